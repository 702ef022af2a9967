/** What the console shows of the server's counters, from the text that Prometheus reads. */
export interface Metrics {
  entries: number;
  badPackets: number;
  badBatches: number;
  viewers: number;
  /** Mean of a round of estimators, ms. */
  roundMs: number | null;
  /** Mean of writing to the store, ms. */
  commitMs: number | null;
}

export function readMetrics(text: string): Metrics {
  const sums = new Map<string, number>();
  for (const line of text.split("\n")) {
    const found = /^(\w+)(?:\{[^}]*\})?\s+(\S+)/.exec(line);
    if (!found || line.startsWith("#")) continue;
    const value = Number(found[2]);
    if (Number.isFinite(value)) sums.set(found[1]!, (sums.get(found[1]!) ?? 0) + value);
  }
  const of = (name: string) => sums.get(name) ?? 0;
  const mean = (name: string) => {
    const count = of(`${name}_count`);
    return count > 0 ? (1000 * of(`${name}_sum`)) / count : null;
  };
  return {
    entries: of("adit_entries_total"),
    badPackets: of("adit_bad_packets_total"),
    badBatches: of("adit_bad_batches_total"),
    viewers: of("adit_feed_viewers"),
    roundMs: mean("adit_round_seconds"),
    commitMs: mean("adit_store_commit_seconds"),
  };
}
