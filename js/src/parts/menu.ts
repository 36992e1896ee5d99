/** The lab's menu, for settings that are rarely changed. */

import type { Lab } from "../session/store";
import { type Layout, type Panels, WITHHELD } from "../ui/layout";
import type { MenuItem } from "../ui/menu";
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
          return {
            label: `Show ${name}`,
            action: `panel-${name}`,
            checked: shown,
            run: () => {
              layout.show(name as keyof Panels, !shown);
              if (panel.hasAttribute(WITHHELD)) void lab.act({ do: "graph", mode: "live" });
            },
          };
        })
    : [];
  const programs = known.programs.map((name) => ({
    label: `Open ${name}…`,
    action: `load-${name}`,
    run: () => choices.open(name),
  }));
  return [
    { label: "Save…", action: "save", run: choices.save },
    { label: "Versions…", action: "versions", run: choices.versions },
    ...choices.cell(),
    {
      label: "Why does the robot do this?",
      action: "why-robot",
      run: () => {
        const { left, top } = lab.root.getBoundingClientRect();
        askWhy(lab, "robot", "", { x: left, y: top });
      },
    },
    null,
    {
      label: "Keep running when the active state is edited",
      action: "keep",
      checked: keep,
      run: () => void lab.act({ do: "on_active_edit", name: keep ? "restart" : "keep" }),
    },
    ...choices.text(),
    null,
    {
      label: "Fill the window",
      action: "fill",
      checked: fills.shown(),
      hint: "⇧F9",
      run: () => fills.show(!fills.shown()),
    },
    ...panels,
    ...(layout ? [{ label: "Reset panel sizes", action: "usual-sizes", run: choices.resetSizes }] : []),
    ...(programs.length ? [null, ...programs] : []),
  ];
}
