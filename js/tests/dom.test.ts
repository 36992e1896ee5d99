// @vitest-environment happy-dom
import { expect, it } from "vitest";
import { h, reconcile } from "../src/ui/dom";
import fc from "./laws";

it("a list becomes any other, and what stays keeps its element and the keyboard's focus", () => {
  const names = fc.uniqueArray(fc.constantFrom(..."abcdef"), { minLength: 1 });
  fc.assert(
    fc.property(names, names, fc.nat(), (before, after, nth) => {
      const list = h("div");
      const lab = h("div", { class: "lrp-lab" }, list);
      document.body.replaceChildren(lab);
      const update = (items: string[]) =>
        reconcile(
          list,
          items,
          String,
          (name) => h("button", {}, name),
          () => {},
        );
      update(before);
      const elements = new Map([...list.children].map((child) => [child.textContent, child]));
      const chosen = before[nth % before.length]!;
      const focused = elements.get(chosen) as HTMLElement;
      focused.focus();
      let isLeft = false;
      focused.addEventListener("blur", () => {
        isLeft = true;
      });
      update(after);
      expect([...list.children].map(({ textContent }) => textContent)).toEqual(after);
      for (const child of list.children) expect(elements.get(child.textContent) ?? child).toBe(child);
      const stays = after.includes(chosen);
      expect(document.activeElement).toBe(stays ? focused : lab);
      expect(isLeft).toBe(!stays);
    }),
  );
});
