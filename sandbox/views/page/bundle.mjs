// Writes ../static: the same sources give the same bytes, on any machine.
import { build } from "esbuild";
import { copyFile, cp, mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "static");

await mkdir(out, { recursive: true });
const folder = join(here, "../../words");
const languages = {};
for (const name of (await readdir(folder)).filter((name) => name.endsWith(".json")).sort())
  languages[name.slice(0, -5)] = JSON.parse(await readFile(join(folder, name), "utf8")).page;
/** Something of every language, by its code. */
const ofEach = (choose) =>
  Object.fromEntries(Object.entries(languages).map(([code, page]) => [code, choose(page)]));
/** Leaves the words of a headset out of the page that has none. */
const withoutHeadset = {
  name: "without the headset's words",
  setup: (build) =>
    build.onLoad({ filter: /[/\\]words[/\\]\w+\.json$/ }, async ({ path }) => {
      const { headset: _, ...others } = JSON.parse(await readFile(path, "utf8"));
      return { contents: JSON.stringify(others), loader: "json" };
    }),
};
/** Names that the sources import from three.js, save types. */
const fromThree = new Set();
for (const name of (await readdir(join(here, "src"))).filter((name) => name.endsWith(".ts")).sort())
  for (const [, names] of (await readFile(join(here, "src", name), "utf8")).matchAll(/import \{([^}]*)\} from "three"/g))
    for (const one of names.split(",").map((one) => one.trim()))
      if (one && !one.startsWith("type ")) fromThree.add(one.split(" as ")[0]);
/** Both pages take three.js from a file of its own. */
const sharedThree = {
  name: "shared three.js",
  setup: (build) => {
    build.onResolve({ filter: /^three$/ }, () => ({ path: "three", namespace: "shared" }));
    build.onLoad({ filter: /.*/, namespace: "shared" }, () => ({ contents: "module.exports = THREE;" }));
  },
};
await build({
  absWorkingDir: here,
  stdin: { contents: `export { ${[...fromThree].sort().join(", ")} } from "three";`, resolveDir: here },
  outfile: join(out, "three.js"),
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "THREE",
  target: ["safari15", "chrome100", "firefox100"],
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
});
await build({
  absWorkingDir: here,
  plugins: [withoutHeadset, sharedThree],
  entryPoints: { app: "src/main.ts", early: "src/early.ts" },
  define: { PREPARING: JSON.stringify(ofEach((page) => page.preparing)) },
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
  plugins: [sharedThree],
  entryPoints: { headset: "src/headset.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome100"],
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
});
await build({
  absWorkingDir: here,
  entryPoints: { app: "src/style.css", headset: "src/headset.css" },
  outdir: out,
  bundle: true,
  minify: true,
  target: ["safari15", "chrome100", "firefox100"],
  logLevel: "warning",
});
const needs = Object.entries(ofEach((page) => page.needs_script));
const places = {
  needs_script: needs.map(([code, text]) => `<p lang="${code}">${text}</p>`).join(""),
  words: JSON.stringify(ofEach((p) => [p.return_title, p.return_how, p.return_no_code])),
};
for (const page of ["index.html", "headset.html", "return.html"]) {
  let text = await readFile(join(here, "src", page), "utf8");
  for (const [name, value] of Object.entries(places)) text = text.replaceAll(`{{${name}}}`, value);
  await writeFile(join(out, page), text);
}
await copyFile(join(here, "src/manifest.json"), join(out, "manifest.json"));
// Of the tasks, by `python -m tools.docs.task_pictures`.
await cp(join(here, "src/pictures"), join(out, "pictures"), { recursive: true });
const three = JSON.parse(await readFile(join(here, "node_modules/three/package.json"), "utf8"));
const text = await readFile(join(here, "node_modules/three/LICENSE"), "utf8");
await writeFile(
  join(out, "licences.txt"),
  `three.js contains parts of three.js ${three.version}, which comes under this licence:\n\n${text.trim()}\n`,
);
