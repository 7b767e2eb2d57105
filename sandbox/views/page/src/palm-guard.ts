// Buttons under a hand that plays: a palm presses none, and a button that lies on the table has to be held
// while a trial runs.

import { pxPerInch } from "./screen";

/** ms for which a button on the table has to be held. */
const HOLD_MS = 400;
/** In inches (15 mm), longer side from which a contact on a button is a palm. A thumb that presses a button has
 * about 13 mm. */
const PALM = 0.59;
/** Class of what holds buttons that lie on the table. */
export const ON_TABLE = "on-table";

export interface Host {
  /** A palm was on a button. */
  palm(): void;
  /** A button on the table was only tapped. */
  short(): void;
  /** True if buttons on the table have to be held now. */
  needsHold(): boolean;
}

interface Press {
  pointer: number;
  button: HTMLElement;
  palm: boolean;
  /** True if it is pressed by holding it, and `tapped` if it is by a tap. */
  held: boolean;
  tapped: boolean;
  /** True once a hold has pressed the button. */
  done: boolean;
}

export class Presses {
  /** The newest touch that began on a button. */
  private press: Press | null = null;
  private timer = 0;

  constructor(private readonly host: Host) {
    const capture = { capture: true };
    document.addEventListener("pointerdown", (e) => this.begin(e), capture);
    document.addEventListener("pointermove", (e) => this.follow(e), capture);
    for (const end of ["pointerup", "pointercancel"] as const)
      document.addEventListener(end, (e) => this.end(e), capture);
    document.addEventListener("click", (e) => this.judge(e), capture);
  }

  /** Ends a hold, as when a finger plays. */
  release(): void {
    window.clearTimeout(this.timer);
    this.press?.button.classList.remove("holding");
  }

  private begin(event: PointerEvent): void {
    this.release();
    const button = event.target instanceof Element ? event.target.closest("button") : null;
    this.press = null;
    if (!button || event.pointerType !== "touch") return;
    const held = button.closest(`.${ON_TABLE}`) !== null;
    const tapped = !held || !this.host.needsHold();
    const press = { pointer: event.pointerId, button, palm: false, held, tapped, done: false };
    this.press = press;
    this.follow(event);
    if (!held) return;
    button.classList.add("holding");
    this.timer = window.setTimeout(() => {
      this.release();
      press.done = true;
      if (!press.palm && button.isConnected) button.click();
    }, HOLD_MS);
  }

  /** A palm may begin as small as a fingertip. */
  private follow(event: PointerEvent): void {
    const { press } = this;
    if (press?.pointer !== event.pointerId) return;
    press.palm ||= Math.max(event.width, event.height) > PALM * pxPerInch();
    if (press.palm) this.release();
  }

  private end(event: PointerEvent): void {
    const { press } = this;
    if (press?.pointer !== event.pointerId) return;
    this.release();
    if (event.type !== "pointerup" || press.done) return;
    if (press.palm) this.host.palm();
    else if (!press.tapped) this.host.short();
  }

  /** Stops the click that a browser makes of a touch. Clicks of a mouse, of keys, and of a hold go on. */
  private judge(event: MouseEvent): void {
    const { press } = this;
    const byTouch = event.isTrusted && event.detail !== 0 && press?.button.contains(event.target as Node);
    if (!byTouch || !press || !(press.palm || press.done || !press.tapped)) return;
    event.stopPropagation();
    event.preventDefault();
  }
}
