/**
 * Draw a layout as SVG. Python computed all positions, for this picture and the still one; here they only
 * become elements, which are reused while their state or transition exists.
 */

import { parentOf } from "../language/paths";
import type { Inside, Label, Layout, Port, SpawnedLine, StateShape, TransitionShape } from "../protocol";
import { reconcile, s, setAttribute, setText } from "../ui/dom";
import { machinesIn } from "./inside";

const STATE_FONT = 13;
const LABEL_FONT = 11.5;
const LABEL_LINE = 13.5; // px from one line of a label to the next
const NAME_ABOVE = 26; // px: a name above the machines inside the state
const NESTED_LETTER = 6.3; // px, about
const NAMED = 36; // px: height of a state with its name only
const LINE = 16; // px: height of a line below a name, and width of what is before it
const SETTINGS = 6; // px between a machine and the values that it gets
const LIFT = 0.35; // of the font size: from the middle of a letter to its base line

export interface Layers {
  root: SVGGElement;
  frame: SVGGElement;
  arrows: SVGGElement;
  ports: SVGGElement;
  states: SVGGElement;
  halos: SVGGElement;
  labels: SVGGElement;
}

export function makeLayers(): Layers {
  const layer = (name: string) => s("g", { class: `lrp-layer-${name}` });
  const [frame, arrows, ports] = [layer("frame"), layer("arrows"), layer("ports")];
  const [states, halos, labels] = [layer("states"), layer("halos"), layer("labels")];
  // labels last, and their halos before all of them: no halo covers another label
  const root = s("g", {}, frame, arrows, ports, states, halos, labels);
  return { root, frame, arrows, ports, states, halos, labels };
}

/** Draw one machine; `layouts` holds those of the machines drawn inside its states. */
export function draw(layers: Layers, layout: Layout, layouts: Record<string, Layout> = {}): void {
  const { transitions } = layout;
  const keys = arrowKeys(transitions);
  const key = (shape: TransitionShape) => keys.get(shape) ?? "";
  drawFrame(layers.frame, layout);
  reconcile(layers.arrows, transitions, key, makeArrow, (element, shape) => updateArrow(element, shape));
  reconcile(layers.ports, layout.ports, (port) => `${port.name} ${port.x} ${port.y}`, makePort, updatePort);
  reconcile(
    layers.states,
    layout.states,
    (shape) => shape.id,
    makeState,
    (element, shape) => updateState(element, shape, layouts),
  );
  reconcile(layers.halos, transitions, key, makeText, (element, shape) => {
    updateLabel(element, shape.label, "lrp-halo");
    setAttribute(element, "data-of", shape.id);
  });
  reconcile(layers.labels, transitions, key, makeText, (element, shape) => {
    updateLabel(element, shape.label, shape.broken ? "lrp-label lrp-off" : "lrp-label");
    setAttribute(element, "data-of", shape.id);
  });
}

/** A transition with several sources has several arrows: each gets a key of its own. */
function arrowKeys(shapes: TransitionShape[]): Map<TransitionShape, string> {
  const seen = new Map<string, number>();
  return new Map(
    shapes.map((shape) => {
      const plain = `${shape.id} ${shape.source}`;
      const count = seen.get(plain) ?? 0;
      seen.set(plain, count + 1);
      return [shape, `${plain} ${count}`];
    }),
  );
}

function drawFrame(layer: SVGGElement, layout: Layout): void {
  const [x = 0, y = 0, width = 0, height = 0] = layout.frame;
  const outer = parentOf(layout.machine);
  layer.replaceChildren(
    s("rect", { class: "lrp-frame", x, y, width, height, rx: 8 }),
    s(
      "text",
      { class: "lrp-machine", x: x + 12, y: y + 19 },
      layout.name,
      outer ? s("tspan", { class: "lrp-within", dx: 6 }, `in ${outer}`) : null,
    ),
  );
  if (!layout.states.length) {
    layer.append(text("lrp-faint", x + width / 2, y + height / 2 + 12, "no states yet"));
  }
}

function makeArrow(shape: TransitionShape): SVGGElement {
  return s(
    "g",
    { role: "button", tabindex: "-1", "data-of": shape.id },
    s("title"),
    s("path", { class: "lrp-hit" }),
    s("path", { class: "lrp-glow" }),
    s("path", { class: "lrp-shaft" }),
    s("path", { class: "lrp-head" }),
    s("path", { class: "lrp-mark" }),
  );
}

