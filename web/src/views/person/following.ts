/** What the server tells of how a tag is followed, read for people. */
import type { Following } from "../../api/types";
import type { Sight } from "../../map/link-layer";

export interface Counts {
  packets: number;
  observations: number;
  fixes: number;
  late: number;
  repeated: number;
  refused: number;
  restarts: number;
}

const object = (value: unknown): Record<string, unknown> =>
  typeof value === "object" && value !== null ? (value as Record<string, unknown>) : {};
const count = (value: unknown): number => (typeof value === "number" && Number.isFinite(value) ? value : 0);

export function countsOf(following: Following): Counts {
  const counts = object(following.counts);
  return {
    packets: count(counts["packets"]),
    observations: count(counts["observations"]),
    fixes: count(counts["fixes"]),
    late: count(counts["late_packets"]) + count(counts["late_readings"]),
    repeated: count(counts["repeated_packets"]),
    refused: count(counts["refused"]),
    restarts: count(counts["restarts"]),
  };
}

export interface Innovations {
  /** Normalised innovations squared, summed and counted; 1 in the mean where the method knows its errors. */
  sum: number;
  count: number;
  /** Observations that were not believed. */
  outliers: number;
  solutions: number;
  reckoned: number;
  carried: string | null;
  warnings: string[];
}

export function innovationsOf(following: Following): Innovations {
  const report = object(following.method_report);
  const carried = object(report["process"])["carried"];
  const warnings = Array.isArray(report["warnings"])
    ? report["warnings"].map((it) => (typeof it === "string" ? it : JSON.stringify(it)))
    : [];
  return {
    sum: count(report["nis_sum"]),
    count: count(report["nis_count"]),
    outliers: count(report["outliers"]),
    solutions: count(report["solutions"]),
    reckoned: count(report["reckoned_solutions"]),
    carried: typeof carried === "string" ? carried : null,
    warnings,
  };
}

/** Numbers and words of the report that have no place of their own, flat: `a.b` → value. */
export function restOf(report: unknown, known: Set<string>): [string, string][] {
  const rest: [string, string][] = [];
  const walk = (value: unknown, path: string): void => {
    if (rest.length > 60 || known.has(path)) return;
    if (typeof value === "object" && value !== null && !Array.isArray(value)) {
      for (const [key, inner] of Object.entries(value)) walk(inner, path === "" ? key : `${path}.${key}`);
    } else if (path !== "") {
      const plain =
        typeof value === "number"
          ? String(Number(value.toPrecision(5)))
          : typeof value === "string"
            ? value
            : JSON.stringify(value);
      rest.push([path, plain]);
    }
  };
  walk(report, "");
  return rest;
}

export interface Sample {
  /** Middle of the bin, s. */
  time: number;
  /** Mean normalised innovation squared; null where nothing counted. */
  nis: number | null;
  outliers: number;
}

/** The last ten minutes, as the server has kept them. */
export function courseOf(following: Following): Sample[] {
  const { innovations } = following;
  if (!innovations) return [];
  const { bins, bin_s } = innovations;
  const end = Date.parse(innovations.until) / 1000;
  return bins.map((bin, index) => ({
    time: end - (bins.length - index - 0.5) * bin_s,
    nis: bin.mean_nis ?? null,
    outliers: bin.outliers,
  }));
}

export type HeardSource = Following["heard"][number];

export const sightOf = (source: HeardSource): Sight =>
  source.line_of_sight == null ? "not-judged" : source.line_of_sight >= 0.5 ? "clear" : "blocked";

/** Ranges first, the nearest on top; then signals, the strongest on top. */
export function byNearness(a: HeardSource, b: HeardSource): number {
  if (a.kind !== b.kind) return a.kind === "range" ? -1 : 1;
  return a.kind === "range" ? (a.range_m ?? 0) - (b.range_m ?? 0) : (b.rssi_dbm ?? 0) - (a.rssi_dbm ?? 0);
}
