// A small picture of a hand, seen from above, in which some fingers have their colours.

import { fingerColour } from "./colours";

const SVG = "http://www.w3.org/2000/svg";
const UNUSED = "#4a5863";
/** Knuckle and tip of each finger of a right hand, thumb first, in a square of 64. */
const BONES = [
  [22, 52, 9, 38],
  [23, 36, 19, 13],
  [33, 34, 33, 8],
  [42, 36, 46, 12],
  [49, 42, 57, 22],
] as const;

/** @param fingers Labels of the fingers that are used, thumb 0 to little finger 4. */
export function handPicture(fingers: ReadonlySet<number>, side: "left" | "right"): SVGElement {
  const draw = (name: string, values: Record<string, string | number>): SVGElement => {
    const part = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(values)) part.setAttribute(key, String(value));
    return part;
  };
  const picture = draw("svg", { viewBox: "0 0 64 64", width: 64, height: 64, "aria-hidden": "true" });
  const hand = draw("g", side === "left" ? { transform: "translate(64 0) scale(-1 1)" } : {});
  hand.append(draw("rect", { x: 19, y: 34, width: 33, height: 28, rx: 11, fill: UNUSED }));
  BONES.forEach(([x1, y1, x2, y2], label) => {
    const stroke = fingers.has(label) ? fingerColour(label) : UNUSED;
    hand.append(draw("line", { x1, y1, x2, y2, stroke, "stroke-width": 8, "stroke-linecap": "round" }));
  });
  picture.append(hand);
  return picture;
}
