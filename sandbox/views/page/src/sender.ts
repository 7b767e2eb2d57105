// Sends touches: every change, and a message ten times a second while fingers are down, since the
// touches of a silent page are cancelled.

import type { Connection } from "./connection";
import type { Change, Finger } from "./fingers";

const REPEAT_MS = 100;
const REMEMBERED = 240;

export class Sender {
  private seq = 0;
  private last = 0;
  private fingers: Finger[] = [];
  /** Contacts of the last message that was sent, at most as many as a message may cancel. */
  private known = new Set<number>();
  /** Those of them that the system has cancelled since. */
  private unsent: number[] = [];
  private lift: number | null = null;
  /** The lift of the last message. */
  private told: number | null = null;
  /** Time of the lift control's last unsent move; null without one. */
  private lifted: number | null = null;
  private readonly times = new Map<number, number>();
  /** Top left corner of the touch rectangle in CSS pixels. */
  corner = { x: 0, y: 0 };
  /** True if touches are used, which is so for a player. */
  active = false;
  /** True if fingers that keys put down have their names; in a study the program finds them. */
  named = true;

  constructor(private readonly connection: Connection) {
    window.setInterval(() => this.repeat(), REPEAT_MS / 2);
  }

  touch(change: Change): void {
    const moves = change.fingers.length === this.fingers.length && !change.cancelled.length;
    this.fingers = change.fingers;
    // What no message had is not there to be cancelled.
    this.unsent.push(...change.cancelled.filter((id) => this.known.has(id)));
    // Of several moves only the newest counts; touch-down and touch-up are never delayed.
    if (moves && this.connection.stalled) return;
    this.send(change.at);
  }

  /** The lift control, 0 to 1; null if the task has none. */
  setLift(lift: number | null): void {
    this.lift = lift;
    if (lift === null) this.told = null;
    else this.lifted ??= performance.now();
  }

  /** Sends a move of the lift control. Called before each picture, after the moves of the fingers, so
   * that both go into one message. */
  settle(): void {
    if (this.lifted !== null) this.send(this.lifted);
  }

  /** ms since the newest touch event in a message or an earlier one; null if it was returned
   * before. */
  since(seq: number): number | null {
    let at: number | null = null;
    for (const [sent, happened] of this.times) {
      if (sent > seq) break;
      at = happened;
      this.times.delete(sent);
    }
    return at === null ? null : performance.now() - at;
  }

  private repeat(): void {
    if (this.fingers.length && performance.now() - this.last >= REPEAT_MS) this.send(null);
  }

  /** @param at ms, time of the event; null repeats the last message, of one moment, as it was. */
  private send(at: number | null): void {
    if (at !== null) {
      this.lifted = null;
      this.told = this.lift;
    }
    if (!this.active) return;
    this.seq += 1;
    const sent = this.connection.say({
      type: "touches",
      seq: this.seq,
      t: performance.now(),
      contacts: this.fingers.map((f) => [
        f.id,
        round(f.x - this.corner.x),
        round(f.y - this.corner.y),
        round(f.width),
        round(f.height),
      ]),
      cancelled: this.unsent,
      lift: this.told,
      labels: this.named ? this.fingers.flatMap(({ id, label }) => (label === null ? [] : [[id, label]])) : [],
    });
    if (!sent) return;
    this.known = new Set(this.fingers.map((f) => f.id));
    this.unsent = [];
    this.last = performance.now();
    if (at === null) return;
    this.times.set(this.seq, at);
    if (this.times.size > REMEMBERED) this.times.delete(this.times.keys().next().value!);
  }
}

const round = (value: number): number => Math.round(value * 100) / 100;
