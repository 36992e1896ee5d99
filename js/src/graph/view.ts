/** The state graph of the machine shown: drawing, marks, zoom and pan, menus. */

import { nameOf, parentOf } from "../language/paths";
import { breakpointItems } from "../parts/breakpoints";
import { looked, showLock } from "../parts/study";
import { askWhy } from "../parts/why";
import type { GraphMode, Layout, StateShape } from "../protocol";
import { inGraph } from "../session/state";
import type { Lab } from "../session/store";
import { button, panel } from "../ui/button";
import { h, s, setAttribute } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { type MenuItem, openMenu } from "../ui/menu";
import { pngOfSvg, savePicture, svgDocument } from "../ui/picture";
import { AutoFit } from "./autofit";
import { type Box, Camera } from "./camera";
import { drawDots } from "./dots";
import { Dragging } from "./drag";
import { draw, makeLayers } from "./draw";
import { keepOneTabStop, walkWithArrows } from "./focus";
import { layoutsIn } from "./inside";
import { Marks } from "./marks";
import { attachPencil } from "./pencil";
import { ScrollBars, scroll, scrollByWheel } from "./scroll";
import { cursorSwitch, showMachine } from "./shown";

const MODES = "Live: redraw after every edit, and show the run. Static: redraw on request.";
const RESIZED_FOR = 150; // ms without another size before the kernel gets it
const ACTIVE_FOR = 300; // ms that a state is active before it is brought into view

