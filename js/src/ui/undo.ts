/** The keys of undo and redo, wherever they are pressed. */

const WRITTEN = "input:not([type=range], [type=checkbox]), textarea, [contenteditable=true]";

/** What a key asks for; null where it means something else, as where text is written it does. */
export function stepOf({
  key,
  ctrlKey,
  metaKey,
  altKey,
  shiftKey,
  target,
}: KeyboardEvent): "undo" | "redo" | null {
  if (!(ctrlKey || metaKey) || altKey) return null;
  if ((target as Partial<Element>).closest?.(WRITTEN)) return null;
  const letter = key.toLowerCase();
  if (letter === "z") return shiftKey ? "redo" : "undo";
  return letter === "y" ? "redo" : null;
}
