/** Messages as the kernel sent them: notebooks differ in what becomes of Python's `None` and of bytes. */

/** A message with null for `None`, where some notebooks have undefined. */
export function withNulls<T>(value: T): T {
  if (typeof value !== "object" || value === null) return value;
  const entries = value as Record<string, unknown>;
  for (const key of Object.keys(entries)) {
    if (entries[key] === undefined) entries[key] = null;
    else withNulls(entries[key]);
  }
  return value;
}

/** Bytes as a `DataView`, where some notebooks have an array of them, perhaps within a larger buffer. */
export function viewOf(bytes: ArrayBuffer | ArrayBufferView): DataView {
  return bytes instanceof ArrayBuffer
    ? new DataView(bytes)
    : new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}
