/** The live people, as the map wants them. */
import type { LiveState } from "../live/state";
import { Subject } from "../live/subject";
import type { Walker } from "../live/walker";
import type { PeopleSource } from "./people-layer";

export class LiveSource implements PeopleSource {
  constructor(private readonly state: LiveState) {}

  walkers(): Iterable<Walker> {
    return this.state.subjects.values();
  }

  nowMs(): number {
    return this.state.clock.now();
  }

  radius(walker: Walker, nowMs: number): number {
    return walker instanceof Subject ? walker.radiusAt(nowMs, this.state.patienceMs) : walker.radius95;
  }
}
