/** The live people, as the map wants them. */
import type { LiveState } from "../live/state";
import { Subject } from "../live/subject";
import type { Walker } from "../live/walker";
import type { PeopleSource } from "./people-layer";

/** A circle does not breathe between two fixes: it grows from this age on, ms. */
const CALM_MS = 2500;

export class LiveSource implements PeopleSource {
  constructor(private readonly state: LiveState) {}

  walkers(): Iterable<Walker> {
    return this.state.subjects.values();
  }

  nowMs(): number {
    return this.state.clock.now();
  }

  radius(walker: Walker, nowMs: number): number {
    return walker instanceof Subject && nowMs - walker.fixMs > CALM_MS ? walker.radiusAt(nowMs) : walker.radius95;
  }
}