function updateArrow(element: Element, shape: TransitionShape): void {
  const broken = shape.broken ? " lrp-broken" : "";
  setAttribute(element, "class", `lrp-transition lrp-${shape.style}${broken}`);
  setAttribute(element, "data-broken", shape.broken);
  setAttribute(element, "data-lands", shape.lands);
  setAttribute(element, "data-lrp-transition", `${shape.id.split(":")[0]}:${shape.name}`);
  const words = `transition ${shape.name} from ${shape.source === "*" ? "any state" : shape.source} to ${shape.destination}`;
  setAttribute(element, "aria-label", shape.broken ? `${words}, broken: ${shape.broken}` : words);
  const [title, hit, glow, shaft, head, mark] = element.children;
  setText(title!, shape.title);
  for (const path of [hit, glow, shaft]) setAttribute(path!, "d", shape.d);
  setAttribute(head!, "d", shape.head);
  setAttribute(mark!, "d", shape.mark);
}

function makeState(shape: StateShape): SVGGElement {
  const own = shape.kind === "any" ? {} : { "data-lrp-state": shape.id };
  const focus = shape.kind === "state" ? { tabindex: "-1" } : {};
  return s("g", { ...own, ...focus });
}

function updateState(element: Element, shape: StateShape, layouts: Record<string, Layout>): void {
  const open = shape.inside.length ? " lrp-open" : "";
  setAttribute(element, "class", `lrp-state lrp-${shape.kind}${open}`);
  if (shape.kind === "state") {
    const lines = shape.spawns.map(({ name, settings }) => `${name} ${settings}`.trim());
    const shown = [shape.label, shape.nested, ...lines].filter(Boolean).join(" "); // a name begins with what is seen
    setAttribute(element, "aria-label", `${shown}: state ${shape.title}`);
    setAttribute(element, "role", shape.inside.length ? "group" : "button");
  }
  const dragged = element.hasAttribute("data-dragged");
  if (!dragged) moveState(element, shape.x, shape.y);
  const body = JSON.stringify({
    ...shape,
    x: 0,
    y: 0,
    start: null,
    from: shape.start && shape.start.x - shape.x,
  });
  if (element.getAttribute("data-body") !== body) {
    element.setAttribute("data-body", body);
    element.replaceChildren(...stateBody(shape));
  }
  drawMachines(element, shape.inside, layouts);
}

const drawings = new WeakMap<Element, Map<string, Layers>>();

/** Draw machines in an element, where they are placed; their elements are reused, too. */
export function drawMachines(
  parent: Element,
  places: readonly Inside[],
  layouts: Record<string, Layout>,
): void {
  const before = drawings.get(parent);
  const now = new Map<string, Layers>();
  for (const { machine, x, y } of places) {
    const layout = layouts[machine];
    if (!layout) continue;
    const layers = before?.get(machine) ?? makeLayers();
    now.set(machine, layers);
    setAttribute(layers.root, "data-drawing", machine);
    setAttribute(layers.root, "transform", `translate(${x} ${y})`);
    if (layers.root.parentNode !== parent) parent.append(layers.root);
    draw(layers, layout, layouts);
  }
  for (const [machine, { root }] of before ?? []) if (!now.has(machine)) root.remove();
  drawings.set(parent, now);
}

/** Join each machine with the states in which it runs, where both are drawn: as if seen through a lens. */
export function drawCones(
  layer: Element,
  places: readonly Inside[],
  layouts: Record<string, Layout>,
  isRow: boolean,
): void {
  const cones = places.slice(1).flatMap(({ machine, x, y }, index) => {
    const around = places[index]!;
    const users = layouts[around.machine]?.states.filter((shape) => machinesIn(shape).includes(machine));
    const [left = 0, top = 0, width = 0, height = 0] = layouts[machine]?.frame ?? [];
    return (users ?? []).map((shape) => {
      const state = { x: around.x + shape.x, y: around.y + shape.y };
      const [right, low] = [state.x + shape.width / 2, state.y + shape.height / 2];
      const d = isRow
        ? `M${x + left} ${y + top}L${right} ${low - shape.height}V${low}L${x + left} ${y + top + height}`
        : `M${x + left} ${y + top}L${right - shape.width} ${low}H${right}L${x + left + width} ${y + top}`;
      return { key: `${shape.id} ${machine}`, d };
    });
  });
  const make = () => s("path", { class: "lrp-cone" });
  reconcile(
    layer,
    cones,
    ({ key }) => key,
    make,
    (cone, { d }) => setAttribute(cone, "d", d),
  );
}

