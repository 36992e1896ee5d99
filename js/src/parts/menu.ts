/** The lab's menu, for settings that are rarely changed. */

import type { Lab } from "../session/store";
import type { MenuItem } from "../ui/menu";

/** Settings of this view only. */
export interface Choices {
  /** Parts that can be hidden, each with its switch. */
  panels: { name: string; title: string; shown: () => boolean; show: (on: boolean) => void }[];
  values: { shown: () => boolean; show: (on: boolean) => void };
  save: () => void;
  versions: () => void;
}

export function labMenu(lab: Lab, choices: Choices): (MenuItem | null)[] {
  const { settings, choices: known } = lab.store.state;
  const keep = settings.on_active_edit === "keep";
  const panels = choices.panels.map(({ name, title, shown, show }) => ({
    label: title,
    action: `panel-${name}`,
    checked: shown(),
    run: () => show(!shown()),
  }));
  const programs = known.programs.map((name) => ({
    label: `Open ${name}`,
    action: `load-${name}`,
    run: () => void lab.act({ do: "load", name }),
  }));
  const { values } = choices;
  return [
    { label: "Save…", action: "save", run: choices.save },
    { label: "Versions…", action: "versions", run: choices.versions },
    { label: "Inspect the robot", action: "inspect-robot", run: () => lab.inspect("robot", "") },
    null,
    {
      label: "Keep running when the active state is edited",
      action: "keep",
      checked: keep,
      run: () => void lab.act({ do: "on_active_edit", name: keep ? "restart" : "keep" }),
    },
    {
      label: "Values in the text",
      action: "values",
      checked: values.shown(),
      run: () => values.show(!values.shown()),
    },
    null,
    ...panels,
    ...(programs.length ? [null, ...programs] : []),
  ];
}
