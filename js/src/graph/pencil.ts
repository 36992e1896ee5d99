/**
 * Drawing with the mouse: a double click on free space makes a state, a drag from the border of a state a
 * transition, a drag of an end of the selected transition leads it elsewhere, and a state that is dropped on
 * another one goes inside. It reads what is drawn from the SVG alone, so it works at every zoom.
 */

import type { Pen } from "../editor/pen";
import { machineOf as machineOfPath, nameOf, parentOf } from "../language/paths";
import type { Lab } from "../session/store";
import { consume, focusLab, s, setAttribute } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { openMenu } from "../ui/menu";
import { middleOf, type Point, pointOf, reachOf } from "../ui/point";
import { focusedAround } from "../ui/root";
import { Acts } from "./acts";
import { placeOf } from "./draw";
import { drawnAt } from "./elements";
import { machinesIn } from "./inside";

const NEAR = 7; // px from the border of a state that count as the border
const ELSEWHERE =
  "A transition leads to a state of its own machine, or to one of the machine that spawns it. Release it there, or on free space.";
const HANDLE = 6; // px, radius of the end of a selected transition

/** `put` pins a state to a place. */
export function attachPencil(
  lab: Lab,
  svg: SVGSVGElement,
  root: SVGGElement,
  pen: Pen,
  put: (path: string, x: number, y: number) => void,
): Acts {
  const host = svg.parentElement!;
  const layer = s("g", { class: "lrp-layer-pencil" });
  const line = s("path", { class: "lrp-rubber", hidden: "" });
  root.append(layer);
  layer.append(line);

  /* ---------------------------------------------------------------- what is at a point */

  /** A point of the window in the drawing, or in that of a nested machine. */
  const inside = ({ x, y }: Point, drawing: SVGGraphicsElement = root): [number, number] => {
    const matrix = drawing.getScreenCTM();
    if (!matrix) return [0, 0];
    const point = new DOMPoint(x, y).matrixTransform(matrix.inverse());
    return [point.x, point.y];
  };
  const client = (x: number, y: number, drawing: SVGGraphicsElement = root): Point => {
    const matrix = drawing.getScreenCTM();
    return matrix ? new DOMPoint(x, y).matrixTransform(matrix) : { x, y };
  };
  /** All states, the topmost first. */
  const boxes = () => [...root.querySelectorAll<SVGGElement>(".lrp-state")].reverse();
  const frameOf = (node: Element) => (node.querySelector(".lrp-box") ?? node).getBoundingClientRect();
  const acts = new Acts(lab, pen, (...paths) =>
    boxes().flatMap((node) => (paths.includes(pathOf(node)) ? [frameOf(node)] : [])),
  );
  const machineOf = (node: Element | undefined) =>
    node?.closest("[data-drawing]")?.getAttribute("data-drawing") ?? undefined;
  /** The path of a state, `m/*` for the fictional one of the wildcards. */
  const pathOf = (node: Element) => node.getAttribute("data-lrp-state") ?? `${machineOf(node)}/*`;
  const isReal = (node: Element) =>
    node.classList.contains("lrp-state") && node.hasAttribute("data-lrp-state");
  const within = ({ x, y }: Point, { left, right, top, bottom }: DOMRect, margin: number) =>
    x > left - margin && x < right + margin && y > top - margin && y < bottom + margin;
  /** The innermost state around a point: of nested pictures the smallest. */
  const stateAt = (point: Point, except: Element | null = null) =>
    boxes()
      .filter((node) => node !== except && within(point, frameOf(node), 0))
      .sort((a, b) => frameOf(a).width - frameOf(b).width)[0];
  /** The state whose border a press means; beside a state, but in another one, it means the other one. */
  const borderAt = (event: PointerEvent) => {
    const point = pointOf(event);
    const near = reachOf(event, NEAR);
    const around = stateAt(point);
    return boxes().find((node) => {
      const frame = frameOf(node);
      const depth = Math.min(near - 2, frame.height / 5);
      const isOther = around && !around.contains(node);
      return !isOther && within(point, frame, near) && !within(point, frame, -depth);
    });
  };
  /** The end of the selected transition that a press means: the one hit, or of those a finger may mean the nearest. */
  const handleAt = (event: PointerEvent) => {
    const { x, y } = pointOf(event);
    const distance = (handle: Element) => {
      const middle = middleOf(handle);
      return Math.hypot(middle.x - x, middle.y - y);
    };
    const nearest = [...layer.querySelectorAll(".lrp-handle")]
      .filter((handle) => distance(handle) < reachOf(event, 0))
      .sort((one, other) => distance(one) - distance(other))[0];
    return (event.target as Element).closest(".lrp-handle") ?? nearest;
  };
  /** The machine to whose free space a point belongs, and the point in its drawing. */
  const spaceAt = (point: Point): [place: [number, number], machine: string | undefined] => {
    const { machine, layouts } = lab.store.state;
    const isShown = (frame: Element) => machineOf(frame) === machine;
    const frames = machine in layouts ? [...root.querySelectorAll<SVGGElement>(".lrp-frame")] : [];
    const frame =
      frames.findLast((each) => within(point, each.getBoundingClientRect(), 0)) ?? frames.find(isShown);
    return [inside(point, frame?.closest<SVGGElement>("[data-drawing]") ?? root), machineOf(frame)];
  };
  const isFree = (event: MouseEvent) => {
    const target = event.target as Element;
    return (
      !target.closest?.("[data-of], .lrp-state, .lrp-handle, button, select") && !stateAt(pointOf(event))
    );
  };

  /* ---------------------------------------------------------------- a selected transition's ends */

  const handles = () => {
    for (const old of [...layer.querySelectorAll(".lrp-handle")]) old.remove();
    const { chosen } = lab.store.state;
    if (!chosen.includes(":")) return;
    for (const arrow of root.querySelectorAll<SVGGElement>(".lrp-transition")) {
      if (arrow.getAttribute("data-of") !== chosen) continue;
      const shaft = arrow.querySelector<SVGPathElement>(".lrp-shaft");
      if (!shaft?.getTotalLength) continue;
      const source = arrow.getAttribute("data-key")?.split(" ").at(-2) ?? "";
      const at = (length: number) => {
        const { x, y } = shaft.getPointAtLength(length);
        return inside(client(x, y, shaft));
      };
      const points = { source: at(0), destination: at(shaft.getTotalLength()) };
      for (const end of ["source", "destination"] as const) {
        // the source of one that lands is in the machine that it leaves
        if (end === "source" && arrow.hasAttribute("data-lands")) continue;
        const [cx, cy] = points[end];
        const fixed = points[end === "source" ? "destination" : "source"].join(" ");
        layer.append(
          s(
            "circle",
            {
              ...{ class: "lrp-handle", r: HANDLE, cx, cy },
              ...{ "data-end": end, "data-source": source, "data-fixed": fixed },
            },
            s("title", {}, end === "source" ? "Drag to another source" : "Drag to another destination"),
          ),
        );
      }
    }
  };
  lab.store.watch(["layouts", "machine", "chosen", "snapshot"], handles);

  /* ---------------------------------------------------------------- the keyboard's focus */

  let focused: Element | null = null;
  svg.addEventListener("focusin", ({ target }) => {
    focused = target as Element;
  });
  /** Where what had the focus is gone or renamed, the focus stays in the graph: keys would edit cells. */
  lab.store.watch(["layouts", "machine", "snapshot"], () => {
    const now = focusedAround(svg);
    if (!focused || focused.isConnected || (now && now !== document.body && now !== lab.root)) return;
    const next = svg.querySelector<SVGGElement>('[tabindex="0"]');
    focused = null;
    if (next) next.focus({ preventScroll: true });
    else focusLab(svg);
  });

  /* ---------------------------------------------------------------- dragging */

  const rubber = (from: Point, to: Point | null) => {
    setAttribute(line, "hidden", to ? null : "");
    if (!to) return;
    const [x, y] = inside(from);
    const [u, v] = inside(to);
    setAttribute(line, "d", `M${x} ${y}L${u} ${v}`);
  };
  const mark = (node: Element | null | undefined, kind = "") => {
    for (const other of root.querySelectorAll("[data-drop]")) other.removeAttribute("data-drop");
    node?.setAttribute("data-drop", kind);
  };
  const follow = (event: PointerEvent, move: (now: Point) => void, end: (last: Point | null) => void) =>
    trackDrag(svg, event, {
      move: (now) => move(pointOf(now)),
      end(last, moved) {
        mark(null);
        end(last && moved ? pointOf(last) : null);
      },
    });

  /** The states of a machine that spawn another one, those that are active first. */
  const spawners = (machine: string | undefined, inner: string): string[] => {
    const { layouts, lit } = lab.store.state;
    const shapes = layouts[machine ?? ""]?.states ?? [];
    const found = shapes.filter((shape) => machinesIn(shape).includes(inner)).map(({ id }) => id);
    return found.sort((a, b) => Number(lit.includes(b)) - Number(lit.includes(a)));
  };
  /** The trigger that a state is for the machine that spawns its own. */
  const asTrigger = (path: string) => `${nameOf(parentOf(path))}.${nameOf(path)}`;
  /** The arrow at a point that may wait for a state: one of the machine that spawns the state's. */
  const awaiting = ({ x, y }: Point, path: string) => {
    const { elementsFromPoint } = svg.getRootNode() as Document;
    for (const element of elementsFromPoint.call(svg.getRootNode(), x, y)) {
      const id = element.closest("[data-of]")?.getAttribute("data-of");
      const arrows = id ? [...root.querySelectorAll<SVGElement>(".lrp-transition")] : [];
      const arrow = arrows.find((each) => {
        if (each.dataset.of !== id || each.hasAttribute("data-lands")) return false;
        const source = each.getAttribute("data-key")?.split(" ").at(-2) ?? "";
        const users = spawners(machineOfPath(id!), parentOf(path)).map(nameOf);
        return source === "*" ? users.length : users.includes(source);
      });
      if (arrow) return arrow;
    }
    return null;
  };

  const drawTransition = (event: PointerEvent, node: SVGGElement) => {
    const source = pathOf(node);
    const from = pointOf(event);
    /** The state at a point; none in the free space of the machine drawn in, also where that is inside of a state. */
    const targetAt = (now: Point) => {
      const target = stateAt(now);
      return target !== node && target?.contains(node) && spaceAt(now)[1] === machineOf(node) ? null : target;
    };
    follow(
      event,
      (now) => {
        rubber(from, now);
        const target = targetAt(now);
        mark(target && isReal(target) ? target : null, "transition");
      },
      (now) => {
        const end = () => rubber(from, null);
        const target = now && targetAt(now);
        const to = target && isReal(target) ? pathOf(target) : "";
        const users = isReal(node) ? spawners(parentOf(to), parentOf(source)) : [];
        if (!now) end();
        else if (!target)
          acts.newTransition(now, source, "", inside(now, node.parentNode as SVGGElement), end);
        else if (to && parentOf(to) === parentOf(source))
          acts.newTransition(now, source, nameOf(to), null, end);
        else if (users.length) {
          const known = { sources: users, trigger: asTrigger(source) };
          acts.newTransition(now, users[0]!, nameOf(to), null, end, known);
        } else {
          end();
          lab.notify(ELSEWHERE);
        }
      },
    );
  };
  const dragEnd = (event: PointerEvent, handle: Element) => {
    const end = handle.getAttribute("data-end") as "source" | "destination";
    const path = lab.store.state.chosen;
    const [x = 0, y = 0] = (handle.getAttribute("data-fixed") ?? "").split(" ").map(Number);
    const fixed = client(x, y);
    follow(
      event,
      (now) => {
        rubber(fixed, now);
        mark(stateAt(now), "transition");
      },
      (now) => {
        rubber(fixed, null);
        const target = now && stateAt(now);
        if (!target) return;
        const to = nameOf(pathOf(target));
        const old = handle.getAttribute("data-source") ?? "";
        void acts.draw({ act: end, kind: "transition", path, to, old });
      },
    );
  };
  /** Watch a state that the graph moves: dropped on another one, it goes inside. */
  const watchNesting = (event: PointerEvent, node: SVGGElement) => {
    const path = pathOf(node);
    const home = placeOf(node);
    const targetAt = (now: Point) => {
      const target = stateAt(now, node);
      return target && isReal(target) && parentOf(pathOf(target)) === parentOf(path) ? target : null;
    };
    follow(
      event,
      (now) => {
        const target = targetAt(now);
        mark(target ?? awaiting(now, path), target ? "nest" : "trigger");
      },
      async (now) => {
        const target = now && targetAt(now);
        const arrow = now && !target && awaiting(now, path);
        if (arrow) {
          put(path, ...home);
          await acts.awaitState(arrow.dataset.of!, asTrigger(path));
        }
        if (!target) return;
        const refusal = await acts.draw({ act: "nest", kind: "state", path, to: nameOf(pathOf(target)) });
        if (refusal) put(path, ...home);
      },
    );
  };

  svg.addEventListener(
    "pointerdown",
    (event) => {
      if (event.button !== 0) return;
      const handle = handleAt(event);
      const border = handle ? null : borderAt(event);
      if (handle) dragEnd(event, handle);
      else if (border) drawTransition(event, border);
      else {
        const node = stateAt(pointOf(event));
        if (node && isReal(node)) watchNesting(event, node);
        return;
      }
      event.stopImmediatePropagation(); // the graph would move the state
      event.preventDefault();
    },
    true,
  );
  svg.addEventListener("pointermove", (event) => {
    if (!event.buttons) svg.toggleAttribute("data-border", Boolean(borderAt(event)));
  });

  /* ---------------------------------------------------------------- double clicks, menu, keys */

  host.addEventListener(
    "dblclick",
    (event) => {
      const it = drawnAt(event.target);
      const at = pointOf(event);
      const node = stateAt(at);
      if (it?.kind === "transition") acts.edit(it, at);
      else if (node && isReal(node) && !node.querySelector(".lrp-nested"))
        acts.edit({ kind: "state", path: pathOf(node) }, at);
      else if (isFree(event)) acts.newState(at, ...spaceAt(at));
      else return;
      event.stopImmediatePropagation();
      event.preventDefault();
    },
    true,
  );
  host.addEventListener("contextmenu", (event) => {
    if (event.button !== 2 || !isFree(event)) return;
    consume(event);
    openMenu(
      lab.root,
      pointOf(event),
      acts.ofSpace(pointOf(event), ...spaceAt(pointOf(event))),
      "State graph",
    );
  });
  svg.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const it = drawnAt(event.target);
    const at = middleOf((event.target as Element).closest(".lrp-state, .lrp-transition") ?? svg);
    if (event.key === "n") acts.newState(at, null, machineOf(event.target as Element));
    else if (event.key === "t" && it?.kind === "state") acts.newTransition(at, it.path, "");
    else if (event.key === "F2" && it) acts.edit(it, at);
    else if ((event.key === "Delete" || event.key === "Backspace") && it) void acts.delete(it);
    else return;
    consume(event);
  });
  return acts;
}
