// @vitest-environment happy-dom

import { expect, it } from "vitest";
import { cellAround, type Notebook } from "../src/host/notebook";
import { h } from "../src/ui/dom";

it("the cell around a lab is where it is now, also after cells were inserted above it", () => {
  const inside = h("div", {});
  const element = h("div", { class: "jp-Cell", "data-windowed-list-index": "1" }, inside);
  const cells = ["first", "of the lab"];
  const context = {
    model: { cells: { length: 2, get: (index: number) => cells[index] } },
  } as unknown as Notebook;
  const place = cellAround({ widget_manager: { context } }, inside);
  expect([place?.cell, place?.index]).toEqual(["of the lab", 1]);
  element.dataset.windowedListIndex = "2"; // JupyterLab counts again
  expect(place?.index).toBe(2);
  expect(cellAround({ widget_manager: { context } }, h("div", {}))).toBe(null);
});
