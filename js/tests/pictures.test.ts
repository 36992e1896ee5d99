import { expect, it, vi } from "vitest";
import type { Notebook } from "../src/host/notebook";

it("the pictures of a notebook are stored once, however many labs it has, each a module of its own", async () => {
  const connect = vi.fn();
  const notebook = { saveState: { connect } } as unknown as Notebook;
  for (const _ of [1, 2]) {
    vi.resetModules();
    const { storePictures } = await import("../src/host/pictures");
    storePictures(notebook);
  }
  expect(connect).toHaveBeenCalledTimes(1);
});
