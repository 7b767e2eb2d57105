// Short vibrations where the device has them: when a hand takes hold, and at success.

import { recall, remember } from "./storage";

/** ms, as short as a device can make it felt. */
const GRIP = 15;
/** ms on, off, on. */
const SUCCESS = [40, 60, 40];
const KEPT = "vibration";

export class Vibration {
  /** False on a device without it, and for people who have asked their system for less motion. */
  readonly possible =
    "vibrate" in navigator && !matchMedia("(prefers-reduced-motion: reduce)").matches;
  /** True in a study, where all participants feel the same: nothing. */
  muted = false;
  private wanted = recall(KEPT) !== "off";
  /** Browsers refuse to vibrate, and complain, before a finger has touched the page and left it. */
  private touched = false;

  constructor() {
    const touch = (): void => {
      this.touched = true;
    };
    window.addEventListener("pointerup", touch, { once: true, capture: true });
  }

  get on(): boolean {
    return this.possible && this.wanted;
  }

  toggle(): void {
    this.wanted = !this.wanted;
    remember(KEPT, this.wanted ? "on" : "off");
  }

  grip(): void {
    this.vibrate(GRIP);
  }

  success(): void {
    this.vibrate(SUCCESS);
  }

  private vibrate(pattern: number | number[]): void {
    if (this.on && this.touched && !this.muted) navigator.vibrate(pattern);
  }
}
