/** A card over the lab, beside what it is about: a heading, a button that closes it, and what it says. */

import type { Lab } from "../session/store";
import { iconButton } from "./button";
import { h } from "./dom";
import { type Point, placeInSight } from "./point";
import { openPopup } from "./popup";

const EDGE = 6; // px between the card and the edge of what can be seen

/** Open a card beside a point of the window. `place` puts it there again when its content has changed. */
export function openCard(
  lab: Lab,
  at: Point,
  action: string,
  heading: HTMLElement[],
  content: HTMLElement[],
  closed: () => void = () => {},
): { card: HTMLElement; place: () => void; close: (focus: boolean) => void } {
  const leave = iconButton("close", "Close", action, () => close(true));
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
      h("div", { class: "lrp-tools" }, leave),
    ),
    ...content,
  );
  const place = () => placeInSight(lab.root, card, { x: at.x + EDGE, y: at.y + EDGE }, EDGE);
  const close = openPopup(lab.root, card, place, closed);
  card.focus({ preventScroll: true });
  return { card, place, close };
}
