import { expect, test } from "vitest";
import { ServerClock } from "./clock";

test("goes on from what the server said, at the server's speed", () => {
  let wall = 500;
  const clock = new ServerClock(() => wall);
  clock.set("2026-11-23T01:00:00.000Z", 10);
  wall += 3000;
  expect(new Date(clock.now()).toISOString()).toBe("2026-11-23T01:00:30.000Z");
});

test("without a speed time goes as fast as here", () => {
  let wall = 0;
  const clock = new ServerClock(() => wall);
  clock.set("2026-11-23T01:00:00.000Z", undefined);
  wall += 1500;
  expect(new Date(clock.now()).toISOString()).toBe("2026-11-23T01:00:01.500Z");
});

test("a resumed connection of an older server, which tells no time, keeps the clock", () => {
  let wall = 0;
  const clock = new ServerClock(() => wall);
  clock.set("2026-11-23T01:00:00.000Z", 1);
  wall += 2000;
  clock.set(undefined, undefined);
  wall += 1000;
  expect(new Date(clock.now()).toISOString()).toBe("2026-11-23T01:00:03.000Z");
});
