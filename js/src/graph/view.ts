/** The state graph of the machine shown: drawing, marks, zoom and pan, menus. */

import { nameOf, parentOf } from "../language/paths";
import { looked, showLock } from "../parts/study";
import { pathView } from "../parts/tree";
import { askWhy } from "../parts/why";
import type { GraphMode, Layout, StateShape } from "../protocol";
import { inGraph } from "../session/state";
import type { Lab } from "../session/store";
import { button, iconButton, panel } from "../ui/button";
import { consume, h, s, setAttribute } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { item, menuButton, openMenu } from "../ui/menu";
import { pngOfSvg, savePicture, svgDocument } from "../ui/picture";
import { middleOf, type Point, pointOf } from "../ui/point";
import { calledAfter } from "../ui/timers";
import { AutoFit } from "./autofit";
import { type Box, Camera } from "./camera";
import { drawDots } from "./dots";
import { Dragging } from "./drag";
import { draw, makeLayers } from "./draw";
import { type Drawn, drawnAt, menuOf } from "./elements";
import { keepOneTabStop, walkWithArrows } from "./focus";
import { layoutsIn } from "./inside";
import { marking } from "./marks";
import { attachPencil } from "./pencil";
import { ScrollBars, scroll, scrollByWheel } from "./scroll";
import { followSwitches, showMachine } from "./shown";

const MODE_WORDS = { live: "Live", static: "Static", hidden: "Hidden" };
const MODES = "Live: redraw after every edit, and show the run. Static: redraw on request.";
const PRIMARY = 1; // the left button, a finger, a pen: of a press with another one the release is a menu's
const RESIZED_FOR = 150; // ms without another size before the kernel gets it
const ACTIVE_FOR = 300; // ms that a state is active before it is brought into view

