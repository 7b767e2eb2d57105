// The lift control: a tall slider under the other thumb. It keeps its position when it is released,
// so that a slipped thumb does not make the hand drop an object.

import { make } from "./dom";

const WHEEL = 0.0012;
const KEY_STEP = 0.05;

export class Lift {
  readonly root: HTMLElement;
  private readonly word = make("span", "", { text: "lift" });
  private readonly knob = make("div", "lift-knob");
  private pointer: number | null = null;
  value = 0;

  constructor(private readonly tell: (value: number) => void) {
    this.root = make("div", "lift", { label: "Lift" }, this.word, this.knob);
    this.root.hidden = true;
    this.root.addEventListener("pointerdown", (e) => {
      this.pointer ??= e.pointerId;
      this.drag(e);
    });
    window.addEventListener("pointermove", (e) => this.drag(e));
    for (const end of ["pointerup", "pointercancel"] as const)
      window.addEventListener(end, (e) => {
        if (e.pointerId === this.pointer) this.pointer = null;
      });
    // With a mouse as the only finger, the wheel and the arrow keys control the lift.
    window.addEventListener("wheel", (e) => this.set(this.value - e.deltaY * WHEEL), {
      passive: true,
    });
    window.addEventListener("keydown", (e) => {
      if (e.key === "ArrowUp") this.set(this.value + KEY_STEP);
      if (e.key === "ArrowDown") this.set(this.value - KEY_STEP);
    });
  }

  /** Begins a trial: shows the control if the task needs it, away from the playing hand. */
  open(needed: boolean, hand: "left" | "right"): void {
    this.root.hidden = !needed;
    this.root.classList.toggle("at-right", hand === "left");
    this.pointer = null;
    this.put(0);
  }

  /** Label of the control. */
  call(word: string): void {
    this.word.textContent = word;
  }

  private drag(event: PointerEvent): void {
    if (event.pointerId !== this.pointer) return;
    const box = this.root.getBoundingClientRect();
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
    this.knob.style.bottom = `${8 + value * 84}%`;
  }
}
