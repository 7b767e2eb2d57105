// The camera of a player: the touch rectangle lies under the fingers at its true size.
//
// The page is a window in the plane of the touch surface. The eye stands before it, and the frustum
// goes from the eye through the page's corners, so that a point of that plane is drawn on exactly the
// pixel that touches it, while things above and below it are seen in perspective. The eye is a little
// beyond the middle, and the frustum off axis: from the person's own side, the knuckles of a bent
// hand would hide its fingertips.

import { Matrix4, PerspectiveCamera, Vector3 } from "three";
import { LIFT_STRIP_PX, type SurfaceView } from "./protocol";

export const METRES_PER_INCH = 0.0254;
const NEAR = 0.02;
const FAR = 8;
/** m, position of the eye from the surface's centre: along its x, up it, and out of it. */
const EYE_FLAT = new Vector3(0, 0.07, 0.7);
const EYE_UPRIGHT = new Vector3(0, 0.12, 0.55);

/** m above the surface up to which a spectator sees everything: for hands on it with lifted objects,
 * and for hands in the air. */
const ABOVE_TOUCHED = 0.13;
const ABOVE_IN_AIR = 0.3;
/** Shares of the page's height above and below that are kept free for text. */
const FREE_ABOVE = 0.1;
const FREE_BELOW = 0.03;

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
  /** Approximate CSS pixels of an inch of the surface, so that rings are as large as fingertips. */
  pxPerInch = 1;
  private size = { width: 1, height: 1 };

  /**
   * @param surface The touch rectangle.
   * @param pxPerInch CSS pixels.
   * @param width Width of the page, CSS pixels.
   * @param place Place of the rectangle on the page; else it is in the centre.
   */
  aim(
    surface: SurfaceView,
    pxPerInch: number,
    width: number,
    height: number,
    place?: Rectangle,
  ): void {
    const r = surface.rotation;
    this.size = { width, height };
    this.pxPerInch = pxPerInch;
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
    const aside = place ? (place.left + place.width / 2 - width / 2) * metres : 0;
    const below = place ? (place.top + place.height / 2 - height / 2) * metres : 0;
    const halfHeight = (height / 2) * metres;
    const shrink = NEAR / eye.z;
    const camera = this.camera;
    camera.position.copy(eye).applyMatrix4(this.axes).add(this.centre);
    camera.quaternion.setFromRotationMatrix(this.axes);
    camera.updateMatrixWorld(true);
    // Not updateProjectionMatrix, which supports symmetric frustums only.
    camera.projectionMatrix.makePerspective(
      (-halfWidth - aside - eye.x) * shrink,
      (halfWidth - aside - eye.x) * shrink,
      (halfHeight + below - eye.y) * shrink,
      (-halfHeight + below - eye.y) * shrink,
      NEAR,
      FAR,
    );
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }

  /** The camera of a spectator: the whole surface, from the side of the thumb, where the arm does not
   * hide it. Hands in the air are seen from farther away and more from the side, to show their
   * height. */
  overlook(
    surface: SurfaceView,
    hand: "left" | "right",
    width: number,
    height: number,
    inAir: boolean,
  ): void {
    this.aim(surface, 100, width, height);
    const upright = Math.abs(surface.rotation[8]) < 0.5;
    const camera = this.camera;
    camera.fov = 32;
    camera.aspect = width / height;
    camera.near = NEAR;
    camera.far = FAR;
    const flat = inAir ? new Vector3(-0.9, -0.55, 0.6) : new Vector3(-1, -0.3, 0.75);
    const from = upright ? new Vector3(-0.5, 0.3, 1) : flat;
    if (hand === "left") from.x = -from.x;
    const above = inAir ? ABOVE_IN_AIR : ABOVE_TOUCHED;
    const target = new Vector3(0, 0, above / 2).applyMatrix4(this.axes).add(this.centre);
    from.normalize().applyMatrix4(this.axes);
    camera.position.copy(target).add(from);
    camera.up.set(0, 0, 1);
    camera.lookAt(target);
    camera.updateMatrixWorld(true);
    camera.position.copy(target).addScaledVector(from, this.farEnough(surface, above, target));
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
  }

  /** m from the target at which the whole surface and the space above it are visible. */
  private farEnough(surface: SurfaceView, above: number, target: Vector3): number {
    const [x, y, back] = [new Vector3(), new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(x, y, back);
    const tall = Math.tan((this.camera.fov * Math.PI) / 360);
    const [up, down] = [tall * (1 - 2 * FREE_ABOVE), tall * (1 - 2 * FREE_BELOW)];
    let distance = 0;
    for (const right of [-0.5, 0.5])
      for (const far of [-0.5, 0.5])
        for (const height of [0, above]) {
          // Lifted objects are farther inside than those at the edge.
          const share = METRES_PER_INCH * (height ? 0.5 : 1);
          const point = new Vector3(
            right * surface.width_in * share,
            far * surface.height_in * share,
            height,
          );
          point.applyMatrix4(this.axes).add(this.centre).sub(target);
          const wide = Math.abs(point.dot(x)) / (tall * this.camera.aspect);
          const high = point.dot(y);
          const needed = Math.max(wide, high / up, -high / down);
          distance = Math.max(distance, needed + point.dot(back));
        }
    this.pxPerInch = (METRES_PER_INCH * this.size.height) / (2 * tall * distance);
    return distance;
  }

  /** CSS pixels on the page of a point in the world. */
  project(place: readonly [number, number, number]): { x: number; y: number } {
    this.seen.set(...place).project(this.camera);
    return {
      x: ((this.seen.x + 1) / 2) * this.size.width,
      y: ((1 - this.seen.y) / 2) * this.size.height,
    };
  }
}

/** The touch rectangle in CSS pixels: in the centre of its part of the page, or as near to it as the lift
 * control beside it allows. */
export function touchRectangle(
  surface: SurfaceView,
  pxPerInch: number,
  room: Rectangle,
  lift: "left" | "right" | null = null,
): Rectangle {
  const width = surface.width_in * pxPerInch;
  const height = surface.height_in * pxPerInch;
  const centred = room.left + (room.width - width) / 2;
  const left =
    lift === "left"
      ? Math.max(centred, room.left + LIFT_STRIP_PX)
      : lift === "right"
        ? Math.min(centred, room.left + room.width - LIFT_STRIP_PX - width)
        : centred;
  return { left, top: room.top + (room.height - height) / 2, width, height };
}
