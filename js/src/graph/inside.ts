/** Which machines a drawing contains: nested ones can be drawn inside their states. */

import type { Layout } from "../protocol";

/** The layouts that a drawing consists of, that of the machine itself first. */
export function layoutsIn(machine: string, layouts: Record<string, Layout>): Layout[] {
  const layout = layouts[machine];
  if (!layout) return [];
  const inner = layout.states.flatMap(({ inside }) => inside);
  return [layout, ...inner.flatMap((nested) => layoutsIn(nested.machine, layouts))];
}

/** Whether a machine is seen where another one is shown. */
export function isDrawnIn(path: string, shown: string, layouts: Record<string, Layout>): boolean {
  return layoutsIn(shown, layouts).some(({ machine }) => machine === path);
}
