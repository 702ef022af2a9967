/** What the console knows of the mine now: kept from the messages of the live socket, in order. No framework, no DOM. */
import type { Alarm, ApiEvent, Evacuation, Headcount, Live, LiveMessage } from "../api/types";
import { ServerClock } from "./clock";
import { Subject, keyOf } from "./subject";

/** What has changed, for whoever watches. */
export type Change = "all" | "positions" | "people" | "alarms" | "headcount" | "evacuation" | "event";
export type Listener = (change: Change, event?: ApiEvent) => void;

const SEVERITIES = ["critical", "high", "medium", "low"];
const COUNTED = new Set(["zone-entered", "zone-left", "level-changed", "went-below", "came-out", "tag-assigned"]);
/** Alarms that are shown after they were cleared. */
const CLEARED_KEPT = 200;

/** The worst and oldest first: unacknowledged before acknowledged. */
export function byUrgency(a: Alarm, b: Alarm): number {
  const waits = (alarm: Alarm) => (alarm.state === "raised" ? 0 : 1);
  return (
    waits(a) - waits(b) ||
    SEVERITIES.indexOf(a.severity) - SEVERITIES.indexOf(b.severity) ||
    Date.parse(a.raised) - Date.parse(b.raised)
  );
}

export class LiveState {
  readonly clock: ServerClock;
  readonly subjects = new Map<string, Subject>();
  /** Open ones, by number. */
  readonly alarms = new Map<number, Alarm>();
  /** Cleared while the console looked on, newest first. */
  cleared: Alarm[] = [];
  headcount: Headcount | null = null;
  evacuation: Evacuation | null = null;
  /** Where to go on after a break. */
  place: { run: string; event: number; tick: number } | null = null;
  /** Names of people by id, for labels. */
  readonly #names = new Map<string, string>();
  readonly #listeners = new Set<Listener>();

  constructor(private readonly wall: () => number = () => performance.now()) {
    this.clock = new ServerClock(wall);
  }

  watch(listener: Listener): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Forgets all: another user, another server. */
  clear(): void {
    this.subjects.clear();
    this.alarms.clear();
    this.cleared = [];
    this.headcount = null;
    this.evacuation = null;
    this.place = null;
    this.#tell("all");
  }

  name(people: Iterable<readonly [id: string, name: string]>): void {
    for (const [id, name] of people) {
      this.#names.set(id, name);
      const subject = this.subjects.get(keyOf(id, null));
      if (subject) subject.name = name;
    }
    this.#tell("people");
  }

  nameOf(person: string): string {
    return this.#names.get(person) ?? person;
  }

  knows(person: string): boolean {
    return this.#names.has(person);
  }

  /** How long a circle stands as the server told it, ms of its time: longer than it is asked anew. */
  patienceMs = 5000;

  /** Everybody as the server knows them now: who rests, how far circles have grown. Who is gone is told by events. */
  refresh(live: Live[]): void {
    const wall = this.wall();
    for (const one of live) this.subjects.get(keyOf(one.person, one.tag))?.take(one, wall);
    this.#tell("positions");
  }

  /** Whether somebody has no new fix for so long, ms of the server's time. */
  quietFor(ms: number): boolean {
    const since = this.clock.now() - ms;
    for (const subject of this.subjects.values()) if (subject.fixMs < since) return true;
    return false;
  }

  setHeadcount(headcount: Headcount): void {
    this.headcount = headcount;
    this.#tell("headcount");
  }

  setEvacuation(evacuation: Evacuation | null): void {
    this.evacuation = evacuation;
    this.#tell("evacuation");
  }

  take(message: LiveMessage): void {
    switch (message.type) {
      case "snapshot":
        this.#snapshot(message);
        break;
      case "resumed":
        this.place = { run: message.run, event: message.event, tick: message.tick };
        this.clock.set(message.time, message.clock_speed);
        break;
      case "positions": {
        if (this.place) this.place.tick = message.tick;
        const wall = this.wall();
        let appeared = false;
        for (const moved of message.positions) {
          const key = keyOf(moved.person, moved.tag);
          let subject = this.subjects.get(key);
          if (!subject) {
            subject = this.#add(key, moved.person);
            appeared = true;
          }
          subject.move(moved, wall);
        }
        this.#tell(appeared ? "people" : "positions");
        break;
      }
      case "event":
        if (this.place) this.place.event = message.number;
        this.#event(message.body);
        break;
    }
  }

