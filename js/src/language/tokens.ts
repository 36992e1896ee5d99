/** The two kinds of token that a regular grammar cannot recognise: words after `(`, and Python. */

import { ExternalTokenizer, type InputStream } from "@lezer/lr";
import { blockEnd } from "./blocks";
import * as terms from "./parser.terms";

const WORDS: Record<string, number> = {
  var: terms._var,
  machine: terms.machine,
  state: terms.state,
  event: terms.event,
  spawn: terms.spawn,
  onentry: terms.onentry,
  running: terms.running,
  onexit: terms.onexit,
  on: terms.on,
  ontime: terms.ontime,
  eps: terms.eps,
  exit: terms.exit,
  effect: terms.effect,
  onpause: terms.onpause,
  onresume: terms.onresume,
  onend: terms.onend,
};

/** Keywords are words only directly after `(`, the one place at which the parser asks for them. */
export const word = new ExternalTokenizer((input: InputStream) => {
  let text = "";
  for (let char = input.next; isNameUnit(char); char = input.advance()) text += String.fromCharCode(char);
  const term = WORDS[text];
  if (term !== undefined) input.acceptToken(term);
});

/** `for` after what a transition waits for; before the arrow it is a state. */
export const hold = new ExternalTokenizer((input: InputStream) => {
  for (const char of "for") {
    if (input.next !== char.charCodeAt(0)) return;
    input.advance();
  }
  if (isNameUnit(input.next)) return;
  let ahead = 0;
  for (let char = input.next; isSpace(char) || isComment(char); char = input.peek(++ahead)) {
    if (isComment(char)) while (!isBreak(input.peek(ahead + 1))) ahead++;
  }
  if (input.peek(ahead) !== 45 || input.peek(ahead + 1) !== 62) input.acceptToken(terms._for);
});

/** The inside of a block. One that is not closed ends with its line, so that the rest keeps its shape. */
export const python = new ExternalTokenizer((input: InputStream) => {
  if (input.peek(-1) !== 91) return; // white space after an empty block
  const start = input.pos - 1;
  const end = blockEnd((offset) => input.peek(offset - input.pos), start);
  let length = end - input.pos;
  if (end < 0) for (length = 0; !isBreak(input.peek(length)); length++);
  if (length > 0) {
    input.advance(length);
    input.acceptToken(terms.Python);
  }
});

function isBreak(char: number): boolean {
  return char < 0 || char === 10 || char === 13;
}

function isSpace(char: number): boolean {
  return (char >= 9 && char <= 13) || char === 32 || char === 160;
}

function isComment(char: number): boolean {
  return char === 59 || char === 35;
}

function isNameUnit(char: number): boolean {
  return char > 160 || /\w/.test(String.fromCharCode(char));
}
