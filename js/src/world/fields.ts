/** The input fields of a panel. Typed values stay until the bridge reports another value. */

import type { Field, Panel } from "../protocol";
import { freshId, h } from "../ui/dom";

type Input = HTMLInputElement | HTMLSelectElement;

export interface Inputs {
  element: HTMLElement;
  refresh(panel: Panel): void;
  /** Clear the texts that the bridge does not keep: they were for a button that has been pressed. */
  clear(): void;
  /** Go to the field that a button fills in. */
  show(key: string): void;
}

/** All values filled in, by key. */
export function values(body: HTMLElement): Record<string, string> {
  const all: Record<string, string> = {};
  for (const input of body.querySelectorAll<Input>("[data-field]")) all[input.dataset.field!] = read(input);
  return all;
}

export function inputs(panel: Panel, press: (key: string, row: string) => void): Inputs {
  const element = h("div", { class: "lrp-fields" });
  const controls = new Map<string, Input>();
  const offers = new Map<string, HTMLDataListElement>();
  const received = new Map<string, string>();
  for (const field of panel.fields) {
    if (field.kind === "value") continue;
    const input = control(field);
    controls.set(field.key, input);
    const offer = field.kind === "text" && field.choices ? h("datalist", { id: freshId() }) : null;
    if (offer) {
      offers.set(field.key, offer);
      input.setAttribute("list", offer.id);
      input.addEventListener("input", () => {
        const chosen = [...offer.options].some(({ value }) => value === read(input));
        if (field.press && chosen) press(field.press, read(input));
      });
    }
    const unit = field.unit && h("span", { class: "lrp-faint" }, field.unit);
    element.append(h("label", { class: "lrp-setting" }, h("span", {}, field.label), input, unit));
    if (offer) element.append(offer);
  }
  return {
    element,
    refresh({ fields }) {
      for (const { key, kind, value, choices } of fields) {
        const input = controls.get(key);
        if (!input) continue;
        const list = kind === "choice" ? input : offers.get(key);
        const changed = list !== undefined && fill(list, choices);
        if (value !== received.get(key) || (changed && kind === "choice")) write(input, value);
        received.set(key, value);
      }
    },
    clear() {
      for (const [key, input] of controls)
        if (input instanceof HTMLInputElement && input.type !== "checkbox" && !received.get(key))
          input.value = "";
    },
    show(key) {
      const filled = panel.fields.find(({ press }) => press === key);
      if (filled) controls.get(filled.key)?.focus();
    },
  };
}

/** Offer choices, and return whether they are others: an open list, and what is chosen, is not disturbed. */
function fill(list: Element, choices: string[]): boolean {
  const old = [...list.children];
  if (old.length === choices.length && old.every((one, i) => one.getAttribute("value") === choices[i]))
    return false;
  list.replaceChildren(...choices.map((value) => h("option", { value }, list.tagName === "SELECT" && value)));
  return true;
}

function read(input: Input): string {
  return input instanceof HTMLInputElement && input.type === "checkbox" ? String(input.checked) : input.value;
}

function write(input: Input, value: string): void {
  if (input instanceof HTMLInputElement && input.type === "checkbox") input.checked = value === "true";
  else input.value = value;
}

function control({ key, kind }: Field): Input {
  if (kind === "switch") return h("input", { type: "checkbox", "data-field": key });
  if (kind === "choice") return h("select", { class: "lrp-select", "data-field": key });
  const type = kind === "number" ? "number" : "text";
  return h("input", { class: "lrp-input", type, spellcheck: "false", "data-field": key });
}
