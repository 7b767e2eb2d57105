// A hint in three or four steps for a new player; each step disappears once it is done. After the first
// success, or when it is closed, the hint is not shown again.

import { make, write } from "./dom";
import type { Rectangle } from "./lens";
import { recall, remember } from "./memory";
import type { State } from "./protocol";
import { touchable } from "./screen";
import { say } from "./words";

/** CSS pixels that a finger has to slide to complete the step. */
const FAR = 60;
/** CSS pixels above and below the hint that the words at the top and the buttons at the bottom need, and
 * at its sides. */
const HEADER = 118;
const FOOTER = 66;
const SIDE = 14;
/** Position of the lift control that completes its step. */
const LIFTED = 0.2;

export class Hint {
  readonly root: HTMLElement;
  private step = 0;
  private readonly words = make("p", "hint-words");
  private readonly dots = [0, 1, 2, 3].map(() => make("span", "hint-dot"));
  private readonly picture = make("div", "hint-picture");
  private start: { x: number; y: number } | null = null;
  private goal = "";
  private lifts = false;
  private mouse = !touchable || matchMedia("(pointer: fine)").matches;

  constructor() {
    for (let i = 0; i < 3; i++) this.picture.append(make("i", ""));
    const close = make("button", "button", { text: say("hint_close"), onTap: () => this.finish() });
    const dots = make("div", "hint-dots", {}, ...this.dots);
    this.words.setAttribute("role", "status");
    this.root = make("aside", "hint", {}, this.picture, make("div", "", {}, this.words, dots), close);
    this.root.hidden = true;
  }

  /** A trial begins.
   *
   * @param lifts True if the task needs the lift control.
   */
  open(goal: string, lifts: boolean): void {
    this.goal = goal;
    this.lifts = lifts;
    this.dots[3]!.hidden = !lifts;
    this.step = Math.min(this.step, this.last);
    this.root.hidden = recall("hint") === "done";
    this.go(this.step);
  }

  /** Updates the step from the fingers and the trial's state. */
  follow(fingers: { x: number; y: number; mouse: boolean }[], lift: number, state: State): void {
    if (this.root.hidden) return;
    if (this.lifts && this.step === 2 && lift > LIFTED) this.go(3);
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

  /** Stands where it covers least of what has to be touched: at the top if there is room, as the hand comes
   * from below.
   *
   * @param things Rectangles of what has to be touched.
   * @param left CSS pixels of the page at the left that are taken, as by the lift control; `right` likewise.
   */
  stand(things: Rectangle[], left: number, right: number): void {
    if (this.root.hidden) return;
    this.root.style.maxWidth = `${window.innerWidth - left - right - 2 * SIDE}px`;
    const { offsetWidth: width, offsetHeight: height } = this.root;
    const [first, last] = [left + SIDE, window.innerWidth - right - width - SIDE];
    const middle = Math.min(Math.max((window.innerWidth - width) / 2, first), Math.max(last, first));
    const [high, low] = [HEADER, window.innerHeight - FOOTER - height];
    const places = [high, low, (high + low) / 2].flatMap((y) =>
      [middle, first, last].map((x) => ({ left: x, top: y, width, height })),
    );
    const covered = places.map((place) => things.reduce((sum, t) => sum + common(place, t), 0));
    const { left: x, top } = places[covered.indexOf(Math.min(...covered))]!;
    this.root.style.left = `${x}px`;
    this.root.style.top = `${top}px`;
  }

  private get last(): number {
    return this.lifts ? 3 : 2;
  }

  private go(step: number): void {
    this.step = step;
    const goal = { goal: this.goal };
    const words = this.mouse
      ? [say("hint_press"), say("hint_drag"), say("hint_wheel"), say("hint_release", goal)]
      : [say("hint_touch"), say("hint_slide"), say("hint_knob"), say("hint_lift_fingers", goal)];
    if (!this.lifts) words.splice(2, 1);
    write(this.words, words[step] ?? "");
    this.picture.dataset["step"] = step === 2 && this.lifts ? "lift" : String(Math.min(step, 2));
    this.dots.forEach((dot, i) => dot.classList.toggle("on", i <= step));
  }

  private finish(): void {
    remember("hint", "done");
    this.root.hidden = true;
  }
}

/** Area that two rectangles share. */
function common(a: Rectangle, b: Rectangle): number {
  const wide = Math.min(a.left + a.width, b.left + b.width) - Math.max(a.left, b.left);
  const high = Math.min(a.top + a.height, b.top + b.height) - Math.max(a.top, b.top);
  return Math.max(wide, 0) * Math.max(high, 0);
}
