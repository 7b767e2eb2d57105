// The lift control: a tall slider under the other thumb, beside the touch rectangle. It keeps its
// position when it is released, so that a slipped thumb does not make the hand drop an object.

import { claim, make, write } from "./dom";
import type { Rectangle } from "./camera";
import { recallHere, rememberHere } from "./storage";
import { LIFT_KEY, LIFT_NOTCH, LIFT_PAGE, LIFT_STRIP_PX, NOTCH_PX } from "./protocol";
import { say } from "./words";

/** Change of the control by each key; with a mouse as the only finger, one hand is at the keys. */
const KEYS: Record<string, number> = {
  ArrowUp: LIFT_KEY,
  ArrowDown: -LIFT_KEY,
  PageUp: LIFT_PAGE,
  PageDown: -LIFT_PAGE,
};
const KEPT = "lift";

/** True for a wheel or a key that belongs to a menu, a form or a field. */
export const elsewhere = ({ target }: Event): boolean =>
  document.querySelector(".veil, .study:not([hidden])") !== null ||
  (target instanceof Element && target.closest("input, textarea, select") !== null);

export class Lift {
  readonly root: HTMLElement;
  private readonly track: HTMLElement;
  private readonly word = make("span", "", { text: say("lift") });
  private readonly knob = make("div", "lift-knob");
  private pointer: number | null = null;
  /** Name of the trial that the value belongs to. */
  private trial = "";
  value = 0;
  /** Side of the touch rectangle on which it stands: away from the playing hand. */
  side: "left" | "right" = "left";

  /** True while the knob is that of a demonstration. */
  private demonstrated = false;

  /** m, height of the hand with the knob at the top. */
  private height = 0;

  /** @param taken True while the wheel belongs to a hand of the mouse. */
  constructor(
    private readonly tell: (value: number) => void,
    private readonly taken: () => boolean,
  ) {
    this.track = make("div", "lift", { label: say("lift") }, this.word, this.knob);
    this.track.tabIndex = 0;
    this.track.setAttribute("role", "slider");
    this.track.setAttribute("aria-orientation", "vertical");
    this.track.setAttribute("aria-valuemin", "0");
    this.track.setAttribute("aria-valuemax", "100");
    this.root = make("div", "lift-strip", {}, this.track);
    this.root.hidden = true;
    claim(this.root);
    this.put(0);
    this.track.addEventListener("pointerdown", (e) => {
      this.pointer ??= e.pointerId;
      this.drag(e);
    });
    window.addEventListener("pointermove", (e) => this.drag(e));
    // As early as moves of the fingers, so that both go into one message.
    window.addEventListener("pointerrawupdate", (e) => {
      if (e instanceof PointerEvent) this.drag(e);
    });
    for (const end of ["pointerup", "pointercancel"] as const)
      window.addEventListener(end, (e) => {
        if (e.pointerId === this.pointer) this.pointer = null;
      });
    const perPixel = LIFT_NOTCH / NOTCH_PX;
    const turn = (e: WheelEvent): void => {
      // With ctrl it zooms the page; a pinch on a trackpad comes as that, too.
      if (!e.ctrlKey && !elsewhere(e) && !this.taken()) this.set(this.value - e.deltaY * perPixel);
    };
    window.addEventListener("wheel", turn, { passive: true });
    window.addEventListener("keydown", (e) => {
      if (this.root.hidden || !(e.key in KEYS) || elsewhere(e)) return;
      e.preventDefault();
      this.set(this.value + KEYS[e.key]!);
    });
  }

  /** Shows the control if the task needs it.
   *
   * @param height m, to which it lifts the hand; 0 if the task has none.
   * @param trial Name of the trial; the control stays where it is for the same one, also after a
   * reload.
   */
  open(needed: boolean, height: number, hand: "left" | "right", trial: string): void {
    this.root.hidden = !needed;
    this.height = height;
    this.side = hand === "right" ? "left" : "right";
    if (trial === this.trial) return;
    const [name, value] = (recallHere(KEPT) ?? "").split("=");
    this.trial = trial;
    this.pointer = null;
    this.put(name === trial && Number(value) <= 1 ? Math.max(Number(value), 0) : 0);
  }

  /** Stores the position for the page that comes after a reload. */
  keep(): void {
    rememberHere(KEPT, `${this.trial}=${this.value}`);
  }

  /** Stands beside the touch rectangle. */
  stand(surface: Rectangle): void {
    const left = this.side === "left" ? surface.left - LIFT_STRIP_PX : surface.left + surface.width;
    this.root.style.left = `${left}px`;
    this.root.style.width = `${LIFT_STRIP_PX}px`;
  }

  /** Writes the label anew, in a language that has come later. */
  relabel(): void {
    this.word.textContent = say("lift");
    this.track.setAttribute("aria-label", say("lift"));
  }

  private drag(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    const box = this.track.getBoundingClientRect();
    const edge = box.height * 0.08;
    this.set(1 - (event.clientY - box.top - edge) / (box.height - 2 * edge));
  }

  private set(value: number): void {
    if (this.root.hidden) return;
    const before = this.value;
    this.put(Math.min(Math.max(value, 0), 1));
    if (this.value !== before) this.tell(this.value);
  }

  private put(value: number): void {
    this.value = value;
    this.draw(value);
    this.track.setAttribute("aria-valuetext", this.knob.textContent ?? "");
    this.track.setAttribute("aria-valuenow", String(Math.round(100 * value)));
  }

  private draw(value: number): void {
    this.knob.style.bottom = `${8 + value * 84}%`;
    write(this.knob, say("lift_height", { mm: (1000 * value * this.height).toFixed(0) }));
  }

  /** Draws the knob where a demonstration has it, and afterwards where it is.
   *
   * @param height m, of the hand in the demonstration; null while none is shown.
   */
  demonstrate(height: number | null): void {
    const shown = height !== null && !this.root.hidden;
    if (shown) this.draw(Math.min(Math.max(height / this.height, 0), 1));
    else if (this.demonstrated) this.draw(this.value);
    this.demonstrated = shown;
  }
}
