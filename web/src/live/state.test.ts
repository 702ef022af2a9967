import { describe, expect, test } from "vitest";
import type { Alarm, Live, LiveMessage, Moved } from "../api/types";
import { LiveState, byUrgency } from "./state";

const TIME = "2026-11-23T01:00:00.000Z";

function where(east: number, extra: Partial<Moved> = {}): Moved {
  return {
    person: "p1",
    tag: "t1",
    time: TIME,
    position_m: [east, 0, 0],
    velocity_m_s: null,
    radius_95_m: 2,
    radius_now_m: 2,
    protection_level_m: 6,
    quality: "fixed",
    method: "fused",
    level: "l1",
    age_s: 0,
    ...extra,
  };
}

function below(person: string, east: number): Live {
  const last_known = where(east, { tag: `tag of ${person}` });
  return {
    person,
    tag: null,
    kind: "person",
    state: "below",
    since: TIME,
    last_known,
    zones: [],
    possible_zones: [],
    in_contact: true,
    alarms: [],
  };
}

function alarm(id: number, extra: Partial<Alarm> = {}): Alarm {
  return {
    id,
    kind: "distress",
    about: "person",
    about_id: "p1",
    severity: "critical",
    state: "raised",
    escalation: 0,
    raised: TIME,
    since: TIME,
    notes: [],
    ...extra,
  };
}

function snapshot(live: Live[], alarms: Alarm[] = []): LiveMessage {
  const none = { people: 0, unassigned_tags: 0, vehicles: 0, assets: 0 };
  return {
    type: "snapshot",
    run: "r1",
    event: 10,
    tick: 20,
    time: TIME,
    live,
    alarms,
    headcount: { mine: { ...none, people: live.length }, levels: [], zones: [], out_of_contact: 0 },
    evacuation: null,
  };
}

function started(live = [below("p1", 0)], alarms: Alarm[] = []): LiveState {
  const state = new LiveState(() => 1000);
  state.take(snapshot(live, alarms));
  return state;
}

describe("the live state", () => {
  test("knows where to go on after each message", () => {
    const state = started();
    state.take({ type: "positions", tick: 21, positions: [] });
    state.take({ type: "event", number: 11, body: { event: "zone-entered", person: "p1", zone: "z" } });
    expect(state.place).toEqual({ run: "r1", event: 11, tick: 21 });
  });

  test("a person who was not known appears with the first position", () => {
    const state = started([]);
    state.take({ type: "positions", tick: 1, positions: [where(5, { person: "p9" })] });
    expect(state.subjects.get("p:p9")?.place).toEqual([5, 0]);
  });

  test("a late position changes nothing", () => {
    const state = started();
    state.take({ type: "positions", tick: 1, positions: [where(7, { time: "2026-11-23T01:00:02.000Z" })] });
    state.take({ type: "positions", tick: 2, positions: [where(1, { time: "2026-11-23T01:00:01.000Z" })] });
    expect(state.subjects.get("p:p1")?.place).toEqual([7, 0]);
  });

  test("who came out is below no more, and a snapshot leaves out who is gone", () => {
    const state = started([below("p1", 0), below("p2", 0)]);
    state.take({ type: "event", number: 11, body: { event: "came-out", person: "p2" } });
    expect([...state.subjects.keys()]).toEqual(["p:p1"]);
    state.take(snapshot([below("p3", 0)]));
    expect([...state.subjects.keys()]).toEqual(["p:p3"]);
  });

  test("a tag that is given to a person is not counted twice", () => {
    const state = started([]);
    state.take({ type: "positions", tick: 1, positions: [where(0, { person: null, tag: "t7" })] });
    state.take({ type: "event", number: 11, body: { event: "tag-assigned", person: "p7", tag: "t7" } });
    expect(state.subjects.has("t:t7")).toBe(false);
  });

  test("an alarm marks whom it is about until it is cleared", () => {
    const state = started();
    state.take({ type: "event", number: 11, body: { event: "alarm-raised", alarm: alarm(3) } });
    expect(state.subjects.get("p:p1")?.trouble).toBe("urgent");
    state.take({ type: "event", number: 12, body: { event: "alarm-cleared", alarm: alarm(3, { state: "cleared" }) } });
    expect(state.subjects.get("p:p1")?.trouble).toBe("none");
    expect(state.cleared.map((it) => it.id)).toEqual([3]);
  });

  test("a comment that is told twice stands once", () => {
    const state = started([below("p1", 0)], [alarm(3)]);
    const comment = { by: "admin", at: TIME, text: "called" };
    for (const number of [11, 12]) {
      state.take({ type: "event", number, body: { event: "alarm-commented", alarm_id: 3, comment } });
    }
    expect(state.alarms.get(3)?.notes).toEqual([comment]);
  });

  test("a server that came back a little behind is believed", () => {
    const state = started();
    state.take({ type: "positions", tick: 21, positions: [where(30, { time: "2026-11-23T01:00:09.000Z" })] });
    state.take(snapshot([below("p1", 12)]));
    expect(state.subjects.get("p:p1")?.place).toEqual([12, 0]);
  });
});

test("what waits and is worst stands first", () => {
  const list = [
    alarm(1, { severity: "low" }),
    alarm(2, { state: "acknowledged" }),
    alarm(3, { severity: "high" }),
    alarm(4),
  ];
  expect(list.sort(byUrgency).map((it) => it.id)).toEqual([4, 3, 1, 2]);
});

test("a circle grows as the server says: not of who rests, and by itself only when the server is silent", () => {
  const state = started();
  const subject = state.subjects.get("p:p1")!;
  const fix = Date.parse(TIME);
  const told = (motion: string, radius_now_m: number) => {
    const live = below("p1", 0);
    live.motion = { motion, since: TIME };
    live.last_known = { ...live.last_known!, radius_now_m, age_s: 60 };
    state.refresh([live]);
  };
  told("moving", 92);
  expect(subject.radiusAt(fix + 62_000, 5000)).toBe(92);
  expect(subject.radiusAt(fix + 70_000, 5000)).toBeCloseTo(92 + 15, 9);
  told("still", 2);
  expect(subject.radiusAt(fix + 600_000, 5000)).toBe(2);
});
