/** The editor's key bindings, except those of single features. */

import { closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import {
  copyLineDown,
  copyLineUp,
  deleteLine,
  historyKeymap,
  indentSelection,
  indentWithTab,
  moveLineDown,
  moveLineUp,
  selectLine,
  selectParentSyntax,
  simplifySelection,
  standardKeymap,
  toggleComment,
} from "@codemirror/commands";
import { foldKeymap } from "@codemirror/language";
import { nextDiagnostic, previousDiagnostic } from "@codemirror/lint";
import {
  closeSearchPanel,
  findNext,
  findPrevious,
  openSearchPanel,
  selectNextOccurrence,
  selectSelectionMatches,
} from "@codemirror/search";
import type { KeyBinding } from "@codemirror/view";
import { newLine } from "../language/indent";

const everywhere = { scope: "editor search-panel", preventDefault: true };

export const keys: KeyBinding[] = [
  ...closeBracketsKeymap,
  ...completionKeymap,
  { key: "Mod-f", run: openSearchPanel, ...everywhere },
  { key: "F3", run: findNext, shift: findPrevious, ...everywhere },
  { key: "Mod-g", run: findNext, shift: findPrevious, ...everywhere },
  { key: "Mod-d", run: selectNextOccurrence, preventDefault: true },
  { key: "Mod-Shift-l", run: selectSelectionMatches, preventDefault: true },
  { key: "Escape", run: closeSearchPanel, scope: "editor search-panel" },
  { key: "F8", run: nextDiagnostic, shift: previousDiagnostic },
  { key: "Mod-/", run: toggleComment },
  { key: "Alt-ArrowUp", run: moveLineUp, shift: copyLineUp },
  { key: "Alt-ArrowDown", run: moveLineDown, shift: copyLineDown },
  { key: "Mod-Shift-k", run: deleteLine },
  { key: "Alt-l", mac: "Ctrl-l", run: selectLine },
  { key: "Mod-i", run: selectParentSyntax, preventDefault: true },
  { key: "Mod-Alt-\\", run: indentSelection },
  { key: "Escape", run: simplifySelection },
  ...historyKeymap,
  ...foldKeymap,
  indentWithTab,
  { key: "Enter", run: newLine },
  ...standardKeymap,
];
