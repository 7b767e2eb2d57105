// Rings around the fingers, on their own canvas above the scene. They follow the touches without the
// network; the computer adds the finger's name, colour and force.

import { fingerColour, fingerName } from "./colours";
import { say } from "./words";

export interface Ring {
  x: number;
  y: number;
  /** Label, thumb 0 to little finger 4; null before it is labelled. */
  label: number | null;
  /** Force on objects, N. */
  force: number;
  /** Force that the grip stores in it and lets go when it opens, N. */
  stored: number;
  /** True if the hand has no more force for it. */
  full: boolean;
  ignored: boolean;
  /** False if the label may well be wrong: the ring is dashed, and the name has a question mark. */
  sure: boolean;
  /** A word in place of the name, for a finger that has to do something. */
  word?: string;
  /** Width and height in CSS pixels of a palm, which is a faint patch without a ring. */
  palm?: { width: number; height: number };
}

/** In inches, size of the ring, which must be visible around a fingertip. */
const RADIUS = 0.42;
const NAME_ABOVE = 0.3;
/** Dash and gap of a ring in radii: nine of each. */
const DASH = Math.PI / 9;
/** CSS pixels, half the height of a name. */
const NAME_HALF = 12;
const PLAIN = "#dfe8ef";
const INK = "#080c0f";
const DARK = "rgba(8, 12, 15, 0.86)";
/** N, grip at which the arc around a ring is closed: the strongest that people's grips are tried at. */
const STRONGEST = 70;
/** N below which a grip is not told: less than what a resting finger presses with. */
export const TOLD = 1;
/** CSS pixels from a ring to the arc around it, and width of the arc. */
const ARC_GAP = 13;
const ARC_WIDTH = 5;
/** In inches, size of a palm on another screen, which is not known here. */
const PALM = 1.2;

/** CSS pixels, radius of a finger's ring. */
export const ringRadius = (pxPerInch: number): number => Math.max(RADIUS * pxPerInch, 22);
const nameAbove = (pxPerInch: number): number =>
  ringRadius(pxPerInch) + NAME_ABOVE * Math.min(pxPerInch, 90);

/** CSS pixels from a finger to what is clear of its ring and of its name. */
export const ringHeight = (pxPerInch: number): number => nameAbove(pxPerInch) + 2 * NAME_HALF;

export class Rings {
  private readonly pen: CanvasRenderingContext2D;
  private empty = true;
  /** Shows only the positions of fingers: no names, colours or forces. */
  plain = false;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.pen = canvas.getContext("2d")!;
    this.resize();
  }

  resize(): void {
    const ratio = Math.min(window.devicePixelRatio, 2);
    this.canvas.width = Math.round(window.innerWidth * ratio);
    this.canvas.height = Math.round(window.innerHeight * ratio);
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.empty = true;
  }

  draw(rings: Ring[], pxPerInch: number): void {
    if (this.empty && !rings.length) return;
    this.pen.clearRect(0, 0, window.innerWidth, window.innerHeight);
    this.empty = !rings.length;
    // Chromium without a graphics card may go on showing what was drawn before on a canvas that is now empty.
    this.canvas.style.visibility = this.empty ? "hidden" : "";
    const radius = ringRadius(pxPerInch);
    for (const ring of rings)
      if (ring.palm) this.drawPalm(ring, ring.palm, PALM * pxPerInch);
      else this.drawRing(ring, radius);
    // Names are drawn over all rings, as fingers side by side would cover each other's names.
    const above = nameAbove(pxPerInch);
    for (const ring of rings)
      if (ring.palm) {
        if (!this.plain) this.drawName(ring, ring.y);
      } else if (ring.word || !(ring.ignored || this.plain)) this.drawName(ring, ring.y - above);
  }

  private colour(ring: Ring): string {
    return this.plain ? PLAIN : fingerColour(ring.ignored ? null : ring.label);
  }

  private drawRing(ring: Ring, radius: number): void {
    const pen = this.pen;
    // From a thin line without force to a thick one at 3 N.
    pen.setLineDash(this.plain || ring.sure ? [] : [DASH * radius, DASH * radius]);
    const thick = 3 + (this.plain ? 0 : 7 * Math.min(ring.force / 3, 1));
    pen.lineWidth = thick + 3;
    pen.strokeStyle = "rgba(8, 12, 15, 0.55)";
    pen.beginPath();
    pen.arc(ring.x, ring.y, radius, 0, 2 * Math.PI);
    pen.stroke();
    pen.lineWidth = thick;
    pen.strokeStyle = this.colour(ring);
    pen.stroke();
    pen.setLineDash([]);
    if (!this.plain && (ring.full || ring.stored >= TOLD)) this.drawGrip(ring, radius + ARC_GAP);
  }

  /** An arc that opens at the bottom and closes with the force of the grip; closed and white at the
   * hand's limit. */
  private drawGrip(ring: Ring, radius: number): void {
    const pen = this.pen;
    const half = Math.PI * (ring.full ? 1 : Math.min(ring.stored / STRONGEST, 1));
    pen.beginPath();
    pen.arc(ring.x, ring.y, radius, Math.PI / 2 - half, Math.PI / 2 + half);
    pen.lineWidth = ARC_WIDTH + 3;
    pen.strokeStyle = "rgba(8, 12, 15, 0.55)";
    pen.stroke();
    pen.lineWidth = ARC_WIDTH;
    pen.strokeStyle = ring.full ? PLAIN : this.colour(ring);
    pen.stroke();
  }

  private drawPalm(ring: Ring, size: { width: number; height: number }, unknown: number): void {
    const pen = this.pen;
    pen.fillStyle = "rgba(158, 163, 168, 0.22)";
    pen.beginPath();
    const across = (size.width || unknown) / 2;
    pen.ellipse(ring.x, ring.y, across, (size.height || unknown) / 2, 0, 0, 2 * Math.PI);
    pen.fill();
  }

  private drawName(ring: Ring, y: number): void {
    const pen = this.pen;
    const name = ring.word ?? named(ring);
    pen.font = "600 15px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const half = pen.measureText(name).width / 2 + 9;
    // Dark on light at the limit, which is told without colours, too.
    const turned = ring.full && ring.word === undefined;
    pen.fillStyle = turned ? PLAIN : DARK;
    pen.beginPath();
    pen.roundRect?.(ring.x - half, y - NAME_HALF, 2 * half, 2 * NAME_HALF, NAME_HALF);
    pen.fill();
    pen.fillStyle = turned ? INK : this.colour(ring);
    pen.fillText(name, ring.x, y + 1);
  }
}

/** The finger's name, and what it holds with. */
function named({ label, sure, full, stored }: Ring): string {
  const name = fingerName(label, sure);
  if (full) return say("grip_limit", { name });
  return stored < TOLD ? name : say("grip_force", { name, force: stored.toFixed(0) });
}
