/** The world of the simulated robot, or the panel of a real one. */

import { saveForm } from "../parts/save";
import { askWhy } from "../parts/why";
import type { FromKernel } from "../protocol";
import { besideGraph } from "../session/state";
import type { Lab } from "../session/store";
import type { Looking } from "../timeline/looking";
import { button, iconButton, panel } from "../ui/button";
import { consume, h, setAttribute, setProse, setText } from "../ui/dom";
import { isOn, KeptSwitch, keepOn } from "../ui/kept";
import { ASPECT } from "../ui/layout";
import { item, type MenuItem, menuButton, switchItem } from "../ui/menu";
import { below } from "../ui/point";
import { stepOf } from "../ui/undo";
import { WorldEdits } from "./edits";
import { openWorld, saveDrawing, savePng } from "./files";
import { legend, trailStyles } from "./legend";
import { paletteIn } from "./palette";
import { bridgePanel } from "./panel";
import { readPoses } from "./poses";
import { Preview } from "./preview";
import { properties } from "./properties";
import { Stage } from "./stage";
import { type Tool, type ToolBox, useTools } from "./tools";
import { trailState } from "./trail";
import { proportions } from "./viewport";
import { worldSelect } from "./worlds";

export interface WorldPart {
  element: HTMLElement;
  /** Poses bypass the state: they are many, and only this part needs them. */
  message(message: FromKernel, buffers: DataView[]): void;
}

const TOOLS = [
  ["move", "hand", "Select and move: robot, start, walls, boxes, zones; hold Shift to turn"],
  ["wall", "wall", "Wall: drag along it; or press Enter in the world"],
  ["box", "box", "Box that can be pushed: drag from corner to corner; or press Enter in the world"],
  ["zone", "zone", "Zone: drag from its middle; or press Enter in the world"],
  ["draw", "line", "Draw line; hold Shift for a straight one"],
  ["erase", "erase", "Erase line"],
] as const;

const LABEL =
  "World. N selects the next thing. Arrow keys move it, or the robot; with Shift they resize it. " +
  "[ and ] turn it, Delete removes it. F follows the robot, G shows a grid, plus and minus zoom, 0 shows all.";

