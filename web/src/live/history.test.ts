import { expect, test } from "vitest";
import { HistorySource, coursesOf, lastBefore } from "./history";

const history = coursesOf({
  from: "2026-11-23T01:00:00.000Z",
  until: "2026-11-23T02:00:00.000Z",
  step_s: 10,
  people: [
    {
      person: "p1",
      tag: "t1",
      time_s: [0, 10, 500],
      position_m: [
        [0, 0, 112],
        [10, 0, 112],
        [400, 0, 112],
      ],
      radius_95_m: [1, 2, 3],
      quality: ["fixed", "dead-reckoning", "fixed"],
      level: ["l300", "l300", "l300"],
    },
  ],
});
const start = Date.parse("2026-11-23T01:00:00.000Z");
const at = (seconds: number) => {
  const source = new HistorySource(history, () => "Anna", start);
  source.seek(start + seconds * 1000, null);
  return { source, walker: source.get("p:p1")! };
};

test("between two fixes somebody is between them", () => {
  expect(at(5).walker.x).toBe(5);
});

test("over a gap the last place stands, and is not as good as heard", () => {
  const { walker } = at(300);
  expect(walker.x).toBe(10);
  expect(walker.inContact).toBe(false);
});

test("before the first fix nobody is there", () => {
  expect(at(-1).source.present).toBe(0);
  expect(at(0).source.present).toBe(1);
});

test("finds the last time not after a moment", () => {
  const times = Float64Array.from([1, 3, 3, 8]);
  expect([0, 1, 2, 3, 7, 8, 9].map((time) => lastBefore(times, time))).toEqual([-1, 0, 0, 2, 2, 3, 3]);
});

test("who changes tags has one course", () => {
  const column = { radius_95_m: [1], quality: ["fixed"], level: ["l300"] };
  const courses = coursesOf({
    from: "2026-11-23T01:00:00.000Z",
    until: "2026-11-23T02:00:00.000Z",
    step_s: 1,
    people: [
      { person: "p1", tag: "t2", time_s: [60], position_m: [[2, 0, 0]], ...column },
      { person: "p1", tag: "t1", time_s: [0], position_m: [[1, 0, 0]], ...column },
    ],
  });
  expect(courses.map((course) => course.places.map(([east]) => east))).toEqual([[1, 2]]);
});
