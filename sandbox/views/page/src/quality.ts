// Draws less on a device that cannot keep up: first no shadows, then fewer pixels.

import type { WebGLRenderer } from "three";

/** ms a picture may take in the mean; 60 Hz leaves 17, and one more step is too much at 30 Hz. */
const TOO_LONG = 24;
const PICTURES = 45;

export class Quality {
  private level = 0;
  private sum = 0;
  private n = 0;
  private last = 0;

  constructor(
    private readonly renderer: WebGLRenderer,
    private readonly changed: () => void,
  ) {
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  }

  /** One more picture has been drawn, at a time in ms. */
  note(now: number): void {
    const passed = now - this.last;
    this.last = now;
    // A pause of the stream says nothing about how fast this device draws.
    if (passed > 250) return;
    this.sum += passed;
    this.n += 1;
    if (this.n < PICTURES) return;
    const mean = this.sum / this.n;
    this.sum = this.n = 0;
    if (mean > TOO_LONG && this.level < 3) this.lower();
  }

  private lower(): void {
    this.level += 1;
    if (this.level === 1) this.renderer.shadowMap.enabled = false;
    else this.renderer.setPixelRatio(this.level === 2 ? 1 : 0.7);
    this.changed();
  }
}
