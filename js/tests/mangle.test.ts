import { expect, it } from "vitest";
import { ownNames } from "../mangle.mjs";

it("shortens only names that are the bundle's own affair", () => {
  const bundle = `
class View {
  measureNow() { this.innerState = 1; return this.innerState + event.rangeOffsetOnly; }
}
const wire = { first_tick: 1, on_active_edit: 2 };
element.dataset.lrpState = "";
const attributes = { contenteditable: "true", writingsuggestions: "false" };
const keys = { namedElsewhere: 1 };
read(keys, "namedElsewhere");
element.scrollIntoView({ clientWidth: 1 });
`;
  expect(ownNames(bundle)).toEqual(["innerState", "measureNow"]);
});
