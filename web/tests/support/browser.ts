/** Debian's Chromium, in software rendering, with a page that tells its errors. */
import { existsSync } from "node:fs";
import { chromium, type Browser, type BrowserContextOptions, type Page } from "playwright-core";
import type { Server } from "./server";

export const CHROMIUM = process.env["ADIT_CHROMIUM"] ?? "/usr/bin/chromium";
export const hasChromium = existsSync(CHROMIUM);

export async function launch(): Promise<Browser> {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: [
      "--no-sandbox",
      "--disable-gpu",
      "--autoplay-policy=no-user-gesture-required",
      "--enable-precise-memory-info",
      "--js-flags=--expose-gc",
    ],
  });
}

export interface Opened {
  page: Page;
  errors: string[];
}

/** Logs in by the address, as `adit demo` does. */
export async function open(
  browser: Browser,
  server: Server,
  options: BrowserContextOptions & { language?: "en" | "zh"; theme?: "dark" | "light" } = {},
): Promise<Opened> {
  const { language = "en", theme = "dark", ...rest } = options;
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...rest });
  await context.addInitScript(
    ([language, theme]) => {
      if (!localStorage.getItem("adit.preferences")) {
        localStorage.setItem("adit.preferences", JSON.stringify({ language, theme, sound: false }));
      }
    },
    [language, theme],
  );
  const page = await context.newPage();
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    // A server that is down is told by the browser itself; the tests that end it expect that.
    if (message.type() === "error" && !/Failed to load resource|WebSocket connection|ERR_/.test(message.text()))
      errors.push(message.text());
  });
  await page.goto(`${server.url}/#login=admin:${encodeURIComponent(server.password)}`);
  await page.waitForSelector("nav a[aria-current=page]");
  return { page, errors };
}

export async function show(page: Page, hash: string): Promise<void> {
  await page.evaluate((to) => (location.hash = to), hash);
  await page.waitForTimeout(350);
  // A view is loaded when it is first asked for.
  await page.waitForSelector("main > *");
}
