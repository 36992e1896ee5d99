import { readdirSync, readFileSync } from "node:fs";
import { expect, it } from "vitest";

it("the styles ask with :has() for children only: for more, a browser looks again at every change of a running lab", () => {
  const folder = new URL("../src/style/", import.meta.url);
  for (const name of readdirSync(folder).filter((each) => each.endsWith(".css"))) {
    const css = readFileSync(new URL(name, folder), "utf8");
    expect(css.match(/:has\((?!> )[^)]*\)/g) ?? [], name).toEqual([]);
    expect(css.match(/\.lrp-(machines|panels?|editor|world|timeline)[^ ]*:has/g) ?? [], name).toEqual([]);
  }
});

it("what a saved picture holds has colours that every reader of SVG knows: what is mixed is for the pointer and the keyboard", () => {
  const css = readFileSync(new URL("../src/style/graph.css", import.meta.url), "utf8");
  const rules = [...css.matchAll(/([^{}]+)\{([^{}]*color-mix[^{}]*)\}/g)];
  const drawn = rules.filter(
    ([, selector, body]) => /fill|stroke/.test(body!) && !/:hover|:focus/.test(selector!),
  );
  expect(drawn.map(([, selector]) => selector!.trim())).toEqual([]);
});
