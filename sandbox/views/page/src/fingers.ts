// Fingers on the screen. Pointer Events become contacts with new ids; the end of a contact is either
// a lift by the person or a cancellation by the system.

import { claim } from "./dom";
import { Mouse } from "./mouse";
import { recall, recallHere, remember, rememberHere } from "./storage";

/** One finger, in CSS pixels of the page. */
export interface Finger {
  id: number;
  x: number;
  y: number;
  /** At most 1 where the browser does not know them. */
  width: number;
  height: number;
  mouse: boolean;
  /** Thumb 0 to little finger 4, of a hand that a key put down; else null. */
  label: number | null;
  /** True if it stays down without a button. */
  pinned: boolean;
}

export interface Change {
  fingers: Finger[];
  /** Fingers that have to be lifted before they count. */
  resting: Finger[];
  cancelled: number[];
  /** True if the system took so many fingers at once that it must have been for a gesture of its own. */
  stolen: boolean;
  /** ms, time of the event itself; the system's delay until now counts as latency. */
  at: number;
}

/** Number of fingers from which systems have gestures of their own. */
const GESTURE = 3;
/** Largest number of contacts that the protocol allows. */
const MOST = 20;
/** ms between two messages of moves: 120 a second, of which the computer accepts twice as many. */
const BETWEEN_MS = 8;
const IDS_PER_LOAD = 100_000;

/** How often this browser has loaded the page before: contacts from before a reload, or of the tab that had
 * the seat before, must not be mistaken for those after it. */
function loads(): number {
  const before = Number(recall("loads") ?? recallHere("loads") ?? 0) || 0;
  const next = String((before + 1) % 10_000);
  remember("loads", next);
  rememberHere("loads", next);
  return before;
}

export class Fingers {
  readonly mouse = new Mouse(() => this.nextId++);
  private readonly down = new Map<number, Finger>();
  /** Fingers that still touch although their contacts were cancelled: they have to be lifted. */
  private readonly dead = new Map<number, Finger>();
  private cancelled: number[] = [];
  private stolen = false;
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
   * @param tell Called for every change; for moves at most every `BETWEEN_MS`.
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
    window.addEventListener("lostpointercapture", (e) => this.onLost(e));
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
    const ofMouse = this.mouse.fingers.map((f) => ({ ...f, width: 0, height: 0, mouse: true }));
    return [...this.down.values(), ...ofMouse];
  }

  /** Tells of fingers that keys or the wheel have moved. */
  tellNow(): void {
    this.flush(performance.now());
  }

  /** Fingers that do not count until they are lifted. */
  get resting(): Finger[] {
    return [...this.dead.values()];
  }

  /** Cancels all contacts, as when the page is turned. */
  cancelAll(): void {
    const { all } = this;
    if (!all.length) return;
    this.cancelled.push(...all.map((f) => f.id));
    for (const [pointer, finger] of this.down) this.dead.set(pointer, finger);
    this.down.clear();
    this.mouse.lift();
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
    if (event.pointerType === "mouse") {
      if (event.button !== 0) return;
      this.mouse.press({ x: event.clientX, y: event.clientY }, event.shiftKey, event.ctrlKey);
      this.flush(event.timeStamp);
      return;
    }
    this.dead.delete(event.pointerId);
    // A browser that loses the end of a touch gives its number to the next one, which is another contact.
    const lost = this.down.get(event.pointerId);
    if (lost && this.down.delete(event.pointerId)) this.cancelled.push(lost.id);
    if (this.down.size >= MOST) return;
    this.down.set(event.pointerId, this.read(event, this.nextId++));
    this.flush(event.timeStamp);
  }

  private onMove(event: PointerEvent): void {
    if (event.pointerType === "mouse") {
      this.drag(event);
      return;
    }
    const dead = this.dead.get(event.pointerId);
    if (dead) this.dead.set(event.pointerId, this.read(event, dead.id));
    if (dead) this.moved = event.timeStamp;
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    const now = this.read(event, finger.id);
    // A move that was sent already comes a second time, with the picture.
    if (now.x === finger.x && now.y === finger.y && now.width === finger.width && now.height === finger.height)
      return;
    this.down.set(event.pointerId, now);
    this.moved = event.timeStamp;
    // Not with the next picture, which may take long.
    this.soon.port2.postMessage(0);
  }

  private drag(event: PointerEvent): void {
    // The button may have been released outside the window.
    if (!(event.buttons & 1)) this.onUp(event);
    if (!this.mouse.move({ x: event.clientX, y: event.clientY })) return;
    this.moved = event.timeStamp;
    this.soon.port2.postMessage(0);
  }

  private onUp(event: PointerEvent): void {
    if (event.pointerType === "mouse") {
      const before = this.mouse.fingers.length;
      this.mouse.release();
      if (this.mouse.fingers.length < before) this.flush(event.timeStamp);
      return;
    }
    const dead = this.dead.delete(event.pointerId);
    if (this.down.delete(event.pointerId) || dead) this.flush(event.timeStamp);
  }

  private onCancel(event: PointerEvent): void {
    if (this.dead.delete(event.pointerId)) this.flush(event.timeStamp);
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    this.stolen = this.down.size >= GESTURE;
    this.down.delete(event.pointerId);
    this.cancelled.push(finger.id);
    this.flush(event.timeStamp);
  }

  /** A browser may lose a lift (Chromium, when a finger moves fast), and yet report that the capture is over
   * which every touch has. It does so after a lift, too, which has ended the contact by then. It does so at the
   * document where the touched element was removed: there the finger still rests, and its events go on. */
  private onLost(event: PointerEvent): void {
    const finger = this.down.get(event.pointerId) ?? this.dead.get(event.pointerId);
    if (!finger || !(event.target instanceof Element)) return;
    window.setTimeout(() => {
      const now = this.down.get(event.pointerId) ?? this.dead.get(event.pointerId);
      if (now?.id === finger.id) this.onUp(event);
    });
  }

  private read(event: PointerEvent, id: number): Finger {
    const { clientX: x, clientY: y, width, height } = event;
    return { id, x, y, width, height, mouse: false, label: null, pinned: false };
  }

  private flush(at: number): void {
    this.moved = 0;
    this.flushed = performance.now();
    const cancelled = this.cancelled.splice(0);
    const { stolen } = this;
    this.stolen = false;
    this.tell({ fingers: this.all, resting: this.resting, cancelled, stolen, at });
  }
}
