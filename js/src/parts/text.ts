/** The lab's menu entries for the text in the editor. */

import type { Editor } from "../editor/editor";
import type { MenuItem } from "../ui/menu";

export function textItems(editor: Editor): MenuItem[] {
  return [
    {
      label: "Values in the text",
      action: "values",
      checked: editor.showsValues,
      run: () => editor.showValues(!editor.showsValues),
    },
    {
      label: "Brackets coloured by depth",
      action: "brackets",
      checked: editor.showsBrackets,
      run: () => editor.showBrackets(!editor.showsBrackets),
    },
    { label: "Format the text", action: "format", hint: "⇧Alt F", run: () => editor.format() },
  ];
}
