// A sign behind the table, for those who see nothing else than the table.

import { CanvasTexture, Mesh, MeshBasicMaterial, PlaneGeometry, SRGBColorSpace } from "three";
import { language } from "./words";

const [WIDE, HIGH] = [1024, 512];
/** m */
const WIDTH = 0.56;
const MARGIN = 40;
/** Pixels of a line of the title and of the other lines. */
const [LARGE, SMALL] = [56, 40];

export class Sign {
  readonly mesh: Mesh;
  private readonly canvas = document.createElement("canvas");
  private readonly texture: CanvasTexture;
  private written = "";

  constructor() {
    this.canvas.width = WIDE;
    this.canvas.height = HIGH;
    this.texture = new CanvasTexture(this.canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.mesh = new Mesh(
      new PlaneGeometry(WIDTH, (WIDTH * HIGH) / WIDE),
      new MeshBasicMaterial({ map: this.texture, transparent: true }),
    );
    // Upright, towards the person, whose side of the table is at -y.
    this.mesh.rotation.x = Math.PI / 2;
  }

  /** Writes lines, the first one large. */
  write(lines: string[]): void {
    const text = lines.filter((line) => line !== "");
    if (text.join("\n") === this.written) return;
    this.written = text.join("\n");
    const pen = this.canvas.getContext("2d")!;
    pen.clearRect(0, 0, WIDE, HIGH);
    pen.fillStyle = "rgba(16, 22, 27, 0.85)";
    pen.fillRect(0, 0, WIDE, HIGH);
    pen.fillStyle = "#eef2f5";
    pen.textAlign = "center";
    pen.textBaseline = "top";
    pen.direction = document.documentElement.dir === "rtl" ? "rtl" : "ltr";
    let y = MARGIN;
    text.forEach((line, i) => {
      const size = i ? SMALL : LARGE;
      pen.font = `${i ? "" : "bold "}${size}px system-ui, sans-serif`;
      for (const row of rows(pen, line)) {
        pen.fillText(row, WIDE / 2, y);
        y += 1.3 * size;
      }
      y += 0.3 * size;
    });
    this.texture.needsUpdate = true;
  }
}

/** A line broken between its words where it is too long. */
function rows(pen: CanvasRenderingContext2D, line: string): string[] {
  const done: string[] = [];
  let row = "";
  for (const { segment } of new Intl.Segmenter(language, { granularity: "word" }).segment(line)) {
    if (row && pen.measureText(row + segment).width > WIDE - 2 * MARGIN) {
      done.push(row.trim());
      row = "";
    }
    row += segment;
  }
  return [...done, row.trim()];
}
