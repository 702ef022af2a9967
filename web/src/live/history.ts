/** Positions of the past for a replay: whoever was somewhere, at any moment of a span. */
import type { HistoryPositions, Point3, Quality, Track } from "../api/types";
import type { PeopleSource } from "../map/people-layer";
import { keyOf } from "./subject";
import { Walker } from "./walker";

/** Between two fixes farther apart than this, the first one stands, ms. */
const GAP_MS = 90_000;
/** Who was not heard for so long is not drawn, ms. */
const GONE_MS = 30 * 60_000;

export interface Course {
  key: string;
  person: string | null;
  times: Float64Array;
  places: Point3[];
  radii: number[];
  qualities: string[];
  levels: (string | null)[];
}

/** Of everybody. Who wore several tags one after the other has several entries in the answer and one course here. */
export function coursesOf(history: HistoryPositions): Course[] {
  const from = Date.parse(history.from);
  const courses = new Map<string, Course>();
  for (const one of history.people) {
    const key = keyOf(one.person, one.tag);
    const course: Course = {
      key,
      person: one.person,
      times: Float64Array.from(one.time_s, (time) => from + time * 1000),
      places: one.position_m,
      radii: one.radius_95_m,
      qualities: one.quality,
      levels: one.level,
    };
    const before = courses.get(key);
    courses.set(key, before ? joined(before, course) : course);
  }
  return [...courses.values()];
}

function joined(one: Course, other: Course): Course {
  const all = [one, other].flatMap((course) => Array.from(course.times, (time, index) => ({ time, course, index })));
  all.sort((a, b) => a.time - b.time);
  return {
    key: one.key,
    person: one.person,
    times: Float64Array.from(all, (it) => it.time),
    places: all.map((it) => it.course.places[it.index]!),
    radii: all.map((it) => it.course.radii[it.index]!),
    qualities: all.map((it) => it.course.qualities[it.index]!),
    levels: all.map((it) => it.course.levels[it.index] ?? null),
  };
}

export function courseOfTrack(key: string, person: string | null, track: Track): Course {
  return {
    key,
    person,
    times: Float64Array.from(track.fixes, (fix) => Date.parse(fix.time)),
    places: track.fixes.map((fix) => fix.position_m as Point3),
    radii: track.fixes.map((fix) => fix.radius_95_m),
    qualities: track.fixes.map((fix) => fix.quality),
    levels: track.fixes.map((fix) => fix.level ?? null),
  };
}

/** Index of the last time that is not after `at`; −1 before the first. */
export function lastBefore(times: Float64Array, at: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= at) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

class Actor extends Walker {
  #moved = false;

  constructor(private readonly course: Course) {
    super(course.key);
  }

  /** Puts them where they were. */
  at(nowMs: number): boolean {
    const { times, places, levels } = this.course;
    const index = lastBefore(times, nowMs);
    const place = places[index];
    if (!place || nowMs - times[index]! > GONE_MS) {
      this.#moved ||= this.fixMs !== 0;
      this.fixMs = 0;
      return false;
    }
    const next = places[index + 1];
    const span = next ? times[index + 1]! - times[index]! : 0;
    const walking = next && span > 0 && span < GAP_MS && levels[index] === levels[index + 1];
    const share = walking ? (nowMs - times[index]!) / span : 0;
    const [x, y] = walking ? [place[0] + (next[0] - place[0]) * share, place[1] + (next[1] - place[1]) * share] : place;
    if (x !== this.x || y !== this.y) this.#moved = true;
    this.x = x;
    this.y = y;
    this.height = place[2];
    this.level = levels[index] ?? null;
    this.radius95 = this.course.radii[index] ?? 0;
    this.quality = (this.course.qualities[index] ?? "fixed") as Quality;
    this.heading =
      walking && Math.hypot(next[0] - place[0], next[1] - place[1]) / (span / 1000) > 0.25
        ? Math.atan2(next[0] - place[0], next[1] - place[1])
        : null;
    // Between two fixes that belong together the position is as good as measured now.
    this.fixMs = walking ? nowMs : times[index]!;
    this.inContact = nowMs - this.fixMs < 120_000;
    return true;
  }

  /** The trail of the last minutes, from the course itself. */
  draw(nowMs: number, spanMs: number): void {
    const { times, places } = this.course;
    this.trail.clear();
    const last = lastBefore(times, nowMs);
    for (let index = Math.max(0, lastBefore(times, nowMs - spanMs)); index <= last; index += 1) {
      this.trail.push(places[index]![0], places[index]![1], times[index]!);
    }
  }

  override advance(): boolean {
    const moved = this.#moved;
    this.#moved = false;
    return moved;
  }
}

export class HistorySource implements PeopleSource {
  readonly #actors: Actor[];
  #now: number;
  /** How many are somewhere at the moment. */
  present = 0;

  constructor(
    courses: Course[],
    nameOf: (course: Course) => string,
    readonly from: number,
  ) {
    this.#now = from;
    this.#actors = courses.map((course) => {
      const actor = new Actor(course);
      actor.name = nameOf(course);
      return actor;
    });
  }

  seek(nowMs: number, trailOf: string | null): void {
    this.#now = nowMs;
    this.present = 0;
    for (const actor of this.#actors) {
      if (actor.at(nowMs)) this.present += 1;
      if (actor.key === trailOf) actor.draw(nowMs, 180_000);
    }
  }

  walkers(): Iterable<Walker> {
    return this.#actors;
  }

  nowMs(): number {
    return this.#now;
  }

  radius(walker: Walker): number {
    return walker.radius95;
  }

  get(key: string): Walker | undefined {
    return this.#actors.find((actor) => actor.key === key);
  }
}
