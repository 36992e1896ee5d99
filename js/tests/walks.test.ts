// @vitest-environment happy-dom

import { readFileSync } from "node:fs";
import { Session } from "node:inspector/promises";
import { beforeAll, expect, it } from "vitest";
import { Page } from "./opened";
import recording from "./page/recording.json";

const DOCUMENT = readFileSync("../.github/CONTRIBUTING.md", "utf8");
const TOUR = DOCUMENT.split("\n## A contributor's tour\n")[1]!.split("\n## ")[0]!;

/** The functions of the page that the walks name, each with the end of its module's path where it is said. */
function named(): Map<string, string> {
  const found = new Map<string, string>();
  for (const [leg] of TOUR.matchAll(/(^\|.*\|\n)+/gm)) {
    let isPage = leg.split("\n")[2]!.startsWith("| `js/");
    for (const row of leg.split("\n").slice(2)) {
      if (row.startsWith("| —")) isPage = row.includes("*the page*");
      const names = isPage ? (row.split("|")[1]?.match(/`[^`]+`/g) ?? []) : [];
      for (const name of names) {
        const [, module = "", called] = /^`(?:(?:js\/)?(\S+): )?(?:\w+\.)?(\w+)`$/.exec(name)!;
        found.set(called!, module || (found.get(called!) ?? ""));
      }
    }
  }
  return found;
}

/** The functions that were called, with the modules that have them. */
const called = new Map<string, string[]>();

beforeAll(async () => {
  const session = new Session();
  session.connect();
  await session.post("Profiler.enable");
  await session.post("Profiler.startPreciseCoverage", { callCount: true, detailed: false });
  const page = await new Page().begin();
  page.type("; x\n");
  page.confirm();
  for (const frame of recording.frames) page.deliver(frame);
  await page.drawn();
  const { result } = await session.post("Profiler.takePreciseCoverage");
  for (const { url, functions } of result) {
    for (const { functionName, ranges } of functions) {
      if (ranges[0]!.count) called.set(functionName, [...(called.get(functionName) ?? []), url]);
    }
  }
  session.disconnect();
  page.close();
});

it.each([...named()])("%s is called, as a walk says (%s)", (name, module) => {
  expect(called.get(name)?.some((url) => url.endsWith(module))).toBe(true);
});
