/** People with names who walk along the roadways of a mine: put as positions of another system, through the whole server. */
import type { Mine, Point3, Roadway } from "../../src/api/types";
import type { Server } from "./server";

const GIVEN = [
  "Anna",
  "Bernd",
  "Carla",
  "David",
  "Elif",
  "Frank",
  "Greta",
  "Hannes",
  "Irina",
  "Jonas",
  "Katrin",
  "Lukas",
  "Mara",
  "Nils",
  "Olga",
  "Piotr",
];
const FAMILY = [
  "Berger",
  "Chen",
  "Dietz",
  "Ernst",
  "Fischer",
  "Günther",
  "Hartmann",
  "Ivanov",
  "Jansen",
  "Kowalski",
  "Lange",
  "Maier",
  "Novak",
  "Otto",
  "Peters",
];
const TEAMS = ["north", "south", "transport", "electrical", "rescue"];

/** Numbers that are the same in every run. */
function seeded(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

interface Hiker {
  tag: string;
  road: Roadway;
  /** Along the road, m, and which way. */
  at: number;
  pace: number;
  length: number;
  still: boolean;
}

function lengthOf(road: Roadway): number {
  let sum = 0;
  for (let i = 1; i < road.points_m.length; i += 1) sum += distance(road.points_m[i - 1]!, road.points_m[i]!);
  return sum;
}

function distance(a: Point3, b: Point3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

function along(road: Roadway, at: number): Point3 {
  let left = at;
  for (let i = 1; i < road.points_m.length; i += 1) {
    const [from, to] = [road.points_m[i - 1]!, road.points_m[i]!];
    const leg = distance(from, to);
    if (left <= leg || i === road.points_m.length - 1) {
      const share = leg > 0 ? Math.min(left / leg, 1) : 0;
      return [0, 1, 2].map((axis) => from[axis]! + (to[axis]! - from[axis]!) * share) as Point3;
    }
    left -= leg;
  }
  return road.points_m[0]!;
}

export const personId = (index: number) => `p${String(index + 1).padStart(4, "0")}`;
export const tagId = (index: number) => `t${String(index + 1).padStart(4, "0")}`;
export const personName = (index: number) =>
  `${GIVEN[index % GIVEN.length]} ${FAMILY[(index * 7 + Math.floor(index / 16)) % FAMILY.length]}`;

export class Crowd {
  readonly #hikers: Hiker[] = [];
  #timer: ReturnType<typeof setInterval> | undefined;
  #busy = false;

  private constructor(
    private readonly server: Server,
    private readonly mine: Mine,
  ) {}

  /** `named` of them are entered as people with a tag each; the others are tags that nobody is known to wear. */
  static async of(server: Server, count: number, named = count): Promise<Crowd> {
    const mine = await server.ask<Mine>("GET", "/api/v1/mine");
    const crowd = new Crowd(server, mine);
    const random = seeded(7);
    const roads = mine.roadways.filter((road) => road.level != null && road.kind !== "shaft");
    const lengths = roads.map(lengthOf);
    const total = lengths.reduce((sum, length) => sum + length, 0);
    for (let index = 0; index < count; index += 1) {
      let where = random() * total;
      let pick = 0;
      while (where > lengths[pick]!) where -= lengths[pick++]!;
      const pace = (random() < 0.5 ? -1 : 1) * (0.9 + random() * 0.7);
      crowd.#hikers.push({
        tag: tagId(index),
        road: roads[pick]!,
        at: where,
        pace,
        length: lengths[pick]!,
        still: false,
      });
    }
    const enter = async (index: number) => {
      await server.ask("POST", "/api/v1/tags", { id: tagId(index), worn: "helmet" });
      const person = {
        id: personId(index),
        name: personName(index),
        team: TEAMS[index % TEAMS.length],
        shift: "early",
      };
      await server.ask("POST", "/api/v1/people", person);
      await server.ask("POST", `/api/v1/tags/${tagId(index)}/assignments`, { person: personId(index) });
    };
    for (let from = 0; from < named; from += 40) {
      await Promise.all(Array.from({ length: Math.min(40, named - from) }, (_, index) => enter(from + index)));
    }
    return crowd;
  }

  /** A second goes by: everybody walks on, to the end of the roadway and back. */
  async step(seconds = 1): Promise<void> {
    const now = new Date().toISOString();
    const locations = this.#hikers.map((hiker) => {
      if (!hiker.still) hiker.at += hiker.pace * seconds;
      if (hiker.at < 0 || hiker.at > hiker.length) {
        hiker.pace = -hiker.pace;
        hiker.at = Math.min(Math.max(hiker.at, 0), hiker.length);
      }
      const [east, north, height] = along(hiker.road, hiker.at);
      const position = { type: "Point", coordinates: [east, north, height + 1] };
      return { provider_id: hiker.tag, position, accuracy: 1.5 + (hiker.at % 3), timestamp_generated: now };
    });
    for (let from = 0; from < locations.length; from += 500) {
      await this.server.ask("PUT", "/v2/providers/locations", locations.slice(from, from + 500));
    }
  }

  walk(): void {
    this.#timer ??= setInterval(() => {
      if (this.#busy) return;
      this.#busy = true;
      this.step()
        .catch(() => undefined)
        .finally(() => (this.#busy = false));
    }, 1000);
  }

  halt(): void {
    clearInterval(this.#timer);
    this.#timer = undefined;
  }

  /** Puts one at a place, where they stay. */
  async place(index: number, at: Point3): Promise<void> {
    const hiker = this.#hikers[index]!;
    hiker.road = { ...hiker.road, points_m: [at, [at[0] + 0.01, at[1], at[2]]] };
    [hiker.at, hiker.length, hiker.still] = [0, 0.01, true];
    await this.step(0);
  }

  /** Takes some away: they are not heard any more. */
  silence(from: number, until: number): void {
    this.#hikers.splice(from, until - from);
  }

  get mineName(): string {
    return this.mine.name;
  }
}

/** Somebody presses the button for help, as their tag tells it through a gateway. */
export async function press(server: Server, tag: string): Promise<void> {
  const packets = [{ tag, distress: true, battery: 0.63, observations: [] }];
  await server.ask("POST", "/api/v1/gateways/g-test/observations", { boot: Date.now(), sequence: 1, packets });
}
