/**
 * The `%%lrp` cell that holds the lab's program, and which of both texts is newer. The lab's may go into the cell
 * only if the cell still has the text that was last known to be that of both: a cell with another text was edited,
 * or holds an earlier program of the same name.
 */

import type { Lab } from "../session/store";
import { plain } from "../ui/difference";
import { type CellPlace, cellsOf, type NotebookCell } from "./notebook";

export interface Held {
  cell: NotebookCell;
  /** Its first line, and the rest. */
  line: string;
  program: string;
}

/** The first line and the program of a `%%lrp` cell; null for other cells. */
export function programOf(cell: NotebookCell | undefined): Held | null {
  const [, line, program = ""] = /^(%%lrp\b.*)\n?([\s\S]*)/.exec(cell?.sharedModel.getSource() ?? "") ?? [];
  return cell && line !== undefined ? { cell, line, program: plain(program) } : null;
}

/** Whether the first line of a cell names this program, or does not begin with a name. */
function names(line: string, name: string): boolean {
  const [, found = ""] = /^%%lrp\s+("[^"]*"|'[^']*'|\S*)/.exec(line) ?? [];
  return !found || found.startsWith("-") || found.replace(/^(["'])(.*)\1$/, "$2") === name;
}

export class Holder {
  private known = "";
  private given = -1;

  constructor(
    private readonly lab: Lab,
    private readonly place: () => CellPlace | null,
    private readonly text: () => string,
  ) {
    lab.store.watch(["snapshot"], () => {
      this.given = -1;
    });
  }

  /** The cell around the lab, or the first other one, whose text the lab's continues. */
  get held(): Held | null {
    const place = this.place();
    if (!place) return null;
    const { name, cell } = this.lab.store.state;
    const given = plain(cell.text);
    if (cell.given !== this.given) this.known = given; // a cell was run
    this.given = cell.given;
    const texts = [this.known, given, plain(this.text())];
    for (const each of [place.cell, ...cellsOf(place.notebook)]) {
      const held = programOf(each);
      if (!held || !names(held.line, name) || !texts.includes(held.program)) continue;
      this.known = held.program;
      return held;
    }
    return null;
  }

  /** Write the lab's text into a cell: only what differs, and not as a step that Jupyter would undo. */
  write({ cell: { sharedModel }, line }: Held): void {
    const [old, text] = [sharedModel.getSource(), `${line}\n${plain(this.text())}`];
    const { start, end, inserted } = difference(old, text);
    if (old !== text)
      sharedModel.transact(() => sharedModel.updateSource(start, old.length - end, inserted), false);
    this.told();
  }

  /** Tell the kernel that the cell has the lab's text: one that is run again is compared with that. */
  told(): void {
    const text = this.text();
    this.known = plain(text);
    const { link, cell } = this.lab.store.state;
    if (link !== "dead" && plain(cell.text) !== this.known) this.lab.send({ do: "put_into_cell", text });
  }
}

/** The range that differs between two texts, from their starts and from their ends. */
export function difference(old: string, text: string): { start: number; end: number; inserted: string } {
  const most = Math.min(old.length, text.length);
  let start = 0;
  while (start < most && old[start] === text[start]) start++;
  let end = 0;
  while (end < most - start && old[old.length - 1 - end] === text[text.length - 1 - end]) end++;
  return { start, end, inserted: text.slice(start, text.length - end) };
}
