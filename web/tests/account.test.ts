/** Users, API tokens and the audit log: in a real browser on a real server. */
import type { Page } from "playwright-core";
import { expect } from "vitest";
import { en } from "../src/i18n/en";
import { zh } from "../src/i18n/zh";
import { open, show } from "./support/browser";
import { stage, test } from "./support/stage";

const at = stage(3, 3);
const PASSWORD = "a horse on a ladder";

/** Somebody's own browser. */
async function logIn(name: string, password: string): Promise<Page> {
  const context = await at.browser.newContext({ viewport: { width: 1280, height: 800 } });
  await context.addInitScript(() => localStorage.setItem("adit.preferences", JSON.stringify({ language: "en" })));
  const page = await context.newPage();
  await page.goto(`${at.server.url}/#login=${name}:${encodeURIComponent(password)}`);
  return page;
}

test("keys lead to users and to the audit log, in both languages", async () => {
  for (const [language, words] of [
    ["en", en],
    ["zh", zh],
  ] as const) {
    const { page, errors } = await open(at.browser, at.server, { language });
    await page.keyboard.press("g");
    await page.keyboard.press("u");
    await page.waitForSelector(`h1:has-text("${words["nav.users"]}")`);
    await page.getByRole("row", { name: /admin/ }).waitFor();
    await page.keyboard.press("g");
    await page.keyboard.press("l");
    await page.waitForSelector(`h1:has-text("${words["nav.audit"]}")`);
    await page.waitForSelector(`text=${words["audit.sound"]}`);
    expect(errors).toEqual([]);
    await page.context().close();
  }
});

test("a user is added, gets another role and password, is disabled, and removed", async () => {
  const { page, errors } = await open(at.browser, at.server);
  await show(page, "#/users");
  await page.getByRole("button", { name: en["users.add"] }).click();
  const form = page.getByRole("dialog");
  await form.getByLabel(en["users.name"]).fill("ann");
  await form.getByLabel(en["users.role"]).selectOption("viewer");
  await form.getByLabel(en["login.password"]).fill("short");
  await form.getByRole("button", { name: en.save }).click();
  expect(await form.count(), "a short password is not sent").toBe(1);
  await form.getByLabel(en["login.password"]).fill(PASSWORD);
  await form.getByRole("button", { name: en.save }).click();
  const row = page.getByRole("row", { name: /ann/ });
  await row.getByText(en["users.may-log-in"]).waitFor();

  const ann = await logIn("ann", PASSWORD);
  await ann.waitForSelector("nav a[aria-current=page]");
  expect(await ann.locator("nav a", { hasText: en["nav.users"] }).count()).toBe(0);
  expect(await ann.locator("nav a", { hasText: en["nav.audit"] }).count()).toBe(0);

  await row.getByRole("button", { name: "Change ann" }).click();
  await form.getByLabel(en["users.role"]).selectOption("dispatcher");
  await form.getByLabel(en["users.new-password"]).fill(`${PASSWORD} again`);
  await form.getByRole("button", { name: en.save }).click();
  await row.getByText(en["role.dispatcher"]).waitFor();
  const users = await at.server.ask<{ name: string; role: string; disabled: boolean }[]>("GET", "/api/v1/users");
  expect(users.find((user) => user.name === "ann")).toMatchObject({ role: "dispatcher", disabled: false });
  // The old session has ended: the page asks who one is.
  await ann.reload();
  await ann.waitForSelector("input[name=password]");
  await ann.context().close();
  const again = await logIn("ann", `${PASSWORD} again`);
  await again.waitForSelector(`nav a:has-text("${en["nav.replay"]}")`);
  await again.context().close();

  await row.getByRole("button", { name: "Change ann" }).click();
  await form.getByLabel(en["users.disabled-box"]).check();
  await form.getByRole("button", { name: en.save }).click();
  await row.getByText(en["users.disabled"], { exact: false }).waitFor();
  const out = await logIn("ann", `${PASSWORD} again`);
  await out.waitForSelector("input[name=password]");
  await out.context().close();

  await row.getByRole("button", { name: "Change ann" }).click();
  await form.getByRole("button", { name: en["users.remove"], exact: true }).click();
  await form.getByRole("button", { name: "Really remove ann" }).click();
  await row.waitFor({ state: "detached" });
  expect(errors).toEqual([]);
  await page.context().close();
});

test("the last administrator stays, and is told why", async () => {
  const { page } = await open(at.browser, at.server);
  await show(page, "#/users");
  await page.getByRole("button", { name: "Change admin" }).click();
  const form = page.getByRole("dialog");
  expect(await form.getByRole("button", { name: en["users.remove"], exact: true }).count()).toBe(0);
  await form.getByLabel(en["users.disabled-box"]).check();
  await form.getByRole("button", { name: en.save }).click();
  await page.waitForSelector(`.toast.bad >> text=${en["error.409"]}`);
  await page.context().close();
});

