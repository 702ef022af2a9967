/** Somebody as the map draws them: between two fixes they move evenly. */
import type { Quality } from "../api/types";
import { Trail } from "./trail";

/** A way longer than this between two fixes is not walked on the map, m. */
const JUMP_M = 40;
/** What lies between two fixes is drawn in at most this time, ms of the wall. */
const LONGEST_MS = 1600;

export type Trouble = "none" | "known" | "urgent";

export class Walker {
  /** As drawn, m. */
  x = 0;
  y = 0;
  height = 0;
  level: string | null = null;
  /** From north to the east, rad; null at rest. */
  heading: number | null = null;
  radius95 = 0;
  quality: Quality = "fixed";
  name = "";
  kind = "person";
  trouble: Trouble = "none";
  /** When the position was measured, ms of the server. */
  fixMs = 0;
  inContact = true;
  readonly trail = new Trail();

  #fromX = 0;
  #fromY = 0;
  #toX = 0;
  #toY = 0;
  #fromWall = 0;
  #forMs = 0;
  #lastWall = 0;

  constructor(readonly key: string) {}

  /** The last fix, not what is drawn. */
  get place(): [number, number] {
    return [this.#toX, this.#toY];
  }

  /** A new fix; `wall` is when it came. */
  moveTo(east: number, north: number, timeMs: number, wall: number): void {
    const first = this.fixMs === 0;
    const far = Math.hypot(east - this.x, north - this.y) > JUMP_M;
    if (first || far) {
      this.x = east;
      this.y = north;
      this.#forMs = 0;
      if (far && !first) this.trail.clear();
    } else {
      this.#forMs = Math.min(Math.max(wall - this.#lastWall, 100), LONGEST_MS);
    }
    this.#fromX = this.x;
    this.#fromY = this.y;
    this.#toX = east;
    this.#toY = north;
    this.#fromWall = wall;
    this.#lastWall = wall;
    this.fixMs = timeMs;
    this.trail.push(east, north, timeMs);
  }

  /** Where they are drawn at a moment of the wall; whether that has changed. */
  advance(wall: number): boolean {
    if (this.x === this.#toX && this.y === this.#toY) return false;
    const share = this.#forMs > 0 ? Math.min((wall - this.#fromWall) / this.#forMs, 1) : 1;
    this.x = this.#fromX + (this.#toX - this.#fromX) * share;
    this.y = this.#fromY + (this.#toY - this.#fromY) * share;
    return true;
  }
}
