// Fingers on the screen. Pointer Events become contacts with new ids; the end of a contact is either
// a lift by the person or a cancellation by the system.

import { claim } from "./dom";
import { recallHere, rememberHere } from "./memory";

/** One finger, in CSS pixels of the page. */
export interface Finger {
  id: number;
  x: number;
  y: number;
  /** At most 1 where the browser does not know them. */
  width: number;
  height: number;
  mouse: boolean;
}

export interface Change {
  fingers: Finger[];
  /** Fingers that have to be lifted before they count. */
  resting: Finger[];
  cancelled: number[];
  /** ms, time of the event itself; the system's delay until now counts as latency. */
  at: number;
}

/** Largest number of contacts that the protocol allows. */
const MOST = 20;
/** ms between two messages of moves: 120 a second, of which the computer accepts twice as many. */
const BETWEEN_MS = 8;
const IDS_PER_LOAD = 100_000;

/** How often this tab has loaded the page before: contacts from before a reload must not be mistaken
 * for those after it. */
function loads(): number {
  const before = Number(recallHere("loads") ?? 0) || 0;
  rememberHere("loads", String((before + 1) % 10_000));
  return before;
}

export class Fingers {
  private readonly down = new Map<number, Finger>();
  /** Fingers that still touch although their contacts were cancelled: they have to be lifted. */
  private readonly dead = new Map<number, Finger>();
  private cancelled: number[] = [];
  private nextId = 1 + IDS_PER_LOAD * loads();
  private moved = 0;
  /** ms, time of the last message. */
  private flushed = 0;
  /** Timer of a message that would come too soon after the last one. */
  private later = 0;
  /** Wakes after the events that are waiting, so that all fingers of a moment are in one message. */
  private readonly soon = new MessageChannel();

  /**
   * @param stage Element on which a touch is a contact; touches that begin on a button are ignored.
   * @param tell Called for every change; for moves once per picture.
   */
  constructor(
    stage: HTMLElement,
    private readonly tell: (change: Change) => void,
  ) {
    // No pointer capture and no preventDefault on touch events: together they make Safari cancel.
    stage.addEventListener("pointerdown", (e) => this.onDown(e));
    claim(stage);
    window.addEventListener("pointermove", (e) => this.onMove(e));
    // Where a browser has it (on https and localhost), it comes at once, and not with the next picture.
    window.addEventListener("pointerrawupdate", (e) => {
      if (e instanceof PointerEvent) this.onMove(e);
    });
    this.soon.port1.onmessage = () => {
      const early = this.flushed + BETWEEN_MS - performance.now();
      if (early <= 0) this.settle();
      else this.later ||= window.setTimeout(() => this.settle(), early);
    };
    window.addEventListener("pointerup", (e) => this.onUp(e));
    window.addEventListener("pointercancel", (e) => this.onCancel(e));
    window.addEventListener("blur", () => this.cancelAll());
    window.addEventListener("pagehide", () => this.forget());
    window.addEventListener("resize", () => this.cancelAll());
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState !== "visible") this.forget();
    });
    for (const gesture of ["gesturestart", "gesturechange", "contextmenu", "selectstart", "dragstart"])
      document.addEventListener(gesture, (e) => {
        // The fields of a study's form must stay usable.
        if (!(e.target instanceof Element && e.target.closest("input, textarea"))) e.preventDefault();
      });
  }

  get all(): Finger[] {
    return [...this.down.values()];
  }

  /** Fingers that do not count until they are lifted. */
  get resting(): Finger[] {
    return [...this.dead.values()];
  }

  /** Cancels all contacts, as when the page is turned. */
  cancelAll(): void {
    if (!this.down.size) return;
    this.cancelled.push(...this.all.map((f) => f.id));
    for (const [pointer, finger] of this.down) if (!finger.mouse) this.dead.set(pointer, finger);
    this.down.clear();
    this.flush(performance.now());
  }

  /** Cancels all contacts of a page that is hidden, where no finger can rest. */
  private forget(): void {
    this.cancelAll();
    this.dead.clear();
  }

  /** Sends the moves of all fingers, which come as one event each, as one message. Called as soon as
   * they are there, and before each picture, so that neither the message nor the rings wait for the
   * next one. */
  settle(): void {
    window.clearTimeout(this.later);
    this.later = 0;
    if (this.moved) this.flush(this.moved);
  }

  private onDown(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    this.dead.delete(event.pointerId);
    if (this.down.size >= MOST || this.down.has(event.pointerId)) return;
    this.down.set(event.pointerId, this.read(event, this.nextId++));
    this.flush(event.timeStamp);
  }

  private onMove(event: PointerEvent): void {
    const dead = this.dead.get(event.pointerId);
    if (dead) this.dead.set(event.pointerId, this.read(event, dead.id));
    if (dead) this.moved = event.timeStamp;
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    if (finger.mouse && !(event.buttons & 1)) {
      // The button was released outside the window.
      this.onUp(event);
      return;
    }
    const now = this.read(event, finger.id);
    // A move that was sent already comes a second time, with the picture.
    if (now.x === finger.x && now.y === finger.y && now.width === finger.width && now.height === finger.height)
      return;
    this.down.set(event.pointerId, now);
    this.moved = event.timeStamp;
    // Not with the next picture, which may take long.
    this.soon.port2.postMessage(0);
  }

  private onUp(event: PointerEvent): void {
    const dead = this.dead.delete(event.pointerId);
    if (this.down.delete(event.pointerId) || dead) this.flush(event.timeStamp);
  }

  private onCancel(event: PointerEvent): void {
    if (this.dead.delete(event.pointerId)) this.flush(event.timeStamp);
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    this.down.delete(event.pointerId);
    this.cancelled.push(finger.id);
    this.flush(event.timeStamp);
  }

  private read(event: PointerEvent, id: number): Finger {
    const mouse = event.pointerType === "mouse";
    const [width, height] = mouse ? [0, 0] : [event.width, event.height];
    return { id, x: event.clientX, y: event.clientY, width, height, mouse };
  }

  private flush(at: number): void {
    this.moved = 0;
    this.flushed = performance.now();
    const cancelled = this.cancelled.splice(0);
    this.tell({ fingers: this.all, resting: this.resting, cancelled, at });
  }
}
