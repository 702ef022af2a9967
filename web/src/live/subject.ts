/** A person, else a tag that nobody is known to wear, as the live state knows them. */
import type { Live, Quality, Where } from "../api/types";
import { Walker } from "./walker";

/** Slower than this is no heading, m/s. */
const HEADING_FROM_M_S = 0.25;
/** How fast the radius grows where the server has not told, m/s. */
const GROWTH_M_S = 1.5;

export const keyOf = (person: string | null | undefined, tag: string | null | undefined): string =>
  person != null ? `p:${person}` : `t:${tag ?? ""}`;

export class Subject extends Walker {
  person: string | null = null;
  /** The tag that says where they are. */
  tag: string | null = null;
  method = "";
  /** Since when they are below, ms. */
  sinceMs = 0;
  heardMs = 0;
  gateway: string | null = null;
  motion: string | null = null;
  zones = new Set<string>();
  possibleZones: string[] = [];
  protectionLevel = 0;
  speed = 0;
  /** Radius that the server told last, and of when: it knows who rests, and does not let their circles grow. */
  #radius = 0;
  #radiusMs = 0;
  hasPosition = false;

  /** All of it, as a snapshot has it. */
  take(live: Live, wall: number): void {
    this.person = live.person ?? null;
    this.tag = live.tag ?? live.last_known?.tag ?? null;
    this.kind = live.kind;
    this.sinceMs = live.since ? Date.parse(live.since) : 0;
    this.zones = new Set(live.zones.map((stay) => stay.zone));
    this.possibleZones = live.possible_zones;
    this.inContact = live.in_contact;
    this.heardMs = live.last_heard ? Date.parse(live.last_heard) : 0;
    this.gateway = live.gateway ?? null;
    this.motion = live.motion?.motion ?? null;
    if (!live.last_known) return;
    this.move(live.last_known, wall);
    this.#radius = live.last_known.radius_now_m;
    this.#radiusMs = this.fixMs + live.last_known.age_s * 1000;
  }

  move(where: Where, wall: number): void {
    const timeMs = Date.parse(where.time);
    if (timeMs < this.fixMs) return;
    this.tag = where.tag;
    this.method = where.method;
    this.quality = where.quality as Quality;
    this.level = where.level ?? null;
    this.radius95 = where.radius_95_m;
    this.protectionLevel = where.protection_level_m;
    this.height = where.position_m[2]!;
    const [east = 0, north = 0] = where.velocity_m_s ?? this.#between(where.position_m, timeMs);
    this.speed = Math.hypot(east, north);
    this.heading = this.speed > HEADING_FROM_M_S ? Math.atan2(east, north) : null;
    this.#radius = where.radius_95_m;
    this.#radiusMs = timeMs;
    this.heardMs = Math.max(this.heardMs, timeMs);
    this.inContact = this.inContact || where.age_s < 5;
    this.hasPosition = true;
    this.moveTo(where.position_m[0]!, where.position_m[1]!, timeMs, wall);
  }

  /** Velocity from the last two fixes, of systems that tell none. */
  #between(position: number[], timeMs: number): [number, number] {
    const seconds = (timeMs - this.fixMs) / 1000;
    if (seconds <= 0 || seconds > 5) return [0, 0];
    const [east, north] = this.place;
    return [(position[0]! - east) / seconds, (position[1]! - north) / seconds];
  }

  /** Radius that holds them at a moment of the server, m: what it told, grown where it has not told for longer than `patienceMs`. */
  radiusAt(nowMs: number, patienceMs: number): number {
    const silentMs = nowMs - this.#radiusMs;
    if (silentMs <= patienceMs || this.motion === "still") return this.#radius;
    return this.#radius + (GROWTH_M_S * silentMs) / 1000;
  }

  ageS(nowMs: number): number {
    return Math.max(0, (nowMs - this.fixMs) / 1000);
  }
}
