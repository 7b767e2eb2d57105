// The camera of a player: the touch rectangle lies under the fingers at its true size.
//
// The page is a window in the plane of the touch surface. The eye stands before it, and the frustum
// goes from the eye through the page's corners, so that a point of that plane is drawn on exactly the
// pixel that touches it, while things above and below it are seen in perspective. The eye is a little
// beyond the middle, and the frustum off axis: from the person's own side, the knuckles of a bent
// hand would hide its fingertips.

import { Matrix4, PerspectiveCamera, Vector3 } from "three";
import type { SurfaceView } from "./protocol";

const METRES_PER_INCH = 0.0254;
const NEAR = 0.02;
const FAR = 8;
/** m, of the eye before the surface's middle: along its x, up it, and out of it. */
const EYE_FLAT = new Vector3(0, 0.07, 0.7);
const EYE_UPRIGHT = new Vector3(0, 0.12, 0.55);

/** m, middle of what hands in the air do, over the table. */
const HELD = 0.07;

export interface Rectangle {
  left: number;
  top: number;
  width: number;
  height: number;
}

export class Lens {
  readonly camera = new PerspectiveCamera();
  private readonly axes = new Matrix4();
  private readonly centre = new Vector3();
  private readonly seen = new Vector3();
  private size = { width: 1, height: 1 };

  /**
   * @param surface The touch rectangle.
   * @param pxPerInch CSS pixels.
   * @param width Of the page, CSS pixels; its middle is the rectangle's.
   */
  aim(surface: SurfaceView, pxPerInch: number, width: number, height: number): void {
    const r = surface.rotation;
    this.size = { width, height };
    this.axes.set(r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0, 0, 0, 0, 1);
    this.centre
      .set(
        (surface.width_in / 2) * METRES_PER_INCH,
        (-surface.height_in / 2) * METRES_PER_INCH,
        0,
      )
      .applyMatrix4(this.axes)
      .add(new Vector3(...surface.origin));
    const upright = Math.abs(r[8]) < 0.5;
    const eye = upright ? EYE_UPRIGHT : EYE_FLAT;
    const metres = METRES_PER_INCH / pxPerInch;
    const halfWidth = (width / 2) * metres;
    const halfHeight = (height / 2) * metres;
    const shrink = NEAR / eye.z;
    const camera = this.camera;
    camera.position.copy(eye).applyMatrix4(this.axes).add(this.centre);
    camera.quaternion.setFromRotationMatrix(this.axes);
    camera.updateMatrixWorld(true);
    // Not updateProjectionMatrix: it knows symmetric frustums only.
    camera.projectionMatrix.makePerspective(
      (-halfWidth - eye.x) * shrink,
      (halfWidth - eye.x) * shrink,
      (halfHeight - eye.y) * shrink,
      (-halfHeight - eye.y) * shrink,
      NEAR,
      FAR,
    );
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }

  /** The camera of somebody who only looks: all of the surface, from the side of the thumb, where
   * the arm is not in the way. Hands in the air are seen from farther away, and more from the side:
   * how high they are is what one has to see. */
  overlook(
    surface: SurfaceView,
    hand: "left" | "right",
    width: number,
    height: number,
    inAir: boolean,
  ): void {
    this.aim(surface, 100, width, height);
    const upright = Math.abs(surface.rotation[8]) < 0.5;
    const span = Math.max(surface.width_in, surface.height_in * 1.4) * METRES_PER_INCH;
    const camera = this.camera;
    camera.fov = 32;
    camera.aspect = width / height;
    camera.near = NEAR;
    camera.far = FAR;
    const flat = inAir ? new Vector3(-0.9, -0.55, 0.6) : new Vector3(-1, -0.3, 0.75);
    const from = upright ? new Vector3(-0.5, 0.3, 1) : flat;
    if (hand === "left") from.x = -from.x;
    const distance = (span * (inAir ? 4.4 : 2.4)) / Math.min(camera.aspect, 1.4);
    const middle = this.centre.clone();
    if (inAir) middle.z += HELD;
    camera.position
      .copy(from.normalize().multiplyScalar(distance))
      .applyMatrix4(this.axes)
      .add(this.centre);
    camera.up.set(0, 0, 1);
    camera.lookAt(middle);
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
  }

  /** Where a place in the world is on the page, CSS pixels. */
  project(place: readonly [number, number, number]): { x: number; y: number } {
    this.seen.set(...place).project(this.camera);
    return {
      x: ((this.seen.x + 1) / 2) * this.size.width,
      y: ((1 - this.seen.y) / 2) * this.size.height,
    };
  }
}

/** The touch rectangle on the page, in CSS pixels: in its middle. */
export function touchRectangle(
  surface: SurfaceView,
  pxPerInch: number,
  pageWidth: number,
  pageHeight: number,
): Rectangle {
  const width = surface.width_in * pxPerInch;
  const height = surface.height_in * pxPerInch;
  return { left: (pageWidth - width) / 2, top: (pageHeight - height) / 2, width, height };
}
