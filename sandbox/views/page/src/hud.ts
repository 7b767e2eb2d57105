// Text around the scene: task, time, progress, connection, and messages to the person.

import type { Condition } from "./connection";
import { make, show, write } from "./dom";
import type { Rectangle } from "./camera";
import { SIDE, leastCovering, placesFor, rowsFor } from "./text-placement";
import { ON_TABLE } from "./palm-guard";
import { LIFT_STRIP_PX, type SceneMessage, type State, type StudyView } from "./protocol";
import { type Key, repeat, say, taskName, word } from "./words";

const TOAST_MS = 2600;
/** CSS pixels between words and buttons. */
const GAP = 8;
/** CSS pixels of the corner with the button for full screen. */
const CORNER_PX = 56;
const corner = (): Rectangle => ({
  left: document.documentElement.dir === "rtl" ? 0 : window.innerWidth - CORNER_PX,
  top: 0,
  width: CORNER_PX,
  height: CORNER_PX,
});
const around = ({ left, top, width, height }: Rectangle): Rectangle =>
  width ? { left: left - GAP, top: top - GAP, width: width + 2 * GAP, height: height + 2 * GAP } : { left, top, width, height };
/** CSS pixels below the table that a row of buttons needs, and beside it a column of them. */
const ROW_PX = 62;
const COLUMN_PX = 150;
/** CSS pixels between words above each other on a phone. */
const SLOT_GAP = 6;
/** Steps of the progress that are spoken. */
const QUARTERS = 4;
/** Keys of the notices that a finger is inside an object, and that the hand is turned too far. */
const [INSIDE, TURNED] = ["stuck", "hand_turned"];

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

/** Why time stands still, for a page whose trial has so many hands: the page of a single hand that still gets frames
 * is itself the player who was away. */
function whyPaused(pause: Exclude<State["pause"], "">, player: boolean, hands: number): Key {
  if (pause === "away" && player && hands === 1) return "go_on";
  return PAUSES[pause][player ? 0 : 1];
}

/** True if a notice helps the player now. A finger inside an object is marked at the finger. A hand whose labels are
 * in doubt only seems turned, and nobody has to turn one that is not down, or whose object is at its goal. */
function helps(key: string, { hands, reached }: State, atFinger: boolean): boolean {
  if (key === INSIDE) return !atFinger;
  if (key !== TURNED) return true;
  const contacts = hands.flatMap((hand) => hand.contacts);
  return contacts.length > 0 && contacts.every(({ sure }) => sure) && !reached;
}

export interface Wishes {
  again(): void;
  tasks(): void;
  settings(): void;
  help(): void;
  seat(): void;
}

/** What the words beside a trial depend on besides its state. */
export interface Moment {
  player: boolean;
  /** True if time stands still because this page was turned. */
  turned: boolean;
  /** True if a demonstration is shown in place of the trial. */
  demonstrated: boolean;
  /** True if a finger that is inside an object is told so beside it. */
  atFinger: boolean;
  /** s, simulated time at which the goal was held; null before. */
  heldAt: number | null;
}

