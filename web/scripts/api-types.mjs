// Types of the API from a running server: ADIT_TOKEN=… npm run api-types -- http://127.0.0.1:8080 [--check]
import { readFileSync, writeFileSync } from "node:fs";
import openapiTS, { astToString } from "openapi-typescript";

const [url = "http://127.0.0.1:8080"] = process.argv.slice(2).filter((word) => !word.startsWith("--"));
const answer = await fetch(`${url}/api/v1/openapi.json`, {
  headers: { Authorization: `Bearer ${process.env.ADIT_TOKEN ?? ""}` },
});
if (!answer.ok) throw new Error(`${url}: ${answer.status} ${await answer.text()}`);
const file = new URL("../src/api/schema.d.ts", import.meta.url);
const head = "// Made by `npm run api-types` of the server's /api/v1/openapi.json. Not edited by hand.\n\n";
// The console names paths itself: of the file only the bodies are taken.
const { components, info, openapi } = await answer.json();
const text = head + astToString(await openapiTS({ components, info, openapi, paths: {} }));
if (process.argv.includes("--check")) {
  if (readFileSync(file, "utf8") !== text)
    throw new Error("src/api/schema.d.ts is not of this server: npm run api-types");
  console.log("src/api/schema.d.ts is that of the server");
} else {
  writeFileSync(file, text);
}
