/** The state graph of the machine shown: drawing, marks, zoom and pan, menus. */

import { restartNotice } from "../parts/notes";
import type { Layout } from "../protocol";
import type { Lab } from "../session/store";
import { button, panel } from "../ui/button";
import { h, s, setAttribute } from "../ui/dom";
import { type MenuItem, openMenu } from "../ui/menu";
import { Camera } from "./camera";
import { draw, makeLayers, moveState } from "./draw";
import { keepOneTabStop, walkWithArrows } from "./focus";
import { Marks } from "./marks";

type Mode = "live" | "static" | "hidden";
const DRAG_FROM = 4; // px of movement that make a press a drag
const LEGIBLE = 0.5; // a large machine begins at its corner, so that its names can be read
const NEARLY = 0.8; // prefer slightly smaller to cut off
const SEND_EVERY = 40; // ms between two places of a dragged state

export function graphView(lab: Lab): HTMLElement {
  const { store } = lab;
  const layers = makeLayers();
  const svg = s("svg", { class: "lrp-graph", role: "group", "aria-label": "State graph" }, layers.root);
  const marks = new Marks(layers, store.state);
  let camera = new Camera();
  let shown: Layout | null = null;
  let mode: Mode = "live";

  const place = () => setAttribute(layers.root, "transform", camera.transform);
  const fit = (least = 0) => {
    const [x = 0, y = 0, width = 0, height = 0] = shown?.view ?? [];
    camera.fit({ x, y, width, height }, svg.clientWidth, svg.clientHeight);
    if (camera.scale < least * NEARLY) camera.corner({ x, y }, least);
    place();
  };
  const redraw = (force = false) => {
    const layout = store.state.layouts[store.state.machine] ?? null;
    svg.toggleAttribute("hidden", mode === "hidden");
    if (mode === "hidden" || !layout) {
      if (!layout) layers.root.setAttribute("visibility", "hidden");
      return;
    }
    layers.root.removeAttribute("visibility");
    const other = shown?.machine !== layout.machine;
    if (shown === layout && !force) return;
    if (mode === "static" && !other && !force) {
      element.dataset.stale = "";
      return;
    }
    delete element.dataset.stale;
    shown = layout;
    if (other) {
      camera = store.state.cameras[layout.machine] ??= new Camera();
    }
    draw(layers, layout);
    keepOneTabStop(svg);
    svg.setAttribute("aria-label", `State graph of ${layout.name}`);
    if (camera.moved) place();
    else fit(LEGIBLE);
  };

  const modes = h(
    "select",
    {
      class: "lrp-select",
      "aria-label": "When the graph is redrawn",
      title: "Live: redraw after every edit. Static: redraw on request.",
      onchange: () => {
        mode = modes.value as Mode;
        element.dataset.mode = mode;
        redraw(true);
      },
    },
    ...["live", "static", "hidden"].map((name) => h("option", { value: name }, name)),
  );
  const zoom = (factor: number) => {
    camera.zoom(factor, svg.clientWidth / 2, svg.clientHeight / 2);
    place();
  };
  const whole = () => {
    fit();
    camera.moved = camera.scale < LEGIBLE; // or a resize would undo it
  };
  const { element } = panel(
    "graph",
    "State graph",
    [
      button({
        label: "Redraw",
        title: "Draw the graph of the program as it is now",
        action: "redraw",
        onclick: () => redraw(true),
      }),
      modes,
      button({
        icon: "arrange",
        title: "Lay out all states again",
        action: "arrange",
        onclick: () => void lab.act({ do: "arrange", path: store.state.machine }),
      }),
      button({ icon: "minus", title: "Zoom out", action: "zoom-out", onclick: () => zoom(1 / 1.25) }),
      button({ icon: "plus", title: "Zoom in", action: "zoom-in", onclick: () => zoom(1.25) }),
      button({ icon: "fit", title: "Show all", action: "zoom-fit", onclick: whole }),
    ],
    h("div", { class: "lrp-graph-body" }, svg, emptyNote(lab), restartNotice(lab)),
  );

  store.watch(["layouts", "machine", "snapshot"], () => redraw());
  store.watch(["lit", "entered", "fired", "machine", "layouts", "chosen"], marks.update);
  new ResizeObserver(() => {
    if (!camera.moved) fit(LEGIBLE);
  }).observe(svg);

  /* ---------------------------------------------------------------- zoom, pan, drag */

  const local = (event: { clientX: number; clientY: number }) => {
    const frame = svg.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  };
  svg.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
      event.preventDefault();
      const { x, y } = local(event);
      camera.zoom(Math.exp(-event.deltaY * 0.002), x, y);
      place();
    },
    { passive: false },
  );
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const node = (event.target as Element).closest<SVGGElement>("[data-lrp-state]");
    const begin = local(event);
    let last = begin;
    let moved = false;
    let sent = 0;
    const move = (now: PointerEvent) => {
      const point = local(now);
      if (!moved && Math.hypot(point.x - begin.x, point.y - begin.y) < DRAG_FROM) return;
      if (!moved) svg.setPointerCapture(event.pointerId);
      moved = true;
      if (node) {
        const [x, y] = camera.inside(point.x, point.y);
        node.setAttribute("data-dragged", "");
        moveState(node, x, y);
        if (now.timeStamp - sent > SEND_EVERY) {
          sent = now.timeStamp;
          pin(node, x, y);
        }
      } else {
        camera.pan(point.x - last.x, point.y - last.y);
        place();
      }
      last = point;
    };
    const end = () => {
      svg.removeEventListener("pointermove", move);
      if (!node || !moved) return;
      pin(node, ...camera.inside(last.x, last.y));
      node.removeAttribute("data-dragged");
      svg.addEventListener("click", (click) => click.stopPropagation(), { capture: true, once: true });
    };
    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerup", end, { once: true });
    svg.addEventListener("pointercancel", end, { once: true });
  });
  const pin = (node: Element, x: number, y: number) => {
    const path = node.getAttribute("data-lrp-state") ?? "";
    const name = path.slice(path.lastIndexOf("/") + 1);
    lab.send({ do: "pin", path: store.state.machine, name, x: Math.round(x), y: Math.round(y) });
  };

  /* ---------------------------------------------------------------- choose, open, menu */

  const hit = (target: EventTarget | null) => {
    const from = target as Element;
    const arrow = from.closest?.("[data-of]")?.getAttribute("data-of");
    const state = from.closest?.(".lrp-state.lrp-state")?.getAttribute("data-lrp-state");
    return { arrow: arrow ?? null, state: state ?? null };
  };
  const open = (path: string) => {
    const inner = shown?.states.find((shape) => shape.id === path)?.machines[0];
    if (inner) store.set("machine", `${path}/${inner}`);
  };
  const choose = (target: EventTarget | null) => {
    const { arrow, state } = hit(target);
    const chosen = arrow ?? state;
    if (!chosen) return;
    store.set("chosen", chosen);
    lab.goTo(arrow ? "transition" : "state", chosen);
  };
  const menu = (target: EventTarget | null, at: { x: number; y: number }) => {
    const { arrow, state } = hit(target);
    if (arrow) openMenu(lab.root, at, transitionMenu(lab, arrow), `Transition ${arrow}`);
    else if (state)
      openMenu(
        lab.root,
        at,
        stateMenu(lab, state, () => open(state)),
        `State ${state}`,
      );
    return Boolean(arrow ?? state);
  };
  svg.addEventListener("click", (event) => choose(event.target));
  svg.addEventListener("dblclick", (event) => {
    const { state } = hit(event.target);
    if (state) open(state);
  });
  svg.addEventListener("contextmenu", (event) => {
    if (event.button !== 2 && event.detail === 0) return; // by key: see below
    if (menu(event.target, { x: event.clientX, y: event.clientY })) {
      event.preventDefault();
      event.stopPropagation();
    }
  });
  svg.addEventListener("keydown", (event) => {
    const target = event.target as Element;
    const frame = target.getBoundingClientRect();
    if (event.key === "Enter" && event.shiftKey) open(hit(target).state ?? "");
    else if (event.key === "Enter" || event.key === " ") choose(target);
    else if (event.key === "ContextMenu" || (event.key === "F10" && event.shiftKey) || event.key === "m") {
      menu(target, { x: frame.left + frame.width / 2, y: frame.top + frame.height / 2 });
    } else return;
    event.preventDefault();
    event.stopPropagation();
  });
  walkWithArrows(svg);
  return element;
}

