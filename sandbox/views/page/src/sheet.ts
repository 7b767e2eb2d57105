// A sheet over the scene, with a menu or a question. One at a time; the trial is paused.

import { make } from "./dom";
import { say } from "./words";
import { showForm } from "./zoom";

export class Sheets {
  private current: HTMLElement | null = null;
  /** What had the focus before. */
  private before: Element | null = null;

  constructor(
    private readonly root: HTMLElement,
    private readonly onOpen: (open: boolean) => void,
  ) {}

  get isOpen(): boolean {
    return this.current !== null;
  }

  /** @param zoom False for a sheet that shows something at its true size. */
  open(title: string, content: HTMLElement[], closing = say("close"), onClose?: () => void, zoom = true): void {
    this.remove();
    const close = (): void => {
      this.close();
      onClose?.();
    };
    const sheet = make(
      "section",
      "sheet",
      {},
      make("h2", "", { text: title }),
      ...content,
      make("div", "row end-row", {}, make("button", "button large", { text: closing, onTap: close })),
    );
    const veil = make("div", "veil", {}, sheet);
    veil.setAttribute("role", "dialog");
    veil.setAttribute("aria-modal", "true");
    veil.setAttribute("aria-label", title);
    this.before = document.activeElement;
    this.current = veil;
    for (const other of this.others()) other.inert = true;
    this.root.append(veil);
    if (zoom) showForm(veil, true);
    sheet.tabIndex = -1;
    sheet.focus({ preventScroll: true });
    this.onOpen(true);
  }

  close(): void {
    if (!this.current) return;
    this.remove();
    this.onOpen(false);
  }

  private remove(): void {
    if (!this.current) return;
    showForm(this.current, false);
    this.current.remove();
    this.current = null;
    for (const other of this.others()) other.inert = false;
    if (this.before instanceof HTMLElement) this.before.focus({ preventScroll: true });
  }

  /** Everything behind the sheet, which neither keys nor screen readers reach meanwhile. */
  private others(): HTMLElement[] {
    return [...this.root.children].filter((e): e is HTMLElement => e instanceof HTMLElement);
  }
}
