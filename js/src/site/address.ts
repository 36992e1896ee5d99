/**
 * What the address of the page asks for: `?program=`, `?challenge=` and `?world=`, and in the fragment the
 * text of a shared program. Browsers send no fragment to a server, so a shared text stays with those who have
 * the link.
 */

export interface Wanted {
  program?: string;
  challenge?: string;
  world?: string;
  text?: string;
}

const TEXT = "text=";

export async function readAddress(url: URL): Promise<Wanted> {
  const wanted: Wanted = {};
  for (const key of ["program", "challenge", "world"] as const) {
    const value = url.searchParams.get(key);
    if (value) wanted[key] = value;
  }
  if (!url.hash.startsWith(`#${TEXT}`)) return wanted;
  try {
    return { ...wanted, text: await unpack(url.hash.slice(1 + TEXT.length)) };
  } catch {
    throw new Error("The program in this link cannot be read: the link is damaged. Ask for it again.");
  }
}

export async function addressOf({ text, ...named }: Wanted, page: URL): Promise<URL> {
  const url = new URL(page.pathname, page);
  for (const [key, value] of Object.entries(named)) if (value) url.searchParams.set(key, value);
  if (text !== undefined) url.hash = TEXT + (await pack(text));
  return url;
}

async function pack(text: string): Promise<string> {
  const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  const characters = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(characters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function unpack(packed: string): Promise<string> {
  const characters = atob(packed.replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(characters, (character) => character.charCodeAt(0));
  const text = await through(bytes, new DecompressionStream("deflate-raw"));
  return new TextDecoder("utf-8", { fatal: true }).decode(text);
}

async function through(
  bytes: Uint8Array<ArrayBuffer>,
  stream: CompressionStream | DecompressionStream,
): Promise<Uint8Array> {
  const out = new Response(new Blob([bytes]).stream().pipeThrough(stream));
  return new Uint8Array(await out.arrayBuffer());
}
