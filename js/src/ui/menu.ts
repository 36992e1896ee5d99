/** A context menu, opened by right click, key or button and operated with arrows, Enter and Escape. */

import { h } from "./dom";
import { openPopup } from "./popup";

const BELOW = 28; // px at the bottom of the window, where the notebook's status bar may be

export interface MenuItem {
  label: string;
  action: string;
  run: () => void;
  disabled?: boolean;
  checked?: boolean;
  hint?: string;
}

export function openMenu(
  root: HTMLElement,
  at: { x: number; y: number },
  items: (MenuItem | null)[],
  label: string,
): void {
  const menu = h("div", { class: "lrp-menu", role: "menu", "aria-label": label });
  for (const item of items) {
    if (!item) {
      menu.append(h("div", { class: "lrp-menu-line", role: "separator" }));
      continue;
    }
    menu.append(
      h(
        "button",
        {
          type: "button",
          class: "lrp-menu-item",
          role: item.checked === undefined ? "menuitem" : "menuitemcheckbox",
          "aria-checked": item.checked === undefined ? null : String(item.checked),
          tabindex: "-1",
          disabled: item.disabled ?? false,
          "data-lrp-action": item.action,
          onclick: () => {
            close(true);
            item.run();
          },
        },
        h("span", {}, item.label),
        item.hint && h("kbd", {}, item.hint),
      ),
    );
  }
  const entries = [...menu.querySelectorAll<HTMLButtonElement>("button:not(:disabled)")];
  menu.addEventListener("keydown", (event) => {
    const index = entries.indexOf(document.activeElement as HTMLButtonElement);
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
    event.preventDefault();
    event.stopPropagation();
  });
  const close = openPopup(root, menu);
  const frame = root.getBoundingClientRect();
  const left = Math.min(at.x - frame.left, frame.width - menu.offsetWidth - 4);
  const top = Math.min(
    at.y - frame.top,
    window.innerHeight - BELOW - menu.offsetHeight - frame.top,
    Math.max(frame.height, menu.offsetHeight + 8) - menu.offsetHeight - 4,
  );
  menu.style.left = `${Math.max(4, left)}px`;
  menu.style.top = `${Math.max(4, top)}px`;
  entries[0]?.focus({ preventScroll: true });
}
