/** The lab's menu entries for the text in the editor. */

import type { Editor } from "../editor/editor";
import type { MenuItem } from "../ui/menu";

/** `quiet`: there are no values in the text. */
export function textItems(editor: Editor, quiet: boolean): MenuItem[] {
  const values = {
    label: "Values in the text",
    action: "values",
    checked: editor.showsValues,
    run: () => editor.showValues(!editor.showsValues),
  };
  return [
    ...(quiet ? [] : [values]),
    {
      label: "Brackets coloured by depth",
      action: "brackets",
      checked: editor.showsBrackets,
      run: () => editor.showBrackets(!editor.showsBrackets),
    },
    { label: "Format the text", action: "format", hint: "⇧Alt F", run: () => editor.format() },
  ];
}
