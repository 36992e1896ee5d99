/** Pointer and keyboard in the world: select, move, turn, resize, place, draw, erase, look around. */

import type { Point } from "../protocol";
import { consume } from "../ui/dom";
import { type Drag, trackDrag } from "../ui/drag";
import { onPinch } from "../ui/pinch";
import { type Point as Px, pointOf, reachOf } from "../ui/point";
import type { Placed, WorldEdits } from "./edits";
import { REACH } from "./legend";
import { GRIP, gripAt } from "./overlay";
import type { Stage } from "./stage";
import { covers, dragged, drawn, type Grip, type Shape, type Thing, thingAt } from "./things";

export type Tool = "move" | "draw" | "erase" | Placed;

const SEND_EVERY = 40; // ms
const WIDTH = { draw: 0.03, erase: 0.08 };
const CATCH = 6; // px around a thin thing

/** What a press does in the world; `end` also ends a click. */
interface Press {
  scrolls?: Drag["scrolls"];
  move(at: Point, due: boolean, steps: boolean): void;
  end(moved: boolean): void;
  cancel?(): void;
}

export interface ToolBox {
  readonly tool: Tool;
  choose(tool: Tool): void;
  grid(): void;
  follow(): void;
}

export function useTools(stage: Stage, edits: WorldEdits, box: ToolBox): void {
  const { canvas } = stage;
  let isPressed = false;
  const at = ({ x, y }: Px): Point => {
    const frame = canvas.getBoundingClientRect();
    return [x - frame.left, y - frame.top];
  };
  const local = (event: MouseEvent): Point => at(pointOf(event));
  onPinch(canvas, (factor, middle, dx, dy) => {
    stage.pan(dx, dy);
    stage.zoom(factor, ...at(middle));
  });

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !stage.world || !stage.latest || isPressed) return;
    canvas.focus({ preventScroll: true });
    edits.flush();
    const press = beginning(event);
    let sent = 0;
    isPressed = true;
    trackDrag(canvas, event, {
      scrolls: press.scrolls,
      begin() {
        stage.busy = true;
      },
      move(now) {
        const due = now.timeStamp - sent > SEND_EVERY;
        if (due) sent = now.timeStamp;
        press.move(local(now), due, now.shiftKey);
      },
      end(released, moved) {
        isPressed = stage.busy = false;
        if (released) press.end(moved);
        else press.cancel?.();
      },
    });
  });

  /** What a pointer that goes down begins. */
  function beginning(event: PointerEvent): Press {
    const at = local(event);
    const point = stage.viewport.inside(...at);
    const held = heldAt(point, event);
    const thing = thingUnder(point, event);
    const { tool } = box;
    if (stage.isPast && (held || tool !== "move" || thing)) return returning(thing);
    if (held) return dragging(held.thing, held.shape, held.grip, held.from);
    if (tool === "draw" || tool === "erase") return drawing(point, tool);
    const shape = thing && stage.shape(thing);
    if (tool !== "move" && thing?.kind !== "robot") return placing(point, tool);
    if (!thing || !shape) return panning(event, at, point);
    return dragging(thing, shape, event.shiftKey && thing.kind !== "zone" ? "turn" : "move", point);
  }

  /** What would be dragged is elsewhere now, so a drag shows the present instead. */
  function returning(thing: Thing | null): Press {
    let isBack = false;
    return {
      move() {
        if (!isBack) isBack = edits.showNow();
      },
      end(moved) {
        if (!moved) edits.select(thing);
      },
    };
  }

  function momentUnder([x, y]: Point, event: PointerEvent): number | null {
    const reach = reachOf(event, REACH) / stage.viewport.scale;
    const found = stage.showsTrail.on && box.tool === "move" && stage.trail.near(x, y, reach);
    return found ? found.time : null;
  }

  function heldAt(
    point: Point,
    event: PointerEvent,
  ): { thing: Thing; shape: Shape; grip: Grip; from: Point } | null {
    const thing = stage.selected;
    const shape = thing && stage.shape(thing);
    const held = thing && shape && gripAt(thing, shape, point, stage.viewport.scale, reachOf(event, GRIP));
    return held ? { thing, shape, grip: held.grip, from: held.at } : null;
  }

  function thingUnder(point: Point, event: PointerEvent): Thing | null {
    const reach = reachOf(event, CATCH) / stage.viewport.scale;
    return stage.world && thingAt(stage.world, (thing) => stage.shape(thing), point, reach);
  }

  function panning(event: PointerEvent, begin: Point, from: Point): Press {
    let last = begin;
    const { follows } = stage;
    const move = (at: Point) => {
      stage.pan(at[0] - last[0], at[1] - last[1]);
      last = at;
    };
    return {
      scrolls: "all",
      move,
      end(moved) {
        const moment = moved ? null : momentUnder(from, event);
        if (moment !== null) edits.look(moment);
        else if (!moved) edits.select(zoneAround(from));
      },
      cancel() {
        if (last === begin) return;
        move(begin);
        if (follows) stage.follows = true;
      },
    };
  }

  /** The smallest zone around a point: a click into it selects it. */
  function zoneAround(point: Point): Thing | null {
    const around = Object.keys(stage.world?.zones ?? {})
      .map((name): Thing => ({ kind: "zone", name }))
      .map((thing) => ({ thing, shape: stage.shape(thing) }))
      .filter(({ shape }) => shape && covers(shape, point, 0));
    const size = ({ shape }: (typeof around)[number]) => shape!.radius ?? Math.max(...shape!.box!) / 2;
    return around.sort((one, other) => size(one) - size(other))[0]?.thing ?? null;
  }

  function dragging(thing: Thing, shape: Shape, grip: Grip, from: Point): Press {
    let next = shape;
    const before = stage.draftOf(thing);
    return {
      move(at, due, turn) {
        const to = stage.viewport.inside(...at);
        const really = turn && grip === "move" && thing.kind !== "zone" ? "turn" : grip;
        next = dragged(shape, really, from, to);
        if (due && grip !== "size") edits.drag(thing, next);
        else stage.setDraft(thing, next);
      },
      end(moved) {
        if (moved) edits.put(thing, next);
        edits.select(thing);
      },
      cancel() {
        if (next !== shape) edits.drag(thing, shape);
        stage.setDraft(thing, before);
      },
    };
  }

  function placing(begin: Point, kind: Placed): Press {
    let shape = drawn(kind, begin, begin);
    return {
      move(at, _, steps) {
        stage.outline = shape = drawn(kind, begin, stage.viewport.inside(...at), steps);
        stage.wake();
      },
      end() {
        stage.outline = null;
        edits.add(kind, shape);
      },
      cancel() {
        stage.outline = null;
        stage.wake();
      },
    };
  }

  function drawing(begin: Point, kind: "draw" | "erase"): Press {
    const width = WIDTH[kind];
    const grey = kind === "draw" ? 0 : (stage.world?.floor.grey ?? 255);
    const points: Point[] = [begin];
    const straight: Point[] = [begin, begin];
    let path = points;
    stage.sketch = { path, width, grey };
    stage.wake();
    return {
      move(at, _, steps) {
        const point = stage.viewport.inside(...at);
        const [x, y] = points.at(-1)!;
        if (Math.hypot(point[0] - x, point[1] - y) > width / 4) points.push(point);
        straight[1] = point;
        path = steps ? straight : points;
        stage.sketch = { path, width, grey };
        stage.wake();
      },
      end() {
        edits.stroke(kind === "draw" ? "stroke" : "erase", path, width);
      },
      cancel() {
        stage.sketch = null;
        stage.wake();
      },
    };
  }

  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
      event.preventDefault();
      stage.zoom(Math.exp(-event.deltaY * 0.002), ...local(event));
    },
    { passive: false },
  );
  canvas.addEventListener("pointermove", (event) => {
    if (!stage.world || !stage.latest || event.buttons) return;
    const point = stage.viewport.inside(...local(event));
    const held = heldAt(point, event);
    const thing = thingUnder(point, event);
    const still = momentUnder(point, event) === null ? "default" : "pointer";
    const free = box.tool === "move" ? still : "crosshair";
    const over = thing && (box.tool === "move" || thing.kind === "robot");
    canvas.style.cursor = held ? "pointer" : over ? "grab" : free;
  });
  canvas.addEventListener("blur", () => edits.flush());
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !stage.world) return;
    if (!pressed(event.key, event.shiftKey)) return;
    consume(event);
  });

  /** What a key does; false for keys that are not the world's. */
  function pressed(key: string, shift: boolean): boolean {
    const { tool } = box;
    const places = tool === "wall" || tool === "box" || tool === "zone";
    if (isPressed) return true; // no key changes what is dragged
    if (edits.nudge(key, shift)) return true;
    if (key === "Delete" || key === "Backspace") edits.remove();
    else if (key === "Enter" && places)
      edits.add(tool, drawn(tool, stage.viewport.middle, stage.viewport.middle));
    else if (key === "n" || key === "N") edits.selectNext(shift ? -1 : 1);
    else if (key === "g") box.grid();
    else if (key === "f") box.follow();
    else if (key === "+" || key === "=") stage.zoom(1.25);
    else if (key === "-") stage.zoom(1 / 1.25);
    else if (key === "0") stage.showAll();
    else if (key === "Escape" && (stage.selected || tool !== "move")) {
      edits.select(null);
      box.choose("move");
    } else return false;
    return true;
  }
}
