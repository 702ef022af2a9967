/** Where somebody looks: kept in the address and in the browser, so that it is there after a reload or a restart of the server. */
import type { Spot } from "../map/mine-map";

const KEY = "adit.view";

export interface Place {
  level: string | null;
  spot: Spot | null;
  selected: string | null;
}

export function toQuery({ level, spot, selected }: Place): Record<string, string> {
  const query: Record<string, string> = { level: level ?? "all" };
  if (spot) query["at"] = `${spot.east.toFixed(1)},${spot.north.toFixed(1)},${spot.zoom.toFixed(2)}`;
  if (selected !== null) query["who"] = selected;
  return query;
}

export function fromQuery(query: Record<string, string>): Place | null {
  if (query["level"] === undefined) return null;
  const [east, north, zoom] = (query["at"] ?? "").split(",").map(Number);
  const spot = [east, north, zoom].every((part) => Number.isFinite(part))
    ? { east: east!, north: north!, zoom: zoom! }
    : null;
  return { level: query["level"] === "all" ? null : query["level"], spot, selected: query["who"] ?? null };
}

export function keep(mine: string, place: Place): void {
  try {
    localStorage.setItem(KEY, JSON.stringify({ mine, query: toQuery({ ...place, selected: null }) }));
  } catch {
    // Not kept: the view begins with the whole mine next time.
  }
}

export function kept(mine: string): Place | null {
  try {
    const stored = JSON.parse(localStorage.getItem(KEY) ?? "null") as {
      mine: string;
      query: Record<string, string>;
    } | null;
    return stored?.mine === mine ? fromQuery(stored.query) : null;
  } catch {
    return null;
  }
}
