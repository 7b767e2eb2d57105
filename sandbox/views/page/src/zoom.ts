// Forms can be zoomed, as in any page; the table cannot, as everything on it has its true size.

import { show } from "./dom";

const meta = document.querySelector<HTMLMetaElement>("meta[name=viewport]")!;
const PLAIN = meta.content;
const open = new Set<HTMLElement>();

/** Shows or hides an element with a form or text. A zoomed page returns to its size afterwards. */
export function showForm(form: HTMLElement, visible: boolean): void {
  show(form, visible);
  if (visible) open.add(form);
  else open.delete(form);
  meta.content = open.size ? PLAIN : `${PLAIN}, maximum-scale=1, user-scalable=no`;
  document.documentElement.classList.toggle("zoomable", open.size > 0);
}
