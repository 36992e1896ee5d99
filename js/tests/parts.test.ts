import { describe, expect, it } from "vitest";
import { entriesOf } from "../src/parts/issues";
import { positionOf, rateAt, rateText, SLIDER } from "../src/parts/rate";
import { points } from "../src/parts/spark";
import { groupsInScope } from "../src/parts/variables";
import type { FindingView, IssueView } from "../src/protocol";
import { lightnessOf } from "../src/ui/theme";

describe("the rate slider", () => {
  it("goes from 1 to 100 Hz, and to free at its end", () => {
    expect([rateAt(0), rateAt(50), rateAt(100), rateAt(SLIDER.max)]).toEqual([1, 10, 100, 0]);
    expect(rateText(rateAt(SLIDER.max))).toBe("free");
  });

  it.each([1, 2, 10, 33, 100, 0])("shows %i Hz where it is set to it, nearly", (rate) => {
    const shown = rateAt(positionOf(rate));
    expect(Math.abs(shown - rate)).toBeLessThanOrEqual(rate * 0.03);
  });
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
    expect(groupsInScope(program, "m/s/n").map(({ machine }) => machine)).toEqual(["m/s/n", "m", ""]);
    expect(groupsInScope(program, "m").map(({ machine }) => machine)).toEqual(["m", ""]);
  });
});

describe("the list of issues", () => {
  const range = (line: number, column: number, end_column: number) => ({
    line,
    column,
    end_line: line,
    end_column,
  });
  const finding = (code: string, place: ReturnType<typeof range>) =>
    ({ code, severity: "error", message: code, range: place, fix: null }) as FindingView;
  const issue = (code: string, place: ReturnType<typeof range>, resolved = false) =>
    ({ id: 1, code, severity: "error", message: code, range: place, resolved, count: 3 }) as IssueView;
  const codes = (findings: FindingView[], issues: IssueView[]) =>
    entriesOf(findings, issues).map((entry) => [entry.code, entry.issue?.count ?? 0]);

  it("has a name that means nothing once, as it was found, counted as it was felt", () => {
    expect(codes([finding("LRP301", range(5, 7, 14))], [issue("LRP603", range(5, 3, 22))])).toEqual([
      ["LRP301", 3],
    ]);
  });

  it.each([
    ["elsewhere", finding("LRP301", range(6, 7, 14)), issue("LRP603", range(5, 3, 22))],
    ["of another kind", finding("LRP301", range(5, 7, 14)), issue("LRP601", range(5, 3, 22))],
    ["resolved", finding("LRP301", range(5, 7, 14)), issue("LRP603", range(5, 3, 22), true)],
  ])("has an issue %s beside a finding", (_, found, felt) => {
    expect(codes([found], [felt])).toHaveLength(2);
  });
});

describe("a sparkline", () => {
  it("ends at the right, highest value at the top", () => {
    expect(points([0, 10]).split(" ").at(-1)).toBe("48.0,2.0");
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

it("a background one can see through says nothing about light and dark", () => {
  expect(lightnessOf("rgba(0, 0, 0, 0)")).toBeNull();
  expect(lightnessOf("rgb(255, 255, 255)")).toBeCloseTo(255);
  expect(lightnessOf("rgb(17, 20, 24)")).toBeLessThan(40);
});
