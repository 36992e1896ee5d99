/** The lab's menu, for settings that are rarely changed. */

import type { Editor } from "../editor/editor";
import type { Source } from "../host/source";
import type { Lab } from "../session/store";
import { ABSENT, type Layout, type Panels, WITHHELD } from "../ui/layout";
import { item, type MenuItem, switchItem } from "../ui/menu";
import type { Arrangement } from "../ui/plans";
import { askWhy } from "./why";

const LARGE: [Arrangement, string][] = [
  ["work", "Program and world"],
  ["world", "Large world"],
  ["demo", "Large world and graph"],
];

interface Choice {
  shown: () => boolean;
  show: (on: boolean) => void;
}

/** Settings of this view only. */
export interface Choices {
  layout: Layout | null;
  fills: Choice;
  editor: Editor | null;
  save: () => void;
  versions: () => void;
  open: (program: string) => void;
  /** Return to the usual sizes. */
  resetSizes: () => void;
  /** The cell above the lab. */
  cell: Source | null;
}

export function labMenu(lab: Lab, choices: Choices): (MenuItem | null)[] {
  const { settings, choices: known } = lab.store.state;
  const keep = settings.on_active_edit === "keep";
  const { layout, fills } = choices;
  const panels = layout
    ? Object.entries(layout.panels)
        .filter(([, panel]) => !panel.hasAttribute(ABSENT))
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
    ...(choices.cell?.items() ?? []),
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
    ...(choices.editor ? ofText(choices.editor, settings.quiet) : []),
    null,
    item("Fill the window", "fill", () => fills.show(!fills.shown()), {
      checked: fills.shown(),
      hint: "⇧F9",
    }),
    ...(layout
      ? LARGE.map(([name, label]) => {
          const choose = () => {
            layout.arrangement = name;
          };
          return item(label, `arrange-${name}`, choose, { checked: layout.arrangement === name });
        })
      : []),
    null,
    ...panels,
    ...(layout ? [item("Reset panel sizes", "usual-sizes", choices.resetSizes)] : []),
    ...(programs.length ? [null, ...programs] : []),
  ];
}

function ofText(editor: Editor, quiet: boolean): MenuItem[] {
  return [
    ...(quiet ? [] : [switchItem("Values in the text", "values", editor.values)]),
    switchItem("Brackets coloured by depth", "brackets", editor.brackets),
    item("Format the text", "format", () => editor.format(), { hint: "⇧Alt F" }),
  ];
}
