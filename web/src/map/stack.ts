/**
 * Levels of a mine lie over one another: drawn in one plan they hide each other. "All levels" draws them one below the other on the sheet, the
 * highest on top, each in its own plan, moved north by a whole shift; what leads from one to another (ramps, shafts) is drawn between.
 */
import type { Level, Mine, Point2, Point3 } from "../api/types";

/** On the level within this height of its elevation, m. */
const LEVEL_HALF_M = 8;
/** Free space between two levels on the sheet, as a share of the tallest plan. */
const GAP_SHARE = 0.22;

export interface Bounds {
  west: number;
  south: number;
  east: number;
  north: number;
}

export function boundsOf(points: Iterable<readonly [number, number, ...number[]]>): Bounds | null {
  let bounds: Bounds | null = null;
  for (const [x, y] of points) {
    if (!bounds) bounds = { west: x, south: y, east: x, north: y };
    bounds.west = Math.min(bounds.west, x);
    bounds.east = Math.max(bounds.east, x);
    bounds.south = Math.min(bounds.south, y);
    bounds.north = Math.max(bounds.north, y);
  }
  return bounds;
}

export function levelAt(levels: Level[], height: number): string | null {
  let nearest: Level | null = null;
  for (const level of levels) {
    if (!nearest || Math.abs(level.elevation_m - height) < Math.abs(nearest.elevation_m - height)) nearest = level;
  }
  return nearest?.id ?? null;
}

export class Stack {
  /** Northward shift of each level, m. */
  readonly #shifts = new Map<string, number>();
  readonly #steps: { height: number; shift: number }[] = [];
  /** From the highest to the lowest. */
  readonly levels: Level[];

  constructor(
    mine: Mine,
    readonly spread: boolean,
  ) {
    this.levels = [...mine.levels].sort((a, b) => b.elevation_m - a.elevation_m);
    const heights = this.levels.map((level) => {
      const bounds = boundsOf(Stack.pointsOf(mine, level.id));
      return { level, bounds };
    });
    const tallest = Math.max(...heights.map(({ bounds }) => (bounds ? bounds.north - bounds.south : 0)), 60);
    let top: number | null = null;
    for (const { level, bounds } of heights) {
      let shift = 0;
      if (spread && bounds) {
        shift = top === null ? 0 : top - bounds.north;
        top = bounds.south + shift - GAP_SHARE * tallest;
      }
      this.#shifts.set(level.id, shift);
      this.#steps.push({ height: level.elevation_m, shift });
    }
  }

  static *pointsOf(mine: Mine, level: string): Generator<Point2 | Point3> {
    for (const road of mine.roadways) if (road.level === level) yield* road.points_m;
    for (const zone of mine.zones ?? []) if (zone.level === level) yield* zone.outline_m as Point2[];
  }

  shiftOf(level: string | null | undefined, height?: number): number {
    if (level != null) return this.#shifts.get(level) ?? 0;
    return height === undefined ? 0 : this.#between(height);
  }

  /** Of a place on a ramp or in a shaft. */
  #between(height: number): number {
    if (!this.spread) return 0;
    const steps = this.#steps;
    for (let at = 0; at < steps.length; at += 1) {
      const { height: upper, shift } = steps[at]!;
      if (height >= upper - LEVEL_HALF_M) return shift;
      const next = steps[at + 1];
      if (!next) return shift;
      const [from, to] = [upper - LEVEL_HALF_M, next.height + LEVEL_HALF_M];
      if (height > to) return shift + ((from - height) / (from - to)) * (next.shift - shift);
    }
    return 0;
  }
}
