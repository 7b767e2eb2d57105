// Forms can be zoomed, as in any page; the table cannot, as everything on it has its true size.

import { show } from "./dom";

const meta = document.querySelector<HTMLMetaElement>("meta[name=viewport]")!;
const PLAIN = meta.content;
const open = new Set<HTMLElement>();
/** Scale from which a page counts as zoomed. */
const ZOOMED = 1.01;
let look = (): void => undefined;

/** Shows or hides an element with a form or text. A zoomed page returns to its size afterwards. */
export function showForm(form: HTMLElement, visible: boolean): void {
  show(form, visible);
  if (visible) open.add(form);
  else open.delete(form);
  meta.content = open.size ? PLAIN : `${PLAIN}, maximum-scale=1, user-scalable=no`;
  document.documentElement.classList.toggle("zoomable", open.size > 0);
  look();
}

/** True while the table is zoomed: a browser that ignores the meta tag leaves it as large as the form was. */
export const tableZoomed = (): boolean =>
  open.size === 0 && (window.visualViewport?.scale ?? 1) > ZOOMED;

/** Tells of every change of the zoom. While the table is zoomed, two fingers can undo it. */
export function watchZoom(tell: () => void): void {
  look = () => {
    document.documentElement.classList.toggle("zoomed", tableZoomed());
    tell();
  };
  for (const change of ["resize", "scroll"]) window.visualViewport?.addEventListener(change, () => look());
  look();
}
