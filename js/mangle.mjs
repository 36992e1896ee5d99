/**
 * Names of properties that a bundle may shorten: those that are only its own affair.
 *
 * A third of a bundled CodeMirror are names of properties, which no minifier touches, because a name may
 * be meant for the browser, come over the wire, or be put together at run time. Left alone are therefore:
 * every word of the browser's and the language's own types, every name that stands anywhere in a string,
 * every word of the wire's types and of `dataset`, every name that is only read and never defined, and
 * every name without a capital, which may be an attribute or an event.
 */

import { readdirSync, readFileSync } from "node:fs";

const WORD = /[A-Za-z_$][\w$]*/g;
const TYPES = "node_modules/typescript/lib";
const WIRE = ["src/nouns.ts", "src/protocol.ts", "src/graph/layout.ts", "src/session/state.ts"];
const SHORTEST = 4;

function words(text) {
  return text.match(WORD) ?? [];
}

/** The names to shorten in a bundle that is not minified yet, in the order of the alphabet. */
export function ownNames(bundle) {
  const foreign = new Set(["default", "render", "constructor"]);
  for (const file of readdirSync(TYPES)) {
    if (/^lib\..*\.d\.ts$/.test(file))
      for (const word of words(readFileSync(`${TYPES}/${file}`, "utf8"))) foreign.add(word);
  }
  for (const file of WIRE) for (const word of words(readFileSync(file, "utf8"))) foreign.add(word);
  for (const [, , text] of bundle.matchAll(/(["'`])((?:(?!\1)[^\\\n]|\\.)*)\1/g)) {
    for (const word of text.split(/[\s.]+/)) foreign.add(word);
  }
  for (const [, word] of bundle.matchAll(/dataset\.(\w+)/g)) foreign.add(word);
  const own = new Set();
  for (const match of bundle.matchAll(
    /(?:\.|^\s+(?:static |get |set |async )*|[{,]\s*)([A-Za-z_$][\w$]*)\s*(?:=[^=>]|[(:])/gm,
  )) {
    const name = match[1];
    if (name.length >= SHORTEST && /[A-Z]/.test(name) && !foreign.has(name)) own.add(name);
  }
  return [...own].sort();
}
