import { expect, test } from "vitest";
import type { Mine } from "../api/types";
import { Stack, levelAt } from "./stack";

const mine: Mine = {
  name: "m",
  levels: [
    { id: "low", elevation_m: 50 },
    { id: "high", elevation_m: 110 },
  ],
  roadways: [
    {
      id: "a",
      kind: "drift",
      level: "high",
      points_m: [
        [0, 0, 110],
        [100, 100, 112],
      ],
    },
    {
      id: "b",
      kind: "drift",
      level: "low",
      points_m: [
        [0, 0, 50],
        [100, 200, 50],
      ],
    },
    {
      id: "ramp",
      kind: "ramp",
      level: null,
      points_m: [
        [0, 0, 110],
        [0, 50, 50],
      ],
    },
  ],
};

test("no level lies over another on the sheet of all", () => {
  const stack = new Stack(mine, true);
  const lowestOfHigh = 0 + stack.shiftOf("high");
  const highestOfLow = 200 + stack.shiftOf("low");
  expect(highestOfLow).toBeLessThan(lowestOfHigh);
});

test("a ramp leads from one level's place on the sheet to the other's", () => {
  const stack = new Stack(mine, true);
  expect(stack.shiftOf(null, 111)).toBe(stack.shiftOf("high"));
  expect(stack.shiftOf(null, 49)).toBe(stack.shiftOf("low"));
  expect(stack.shiftOf(null, 80)).toBeCloseTo((stack.shiftOf("high") + stack.shiftOf("low")) / 2, 6);
});

test("a level alone lies where it is", () => {
  const stack = new Stack(mine, false);
  expect([stack.shiftOf("high"), stack.shiftOf("low"), stack.shiftOf(null, 80)]).toEqual([0, 0, 0]);
});

test("the nearest level is that of a height", () => {
  expect([levelAt(mine.levels, 113), levelAt(mine.levels, 60)]).toEqual(["high", "low"]);
});
