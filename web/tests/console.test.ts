/** Each view, the way of an alarm, an evacuation, a replay, the editor, people and tags, roles, a restart: in a real browser on a real server. */
import { expect } from "vitest";
import { en } from "../src/i18n/en";
import { zh } from "../src/i18n/zh";
import { open, show } from "./support/browser";
import { personName, press, tagId } from "./support/crowd";
import { stage, test } from "./support/stage";

const at = stage(24, 20);
const VIEWS = [
  "map",
  "alarms",
  "evacuation",
  "people",
  "replay",
  "attendance",
  "radio",
  "editor",
  "users",
  "audit",
  "settings",
] as const;

test("every view opens in both languages, in the words of the dictionary", async () => {
  for (const [language, words] of [
    ["en", en],
    ["zh", zh],
  ] as const) {
    const { page, errors } = await open(at.browser, at.server, { language });
    for (const view of VIEWS) {
      await show(page, `#/${view}`);
      await page.waitForSelector(`nav a[aria-current=page]:has-text("${words[`nav.${view}`]}")`);
      await page.waitForFunction(() => (document.querySelector("main .view")?.textContent?.trim().length ?? 0) > 5);
    }
    await show(page, "#/people/p0001");
    await page.waitForSelector(`text=${words["why.title"]}`);
    expect(await page.getAttribute("html", "lang")).toBe(language === "zh" ? "zh-CN" : "en");
    expect(errors).toEqual([]);
    await page.context().close();
  }
});

test("a wrong password is told, the right one lets in, the address keeps none", async () => {
  const context = await at.browser.newContext();
  const page = await context.newPage();
  await page.goto(at.server.url);
  await page.fill("input[name=name]", "admin");
  await page.fill("input[name=password]", "not the password");
  await page.click("form button.primary");
  await page.waitForSelector("[role=alert]");
  await page.fill("input[name=password]", at.server.password);
  await page.click("form button.primary");
  await page.waitForSelector("nav a[aria-current=page]");
  await page.goto(`${at.server.url}/#login=admin:${encodeURIComponent(at.server.password)}`);
  await page.waitForSelector("nav a[aria-current=page]");
  expect(page.url()).not.toContain(at.server.password);
  await context.close();
});

test("an alarm comes, is acknowledged, commented and cleared", async () => {
  const { page } = await open(at.browser, at.server);
  await press(at.server, tagId(1));
  const strip = page.locator("aside.strip", { hasText: en["alarm.distress"] });
  await strip.waitFor();
  expect(await strip.textContent()).toContain(personName(1));
  await page.waitForFunction(() => document.title.startsWith("("));
  await strip.getByRole("button", { name: en["alarms.acknowledge"] }).click();
  await strip.waitFor({ state: "detached" });

  await show(page, "#/alarms");
  await page.getByRole("link", { name: en["alarm.distress"] }).click();
  await page.fill("#note", "Called, help is on the way");
  await page.getByRole("button", { name: en["alarms.say"] }).click();
  await page.waitForSelector("text=Called, help is on the way");
  await page.getByRole("button", { name: en["alarms.clear"] }).click();
  await page.waitForSelector(`text=${en["alarms.none"]}`);
  await page.getByRole("tab", { name: en["alarms.past"] }).click();
  await page.getByRole("link", { name: en["alarm.distress"] }).waitFor();
  await page.context().close();
});

test("somebody is found by name, followed, and told why they are there", async () => {
  at.crowd.walk();
  const { page } = await open(at.browser, at.server);
  await page.keyboard.press("/");
  await page.keyboard.type(personName(5).toLowerCase());
  await page.keyboard.press("Enter");
  await page.waitForSelector(`section.card h1:has-text("${personName(5)}")`);
  await page.keyboard.press("f");
  const centre = () => page.evaluate(() => new URLSearchParams(location.hash.split("?")[1]).get("at"));
  await page.waitForTimeout(1200);
  const before = await centre();
  await page.waitForTimeout(4000);
  expect(await centre()).not.toBe(before);
  await page.getByRole("link", { name: en["map.why"] }).click();
  await page.waitForSelector(`text=${en["why.title"]}`);
  at.crowd.halt();
  await page.context().close();
});

test("an evacuation is started, tells who is where, and is ended", async () => {
  await at.crowd.place(2, [5208, 3035, 113]);
  const { page } = await open(at.browser, at.server);
  await show(page, "#/evacuation");
  await page.getByRole("button", { name: en["evacuation.start"] }).click();
  await page
    .getByRole("dialog")
    .getByRole("button", { name: /Everybody out/ })
    .click();
  await page.waitForSelector(`text=${en["evacuation.runs"]}`);
  const refuge = page.locator(".tile.in-refuge .n");
  await expect.poll(() => refuge.textContent(), { timeout: 15_000 }).toBe("1");
  const all = await page.locator(".tile .n").allTextContents();
  const people = Number((await page.locator(".safe p").textContent())?.match(/of (\d+) safe/)?.[1]);
  expect(all.slice(1).reduce((sum, n) => sum + Number(n), 0)).toBe(people);
  expect(people).toBe(24);
  await page.getByRole("button", { name: en["evacuation.stop"] }).click();
  await page.getByRole("dialog").getByRole("button", { name: en["evacuation.stop"] }).click();
  await page.waitForSelector(`text=${en["evacuation.none"]}`);
  await page.context().close();
});

