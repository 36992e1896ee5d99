// @vitest-environment happy-dom
import { expect, it, vi } from "vitest";
import { Page } from "./opened";
import recording from "./page/recording.json";

const TEXT = `(machine m
  ; robot.dock() is in words only
  (state going
    (running [robot.dock(2)])
    (machine inner
      (state talking (onentry [robot.say ("robot.dock()")]))
      (state silent (running [robot.say("")]))))
  (state home (running [robot.dock(0)])))
(spawn m going)`;

it("says what has become of a task in the line of the active state that asks for it", async () => {
  const page = new Page();
  const lit = ["m/going", "m/going/inner/talking"];
  const member = (name: string, kind = "task") => ({ name, kind, type: "", unit: "", doc: "", insert: "" });
  const { bridge, ...frame } = recording.snapshot.frame;
  const robot = { ...bridge, members: [member("dock"), member("say"), member("stop", "method")] };
  const text = { text: TEXT, running: TEXT, findings: [] };
  const members = { dock: "aborted: the way is blocked", say: "active" };
  page.open({ ...text, frame: { ...frame, bridge: robot, members, lit } as never });
  await page.drawn();
  const shown = () =>
    [...page.host.querySelectorAll<HTMLElement>(".lrp-inline-value")].map((each) => {
      const { number } = page.editor.state.doc.lineAt(page.editor.posAtDOM(each));
      return [number, each.textContent, each.querySelector("[data-failed]") !== null];
    });
  expect(shown()).toEqual([
    [4, "aborted: the way is blocked", true],
    [6, "active", false],
  ]);
  const drawn = vi.spyOn(page.editor, "dispatch");
  const later = vi.spyOn(window, "setTimeout");
  const tell = async (frame: number, more: Record<string, string>) => {
    later.mockClear();
    drawn.mockClear();
    page.deliver({ type: "frame", frame, members: { ...members, ...more } });
    await page.drawn();
    return drawn.mock.calls.length + later.mock.calls.length;
  };
  expect(await tell(2, { stop: "other" })).toBe(0); // what is not shown draws nothing
  expect(await tell(3, { say: "succeeded" })).toBeGreaterThan(0);
  expect(shown()[1]).toEqual([6, "succeeded", false]);
  page.close();
});
