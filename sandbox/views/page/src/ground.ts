// The table: a dark mat with a grid that shows the scale, and the touch rectangle.

import {
  BufferGeometry,
  CanvasTexture,
  LineBasicMaterial,
  LineLoop,
  RepeatWrapping,
  SRGBColorSpace,
  Vector3,
} from "three";
import { OUTLINE, TABLE } from "./colours";
import { METRES_PER_INCH } from "./camera";
import type { SurfaceView } from "./protocol";
import { type Surfaced, surfaced } from "./shapes";

/** m, side of the repeated tile of the mat: 5 fields of 2 cm. */
const PIECE = 0.1;

/** The material of the mat, a plane of a given width and height in m; for `plain` see `surfaced`. */
export function matMaterial(width: number, height: number, plain: boolean): Surfaced {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 512;
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = `#${TABLE.toString(16).padStart(6, "0")}`;
  pen.fillRect(0, 0, 512, 512);
  for (let i = 0; i < 5; i++) {
    const at = (i * 512) / 5;
    pen.fillStyle = i ? "rgba(255,255,255,0.045)" : "rgba(255,255,255,0.12)";
    const wide = i ? 3 : 4;
    pen.fillRect(at, 0, wide, 512);
    pen.fillRect(0, at, 512, wide);
  }
  const map = new CanvasTexture(canvas);
  map.wrapS = map.wrapT = RepeatWrapping;
  map.repeat.set(width / PIECE, height / PIECE);
  map.colorSpace = SRGBColorSpace;
  map.anisotropy = plain ? 1 : 4;
  return surfaced(plain, { map, roughness: 0.95 });
}

/** The border of the touch rectangle, in its own plane. */
export function outline(surface: SurfaceView): LineLoop {
  const [w, h] = [surface.width_in * METRES_PER_INCH, surface.height_in * METRES_PER_INCH];
  const r = surface.rotation;
  const corners = [
    [0, 0],
    [w, 0],
    [w, -h],
    [0, -h],
  ].map(
    ([x = 0, y = 0]) =>
      new Vector3(
        surface.origin[0] + r[0] * x + r[1] * y,
        surface.origin[1] + r[3] * x + r[4] * y,
        surface.origin[2] + r[6] * x + r[7] * y,
      ),
  );
  const line = new LineLoop(
    new BufferGeometry().setFromPoints(corners),
    new LineBasicMaterial({ color: OUTLINE, transparent: true, opacity: 0.5 }),
  );
  return line;
}