/** What is to be done; in a study in the words of its design. */
const goalOf = (scene: SceneMessage, inStudy: boolean): string =>
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
  private readonly caption = make("span", "badge quiet");
  private readonly looking = make("span", "badge");
  /** Asks for the player's seat. */
  private readonly ask: HTMLButtonElement;
  readonly toast = make("div", "toast");
  /** Read aloud by screen readers. */
  private readonly voice = make("p", "voice");
  /** State of the trial that was spoken last. */
  private spoken = "";
  /** The words under the progress. */
  private written = "";
  private readonly header: HTMLElement;
  private readonly words: HTMLElement;
  private readonly score: HTMLElement;
  private readonly buttons: HTMLElement;
  private timer = 0;
  private study: StudyView | null = null;
  /** What a study's trial lacked in its last moment. */
  private missing = "";

  constructor(wishes: Wishes) {
    const button = (text: string, onTap: () => void): HTMLButtonElement =>
      make("button", "button", { text, onTap });
    this.ask = button(say("seat_ask"), () => {
      wishes.seat();
      this.ask.disabled = true;
    });
    this.buttons = make(
      "div",
      "buttons",
      {},
      button(say("again"), wishes.again),
      button(say("tasks"), wishes.tasks),
      button(say("settings"), wishes.settings),
      make("button", "button help", { text: "?", label: say("show_how"), onTap: wishes.help }),
    );
    const progress = make("div", "bar", {}, this.bar);
    this.words = make("div", "words", {}, this.task, this.goal);
    this.score = make("div", "score", {}, this.clock, progress, this.reason);
    const state = make("div", "pill", {}, this.dot, this.link);
    this.header = make("header", "top", {}, this.words, this.score);
    this.root = make(
      "div",
      "hud",
      {},
      this.header,
      // Buttons are at the edge that the hand comes from, where no task needs a finger.
      make("footer", "bottom", {}, state, this.caption, this.looking, this.ask, this.buttons),
      this.toast,
      this.voice,
    );
    for (const told of [this.toast, this.voice]) told.setAttribute("role", "status");
    show(this.toast, false);
    show(this.caption, false);
    this.setLooking("");
  }

  /** Shows buttons to a player, and none to a spectator. */
  setPlayer(player: boolean): void {
    show(this.buttons, player);
    this.root.classList.toggle("looking", !player);
  }

  /** Puts the buttons beside the touch rectangle, below it or in the margin, where there is room. On it they
   * have to be held.
   *
   * @param lift Side of the rectangle that the lift control takes; null without one.
   * @param phone True if there is room for them beside the table anyway.
   */
  stand(place: Rectangle, lift: "left" | "right" | null, phone: boolean): void {
    const end = document.documentElement.dir === "rtl" ? "left" : "right";
    const strip = lift === end ? LIFT_STRIP_PX : 0;
    const below = window.innerHeight - place.top - place.height;
    const margin = end === "left" ? place.left : window.innerWidth - place.left - place.width;
    const aside = below < ROW_PX && margin - strip >= COLUMN_PX;
    this.buttons.classList.toggle("aside", aside && !phone);
    this.buttons.classList.toggle(ON_TABLE, below < ROW_PX && !aside && !phone);
    if (phone) for (const { style } of [this.words, this.score]) style.left = style.top = "";
  }

  /** Shows who plays, if it is not the person at this page; empty shows nothing. */
  setLooking(words: string): void {
    write(this.looking, words);
    show(this.looking, words !== "");
    show(this.ask, words !== "");
    if (words === "") this.ask.disabled = false;
  }

  /** Shows only what a study's design chooses, in the participant's language. */
  setStudy(view: StudyView): void {
    this.study = view;
    this.root.classList.add(...view.shows.map((what) => `shows-${what}`));
  }

  setScene(scene: SceneMessage): void {
    write(this.task, this.study ? scene.task : taskName(scene.task));
    write(this.goal, goalOf(scene, this.study !== null));
    write(this.caption, scene.caption ? repeat(scene.caption) : "");
    show(this.caption, scene.caption !== null);
  }

  setState(state: State, limit: number, moment: Moment): void {
    const { player, turned, demonstrated, atFinger, heldAt } = moment;
    const over = state.status !== "running";
    // A success is measured until it was held; its trial goes on for a second.
    const time = (heldAt ?? state.time).toFixed(1);
    const clock = this.study ? say("seconds", { time }) : say("seconds_of", { time, limit: String(limit) });
    write(this.clock, clock);
    this.clock.classList.toggle("late", !over && limit - state.time < 5);
    this.bar.style.transform = `scaleX(${Math.min(Math.max(state.progress, 0), 1)})`;
    this.bar.classList.toggle("good", state.reached);
    this.bar.classList.toggle("done", state.held);
    this.score.classList.toggle("begun", state.time > 0);
    if (this.study) {
      this.tellInStudy(state, moment);
      return;
    }
    const reason = state.reason ? repeat(state.reason) : "";
    let words = reason;
    const within = demonstrated && state.time > 0;
    if (demonstrated) words = say(within ? "demonstration_within" : "demonstration");
    else if (turned) words = say("stands_still");
    else if (state.pause) words = say(whyPaused(state.pause, player, state.hands.length));
    else if (state.held) words = say("stayed");
    else if (state.reached) words = say("there");
    write(this.reason, words);
    this.reason.classList.toggle("example", within);
    if (words !== this.written) this.keepInside();
    this.written = words;
    this.speak(state, words, limit);
    const notice = state.notices.find(({ key }) => helps(key, state, atFinger));
    if (notice) this.say(repeat(notice));
  }

  /** Speaks the state of the trial: what it waits for, how it ends, and every quarter of the way what is missing. */
  private speak(state: State, words: string, limit: number): void {
    const quarter = Math.floor(Math.min(Math.max(state.progress, 0), 1) * QUARTERS);
    const { status, pause, reached, held } = state;
    const now = [status, pause, reached, held, quarter].join();
    if (now === this.spoken) return;
    this.spoken = now;
    const timeout = status === "timeout" ? `${say("time_up")}. ${say("limit", { time: String(limit) })}` : words;
    write(this.voice, timeout);
  }

  /** Shows neither score nor diagnostics, only what the person needs to go on, and the result of a trial if the
   * design says so. */
  private tellInStudy(state: State, { demonstrated, heldAt }: Moment): void {
    const over = state.status !== "running";
    if (!over) this.missing = state.reason ? repeat(state.reason) : "";
    const told = (): string => {
      if (over || state.held) return this.resultInStudy(state, heldAt);
      if (demonstrated) return say("demonstration");
      if (state.pause) return say(STUDY_PAUSES[state.pause]);
      return state.reached ? say("let_stay") : "";
    };
    write(this.reason, told());
    this.reason.classList.toggle("told", over || state.held);
  }

  private resultInStudy({ held, reason, status }: State, heldAt: number | null): string {
    const shown = this.study?.shows.includes("result") ?? false;
    if (held && shown && heldAt !== null) return say("done_in", { time: heldAt.toFixed(1) });
    const late = status === "timeout";
    const end = say(held ? "success" : late ? "time_up" : "over");
    // The reason of a trial that took too long may be the study's limit.
    const why = late || !reason ? this.missing : repeat(reason);
    return shown && !held && why ? `${end}\n${why}` : end;
  }

  setConnection(condition: Condition, words: string): void {
    this.dot.dataset["condition"] = condition;
    // A connection that works says nothing.
    write(this.link, condition === "open" ? "" : words);
  }

  /** Moves the words at the top away from what has to be seen.
   *
   * @param things Rectangles of objects and of goals, in CSS pixels.
   * @param left CSS pixels of the page at the left that are taken; `right` likewise.
   */
  standAside(things: Rectangle[], left: number, right: number): void {
    const { controls } = this;
    const taken = [...things, ...controls, ...controls, ...controls];
    // A study shows its progress elsewhere.
    for (const text of this.study ? [this.words] : [this.words, this.score]) {
      text.style.left = text.style.top = "0";
      const { left: x, top: y, width, height } = text.getBoundingClientRect();
      const own = { left: x, top: y, width, height };
      const edge = (row: number): number => Math.min(row, window.innerHeight - row - height);
      const rows = [y, ...rowsFor(height).sort((a, b) => edge(a) - edge(b))];
      const places = [own, ...placesFor(own, left, right, rows)];
      const place = leastCovering(places, taken);
      text.style.left = `${place.left - x}px`;
      text.style.top = `${place.top - y}px`;
      taken.push(place);
    }
  }

  /** Moves the progress up where a second line of words would be below the page. */
  private keepInside(): void {
    const below = this.score.getBoundingClientRect().bottom - (window.innerHeight - SIDE);
    if (below > 0) this.score.style.top = `${(Number.parseFloat(this.score.style.top) || 0) - below}px`;
  }

  /** The place on a phone between the words and the buttons, or the table, in CSS pixels. */
  get slot(): Rectangle {
    const { left, width, bottom } = this.header.getBoundingClientRect();
    const top = bottom + SLOT_GAP;
    const end = this.header.nextElementSibling!.getBoundingClientRect().top;
    const table = Number.parseFloat(document.documentElement.style.getPropertyValue("--table-top"));
    const height = (table > 0 ? Math.min(table, end) : end) - SLOT_GAP - top;
    if (table > 0) return { left: SIDE, top, width: window.innerWidth - 2 * SIDE, height };
    return { left, top, width, height };
  }

  /** Rectangles of the words around the table, and of its buttons. */
  get texts(): Rectangle[] {
    return [...this.controls, ...[this.words, this.score].map((text) => text.getBoundingClientRect())];
  }

  /** Rectangles of the buttons, that for full screen among them, and of the state of the connection. */
  private get controls(): Rectangle[] {
    return [corner(), ...[this.buttons, this.dot.parentElement!].map((e) => around(e.getBoundingClientRect()))];
  }

  /** CSS pixels from the top of the page to below its words and its progress. */
  get headerHeight(): number {
    return this.header.getBoundingClientRect().bottom;
  }

  /** Shows a message that disappears by itself. */
  say(text: string, ms = TOAST_MS): void {
    write(this.toast, text);
    show(this.toast, true);
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => show(this.toast, false), ms);
  }
}
