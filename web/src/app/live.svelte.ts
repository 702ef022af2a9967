/** The live state for views: `LiveState` and its socket, with revisions that runes see. */
import { api } from "../api/client";
import type { Evacuation, Headcount, Live, LiveMessage, Mine, PersonNow, TagNow, ZoneNow } from "../api/types";
import { LiveSocket, type Link } from "../live/socket";
import { LiveState, byUrgency } from "../live/state";
import { refresh } from "./session.svelte";

export const state = new LiveState();

/** How often lists of people are drawn anew while they move, ms. */
const LISTS_MS = 1000;
const COUNTS_MS = 700;

/** Counted up when a part has changed: what a view reads, it is drawn anew with. */
export const revision = $state({ people: 0, alarms: 0, headcount: 0, evacuation: 0, second: 0, plan: 0, events: 0 });

export const connection = $state<{ link: Link; brokenAt: number }>({ link: "connecting", brokenAt: 0 });

/** The mine's plan and its zones; zones change while the server runs. */
export const site = $state<{ mine: Mine | null; zones: ZoneNow[]; teams: Map<string, string>; failed: string }>({
  mine: null,
  zones: [],
  teams: new Map(),
  failed: "",
});

export const alarms = {
  /** Open ones, the most urgent first. */
  get open() {
    void revision.alarms;
    return [...state.alarms.values()].sort(byUrgency);
  },
  get waiting() {
    return this.open.filter((alarm) => alarm.state === "raised");
  },
};

export const live = {
  get subjects() {
    void revision.people;
    return state.subjects;
  },
  get headcount(): Headcount | null {
    void revision.headcount;
    return state.headcount;
  },
  get evacuation(): Evacuation | null {
    void revision.evacuation;
    return state.evacuation;
  },
  /** The server's time, once a second. */
  get now(): number {
    void revision.second;
    void revision.people;
    return state.clock.known ? state.clock.now() : 0;
  },
};

export function nameOf(person: string | null | undefined, tag?: string | null): string {
  void revision.people;
  return person != null ? state.nameOf(person) : (tag ?? "–");
}

export function levelName(id: string | null | undefined): string {
  return site.mine?.levels.find((level) => level.id === id)?.name ?? id ?? "–";
}

export function zoneName(id: string | null | undefined): string {
  const zone = site.zones.find((now) => now.zone.id === id)?.zone;
  return zone?.name ?? id ?? "–";
}

/** Calls `then` at most once in so many milliseconds, and once after the last call. */
function seldom(ms: number, then: () => void): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  return () => {
    timer ??= setTimeout(() => {
      timer = undefined;
      then();
    }, ms);
  };
}

const peopleSeldom = seldom(LISTS_MS, () => (revision.people += 1));
const countSeldom = seldom(COUNTS_MS, () => void count());
const namesSeldom = seldom(500, () => void loadNames());

async function quietly(work: () => Promise<void>): Promise<void> {
  try {
    await work();
  } catch {
    // The bar of the connection says what is wrong; the next message brings it anew.
  }
}

function count(): Promise<void> {
  return quietly(async () => state.setHeadcount(await api.get<Headcount>("/api/v1/headcount")));
}

export function loadZones(): Promise<void> {
  return quietly(async () => {
    site.zones = await api.get<ZoneNow[]>("/api/v1/zones");
    revision.plan += 1;
  });
}

export function loadEvacuation(): Promise<void> {
  return quietly(async () => {
    const board = await api.get<{ evacuation?: Evacuation | null }>("/api/v1/evacuation");
    state.setEvacuation(board.evacuation ?? null);
  });
}

export function loadNames(): Promise<void> {
  return quietly(async () => {
    const people = await api.get<PersonNow[]>("/api/v1/people");
    site.teams = new Map(people.map(({ person }) => [person.id, person.team ?? ""]));
    state.name(people.map(({ person }) => [person.id, person.name || person.id] as const));
  });
}

/** Positions come when somebody moves; who rests, and how circles grow, is asked for. A crowd is asked for less often. */
let askedAt = 0;
async function refreshQuiet(): Promise<void> {
  const every = state.subjects.size > 500 ? 10_000 : 3000;
  state.patienceMs = 1.6 * every * state.clock.speed;
  if (performance.now() - askedAt < every || !state.quietFor(2500 * state.clock.speed)) return;
  askedAt = performance.now();
  await quietly(async () => state.refresh(await api.get<Live[]>("/api/v1/live")));
}

/** Kinds of tags that nobody wears: a vehicle is drawn as one. */
export async function loadTags(): Promise<TagNow[]> {
  return api.get<TagNow[]>("/api/v1/tags");
}

/** People who were seen without a name are asked for once. */
const asked = new Set<string>();
function strangers(message: LiveMessage): void {
  const seen = message.type === "positions" ? message.positions : message.type === "snapshot" ? message.live : [];
  for (const { person } of seen) {
    if (person == null || state.knows(person) || asked.has(person)) continue;
    asked.add(person);
    namesSeldom();
  }
}

let socket: LiveSocket | null = null;

/** Begins to watch; to be called when somebody has logged in. */
export function start(): () => void {
  const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/v1/live/socket`;
  const unwatch = state.watch((change, event) => {
    if (change === "all" || change === "people") revision.people += 1;
    if (change === "positions") peopleSeldom();
    if (change === "all" || change === "alarms") revision.alarms += 1;
    if (change === "all" || change === "headcount") revision.headcount += 1;
    if (change === "all" || change === "evacuation") revision.evacuation += 1;
    if (change === "event") {
      revision.events += 1;
      if (event && LiveState.counts(event)) countSeldom();
      if (event?.event === "evacuation-started") void loadEvacuation();
    }
  });
  socket = new LiveSocket({
    url,
    place: () => state.place,
    message: (message) => {
      state.take(message);
      strangers(message);
      if (message.type === "snapshot") void loadZones();
    },
    link: (link) => {
      if (link === "broken" && connection.link !== "broken") connection.brokenAt = performance.now();
      connection.link = link;
    },
    allowed: async () => (await refresh()) || connection.link === "broken",
  });
  socket.start();
  const hurry = () => socket?.hurry();
  addEventListener("online", hurry);
  const seconds = setInterval(() => {
    revision.second += 1;
    if (state.evacuation && revision.second % 2 === 0) void loadEvacuation();
    void refreshQuiet();
    if (revision.second % 15 === 0) countSeldom();
    // Others may draw zones too, and nothing tells of it.
    if (revision.second % 30 === 0) void loadZones();
  }, 1000);
  void loadMine();
  void loadNames();
  return () => {
    unwatch();
    removeEventListener("online", hurry);
    clearInterval(seconds);
    socket?.stop();
    socket = null;
    asked.clear();
    state.clear();
  };
}

export async function loadMine(): Promise<void> {
  try {
    site.mine = await api.get<Mine>("/api/v1/mine");
    site.failed = "";
    revision.plan += 1;
  } catch (error) {
    site.failed = error instanceof Error ? error.message : String(error);
    setTimeout(() => void loadMine(), 3000);
  }
}
