import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vite";

/** `npm run dev`: the server that answers the API. */
const server = process.env["ADIT_URL"] ?? "http://127.0.0.1:8080";

const proxy = Object.fromEntries(
  ["/api", "/v2", "/metrics", "/health"].map((path) => [path, { target: server, ws: true }]),
);

export default defineConfig({
  base: "./",
  plugins: [svelte()],
  build: { target: "es2022", chunkSizeWarningLimit: 700, assetsInlineLimit: 0 },
  server: { proxy },
  preview: { proxy },
});
