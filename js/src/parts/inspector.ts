/** The inspector of an element or a value: structure, source, members; live while it is open. Paper: §6.5. */

import type { ElementKind, Facet, InspectView } from "../protocol";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import { iconButton, linkButton } from "../ui/button";
import { h, reconcile, returnFocus, setHidden, setText } from "../ui/dom";
import { focusedAround } from "../ui/root";
import { partInSight } from "../ui/sight";
import { looked } from "./study";

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
  let asked = Number.NEGATIVE_INFINITY; // when, in ms
  let before: Element | null = null;
  const title = h("div", { class: "lrp-title" });
  const way = h("nav", { class: "lrp-way", "aria-label": "Path into the value" });
  const error = h("p", { class: "lrp-error", hidden: true });
  const body = h("div", { class: "lrp-inspect-body" }, error);
  const tell = (on: boolean) => {
    const { inspected } = store.state;
    if (inspected) looked(lab, "inspect", `${inspected.kind} ${inspected.path}`.trim(), on);
  };
  const close = () => {
    tell(false);
    store.set("inspected", null);
    element.hidden = true;
    returnFocus(before, lab.root);
  };
  const leave = iconButton("close", "Close", "close-inspector", close);
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
    h("header", { class: "lrp-head" }, title, h("div", { class: "lrp-tools" }, leave)),
    way,
    body,
  );
  const enter = (steps: string[]) => {
    into = steps;
    element.focus({ preventScroll: true }); // what was pressed will be gone
    askNow();
  };
  const { element: known, show } = facts(enter);
  body.append(known);
  const ask = newest(
    lab.closed,
    () => asked + INTERVAL,
    async () => {
      const subject = store.state.inspected;
      const steps = into;
      if (!subject) return;
      asked = performance.now();
      const reply = await lab.ask({ type: "inspect", ...subject, into: steps });
      if (subject !== store.state.inspected || steps !== into) return; // which is asked for
      setText(title, subject.path ? `${subject.kind} ${subject.path}` : subject.kind);
      showWay(way, steps, enter);
      if (reply.inspect) show(reply.inspect, steps);
      else setText(error, reply.error ?? "Nothing is known about this.");
      setHidden(error, Boolean(reply.inspect));
      setHidden(known, !reply.inspect);
    },
  );
  const askNow = () => {
    asked = Number.NEGATIVE_INFINITY;
    ask();
  };
  store.watch(["tick", "program"], ask);
  store.watch(["inspected"], askNow);
  return {
    element,
    open(kind, path) {
      if (element.hidden) before = focusedAround(lab.root);
      into = [];
      tell(false);
      store.set("inspected", { kind, path });
      tell(true);
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
    ...steps.map((step, depth) => linkButton(step, { onclick: () => enter(into.slice(0, depth)) })),
  );
}

/** What is inspected; elements stay while their values change, and with them what is selected or has the focus. */
function facts(enter: (into: string[]) => void) {
  const text = h("code", {});
  const type = h("span", { class: "lrp-faint" });
  const rows = h("tbody", {});
  const table = h("table", { class: "lrp-table" }, rows);
  const more = h("p", { class: "lrp-faint" });
  const source = h("pre", { class: "lrp-source", tabindex: "0" });
  const element = h("div", { class: "lrp-facets" }, h("p", {}, text, type), table, more, source);
  const show = (view: InspectView, into: string[]) => {
    setText(text, view.text || view.title);
    setText(type, view.type && ` ${view.type}`);
    reconcile<[number, Facet]>(
      rows,
      [...view.facets.entries()],
      ([index, { label, deep }]) => JSON.stringify([into, index, label, deep]),
      ([, { step, label, deep }]) => {
        const name = deep ? linkButton(label, { onclick: () => enter([...into, step]) }) : label;
        const [value, kind] = [h("code", {}), h("span", { class: "lrp-faint" })];
        return h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, value, kind));
      },
      (row, [, facet]) => {
        const [value, kind] = row.lastElementChild!.children;
        setText(value!, facet.text);
        setText(kind!, facet.type && ` ${facet.type}`);
      },
    );
    table.hidden = !view.facets.length;
    setText(more, `and ${view.more} more`);
    more.hidden = !view.more;
    setText(source, view.source);
    source.hidden = !view.source;
  };
  return { element, show };
}
