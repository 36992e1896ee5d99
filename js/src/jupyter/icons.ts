/** The icons of programs and recordings: two states with transitions, and a timeline. */

import { LabIcon } from "@jupyterlab/ui-components";

const icon = (name: string, drawing: string) =>
  new LabIcon({
    name: `lrp-jupyter:${name}`,
    svgstr: `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 22 22" width="16" fill="none"><g class="lrp-file-icon" stroke="#1f78b4" stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round">${drawing}</g></svg>`,
  });

export const programIcon = icon(
  "program",
  '<rect x="2" y="3" width="9" height="6" rx="2"/><rect x="11" y="13" width="9" height="6" rx="2"/>' +
    '<path d="M14 6h2.500v4M14.500 8.500l2 2 2-2M8 16H5.500v-4M3.500 13.500l2-2 2 2"/>',
);

export const recordingIcon = icon(
  "recording",
  '<path d="M2 6h7M12 6h8M2 11h3M8 11h12M2 16h11M16 16h4"/><path stroke="#e31a1c" d="M13.500 2.500v17"/>',
);
