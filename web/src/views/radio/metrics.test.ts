import { expect, test } from "vitest";
import { readMetrics } from "./metrics";

test("reads the server's counters, summed over labels", () => {
  const metrics = readMetrics(
    [
      "# TYPE adit_bad_packets_total counter",
      'adit_bad_packets_total{why="order"} 2',
      'adit_bad_packets_total{why="value"} 3',
      'adit_round_seconds_bucket{le="0.001"} 189',
      "adit_round_seconds_sum 0.125",
      "adit_round_seconds_count 250",
      "adit_feed_viewers 4",
    ].join("\n"),
  );
  expect(metrics).toEqual({ entries: 0, badPackets: 5, badBatches: 0, viewers: 4, roundMs: 0.5, commitMs: null });
});
