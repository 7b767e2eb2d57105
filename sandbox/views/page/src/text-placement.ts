// Where words stand: at the place where they cover least of what has to be seen.

import type { Rectangle } from "./camera";

export type Size = Pick<Rectangle, "width" | "height">;

/** CSS pixels that the buttons at the bottom of a phone need, and of the margin at all sides. */
export const FOOTER = 66;
export const SIDE = 14;

/** Rows and columns in which words may stand. */
const ROWS = 9;
const COLUMNS = 9;

/** Places for words of a size, row by row from the top, in each from its middle to its sides.
 *
 * @param left CSS pixels of the page at the left that are taken; `right` likewise.
 * @param rows CSS pixels from the top of the page to each row.
 */
export function placesFor(size: Size, left: number, right: number, rows: number[]): Rectangle[] {
  const { width, height } = size;
  const [first, last] = [left + SIDE, window.innerWidth - right - SIDE - width];
  const columns = Array.from({ length: COLUMNS }, (_, i) => first + ((last - first) * i) / (COLUMNS - 1));
  const middle = (window.innerWidth - width) / 2;
  columns.sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle));
  return rows.flatMap((top) => columns.map((at) => ({ left: Math.max(at, first), top, width, height })));
}

/** Rows from the top of the page in which words of a height may stand, in CSS pixels. */
export function rowsFor(height: number): number[] {
  const lowest = window.innerHeight - SIDE - height;
  return Array.from({ length: ROWS }, (_, i) => SIDE + ((lowest - SIDE) * i) / (ROWS - 1));
}

/** The place of several that covers least; of equal ones the first. */
export function leastCovering(places: Rectangle[], things: Rectangle[]): Rectangle {
  const covered = places.map((place) => covering(place, things));
  return places[covered.indexOf(Math.min(...covered))]!;
}

/** Area of things that a place covers. */
export const covering = (place: Rectangle, things: Rectangle[]): number =>
  things.reduce((sum, thing) => sum + common(place, thing), 0);

/** Area that two rectangles share. */
function common(a: Rectangle, b: Rectangle): number {
  const wide = Math.min(a.left + a.width, b.left + b.width) - Math.max(a.left, b.left);
  const high = Math.min(a.top + a.height, b.top + b.height) - Math.max(a.top, b.top);
  return Math.max(wide, 0) * Math.max(high, 0);
}
