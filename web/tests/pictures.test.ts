/** A picture of each view for docs/live/console.md, and each view before axe-core in both themes: contrast, labels, names. */
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import type { Page } from "playwright-core";
import { beforeAll, expect } from "vitest";
import { open, show } from "./support/browser";
import { press, tagId } from "./support/crowd";
import { stage, test } from "./support/stage";

const at = stage(86, 80);
/** Written only when asked for: pictures change with every run. */
const folder = process.env["ADIT_PICTURES"] ? resolve(process.env["ADIT_PICTURES"]) : null;
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const mine = resolve(import.meta.dirname, "../../mines/two-level.toml");

/** Tags with real sensors: the person page tells how they are followed. */
const LOADED = 8;
const VIEWS: [name: string, hash: string][] = [
  ["map", "#/map?level=all"],
  ["map-level", "#/map?level=l300&at=5290.0,3050.0,5.20&who=p:p0010"],
  ["alarms", "#/alarms"],
  ["person", "#/people/p0080"],
  ["people", "#/people"],
  ["replay", "#/replay"],
  ["attendance", "#/attendance"],
  ["radio", "#/radio"],
  ["editor", "#/editor"],
  ["users", "#/users"],
  ["tokens", "#/users"],
  ["audit", "#/audit"],
  ["settings", "#/settings"],
];
/** Pictures in light too. */
const LIGHT = new Set(["map", "person"]);

beforeAll(async () => {
  if (!at.server) return;
  at.crowd.walk();
  await at.crowd.place(3, [5765, 3170, 114.2]);
  await at.crowd.place(9, [5208, 3035, 113]);
  await at.crowd.place(14, [5205, 3036, 113]);
  const load = [
    "load",
    at.server.url,
    "--mine",
    mine,
    "--tags",
    String(LOADED),
    "--seconds",
    "100",
    "--token",
    at.server.token,
  ];
  spawn(at.server.program, load, { stdio: "ignore" });
  await new Promise((done) => setTimeout(done, 25_000));
  const heard = await at.server.ask<{ tag: { id: string } }[]>("GET", "/api/v1/tags");
  const tag = heard.find((one) => one.tag.id.startsWith("T"))?.tag.id;
  await at.server.ask("DELETE", `/api/v1/tags/${tagId(79)}/assignments`);
  if (tag) await at.server.ask("POST", `/api/v1/tags/${tag}/assignments`, { person: "p0080" });
  await press(at.server, tagId(11));
  for (const [name, role] of [
    ["berger", "dispatcher"],
    ["chen", "dispatcher"],
    ["novak", "safety-officer"],
    ["lobby-screen", "viewer"],
  ] as const) {
    await at.server.ask("POST", "/api/v1/users", { name, role, password: `${name} and a long word` });
  }
  await at.server.ask("PATCH", "/api/v1/users/chen", { disabled: true });
  const ends = new Date(Date.now() + 90 * 86_400_000).toISOString();
  for (const token of [
    { name: "gateways-north", grant: "ingest" },
    { name: "shift-report", grant: "safety-officer", expires: ends },
    { name: "old-board", grant: "viewer" },
  ]) {
    const made = await at.server.ask<{ token: { id: string } }>("POST", "/api/v1/tokens", token);
    if (token.name === "old-board") await at.server.ask("DELETE", `/api/v1/tokens/${made.token.id}`);
  }
  if (folder) mkdirSync(folder, { recursive: true });
});

async function picture(page: Page, name: string): Promise<void> {
  if (folder) await page.screenshot({ path: join(folder, `${name}.png`) });
}

async function violations(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    const { axe } = window as unknown as {
      axe: { run: () => Promise<{ violations: { id: string; nodes: { html: string; failureSummary?: string }[] }[] }> };
    };
    const found = (await axe.run()).violations;
    return found.flatMap(({ id, nodes }) =>
      nodes.slice(0, 3).map((node) => `${id}: ${node.html.slice(0, 160)} ${node.failureSummary ?? ""}`),
    );
  });
}

test("the log-in page passes axe-core", async () => {
  const context = await at.browser.newContext({ viewport: { width: 1280, height: 800 } });
  const page = await context.newPage();
  await page.goto(at.server.url);
  await page.waitForSelector("form");
  await picture(page, "login");
  expect(await violations(page)).toEqual([]);
  await context.close();
});