export function graphView(lab: Lab): HTMLElement {
  const { store } = lab;
  const layers = makeLayers();
  const svg = s("svg", { class: "lrp-graph", role: "group", "aria-label": "State graph" }, layers.root);
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

  // a hidden one is shown again by the menu, which only a whole lab has
  const isLab = lab.root.dataset.part === "lab";
  const MODE_NAMES: GraphMode[] = ["live", "static", ...(isLab ? (["hidden"] as const) : [])];
  const setMode = (graph: GraphMode) => void lab.act({ do: "graph", mode: graph });
  const modes = h(
    "select",
    {
      class: "lrp-select",
      "aria-label": "When the graph is redrawn",
      title: MODES,
      "data-lrp-action": "graph-mode",
      onchange: () => setMode(modes.value as GraphMode),
    },
    ...MODE_NAMES.map((name) => h("option", { value: name }, name)),
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
  const about = { title: "More for the graph", action: "graph-menu" };
  const nest = () => void lab.act({ do: "nest", on: !isNested() });
  const more = menuButton(lab.root, about, "State graph", () => {
    const disabled = !shown;
    return [
      item("Nested machines inside their states", "nest", nest, {
        checked: isNested(),
        disabled: !store.state.program.machines.some(({ parent }) => parent),
      }),
      null,
      ...MODE_NAMES.map((name) =>
        item(MODE_WORDS[name], `graph-${name}`, () => setMode(name), {
          checked: mode() === name,
          disabled: store.state.settings.lock,
        }),
      ),
      null,
      item("Lay out all states again", "menu-arrange", arrange, { disabled }),
      item("Zoom in", "menu-zoom-in", () => zoom(1.25), { disabled }),
      item("Zoom out", "menu-zoom-out", () => zoom(1 / 1.25), { disabled }),
      null,
      item("Save as SVG", "save-svg", () => save("svg"), { disabled }),
      item("Save as PNG", "save-png", () => save("png"), { disabled }),
    ];
  });
  const arrange = () => void lab.act({ do: "arrange", path: store.state.machine });
  const { element, heading } = panel(
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
      iconButton("arrange", "Lay out all states again", "arrange", arrange),
      ...followSwitches(store),
      iconButton("minus", "Zoom out", "zoom-out", () => zoom(1 / 1.25)),
      iconButton("plus", "Zoom in", "zoom-in", () => zoom(1.25)),
      iconButton("fit", "Show all", "zoom-fit", whole),
      more,
    ],
    h("div", { class: "lrp-graph-body" }, svg, ...scrollBars.elements, emptyNote(lab)),
  );

  if (isLab) heading.after(pathView(lab));

  store.watch(["layouts", "machine", "snapshot"], () => redraw());
  let before = mode();
  store.watch(["settings"], () => {
    modes.value = element.dataset.mode = mode();
    showLock(modes, store.state.settings, MODES);
    if (mode() !== before) redraw(true);
    before = mode();
  });
  store.watch(
    ["lit", "entered", "fired", "machine", "layouts", "chosen", "settings"],
    marking(layers, store.state),
  );
  store.watch(["breakpoints"], () => drawDots(layers.root, store.state));
  const follow = calledAfter(ACTIVE_FOR, () => {
    if (store.state.follow === "active") fitting.reveal(focus);
  });
  store.watch(["lit", "follow"], () => {
    if (store.state.follow === "active" && mode() === "live") follow();
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
  lab.root.addEventListener("keydown", ({ key }) => void (FUNCTION_KEY.test(key) || fitting.acted()), true);

  /* ---------------------------------------------------------------- zoom, pan, drag */

  const local = ({ x, y }: Point): Point => {
    const frame = svg.getBoundingClientRect();
    return { x: x - frame.left, y: y - frame.top };
  };
  svg.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const { x, y } = local(pointOf(event));
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
  for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"] as const)
    svg.addEventListener(name, ({ buttons }) => fitting.acted((buttons & PRIMARY) > 0), true);
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const node = (event.target as Element).closest<SVGGElement>("[data-lrp-state]");
    let last = local(pointOf(event));
    const { x, y, scale } = camera;
    trackDrag(svg, event, {
      begin() {
        if (!node) return;
        fitting.hold();
        dragging.begin(node);
      },
      move(now) {
        const point = local(pointOf(now));
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
        } else if (released) dragging.drop();
        else dragging.cancel();
      },
    });
  });

  /* ---------------------------------------------------------------- choose, open, menu */

  const open = ({ kind, path }: Drawn) => {
    const shapes = drawn.flatMap(({ states }) => states);
    const inner = kind === "state" && shapes.find((shape) => shape.id === path)?.machines[0];
    if (inner) showMachine(store, `${path}/${inner}`);
  };
  const choose = ({ kind, path }: Drawn) => {
    store.set("chosen", path);
    lab.goTo(kind, path);
  };
  const openMenuOf = (it: Drawn, at: Point) => {
    const drawing = acts?.of(it, at) ?? [];
    const title = `${it.kind === "state" ? "State" : "Transition"} ${it.path}`;
    openMenu(lab.root, at, [...menuOf(lab, it, at, () => open(it)), null, ...drawing], title);
  };
  /** Let an event act on the state or transition that it is about. */
  const on = <K extends "click" | "dblclick" | "contextmenu" | "keydown">(
    name: K,
    act: (it: Drawn, event: SVGElementEventMap[K]) => unknown,
  ) =>
    svg.addEventListener(name, (event) => {
      const it = drawnAt(event.target);
      if (it && act(it, event)) consume(event);
    });
  on("click", choose);
  on("dblclick", open);
  on("contextmenu", (it, event) => {
    if (event.button !== 2 && event.detail === 0) return false; // by key: see below
    openMenuOf(it, pointOf(event));
    return true;
  });
  on("keydown", (it, { key, shiftKey, target }) => {
    const at = middleOf(target as Element);
    if (key === "Enter" && shiftKey) open(it);
    else if (key === "Enter" || key === " ") choose(it);
    else if (key === "?") askWhy(lab, it.kind, it.path, at);
    else if (key === "ContextMenu" || (key === "F10" && shiftKey) || key === "m") openMenuOf(it, at);
    else return false;
    return true;
  });
  walkWithArrows(svg, (focused) => {
    const { left, top, width, height } = focused.getBoundingClientRect();
    const corner = local({ x: left, y: top });
    const [x, y] = camera.inside(corner.x, corner.y);
    const box = { x, y, width: width / camera.scale, height: height / camera.scale };
    fitting.reveal(() => box, true);
  });
  const acts =
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
