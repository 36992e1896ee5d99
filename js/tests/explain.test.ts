// @vitest-environment happy-dom

import { beforeEach, describe, expect, it } from "vitest";
import { codeButton } from "../src/parts/explain";
import type { ExplanationView, ReplyMessage } from "../src/protocol";
import { type Lab, Store } from "../src/session/store";

const UNKNOWN: ExplanationView = {
  code: "LRP301",
  title: "Unknown event",
  explanation: "The transition never fires.",
  example: "(on bumb a -> b)",
  script: "",
  remedy: "Correct the name, or define it with `(event …)`.",
  repaired: "(on bump a -> b)",
  address: "https://example.org/errors.html#LRP301",
};

describe("a code", () => {
  let root: HTMLElement;
  const told: string[] = [];
  const asked: unknown[] = [];
  const open = async (reply: Partial<ReplyMessage>) => {
    const lab = {
      root,
      store: new Store(),
      notify: (text: string) => told.push(text),
      ask: async (question: unknown) => {
        asked.push(question);
        return reply;
      },
    } as unknown as Lab;
    root.append(codeButton(lab, "LRP301"));
    root.querySelector<HTMLElement>(".lrp-code")!.click();
    await new Promise((over) => setTimeout(over));
  };
  beforeEach(() => {
    told.length = asked.length = 0;
    root = document.createElement("div");
    document.body.replaceChildren(root);
  });

  it("opens its explanation, with the program, the repaired program and the address", async () => {
    await open({ explanation: UNKNOWN });
    expect(asked).toEqual([{ type: "explain", code: "LRP301" }]);
    const card = root.querySelector('[role="dialog"]')!;
    expect(card.getAttribute("aria-label")).toBe("Unknown event");
    const programs = [...card.querySelectorAll("pre")].map((each) => each.textContent);
    expect(programs).toEqual(["(on bumb a -> b)", "(on bump a -> b)"]);
    expect(card.querySelector("a")!.href).toBe(UNKNOWN.address);
    expect(card.querySelector("p code")!.textContent).toBe("(event …)");
    card.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
    expect(root.querySelector('[role="dialog"]')).toBeNull();
  });

  it("leads nowhere while the documentation is not published", async () => {
    await open({ explanation: { ...UNKNOWN, address: "errors.html#LRP301" } });
    expect(root.querySelector('[role="dialog"] a')).toBeNull();
  });

  it("says why it cannot be explained", async () => {
    await open({ error: "There is no code `LRP301`." });
    expect(told).toEqual(["There is no code `LRP301`."]);
    expect(root.querySelector('[role="dialog"]')).toBeNull();
  });
});
