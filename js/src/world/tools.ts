/** Pointer and keyboard tools for the world: dragging, turning, drawing, erasing. */

import type { Point, Pose } from "../protocol";
import type { Lab } from "../session/store";
import type { FullWorld } from "./complete";
import type { Snapshot } from "./poses";
import type { Stage } from "./stage";

export type Tool = "move" | "draw" | "erase";

const SEND_EVERY = 40; // ms
const WIDTH: Record<Exclude<Tool, "move">, number> = { draw: 0.03, erase: 0.08 };
const STEP = 0.02; // metres by an arrow key
const TURN = Math.PI / 18;

export interface Target {
  do: "drag_robot" | "drag_solid";
  index: number;
  pose: Pose;
}

/** The thing at a point: robots before solids, the last drawn first. */
export function targetAt(world: FullWorld, now: Snapshot, [x, y]: Point): Target | null {
  for (let index = now.robots.length - 1; index >= 0; index--) {
    const pose = now.robots[index]!.pose;
    const radius = world.robots[index]?.radius ?? 0;
    if (Math.hypot(x - pose[0], y - pose[1]) <= radius * 1.25) return { do: "drag_robot", index, pose };
  }
  for (let index = now.solids.length - 1; index >= 0; index--) {
    const pose = now.solids[index]!;
    const { box, circle } = world.solids[index] ?? {};
    const [dx, dy] = [x - pose[0], y - pose[1]];
    const along = Math.abs(dx * Math.cos(pose[2]) + dy * Math.sin(pose[2]));
    const aside = Math.abs(dy * Math.cos(pose[2]) - dx * Math.sin(pose[2]));
    const grip = 0.015; // thin walls can be caught too
    const hit = circle
      ? Math.hypot(dx, dy) <= circle[2]
      : box !== undefined && along <= (box[2] ?? 0) / 2 + grip && aside <= (box[3] ?? 0) / 2 + grip;
    if (hit) return { do: "drag_solid", index, pose };
  }
  return null;
}

export function useTools(stage: Stage, lab: Lab, tool: () => Tool): void {
  const { canvas } = stage;
  const local = (event: MouseEvent): Point => {
    const frame = canvas.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top];
  };

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || !stage.world || !stage.latest) return;
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    const begin = local(event);
    const drag = tool() === "move" ? dragging(begin) : drawing(begin, tool() as Exclude<Tool, "move">);
    let sent = 0;
    const move = (now: PointerEvent) => {
      const due = now.timeStamp - sent > SEND_EVERY;
      if (due) sent = now.timeStamp;
      drag.move(local(now), due, now.shiftKey);
    };
    const end = () => {
      canvas.removeEventListener("pointermove", move);
      drag.end();
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", end, { once: true });
    canvas.addEventListener("pointercancel", end, { once: true });
  });

  function dragging(begin: Point) {
    const from = stage.inside(...begin);
    const target = targetAt(stage.world!, stage.latest!, from);
    let last = begin;
    let pose = target?.pose ?? ([0, 0, 0] as Pose);
    if (!target) {
      return {
        move(at: Point) {
          stage.pan(at[0] - last[0], at[1] - last[1]);
          last = at;
        },
        end() {},
      };
    }
    const { pose: first } = target;
    return {
      move(at: Point, due: boolean, turn: boolean) {
        const [x, y] = stage.inside(...at);
        if (turn) pose = [pose[0], pose[1], Math.atan2(y - pose[1], x - pose[0])];
        else pose = [first[0] + x - from[0], first[1] + y - from[1], pose[2]];
        last = at;
        if (due) lab.send({ ...target, pose });
      },
      end() {
        if (last !== begin) lab.send({ ...target, pose });
      },
    };
  }

  function drawing(begin: Point, kind: Exclude<Tool, "move">) {
    const width = WIDTH[kind];
    const grey = kind === "draw" ? 0 : (stage.world?.floor.grey ?? 255);
    const points: Point[] = [stage.inside(...begin)];
    stage.sketch = { path: points, width, grey };
    stage.wake();
    return {
      move(at: Point) {
        const point = stage.inside(...at);
        const [x, y] = points.at(-1)!;
        if (Math.hypot(point[0] - x, point[1] - y) > width / 4) points.push(point);
        stage.wake();
      },
      end() {
        const done = stage.sketch;
        const act =
          kind === "draw"
            ? ({ do: "stroke", points, width, grey } as const)
            : ({ do: "erase", points, width } as const);
        void lab.act(act).then(() => {
          if (stage.sketch === done) stage.sketch = null; // by now it is part of the world
          stage.wake();
        });
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
    const target = tool() === "move" && targetAt(stage.world, stage.latest, stage.inside(...local(event)));
    canvas.style.cursor = target ? "grab" : tool() === "move" ? "default" : "crosshair";
  });
  canvas.addEventListener("keydown", (event) => {
    const pose = stage.latest?.robots[0]?.pose;
    const next = pose && nudged(pose, event.key);
    if (!next || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    event.stopPropagation();
    lab.send({ do: "drag_robot", index: 0, pose: next });
  });
}

/** The pose after a key press: arrows move the robot, `[` and `]` turn it. */
export function nudged([x, y, theta]: Pose, key: string): Pose | null {
  switch (key) {
    case "ArrowLeft":
      return [x - STEP, y, theta];
    case "ArrowRight":
      return [x + STEP, y, theta];
    case "ArrowUp":
      return [x, y + STEP, theta];
    case "ArrowDown":
      return [x, y - STEP, theta];
    case "[":
      return [x, y, theta + TURN];
    case "]":
      return [x, y, theta - TURN];
    default:
      return null;
  }
}
