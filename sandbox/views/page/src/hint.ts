// A hint in three steps for a new player; each step disappears once it is done. After the first
// success, or when it is closed, the hint is not shown again.

import { make, write } from "./dom";
import { recall, remember } from "./memory";
import type { State } from "./protocol";
import { touchable } from "./screen";

/** CSS pixels that a finger has to slide to complete the step. */
const FAR = 60;

export class Hint {
  readonly root: HTMLElement;
  private step = 0;
  private readonly words = make("p", "hint-words");
  private readonly dots = [0, 1, 2].map(() => make("span", "hint-dot"));
  private readonly picture = make("div", "hint-picture");
  private start: { x: number; y: number } | null = null;
  private goal = "";
  private mouse = !touchable || matchMedia("(pointer: fine)").matches;

  constructor() {
    for (let i = 0; i < 3; i++) this.picture.append(make("i", ""));
    const close = make("button", "button", { text: "Got it", onTap: () => this.finish() });
    const dots = make("div", "hint-dots", {}, ...this.dots);
    this.root = make("aside", "hint", {}, this.picture, make("div", "", {}, this.words, dots), close);
    this.root.hidden = true;
  }

  /** A trial begins. */
  open(goal: string): void {
    this.goal = goal;
    this.root.hidden = recall("hint") === "done";
    this.go(this.step);
  }

  /** Updates the step from the fingers and the trial's state. */
  follow(fingers: { x: number; y: number; mouse: boolean }[], state: State): void {
    if (this.root.hidden) return;
    if (state.held) this.finish();
    // After a trial the result is shown instead; the hint comes back with the next trial.
    if (state.status !== "running") this.root.hidden = true;
    const first = fingers[0];
    if (!first) {
      this.start = null;
      return;
    }
    this.start ??= { x: first.x, y: first.y };
    this.mouse ||= first.mouse;
    if (this.step === 0 && (fingers.length > 1 || first.mouse)) this.go(1);
    const far = Math.hypot(first.x - this.start.x, first.y - this.start.y);
    if (this.step === 1 && far > FAR) this.go(2);
  }

  private go(step: number): void {
    this.step = step;
    const words = this.mouse
      ? [
          "Press the left button beside the box: that is one finger.",
          "Drag it. The hand goes along, and what stands in its way is pushed.",
          this.goal + " Then let go.",
        ]
      : [
          "Put two or three fingertips on the glass, beside the box. A hand comes.",
          "Slide them. The hand goes along, and what stands in its way is pushed.",
          this.goal + " Then lift your fingers.",
        ];
    write(this.words, words[step] ?? "");
    this.picture.dataset["step"] = String(step);
    this.dots.forEach((dot, i) => dot.classList.toggle("on", i <= step));
  }

  private finish(): void {
    remember("hint", "done");
    this.root.hidden = true;
  }
}
