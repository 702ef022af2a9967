// Size of the console as it goes over the wire: fails above the limit.
import { readFileSync, readdirSync } from "node:fs";
import { gzipSync } from "node:zlib";

const LIMIT_KB = 600;
const dist = new URL("../dist/", import.meta.url);
const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
const sizes = files.map((file) => {
  const bytes = readFileSync(`${file.parentPath}/${file.name}`);
  return { name: file.name, gzip: gzipSync(bytes, { level: 9 }).length };
});
sizes.sort((a, b) => b.gzip - a.gzip);
const total = sizes.reduce((sum, file) => sum + file.gzip, 0);
for (const { name, gzip } of sizes.slice(0, 8)) console.log(`${(gzip / 1000).toFixed(1).padStart(8)} kB gzip  ${name}`);
console.log(`${(total / 1000).toFixed(1).padStart(8)} kB gzip  in all, ${files.length} files (limit ${LIMIT_KB})`);
if (total > LIMIT_KB * 1000) process.exit(1);