test("a zone is drawn, its corners are its own, and it is removed", async () => {
  const { page } = await open(at.browser, at.server);
  await show(page, "#/editor");
  await page.getByRole("button", { name: /Draw a zone/ }).click();
  const box = (await page.locator(".editor .map").boundingBox())!;
  for (const [x, y] of [
    [0.3, 0.3],
    [0.5, 0.3],
    [0.5, 0.45],
  ] as const) {
    await page.mouse.click(box.x + box.width * x, box.y + box.height * y);
    await page.waitForTimeout(350);
  }
  await page.mouse.dblclick(box.x + box.width * 0.3, box.y + box.height * 0.45);
  await page.waitForSelector("form >> text=4 corners");
  await page.locator("form input").nth(1).fill("Test area");
  await page.getByRole("button", { name: en.save }).click();
  await page.getByRole("button", { name: /Test area/ }).waitFor();
  const zones = await at.server.ask<{ zone: { name: string; outline_m: number[][] } }[]>("GET", "/api/v1/zones");
  const drawn = zones.find(({ zone }) => zone.name === "Test area")!.zone;
  expect(drawn.outline_m).toHaveLength(4);
  const [west, east] = [drawn.outline_m[0]![0]!, drawn.outline_m[1]![0]!];
  expect(east).toBeGreaterThan(west);
  await page.getByRole("button", { name: /Test area/ }).click();
  await page.getByRole("button", { name: en["editor.remove"] }).click();
  await page.getByRole("button", { name: /Test area/ }).waitFor({ state: "detached" });
  await page.context().close();
});

test("a person is entered, gets a tag, and gives it back", async () => {
  await at.server.ask("POST", "/api/v1/tags", { id: "spare-1", worn: "waist" });
  const { page } = await open(at.browser, at.server);
  await show(page, "#/people");
  await page.getByRole("button", { name: en["people.add"] }).click();
  const form = page.getByRole("dialog");
  await form.getByLabel(en["people.id"], { exact: true }).fill("p9000");
  await form.getByLabel(en["people.name"], { exact: true }).fill("Zoe Zander");
  await form.getByRole("button", { name: en.save }).click();
  const row = page.locator("tr", { hasText: "Zoe Zander" });
  await row.getByRole("button", { name: en["people.give"] }).click();
  await page.getByRole("dialog").getByLabel(en["people.tag"], { exact: true }).fill("spare-1");
  await page.getByRole("dialog").getByRole("button", { name: en["people.give"] }).click();
  await row.getByRole("button", { name: en["people.take-back"] }).click();
  await row.getByRole("button", { name: en["people.give"] }).waitFor();
  await page.context().close();
});

test("the past plays: time goes on, people move", async () => {
  at.crowd.walk();
  await new Promise((done) => setTimeout(done, 6000));
  at.crowd.halt();
  await new Promise((done) => setTimeout(done, 6000));
  const { page, errors } = await open(at.browser, at.server);
  await show(page, "#/replay");
  await page.getByRole("button", { name: "15 min" }).click();
  await page.waitForSelector("text=/2[0-9] below/");
  const time = () => page.locator("time.at").textContent();
  const before = await time();
  await page.getByRole("button", { name: en["replay.play"], exact: true }).click();
  await page.waitForTimeout(1500);
  expect(await time()).not.toBe(before);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("who may only look is told why a button does nothing", async () => {
  await at.server.ask("POST", "/api/v1/users", { name: "looker", password: "look but do not touch", role: "viewer" });
  const context = await at.browser.newContext({ viewport: { width: 1280, height: 800 } });
  await context.addInitScript(() => localStorage.setItem("adit.preferences", JSON.stringify({ language: "en" })));
  const page = await context.newPage();
  await page.goto(`${at.server.url}/#login=looker:${encodeURIComponent("look but do not touch")}`);
  await page.waitForSelector("nav a[aria-current=page]");
  expect(await page.locator("nav a", { hasText: en["nav.replay"] }).count()).toBe(0);
  await show(page, "#/evacuation");
  const start = page.getByRole("button", { name: en["evacuation.start"] });
  expect(await start.isDisabled()).toBe(true);
  expect(await start.getAttribute("title")).toContain(en["role.dispatcher"]);
  await context.close();
});

test("comes back by itself after the server was killed; place and zoom stay", async () => {
  const { page } = await open(at.browser, at.server);
  await show(page, "#/map?level=l300&at=5400.0,3050.0,5.20");
  await page.waitForSelector(".link.open");
  await at.server.down("SIGKILL");
  await page.waitForSelector(`.lost-bar >> text=${en["link.lost"]}`);
  await page.waitForTimeout(2500);
  expect(await page.locator(".lost-bar").textContent()).toMatch(/\d+ s old/);
  await at.server.up();
  await page.waitForSelector(".link.open", { timeout: 15_000 });
  expect(await page.locator(".lost-bar").count()).toBe(0);
  const query = new URLSearchParams(new URL(page.url()).hash.split("?")[1]);
  expect([query.get("level"), query.get("at")]).toEqual(["l300", "5400.0,3050.0,5.20"]);
  await at.crowd.step();
  await expect.poll(() => page.locator(".heads b").first().textContent()).toBe("24");
  await page.context().close();
});

test("the first content stands within two seconds", async () => {
  const context = await at.browser.newContext();
  const page = await context.newPage();
  await page.goto(`${at.server.url}/#login=admin:${encodeURIComponent(at.server.password)}`);
  await page.waitForSelector("canvas.people", { state: "attached" });
  const paint = await page.evaluate(
    () => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity,
  );
  const map = await page.evaluate(() => performance.now());
  console.log(`first content after ${paint.toFixed(0)} ms, the map after ${map.toFixed(0)} ms`);
  expect(paint).toBeLessThan(2000);
  await context.close();
});
