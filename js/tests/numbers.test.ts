// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { readable, readableNumber } from "../src/ui/numbers";
import { Page } from "./opened";

describe("a number for reading", () => {
  it.each([
    ["63.500000000000334", "63.50"],
    ["63.5", "63.5"],
    ["0.30000000000000004", "0.3000"],
    ["-1.3877787807814457e-17", "-1.388e-17"],
    ["12345.678", "12346"],
    ["999.96", "1000"],
    ["10000.0", "10000.0"],
    ["1732810000", "1732810000"],
    ["1.2345678e+20", "1.235e+20"],
    ["(1.0999999999999999, -0.6)", "(1.100, -0.6)"],
    ["{'A': 0.123456, 'v1.23456': None}", "{'A': 0.1235, 'v1.23456': None}"],
    ["'0.123456 isn\\'t 0.123456'", "'0.123456 isn\\'t 0.123456'"],
    ["(0.123456+1.123456j)", "(0.1235+1.123j)"],
    ["speed1(a1)", "speed1(a1)"],
    ["inf", "inf"],
    ["1.10.123456", "1.10.123456"],
  ])("%s is %s", (exact, shown) => expect(readable(exact)).toBe(shown));

  it("is as wide as the next one", () => {
    const shown = Array.from({ length: 50 }, (_, i) => readableNumber(63.123456789 - i * 0.1000001));
    expect(new Set(shown.map(({ length }) => length))).toEqual(new Set([5]));
  });
});

describe("a lab whose program counts in small steps", () => {
  const EXACT = "63.500000000000334";
  const TEXT = "(var battery := [70.0])\n(machine m (state s))\n(spawn m s)";
  let page: Page;
  beforeEach(async () => {
    page = new Page();
    const program = {
      ...{ variables: ["battery"], events: [] },
      machines: [
        {
          ...{ path: "m", parent: null, transitions: [], variables: [], events: [] },
          states: [{ path: "m/s", machines: [] }],
        },
      ],
    };
    const frame = {
      ...{ type: "frame", view: "", frame: 1, tick: 8, time: 0.7, status: "paused", program },
      ...{ machine: "m", active: ["m/s"], lit: ["m/s"], variables: { battery: [EXACT, Number(EXACT)] } },
    };
    page.open({ text: TEXT, running: TEXT, findings: [], frame: frame as never });
    await page.drawn();
  });
  afterEach(() => page.close());

  it("shows its values for reading, and has the exact one to edit and in the tooltip", () => {
    const value = page.find('[data-lrp-variable="battery"] .lrp-value');
    expect([value.textContent, value.title]).toEqual(["63.50", `${EXACT}\nClick: change`]);
    expect(page.find(".lrp-inline-value").textContent).toBe("63.50");
    value.click();
    expect((page.find('[data-lrp-variable="battery"] input') as HTMLInputElement).value).toBe(EXACT);
  });

  it("draws the changes of a truth value beside it", async () => {
    for (const [frame, time, text] of [
      [2, 1, "True"],
      [3, 9, "False"],
      [4, 16, "False"],
    ]) {
      page.deliver({ type: "frame", frame, tick: frame, time, variables: { battery: [text, null] } });
      await page.drawn();
    }
    const spark = page.find('[data-lrp-variable="battery"] .lrp-spark');
    expect(spark.hidden).toBe(false);
    expect(spark.querySelector("polyline")!.getAttribute("points")).toBe("24.0,2 36.8,2 36.8,12 48,12");
  });
});
