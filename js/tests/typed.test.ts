// @vitest-environment happy-dom

/** Lines typed letter by letter, with the answers of a real kernel (`tests/widgets/test_typed.py`). */

import { ChangeSet } from "@codemirror/state";
import { expect, it } from "vitest";
import typed from "../../tests/widgets/typed.json";
import type { FindingView, Sections } from "../src/protocol";
import { Page } from "./opened";

it("what is found changes only with texts that are programs, or are left as they are", async () => {
  const page = await new Page().begin();
  const all = typed.findings as FindingView[][];
  page.open({
    text: typed.text,
    running: typed.text,
    document: "typed",
    findings: all[typed.steps[0]!.findings]!,
  });
  await page.drawn();
  const read = (selector: string) =>
    [...page.host.querySelectorAll(selector)].map(({ textContent }) => textContent).join("\n");
  const list = () => read(".lrp-issue-text");
  const marks = () => read(".cm-lintRange");
  let changes = 0;
  let judged = typed.steps[0]!.findings;
  let others = 0;
  for (const { changes: sections, findings, accepted, half_typed } of typed.steps) {
    const before = { list: list(), marks: marks() };
    for (const each of sections as Sections[])
      page.editor.dispatch({ changes: ChangeSet.fromJSON(each), userEvent: "input" }); // as it was typed: nothing is indented
    page.confirm({ findings: all[findings]!, accepted, half_typed });
    await page.drawn();
    if (list() !== before.list) changes++;
    if (!accepted && half_typed) expect({ list: list(), marks: marks() }).toEqual(before);
    else {
      if (findings !== judged) others++;
      judged = findings;
      const words = all[findings]!.map(({ severity, message }) => `${severity}: ${message}`);
      expect(list()).toBe(words.join("\n").replaceAll("`", ""));
    }
  }
  expect(changes).toBeGreaterThan(3);
  expect(changes).toBeLessThanOrEqual(others);
  page.close();
});
