// A demonstration: frames in which the simulated user plays this very table, shown again and again until the
// person touches. The layout of the message is in sandbox/play/demonstration.py.

import { type Frame, parseFrame } from "./frame";
import { DEMONSTRATION_KIND, PROTOCOL } from "./protocol";

const HEADER_BYTES = 8;
/** s that a demonstration should take, and how many times faster than the simulated user it is at least and at
 * most: a chord is pressed in less than a second. */
const SECONDS = 3;
const SLOWEST = 0.5;
const FASTEST = 2.5;
/** ms for which its end stays. */
const STAY_MS = 900;

/** The frames in a message, or null if the message is no demonstration. */
export function parseDemonstration(data: ArrayBuffer): Frame[] | null {
  if (data.byteLength < HEADER_BYTES) return null;
  const view = new DataView(data);
  if (view.getUint8(0) !== PROTOCOL || view.getUint8(1) !== DEMONSTRATION_KIND) return null;
  const frames: Frame[] = [];
  let at = HEADER_BYTES;
  for (let i = view.getUint16(2, true); i > 0; i--) {
    const end = at + 4 + view.getUint32(at, true);
    const frame = parseFrame(data.slice(at + 4, end));
    if (frame) frames.push(frame);
    at = end;
  }
  return frames;
}

export class Demonstration {
  /** Empty until there is one. */
  frames: readonly Frame[] = [];
  /** ms, time at which it began; null while it is not shown. */
  private began: number | null = null;

  /** True once it can be shown. */
  get ready(): boolean {
    return this.frames.length > 0;
  }

  get shown(): boolean {
    return this.began !== null;
  }

  take(frames: Frame[]): void {
    this.frames = frames;
  }

  start(now: number): void {
    if (this.ready) this.began ??= now;
  }

  stop(): void {
    this.began = null;
  }

  /** Another trial has begun. */
  forget(): void {
    this.frames = [];
    this.began = null;
  }

  /** The frame to show at a time in ms; null if nothing is shown. */
  at(now: number): Frame | null {
    const [first, last] = [this.frames[0], this.frames.at(-1)];
    if (this.began === null || !first || !last) return null;
    const long = last.time - first.time;
    const speed = Math.min(Math.max(long / SECONDS, SLOWEST), FASTEST);
    const passed = (now - this.began) % ((1000 * long) / speed + STAY_MS);
    const time = first.time + (speed * passed) / 1000;
    const later = this.frames.findIndex((frame) => frame.time > time);
    return later < 0 ? last : this.frames[Math.max(later - 1, 0)]!;
  }
}
