/**
 * Messages as the other side wrote them. Notebooks differ in what becomes of Python's `None` (null, undefined, or
 * nothing at all), of JavaScript's null and of bytes, so a message travels as a text in JSON.
 */

export interface Packed {
  json: string;
}

export function packed(message: unknown): Packed {
  return { json: JSON.stringify(message) };
}

export function unpacked<T>({ json }: Packed): T {
  return JSON.parse(json);
}

/** Bytes as a `DataView`, where some notebooks have an array of them, perhaps within a larger buffer. */
export function viewOf(bytes: ArrayBuffer | ArrayBufferView): DataView {
  return bytes instanceof ArrayBuffer
    ? new DataView(bytes)
    : new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}
