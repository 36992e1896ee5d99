/** Edits of the world: what is selected, placed, changed, removed. The kernel holds the history of them. */

import type { Point } from "../protocol";
import type { Act } from "../session/connection";
import type { Lab } from "../session/store";
import type { Looking } from "../timeline/looking";
import type { Stage } from "./stage";
import { keyed, poseOf, type Shape, same, shaped, type Thing, thingsOf } from "./things";

export type Placed = "wall" | "box" | "zone";

export const PUSH = 0.3; // coefficient of friction of a new box
const QUIET = 600; // ms after which moves by key are one edit
const IN_FRAMES: Act["do"][] = ["drag_robot", "stroke", "erase"]; // seen with a frame, not in a description

export class WorldEdits {
  /** Of the newest solid, until the kernel describes it. */
  private push: number | null = null;
  /** What was moved by key since the last edit. */
  private nudged: Thing | null = null;
  private pending: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly stage: Stage,
    private readonly lab: Lab,
    private readonly looking: Looking,
    private readonly selectionChanged: () => void,
  ) {}

  select(thing: Thing | null): void {
    if (!same(this.stage.selected, thing)) this.flush();
    this.stage.selected = thing;
    this.stage.wake();
    this.selectionChanged();
  }

  /** Drop the selection if its thing is gone. */
  check(): void {
    const { selected, world } = this.stage;
    if (this.stage.isHeld || !selected || !world) return;
    const { kind } = selected;
    const gone =
      kind === "solid" ? !world.solids[selected.index] : kind === "zone" && !world.zones[selected.name];
    if (gone) this.select(null);
  }

  selectNext(by: 1 | -1): void {
    const { world, selected } = this.stage;
    if (!world) return;
    const things = thingsOf(world);
    const index = things.findIndex((thing) => same(thing, selected));
    const next = index < 0 && by < 0 ? things.length - 1 : index + by;
    this.select(things[next] ?? null);
  }

  look(time: number): void {
    void this.looking.at({ time });
  }

  /** Show the present if an earlier moment is shown, which cannot be edited; return whether one was. */
  showNow(): boolean {
    if (this.stage.isPast) this.looking.back();
    return this.stage.isPast;
  }

  /** Put a new thing into the world, and select it. */
  add(kind: Placed, shape: Shape): void {
    const { world } = this.stage;
    if (!world || this.showNow()) return;
    if (kind === "zone") {
      const names = ["goal", ...Array.from({ length: 99 }, (_, i) => `zone ${i + 2}`)];
      const name = names.find((free) => !(free in world.zones)) ?? "zone";
      this.hold({ kind: "zone", name }, shape);
      this.act({ do: "put_zone", name, ...shaped(shape) });
    } else {
      this.push = kind === "box" ? PUSH : null;
      let index = world.solids.length;
      while (this.stage.draftOf({ kind: "solid", index })) index++; // added, and not answered yet
      this.hold({ kind: "solid", index }, shape);
      this.act({ do: "put_solid", ...shaped(shape), angle: poseOf(shape)[2], push: this.push });
    }
  }

  /** Select a thing that the kernel does not know yet. */
  private hold(thing: Thing, shape: Shape): void {
    this.flush();
    this.stage.setDraft(thing, shape);
    this.select(thing);
  }

  /** Move a thing while it is dragged; zones and starts move when they are dropped. */
  drag(thing: Thing, shape: Shape): void {
    if (this.showNow()) return;
    this.stage.setDraft(thing, shape);
    if (thing.kind === "robot" || thing.kind === "solid") {
      const act = thing.kind === "robot" ? "drag_robot" : "drag_solid";
      this.lab.send({ do: act, index: thing.index, pose: poseOf(shape) });
    }
  }

  /** Edit the place and size of a thing. */
  put(thing: Thing, shape: Shape): void {
    if (this.showNow()) return;
    this.stage.setDraft(thing, shape);
    const pose = poseOf(shape);
    if (thing.kind === "robot") this.act({ do: "drag_robot", index: thing.index, pose });
    else if (thing.kind === "start") this.act({ do: "set_start", index: thing.index, pose });
    else if (thing.kind === "zone") this.act({ do: "put_zone", name: thing.name, ...shaped(shape) });
    else this.putSolid(thing.index, shape, {});
  }

  /** Change a solid's other properties. */
  putSolid(index: number, shape: Shape, properties: { push?: number | null; name?: string }): void {
    const { push = null, name = "" } = this.stage.world?.solids[index] ?? { push: this.push };
    const angle = poseOf(shape)[2];
    this.act({ do: "put_solid", index, ...shaped(shape), angle, push, name, ...properties });
  }

  rename(zone: string, name: string): void {
    const shape = this.stage.shape({ kind: "zone", name: zone });
    if (!shape || !name || name === zone) return;
    void this.act({ do: "put_zone", name, former: zone, ...shaped(shape) }).then((error) => {
      if (!error) this.select({ kind: "zone", name });
    });
  }

  remove(): void {
    const { selected } = this.stage;
    if (selected?.kind === "solid") this.act({ do: "remove_solid", index: selected.index });
    else if (selected?.kind === "zone") this.act({ do: "remove_zone", name: selected.name });
    else return;
    this.select(null);
  }

  /** Move, resize or turn the selected thing, or the robot, by a key; return whether the key does that. */
  nudge(key: string, resize: boolean): boolean {
    const thing: Thing = this.stage.selected ?? { kind: "robot", index: 0 };
    const shape = this.stage.shape(thing);
    const next = shape && keyed(shape, key, resize && thing.kind !== "robot" && thing.kind !== "start");
    if (!next || (thing.kind === "zone" && next.angle)) return false;
    if (this.showNow()) return true;
    if (thing.kind === "robot") {
      this.put(thing, next);
      return true;
    }
    this.stage.busy = true;
    this.drag(thing, next);
    this.nudged = thing;
    clearTimeout(this.pending);
    this.pending = setTimeout(() => this.flush(), QUIET);
    return true;
  }

  /** Make one edit of the moves by key since the last one. */
  flush(): void {
    const thing = this.nudged;
    if (!thing) return;
    clearTimeout(this.pending);
    this.nudged = null;
    this.stage.busy = false;
    const shape = this.stage.draftOf(thing);
    if (shape) this.put(thing, shape);
  }

  /** Draw a line, or erase with the floor's own grey. */
  stroke(kind: "stroke" | "erase", points: Point[], width: number): void {
    this.act({ do: kind, points, width });
  }

  /** Set the start to where the robot is shown, also before a frame has it there: the selected, or the first one. */
  startHere(): void {
    const { selected } = this.stage;
    const index = selected?.kind === "robot" ? selected.index : 0;
    const shape = this.stage.shape({ kind: "robot", index });
    if (shape) this.act({ do: "set_start", index, pose: [shape.x, shape.y, shape.angle] });
  }

  undo(): void {
    this.flush();
    void this.act({ do: "undo_world" });
  }

  redo(): void {
    this.flush();
    void this.act({ do: "redo_world" });
  }

  /**
   * Send an edit; what it will look like is shown until the kernel has replied: by then it has described the world.
   * Where the robot is and what is drawn comes with the next frame.
   */
  private async act(act: Act): Promise<string | null> {
    const { stage } = this;
    if (this.showNow()) return null;
    stage.awaited += 1;
    const error = await this.lab.act(act);
    stage.awaited -= 1;
    if (error || !IN_FRAMES.includes(act.do)) stage.clearDrafts();
    return error;
  }
}
