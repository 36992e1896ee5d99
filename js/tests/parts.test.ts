import { describe, expect, it } from "vitest";
import { entriesOf } from "../src/parts/issues";
import { positionOf, rateAt, rateText, SLIDER } from "../src/parts/rate";
import { groupsInScope, points, steps } from "../src/parts/variables";
import type { FindingView, IssueView } from "../src/protocol";
import { lightnessOf } from "../src/ui/theme";

describe("the rate slider", () => {
  it("goes from 0.1 to 1000 Hz in steps of about a tenth, each another round rate, and to free at its end", () => {
    expect([rateAt(SLIDER.min), rateAt(SLIDER.max - 1), rateAt(SLIDER.max)]).toEqual([0.1, 1000, 0]);
    expect([rateText(rateAt(1)), rateText(rateAt(SLIDER.max))]).toEqual(["0.11 Hz", "free"]);
    for (let position: number = SLIDER.min; position < SLIDER.max; position++) {
      const rate = rateAt(position);
      expect(Number(rate.toPrecision(2))).toBe(rate);
      expect(positionOf(rate)).toBe(position);
      const more = rateAt(position + 1) / rate;
      if (position < SLIDER.max - 1) expect(more > 1.05 && more < 1.15).toBe(true);
    }
  });

  it.each([0.01, 0.1, 0.5, 1, 2, 10, 23, 50, 100, 999, 5000, 0])(
    "shows %d Hz where it is set to it, nearly",
    (rate) => {
      const shown = rateAt(positionOf(rate));
      const within = rate && Math.min(1000, Math.max(0.1, rate));
      expect(Math.abs(shown - within)).toBeLessThanOrEqual(within * 0.13);
    },
  );
});

describe("variables in scope", () => {
  const program = {
    variables: ["g"],
    machines: [
      { path: "m", variables: ["m/a"] },
      { path: "m/s/n", variables: ["m/s/n/b"] },
      { path: "m/t/o", variables: ["m/t/o/c"] },
      { path: "mm", variables: ["mm/d"] },
    ],
  };

  it("are those of the machine, of those around it, and the globals", () => {
    const of = (machine: string) => groupsInScope({ program, machine, instances: [], instance: "" });
    expect(of("m/s/n").map(({ machine }) => machine)).toEqual(["m/s/n", "m", ""]);
    expect(of("m").map(({ machine }) => machine)).toEqual(["m", ""]);
  });
});

describe("the list of issues", () => {
  const range = { line: 5, column: 7, end_line: 5, end_column: 14 };
  const finding = {
    id: "f",
    code: "LRP301",
    severity: "error",
    message: "m",
    range,
    fix: null,
    creates: null,
  } as FindingView;
  const issue = (named: string) =>
    ({
      id: 1,
      code: "LRP603",
      severity: "error",
      message: "m",
      range,
      finding: named,
      count: 3,
    }) as IssueView;
  const codes = (findings: FindingView[], issues: IssueView[]) =>
    entriesOf(findings, issues).map((entry) => [entry.code, entry.issue?.count ?? 0]);

  it("has an issue that names a finding once, as the finding, with the issue's count", () => {
    expect(codes([finding], [issue("f")])).toEqual([["LRP301", 3]]);
  });

  it.each([
    ["that names none", [finding], issue("")],
    ["whose finding is not there any more", [{ ...finding, id: "g" }], issue("f")],
  ])("has an issue %s beside the findings", (_, findings, felt) => {
    expect(codes(findings, [felt])).toEqual([
      ["LRP301", 0],
      ["LRP603", 3],
    ]);
  });
});

it("what is resolved is listed after all that is open", () => {
  const issues = [true, false, true, false].map((resolved, index) => ({
    id: index,
    code: `${index}`,
    resolved,
  }));
  const listed = entriesOf([], issues as IssueView[]).map(({ code }) => code);
  expect(listed).toEqual(["1", "3", "0", "2"]);
});

describe("a sparkline", () => {
  it("ends at the right, highest value at the top", () => {
    expect(points([0, 10]).split(" ").at(-1)).toBe("48.0,2.0");
  });

  it("of truth values has steps, the present at the right", () => {
    const truths = [
      { time: -40, value: 0 },
      { time: 15, value: 1 },
      { time: 22.5, value: 0 },
    ];
    expect(steps(truths, 30)).toBe("0.0,12 24.0,12 24.0,2 36.0,2 36.0,12 48,12");
  });

  it("of equal values lies flat", () => {
    expect(
      new Set(
        points([3, 3, 3])
          .split(" ")
          .map((point) => point.split(",")[1]),
      ),
    ).toEqual(new Set(["12.0"]));
  });
});

it("ignores a transparent background for light and dark", () => {
  expect(lightnessOf("rgba(0, 0, 0, 0)")).toBeNull();
  expect(lightnessOf("rgb(255, 255, 255)")).toBeCloseTo(255);
  expect(lightnessOf("rgb(17, 20, 24)")).toBeLessThan(40);
});
