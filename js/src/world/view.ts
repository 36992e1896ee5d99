/** The world of the simulated robot, or the panel of a real one. */

import type { FromKernel } from "../protocol";
import type { Lab } from "../session/store";
import { button, panel } from "../ui/button";
import { h, setText } from "../ui/dom";
import type { Palette } from "./paint";
import { bridgePanel } from "./panel";
import { readPoses } from "./poses";
import { Stage } from "./stage";
import { type Tool, useTools } from "./tools";

export interface WorldPart {
  element: HTMLElement;
  /** Poses bypass the state: they are many, and only this part needs them. */
  message(message: FromKernel, buffers: DataView[]): void;
}

export function worldView(lab: Lab): WorldPart {
  const { store } = lab;
  const stage = new Stage(() => palette(lab.root));
  const { canvas } = stage;
  let tool: Tool = "move";
  for (const [name, value] of Object.entries({
    class: "lrp-canvas",
    tabindex: "0",
    role: "application",
    "aria-label": "World. Arrow keys move the robot, [ and ] turn it.",
  })) {
    canvas.setAttribute(name, value);
  }
  const tools = (
    [
      ["move", "hand", "Move the robot and objects; hold Shift to turn"],
      ["draw", "draw", "Draw line"],
      ["erase", "erase", "Erase line"],
    ] as const
  ).map(([name, icon, title]) =>
    button({
      icon,
      title,
      action: `tool-${name}`,
      "aria-pressed": String(name === tool),
      onclick: () => {
        tool = name;
        for (const other of tools)
          other.setAttribute("aria-pressed", String(other.dataset.lrpAction === `tool-${name}`));
      },
    }),
  );
  const worlds = h("select", {
    class: "lrp-select",
    "aria-label": "World",
    title: "Choose a world",
    "data-lrp-action": "world",
    onchange: () => void lab.act({ do: "world", name: worlds.value }),
  });
  const time = h("span", { class: "lrp-world-time", "aria-hidden": "true" });
  const view = h("div", { class: "lrp-world-body" }, canvas, time);
  const { element, heading } = panel(
    "world",
    "World",
    [
      worlds,
      h("span", { class: "lrp-group", role: "group", "aria-label": "Tool" }, ...tools),
      button({
        icon: "minus",
        title: "Zoom out",
        action: "world-zoom-out",
        onclick: () => stage.zoom(1 / 1.25),
      }),
      button({ icon: "plus", title: "Zoom in", action: "world-zoom-in", onclick: () => stage.zoom(1.25) }),
      button({
        icon: "fit",
        title: "Show all",
        action: "world-zoom-fit",
        onclick: () => {
          stage.fit();
          stage.repaint();
        },
      }),
      button({
        icon: "reset",
        title: "Reset pose: return the robot to its start",
        action: "reset-pose",
        onclick: () => void lab.act({ do: "reset_pose", index: 0 }),
      }),
      button({
        icon: "world",
        title: "Reset world: robot and objects to their start, without trails",
        action: "reset-world",
        onclick: () => void lab.act({ do: "reset_world" }),
      }),
    ],
    view,
    bridgePanel(lab),
  );
  useTools(stage, lab, () => tool);
  store.watch(["world", "panel", "snapshot"], () => {
    const { world } = store.state;
    stage.show(world);
    view.hidden = !world;
    element.toggleAttribute("data-worldless", !world);
    setText(heading, world ? "World" : "Robot");
  });
  store.watch(["choices", "world"], () => {
    const current = store.state.world?.name ?? "";
    const names = store.state.choices.worlds;
    const all = !current || names.includes(current) ? names : [current, ...names];
    worlds.replaceChildren(
      ...all.map((name) => h("option", { value: name, selected: name === current }, name)),
    );
    worlds.hidden = !store.state.world || all.length < 2;
  });
  const showTime = () => {
    const { achieved } = store.state.speed;
    const now = stage.latest?.time ?? 0;
    setText(time, `${now.toFixed(1)} s${achieved ? `  ×${achieved.toPrecision(2)}` : ""}`);
  };
  store.watch(["speed"], showTime);
  new ResizeObserver(() => stage.resize()).observe(canvas);
  new MutationObserver(() => stage.retheme()).observe(lab.root, {
    attributes: true,
    attributeFilter: ["data-theme"],
  });

  return {
    element,
    message(message, buffers) {
      if (message.type === "snapshot") stage.show(message.world);
      if (message.type === "world") stage.show(message.world);
      if (message.type !== "frame" || !stage.world) return;
      if (message.ink) stage.draw(message.ink.first, message.ink.strokes);
      const poses = buffers[0] && readPoses(stage.world, buffers[0]);
      if (!poses) return;
      stage.move(poses, performance.now());
      showTime();
    },
  };
}

function palette(root: HTMLElement): Palette {
  const style = getComputedStyle(root);
  const color = (name: string) => style.getPropertyValue(`--lrp-world-${name}`).trim() || "gray";
  return {
    outside: color("outside"),
    edge: color("edge"),
    solid: color("solid"),
    pushable: color("pushable"),
    solidEdge: color("solid-edge"),
    zone: color("zone"),
    robot: color("robot"),
    robotEdge: color("robot-edge"),
    mark: color("mark"),
    bump: color("bump"),
    ray: color("ray"),
    text: color("text"),
    halo: color("halo"),
    dim: root.dataset.theme === "dark",
    font: style.fontFamily || "sans-serif",
  };
}
