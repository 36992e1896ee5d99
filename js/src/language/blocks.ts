/**
 * Where the Python of a block ends: a port of `lrp_jupyter/language/python/scanner.py`, which explains the
 * rules. The corpus `tests/language/blocks.json` holds the two equal.
 *
 * It reads characters through a function, so that it works on a string and on the parser's stream,
 * which thereby records how far a token has read ahead.
 */

/** The UTF-16 unit at an offset; -1 after the end (and before the beginning). */
type CharAt = (offset: number) => number;

const HASH = 35;
const OPEN = 91;
const CLOSE = 93;
const BACKSLASH = 92;
const DOUBLE = 34;
const SINGLE = 39;
const BRACE = 123;
const UNBRACE = 125;
const COLON = 58;
const NEWLINE = 10;
const RETURN = 13;
const DEEPEST = 100;
const PREFIXES = new Set(["r", "u", "b", "br", "rb", "f", "fr", "rf"]);

/** The offset of the `]` that closes the block whose `[` stands at `start`; -1 if there is none. */
export function blockEnd(at: CharAt, start: number): number {
  let depth = 0;
  let position = start;
  for (;;) {
    const char = at(position);
    if (char < 0) return -1;
    if (char === OPEN) depth++;
    else if (char === CLOSE && --depth === 0) return position;
    else if (char === HASH) position = lineEnd(at, position) - 1;
    else if (isQuote(char)) position = stringEnd(at, position, start) - 1;
    position++;
  }
}

function isQuote(char: number): boolean {
  return char === DOUBLE || char === SINGLE;
}

function isLineEnd(char: number): boolean {
  return char === NEWLINE || char === RETURN;
}

function lineEnd(at: CharAt, position: number): number {
  let end = position;
  while (at(end) >= 0 && !isLineEnd(at(end))) end++;
  return end;
}

function tripled(at: CharAt, position: number): boolean {
  const quote = at(position);
  return at(position + 1) === quote && at(position + 2) === quote;
}

/** The offset after a string; of one that is not closed, the end of its line or of the text. */
function stringEnd(at: CharAt, quoteAt: number, floor: number): number {
  const end = closedEnd(at, quoteAt, floor, 0);
  if (end >= 0) return end;
  if (tripled(at, quoteAt)) {
    let last = quoteAt;
    while (at(last) >= 0) last++;
    return last;
  }
  if (!prefix(at, quoteAt, floor).includes("f")) return plainEnd(at, quoteAt + 1, at(quoteAt), false);
  return lineEnd(at, quoteAt);
}

function isWord(char: number): boolean {
  if (char < 0) return false;
  if (char < 128) return char === 95 || /[0-9A-Za-z]/.test(String.fromCharCode(char));
  return (char >= 0xd800 && char < 0xe000) || /[\p{L}\p{N}]/u.test(String.fromCharCode(char));
}

/** The letters before a quote, if they are a prefix; template strings count as f-strings. */
function prefix(at: CharAt, quoteAt: number, floor: number): string {
  let letters = "";
  let start = quoteAt;
  while (start > floor && quoteAt - start < 3 && isWord(at(start - 1))) {
    start--;
    letters = String.fromCharCode(at(start)) + letters;
  }
  letters = letters.toLowerCase().replaceAll("t", "f");
  return PREFIXES.has(letters) ? letters : "";
}

/** The offset at which the text of a string without fields stops: its closing quotes, or where it breaks off. */
function plainEnd(at: CharAt, from: number, quote: number, triple: boolean): number {
  let position = from;
  for (;;) {
    const char = at(position);
    if (char < 0) return position;
    if (char === BACKSLASH) {
      if (at(position + 1) < 0) return position;
      position += at(position + 1) === RETURN && at(position + 2) === NEWLINE ? 3 : 2;
    } else if (char === quote && (!triple || tripled(at, position))) return position;
    else if (!triple && isLineEnd(char)) return position;
    else position++;
  }
}