function emptyNote(lab: Lab): HTMLElement {
  const note = h(
    "p",
    { class: "lrp-empty" },
    "No machine yet. Write ",
    h("code", {}, "(machine m (state s)) (spawn m s)"),
  );
  lab.store.watch(["program", "snapshot"], () => {
    note.hidden = lab.store.state.program.machines.length > 0;
  });
  return note;
}

export function stateMenu(lab: Lab, path: string, open: () => void): (MenuItem | null)[] {
  const nested = lab.store.state.program.machines.some((machine) => machine.parent === path);
  return [
    { label: "Transition here", action: "transition", run: () => void lab.act({ do: "transition", path }) },
    { label: "Teleport here", action: "teleport", run: () => void lab.act({ do: "teleport", path }) },
    null,
    { label: "Open nested machine", action: "open", run: open, disabled: !nested, hint: "⇧⏎" },
    { label: "Inspect", action: "inspect", run: () => lab.inspect("state", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("state", path), hint: "⏎" },
    { label: "Rename…", action: "rename", run: () => lab.rename("state", path) },
  ];
}

export function transitionMenu(lab: Lab, path: string): (MenuItem | null)[] {
  return [
    { label: "Fire now", action: "fire", run: () => void lab.act({ do: "fire", path }) },
    null,
    { label: "Inspect", action: "inspect", run: () => lab.inspect("transition", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("transition", path), hint: "⏎" },
  ];
}
