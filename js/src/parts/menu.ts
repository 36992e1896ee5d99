/** The lab's menu, for settings that are rarely changed. */

import type { Lab } from "../session/store";
import { type Layout, type Panels, WITHHELD } from "../ui/layout";
import { item, type MenuItem } from "../ui/menu";
import { askWhy } from "./why";

interface Choice {
  shown: () => boolean;
  show: (on: boolean) => void;
}

/** Settings of this view only. */
export interface Choices {
  layout: Layout | null;
  fills: Choice;
  /** What concerns the text in the editor. */
  text: () => MenuItem[];
  save: () => void;
  versions: () => void;
  open: (program: string) => void;
  /** Return to the usual sizes. */
  resetSizes: () => void;
  /** What concerns the cell above the lab. */
  cell: () => MenuItem[];
}

export function labMenu(lab: Lab, choices: Choices): (MenuItem | null)[] {
  const { settings, choices: known } = lab.store.state;
  const keep = settings.on_active_edit === "keep";
  const { layout, fills } = choices;
  const panels = layout
    ? Object.entries(layout.panels)
        .filter(([name]) => name !== "goal" || lab.store.state.goal)
        .filter(([name, panel]) => !panel.hasAttribute(WITHHELD) || (name === "graph" && !settings.lock))
        .map(([name, panel]) => {
          const shown = !panel.hidden && !panel.hasAttribute(WITHHELD);
          return item(
            `Show ${name}`,
            `panel-${name}`,
            () => {
              layout.show(name as keyof Panels, !shown);
              if (panel.hasAttribute(WITHHELD)) void lab.act({ do: "graph", mode: "live" });
            },
            { checked: shown },
          );
        })
    : [];
  const programs = known.programs.map((name) =>
    item(`Open ${name}…`, `load-${name}`, () => choices.open(name)),
  );
  return [
    item("Save…", "save", choices.save),
    item("Versions…", "versions", choices.versions),
    ...choices.cell(),
    item("Why does the robot do this?", "why-robot", () => {
      const { left, top } = lab.root.getBoundingClientRect();
      askWhy(lab, "robot", "", { x: left, y: top });
    }),
    null,
    item(
      "Keep running when the active state is edited",
      "keep",
      () => void lab.act({ do: "on_active_edit", name: keep ? "restart" : "keep" }),
      { checked: keep },
    ),
    ...choices.text(),
    null,
    item("Fill the window", "fill", () => fills.show(!fills.shown()), {
      checked: fills.shown(),
      hint: "⇧F9",
    }),
    ...panels,
    ...(layout ? [item("Reset panel sizes", "usual-sizes", choices.resetSizes)] : []),
    ...(programs.length ? [null, ...programs] : []),
  ];
}