/** The offset after a string; -1 if it is not closed. */
function closedEnd(at: CharAt, quoteAt: number, floor: number, depth: number): number {
  const quote = at(quoteAt);
  const triple = tripled(at, quoteAt);
  const length = triple ? 3 : 1;
  const letters = prefix(at, quoteAt, floor);
  const begin = quoteAt + length;
  if (letters.includes("f")) return formattedEnd(at, begin, quote, triple, letters.includes("r"), depth);
  const end = plainEnd(at, begin, quote, triple);
  return closes(at, end, quote, triple) ? end + length : -1;
}

function closes(at: CharAt, position: number, quote: number, triple: boolean): boolean {
  return at(position) === quote && (!triple || tripled(at, position));
}

function formattedEnd(
  at: CharAt,
  from: number,
  quote: number,
  triple: boolean,
  raw: boolean,
  depth: number,
): number {
  if (depth > DEEPEST) return -1;
  let position = from;
  for (;;) {
    position = literalEnd(at, position, quote, triple, raw);
    if (closes(at, position, quote, triple)) return position + (triple ? 3 : 1);
    if (at(position) !== BRACE) return -1;
    position = fieldEnd(at, position + 1, quote, triple, depth);
    if (position < 0) return -1;
  }
}

/** Skip the text of an f-string up to a field, its closing quotes, or where it breaks off. */
function literalEnd(at: CharAt, from: number, quote: number, triple: boolean, raw: boolean): number {
  let position = from;
  for (;;) {
    const char = at(position);
    if (char < 0) return position;
    if (char === BACKSLASH) {
      const named = raw ? -1 : namedEnd(at, position);
      if (named >= 0) position = named;
      else {
        const next = at(position + 1);
        if (next < 0) return position;
        if (next === BRACE || next === UNBRACE) position += 1;
        else position += next === RETURN && at(position + 2) === NEWLINE ? 3 : 2;
      }
    } else if (char === BRACE) {
      if (at(position + 1) !== BRACE) return position;
      position += 2;
    } else if (char === quote) {
      if (!triple || tripled(at, position)) return position;
      position++;
    } else if (!triple && isLineEnd(char)) return position;
    else position++;
  }
}

/** The offset after `\N{LATIN SMALL LETTER A}`, which is a name, not a field; -1 if it is not one. */
function namedEnd(at: CharAt, position: number): number {
  if (at(position + 1) !== 78 || at(position + 2) !== BRACE) return -1;
  for (let end = position + 3; ; end++) {
    const char = at(end);
    if (char === UNBRACE) return end + 1;
    if (char < 0 || char === BRACE || isQuote(char) || isLineEnd(char)) return -1;
  }
}

/** The offset after the `}` of a replacement field; -1 if it is not closed. */
function fieldEnd(at: CharAt, from: number, quote: number, triple: boolean, depth: number): number {
  let position = from;
  let level = 0;
  for (;;) {
    const char = at(position);
    if (char < 0) return -1;
    position++;
    if (isQuote(char)) {
      position = closedEnd(at, position - 1, from, depth + 1);
      if (position < 0) return -1;
    } else if (char === HASH) position = lineEnd(at, position);
    else if (char === 40 || char === OPEN || char === BRACE) level++;
    else if (char === 41 || char === CLOSE || char === UNBRACE) {
      if (level > 0) level--;
      else if (char === UNBRACE) return position;
    } else if (char === COLON && level === 0) return formatEnd(at, position, quote, triple, depth);
  }
}

/** The offset after the `}` of a field whose format begins at `from`; -1 if it is not closed. */
function formatEnd(at: CharAt, from: number, quote: number, triple: boolean, depth: number): number {
  if (depth > DEEPEST) return -1;
  let position = from;
  for (;;) {
    for (;;) {
      const char = at(position);
      if (char < 0 || char === BRACE || char === UNBRACE) break;
      if (char === quote && (!triple || tripled(at, position))) break;
      if (!triple && isLineEnd(char)) break;
      position++;
    }
    if (at(position) === UNBRACE) return position + 1;
    if (at(position) !== BRACE) return -1;
    position = fieldEnd(at, position + 1, quote, triple, depth + 1);
    if (position < 0) return -1;
  }
}
