// A sheet over the scene, with a menu or a question. One at a time; the trial is paused.

import { make } from "./dom";

export class Sheets {
  private current: HTMLElement | null = null;

  constructor(
    private readonly root: HTMLElement,
    private readonly onOpen: (open: boolean) => void,
  ) {}

  get isOpen(): boolean {
    return this.current !== null;
  }

  open(title: string, content: HTMLElement[], closing = "Close", onClose?: () => void): void {
    this.current?.remove();
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
    veil.setAttribute("aria-label", title);
    this.current = veil;
    this.root.append(veil);
    this.onOpen(true);
  }

  close(): void {
    if (!this.current) return;
    this.current.remove();
    this.current = null;
    this.onOpen(false);
  }
}
