/** The state graph of the machine shown: drawing, marks, zoom and pan, menus. */

import { nameOf, parentOf } from "../language/paths";
import { reachWords } from "../parts/coverage";
import { looked, showLock } from "../parts/study";
import { pathView } from "../parts/tree";
import { askWhy } from "../parts/why";
import type { GraphMode, Inside, Layout, StateShape } from "../protocol";
import { inGraph } from "../session/state";
import type { Lab } from "../session/store";
import { button, iconButton, panel } from "../ui/button";
import { consume, h, s, setAttribute, setText } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { item, menuButton, openMenu } from "../ui/menu";
import { pngOfSvg, savePicture, svgDocument } from "../ui/picture";
import { onPinch } from "../ui/pinch";
import { isTouch, middleOf, type Point, pointOf } from "../ui/point";
import { AutoFit } from "./autofit";
import { type Box, Camera } from "./camera";
import { CountBars, cardOf } from "./countdowns";
import { drawReached } from "./covered";
import { drawDots } from "./dots";
import { Dragging } from "./drag";
import { drawCones, drawMachines } from "./draw";
import { type Drawn, drawnAt, menuOf } from "./elements";
import { keepOneTabStop, walkWithArrows } from "./focus";
import {
  boxAround,
  layoutsIn,
  machinesIn,
  nestAround,
  placesOf,
  type Shape,
  shapeFor,
  unionOf,
  writtenIn,
} from "./inside";
import { marking } from "./marks";
import { attachPencil } from "./pencil";
import { ScrollBars, scroll, scrollByWheel } from "./scroll";
import { flipFollow, followRun, followSwitches, showMachine } from "./shown";

const MODE_WORDS = { live: "Live", static: "Static", hidden: "Hidden" };
const MODES = "Live: redraw after every edit, and show the run. Static: redraw on request.";
const PRIMARY = 1; // the left button, a finger, a pen: of a press with another one the release is a menu's
const RESIZED_FOR = 150; // ms without another size before the kernel gets it