/** The body is drawn around its centre, so that moving a state changes one attribute. */
export function moveState(element: Element, x: number, y: number): void {
  setAttribute(element, "transform", `translate(${x} ${y})`);
}

/** Where a state is drawn. */
export function placeOf(element: Element): [x: number, y: number] {
  const [x = 0, y = 0] = (element.getAttribute("transform")?.match(/-?[\d.]+/g) ?? []).map(Number);
  return [x, y];
}

function stateBody(shape: StateShape): SVGElement[] {
  const { width, height } = shape;
  const [left, top] = [-width / 2, -height / 2];
  const rx = shape.kind === "any" ? height / 2 : 9;
  const parts: SVGElement[] = [
    s("title", {}, shape.title),
    s("rect", { class: "lrp-box", x: left, y: top, width, height, rx }),
  ];
  if (shape.nested) {
    const inner = { x: left + 3.5, y: top + 3.5, width: width - 7, height: height - 7, rx: 6 };
    const line = top + NAMED;
    const half = shape.nested.length * NESTED_LETTER * 0.5;
    const symbol = icon(NESTED, -half - 4, line);
    parts.push(s("rect", { class: "lrp-inner", ...inner }));
    parts.push(s("g", { class: "lrp-nested" }, " ", symbol, text("", 7, line + 4, shape.nested)));
  }
  const middle = top + (shape.inside.length ? NAME_ABOVE : NAMED) / 2;
  const isAbove = shape.nested || (shape.spawns.length && !shape.inside.length);
  parts.push(text("lrp-name", 0, middle + (isAbove ? 5.5 : STATE_FONT * LIFT), shape.label));
  parts.push(...shape.spawns.map(spawnedLine));
  if (shape.start) {
    const { x, y, radius, d, head } = shape.start;
    parts.push(
      s(
        "g",
        { class: "lrp-start", transform: `translate(${-shape.x} ${-shape.y})` },
        s("circle", { cx: x, cy: y, r: radius }),
        s("path", { class: "lrp-start-shaft", d }),
        s("path", { d: head }),
      ),
    );
  }
  return parts;
}

/** A machine that runs in a state and is defined elsewhere: a press shows it. */
function spawnedLine({ machine, name, settings, title, x, y, width }: SpawnedLine): SVGGElement {
  const hit = { x: x - 4, y: y - LINE / 2, width: width + 8, height: LINE };
  return s(
    "g",
    { class: "lrp-nested lrp-spawned", "data-lrp-spawns": machine },
    s("title", {}, title),
    s("rect", { class: "lrp-spawned-hit", ...hit, rx: 4 }),
    " ",
    icon(JOINED, x + 5, y),
    s("text", { x: x + LINE, y: y + 4 }, name, settings ? s("tspan", { dx: SETTINGS }, settings) : null),
  );
}

const NESTED = "M-6 -4h5v4h-5zM1 1h5v4h-5zM-3.5 0v3h4.5"; // two small states and an arrow
const JOINED = "M-5 -5h7v7h-7zM-2 -2h7v7h-7z"; // two squares, one behind the other

function icon(d: string, x: number, y: number): SVGPathElement {
  return s("path", { class: "lrp-nested-icon", d, transform: `translate(${x} ${y})` });
}

function makePort(): SVGGElement {
  return s("g", {}, s("circle", { class: "lrp-port", r: 4.5 }), s("text", { class: "lrp-outside" }));
}

function updatePort(element: Element, port: Port): void {
  const [circle, label] = element.children;
  setAttribute(circle!, "cx", port.x);
  setAttribute(circle!, "cy", port.y);
  updateLabel(label!, port.label, port.missing ? "lrp-outside lrp-off" : "lrp-outside");
}

function makeText(): SVGTextElement {
  return s("text");
}

function updateLabel(element: Element, label: Label, kind: string): void {
  const lines = label.text.split("\n");
  const first = label.y + LABEL_FONT * LIFT - (LABEL_LINE * (lines.length - 1)) / 2;
  setAttribute(element, "class", kind);
  setAttribute(element, "x", label.x);
  setAttribute(element, "y", first);
  if (lines.length === 1) setText(element, label.text);
  else {
    const spans = lines.map((line, index) =>
      s("tspan", { x: label.x, y: first + index * LABEL_LINE }, index ? ` ${line}` : line),
    );
    element.replaceChildren(...spans);
  }
}

function text(kind: string, x: number, y: number, content: string): SVGTextElement {
  return s("text", { class: kind, x, y }, content);
}
