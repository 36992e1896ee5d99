/** Pictures of what the page shows, saved as files: SVG for print and slides, PNG for everything else. */

import type { Box } from "../graph/camera";
import { h, s } from "./dom";
import { parentOf } from "./root";

const DENSITY = 2; // pixels of a PNG per px of the page
const SVG = "http://www.w3.org/2000/svg";
/** The properties by which a stylesheet changes how SVG looks. */
const STYLES = [
  ...["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linejoin"],
  ...["stroke-linecap", "stroke-opacity", "paint-order", "opacity", "visibility"],
  ...["font-family", "font-size", "font-weight", "text-anchor"],
];
/** What is there for the pointer alone. */
const HANDLES = ".lrp-layer-pencil";
/** Attributes for pointer, keyboard and tests. */
const OF_PAGE = /^(class|style|role|tabindex|aria-|data-)/;

/**
 * Part of an SVG element as a document that looks the same without this page: its styles are written into it.
 * `layer` is the child of the element that is zoomed and panned; `box` is in its coordinates.
 */
export function svgDocument(svg: SVGSVGElement, layer: SVGElement, box: Box): string {
  const copy = layer.cloneNode(true) as SVGElement;
  copy.querySelector(HANDLES)?.remove();
  const originals = [layer, ...layer.querySelectorAll<SVGElement>("*")].filter(
    (one) => !one.closest(HANDLES),
  );
  const copies = [copy, ...copy.querySelectorAll<SVGElement>("*")];
  for (const [index, original] of originals.entries()) write(getComputedStyle(original), copies[index]!);
  copy.removeAttribute("transform");
  const { x, y, width, height } = box;
  const paper = opaque(svg);
  const whole = s(
    "svg",
    { xmlns: SVG, width, height, viewBox: [x, y, width, height].join(" ") },
    s("title", {}, svg.getAttribute("aria-label") ?? ""),
    s("rect", { x, y, width, height, fill: paper }),
    copy,
  );
  return new XMLSerializer().serializeToString(whole);
}

/** Write the styles of an element into its copy, which loses what only this page uses; drop what is not seen. */
function write(style: CSSStyleDeclaration, copy: SVGElement): void {
  if (style.display === "none" || style.opacity === "0" || style.stroke === "rgba(0, 0, 0, 0)") {
    copy.remove();
    return;
  }
  for (const { name } of [...copy.attributes]) if (OF_PAGE.test(name)) copy.removeAttribute(name);
  for (const name of STYLES) {
    const value = style.getPropertyValue(name);
    if (value) copy.setAttribute(name, value);
  }
}

/** The colour of the paper below an element. */
function opaque(element: Element | null): string {
  for (let at = element; at; at = parentOf(at)) {
    const colour = getComputedStyle(at).backgroundColor;
    if (colour && colour !== "transparent" && colour !== "rgba(0, 0, 0, 0)") return colour;
  }
  return "white";
}

export async function pngOfSvg(document: string, { width, height }: Box): Promise<Blob> {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(document)}`;
  await image.decode();
  const canvas = h("canvas", { width: Math.ceil(width * DENSITY), height: Math.ceil(height * DENSITY) });
  canvas.getContext("2d")!.drawImage(image, 0, 0, canvas.width, canvas.height);
  return pngOf(canvas);
}

export function pngOf(canvas: HTMLCanvasElement): Promise<Blob> {
  return new Promise((resolve, reject) => {
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("too large"))));
  });
}

/** Have the browser save a picture as a file; `refuse` gets the sentence that says why there is none. */
export async function savePicture(
  name: string,
  picture: Blob | Promise<Blob>,
  refuse: (sentence: string) => void,
): Promise<void> {
  const content = await Promise.resolve(picture).catch(() => null);
  if (!content) return refuse("The browser cannot make a picture of this size. Save it as SVG.");
  const address = URL.createObjectURL(content);
  h("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 60_000); // when it is certainly saved
}