export function graphView(lab: Lab): HTMLElement {
  const { store } = lab;
  const [cones, machines] = [s("g"), s("g")];
  const root = s("g", {}, cones, machines);
  const svg = s("svg", { class: "lrp-graph", role: "group", "aria-label": "State graph" }, root);
  let camera = new Camera();
  let shown = ""; // the machine
  let form: Shape = "one";
  let places: Inside[] = []; // of this machine, or of its whole nest
  let held: Inside[] | null = null; // what they are while a state is dragged: nothing moves under the pointer
  let drawn: Record<string, Layout> = {}; // the layouts of these, and of the machines inside their states
  const mode = () => store.state.settings.graph;

  const mark = marking({ root }, store.state);
  const counts = new CountBars(store.state);
  const place = () => {
    setAttribute(root, "transform", camera.transform);
    if (svg.hasAttribute("viewBox")) print(true);
    counts.place(camera);
    scrollBars.update(camera, contents(), size());
  };
  const size = () => ({ width: svg.clientWidth, height: svg.clientHeight });
  let resizing: ReturnType<typeof setTimeout> | undefined;
  let told = "";
  /** Tell the kernel how much room each machine has. */
  const tellSize = () => {
    const { width, height } = size();
    const parts = places.length || 1;
    const room = {
      width: width / (form === "row" ? parts : 1),
      height: height / (form === "column" ? parts : 1),
    };
    if (!width || !store.state.name || JSON.stringify(room) === told) return;
    clearTimeout(resizing);
    resizing = setTimeout(() => {
      told = JSON.stringify(room);
      lab.send({ do: "fit", ...room });
    }, RESIZED_FOR);
  };
  const scrollBars = new ScrollBars();
  const fitting = new AutoFit(svg, camera, place, () => {
    const { width, height } = size();
    const isSuited = mode() !== "live" || !width || shapeFor(width, height, form) === form;
    if (!isSuited) redraw(true);
    return !isSuited;
  });
  const dragging = new Dragging(
    (path, x, y) => lab.send({ do: "pin", path: parentOf(path), name: nameOf(path), x, y }),
    () => {
      held = null;
      fitting.release();
      store.touch(["layouts"]); // machines may now have to make room
    },
  );
  const contents = (): Box => boxAround(places, drawn);
  /** The state that must be in view: the innermost active one, or where the machine starts. */
  const focus = (): Box | null =>
    boxOf(({ id }) => inGraph(store.state).lit.includes(id)) ?? boxOf(({ start }) => start);
  const boxOf = (isMeant: (shape: StateShape) => unknown): Box | null =>
    places
      .map(({ machine, x, y }) => {
        const found = drawn[machine]?.states.find(isMeant);
        return found ? around(found, x, y) : null;
      })
      .findLast(Boolean) ?? null;
  /** The rectangle around some states. */
  const boxOfAll = (ids: readonly string[]): Box | null => {
    const boxes = ids.flatMap((one) => boxOf(({ id }) => id === one) ?? []);
    return boxes.length ? unionOf(boxes) : null;
  };
  /** Where each state is drawn. */
  const spots = () =>
    new Map(
      places.flatMap(({ machine, x, y }) =>
        (drawn[machine]?.states ?? []).map((state) => [state.id, `${state.x + x} ${state.y + y}`]),
      ),
    );
  const redraw = (force = false) => {
    const { machine, layouts } = store.state;
    svg.toggleAttribute("hidden", mode() === "hidden");
    if (mode() === "hidden" || !layouts[machine]) {
      if (!layouts[machine]) root.setAttribute("visibility", "hidden");
      return;
    }
    root.removeAttribute("visibility");
    const { width, height } = size();
    const next = width && (force || !places.length) ? shapeFor(width, height, form) : form;
    const isKept = shown === machine && store.state.follow !== "active";
    const [lit, before] = [inGraph(store.state).lit, [...spots().keys()]];
    const likely = isKept ? [...lit, ...before] : [...before, ...lit];
    const nest = next === "one" ? [machine] : nestAround(machine, layouts, likely);
    const other = next !== form || places[0]?.machine !== nest[0];
    const parts = nest.flatMap((each) => layoutsIn(each, layouts));
    const old = Object.values(drawn);
    const isHeld =
      !other && held?.length === nest.length && held.every(({ machine }, i) => machine === nest[i]);
    const placed = isHeld ? held! : placesOf(nest, layouts, next, other ? [] : places);
    const isSame =
      !other &&
      parts.length === old.length &&
      parts.every((part, i) => part === old[i]) &&
      placed.every(({ x, y }, i) => x === places[i]?.x && y === places[i]?.y);
    const isChosen =
      shown !== machine && (!shown || store.state.program.machines.some(({ path }) => path === shown));
    if (isSame && !force) {
      if (isChosen) showPart(machine);
      return;
    }
    if (mode() === "static" && !isChosen && !force) {
      element.dataset.stale = "";
      return;
    }
    delete element.dataset.stale;
    const known = spots();
    if (next !== form) store.state.cameras = {}; // they are of another drawing
    form = next;
    places = placed;
    drawn = Object.fromEntries(parts.map((part) => [part.machine, part]));
    const now = [...spots()];
    const fresh = now.flatMap(([id]) => (known.has(id) ? [] : [id]));
    const isRearranged = known.size > 1 && !now.some(([id, spot]) => known.get(id) === spot);
    drawCones(cones, places, layouts, form === "row");
    drawMachines(machines, places, layouts);
    drawDots(root, store.state);
    drawReached(root, store.state);
    keepOneTabStop(svg);
    mark();
    counts.draw(places, drawn);
    svg.setAttribute("aria-label", `State graph of ${nest.map((path) => layouts[path]!.name).join(", ")}`);
    if (other) {
      camera = store.state.cameras[nest[0]!] ??= new Camera();
      fitting.show(camera, contents(), focus());
    } else if (isRearranged) fitting.rearranged(contents(), focus());
    else fitting.update(contents(), fresh.length ? () => boxOfAll(fresh) : null);
    if (isChosen && !other) showPart(machine);
    shown = machine;
    dragging.drawn(parts);
  };
  /** Bring one of the machines that are drawn into view: the user has chosen it. */
  const showPart = (machine: string) => {
    shown = machine;
    const part = places.filter((each) => each.machine === machine);
    if (part.length) fitting.reveal(() => boxAround(part, drawn), true);
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
    const picture = svgDocument(svg, root, contents());
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
      item("Follow the cursor", "menu-follow-cursor", () => flipFollow(store, "cursor"), {
        checked: store.state.follow === "cursor",
      }),
      item("Lay out all states again", "menu-arrange", arrange, { disabled }),
      item("Show all", "menu-zoom-fit", whole, { disabled }),
      item("Zoom in", "menu-zoom-in", () => zoom(1.25), { disabled }),
      item("Zoom out", "menu-zoom-out", () => zoom(1 / 1.25), { disabled }),
      null,
      item("Save as SVG", "save-svg", () => save("svg"), { disabled }),
      item("Save as PNG", "save-png", () => save("png"), { disabled }),
    ];
  });
  const arrange = () => {
    const paths = places.map(({ machine }) => machine);
    places = places.slice(0, 1); // the others stand where there is room again
    for (const path of paths) void lab.act({ do: "arrange", path });
  };
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
    h("div", { class: "lrp-graph-body" }, svg, counts.element, ...scrollBars.elements, emptyNote(lab)),
  );

  if (isLab) heading.after(pathView(lab));

  store.watch(["layouts", "machine", "snapshot"], () => {
    redraw();
    tellSize();
  });
  let before = mode();
  store.watch(["settings"], () => {
    modes.value = element.dataset.mode = mode();
    showLock(modes, store.state.settings, MODES);
    if (mode() !== before) redraw(true);
    before = mode();
  });
  store.watch(
    ["active", "lit", "users", "entered", "fired", "machine", "layouts", "chosen", "settings", "reached"],
    mark,
  );
  store.watch(
    ["countdowns", "time", "lit", "status", "looking", "link", "speed", "achieved_speed", "settings"],
    () => counts.update(),
  );
  store.watch(["breakpoints"], () => drawDots(root, store.state));
  store.watch(["reached", "settings"], () => drawReached(root, store.state));
  followRun(
    lab,
    (running) => (form === "one" ? running.slice(-1) : running).every((machine) => machine in drawn),
    () => !fitting.isQuiet,
    () => fitting.suggest(focus),
    (machine) => {
      store.set("machine", machine);
      redraw(); // also where only the state in which it runs is another one
    },
    // alone, a machine that several use says less than the one that uses it
    (running) => (form === "one" ? writtenIn(running) : running),
  );
  new ResizeObserver(() => {
    fitting.resized(focus());
    tellSize();
  }).observe(svg);
  /** On paper there is all of it, also what one would scroll to. */
  const print = (on: boolean) => {
    const { x, y, width, height } = contents();
    const part = [camera.x + camera.scale * x, camera.y + camera.scale * y];
    setAttribute(svg, "width", on ? width : null);
    setAttribute(
      svg,
      "viewBox",
      on ? [...part, camera.scale * width, camera.scale * height].join(" ") : null,
    );
  };
  addEventListener("beforeprint", () => print(true), { signal: lab.closed });
  addEventListener("afterprint", () => print(false), { signal: lab.closed });
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
  onPinch(svg, (factor, middle, dx, dy) => {
    const { x, y } = local(middle);
    fitting.stop();
    camera.pan(dx, dy);
    camera.zoom(factor, x, y);
    place();
  });
  for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"] as const)
    svg.addEventListener(name, ({ buttons }) => fitting.acted((buttons & PRIMARY) > 0), true);
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const node = (event.target as Element).closest<SVGGElement>("[data-lrp-state]");
    if (!node && isTouch(event)) return; // scrolls the page
    let last = local(pointOf(event));
    const { x, y, scale } = camera;
    trackDrag(svg, event, {
      begin() {
        if (!node) return;
        fitting.hold();
        held = places;
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

  const machinesOf = ({ kind, path }: Drawn): string[] => {
    const shapes = Object.values(drawn).flatMap(({ states }) => states);
    const shape = kind === "state" && shapes.find(({ id }) => id === path);
    return shape ? machinesIn(shape) : [];
  };
  const open = (it: Drawn) => {
    const [first] = machinesOf(it);
    if (first) showMachine(store, first);
  };
  const choose = ({ kind, path }: Drawn) => {
    store.set("chosen", path);
    lab.goTo(kind, path);
  };
  const openMenuOf = (it: Drawn, at: Point) => {
    const drawing = acts?.of(it, at) ?? [];
    const title = `${it.kind === "state" ? "State" : "Transition"} ${it.path}`;
    const items = menuOf(lab, it, at, machinesOf(it), (machine) => showMachine(store, machine));
    openMenu(lab.root, at, [...items, null, ...drawing], title);
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
  on("click", (it, { target }) => {
    const spawned = (target as Element).closest("[data-lrp-spawns]")?.getAttribute("data-lrp-spawns");
    if (spawned) showMachine(store, spawned);
    else choose(it);
  });
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
  /** The card of an arrow, also of its label, is of the moment at which it is asked for; so is that of a state. */
  svg.addEventListener("pointerover", ({ target }) => {
    const node = (target as Element).closest("[data-lrp-state]");
    const path = node?.getAttribute("data-lrp-state") ?? "";
    const found = Object.values(drawn)
      .flatMap(({ states }) => states)
      .find(({ id }) => id === path);
    const card = node?.querySelector(":scope > title");
    if (card && found) setText(card, [found.title, reachWords(store.state, "state", path)].join("\n").trim());
    const part = (target as Element).closest("[data-of]");
    const machine = part?.closest("[data-drawing]")?.getAttribute("data-drawing") ?? "";
    const [id, source] = [part?.getAttribute("data-of"), part?.getAttribute("data-key")?.split(" ").at(-2)];
    const shape = drawn[machine]?.transitions.find((each) => each.id === id && each.source === source);
    if (!part || !shape) return;
    const isLabel = part.localName === "text";
    const title = part.querySelector(":scope > title") ?? s("title");
    if (isLabel) part.append(title); // only while it is pointed at: a label is a text
    title.textContent = cardOf(store.state, shape, machine);
    if (isLabel) part.addEventListener("pointerleave", () => title.remove(), { once: true });
  });
  walkWithArrows(svg, (focused) => {
    const { left, top, width, height } = focused.getBoundingClientRect();
    const corner = local({ x: left, y: top });
    const [x, y] = camera.inside(corner.x, corner.y);
    const box = { x, y, width: width / camera.scale, height: height / camera.scale };
    fitting.reveal(() => box, true);
  });
  const acts = lab.pen && attachPencil(lab, svg, root, lab.pen, (path, x, y) => dragging.put(path, x, y));
  return element;
}

function around({ x, y, width, height }: StateShape, left: number, top: number): Box {
  return { x: left + x - width / 2, y: top + y - height / 2, width, height };
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
