// Writes templates/viewer/viewer.js: the script of all pages, with three.js and uPlot inside, and their licences.
//
// `make viewer` runs it after `npm ci`. The first line has a digest of everything that goes in, which a test compares.

import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const here = (path) => new URL(path, import.meta.url).pathname;
const read = (path) => readFileSync(here(path), "utf8");

const sources = ["build.mjs", "package.json", "package-lock.json", ...readdirSync(here("src")).sort().map((name) => `src/${name}`)];
const digest = createHash("sha256");
for (const name of sources) digest.update(`${name}\n${read(name)}\n`);

const licences = ["three", "uplot"].map((name) => `${name} ${JSON.parse(read(`node_modules/${name}/package.json`)).version}\n\n${read(`node_modules/${name}/LICENSE`).trim()}\n`);
const result = await build({
  entryPoints: [here("src/index.js")],
  bundle: true,
  minify: true,
  format: "iife",
  globalName: "kanegenViewer",
  target: "es2022",
  loader: { ".css": "text" },
  legalComments: "none",
  charset: "ascii",
  write: false,
});
const banner = `/* kanegen viewer ${digest.digest("hex")}\n   with three.js and uPlot under the MIT License, see LICENSES.txt beside this file. */\n`;
writeFileSync(here("../templates/viewer/viewer.js"), banner + result.outputFiles[0].text);
writeFileSync(here("../templates/viewer/LICENSES.txt"), licences.join("\n---\n\n"));
