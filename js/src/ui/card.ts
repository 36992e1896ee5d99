/** A card over the lab, beside what it is about: a heading, a button that closes it, and what it says. */

import type { Lab } from "../session/store";
import { button } from "./button";
import { h } from "./dom";
import { openPopup } from "./popup";
import { partInSight } from "./sight";

const EDGE = 6; // px between the card and the edge of what can be seen

export interface Point {
  x: number;
  y: number;
}

/** The lower left corner of an element, for a card below it. */
export function below(element: Element): Point {
  const { left, bottom } = element.getBoundingClientRect();
  return { x: left, y: bottom };
}

/** Open a card beside a point of the window. `place` puts it there again when its content has changed. */
export function openCard(
  lab: Lab,
  at: Point,
  action: string,
  heading: HTMLElement[],
  content: HTMLElement[],
  closed: () => void = () => {},
): { card: HTMLElement; place: () => void; close: (focus: boolean) => void } {
  const card = h(
    "section",
    {
      class: "lrp-why",
      role: "dialog",
      "aria-label": heading[0]!.textContent,
      tabindex: "-1",
      onkeydown: (event: KeyboardEvent) => {
        if (event.key !== "Escape") return;
        event.stopPropagation();
        close(true);
      },
    },
    h(
      "header",
      { class: "lrp-head" },
      h("div", { class: "lrp-title" }, ...heading),
      h(
        "div",
        { class: "lrp-tools" },
        button({ icon: "close", title: "Close", action, onclick: () => close(true) }),
      ),
    ),
    ...content,
  );
  const place = () => {
    const frame = lab.root.getBoundingClientRect();
    const { top, bottom } = partInSight(lab.root);
    const left = Math.min(at.x - frame.left + EDGE, frame.width - card.offsetWidth - EDGE);
    const below = Math.min(at.y - frame.top + EDGE, bottom - card.offsetHeight - EDGE);
    card.style.left = `${Math.max(EDGE, left)}px`;
    card.style.top = `${Math.max(top + EDGE, below)}px`;
  };
  const close = openPopup(lab.root, card, closed);
  place();
  card.focus({ preventScroll: true });
  return { card, place, close };
}
