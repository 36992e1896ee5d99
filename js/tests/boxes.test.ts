import { describe, expect, it } from "vitest";
import { arrange, type Division } from "../src/ui/boxes";

const inner: Division = { name: "inner", label: "", axis: "rows", share: 25, parts: ["b", "c"] };
const plan: Division = { name: "outer", label: "", axis: "columns", share: 40, parts: ["a", inner] };

const shown = (names: string) => arrange(plan, (name) => names.includes(name));

describe("a plan", () => {
  it("divides the whole again and again", () => {
    expect(Object.fromEntries(shown("abc").boxes)).toEqual({
      a: { left: 0, top: 0, width: 40, height: 100 },
      b: { left: 40, top: 0, width: 60, height: 25 },
      c: { left: 40, top: 25, width: 60, height: 75 },
    });
    expect(shown("abc").bars.map(({ division, box }) => [division.name, box.left, box.top])).toEqual([
      ["outer", 40, 0],
      ["inner", 40, 25],
    ]);
  });

  it("leaves the place of what is hidden to the rest, without a bar", () => {
    expect(Object.fromEntries(shown("ac").boxes)).toEqual({
      a: { left: 0, top: 0, width: 40, height: 100 },
      c: { left: 40, top: 0, width: 60, height: 100 },
    });
    expect(shown("ac").bars).toHaveLength(1);
    expect(Object.fromEntries(shown("b").boxes)).toEqual({ b: { left: 0, top: 0, width: 100, height: 100 } });
    expect(shown("").boxes.size).toBe(0);
  });

  it("uses the share that the user chose", () => {
    const { boxes, bars } = arrange(
      plan,
      () => true,
      ({ name }) => (name === "inner" ? 50 : 80),
    );
    expect(boxes.get("c")).toEqual({ left: 80, top: 50, width: 20, height: 50 });
    expect(bars.map(({ share }) => share)).toEqual([80, 50]);
  });
});
