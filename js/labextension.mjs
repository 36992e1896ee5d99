/**
 * The extension of JupyterLab: a container of module federation, as JupyterLab's own builder makes it with webpack.
 * It has two functions, `init`, which is told what the page shares, and `get`; what it shares, it does not bring.
 */

import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const OUT = "labextension";
const NAME = "lrp-jupyter";
const SHARED = /^(@(jupyterlab|lumino)\/|@codemirror\/(language|state|view)$|@lezer\/(common|highlight)$)/;

/** The container; it asks for what is shared when its module is made, when every extension has said what it shares. */
const wrapped = (names, css, code) => `\
(globalThis._JUPYTERLAB ??= {})[${JSON.stringify(NAME)}] = (() => {
  const css = ${JSON.stringify(css)};
  const names = ${JSON.stringify(names)};
  let scope;
  async function shared(name) {
    const all = scope[name];
    const newer = (a, b) => !!all[a].loaded - !!all[b].loaded || a.localeCompare(b, "en", { numeric: true });
    return [name, (await all[Object.keys(all).sort(newer).at(-1)].get())()];
  }
  return {
    init(shared) {
      scope = shared;
    },
    async get() {
      const packages = new Map(await Promise.all(names.map(shared)));
      const module = { exports: {} };
      document.head.append(Object.assign(document.createElement("style"), { textContent: css }));
      ((require, module) => {
${code}
      })((name) => packages.get(name), module);
      return () => module.exports;
    },
  };
})();
`;

export async function labextension(options, licences) {
  const { outputFiles, metafile } = await build({
    ...options,
    entryPoints: ["src/jupyter/index.ts"],
    outdir: OUT,
    format: "cjs",
    minify: true,
    metafile: true,
    write: false,
    logLevel: "info",
    plugins: [
      {
        name: "shared",
        setup: ({ onResolve }) => onResolve({ filter: SHARED }, ({ path }) => ({ path, external: true })),
      },
    ],
  });
  const [css, code] = [".css", ".js"].map((end) =>
    outputFiles.find(({ path }) => path.endsWith(end)).text.trim(),
  );
  const asked = Object.values(metafile.outputs).flatMap(({ imports }) => imports);
  const names = new Set(asked.filter(({ external }) => external).map(({ path }) => path));
  const text = wrapped([...names].sort(), css, code);
  const file = `static/remoteEntry.${createHash("sha256").update(text).digest("hex").slice(0, 16)}.js`;
  rmSync(OUT, { recursive: true, force: true });
  mkdirSync(`${OUT}/static`, { recursive: true });
  writeFileSync(`${OUT}/${file}`, text);
  writeFileSync(
    `${OUT}/static/THIRD-PARTY-LICENSES.txt`,
    licences("remoteEntry.js", Object.keys(metafile.inputs)),
  );
  const { version, license } = JSON.parse(readFileSync("package.json", "utf8"));
  const about = {
    name: NAME,
    version,
    license,
    jupyterlab: { _build: { load: file, extension: "./extension" } },
  };
  writeFileSync(`${OUT}/package.json`, `${JSON.stringify(about, null, 2)}\n`);
  const manager = {
    packageManager: "python",
    packageName: NAME,
    uninstallInstructions: `pip uninstall ${NAME}`,
  };
  writeFileSync(`${OUT}/install.json`, `${JSON.stringify(manager, null, 2)}\n`);
}