export function worldView(lab: Lab, looking: Looking): WorldPart {
  const { store } = lab;
  const grid = new KeptSwitch("world-grid", false, () => stage.repaint());
  const trail = new KeptSwitch("world-trail", true, () => {
    colours.refresh();
    stage.repaint();
  });
  const foretells = new KeptSwitch("world-preview", true, () => preview.check());
  const stage = new Stage(() => paletteIn(lab.root), grid, trail);
  const { canvas } = stage;
  stage.viewport.alwaysFollows = isOn("world-follow", false);
  const named = { class: "lrp-canvas", tabindex: "0", role: "application", "aria-label": LABEL };
  for (const [name, value] of Object.entries(named)) canvas.setAttribute(name, value);

  const strip = properties(stage, () => edits);
  const edits = new WorldEdits(stage, lab, looking, strip.refresh);
  const preview = new Preview(lab, foretells);
  let tool: Tool = "move";
  const box: ToolBox = {
    get tool() {
      return tool;
    },
    choose(name) {
      tool = name;
      for (const other of tools)
        other.setAttribute("aria-pressed", String(other.dataset.lrpAction === `tool-${name}`));
    },
    grid: grid.flip,
    follow() {
      stage.follows = !stage.follows;
      stage.viewport.alwaysFollows = stage.follows;
      keepOn("world-follow", stage.follows);
    },
  };
  const tools = TOOLS.map(([name, icon, title]) =>
    button({
      icon,
      title,
      action: `tool-${name}`,
      "aria-pressed": String(name === tool),
      onclick: () => {
        box.choose(name);
        canvas.focus({ preventScroll: true });
      },
    }),
  );
  useTools(stage, edits, box);

  const undo = iconButton("undo", "Undo in the world (Ctrl+Z)", "world-undo", () => edits.undo());
  const redo = iconButton("redo", "Redo in the world (Ctrl+Shift+Z)", "world-redo", () => edits.redo());
  const follow = button({
    icon: "follow",
    title: "Follow the robot (F)",
    action: "world-follow",
    "aria-pressed": "false",
    onclick: () => box.follow(),
  });
  stage.viewed = () => follow.setAttribute("aria-pressed", String(stage.follows));
  const about = { title: "More about the world", action: "world-menu" };
  const more = menuButton(lab.root, about, "World", () => menu());
  const offer = async () => {
    const { worlds } = await lab.ask({ type: "worlds" });
    if (worlds) store.set("choices", { ...store.state.choices, worlds });
  };
  const suggested = () => `${store.state.world?.name || "my"}-edited.world.json`;
  const save = saveForm(lab, "world-file", suggested, () => void offer());

  const original = () => void lab.act({ do: "reset_world", drawings: true });
  function menu(): (MenuItem | null)[] {
    return [
      switchItem("Grid", "grid", grid, "G"),
      switchItem("Trail", "trail", trail),
      ...(store.state.settings.quiet ? [] : [switchItem("Preview after an edit", "preview", foretells)]),
      null,
      item("Why does the robot do this?", "why-robot", () => askWhy(lab, "robot", "", below(more))),
      item("Start here", "start-at-robot", () => edits.startHere()),
      item("Undo all edits of this world", "world-original", original, {
        disabled: !store.state.world?.edited,
      }),
      null,
      item("Save world…", "save-world", save.open),
      item("Open world…", "open-world", () => openWorld(lab)),
      item("Save picture (PNG)", "world-png", () => void savePng(lab, stage)),
      item("Save drawing (SVG)", "world-svg", () => void saveDrawing(lab, "world_picture")),
      item("Save animation (SVG)", "world-animation", () => void saveDrawing(lab, "world_animation")),
    ];
  }

  const time = h("span", { class: "lrp-world-time", "aria-hidden": "true" });
  const colours = legend(stage, () => store.state.program);
  const toolbar = h(
    "div",
    { class: "lrp-world-tools", hidden: true },
    h("span", { class: "lrp-group", role: "group", "aria-label": "Tool" }, ...tools),
    h("span", { class: "lrp-group", role: "group", "aria-label": "History of the world" }, undo, redo),
  );
  const edit = button({
    icon: "draw",
    title: "Edit the world: walls, boxes, zones, lines",
    action: "edit-world",
    "aria-pressed": "false",
    onclick: () => {
      toolbar.hidden = !toolbar.hidden;
      edit.setAttribute("aria-pressed", String(!toolbar.hidden));
      if (toolbar.hidden) box.choose("move");
    },
  });
  const zoom = h(
    "span",
    { class: "lrp-group lrp-world-zoom", role: "group", "aria-label": "What is shown" },
    iconButton("minus", "Zoom out (-)", "world-zoom-out", () => stage.zoom(1 / 1.25)),
    iconButton("plus", "Zoom in (+)", "world-zoom-in", () => stage.zoom(1.25)),
    iconButton("fit", "Show all (0)", "world-zoom-fit", () => stage.showAll()),
    follow,
  );
  const ahead = h("div", { class: "lrp-world-ahead", role: "status" });
  const over = [zoom, colours.tip, ahead, time, colours.element, strip.element];
  const view = h("div", { class: "lrp-world-body" }, canvas, ...over);
  const { element, heading } = panel(
    "world",
    "World",
    [
      worldSelect(lab),
      edit,
      iconButton("reset", "Reset pose: return the robot to its start", "reset-pose", () =>
        stage.world?.robots.forEach((_, index) => void lab.act({ do: "reset_pose", index })),
      ),
      iconButton(
        "world",
        "Reset world: robot and objects to their start, without trails",
        "reset-world",
        () => {
          stage.clearTrails();
          stage.repaint();
          void lab.act({ do: "reset_world" });
        },
      ),
      more,
    ],
    save.element,
    toolbar,
    view,
    bridgePanel(lab),
  );
  element.addEventListener("keydown", (event) => {
    const step = stepOf(event);
    const isOfWorld = !toolbar.hidden || !undo.disabled || !redo.disabled;
    if (!step || !isOfWorld) return; // it is a step of the program
    (step === "undo" ? undo : redo).click();
    consume(event);
  });

  store.watch(["world", "panel", "bridge", "snapshot"], () => {
    const { world, bridge } = store.state;
    edits.check();
    strip.refresh();
    undo.disabled = !world?.undo;
    redo.disabled = !world?.redo;
    view.hidden = !world;
    if (!world) toolbar.hidden = true;
    setAttribute(element, ASPECT, world && proportions(world.size).toFixed(3));
    setText(heading, world ? "World" : "Robot");
    setAttribute(element, "data-empty", bridge.name === "none" ? "The program runs without a robot." : null);
  });
  store.watch(["whatIf"], () => {
    const { whatIf } = store.state;
    stage.whatIf = whatIf;
    setAttribute(view, "data-what-if", whatIf?.changed.way.length ? whatIf.end : null);
    colours.refresh();
    stage.wake();
  });
  store.watch(["whatIf", "unforetold", "time"], () => {
    const { whatIf, unforetold, time } = store.state;
    const touch = whatIf?.changed.touch;
    setProse(ahead, touch && touch.time >= time ? touch.text : unforetold);
    setAttribute(ahead, "data-quiet", unforetold !== "");
  });
  store.watch(["looking"], () => {
    const { looking } = store.state;
    stage.isPast = looking !== null;
    setAttribute(view, "data-looking", looking?.time);
    stage.repaint();
  });
  let begun = 0;
  store.watch(["goal"], () => {
    const { goal } = store.state;
    if (!goal || goal.begun === begun) return;
    begun = goal.begun;
    stage.trail.clear();
    for (const [at, x, y, state] of goal.trail) stage.trail.add(at, [x, y, 0], state);
    stage.repaint();
  });
  store.watch(["program", "snapshot"], () => {
    stage.styleOf = trailStyles(store.state.program, stage.palette.trail);
    stage.repaint();
  });
  const showTime = () => {
    const { time: now, achieved_speed: achieved } = store.state;
    setText(time, `${now.toFixed(1)} s${achieved ? `  ×${achieved.toPrecision(2)}` : ""}`);
  };
  store.watch(["time", "achieved_speed"], showTime);
  new ResizeObserver(() => stage.resize()).observe(canvas);
  new MutationObserver(() => {
    stage.retheme();
    stage.styleOf = trailStyles(store.state.program, stage.palette.trail);
  }).observe(lab.root, { attributes: true, attributeFilter: ["data-theme"] });

  return {
    element,
    message(message, buffers) {
      if (message.type === "snapshot" || message.type === "world") stage.show(message.world);
      if (message.type !== "frame" || !stage.world) return;
      stage.isPast = store.state.looking !== null;
      if (message.says) stage.says = message.says;
      if (message.ink) stage.draw(message.ink.first, message.ink.strokes);
      const poses = buffers[0] && readPoses(stage.world, buffers[0]);
      if (!poses) return;
      const { time: now } = store.state;
      const state = trailState(besideGraph(store.state).active, store.state.layouts);
      stage.move({ ...poses, time: now }, performance.now(), state); // a world has a time of its own
      preview.check(poses.robots[0]?.pose);
      colours.refresh();
    },
  };
}
