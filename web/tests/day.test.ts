/** A whole day of one person, a fix a second, put through the whole server: how long their page takes to show it. */
import { expect } from "vitest";
import { open } from "./support/browser";
import { personId, tagId } from "./support/crowd";
import { stage, test } from "./support/stage";
import type { Mine, Point3 } from "../src/api/types";

const at = stage(2, 2);
const FIXES = Number(process.env["ADIT_DAY"] ?? 86_400);
const BATCH = 500;
/** The server of a debug build is not optimised: it takes three times as long to read and thin the day. */
const LIMIT_MS = /release/.test(process.env["ADIT_BIN"] ?? "") ? 1000 : 3000;

/** Up and down the roadways of a level at 1.2 m/s, with a metre of noise; half of each hour at work on one spot. */
function* walk(mine: Mine): Generator<Point3> {
  const roads = mine.roadways.filter((road) => road.level === "l300");
  let seed = 11;
  const random = () => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32 - 0.5;
  for (let second = 0; ;) {
    const road = roads[Math.floor((random() + 0.5) * roads.length)]!;
    const points = random() < 0 ? road.points_m : [...road.points_m].reverse();
    for (let leg = 1; leg < points.length; leg += 1) {
      const [from, to] = [points[leg - 1]!, points[leg]!];
      const steps = Math.ceil(Math.hypot(to[0] - from[0], to[1] - from[1]) / 1.2);
      for (let step = 0; step < steps; second += second % 3600 < 1800 ? 1 : 0, step += 1) {
        const share = step / steps;
        const [east, north, up] = [0, 1, 2].map((axis) => from[axis]! + (to[axis]! - from[axis]!) * share) as Point3;
        yield [east + random(), north + random(), up + 1 + 0.2 * random()];
        // At work: the place stays, the noise goes on.
        while (second % 3600 >= 1800) {
          yield [east + random(), north + random(), up + 1 + 0.2 * random()];
          second += 1;
        }
      }
    }
  }
}

test(`a day of somebody, ${FIXES} fixes, opens within ${LIMIT_MS / 1000} s`, async () => {
  const mine = await at.server.ask<Mine>("GET", "/api/v1/mine");
  const places = walk(mine);
  const tag = tagId(5);
  await at.server.ask("POST", "/api/v1/tags", { id: tag, worn: "helmet" });
  await at.server.ask("POST", "/api/v1/people", { id: personId(5), name: "Day Walker" });
  const begin = Date.now() - FIXES * 1000;
  await at.server.ask("POST", `/api/v1/tags/${tag}/assignments`, {
    person: personId(5),
    from: new Date(begin - 1000).toISOString(),
  });
  const putting = performance.now();
  for (let from = 0; from < FIXES; from += BATCH) {
    const locations = Array.from({ length: Math.min(BATCH, FIXES - from) }, (_, index) => ({
      provider_id: tag,
      position: { type: "Point", coordinates: places.next().value as Point3 },
      accuracy: 1.5,
      timestamp_generated: new Date(begin + (from + index) * 1000).toISOString(),
    }));
    await at.server.ask("PUT", "/v2/providers/locations", locations);
  }
  const put = performance.now() - putting;
  const path = `/api/v1/people/${personId(5)}/track?from=${new Date(begin - 1000).toISOString()}&until=${new Date(Date.now() + 1000).toISOString()}&points=3000`;
  type Answer = { fixes: unknown[]; of: number; error_m: number };
  // The writer to the store is behind what was put.
  await expect
    .poll(async () => (await at.server.ask<Answer>("GET", path)).of, { timeout: 120_000, interval: 1000 })
    .toBeGreaterThan(0.99 * FIXES);
  const asked = performance.now();
  const answer = await at.server.ask<Answer>("GET", path);
  const served = performance.now() - asked;

  const { page, errors } = await open(at.browser, at.server);
  await page.evaluate(() => (location.hash = "#/settings"));
  await page.waitForTimeout(4000);
  const shown = await page.evaluate(
    async (hash) => {
      const began = performance.now();
      location.hash = hash;
      while (!/fixes drawn/.test(document.body.textContent ?? "")) await new Promise((done) => setTimeout(done, 10));
      // The picture is on the screen after the frame that follows.
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      return performance.now() - began;
    },
    `#/people/${personId(5)}`,
  );
  const told = await page.locator("text=/fixes drawn, loaded in/").textContent();
  console.log(
    `${FIXES} fixes put in ${(put / 1000).toFixed(0)} s; the server tells ${answer.fixes.length} of ${answer.of} in ${served.toFixed(0)} ms, ` +
      `none left out farther than ${answer.error_m.toFixed(2)} m; the page shows them ${shown.toFixed(0)} ms after the click (${told?.trim()})`,
  );
  expect(shown).toBeLessThan(LIMIT_MS);
  expect(answer.error_m).toBeLessThan(5);
  expect(errors).toEqual([]);
  await page.context().close();
}, 600_000);
