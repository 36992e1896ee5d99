/** The lab's menu entries for the text in the editor. */

import type { Editor } from "../editor/editor";
import { item, type MenuItem, switchItem } from "../ui/menu";

/** `quiet`: there are no values in the text. */
export function textItems(editor: Editor, quiet: boolean): MenuItem[] {
  return [
    ...(quiet ? [] : [switchItem("Values in the text", "values", editor.values)]),
    switchItem("Brackets coloured by depth", "brackets", editor.brackets),
    item("Format the text", "format", () => editor.format(), { hint: "⇧Alt F" }),
  ];
}
