/**
 * Bundles the lab into one module and one stylesheet in `lrp_jupyter/static`, with the licences of the
 * packages that are in it; the same input gives the same bytes.
 */

import { createHash } from "node:crypto";
import { copyFileSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { build, context } from "esbuild";
import { labextension } from "./labextension.mjs";

const OUT = "../lrp_jupyter/static";
const LIMIT = 880_000;
const PACKAGE_IMPORT = /^import \{([^}]*)\} from "(@(?:codemirror|lezer)\/[^"]+)"/gm;

const options = {
  entryPoints: [
    { in: "src/index.ts", out: "lab" },
    { in: "src/style/lab.css", out: "lab" },
  ],
  outdir: OUT,
  bundle: true,
  format: "esm",
  target: ["es2022", "chrome123", "firefox120", "safari17.5"],
  charset: "ascii", // one byte for each character in the memory of a page
  legalComments: "none", // the licences stand in a file of their own
  preserveSymlinks: true,
};

/**
 * The packages as one module with short names, holding what our own modules import from them. Our own modules
 * keep their names, so that what a traceback says can be found in them.
 */
async function packages() {
  const wanted = new Set();
  for (const file of readdirSync("src", { recursive: true }).filter((name) =>
    /^(?!jupyter).*\.ts$/.test(name),
  )) {
    for (const [, names, from] of readFileSync(`src/${file}`, "utf8").matchAll(PACKAGE_IMPORT)) {
      for (const name of names.split(",").map((each) => each.trim()))
        if (name && !name.startsWith("type ")) wanted.add(`export { ${name} } from "${from}";`);
    }
  }
  const contents = [...wanted].sort().join("\n");
  const stdin = { contents, resolveDir: "." };
  const { outputFiles, metafile } = await build({
    ...options,
    entryPoints: [],
    stdin,
    minify: true,
    metafile: true,
    write: false,
  });
  return { code: outputFiles[0].text, inputs: Object.keys(metafile.inputs) };
}

/** Replaces the packages by their one module. */
const bundled = (code) => ({
  name: "bundled-packages",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^@(codemirror|lezer)\// }, () => ({ path: "packages", namespace: "bundled" }));
    onLoad({ filter: /.*/, namespace: "bundled" }, () => ({ contents: code }));
  },
});

/**
 * The bundle, to be evaluated once in a page: every widget brings it in a module of its own, and what is
 * evaluated stays in memory as long as the page.
 */
function onlyOnce(code) {
  const name = JSON.stringify(`lrp-jupyter ${createHash("sha256").update(code).digest("hex").slice(0, 16)}`);
  const start = code.lastIndexOf("export{");
  const [, exported] = /^export\{([\w$]+) as default\};\s*$/.exec(code.slice(start)) ?? [];
  if (!exported) throw new Error("The bundle must export its default and nothing else");
  const body = `${code.slice(0, start)}return ${exported}`;
  return `export default globalThis[Symbol.for(${name})]??=(function(){"use strict";${body}})();\n`;
}

/** The licence of each package that the bundle holds, from the package's own folder. */
function licences(bundle, inputs) {
  const packages = new Set();
  for (const file of inputs) {
    const [, name] = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(file) ?? [];
    if (name) packages.add(name);
  }
  const texts = [...packages].sort().map((name) => {
    const folder = `node_modules/${name}`;
    const { version, license } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
    const file = readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
    if (!file) throw new Error(`${name} has no licence file`);
    return `${name} ${version} (${license})\n\n${readFileSync(`${folder}/${file}`, "utf8").trim()}\n`;
  });
  const line = `\n${"-".repeat(78)}\n\n`;
  return [`${bundle} contains code of the following packages.\n`, ...texts].join(line);
}

/** The plain page, its worker and its service worker, which `lrp site` copies beside the lab. */
async function site() {
  const outdir = `${OUT}/site`;
  const { metafile } = await build({
    ...options,
    entryPoints: ["page", "lesson", "worker", "cache"].map((name) => `src/site/${name}.ts`),
    outdir,
    minify: true,
    metafile: true,
    logLevel: "info",
  });
  for (const name of ["index.html", "page.css", "lesson.css"])
    copyFileSync(`src/site/${name}`, `${outdir}/${name}`);
  writeFileSync(`${outdir}/THIRD-PARTY-LICENSES.txt`, licences("page.js", Object.keys(metafile.inputs)));
}

/** The extension for Visual Studio Code, of which `lrp editor vscode` makes a package. */
async function vscode() {
  const outdir = "../lrp_jupyter/editors/vscode";
  const { metafile } = await build({
    entryPoints: ["src/vscode/extension.ts"],
    outdir,
    bundle: true,
    platform: "node",
    target: "node20",
    external: ["vscode"], // the editor's own
    minify: true,
    charset: "ascii",
    legalComments: "none",
    preserveSymlinks: true,
    metafile: true,
    logLevel: "info",
  });
  writeFileSync(`${outdir}/THIRD-PARTY-LICENSES.txt`, licences("extension.js", Object.keys(metafile.inputs)));
}

/** The page of a run, which `lrp run --serve` serves beside the lab. */
async function served() {
  const outdir = `${OUT}/served`;
  await build({ ...options, entryPoints: ["src/served/served.ts"], outdir, minify: true, logLevel: "info" });
  for (const name of ["index.html", "served.css"]) copyFileSync(`src/served/${name}`, `${outdir}/${name}`);
}

if (process.argv.includes("--watch")) {
  await (await context({ ...options, sourcemap: "inline", logLevel: "info" })).watch();
} else {
  const { code, inputs } = await packages();
  await build({
    ...options,
    plugins: [bundled(code)],
    minifyWhitespace: true,
    minifySyntax: true,
    logLevel: "info",
  });
  writeFileSync(`${OUT}/THIRD-PARTY-LICENSES.txt`, licences("lab.js", inputs));
  const bundle = onlyOnce(readFileSync(`${OUT}/lab.js`, "utf8"));
  writeFileSync(`${OUT}/lab.js`, bundle);
  if (statSync(`${OUT}/lab.js`).size > LIMIT) throw new Error(`lab.js is larger than ${LIMIT} bytes`);
  if (/https?:\/\/(cdn|unpkg|esm)\b/.test(bundle)) throw new Error("lab.js loads from elsewhere");
  await site();
  await vscode();
  await served();
  await labextension(options, licences);
}
