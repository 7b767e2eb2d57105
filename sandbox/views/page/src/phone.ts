// The layout of a phone: its table takes a part of the page, and words and buttons take the rest, so that nothing
// covers an object. On a phone that lies they are in a column on the side away from the hand; on one that stands,
// above and below the table.

import type { Rectangle } from "./camera";
import { FOOTER } from "./text-placement";

export type Layout = "lies" | "stands";

/** CSS pixels, width of the column beside the table, within which a table that takes the page's height leaves
 * more or less of it. */
const COLUMN = { least: 210, most: 250 } as const;
/** Width of the smallest table, that of the paper, in heights. */
const WIDE = 7.75 / 5.8;
/** CSS pixels above the table that words need on a phone that stands, where its smallest table leaves them. */
const HEADER = 300;

export const layoutOf = (width: number, height: number): Layout => (width > height ? "lies" : "stands");

/** The part of a phone's page for its table and the lift control, in CSS pixels.
 *
 * @param hand The hand that plays: the column is on its other side.
 */
export function tableRoom(width: number, height: number, hand: "left" | "right" = "right"): Rectangle {
  if (layoutOf(width, height) === "lies") {
    const room = Math.min(Math.max(width - WIDE * height, COLUMN.least), COLUMN.most);
    const column = Math.min(room, width / 2);
    return { left: hand === "right" ? column : 0, top: 0, width: width - column, height };
  }
  const high = Math.max(Math.min(width, height - FOOTER - HEADER), width / WIDE, 1);
  return { left: 0, top: height - FOOTER - high, width, height: high };
}

/** Marks the layout for the style sheet; null is that of a larger screen.
 *
 * @param room The part of the page for the table.
 */
export function markLayout(layout: Layout | null, room: Rectangle): void {
  const { dataset, style } = document.documentElement;
  if (!layout) {
    delete dataset["phone"];
    return;
  }
  dataset["phone"] = layout;
  dataset["column"] = room.left > 0 ? "left" : "right";
  style.setProperty("--column", `${window.innerWidth - room.width}px`);
  style.setProperty("--table-top", `${room.top}px`);
}
