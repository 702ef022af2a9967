/** What every file of browser tests begins with: a server, a crowd and a browser; or a word why not. */
import type { Browser } from "playwright-core";
import { afterAll, beforeAll, test as vitest } from "vitest";
import { CHROMIUM, hasChromium, launch } from "./browser";
import { Crowd } from "./crowd";
import { Server } from "./server";

export interface Stage {
  server: Server;
  browser: Browser;
  crowd: Crowd;
}

const reason = !hasChromium ? `no ${CHROMIUM}` : !Server.has() ? "no adit: ADIT_BIN, or cargo build" : null;
if (reason !== null) console.log(`SKIPPED (${reason}): the browser tests`);

/** Tests that need the stage; skipped, and said so, where there is none. */
export const test = vitest.skipIf(reason !== null);

export function stage(count: number, named: number, anybody = 1000): Stage {
  const made = {} as Stage;
  beforeAll(async () => {
    if (reason !== null) return;
    made.server = (await Server.start({ anybody }))!;
    made.crowd = await Crowd.of(made.server, count, named);
    await made.crowd.step();
    made.browser = await launch();
  });
  afterAll(async () => {
    made.crowd?.halt();
    await made.browser?.close();
    await made.server?.stop();
  });
  return made;
}
