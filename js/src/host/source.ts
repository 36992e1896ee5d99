/**
 * The text of the `%%lrp` cell whose output is the lab. While lab and cell show the same text, the cell is
 * folded to its first line, unless it is being edited. The notebook itself does not change by that.
 */

import type { Editor } from "../editor/editor";
import type { Lab } from "../session/store";
import { plain } from "../ui/difference";
import { item, type MenuItem } from "../ui/menu";
import { hasFocus } from "../ui/root";
import { type CellPlace, cellAround, type HostedModel } from "./notebook";

const FOLDED = "lrp-lab-folded";
const OTHER = "lrp-lab-differs";

export interface Source {
  /** What the lab's menu offers: write the text into the cell, or use the cell's. */
  items(): MenuItem[];
  close(): void;
}

export function cellSource(model: HostedModel, lab: Lab, editor: Editor): Source {
  const { root, store } = lab;
  let place: CellPlace | null = null;

  /** The first line and the program of a `%%lrp` cell; null if the cell is of another kind. */
  const own = (): { line: string; program: string } | null => {
    const [, line, program = ""] =
      /^(%%lrp\b.*)\n?([\s\S]*)/.exec(place?.cell.sharedModel.getSource() ?? "") ?? [];
    return line === undefined ? null : { line, program };
  };
  /** Whether the cell shows another program, or the lab's; null if it shows none. */
  const differs = (): boolean | null => {
    const program = own()?.program ?? "";
    return program.trim() ? plain(program) !== plain(editor.text) : null;
  };
  const update = () => {
    if (!place) {
      place = cellAround(model, root);
      place?.cell.contentChanged.connect(update);
    }
    if (!place) return;
    const other = differs();
    const fold = other === false;
    place.element.classList.toggle(OTHER, other === true);
    const isFolded = place.element.classList.contains(FOLDED);
    if (fold === isFolded || (isFolded && hasFocus(root))) return; // nothing moves meanwhile
    const { element } = place;
    const seen = fold && element.getBoundingClientRect().top >= topOf(scroller(element)) ? element : root;
    keepInPlace(seen, () => element.classList.toggle(FOLDED, fold));
  };
  const later = () => void setTimeout(update); // when the focus has arrived elsewhere
  root.addEventListener("focusout", later);
  store.watch(["snapshot", "findings", "revision"], update);

  /** Write the text into the `%%lrp` cell, or into a new one below. */
  const write = ({ notebook, cell, index }: CellPlace) => {
    const mine = own();
    const source = `${mine?.line ?? `%%lrp ${store.state.name}`}\n${plain(editor.text)}`;
    if (mine) cell.sharedModel.setSource(source);
    else notebook.model.sharedModel.insertCell(index + 1, { cell_type: "code", source });
  };

  return {
    items() {
      const [here, mine] = [place, own()];
      if (!here) return [];
      const writing = mine ? "Write the text into the cell" : "Write the text into a new cell";
      const isWritten = mine !== null && plain(mine.program) === plain(editor.text);
      const use = () => editor.edit(`${plain(mine?.program ?? "")}\n`); // as the kernel gets it
      return [
        item(writing, "write-cell", () => write(here), { disabled: isWritten }),
        item("Use the cell's text", "use-cell", use, { disabled: !differs() }),
      ];
    },
    close() {
      root.removeEventListener("focusout", later);
      place?.cell.contentChanged.disconnect(update);
      place?.element.classList.remove(FOLDED, OTHER);
    },
  };
}

function scroller(element: HTMLElement): HTMLElement | null {
  let around = element.parentElement;
  while (around && !/auto|scroll/.test(getComputedStyle(around).overflowY)) around = around.parentElement;
  return around;
}

function topOf(element: HTMLElement | null): number {
  return Math.max(0, element?.getBoundingClientRect().top ?? 0);
}

/** Make a change, and scroll so that an element stays where it is in the window. */
function keepInPlace(element: HTMLElement, change: () => void): void {
  const before = element.getBoundingClientRect().top;
  change();
  const around = scroller(element.closest<HTMLElement>(".jp-Cell") ?? element);
  if (around) around.scrollTop += element.getBoundingClientRect().top - before;
}
