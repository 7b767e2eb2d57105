// Fingers on the screen. Pointer Events become contacts with new ids; the end of a contact is either
// a lift by the person or a cancellation by the system.

/** One finger, in CSS pixels of the page. */
export interface Finger {
  id: number;
  x: number;
  y: number;
  width: number;
  mouse: boolean;
}

export interface Change {
  fingers: Finger[];
  cancelled: number[];
  /** ms, time of the event itself; the system's delay until now counts as latency. */
  at: number;
}

/** Largest number of contacts that the protocol allows. */
const MOST = 20;

export class Fingers {
  private readonly down = new Map<number, Finger>();
  private cancelled: number[] = [];
  private nextId = 1;
  private moved = 0;

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
    window.addEventListener("pointermove", (e) => this.onMove(e));
    window.addEventListener("pointerup", (e) => this.onUp(e));
    window.addEventListener("pointercancel", (e) => this.onCancel(e));
    window.addEventListener("blur", () => this.cancelAll());
    window.addEventListener("pagehide", () => this.cancelAll());
    window.addEventListener("resize", () => this.cancelAll());
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState !== "visible") this.cancelAll();
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

  /** Cancels all contacts when the page is turned, hidden, or disconnected from the computer. */
  cancelAll(): void {
    if (!this.down.size) return;
    this.cancelled.push(...this.all.map((f) => f.id));
    this.down.clear();
    this.flush(performance.now());
  }

  /** Sends the moves of all fingers, which come as one event each, as one message. Called before each
   * picture is drawn, so that neither the message nor the rings wait for the next one. */
  settle(): void {
    if (this.moved) this.flush(this.moved);
  }

  private onDown(event: PointerEvent): void {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    if (this.down.size >= MOST || this.down.has(event.pointerId)) return;
    this.down.set(event.pointerId, this.read(event, this.nextId++));
    this.flush(event.timeStamp);
  }

  private onMove(event: PointerEvent): void {
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    if (finger.mouse && !(event.buttons & 1)) {
      // The button was released outside the window.
      this.onUp(event);
      return;
    }
    this.down.set(event.pointerId, this.read(event, finger.id));
    this.moved = event.timeStamp;
  }

  private onUp(event: PointerEvent): void {
    if (this.down.delete(event.pointerId)) this.flush(event.timeStamp);
  }

  private onCancel(event: PointerEvent): void {
    const finger = this.down.get(event.pointerId);
    if (!finger) return;
    this.down.delete(event.pointerId);
    this.cancelled.push(finger.id);
    this.flush(event.timeStamp);
  }

  private read(event: PointerEvent, id: number): Finger {
    const mouse = event.pointerType === "mouse";
    return { id, x: event.clientX, y: event.clientY, width: mouse ? 0 : event.width, mouse };
  }

  private flush(at: number): void {
    this.moved = 0;
    const cancelled = this.cancelled.splice(0, MOST);
    this.tell({ fingers: this.all, cancelled, at });
  }
}
