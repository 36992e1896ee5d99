/** A context menu, opened by right click, key or button and operated with arrows, Enter and Escape. */

import { type ButtonOptions, button } from "./button";
import { consume, h } from "./dom";
import type { KeptSwitch } from "./kept";
import { below, type Point, placeInSight } from "./point";
import { openPopup } from "./popup";
import { focusedAround } from "./root";
import { partInSight } from "./sight";

const EDGE = 4; // px between a menu and the edge of what can be seen
const LEAST = 150; // px that it is high where hardly anything of the lab is in sight

export interface MenuItem {
  label: string;
  action: string;
  run: () => void;
  disabled?: boolean;
  checked?: boolean;
  hint?: string;
}

export function item(
  label: string,
  action: string,
  run: () => void,
  more: Pick<MenuItem, "disabled" | "checked" | "hint"> = {},
): MenuItem {
  return { label, action, run, ...more };
}

export function switchItem(label: string, action: string, { on, flip }: KeptSwitch, hint?: string): MenuItem {
  return item(label, action, flip, { checked: on, ...(hint ? { hint } : {}) });
}

export function openMenu(root: HTMLElement, at: Point, items: (MenuItem | null)[], label: string): void {
  const menu = h("div", { class: "lrp-menu", role: "menu", "aria-label": label });
  for (const each of items) {
    if (!each) {
      menu.append(h("div", { class: "lrp-menu-line", role: "separator" }));
      continue;
    }
    menu.append(
      h(
        "button",
        {
          type: "button",
          class: "lrp-menu-item",
          role: each.checked === undefined ? "menuitem" : "menuitemcheckbox",
          "aria-checked": each.checked === undefined ? null : String(each.checked),
          tabindex: "-1",
          disabled: each.disabled ?? false,
          "data-lrp-action": each.action,
          onclick: () => {
            close(true);
            each.run();
          },
        },
        h("span", {}, each.label),
        each.hint && h("kbd", {}, each.hint),
      ),
    );
  }
  const entries = [...menu.querySelectorAll<HTMLButtonElement>("button:not(:disabled)")];
  menu.addEventListener("keydown", (event) => {
    const index = entries.indexOf(focusedAround(menu) as HTMLButtonElement);
    const move: Record<string, number> = {
      ArrowDown: (index + 1) % entries.length,
      ArrowUp: (index + entries.length - 1) % entries.length,
      Home: 0,
      End: entries.length - 1,
    };
    const next = move[event.key];
    if (next !== undefined) entries[next]?.focus();
    else if (event.key === "Escape" || event.key === "Tab") close(true);
    else if (event.key.length === 1) {
      const letter = event.key.toLowerCase();
      entries.find((entry, i) => i > index && entry.textContent?.toLowerCase().startsWith(letter))?.focus();
      return;
    } else return;
    consume(event);
  });
  const close = openPopup(root, menu, () => {
    const { top, bottom } = partInSight(root);
    menu.style.maxHeight = `${Math.max(LEAST, bottom - top - 2 * EDGE)}px`;
    placeInSight(root, menu, at, EDGE);
  });
  entries[0]?.focus({ preventScroll: true });
}

export function menuButton(
  root: HTMLElement,
  options: ButtonOptions,
  label: string,
  items: () => (MenuItem | null)[],
): HTMLButtonElement {
  const element = button({
    icon: "more",
    "aria-haspopup": "menu",
    onclick: () => openMenu(root, below(element, EDGE), items(), label),
    ...options,
  });
  return element;
}