  #snapshot(message: Extract<LiveMessage, { type: "snapshot" }>): void {
    this.place = { run: message.run, event: message.event, tick: message.tick };
    this.clock.set(message.time, message.clock_speed);
    const wall = this.wall();
    const present = new Set<string>();
    for (const live of message.live) {
      const key = keyOf(live.person, live.tag);
      present.add(key);
      const subject = this.subjects.get(key) ?? this.#add(key, live.person ?? null);
      // A server that came back from its snapshot may be a little behind: what it says counts.
      if (live.last_known && Date.parse(live.last_known.time) < subject.fixMs) subject.fixMs = 0;
      subject.take(live, wall);
    }
    for (const key of this.subjects.keys()) if (!present.has(key)) this.subjects.delete(key);
    this.alarms.clear();
    for (const alarm of message.alarms) this.alarms.set(alarm.id, alarm);
    this.headcount = message.headcount;
    this.evacuation = message.evacuation;
    this.#trouble();
    this.#tell("all");
  }

  #add(key: string, person: string | null): Subject {
    const subject = new Subject(key);
    subject.person = person;
    subject.name = person === null ? key.slice(2) : this.nameOf(person);
    this.subjects.set(key, subject);
    return subject;
  }

  #event(event: ApiEvent): void {
    const key = keyOf(event.person, event.tag);
    const subject = this.subjects.get(key);
    switch (event.event) {
      case "zone-entered":
        subject?.zones.add(event.zone ?? "");
        break;
      case "zone-left":
        subject?.zones.delete(event.zone ?? "");
        break;
      case "level-changed":
        if (subject) subject.level = event.to_level ?? null;
        break;
      case "went-below":
        if (event.person != null || event.tag != null) {
          const below = subject ?? this.#add(key, event.person ?? null);
          below.sinceMs = event.shift_since ? Date.parse(event.shift_since) : 0;
          below.kind = event.kind ?? below.kind;
        }
        break;
      case "came-out":
        this.subjects.delete(key);
        break;
      case "contact-lost":
        if (subject) subject.inContact = false;
        break;
      case "contact-regained":
        if (subject) subject.inContact = true;
        break;
      case "tag-assigned":
        this.subjects.delete(keyOf(null, event.tag));
        break;
      case "alarm-raised":
      case "alarm-escalated":
      case "alarm-acknowledged":
      case "alarm-cleared":
        if (event.alarm) this.#alarm(event.alarm);
        break;
      case "alarm-commented": {
        const alarm = this.alarms.get(event.alarm_id ?? -1) ?? this.cleared.find((it) => it.id === event.alarm_id);
        const note = event.comment;
        if (alarm && note && !alarm.notes.some((known) => known.at === note.at && known.text === note.text)) {
          alarm.notes = [...alarm.notes, note];
        }
        break;
      }
      case "evacuation-stopped":
        this.evacuation = null;
        break;
    }
    if (COUNTED.has(event.event)) this.#tell("people");
    if (event.event.startsWith("alarm-")) this.#tell("alarms", event);
    if (event.event.startsWith("evacuation-")) this.#tell("evacuation", event);
    this.#tell("event", event);
  }

  #alarm(alarm: Alarm): void {
    if (alarm.state === "cleared") {
      this.alarms.delete(alarm.id);
      this.cleared = [alarm, ...this.cleared.filter((it) => it.id !== alarm.id)].slice(0, CLEARED_KEPT);
    } else {
      this.alarms.set(alarm.id, alarm);
    }
    this.#trouble();
  }

  /** Who has an open alarm, for the map. */
  #trouble(): void {
    for (const subject of this.subjects.values()) subject.trouble = "none";
    for (const alarm of this.alarms.values()) {
      if (alarm.about !== "person" && alarm.about !== "tag") continue;
      const key = alarm.about === "person" ? keyOf(alarm.about_id, null) : keyOf(null, alarm.about_id);
      const subject = this.subjects.get(key);
      if (!subject) continue;
      const urgent = alarm.severity === "critical" || alarm.severity === "high";
      if (urgent) subject.trouble = "urgent";
      else if (subject.trouble === "none") subject.trouble = "known";
    }
  }

  /** Whether an event changes how many are where. */
  static counts(event: ApiEvent): boolean {
    return COUNTED.has(event.event);
  }

  #tell(change: Change, event?: ApiEvent): void {
    for (const listener of this.#listeners) listener(change, event);
  }
}
