// Text around the scene: task, time, progress, connection, and messages to the person.

import type { Condition } from "./connection";
import { make, show, write } from "./dom";
import type { SceneMessage, State, StudyView } from "./protocol";
import { type Key, repeat, say, taskName, word } from "./words";

const TOAST_MS = 2600;
/** ms for which the delay of the last touch stays in view. */
const DELAY_SHOWN_MS = 3000;
/** Key of the notice that a finger is inside an object. */
const INSIDE: Key = "stuck";
const digits = (ms: number): string => (ms < 10 ? ms.toFixed(1) : ms.toFixed(0));

/** Why time stands still, for a player and for a spectator. */
const PAUSES: Record<Exclude<State["pause"], "">, [Key, Key]> = {
  start: ["first_touch", "starts_with_touch"],
  menu: ["paused", "paused"],
  away: ["other_player_away", "player_away"],
  back: ["go_on", "player_back"],
};
/** The same in a study. */
const STUDY_PAUSES: Record<Exclude<State["pause"], "">, Key> = {
  start: "first_touch",
  menu: "paused",
  away: "go_on",
  back: "go_on",
};

export interface Wishes {
  again(): void;
  tasks(): void;
  hand(): void;
  sound(): void;
  settings(): void;
}

/** What is to be done; in a study in the words of its design. */
export const goalOf = (scene: SceneMessage, inStudy: boolean): string =>
  inStudy ? scene.goal : word(`goal_${scene.task}`, scene.goal);

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
  readonly toast = make("div", "toast");
  readonly end = make("div", "end");
  private readonly endWords = make("p", "end-words");
  private readonly hand: HTMLButtonElement;
  private readonly sound: HTMLButtonElement;
  private readonly buttons: HTMLElement;
  private timer = 0;
  /** ms, time at which a touch's delay was shown last. */
  private delayed = -Infinity;
  private study: StudyView | null = null;
  private scored = true;

  constructor(wishes: Wishes) {
    const button = (text: string, onTap: () => void): HTMLButtonElement =>
      make("button", "button", { text, onTap });
    this.hand = button(say("right_hand"), wishes.hand);
    this.sound = button(say("sound_on"), wishes.sound);
    this.size = make("button", "badge warn", { onTap: wishes.settings });
    this.buttons = make(
      "div",
      "buttons",
      {},
      button(say("again"), wishes.again),
      button(say("tasks"), wishes.tasks),
      this.hand,
      this.sound,
    );
    this.end.append(
      this.endWords,
      make(
        "div",
        "row",
        {},
        make("button", "button large primary", { text: say("again"), onTap: wishes.again }),
        make("button", "button large", { text: say("other_task"), onTap: wishes.tasks }),
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
    for (const told of [this.toast, this.end]) told.setAttribute("role", "status");
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
    write(this.task, this.study ? scene.task : taskName(scene.task));
    write(this.goal, goalOf(scene, this.study !== null));
    write(this.hand, say(scene.hand === "right" ? "right_hand" : "left_hand"));
    write(this.caption, scene.caption ? repeat(scene.caption) : "");
    show(this.caption, scene.caption !== null);
    this.scored = scene.scored ?? true;
    show(this.end, false);
  }

  /**
   * @param turned True if time stands still because this page was turned.
   * @param atFinger True if a finger that is inside an object is told so beside it.
   */
  setState(state: State, limit: number, player: boolean, turned: boolean, atFinger: boolean): void {
    const over = state.status !== "running";
    write(this.clock, say("seconds", { time: state.time.toFixed(1) }));
    this.clock.classList.toggle("late", !over && limit - state.time < 5);
    this.bar.style.transform = `scaleX(${Math.min(Math.max(state.progress, 0), 1)})`;
    this.bar.classList.toggle("good", state.reached);
    this.bar.classList.toggle("done", state.held);
    if (this.study) {
      this.tellInStudy(state);
      return;
    }
    const reason = state.reason ? repeat(state.reason) : "";
    let words = reason;
    if (turned) words = say("stands_still");
    else if (state.pause) words = say(PAUSES[state.pause][player ? 0 : 1]);
    else if (state.held) words = say("stayed");
    else if (state.reached) words = say("there");
    write(this.reason, words);
    const notice = state.notices.find(({ key }) => !(atFinger && key === INSIDE));
    if (notice) this.say(repeat(notice));
    if (over && player) {
      const because = reason ? say("over_because", { reason }) : say("over_plain");
      const time = state.time.toFixed(1);
      write(
        this.endWords,
        state.held
          ? say(this.scored ? "done_in" : "done_unscored", { time })
          : state.status === "timeout"
            ? say("time_up")
            : because,
      );
      this.end.classList.toggle("success", state.held);
    }
    show(this.end, over && player);
  }

  /** Shows neither score nor diagnostics, only what the person needs to go on. */
  private tellInStudy(state: State): void {
    const over = state.status !== "running";
    const end: Key = state.held ? "success" : state.status === "timeout" ? "time_up" : "over";
    const let_stay: Key | null = state.reached ? "let_stay" : null;
    const now = state.pause ? STUDY_PAUSES[state.pause] : let_stay;
    const told = over || state.held ? end : now;
    write(this.reason, told ? say(told) : "");
    this.reason.classList.toggle("told", over || state.held);
  }

  setConnection(condition: Condition, words: string): void {
    this.dot.dataset["condition"] = condition;
    write(this.link, words);
  }

  /** Shows the time from a touch to the first picture that contains it, at a time in ms. */
  setDelay(ms: number, at: number): void {
    this.delayed = at;
    write(this.link, say("milliseconds", { time: digits(ms) }));
  }

  /** Shows the time to the computer and back while there are no touches whose delay could be shown. */
  setRoundTrip(ms: number, at: number): void {
    if (at - this.delayed > DELAY_SHOWN_MS) write(this.link, say("link_delay", { time: digits(ms) }));
  }

  setSound(muted: boolean): void {
    write(this.sound, say(muted ? "sound_off" : "sound_on"));
  }

  /** Shows what is to be known about the table's size; empty shows nothing. */
  setSize(words: string): void {
    write(this.size, words);
    show(this.size, words !== "");
  }

  /** Shows a message that disappears by itself. */
  say(text: string): void {
    write(this.toast, text);
    show(this.toast, true);
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => show(this.toast, false), TOAST_MS);
  }
}
