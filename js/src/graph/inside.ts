/** The machines of a drawing, and where they stand: nested ones inside their states, or beside the one around them. */

import { isIn, nameOf, parentOf } from "../language/paths";
import type { Inside, Layout, StateShape } from "../protocol";
import type { Box } from "./camera";

type Layouts = Record<string, Layout>;
/** One machine, or the whole nest: one beside or below the other. */
export type Shape = "one" | "row" | "column";

const ROOM = 200_000; // px², from which a panel shows the whole nest
const GAP = 48; // px between two machines
const KEPT = 1.25; // how much more or less changes nothing: a panel's size is not quite still

/** The layouts that a drawing consists of, that of the machine itself first. */
export function layoutsIn(machine: string, layouts: Layouts): Layout[] {
  const layout = layouts[machine];
  if (!layout) return [];
  const inner = layout.states.flatMap(({ inside }) => inside);
  return [layout, ...inner.flatMap((nested) => layoutsIn(nested.machine, layouts))];
}

/** Whether a machine is seen where another one is shown. */
export function isDrawnIn(path: string, shown: string, layouts: Layouts): boolean {
  return layoutsIn(shown, layouts).some(({ machine }) => machine === path);
}

/** What a panel of this size shows; `before`: what it has shown so far. */
export function shapeFor(width: number, height: number, before: Shape): Shape {
  if (width * height < (before === "one" ? ROOM : ROOM / KEPT)) return "one";
  const isClear = before === "one" || Math.abs(Math.log(width / height)) > Math.log(KEPT);
  return isClear ? (width >= height ? "row" : "column") : before;
}

/** The machines that are defined in a state, and those that it spawns from elsewhere. */
export function machinesIn({ id, machines, spawns }: StateShape): string[] {
  return [...machines.map((name) => `${id}/${name}`), ...spawns.map(({ machine }) => machine)];
}

/** Of the machines that run in one another those that are written in the outermost: others may use the rest, too. */
export function writtenIn(machines: string[]): string[] {
  return machines.filter((machine) => isIn(machine, machines[0]!));
}

/** The states on a path as spawned, where they are defined; the outermost first. */
export function statesOn(path: string, layouts: Layouts): string[] {
  const [root = "", ...names] = path.split("/");
  const states: string[] = [];
  let machine = root;
  for (let at = 0; at < names.length; at += 2) {
    const id = `${machine}/${names[at]}`;
    states.push(id);
    const name = names[at + 1] ?? "";
    const shape = layouts[machine]?.states.find((each) => each.id === id);
    machine = (shape && machinesIn(shape).find((each) => nameOf(each) === name)) || `${id}/${name}`;
  }
  return states;
}

/**
 * A machine with those around it and the first ones in it, the outermost first. Of several states in which it may
 * run, the one in the last place of `likely` counts.
 */
export function nestAround(machine: string, layouts: Layouts, likely: readonly string[] = []): string[] {
  const nest = [machine].filter((path) => layouts[path]);
  const shapes = Object.values(layouts).flatMap(({ states }) => states);
  const machineAround = (path: string) => {
    const users = shapes.filter((shape) => machinesIn(shape).includes(path)).map(({ id }) => id);
    const isUser = (id: string) => users.includes(id);
    return parentOf(likely.findLast(isUser) ?? [parentOf(path), ...users].find(isUser) ?? "");
  };
  const isNew = (path: string) => layouts[path] && !nest.includes(path);
  for (let outer = machineAround(machine); isNew(outer); outer = machineAround(outer)) nest.unshift(outer);
  const firstIn = (path: string) => layouts[path]?.states.flatMap(machinesIn).find(isNew);
  for (let inner = firstIn(machine); inner; inner = firstIn(inner)) nest.push(inner);
  return nest.filter((path, index) => !nest.slice(0, index).some((outer) => isDrawnIn(path, outer, layouts)));
}

/** Where machines stand; one that has room where it was `before` stays there. */
export function placesOf(
  nest: readonly string[],
  layouts: Layouts,
  shape: Shape,
  before: readonly Inside[],
): Inside[] {
  const isRow = shape === "row";
  const first = layouts[nest[0] ?? ""];
  let end = Number.NEGATIVE_INFINITY;
  return nest.map((machine, index) => {
    const [left = 0, top = 0, width = 0, height = 0] = layouts[machine]!.view;
    const [begin, length] = isRow ? [left, width] : [top, height];
    const old = before.find((each) => each.machine === machine);
    const along = index
      ? Math.max(end + GAP - begin, old?.[isRow ? "x" : "y"] ?? Number.NEGATIVE_INFINITY)
      : 0;
    const across = old?.[isRow ? "y" : "x"] ?? first!.view[isRow ? 1 : 0]! - (isRow ? top : left);
    end = along + begin + length;
    return isRow ? { machine, x: along, y: across } : { machine, x: across, y: along };
  });
}

/** The rectangle around some machines. */
export function boxAround(places: readonly Inside[], layouts: Layouts): Box {
  const boxes = places.map(({ machine, x, y }) => {
    const [left = 0, top = 0, width = 0, height = 0] = layouts[machine]!.view;
    return { x: left + x, y: top + y, width, height };
  });
  return boxes.length ? unionOf(boxes) : { x: 0, y: 0, width: 0, height: 0 };
}

/** The rectangle around rectangles. */
export function unionOf(boxes: readonly Box[]): Box {
  const [x, y] = [Math.min(...boxes.map((box) => box.x)), Math.min(...boxes.map((box) => box.y))];
  const right = Math.max(...boxes.map((box) => box.x + box.width));
  const bottom = Math.max(...boxes.map((box) => box.y + box.height));
  return { x, y, width: right - x, height: bottom - y };
}
