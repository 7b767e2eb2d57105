// "Again" while a trial runs: time stands still for a moment, in which a finger on the table undoes it.

import { make, show } from "./dom";
import { say } from "./words";

/** ms for which it can be undone. */
const UNDO_MS = 2500;

export interface AnewWishes {
  pause(): void;
  resume(): void;
  retry(): void;
}

export class Anew {
  readonly root: HTMLElement;
  private timer = 0;

  constructor(private readonly wishes: AnewWishes) {
    this.root = make("div", "anew", {}, make("p", "", { text: say("starting_again") }), make("i", "anew-left"));
    this.root.setAttribute("role", "alert");
    show(this.root, false);
  }

  /** Starts again: a trial that runs after a moment, or at once if it was asked before.
   *
   * @param running False if there is nothing to lose.
   */
  ask(running: boolean): void {
    const again = !this.root.hidden;
    this.stop();
    if (!running || again) {
      this.wishes.retry();
      return;
    }
    show(this.root, true);
    this.wishes.pause();
    this.timer = window.setTimeout(() => this.ask(true), UNDO_MS);
  }

  /** Goes on with the trial that runs. */
  undo(): void {
    if (this.root.hidden) return;
    this.stop();
    this.wishes.resume();
  }

  /** Another trial has begun. */
  stop(): void {
    window.clearTimeout(this.timer);
    show(this.root, false);
  }
}
