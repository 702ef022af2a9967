import { expect, test } from "vitest";
import type { Following } from "../../api/types";
import { byNearness, courseOf, sightOf, type HeardSource } from "./following";

const heard = (of: Partial<HeardSource>): HeardSource => ({
  source: "a1",
  kind: "range",
  time: "2026-11-23T06:00:00.000Z",
  ...of,
});

test("innovations stand in the middle of their ten seconds, the last before the end", () => {
  const bins = Array.from({ length: 60 }, (_, index) => ({ mean_nis: index === 0 ? null : 1, count: 4, outliers: 0 }));
  const following = { innovations: { until: "2026-11-23T06:10:00.000Z", bin_s: 10, bins } } as unknown as Following;
  const course = courseOf(following);
  const end = Date.parse("2026-11-23T06:10:00.000Z") / 1000;
  expect(course).toHaveLength(60);
  expect([course[0]!.time, course[59]!.time]).toEqual([end - 595, end - 5]);
  expect([course[0]!.nis, course[1]!.nis]).toEqual([null, 1]);
  expect(courseOf({ innovations: null } as unknown as Following)).toEqual([]);
});

test("what nothing judged is neither clear nor blocked", () => {
  expect(sightOf(heard({}))).toBe("not-judged");
  expect(sightOf(heard({ line_of_sight: null }))).toBe("not-judged");
  expect(sightOf(heard({ line_of_sight: 0 }))).toBe("blocked");
  expect(sightOf(heard({ line_of_sight: 0.9 }))).toBe("clear");
});

test("ranges come first, the nearest on top, then signals, the strongest on top", () => {
  const all = [
    heard({ source: "w2", kind: "signal", rssi_dbm: -80 }),
    heard({ source: "far", range_m: 90 }),
    heard({ source: "w1", kind: "signal", rssi_dbm: -40 }),
    heard({ source: "near", range_m: 3 }),
  ];
  expect(all.sort(byNearness).map((one) => one.source)).toEqual(["near", "far", "w1", "w2"]);
});
