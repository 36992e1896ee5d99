/** The choice of another world. */

import type { Lab } from "../session/store";
import { h, setChoices } from "../ui/dom";

export function worldSelect(lab: Lab): HTMLSelectElement {
  const { store } = lab;
  const select = h("select", {
    class: "lrp-select",
    "aria-label": "World",
    title: "Choose a world",
    "data-lrp-action": "world",
    onchange: () => void lab.act({ do: "world", name: select.value }).then(update),
  });
  const update = () => {
    const { name: current = "", edited = false } = store.state.world ?? {};
    const files = store.state.choices.worlds.map(
      (file) => [file, file.replace(/\.world\.json$/, "")] as const,
    );
    const isKnown = !current || files.some(([, name]) => name === current);
    const all = isKnown ? files : [[current, current] as const, ...files];
    const words = (name: string) => (name === current && edited ? `${name} (edited)` : name);
    const chosen = all.find(([, name]) => name === current)?.[0] ?? "";
    const offered = all.map(([file, name]) => [file, words(name)] as const);
    setChoices(select, offered, chosen);
    select.hidden = !store.state.world || all.length < 2;
  };
  store.watch(["choices", "world"], update);
  return select;
}
