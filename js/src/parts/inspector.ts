/** The inspector of an element or a value: structure, source, members; live while it is open. Paper: §6.5. */

import type { ElementKind, Facet, InspectView } from "../protocol";
import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { h, returnFocus, setText } from "../ui/dom";
import { partInSight } from "../ui/sight";

const INTERVAL = 500; // ms between two requests while the program runs
const AROUND = 8; // px between the inspector and the edge of what is in sight
const CONTROLS = 48; // px that are left free at the upper edge of the lab
const LEAST = 120; // px of height

export interface Inspector {
  element: HTMLElement;
  open(kind: ElementKind, path: string): void;
}

export function inspector(lab: Lab): Inspector {
  const { store } = lab;
  let into: string[] = [];
  let asked = 0;
  let asking = false;
  let before: Element | null = null;
  const title = h("div", { class: "lrp-title" });
  const way = h("nav", { class: "lrp-way", "aria-label": "Path into the value" });
  const body = h("div", { class: "lrp-inspect-body" });
  const close = () => {
    store.set("inspected", null);
    element.hidden = true;
    returnFocus(before, lab.root);
  };
  const element = h(
    "section",
    {
      class: "lrp-inspector",
      role: "dialog",
      "aria-label": "Inspector",
      hidden: true,
      tabindex: "-1",
      onkeydown: (event: KeyboardEvent) => {
        if (event.key !== "Escape") return;
        event.stopPropagation();
        close();
      },
    },
    h(
      "header",
      { class: "lrp-head" },
      title,
      h(
        "div",
        { class: "lrp-tools" },
        button({ icon: "close", title: "Close", action: "close-inspector", onclick: close }),
      ),
    ),
    way,
    body,
  );
  const enter = (steps: string[]) => {
    into = steps;
    void ask();
  };
  const ask = async () => {
    const subject = store.state.inspected;
    const steps = into;
    if (!subject || asking) return;
    asking = true;
    asked = performance.now();
    const reply = await lab.ask({ type: "inspect", ...subject, into: steps });
    asking = false;
    if (subject !== store.state.inspected || steps !== into) return void ask();
    setText(title, subject.path ? `${subject.kind} ${subject.path}` : subject.kind);
    showWay(way, steps, enter);
    if (reply.inspect) show(body, reply.inspect, (step) => enter([...steps, step]));
    else body.replaceChildren(h("p", { class: "lrp-error" }, reply.error ?? "Nothing is known about this."));
  };
  store.watch(["tick", "program"], () => {
    if (performance.now() - asked > INTERVAL) void ask();
  });
  store.watch(["inspected"], () => void ask());
  return {
    element,
    open(kind, path) {
      if (element.hidden) before = document.activeElement;
      into = [];
      store.set("inspected", { kind, path });
      const { top, bottom } = partInSight(lab.root);
      const below = Math.max(top + AROUND, CONTROLS);
      element.style.top = `${below}px`;
      element.style.maxHeight = `${Math.max(LEAST, bottom - below - AROUND)}px`;
      element.hidden = false;
      element.focus({ preventScroll: true });
    },
  };
}

function showWay(way: HTMLElement, into: string[], enter: (into: string[]) => void): void {
  const steps = ["value", ...into];
  way.hidden = into.length === 0;
  if (way.dataset.at === steps.join("\0")) return;
  way.dataset.at = steps.join("\0");
  way.replaceChildren(
    ...steps.map((step, depth) =>
      h("button", { type: "button", class: "lrp-link", onclick: () => enter(into.slice(0, depth)) }, step),
    ),
  );
}

function show(body: HTMLElement, view: InspectView, enter: (step: string) => void): void {
  const now = JSON.stringify(view);
  if (body.dataset.now === now) return;
  body.dataset.now = now;
  const row = ({ step, label, type, text, deep }: Facet) =>
    h(
      "tr",
      {},
      h(
        "th",
        { scope: "row" },
        deep ? h("button", { type: "button", class: "lrp-link", onclick: () => enter(step) }, label) : label,
      ),
      h("td", {}, h("code", {}, text), type && h("span", { class: "lrp-faint" }, ` ${type}`)),
    );
  body.replaceChildren(
    h(
      "p",
      {},
      h("code", {}, view.text || view.title),
      view.type && h("span", { class: "lrp-faint" }, ` ${view.type}`),
    ),
    ...(view.facets.length
      ? [h("table", { class: "lrp-table" }, h("tbody", {}, ...view.facets.map(row)))]
      : []),
    ...(view.more ? [h("p", { class: "lrp-faint" }, `and ${view.more} more`)] : []),
    ...(view.source ? [h("pre", { class: "lrp-source", tabindex: "0" }, view.source)] : []),
  );
}