export function graphView(lab: Lab): HTMLElement {
  const { store } = lab;
  const layers = makeLayers();
  const svg = s("svg", { class: "lrp-graph", role: "group", "aria-label": "State graph" }, layers.root);
  const marks = new Marks(layers, store.state);
  let camera = new Camera();
  let shown: Layout | null = null;
  let drawn: Layout[] = []; // that of the machine shown, then those inside its states
  const mode = () => store.state.settings.graph;

  const place = () => {
    setAttribute(layers.root, "transform", camera.transform);
    scrollBars.update(camera, contents(), size());
  };
  const size = () => ({ width: svg.clientWidth, height: svg.clientHeight });
  const scrollBars = new ScrollBars();
  const fitting = new AutoFit(svg, camera, place);
  const dragging = new Dragging(
    (path, x, y) => lab.send({ do: "pin", path: parentOf(path), name: nameOf(path), x, y }),
    () => fitting.release(),
  );
  const contents = (): Box => {
    const [x = 0, y = 0, width = 0, height = 0] = shown?.view ?? [];
    return { x, y, width, height };
  };
  /** The state that must be in view: the active one, or where the machine starts. */
  const focus = (): Box | null =>
    boxOf(({ id }) => inGraph(store.state).lit.includes(id)) ?? boxOf(({ start }) => start);
  const boxOf = (isMeant: (shape: StateShape) => unknown): Box | null => {
    const shape = shown?.states.find(isMeant);
    return shape ? around(shape) : null;
  };
  const redraw = (force = false) => {
    const layout = store.state.layouts[store.state.machine] ?? null;
    svg.toggleAttribute("hidden", mode() === "hidden");
    if (mode() === "hidden" || !layout) {
      if (!layout) layers.root.setAttribute("visibility", "hidden");
      return;
    }
    layers.root.removeAttribute("visibility");
    const other = shown?.machine !== layout.machine;
    const parts = layoutsIn(layout.machine, store.state.layouts);
    const isSame = parts.length === drawn.length && parts.every((part, index) => part === drawn[index]);
    if (isSame && !force) return;
    const isChosen =
      other && (!shown || store.state.program.machines.some(({ path }) => path === shown?.machine));
    if (mode() === "static" && !isChosen && !force) {
      element.dataset.stale = "";
      return;
    }
    delete element.dataset.stale;
    const known = new Map(shown?.states.map((shape) => [shape.id, shape]));
    const fresh = layout.states.find(({ id }) => !known.has(id));
    const isRearranged = known.size > 1 && !layout.states.some((shape) => isAt(shape, known.get(shape.id)));
    shown = layout;
    drawn = parts;
    draw(layers, layout, store.state.layouts);
    drawDots(layers.root, store.state);
    keepOneTabStop(svg);
    svg.setAttribute("aria-label", `State graph of ${layout.name}`);
    if (other) {
      camera = store.state.cameras[layout.machine] ??= new Camera();
      fitting.show(camera, contents(), focus());
    } else if (isRearranged) fitting.rearranged(contents(), focus());
    else fitting.update(contents(), fresh ? () => boxOf(({ id }) => id === fresh.id) : null);
    dragging.drawn(parts);
  };

  const modes = h(
    "select",
    {
      class: "lrp-select",
      "aria-label": "When the graph is redrawn",
      title: MODES,
      "data-lrp-action": "graph-mode",
      onchange: () => void lab.act({ do: "graph", mode: modes.value as GraphMode }),
    },
    // a hidden one is shown again by the menu, which only a whole lab has
    ...["live", "static", ...(lab.root.dataset.part === "lab" ? ["hidden"] : [])].map((name) =>
      h("option", { value: name }, name),
    ),
  );
  const zoom = (factor: number) => {
    fitting.stop();
    camera.zoom(factor, svg.clientWidth / 2, svg.clientHeight / 2);
    place();
  };
  const whole = () => fitting.whole(contents());
  const isNested = () =>
    Object.values(store.state.layouts).some(({ states }) => states.some(({ inside }) => inside.length));
  const save = (kind: "svg" | "png") => {
    const picture = svgDocument(svg, layers.root, contents());
    const file =
      kind === "svg" ? new Blob([picture], { type: "image/svg+xml" }) : pngOfSvg(picture, contents());
    void savePicture(`${store.state.machine.replaceAll("/", "-")}.${kind}`, file, lab.notify);
  };
  const more = button({
    icon: "more",
    title: "More for the graph",
    action: "graph-menu",
    "aria-haspopup": "menu",
    onclick: () => {
      const { left, bottom } = more.getBoundingClientRect();
      const disabled = !shown;
      openMenu(
        lab.root,
        { x: left, y: bottom + 4 },
        [
          {
            label: "Nested machines inside their states",
            action: "nest",
            checked: isNested(),
            disabled: !store.state.program.machines.some(({ parent }) => parent),
            run: () => void lab.act({ do: "nest", on: !isNested() }),
          },
          null,
          { label: "Zoom in", action: "menu-zoom-in", disabled, run: () => zoom(1.25) },
          { label: "Zoom out", action: "menu-zoom-out", disabled, run: () => zoom(1 / 1.25) },
          null,
          { label: "Save as SVG", action: "save-svg", disabled, run: () => save("svg") },
          { label: "Save as PNG", action: "save-png", disabled, run: () => save("png") },
        ],
        "State graph",
      );
    },
  });
  const { element } = panel(
    "graph",
    "State graph",
    [
      button({
        label: "Redraw",
        title: "Draw the graph of the program as it is now",
        action: "redraw",
        onclick: () => {
          looked(lab, "redraw", store.state.machine, true);
          redraw(true);
        },
      }),
      modes,
      button({
        icon: "arrange",
        title: "Lay out all states again",
        action: "arrange",
        onclick: () => void lab.act({ do: "arrange", path: store.state.machine }),
      }),
      cursorSwitch(store),
      button({ icon: "minus", title: "Zoom out", action: "zoom-out", onclick: () => zoom(1 / 1.25) }),
      button({ icon: "plus", title: "Zoom in", action: "zoom-in", onclick: () => zoom(1.25) }),
      button({ icon: "fit", title: "Show all", action: "zoom-fit", onclick: whole }),
      more,
    ],
    h("div", { class: "lrp-graph-body" }, svg, ...scrollBars.elements, emptyNote(lab)),
  );

  store.watch(["layouts", "machine", "snapshot"], () => redraw());
  let before = mode();
  store.watch(["settings"], () => {
    modes.value = element.dataset.mode = mode();
    showLock(modes, store.state.settings, MODES);
    if (mode() !== before) redraw(true);
    before = mode();
  });
  store.watch(["lit", "entered", "fired", "machine", "layouts", "chosen", "settings"], marks.update);
  store.watch(["breakpoints"], () => drawDots(layers.root, store.state));
  let isWaiting = false;
  store.watch(["lit", "follow"], () => {
    if (isWaiting || store.state.follow !== "active" || mode() !== "live") return;
    isWaiting = true;
    setTimeout(() => {
      isWaiting = false;
      if (store.state.follow === "active") fitting.reveal(focus);
    }, ACTIVE_FOR);
  });
  let resizing: ReturnType<typeof setTimeout> | undefined;
  new ResizeObserver(() => {
    fitting.resized(focus());
    clearTimeout(resizing);
    resizing = setTimeout(() => {
      if (svg.clientWidth) lab.send({ do: "fit", width: svg.clientWidth, height: svg.clientHeight });
    }, RESIZED_FOR);
  }).observe(svg);
  const FUNCTION_KEY = /^F\d/; // types nothing; F9 makes this panel larger
  lab.root.addEventListener("keydown", ({ key }) => void (FUNCTION_KEY.test(key) || fitting.typed()), true);

  /* ---------------------------------------------------------------- zoom, pan, drag */

  const local = (event: { clientX: number; clientY: number }) => {
    const frame = svg.getBoundingClientRect();
    return { x: event.clientX - frame.left, y: event.clientY - frame.top };
  };
  svg.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const { x, y } = local(event);
      fitting.stop();
      camera.zoom(Math.exp(-event.deltaY * 0.002), x, y);
      place();
    },
    { passive: false },
  );
  scrollByWheel(svg, lab.closed, (dx, dy) => {
    fitting.stop();
    const moves = scroll(camera, contents(), size(), dx, dy);
    place();
    return moves;
  });
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const node = (event.target as Element).closest<SVGGElement>("[data-lrp-state]");
    let last = local(event);
    const { x, y, scale } = camera;
    trackDrag(svg, event, {
      begin() {
        fitting.hold();
        if (node) dragging.begin(node);
      },
      move(now) {
        const point = local(now);
        const [dx, dy] = [point.x - last.x, point.y - last.y];
        if (node) dragging.move(dx / camera.scale, dy / camera.scale, now.timeStamp);
        else {
          camera.pan(dx, dy);
          place();
        }
        last = point;
      },
      end(released, moved) {
        if (!moved) return;
        if (!node) {
          if (!released) camera.set({ x, y, scale });
          place();
          fitting.release();
        } else if (released) dragging.drop();
        else dragging.cancel();
      },
    });
  });

  /* ---------------------------------------------------------------- choose, open, menu */

  const hit = (target: EventTarget | null) => {
    const from = target as Element;
    const arrow = from.closest?.("[data-of]")?.getAttribute("data-of");
    const state = from.closest?.(".lrp-state.lrp-state")?.getAttribute("data-lrp-state");
    return { arrow: arrow ?? null, state: state ?? null };
  };
  const open = (path: string) => {
    const shapes = drawn.flatMap(({ states }) => states);
    const inner = shapes.find((shape) => shape.id === path)?.machines[0];
    if (inner) showMachine(store, `${path}/${inner}`);
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
    const acts = pencil?.acts;
    if (arrow) {
      const items = [...transitionMenu(lab, arrow, at), null, ...(acts?.ofTransition(arrow, at) ?? [])];
      openMenu(lab.root, at, items, `Transition ${arrow}`);
    } else if (state)
      openMenu(
        lab.root,
        at,
        [...stateMenu(lab, state, at, () => open(state)), null, ...(acts?.ofState(state, at) ?? [])],
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
    else if (event.key === "?") {
      const { arrow, state } = hit(target);
      const at = { x: frame.left + frame.width / 2, y: frame.top + frame.height / 2 };
      if (arrow ?? state) askWhy(lab, arrow ? "transition" : "state", (arrow ?? state)!, at);
    } else if (event.key === "ContextMenu" || (event.key === "F10" && event.shiftKey) || event.key === "m") {
      menu(target, { x: frame.left + frame.width / 2, y: frame.top + frame.height / 2 });
    } else return;
    event.preventDefault();
    event.stopPropagation();
  });
  walkWithArrows(svg, (focused) => {
    const { left, top, width, height } = focused.getBoundingClientRect();
    const corner = local({ clientX: left, clientY: top });
    const [x, y] = camera.inside(corner.x, corner.y);
    const box = { x, y, width: width / camera.scale, height: height / camera.scale };
    fitting.reveal(() => box, true);
  });
  const pencil =
    lab.pen && attachPencil(lab, svg, layers.root, lab.pen, (path, x, y) => dragging.put(path, x, y));
  return element;
}

