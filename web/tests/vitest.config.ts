import { defineConfig } from "vitest/config";

/** One real browser and one real server at a time: two cores. */
export default defineConfig({
  root: import.meta.dirname,
  test: { include: ["**/*.test.ts"], fileParallelism: false, testTimeout: 120_000, hookTimeout: 120_000, retry: 0 },
});
