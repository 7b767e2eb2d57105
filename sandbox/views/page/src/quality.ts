// Reduces the quality on a device that cannot keep up: first no shadows, then fewer pixels. The level
// is stored for the next start. A device without a graphics card begins with the lowest.

import type { WebGLRenderer } from "three";
import { drawsSlowly } from "./drawing";
import { recall, remember } from "./storage";

/** ms, largest mean duration of a picture; 60 Hz leaves 17. */
const TOO_LONG = 24;
const PICTURES = 45;
/** ms, duration of a picture that makes the scene lag visibly; a few of them are enough. */
const FAR_TOO_LONG = 150;
const FEW = 3;
/** ms above which the page was stopped meanwhile, and the device is not slow. */
const PAUSE = 1000;
/** Levels: full quality; no shadows; one pixel per CSS pixel; fewer pixels, and jagged edges. */
const LOWEST = 3;
const PIXELS = [2, 2, 1, 0.7];

export class Quality {
  private level = firstLevel();
  private sum = 0;
  private n = 0;
  private pictures = 0;
  private slow = 0;
  private renderer: WebGLRenderer | null = null;

  constructor(private readonly changed: () => void) {}

  /** True if edges are smoothed; needed when the canvas is made. */
  get smooth(): boolean {
    return this.level < LOWEST;
  }

  /** Applies the current level to a renderer. */
  apply(renderer: WebGLRenderer): void {
    this.renderer = renderer;
    renderer.shadowMap.enabled = this.level === 0;
    const most = PIXELS[this.level] ?? 1;
    renderer.setPixelRatio(most < 1 ? most : Math.min(window.devicePixelRatio, most));
  }

  /** Notes how many ms a picture took, up to the first chance to draw another one. How many pictures
   * come is up to the network, and says nothing about the device. The first ones take longer, as
   * programs are compiled. */
  finished(ms: number): void {
    this.pictures += 1;
    this.slow = ms > FAR_TOO_LONG && this.pictures > FEW ? this.slow + 1 : 0;
    if (this.slow >= FEW && this.level < LOWEST) this.lower();
    else this.note(ms);
  }

  /** The same for a page that draws at every chance, and does not know when a picture is finished. */
  note(ms: number): void {
    if (ms > PAUSE) return;
    this.sum += ms;
    this.n += 1;
    if (this.n < PICTURES) return;
    const mean = this.sum / this.n;
    this.sum = this.n = 0;
    if (mean > TOO_LONG && this.level < LOWEST) this.lower();
  }

  private lower(): void {
    this.slow = this.pictures = this.sum = this.n = 0;
    this.level += 1;
    remember("quality", String(this.level));
    if (this.renderer) this.apply(this.renderer);
    this.changed();
  }
}

/** The level that was stored, else that of the renderer. */
function firstLevel(): number {
  const stored = recall("quality");
  if (stored !== null) return Math.min(Math.max(Number(stored) || 0, 0), LOWEST);
  return drawsSlowly() ? LOWEST : 0;
}
