// Rings around the fingers, on their own canvas above the scene. They follow the touches without the
// network; the computer adds the finger's name, colour and force.

import { fingerColour, fingerName } from "./colours";

export interface Ring {
  x: number;
  y: number;
  /** Label, thumb 0 to little finger 4; null before it is labelled. */
  label: number | null;
  /** Force on objects, N. */
  force: number;
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
const PLAIN = "#dfe8ef";
/** In inches, size of a palm on another screen, which is not known here. */
const PALM = 1.2;

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
    const radius = Math.max(RADIUS * pxPerInch, 22);
    for (const ring of rings)
      if (ring.palm) this.drawPalm(ring, ring.palm, PALM * pxPerInch);
      else this.drawRing(ring, radius);
    // Names are drawn over all rings, as fingers side by side would cover each other's names.
    const above = radius + NAME_ABOVE * Math.min(pxPerInch, 90);
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
    const name = ring.word ?? fingerName(ring.label, ring.sure);
    pen.font = "600 15px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    const half = pen.measureText(name).width / 2 + 9;
    pen.fillStyle = "rgba(8, 12, 15, 0.72)";
    pen.beginPath();
    pen.roundRect?.(ring.x - half, y - 12, 2 * half, 24, 12);
    pen.fill();
    pen.fillStyle = this.colour(ring);
    pen.fillText(name, ring.x, y + 1);
  }
}
