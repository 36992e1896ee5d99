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