function around({ x, y, width, height }: StateShape): Box {
  return { x: x - width / 2, y: y - height / 2, width, height };
}

function isAt({ x, y }: StateShape, before: StateShape | undefined): boolean {
  return before?.x === x && before.y === y;
}

function emptyNote(lab: Lab): HTMLElement {
  const note = h(
    "p",
    { class: "lrp-empty" },
    "No machine yet. Double-click here to draw a state, or write ",
    h("code", {}, "(machine m (state s)) (spawn m s)"),
  );
  lab.store.watch(["program", "snapshot"], () => {
    note.hidden = lab.store.state.program.machines.length > 0;
  });
  return note;
}

type Point = { x: number; y: number };

export function stateMenu(lab: Lab, path: string, at: Point, open: () => void): (MenuItem | null)[] {
  const nested = lab.store.state.program.machines.some((machine) => machine.parent === path);
  return [
    { label: "Transition here", action: "transition", run: () => void lab.act({ do: "transition", path }) },
    { label: "Teleport here", action: "teleport", run: () => void lab.act({ do: "teleport", path }) },
    { label: "Why?", action: "why", run: () => askWhy(lab, "state", path, at), hint: "?" },
    ...breakpointItems(lab, "state", path),
    null,
    { label: "Open nested machine", action: "open", run: open, disabled: !nested, hint: "⇧⏎" },
    { label: "Inspect", action: "inspect", run: () => lab.inspect("state", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("state", path), hint: "⏎" },
    { label: "Rename…", action: "rename", run: () => lab.rename("state", path) },
  ];
}

export function transitionMenu(lab: Lab, path: string, at: Point): (MenuItem | null)[] {
  return [
    { label: "Fire now", action: "fire", run: () => void lab.act({ do: "fire", path }) },
    { label: "Why not?", action: "why", run: () => askWhy(lab, "transition", path, at), hint: "?" },
    ...breakpointItems(lab, "transition", path),
    null,
    { label: "Inspect", action: "inspect", run: () => lab.inspect("transition", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("transition", path), hint: "⏎" },
  ];
}
