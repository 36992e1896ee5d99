/**
 * Numbers for reading: one with many digits has as many as a person needs, and no fewer, so that its width stays the
 * same while it changes. Whoever edits, copies or inspects a value gets the exact one.
 */

const DIGITS = 4;
const WHOLE = 1e15; // from here on, text has an exponent
const LITERALS = /'(?:\\.|[^'\\])*'|"(?:\\.|[^"\\])*"|(?<![\w.])\d+(?:\.\d*)?(?:e[+-]?\d+)?(?=j?(?![\w.]))/g;

export function readableNumber(number: number): string {
  return readable(String(number));
}

/** The text of a value with its numbers for reading; quoted text is left as it is. */
export function readable(text: string): string {
  return text.replace(LITERALS, (literal) => (/^\d/.test(literal) ? withFewDigits(literal) : literal));
}

function withFewDigits(literal: string): string {
  const [mantissa = "", exponent] = literal.split("e");
  const [whole = "", fraction = ""] = mantissa.split(".");
  const digits = (whole + fraction).replace(/^0+|0+$/g, "").length;
  if (digits <= DIGITS || (!exponent && /^0*$/.test(fraction))) return literal;
  const number = Number(literal);
  const isLarge = number >= 10 ** (DIGITS - 1) && number < WHOLE;
  return isLarge ? number.toFixed(0) : number.toPrecision(DIGITS);
}
