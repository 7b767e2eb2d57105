// The delay that the settings show: from a touch to the first picture that contains it; before the first
// touch, to the computer and back.

import { say } from "./words";

const digits = (ms: number): string => (ms < 10 ? ms.toFixed(1) : ms.toFixed(0));

export class Delay {
  /** ms, of the newest touch; null before the first. */
  touch: number | null = null;
  /** ms, of the newest heartbeat; null before the first. */
  link: number | null = null;

  get words(): string {
    if (this.touch !== null) return say("touch_delay", { time: digits(this.touch) });
    return this.link === null ? "" : say("link_delay", { time: digits(this.link) });
  }
}
