/** The breakpoints, the form for a condition, and whether issues pause the program, too. */

import type { BreakpointView } from "../protocol";
import type { Act } from "../session/connection";
import type { Lab } from "../session/store";
import { disabledDuring, iconButton, linkButton, panel, setSwitch, toggle } from "../ui/button";
import { freshId, h, reconcile, setAttribute, setHidden, setProse, setText } from "../ui/dom";
import { hasFocus } from "../ui/root";
import { ELEMENT_OF } from "./breakpoints";

type Entry = [string, BreakpointView];

const WORDS: Record<BreakpointView["kind"], string> = {
  entered: "is entered",
  left: "is left",
  fired: "fires",
  event: "occurs",
  condition: "becomes True",
};

export function breakpointsView(lab: Lab): HTMLElement {
  const { store } = lab;
  const pause = toggle(
    "Pause on issue",
    "Pause the program whenever an issue occurs",
    "pause-on-issue",
    (on) => void lab.act({ do: "pause_on_issue", on }),
  );
  store.watch(["settings"], () => setSwitch(pause, store.state.settings.pause_on_issue));
  const list = h("ul", { class: "lrp-breakpoints" });
  const body = h("div", { class: "lrp-breakpoint-list" }, conditionForm(lab), list);
  const { element, heading } = panel("breakpoints", "Breakpoints", [pause], body);
  store.watch(["breakpoints"], () => {
    const all = Object.entries(store.state.breakpoints);
    setText(heading, all.length ? `Breakpoints (${all.length})` : "Breakpoints");
    const make = ([number]: Entry) => item(lab, number);
    reconcile(list, all, ([number]) => number, make, update);
  });
  return element;
}

function item(lab: Lab, number: string): HTMLElement {
  const current = () => lab.store.state.breakpoints[number];
  /** What is refused is shown again as it is. */
  const act = async (command: Act) => {
    if (await lab.act(command)) lab.store.touch(["breakpoints"]);
  };
  const on = h("input", {
    type: "checkbox",
    "data-lrp-action": "breakpoint-on",
    onchange: () => void act({ do: "change_breakpoint", number: Number(number), on: on.checked }),
  });
  const after = h("input", {
    class: "lrp-input",
    type: "number",
    min: "1",
    "aria-label": `Breakpoint ${number} pauses from this hit on`,
    onchange: () => {
      if (after.reportValidity() && after.value)
        void act({ do: "change_breakpoint", number: Number(number), after: Number(after.value) });
    },
  });
  const go = linkButton("", {
    onclick: () => {
      const { kind, path } = current() ?? {};
      const noun = kind && ELEMENT_OF[kind];
      if (noun && path) lab.goTo(noun, path);
    },
  });
  const remove = () => void lab.act({ do: "remove_breakpoint", number: Number(number) });
  return h(
    "li",
    { class: "lrp-breakpoint-item", "data-lrp-breakpoint": number },
    on,
    go,
    h("span", { class: "lrp-faint" }),
    h("label", { class: "lrp-faint" }, "from hit ", after, " onwards"),
    iconButton("remove", `Remove breakpoint ${number}`, "remove-breakpoint", remove),
    h("p", { class: "lrp-error", role: "status" }),
  );
}

function update(element: Element, [number, each]: Entry): void {
  const [on, go, note, , , problem] = element.children;
  const where = each.kind === "condition" && each.instance ? ` in ${each.instance}` : "";
  const words = `${each.name}${where} ${WORDS[each.kind]}`;
  (on as HTMLInputElement).checked = each.enabled;
  setAttribute(on!, "aria-label", `Breakpoint ${number}: pause when ${words}`);
  setText(go!, words);
  (go as HTMLButtonElement).disabled = !each.line;
  const hits = each.hits === 1 ? "1 hit" : `${each.hits} hits`;
  setText(
    note!,
    [each.line ? `line ${each.line}` : "", hits, each.dormant ? "dormant" : ""].filter(Boolean).join(" · "),
  );
  const after = element.querySelector<HTMLInputElement>('input[type="number"]')!;
  if (!hasFocus(after)) after.value = String(each.after);
  setProse(problem!, each.problem);
  setHidden(problem as HTMLElement, !each.problem);
}

/** "Pause when…": a condition in Python, with what is wrong with it below. */
function conditionForm(lab: Lab): HTMLElement {
  const id = freshId();
  const error = h("p", { class: "lrp-error", role: "alert", id, hidden: true });
  const field = h("input", {
    class: "lrp-input",
    "aria-label": "Pause when this Python condition becomes True",
    "aria-describedby": id,
    placeholder: "a condition, such as n > 3",
    spellcheck: "false",
    autocomplete: "off",
  });
  const add = h("button", { type: "submit", class: "lrp-button", "data-lrp-action": "add-condition" }, "Add");
  const show = (sentence: string | null) => {
    setProse(error, sentence ?? "");
    setHidden(error, !sentence);
    setAttribute(field, "aria-invalid", sentence ? "true" : null);
  };
  return h(
    "form",
    {
      class: "lrp-condition",
      onsubmit: async (event: Event) => {
        event.preventDefault();
        if (add.disabled) return;
        const { value } = field;
        const added = lab.act({ do: "add_breakpoint", kind: "condition", expression: value }, true);
        const refused = await disabledDuring(add, added);
        show(refused);
        if (!refused && field.value === value) field.value = "";
      },
    },
    h("span", { class: "lrp-faint" }, "Pause when…"),
    field,
    add,
    error,
  );
}