test("a token is shown once, copied, works, and is revoked", async () => {
  const { page, errors } = await open(at.browser, at.server, { permissions: ["clipboard-read", "clipboard-write"] });
  await show(page, "#/users");
  await page.getByRole("tab", { name: new RegExp(en["tokens.tokens"]) }).click();
  await page.getByRole("button", { name: en["tokens.add"] }).click();
  const form = page.getByRole("dialog");
  await form.getByLabel(en["tokens.name"]).fill("board-7");
  await form.getByLabel(en["tokens.grant"]).selectOption("viewer");
  await form.getByLabel(en["tokens.expires"]).selectOption("30");
  await form.getByRole("button", { name: en["tokens.make"], exact: true }).click();
  const secret = await form.getByLabel(en["tokens.secret"]).inputValue();
  await form.getByRole("button", { name: en["copy.do"] }).click();
  await page.waitForSelector(`.toast.good >> text=${en["copy.done"]}`);
  expect(await page.evaluate(() => navigator.clipboard.readText())).toBe(secret);
  await form.getByRole("button", { name: en["tokens.kept"] }).click();
  const row = page.getByRole("row", { name: /board-7/ });
  await row.getByText(en["tokens.valid"]).waitFor();
  expect(await page.content(), "the secret is nowhere on the page any more").not.toContain(secret);

  const ask = () => fetch(`${at.server.url}/api/v1/live`, { headers: { Authorization: `Bearer ${secret}` } });
  expect((await ask()).status).toBe(200);
  await row.getByRole("button", { name: "Revoke board-7" }).click();
  await form.getByRole("button", { name: en["tokens.revoke"], exact: true }).click();
  await row.getByText(/revoked/).waitFor();
  expect((await ask()).status).toBe(401);
  expect(errors).toEqual([]);
  await page.context().close();
});

test("the audit log is filtered, goes on page by page, and its chain is held against a head", async () => {
  const logIn = { name: "admin", password: "not the password at all" };
  await fetch(`${at.server.url}/api/v1/session`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(logIn),
  });
  for (let n = 0; n < 120; n += 1) await at.server.ask("POST", "/api/v1/people", { id: `x${n}`, name: `X ${n}` });
  const { page, errors } = await open(at.browser, at.server);
  await show(page, "#/audit");
  const rows = page.locator("tbody tr");
  await rows.nth(99).waitFor();
  expect(await rows.count()).toBe(100);
  await page.getByRole("button", { name: en.more, exact: true }).last().click();
  await rows.nth(120).waitFor();
  const numbers = await page.locator("tbody td:first-child").allTextContents();
  const read = numbers.map((text) => Number(text.replace(/\D/g, "")));
  expect(read, "each row once, newest first").toEqual([...new Set(read)].sort((a, b) => b - a));

  await page.getByLabel(en["audit.what"]).fill("session.login");
  await page.getByRole("button", { name: en["audit.filter"] }).click();
  await expect
    .poll(() => page.locator("tbody td:nth-child(4)").allTextContents())
    .toContain(en["audit-what.session.login"]);
  await expect.poll(async () => new Set(await page.locator("tbody td:nth-child(4)").allTextContents()).size).toBe(1);
  expect(await page.locator("tbody td.bad").count(), "the wrong password stands out").toBeGreaterThan(0);
  await page.getByLabel(en["audit.who"]).fill("nobody-of-that-name");
  await page.getByRole("button", { name: en["audit.filter"] }).click();
  await page.waitForSelector(`text=${en["audit.none"]}`);

  await page.waitForSelector(`.chain >> text=${en["audit.sound"]}`);
  await page.getByText(en["audit.head-title"]).click();
  const head = await page.getByLabel(en["audit.head"], { exact: true }).inputValue();
  expect(head).toMatch(/^\d+:[0-9a-f]{64}$/);
  await page.getByLabel(en["audit.head-before"]).fill(head);
  await page.getByRole("button", { name: en["audit.verify"] }).click();
  await page.waitForSelector(`text=${en["audit.head-fits"]}`);
  // A head that the log never had: it was made anew since, or the head is somebody else's.
  await page.getByLabel(en["audit.head-before"]).fill(head.replace(/[0-9a-f]{8}$/, "00000000"));
  await page.getByRole("button", { name: en["audit.verify"] }).click();
  await page.waitForSelector(`.chain.broken >> text=${en["audit.broken"]}`);
  expect(errors).toEqual([]);
  await page.context().close();
});
