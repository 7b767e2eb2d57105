// The card after a trial: how it went, and what to do next.

import { make, show, write } from "./dom";
import type { State } from "./protocol";
import { best, following, note } from "./records";
import { repeat, say } from "./words";

/** Progress from which a failure is called a near one. */
const NEAR = 0.8;

export interface ResultWishes {
  again(): void;
  tasks(): void;
  play(task: string): void;
  replay(): void;
  help(): void;
  measure(): void;
}

/** The trial that the card is about. */
export interface Played {
  task: string;
  /** s */
  limit: number;
  scored: boolean;
  /** False if somebody else played, such as a simulated user: nothing is noted on this device. */
  own: boolean;
  /** True if objects have their true size only if a guess is right. */
  sizeGuessed: boolean;
  /** Names of the tasks on the menu. */
  tasks: readonly string[];
}

export class Result {
  readonly root = make("div", "end");
  private readonly words = make("p", "end-words");
  private readonly detail = make("p", "end-detail");
  private readonly next: HTMLButtonElement;
  private readonly again: HTMLButtonElement;
  private readonly replay: HTMLButtonElement;
  private readonly help: HTMLButtonElement;
  /** Offers to measure the screen, after a success on one whose size is a guess. */
  private readonly card: HTMLElement;
  private following: string | null = null;
  /** How the trial ended that the card shows; empty while it shows none. */
  private ended = "";

  constructor(wishes: ResultWishes) {
    const button = (text: string, onTap: () => void): HTMLButtonElement =>
      make("button", "button large", { text, onTap });
    this.next = button("", () => this.following && wishes.play(this.following));
    this.again = button(say("again"), wishes.again);
    this.replay = button(say("replay"), wishes.replay);
    this.card = make("button", "quiet-line", { text: say("measure_offer"), onTap: wishes.measure });
    this.help = button(say("show_how"), wishes.help);
    const others = [this.again, this.replay, this.help, button(say("other_task"), wishes.tasks)];
    this.root.append(this.words, this.detail, make("div", "row", {}, this.next, ...others), this.card);
    this.root.setAttribute("role", "status");
    this.close();
  }

  close(): void {
    this.ended = "";
    show(this.root, false);
  }

  /** Shows how a trial ended.
   *
   * @param time s until the goal was held, or until the trial ended.
   */
  open(state: State, time: number, played: Played): void {
    show(this.root, true);
    const { held, status } = state;
    if (this.ended === status) return;
    this.ended = status;
    this.root.classList.toggle("success", held);
    if (held) this.praise(time, played);
    else this.explain(state, played);
    this.following = held ? following(played.tasks, played.task) : null;
    if (this.following) write(this.next, say("next_task", { task: this.following }));
    show(this.next, this.following !== null);
    show(this.replay, held);
    show(this.help, !held);
    this.next.classList.toggle("primary", held);
    this.again.classList.toggle("primary", this.following === null);
    show(this.card, held && played.sizeGuessed);
  }

  private praise(time: number, { task, scored, own }: Played): void {
    const before = own ? best(task, scored) : null;
    if (own) note(task, scored, time);
    write(this.words, say("done_in", { time: time.toFixed(1) }));
    const details = [];
    if (before !== null)
      details.push(time < before ? say("best_now") : say("best_time", { time: before.toFixed(1) }));
    if (!scored) details.push(say("does_not_count"));
    this.describe(details);
  }

  private explain({ status, progress, reason }: State, { limit }: Played): void {
    const missing = reason ? repeat(reason) : "";
    if (status !== "timeout") {
      write(this.words, missing ? say("over_because", { reason: missing }) : say("over_plain"));
      this.describe([]);
      return;
    }
    write(this.words, say("time_up"));
    const near = progress >= NEAR ? say("almost", { reason: missing }) : missing;
    this.describe([missing && near, say("limit", { time: String(limit) })]);
  }

  private describe(details: string[]): void {
    write(this.detail, details.filter(Boolean).join("\n"));
    show(this.detail, this.detail.textContent !== "");
  }
}
