/** Paths of machines and states: names with slashes between. */

/** The path of what is around. */
export const parentOf = (path: string) => path.slice(0, Math.max(0, path.lastIndexOf("/")));

/** The transition at a path: its machine, a colon, its name. */
export const transitionAt = (path: string) => path && `${parentOf(path)}:${nameOf(path)}`;

/** The machine of an element: `m` of `m/a`, and of `m:go`. */
export const machineOf = (path: string) =>
  path.includes(":") ? path.slice(0, path.indexOf(":")) : parentOf(path);

export const nameOf = (path: string) => path.slice(path.lastIndexOf("/") + 1);

/** Whether a path is `around`, or that of something in it. */
export const isIn = (path: string, around: string) => !around || `${path}/`.startsWith(`${around}/`);

/** What tells paths apart: each without the names with which all of them begin and end. */
export function differences(paths: readonly string[]): string[] {
  const all = paths.map((path) => path.split("/"));
  const least = Math.min(...all.map(({ length }) => length));
  const isShared = (at: number) => all.every((names) => names.at(at) === all[0]!.at(at));
  let [before, after] = [0, 0];
  while (before < least && isShared(before)) before++;
  while (after < least - before && isShared(-1 - after)) after++;
  return all.map((names) => names.slice(before, names.length - after).join("/"));
}
