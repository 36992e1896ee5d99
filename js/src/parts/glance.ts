/**
 * A card beside a live value with its last half minute, while the pointer or the focus is on it; a click pins it.
 * Elements say of what they show the value: see `history`.
 */

import type { Lab } from "../session/store";
import { plotsOf, type Spark, type Subject, spark, titleOf } from "../timeline/spark";
import { h } from "../ui/dom";
import { below, placeInSight } from "../ui/point";
import { partInSight } from "../ui/sight";
import { arePinned, MARK, openHistory, pin } from "./history";
import { lookedAt } from "./study";

const OPENS = 250; // ms that the pointer rests on a value
const CLOSES = 120; // ms until it has come to another
const EDGE = 4; // px

/** A card that is open while something is under the pointer, or has the focus. */
interface Hovering {
  key: string;
  shown: Spark;
  close(): void;
}

/** Show the history of values in a lab. */
export function glances(lab: Lab): void {
  const { root } = lab;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let open: Hovering | null = null;
  let pointer = "";
  const valueAt = (event: Event) => (event.target as Element).closest<HTMLElement>(`[${MARK}]`);
  const close = () => {
    clearTimeout(timer);
    open?.close();
    open = null;
  };
  const soon = (act: () => void, after: number) => {
    clearTimeout(timer);
    timer = setTimeout(act, after);
  };
  const show = (value: HTMLElement, after: number) => {
    const key = value.getAttribute(MARK)!;
    if (open?.key === key) clearTimeout(timer);
    else if (!lab.store.state.settings.quiet)
      soon(() => {
        close();
        if (value.isConnected) open = hovering(lab, value, key);
      }, after);
  };
  const listen = { signal: lab.closed };
  root.addEventListener(
    "pointermove", // which a value that comes under the pointer, or a key, does not cause
    (event) => {
      const value = event.pointerType === "mouse" && !event.buttons && valueAt(event);
      if (value) show(value, open ? 0 : OPENS);
    },
    listen,
  );
  root.addEventListener(
    "pointerover",
    (event) => {
      if (!valueAt(event)) soon(close, CLOSES);
    },
    listen,
  );
  root.addEventListener("pointerleave", close, listen);
  root.addEventListener(
    "focusin",
    (event) => {
      const value = valueAt(event);
      if (value?.matches(":focus-visible")) show(value, OPENS);
      else if (open) close();
    },
    listen,
  );
  root.addEventListener("focusout", () => soon(close, CLOSES), listen);
  for (const kind of ["keydown", "wheel"] as const)
    root.addEventListener(kind, close, { ...listen, capture: true, passive: true });
  root.addEventListener(
    "pointerdown",
    (event) => {
      pointer = event.pointerType;
      if (!valueAt(event)) close();
    },
    { ...listen, capture: true },
  );
  root.addEventListener(
    "mousedown",
    (event) => {
      if (pins(valueAt(event))) event.preventDefault(); // the cursor of the editor stays
    },
    listen,
  );
  root.addEventListener(
    "click",
    (event) => {
      const value = valueAt(event);
      if (!value || !pins(value) || lab.store.state.settings.quiet) return;
      const key = value.getAttribute(MARK)!;
      const names = open?.key === key ? open.shown.names() : [];
      if (pointer === "touch") {
        close();
        openHistory(lab, JSON.parse(key), below(value));
      } else if (names.length) pin(lab, names);
      else
        void plotsOf(lab, JSON.parse(key)).then(({ plots }) =>
          pin(
            lab,
            plots.map(({ name }) => name),
          ),
        );
    },
    listen,
  );
  lab.store.watch(["snapshot"], close);
}

/** Whether a click on a value pins it; that on a button does what it says. */
function pins(value: HTMLElement | null): boolean {
  return value !== null && (value.tagName !== "BUTTON" || value.dataset.lrpAction === "pin");
}

function hovering(lab: Lab, value: HTMLElement, key: string): Hovering {
  const subject: Subject = JSON.parse(key);
  const hint = h("p", { class: "lrp-faint" });
  const say = () => {
    const names = shown.names();
    const words = arePinned(lab, names) ? "In the timeline. Click: remove" : "Click: plot in the timeline";
    hint.textContent = pins(value) && names.length ? words : "";
  };
  const place = () => {
    const { left, right, top, bottom } = value.getBoundingClientRect();
    const { bottom: lowest } = partInSight(lab.root);
    const height = card.offsetHeight + EDGE;
    const isAbove = bottom + height > lab.root.getBoundingClientRect().top + lowest;
    const x = Math.max(left, right - card.offsetWidth);
    placeInSight(lab.root, card, { x, y: isAbove ? top - height : bottom + EDGE }, EDGE);
  };
  const shown = spark(lab, subject, (reason) => {
    card.hidden = reason !== "";
    say();
    place();
  });
  const card = h("div", { class: "lrp-history-card", hidden: true }, shown.element, hint);
  const end = lab.store.watch(["plots"], say);
  const told = lookedAt(lab, titleOf(lab, subject));
  lab.root.append(card);
  return {
    key,
    shown,
    close() {
      told();
      end();
      shown.close();
      card.remove();
    },
  };
}
