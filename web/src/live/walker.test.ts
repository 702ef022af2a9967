import { expect, test } from "vitest";
import { Trail } from "./trail";
import { Walker } from "./walker";

test("walks evenly from one fix to the next", () => {
  const walker = new Walker("p:1");
  walker.moveTo(0, 0, 1000, 0);
  walker.moveTo(2, 4, 2000, 1000);
  expect(walker.advance(1500)).toBe(true);
  expect([walker.x, walker.y]).toEqual([1, 2]);
  walker.advance(2000);
  expect([walker.x, walker.y]).toEqual([2, 4]);
  expect(walker.advance(2100)).toBe(false);
});

test("does not walk through the rock over a jump, nor leaves a trail across it", () => {
  const walker = new Walker("p:1");
  walker.moveTo(0, 0, 1000, 0);
  walker.moveTo(500, 0, 4000, 1000);
  expect(walker.x).toBe(500);
  expect(walker.trail.count).toBe(1);
});

test("a trail has a fixed size and begins where it is asked to", () => {
  const trail = new Trail();
  for (let at = 0; at < 500; at += 1) trail.push(5000 + at, 3000, at * Trail.EVERY_MS);
  expect(trail.count).toBe(Trail.PLACES);
  const seen: number[] = [];
  trail.each(495 * Trail.EVERY_MS, (east) => seen.push(east));
  expect(seen).toEqual([5495, 5496, 5497, 5498, 5499]);
});
