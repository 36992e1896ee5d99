/** Buttons, switches and panel headers, in one style. */

import { type Attributes, h } from "./dom";
import { type IconName, icon } from "./icons";

export interface ButtonOptions extends Record<string, unknown> {
  icon?: IconName;
  /** Shown beside the icon; without it the title is the label. */
  label?: string;
  title: string;
  action?: string;
  onclick?: (event: MouseEvent) => void;
}

/** `action` becomes `data-lrp-action`, the name in the page for tests and themes. */
export function button({
  icon: name,
  label,
  title,
  action,
  onclick,
  ...rest
}: ButtonOptions): HTMLButtonElement {
  const attributes: Attributes = { type: "button", class: "lrp-button", title, ...rest };
  if (onclick) attributes.onclick = onclick;
  if (action) attributes["data-lrp-action"] = action;
  if (!label) attributes["aria-label"] = title;
  const words = label && h("span", { class: "lrp-button-label" }, label);
  return h("button", attributes, name && icon(name), words);
}

export function iconButton(
  icon: IconName,
  title: string,
  action: string,
  onclick: () => void,
): HTMLButtonElement {
  return button({ icon, title, action, onclick });
}

/** Disable a button as long as what it has begun lasts. */
export async function disabledDuring<T>(element: HTMLButtonElement, act: Promise<T>): Promise<T> {
  element.disabled = true;
  const result = await act;
  element.disabled = false;
  return result;
}

export function linkButton(words: string, attributes: Attributes): HTMLButtonElement {
  return h("button", { type: "button", class: "lrp-link", ...attributes }, words);
}

/** A switch: a button with a state. Set it with `setSwitch`. */
export function toggle(
  label: string,
  title: string,
  action: string,
  onchange: (on: boolean) => void,
): HTMLButtonElement {
  const element = h(
    "button",
    {
      type: "button",
      role: "switch",
      class: "lrp-switch",
      title,
      "aria-checked": "false",
      "data-lrp-action": action,
      onclick: () => onchange(element.getAttribute("aria-checked") !== "true"),
    },
    h("span", { class: "lrp-switch-track", "aria-hidden": "true" }),
    h("span", {}, label),
  );
  return element;
}

export function setSwitch(element: Element, on: boolean): void {
  if (element.getAttribute("aria-checked") !== String(on)) element.setAttribute("aria-checked", String(on));
}

/** A panel: a heading, tools at its right, and a body. See `enlarge.ts` for the last tool. */
export function panel(
  part: string,
  title: string,
  tools: (Node | null)[],
  ...body: Node[]
): { element: HTMLElement; heading: HTMLElement } {
  const heading = h("div", { class: "lrp-title" }, title);
  const element = h(
    "section",
    { class: "lrp-panel", "data-lrp": part, "aria-label": title },
    h(
      "header",
      { class: "lrp-head" },
      heading,
      h("div", { class: "lrp-tools" }, ...tools),
      button({ icon: "enlarge", title: "Enlarge this panel, or show all again (F9)", action: "enlarge" }),
    ),
    ...body,
  );
  return { element, heading };
}
