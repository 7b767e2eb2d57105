// Text around the scene: task, time, progress, connection, and messages to the person.

import type { Condition } from "./connection";
import { make, show, write } from "./dom";
import type { SceneMessage, State, StudyView } from "./protocol";

const TOAST_MS = 2600;

export interface Wishes {
  again(): void;
  tasks(): void;
  hand(): void;
  sound(): void;
  settings(): void;
}

export const title = (task: string): string => {
  const words = task.replace(/[-_]/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

export class Hud {
  readonly root: HTMLElement;
  private readonly task = make("h1", "task");
  private readonly goal = make("p", "goal");
  private readonly clock = make("span", "clock");
  private readonly reason = make("p", "reason");
  private readonly bar = make("div", "bar-fill");
  private readonly dot = make("span", "dot");
  private readonly link = make("span", "link");
  private readonly size: HTMLElement;
  private readonly caption = make("span", "badge quiet");
  private readonly looking = make("span", "badge");
  private readonly toast = make("div", "toast");
  private readonly end = make("div", "end");
  private readonly endWords = make("p", "end-words");
  private readonly hand: HTMLButtonElement;
  private readonly sound: HTMLButtonElement;
  private readonly buttons: HTMLElement;
  private timer = 0;
  private study: StudyView | null = null;

  constructor(wishes: Wishes) {
    const button = (text: string, onTap: () => void): HTMLButtonElement =>
      make("button", "button", { text, onTap });
    this.hand = button("Right hand", wishes.hand);
    this.sound = button("Sound on", wishes.sound);
    this.size = make("button", "badge warn", { text: "size guessed", onTap: wishes.settings });
    this.buttons = make(
      "div",
      "buttons",
      {},
      button("Again", wishes.again),
      button("Tasks", wishes.tasks),
      this.hand,
      this.sound,
    );
    this.end.append(
      this.endWords,
      make(
        "div",
        "row",
        {},
        make("button", "button large primary", { text: "Again", onTap: wishes.again }),
        make("button", "button large", { text: "Other task", onTap: wishes.tasks }),
      ),
    );
    const progress = make("div", "bar", {}, this.bar);
    const words = make("div", "words", {}, this.task, this.goal);
    const score = make("div", "score", {}, this.clock, progress, this.reason);
    const state = make("div", "pill", {}, this.dot, this.link);
    this.root = make(
      "div",
      "hud",
      {},
      make("header", "top", {}, words, score),
      // Buttons are at the edge that the hand comes from, where no task needs a finger.
      make("footer", "bottom", {}, state, this.size, this.caption, this.looking, this.buttons),
      this.toast,
      this.end,
    );
    show(this.toast, false);
    show(this.end, false);
    show(this.caption, false);
    show(this.size, false);
    this.setLooking("");
  }

  /** Shows buttons to a player, and none to a spectator. */
  setPlayer(player: boolean): void {
    show(this.buttons, player);
    this.root.classList.toggle("looking", !player);
  }

  /** Shows who plays, if it is not the person at this page; empty shows nothing. */
  setLooking(words: string): void {
    write(this.looking, words);
    show(this.looking, words !== "");
  }

  /** Shows only what a study's design chooses, in the participant's language. */
  setStudy(view: StudyView): void {
    this.study = view;
    this.root.classList.add(...view.shows.map((what) => `shows-${what}`));
  }

  setScene(scene: SceneMessage): void {
    write(this.task, this.study ? scene.task : title(scene.task));
    write(this.goal, scene.goal);
    write(this.hand, scene.hand === "right" ? "Right hand" : "Left hand");
    write(this.caption, scene.caption);
    show(this.caption, scene.caption !== "");
    show(this.end, false);
  }

  setState(state: State, limit: number, player: boolean): void {
    const over = state.status !== "running";
    const waiting = state.paused && state.time === 0;
    write(this.clock, `${state.time.toFixed(1)} s`);
    this.clock.classList.toggle("late", !over && limit - state.time < 5);
    this.bar.style.transform = `scaleX(${Math.min(Math.max(state.progress, 0), 1)})`;
    this.bar.classList.toggle("good", state.reached);
    this.bar.classList.toggle("done", state.held);
    let words = state.reason;
    if (waiting) words = "Time starts with your first touch";
    else if (state.paused) words = "Paused";
    else if (state.held) words = "Done: it stayed there";
    else if (state.reached) words = "There! Let it stay";
    if (this.study) {
      this.tellInStudy(state, this.study.words);
      return;
    }
    write(this.reason, words);
    if (state.notice) this.say(state.notice);
    if (over && player) {
      write(
        this.endWords,
        state.held
          ? `Done in ${state.time.toFixed(1)} s`
          : state.status === "timeout"
            ? "Time is up"
            : `Over: ${state.reason || state.status}`,
      );
      this.end.classList.toggle("success", state.held);
    }
    show(this.end, over && player);
  }

  /** Shows neither score nor diagnostics, only what the person needs to go on. */
  private tellInStudy(state: State, words: Record<string, string>): void {
    const over = state.status !== "running";
    const end = state.held ? "success" : state.status === "timeout" ? "time_up" : "over";
    const now = state.paused ? "first_touch" : state.reached ? "let_stay" : "";
    write(this.reason, words[over || state.held ? end : now] ?? "");
    this.reason.classList.toggle("told", over || state.held);
  }

  setConnection(condition: Condition, words: string): void {
    this.dot.dataset["condition"] = condition;
    write(this.link, words);
  }

  setRoundTrip(ms: number): void {
    write(this.link, `${ms < 10 ? ms.toFixed(1) : ms.toFixed(0)} ms`);
  }

  setSound(muted: boolean): void {
    write(this.sound, muted ? "Sound off" : "Sound on");
  }

  setGuessed(guessed: boolean): void {
    show(this.size, guessed);
  }

  /** Shows a message that disappears by itself. */
  say(text: string): void {
    write(this.toast, text);
    show(this.toast, true);
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => show(this.toast, false), TOAST_MS);
  }
}
