/** A strip about what is selected in the world: its name, whether it can be pushed, and how to remove it. */

import { button, iconButton } from "../ui/button";
import { h, setHidden, setText } from "../ui/dom";
import { hasFocus } from "../ui/root";
import { PUSH, type WorldEdits } from "./edits";
import type { Stage } from "./stage";
import type { Shape, Thing } from "./things";

export function properties(stage: Stage, edits: () => WorldEdits) {
  const kind = h("span", { class: "lrp-thing-kind", "aria-live": "polite" });
  const name = h("input", {
    class: "lrp-input",
    "aria-label": "Name",
    placeholder: "Name",
    spellcheck: "false",
    "data-lrp-action": "thing-name",
    onchange: () => rename(),
  });
  const push = h("input", { type: "checkbox", "data-lrp-action": "thing-push", onchange: () => change() });
  const round = h("input", { type: "checkbox", "data-lrp-action": "thing-round", onchange: () => reshape() });
  const labels = [h("label", {}, push, "Pushable"), h("label", {}, round, "Round")];
  const solid = h("span", { class: "lrp-thing-solid" }, ...labels);
  const start = button({
    label: "Start here",
    title: "Set the start to where the robot is now",
    action: "start-here",
    onclick: () => edits().startHere(),
  });
  const remove = iconButton("remove", "Remove (Delete)", "thing-remove", () => {
    edits().remove();
    stage.canvas.focus({ preventScroll: true });
  });
  const element = h("div", { class: "lrp-thing", hidden: true }, kind, name, solid, start, remove);
  let shown: Thing | null = null;

  function rename(): void {
    if (shown?.kind === "zone") edits().rename(shown.name, name.value.trim());
    else change();
  }
  function change(): void {
    const shape = shown && stage.shape(shown);
    if (shown?.kind === "solid" && shape)
      edits().putSolid(shown.index, shape, { push: push.checked ? PUSH : null, name: name.value.trim() });
  }
  function reshape(): void {
    const shape = shown && stage.shape(shown);
    if (shown?.kind !== "solid" || !shape) return;
    const { box, radius = 0, ...place } = shape;
    const other: Shape = box
      ? { ...place, radius: Math.max(...box) / 2 }
      : { ...place, box: [2 * radius, 2 * radius] };
    edits().putSolid(shown.index, other, {});
  }

  return {
    element,
    refresh(): void {
      const { selected, world } = stage;
      shown = selected;
      const isSolid = selected?.kind === "solid";
      const it = isSolid ? world?.solids[selected.index] : undefined;
      setHidden(element, !selected || (isSolid && !it));
      if (!selected) return;
      const isOne = selected.kind === "robot" || selected.kind === "start";
      const robot = isOne && world && world.robots.length > 1 ? ` ${world.robots[selected.index]?.name}` : "";
      const title = it?.patrol
        ? "Moves by itself"
        : titleOf(selected, typeof it?.push === "number", Boolean(it?.circle));
      setText(kind, title + robot);
      setHidden(name, isOne);
      setHidden(solid, !isSolid);
      setHidden(start, selected.kind !== "robot");
      setHidden(remove, isOne);
      const named = selected.kind === "zone" ? selected.name : (it?.name ?? "");
      if (!hasFocus(name)) name.value = named;
      push.checked = typeof it?.push === "number";
      round.checked = Boolean(it?.circle);
    },
  };
}

function titleOf(thing: Thing, pushable: boolean, round: boolean): string {
  if (thing.kind === "robot") return "Robot";
  if (thing.kind === "start") return "Start";
  if (thing.kind === "zone") return "Zone";
  if (pushable) return round ? "Can" : "Box";
  return round ? "Pillar" : "Wall";
}
