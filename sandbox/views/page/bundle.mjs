// Writes ../static: the same sources give the same bytes, on any machine.
import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "static");

await mkdir(out, { recursive: true });
await build({
  absWorkingDir: here,
  entryPoints: { app: "src/main.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["safari15", "chrome100", "firefox100"],
  charset: "utf8",
  legalComments: "none", // The licences are in a file of their own.
  logLevel: "warning",
});
await build({
  absWorkingDir: here,
  entryPoints: { app: "src/style.css" },
  outdir: out,
  bundle: true,
  minify: true,
  target: ["safari15", "chrome100", "firefox100"],
  logLevel: "warning",
});
await copyFile(join(here, "src", "index.html"), join(out, "index.html"));
const three = JSON.parse(await readFile(join(here, "node_modules/three/package.json"), "utf8"));
const text = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
await writeFile(
  join(out, "licences.txt"),
  `app.js contains parts of three.js ${three.version}, which comes under this licence:\n\n${text.trim()}\n`,
);
