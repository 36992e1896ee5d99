/** Bundles the lab into one module and one stylesheet in `lrp_jupyter/static`; the same input gives the same bytes. */

import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";
import { build, context } from "esbuild";
import { ownNames } from "./mangle.mjs";

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

const options = {
  entryPoints: [
    { in: "src/index.ts", out: "lab" },
    { in: "src/style/lab.css", out: "lab" },
  ],
  outdir: OUT,
  bundle: true,
  format: "esm",
  target: ["es2022", "chrome123", "firefox120", "safari17.5"],
  charset: "utf8",
  legalComments: "none",
};

if (process.argv.includes("--watch")) {
  await (await context({ ...options, sourcemap: "inline", logLevel: "info" })).watch();
} else {
  const { outputFiles } = await build({ ...options, write: false });
  const names = ownNames(outputFiles.find(({ path }) => path.endsWith(".js")).text);
  await build({
    ...options,
    minify: true,
    mangleProps: new RegExp(`^(?:${names.join("|")})$`),
    logLevel: "info",
  });
  const bundle = readFileSync(`${OUT}/lab.js`, "utf8");
  if (statSync(`${OUT}/lab.js`).size > LIMIT) throw new Error(`lab.js is larger than ${LIMIT} bytes`);
  if (/https?:\/\/(cdn|unpkg|esm)\b/.test(bundle)) throw new Error("lab.js loads from elsewhere");
}
