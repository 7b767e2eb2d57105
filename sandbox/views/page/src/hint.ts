// How a task is done, in words, for somebody who has not done it yet; behind "?" for everybody.

import { make, show, write } from "./dom";
import type { Rectangle } from "./camera";
import { recall, remember } from "./storage";
import { SIDE, leastCovering, placesFor, rowsFor } from "./text-placement";
import type { SceneMessage, State } from "./protocol";
import { done } from "./records";
import { touchable } from "./screen";
import { type Key, say, word } from "./words";

const LIFT_KEYS: Key = "keys_lift";
/** What a mouse can do, for somebody who begins, and for somebody who asks. */
const FIRST_KEYS: Key[] = ["keys_hand", "keys_move", LIFT_KEYS];
const ALL_KEYS: Key[] = ["keys_hand", "keys_move", "keys_wheel", "keys_pin", "keys_all", LIFT_KEYS, "keys_space"];

/** Progress from which the player has found out how. */
const FOUND_OUT = 0.3;
/** CSS pixels, widths of which the hint takes a smaller one only to cover less. */
const WIDTHS = [1000, 420, 300] as const;

/** Key in the page's storage for a task whose hint was closed. */
const closed = (task: string): string => `hint-closed:${task}`;

export class Hint {
  readonly root: HTMLElement;
  private readonly how = make("p", "");
  /** What mouse and keys do. */
  private readonly keys = make("ul", "hint-keys");
  private readonly words = make("div", "hint-words", {}, this.how, this.keys);
  private readonly mouse = !touchable || matchMedia("(pointer: fine)").matches;
  /** True if the player asked for it, who then closes it. */
  asked = false;
  private task = "";
  /** True if the task needs the lift control. */
  private lifts = false;

  constructor() {
    const close = make("button", "button", { text: say("hint_close"), onTap: () => this.finish() });
    this.words.setAttribute("role", "status");
    this.root = make("aside", "hint", {}, this.words, close);
    this.root.hidden = true;
  }

  /** A trial begins: its words are shown unless its player has done the task, or has closed its hint before. In
   * a study they are shown in every trial if its design says so. */
  begin(scene: SceneMessage, lifts: boolean, inStudy: boolean): void {
    this.task = scene.task;
    const known = recall(closed(scene.task)) === "yes" || done(scene.task) !== null;
    this.root.hidden = inStudy ? !scene.how : known;
    this.asked = false;
    this.lifts = lifts;
    const both = word(`how_${scene.task}`, say("how_any"));
    const how = scene.shared ? word(`how_${scene.task}_shared`, both) : both;
    write(this.how, inStudy ? (scene.how ?? "") : how);
    this.list(inStudy || !this.mouse ? [] : FIRST_KEYS);
  }

  /** Shows it, as the player asked for it: with all that mouse and keys do. */
  open(): void {
    this.root.hidden = false;
    this.asked = true;
    if (this.mouse) this.list(ALL_KEYS);
  }

  /** Hides it once the player has found out, and after the trial, where the result is shown instead. */
  follow(state: State): void {
    const found = !this.asked && state.progress > FOUND_OUT && !state.pause;
    if (found || state.held || state.status !== "running") this.root.hidden = true;
  }

  /** Stands where it covers least of what has to be touched: at the top if there is room, as the hand comes
   * from below.
   *
   * @param things Rectangles of what has to be touched or read.
   * @param left CSS pixels of the page at the left that are taken, as by the lift control; `right` likewise.
   */
  stand(things: Rectangle[], left: number, right: number): void {
    if (this.root.hidden) return;
    const { style } = this.root;
    style.maxHeight = "";
    const room = window.innerWidth - left - right - 2 * SIDE;
    const places = WIDTHS.map((most) => {
      style.maxWidth = `${Math.min(most, room)}px`;
      const { offsetWidth: width, offsetHeight: height } = this.root;
      return leastCovering(placesFor({ width, height }, left, right, rowsFor(height)), things);
    });
    const place = leastCovering(places, things);
    style.maxWidth = `${place.width}px`;
    style.left = `${place.left}px`;
    style.top = `${place.top}px`;
  }

  /** Stands in a place that is free for it, as on a phone. */
  standIn({ left, top, width, height }: Rectangle): void {
    const { style } = this.root;
    style.maxWidth = `${width}px`;
    style.maxHeight = `${height}px`;
    style.left = `${left}px`;
    style.top = `${top}px`;
  }

  private list(keys: readonly Key[]): void {
    const shown = keys.filter((key) => key !== LIFT_KEYS || this.lifts);
    this.keys.replaceChildren(...shown.map((key) => make("li", "", { text: say(key) })));
    show(this.keys, shown.length > 0);
  }

  /** Hides it; in this task it is not shown unasked again. */
  finish(): void {
    remember(closed(this.task), "yes");
    this.hide();
  }

  hide(): void {
    this.root.hidden = true;
    this.asked = false;
  }
}
