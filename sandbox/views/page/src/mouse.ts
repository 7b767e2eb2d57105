// The mouse as one finger or a whole hand, as in the program's window (sandbox/devices/mouse/mouse.py): a key
// puts down a hand whose fingers are pinned, which means that they stay without a button.

import type { Rectangle } from "./camera";
import { GRAB_RADIUS, HANDS, NARROWEST, WHEEL_FACTOR, WHEEL_TURN, WIDEST } from "./protocol";

export interface Place {
  x: number;
  y: number;
}

/** One finger, in CSS pixels of the page. */
export interface MouseFinger extends Place {
  readonly id: number;
  /** Thumb 0 to little finger 4; null for a finger without a name. */
  readonly label: number | null;
  readonly pinned: boolean;
}

const THUMB = 0;

export class Mouse {
  private down: MouseFinger[] = [];
  /** Ids of the fingers that the button holds. */
  private held = new Set<number>();
  private last: Place = { x: 0, y: 0 };
  /** True once the pointer has a place. */
  private came = false;
  private isHand = false;
  /** The touch rectangle, and CSS pixels of a metre on its table. */
  private table: Rectangle = { left: 0, top: 0, width: 0, height: 0 };
  private scale = 1;
  private side: "left" | "right" = "right";

  /** @param nextId Gives every new finger its id. */
  constructor(private readonly nextId: () => number) {}

  get fingers(): readonly MouseFinger[] {
    return this.down;
  }

  /** True if the wheel opens, closes and turns the fingers. */
  get opens(): boolean {
    return this.pins.length > 1;
  }

  private get pins(): MouseFinger[] {
    return this.down.filter((f) => f.pinned);
  }

  /** @param scale CSS pixels of a metre on the table. */
  stand(table: Rectangle, scale: number, side: "left" | "right"): void {
    [this.table, this.scale, this.side] = [table, scale, side];
    if (!this.came) this.last = { x: table.left + table.width / 2, y: table.top + table.height / 2 };
  }

  /** Presses the button.
   *
   * @param pin Pins the new finger; on a pinned one, lifts it.
   * @param together Takes all pinned fingers, wherever the press is.
   */
  press(at: Place, pin: boolean, together: boolean): void {
    this.release();
    this.last = at;
    this.came = true;
    const pins = this.pins;
    const away = (f: Place): number => Math.hypot(f.x - at.x, f.y - at.y);
    const near = pins.filter((f) => away(f) <= GRAB_RADIUS * this.scale).sort((f, g) => away(f) - away(g))[0];
    if (pins.length && together) this.hold(pins);
    else if (near && pin) this.down = this.down.filter((f) => f !== near);
    else if (near) this.hold([near]);
    else if (this.isHand && !pin) this.hold(pins);
    else {
      const finger = { id: this.nextId(), ...at, label: null, pinned: pin };
      this.down = [...this.down, finger];
      this.hold([finger]);
      this.isHand = false;
    }
  }

  /** Moves the pointer, with the fingers that the button holds; true if there are any. */
  move(at: Place): boolean {
    const step = { x: at.x - this.last.x, y: at.y - this.last.y };
    this.last = at;
    this.came = true;
    if (!this.held.size) return false;
    const moved = this.down.filter((f) => this.held.has(f.id));
    const free = moved.length === 1 && !moved[0]!.pinned;
    const { x, y } = free ? step : this.within(moved, step);
    this.put(moved.map((f) => (free ? { ...f, ...at } : { ...f, x: f.x + x, y: f.y + y })));
    return true;
  }

  /** Releases the button: a finger that is not pinned is lifted. */
  release(): void {
    this.down = this.down.filter((f) => f.pinned || !this.held.has(f.id));
    this.held.clear();
  }

  /** Opens (steps above 0) or closes the pinned fingers, or turns them about their middle. */
  wheel(steps: number, turn: boolean): void {
    const { pins } = this;
    const thumbs = pins.filter((f) => f.label === THUMB);
    // A thumb closes against all other fingers together.
    const groups = thumbs.length === 1 ? [thumbs, pins.filter((f) => f.label !== THUMB)] : pins.map((f) => [f]);
    const means = groups.map(mean);
    const middle = mean(means);
    if (turn) {
      const [cos, sin] = [Math.cos(-WHEEL_TURN * steps), Math.sin(-WHEEL_TURN * steps)];
      this.put(pins.map((f) => {
        const [x, y] = [f.x - middle.x, f.y - middle.y];
        return { ...f, x: middle.x + cos * x - sin * y, y: middle.y + sin * x + cos * y };
      }));
      return;
    }
    const width = (2 * Math.max(...means.map((m) => Math.hypot(m.x - middle.x, m.y - middle.y)))) / this.scale;
    const wanted = Math.min(Math.max(width * WHEEL_FACTOR ** steps, NARROWEST), WIDEST);
    const more = width > 0 ? wanted / width - 1 : 0;
    this.put(groups.flatMap((group, i) => {
      const [x, y] = [more * (means[i]!.x - middle.x), more * (means[i]!.y - middle.y)];
      return group.map((f) => ({ ...f, x: f.x + x, y: f.y + y }));
    }));
  }

  /** Puts down a hand at the pointer; the same number again lifts it, another one replaces it. */
  hand(count: number): void {
    const there = this.isHand && this.pins.length === count;
    this.lift();
    if (there) return;
    const mirrored = this.side === "right" ? 1 : -1;
    this.down = (HANDS[count - 1] ?? []).map(([label, x, y]) => {
      const at = { x: this.last.x + mirrored * x * this.scale, y: this.last.y + y * this.scale };
      return { id: this.nextId(), ...at, label, pinned: true };
    });
    const { x, y } = this.within(this.down, { x: 0, y: 0 });
    this.put(this.down.map((f) => ({ ...f, x: f.x + x, y: f.y + y })));
    this.isHand = true;
  }

  /** Lifts all fingers. */
  lift(): void {
    this.down = [];
    this.held.clear();
    this.isHand = false;
  }

  private hold(fingers: MouseFinger[]): void {
    this.held = new Set(fingers.map((f) => f.id));
  }

  /** A step that leaves some fingers on the table, as far as they have room on it. */
  private within(fingers: Place[], step: Place): Place {
    const { left, top, width, height } = this.table;
    const [xs, ys] = [fingers.map((f) => f.x), fingers.map((f) => f.y)];
    const between = (d: number, some: number[], from: number, to: number): number =>
      Math.max(Math.min(d, to - Math.max(...some)), from - Math.min(...some));
    return { x: between(step.x, xs, left, left + width), y: between(step.y, ys, top, top + height) };
  }

  private put(moved: MouseFinger[]): void {
    const places = new Map(moved.map((f) => [f.id, f]));
    this.down = this.down.map((f) => places.get(f.id) ?? f);
  }
}

const mean = (places: readonly Place[]): Place => ({
  x: places.reduce((sum, { x }) => sum + x, 0) / places.length,
  y: places.reduce((sum, { y }) => sum + y, 0) / places.length,
});
