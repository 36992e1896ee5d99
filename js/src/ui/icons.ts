/** The lab's own icons: 16 px, drawn with the colour of the text. */

import { s } from "./dom";

const PATHS = {
  run: "M5 3.2v9.6L12.6 8z",
  pause: "M4.5 3h2.4v10H4.5zM9.1 3h2.4v10H9.1z",
  step: "M3.5 3.2v9.6L9.6 8zM10.6 3h2v10h-2z",
  step_back: "M12.5 3.2v9.6L6.4 8zM3.4 3h2v10h-2z",
  reset: "M8 3a5 5 0 1 1-4.8 6.4l1.5-.5A3.4 3.4 0 1 0 5.3 6H7.4v1.6H2.8V3h1.6v1.6A5 5 0 0 1 8 3z",
  stop: "M5.3 2.5h5.4l2.8 2.8v5.4l-2.8 2.8H5.3l-2.8-2.8V5.3z",
  more: "M3 6.7a1.3 1.3 0 1 1 0 2.6 1.3 1.3 0 0 1 0-2.6zm5 0a1.3 1.3 0 1 1 0 2.6 1.3 1.3 0 0 1 0-2.6zm5 0a1.3 1.3 0 1 1 0 2.6 1.3 1.3 0 0 1 0-2.6z",
  plus: "M7.2 3h1.6v4.2H13v1.6H8.8V13H7.2V8.8H3V7.2h4.2z",
  minus: "M3 7.2h10v1.6H3z",
  fit: "M2.5 2.5h4V4H4v2.5H2.5zm7 0h4v4H12V4H9.500zM2.500 9.500H4V12h2.500v1.500h-4zM12 9.500h1.500v4h-4V12H12z",
  enlarge:
    "M8.5 2.500h5v5H12V5.060L9.060 8 8 6.940 10.940 4H8.500zM2.500 8.500H4v2.440L6.940 8 8 9.060 5.060 12H7.500v1.500h-5z",
  arrange:
    "M2.500 2.500h4v4h-4zm7 0h4v4h-4zm-3.500 7h4v4h-4zM6.500 4h3v1h-3zM4.500 6.500l2.500 3-.8.6-2.500-3z",
  close: "M4 3l4 4 4-4 1 1-4 4 4 4-1 1-4-4-4 4-1-1 4-4-4-4z",
  search:
    "M7 2.500a4.500 4.500 0 0 1 3.600 7.200l2.900 2.900-1 1-2.900-2.900A4.500 4.500 0 1 1 7 2.500zM7 4a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
  draw: "M11.500 2.500l2 2-7.500 7.500-2.800.8.8-2.800zM2.500 14h11v1h-11z",
  erase: "M9 3l4.500 4.500-5 5H5L2.500 10zM3.900 10l1.800 1.500h2L9.500 9.700 6.300 6.500z",
  hand: "M3 3l4.200 10 1.600-4.200L13 7.200z",
  save: "M3 2.500h8l2.500 2.500v8.500h-11V2.500zM5 4v3h5V4zm0 5.500V12h6V9.500z",
  world: "M2.500 3.500h11v9h-11zM4 5v6h8V5zm4 1.500A1.500 1.500 0 1 1 8 9.500 1.500 1.500 0 0 1 8 6.500z",
  panels: "M2.500 3h11v10h-11zM4 4.500v7h2.500v-7zm4 0v3h4v-3zM8 9v2.500h4V9z",
  right: "M6 4l4.500 4L6 12z",
} as const;

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  return s(
    "svg",
    { class: "lrp-icon", viewBox: "0 0 16 16", "aria-hidden": "true", focusable: "false" },
    s("path", { d: PATHS[name] }),
  );
}
