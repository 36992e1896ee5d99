/**
 * The `%%lrp` cell whose output is the lab. While the lab shows its text, or a newer one that is written into it
 * when the notebook is saved, the cell is folded to its first line, unless it is being edited.
 */

import type { Editor } from "../editor/editor";
import type { Lab } from "../session/store";
import { plain } from "../ui/difference";
import { item, type MenuItem } from "../ui/menu";
import { hasFocus } from "../ui/root";
import { type Held, Holder, programOf } from "./holder";
import { type CellPlace, cellAround, type HostedModel } from "./notebook";
import { saveWith } from "./saving";

const FOLDED = "lrp-lab-folded";
const NEWER = "lrp-lab-newer";
const OTHER = "lrp-lab-differs";
const NOT_SAVED = "The text is not saved with the notebook:";

export interface Source {
  /** What the lab's menu offers: write the text into the cell, or use the cell's. */
  items(): MenuItem[];
  close(): void;
}

export function cellSource(model: HostedModel, lab: Lab, editor: Editor): Source {
  const { root, store } = lab;
  let place: CellPlace | null = null;
  /** Where the lab is, as soon as it is shown. */
  const around = () => {
    if (!place) {
      place = cellAround(model, root);
      place?.cell.contentChanged.connect(update);
    }
    return place;
  };
  const holder = new Holder(lab, around, () => editor.text);
  const notebook = model.widget_manager?.context;

  /** The cell around the lab if it holds a program. */
  const own = () => programOf(place?.cell);
  /** Whose program the cell around the lab shows: the lab's, an older one of the lab, or another; null for none. */
  const shows = (held: Held | null): "same" | "older" | "other" | null => {
    const { program = "" } = own() ?? {};
    if (program === plain(editor.text)) return program.trim() ? "same" : null;
    if (place && held?.cell === place.cell) return "older";
    return program.trim() ? "other" : null;
  };
  /** Why the text is not saved with the notebook; empty if it is, or if there is none. */
  const unsaved = (held: Held | null): string => {
    const { by_hand, cell } = store.state;
    if (!notebook)
      return by_hand && !cell.is_saved ? `${NOT_SAVED} this page cannot write into it. ${by_hand}` : "";
    if (held) return "";
    if (own())
      return `${NOT_SAVED} the cell above has a different text. Run the cell, or choose in the menu More which text to use.`;
    const isLost = place && cell.given && !cell.is_saved;
    return isLost ? `${NOT_SAVED} no cell has this program. The menu More can write it into a new cell.` : "";
  };
  const update = () => {
    const { held } = holder;
    store.set("unsaved", unsaved(held));
    if (!place) return;
    const shown = shows(held);
    const fold = shown === "same" || shown === "older";
    place.element.classList.toggle(NEWER, shown === "older");
    place.element.classList.toggle(OTHER, shown === "other");
    const isFolded = place.element.classList.contains(FOLDED);
    if (fold === isFolded || (isFolded && hasFocus(root))) return; // nothing moves meanwhile
    const { element } = place;
    const seen = fold && element.getBoundingClientRect().top >= topOf(scroller(element)) ? element : root;
    keepInPlace(seen, () => element.classList.toggle(FOLDED, fold));
  };
  const later = () => void setTimeout(update); // when the focus has arrived elsewhere
  root.addEventListener("focusout", later);
  store.watch(["snapshot", "findings", "revision", "cell"], update);
  if (notebook) saveWith(notebook, lab, editor, holder, around);

  /** Write the text into the `%%lrp` cell, or into a new one below. */
  const write = ({ notebook, index }: CellPlace) => {
    const mine = own();
    if (mine) return holder.write(mine);
    const source = `${store.state.cell.line}\n${plain(editor.text)}`;
    notebook.model.sharedModel.insertCell(index + 1, { cell_type: "code", source });
    holder.told();
  };

  return {
    items() {
      const [here, mine] = [place, own()];
      if (!here) return [];
      const writing = mine ? "Write the text into the cell" : "Write the text into a new cell";
      const isWritten = mine?.program === plain(editor.text);
      const use = () => {
        editor.edit(`${mine?.program}\n`); // as the kernel gets it
        holder.told();
      };
      return [
        item(writing, "write-cell", () => write(here), { disabled: isWritten }),
        item("Use the cell's text", "use-cell", use, { disabled: !mine?.program.trim() || isWritten }),
      ];
    },
    close() {
      root.removeEventListener("focusout", later);
      place?.cell.contentChanged.disconnect(update);
      place?.element.classList.remove(FOLDED, NEWER, OTHER);
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