for (const theme of ["dark", "light"] as const) {
  test(`every view passes axe-core, ${theme}`, async () => {
    const { page, errors } = await open(at.browser, at.server, { theme, viewport: { width: 1280, height: 800 } });
    const found: string[] = [];
    for (const [name, hash] of VIEWS) {
      await show(page, hash);
      await page.waitForTimeout(name === "person" ? 7000 : 1800);
      if (name === "alarms") await page.locator("table a").first().click();
      if (name === "replay") await page.getByRole("button", { name: "To the last alarm" }).click();
      if (["people", "users", "tokens", "audit"].includes(name)) await page.waitForSelector("main tbody tr");
      // The whole of the page: innovations and anchors stand below the figures.
      await page.setViewportSize({ width: 1280, height: name.startsWith("person") ? 1400 : 800 });
      if (name === "tokens") await page.getByRole("tab", { name: /tokens/ }).click();
      await page.waitForTimeout(300);
      if (theme === "dark") await picture(page, name);
      else if (LIGHT.has(name)) await picture(page, `${name}-light`);
      for (const one of await violations(page)) found.push(`${name}: ${one}`);
    }
    await page.keyboard.press("?");
    await page.waitForSelector("dialog[open]");
    for (const one of await violations(page)) found.push(`keys: ${one}`);
    expect(found).toEqual([]);
    expect(errors).toEqual([]);
    await page.context().close();
  });
}

test("the evacuation board passes axe-core, both themes; a phone and a wall", async () => {
  await at.server.ask("POST", "/api/v1/evacuation", { note: "Smoke at the crusher" });
  const found: string[] = [];
  for (const theme of ["dark", "light"] as const) {
    const { page } = await open(at.browser, at.server, { theme, viewport: { width: 1280, height: 800 } });
    await show(page, "#/evacuation");
    await page.waitForTimeout(3000);
    if (theme === "dark") await picture(page, "evacuation");
    for (const one of await violations(page)) found.push(`evacuation ${theme}: ${one}`);
    await page.context().close();
  }
  const phone = await open(at.browser, at.server, {
    viewport: { width: 390, height: 844 },
    hasTouch: true,
    isMobile: true,
    deviceScaleFactor: 1,
  });
  await show(phone.page, "#/map?level=l300&who=p:p0010");
  await phone.page.waitForTimeout(2000);
  await phone.page.getByRole("button", { name: "People", expanded: false }).click();
  await picture(phone.page, "phone-map");
  for (const one of await violations(phone.page)) found.push(`phone: ${one}`);
  expect(await phone.page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  for (const view of ["users", "audit", "people/p0080"]) {
    await show(phone.page, `#/${view}`);
    await phone.page.waitForTimeout(2500);
    for (const one of await violations(phone.page)) found.push(`phone ${view}: ${one}`);
    expect(await phone.page.evaluate(() => document.documentElement.scrollWidth)).toBeLessThanOrEqual(390);
  }
  await show(phone.page, "#/evacuation");
  await phone.page.waitForTimeout(1500);
  await picture(phone.page, "phone-evacuation");
  await phone.page.context().close();
  const wall = await open(at.browser, at.server, { viewport: { width: 1920, height: 1080 } });
  await show(wall.page, "#/settings");
  await wall.page.getByRole("radio", { name: /wall/ }).check();
  await show(wall.page, "#/evacuation");
  await wall.page.waitForTimeout(1500);
  await picture(wall.page, "wall-evacuation");
  for (const one of await violations(wall.page)) found.push(`wall: ${one}`);
  await wall.page.context().close();
  const chinese = await open(at.browser, at.server, { language: "zh", viewport: { width: 1280, height: 800 } });
  await show(chinese.page, "#/map?level=all");
  await chinese.page.waitForTimeout(2000);
  await picture(chinese.page, "map-zh");
  for (const one of await violations(chinese.page)) found.push(`zh: ${one}`);
  await chinese.page.context().close();
  expect(found).toEqual([]);
  await at.server.ask("POST", "/api/v1/evacuation/stop", { note: "" });
});
