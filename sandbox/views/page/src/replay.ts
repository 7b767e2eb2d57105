// The last seconds before a success, once more: frames that the page has had already.

import type { Frame } from "./frame";

/** s that are shown again. */
const SECONDS = 3;

export class Replay {
  private frames: Frame[] = [];
  /** ms, time at which it began; null while it is not shown. */
  private began: number | null = null;

  /** Keeps a frame of the trial that is running. */
  note(frame: Frame): void {
    const last = this.frames.at(-1);
    if (last && (last.scene !== frame.scene || frame.time < last.time)) this.frames = [];
    // What comes after the success is not its own part.
    if (last?.scene === frame.scene && last.state.held) return;
    this.frames.push(frame);
    while (frame.time - this.frames[0]!.time > SECONDS) this.frames.shift();
  }

  get shown(): boolean {
    return this.began !== null;
  }

  start(now: number): void {
    this.began = this.frames.length ? now : null;
  }

  stop(): void {
    this.began = null;
  }

  /** The frame to show at a time in ms; null if nothing is shown again. */
  at(now: number): Frame | null {
    if (this.began === null) return null;
    const passed = this.frames[0]!.time + (now - this.began) / 1000;
    const later = this.frames.findIndex(({ time }) => time > passed);
    if (later < 0) this.began = null;
    return this.frames.at(later < 0 ? -1 : Math.max(later - 1, 0))!;
  }
}
