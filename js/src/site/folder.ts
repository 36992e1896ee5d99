/**
 * A folder of Python's that the browser stores: only what has changed here, so that what another tab has
 * stored stays, and all of it at once, so that it fits together.
 */

import { openDB } from "idb";
import type { PyodideInterface } from "pyodide";

const NAME = "lrp-texts";
const FILES = "files"; // contents, by path

export class Folder {
  private readonly known = new Map<string, string>(); // by path: the version of the file that is stored

  constructor(
    private readonly files: PyodideInterface["FS"],
    private readonly path: string,
  ) {
    files.mkdirTree(path);
  }

  /** Fill the folder with what is stored. */
  async load(): Promise<void> {
    const storage = await open();
    const { store, done } = storage.transaction(FILES);
    const [paths, contents] = await Promise.all([store.getAllKeys(), store.getAll(), done]);
    storage.close();
    paths.forEach((each, index) => {
      const path = String(each);
      this.files.mkdirTree(path.slice(0, path.lastIndexOf("/")));
      this.files.writeFile(path, contents[index]);
    });
    for (const [path, version] of this.versions()) this.known.set(path, version);
  }

  /** Store what has changed since. */
  async store(): Promise<void> {
    const now = new Map(this.versions());
    const changed = [...now].filter(([path, version]) => version !== this.known.get(path));
    const removed = [...this.known.keys()].filter((path) => !now.has(path));
    if (!changed.length && !removed.length) return;
    const contents = changed.map(([path]) => this.files.readFile(path)); // before anything else can happen
    const storage = await open();
    const { store, done } = storage.transaction(FILES, "readwrite");
    await Promise.all([
      ...changed.map(([path], index) => store.put(contents[index], path)),
      ...removed.map((path) => store.delete(path)),
      done,
    ]);
    storage.close();
    for (const [path, version] of changed) this.known.set(path, version);
    for (const path of removed) this.known.delete(path);
  }

  /** The files of the folder, each with a version that is another one whenever it has been written. */
  private *versions(folder = this.path): Generator<[string, string]> {
    for (const name of this.files.readdir(folder) as string[]) {
      if (name === "." || name === "..") continue;
      const path = `${folder}/${name}`;
      const { mode, mtime, size, ino } = this.files.stat(path);
      if (this.files.isDir(mode)) yield* this.versions(path);
      else yield [path, `${ino} ${size} ${Number(mtime)}`];
    }
  }
}

const open = () => openDB(NAME, 1, { upgrade: (storage) => void storage.createObjectStore(FILES) });
