/** A table of a panel. Where there is little room each row is a card: the stylesheet turns cells into lines. */

import type { Button, Table } from "../protocol";
import { h, reconcile, setAttribute, setProse, unmarked } from "../ui/dom";

export interface DrawnTable {
  element: HTMLElement;
  refresh(table: Table): void;
}

interface Row {
  key: string;
  cells: string[];
}

const NUMBER = /^-?[\d.]+(e[+-]?\d+)?$/;

export function tableOf(table: Table, makeButton: (one: Button, row: string) => HTMLElement): DrawnTable {
  const { key, title, columns, buttons } = table;
  const head = columns.map((name) => h("th", { scope: "col", role: "columnheader" }, name));
  if (buttons.length) head.push(h("th", { scope: "col", role: "columnheader", "aria-label": "do" }));
  const rows = h("tbody", { role: "rowgroup" });
  const empty = h("p", { class: "lrp-empty" }, "None yet.");
  const make = ({ key: row }: Row) =>
    h(
      "tr",
      { role: "row", "data-row": row },
      ...columns.map((name) => h("td", { role: "cell", "data-column": name })),
      buttons.length > 0 &&
        h("td", { role: "cell", class: "lrp-row-buttons" }, ...buttons.map((one) => makeButton(one, row))),
    );
  const update = (element: Element, { cells }: Row) => {
    cells.forEach((text, index) => {
      const cell = element.children[index] as HTMLElement;
      setProse(cell, text);
      setAttribute(cell, "title", text.length > 24 && unmarked(text));
      // in a card a number needs the name of its column; words speak for themselves
      setAttribute(cell, "data-label", NUMBER.test(text) && columns[index]);
    });
  };
  const element = h(
    "section",
    { class: "lrp-table-frame" },
    h(
      "table",
      { class: "lrp-table", role: "table", "data-table": key },
      h("caption", {}, title),
      h("thead", { role: "rowgroup" }, h("tr", { role: "row" }, ...head)),
      rows,
    ),
    empty,
  );
  return {
    element,
    refresh(now) {
      const all = now.rows.map((cells, index) => ({ key: now.keys[index] ?? String(index), cells }));
      reconcile(rows, all, (row) => row.key, make, update);
      empty.hidden = all.length > 0;
    },
  };
}
