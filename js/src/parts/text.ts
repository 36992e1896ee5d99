/** The lab's menu entries for the text in the editor. */

import type { Editor } from "../editor/editor";
import { item, type MenuItem } from "../ui/menu";

/** `quiet`: there are no values in the text. */
export function textItems(editor: Editor, quiet: boolean): MenuItem[] {
  const values = item("Values in the text", "values", () => editor.showValues(!editor.showsValues), {
    checked: editor.showsValues,
  });
  return [
    ...(quiet ? [] : [values]),
    item("Brackets coloured by depth", "brackets", () => editor.showBrackets(!editor.showsBrackets), {
      checked: editor.showsBrackets,
    }),
    item("Format the text", "format", () => editor.format(), { hint: "⇧Alt F" }),
  ];
}
