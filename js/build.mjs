/** Bundles the lab into one module and one stylesheet in `lrp_jupyter/static`; the same input gives the same bytes. */

import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { context } from "esbuild";

const OUT = "../lrp_jupyter/static";
const LIMIT = 500_000;

execFileSync("npx", [
  "--no-install",
  "lezer-generator",
  "--typeScript",
  "src/language/lrp.grammar",
  "-o",
  "src/language/parser.ts",
]);

const build = await context({
  entryPoints: { lab: "src/index.ts", "lab-style": "src/style/lab.css" },
  outdir: OUT,
  bundle: true,
  format: "esm",
  target: "es2022",
  minify: true,
  charset: "utf8",
  legalComments: "none",
  logLevel: "info",
});

if (process.argv.includes("--watch")) {
  await build.watch();
} else {
  await build.rebuild();
  await build.dispose();
  const size = statSync(`${OUT}/lab.js`).size;
  if (size > LIMIT) throw new Error(`lab.js has ${size} bytes, more than ${LIMIT}`);
  if (/https?:\/\/(cdn|unpkg|esm)/.test(readFileSync(`${OUT}/lab.js`, "utf8")))
    throw new Error("lab.js loads from elsewhere");
}
