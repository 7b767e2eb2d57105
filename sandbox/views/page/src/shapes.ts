// MuJoCo's shapes as three.js has them. Sizes are half lengths and radii; long shapes lie along z.

import {
  BoxGeometry,
  type BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  MeshLambertMaterial,
  MeshStandardMaterial,
  type MeshStandardMaterialParameters,
  type Object3D,
  PlaneGeometry,
  Quaternion,
  ReplaceStencilOp,
  SphereGeometry,
} from "three";
import type { Geom } from "./protocol";

/** Stencil value of what has to be touched, which a waiting hand leaves free. */
export const TO_TOUCH = 1;
/** Marks an object's pixels as what has to be touched. */
export const MARKED = {
  stencilWrite: true,
  stencilRef: TO_TOUCH,
  stencilZPass: ReplaceStencilOp,
} as const;

export type Surfaced = MeshStandardMaterial | MeshLambertMaterial;

/** The material of a surface.
 *
 * @param plain True for a browser that draws without a graphics card, which needs a quarter less time for it.
 */
export function surfaced(plain: boolean, look: MeshStandardMaterialParameters): Surfaced {
  const { roughness: _, ...simple } = look;
  return plain ? new MeshLambertMaterial(simple) : new MeshStandardMaterial(look);
}

/** m, half the side of a plane that is endless in MuJoCo. */
const FAR = 2;

/** The shape of a geom; `fine` uses more facets. */
export function geometry(geom: Geom, fine = false): BufferGeometry {
  const [a, b, c] = geom.size;
  const around = fine ? 32 : 20;
  switch (geom.kind) {
    case "box":
      return new BoxGeometry(2 * a, 2 * b, 2 * c);
    case "sphere":
      return new SphereGeometry(a, around, around / 2);
    case "ellipsoid":
      return new SphereGeometry(1, around, around / 2).scale(a, b, c);
    case "capsule":
      return new CapsuleGeometry(a, 2 * b, around / 4, around).rotateX(Math.PI / 2);
    case "cylinder":
      return new CylinderGeometry(a, a, 2 * b, around).rotateX(Math.PI / 2);
    case "plane":
      return new PlaneGeometry(2 * (a || FAR), 2 * (b || FAR));
  }
}

/** Puts an object where a geom is on its body. */
export function place(object: Object3D, geom: Geom): void {
  object.position.set(...geom.position);
  object.quaternion.copy(quaternion(geom.quaternion));
}

/** A three.js quaternion from w, x, y, z. */
export const quaternion = ([w, x, y, z]: readonly [number, number, number, number]): Quaternion =>
  new Quaternion(x, y, z, w);
