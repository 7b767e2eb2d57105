// Short functions that make DOM elements.

type Options = { text?: string; onTap?: () => void; label?: string };

export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  className: string,
  options: Options = {},
  ...children: HTMLElement[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  element.className = className;
  if (options.text !== undefined) element.textContent = options.text;
  if (options.label) element.setAttribute("aria-label", options.label);
  if (options.onTap) element.addEventListener("click", options.onTap);
  element.append(...children);
  return element;
}

/** Writes a text only if it has changed, as layout takes longer than a comparison. */
export function write(element: HTMLElement, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function show(element: HTMLElement, visible: boolean): void {
  if (element.hidden === visible) element.hidden = !visible;
}

/** Keeps touches that begin on an element. Chromium gives a touch beside a button to the button, unless
 * what lies under the finger can be clicked as well. */
export function claim(element: HTMLElement): void {
  element.addEventListener("click", () => undefined);
}
