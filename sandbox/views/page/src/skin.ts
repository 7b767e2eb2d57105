// The skin of a hand; the layout is in sandbox/server/page_frames.py. Its bones are the scene's bodies.

import {
  type Bone,
  BufferAttribute,
  BufferGeometry,
  Color,
  type Material,
  Matrix4,
  Quaternion,
  Skeleton,
  SkinnedMesh,
  Sphere,
  Vector3,
} from "three";
import { POSE_BYTES, PROTOCOL, SKIN_KIND } from "./protocol";

const HEADER_BYTES = 16;
const text = new TextDecoder();

/** A decoded skin. */
export interface Skin {
  /** Names of the bodies that carry it, palm first. */
  names: string[];
  geometry: BufferGeometry;
  inverses: Matrix4[];
}

/** The skin in a message, or null if the message is not a skin. */
export function parseSkin(data: ArrayBuffer): Skin | null {
  if (data.byteLength < HEADER_BYTES) return null;
  const view = new DataView(data);
  if (view.getUint8(0) !== PROTOCOL || view.getUint8(1) !== SKIN_KIND) return null;
  const length = view.getUint16(2, true);
  const n = view.getUint32(4, true);
  const m = view.getUint32(8, true);
  const names = JSON.parse(text.decode(new Uint8Array(data, HEADER_BYTES, length))) as string[];
  let at = HEADER_BYTES;
  const take = (bytes: number): number => {
    const here = at;
    at += (bytes + 3) & ~3;
    return here;
  };
  take(length);
  const bind = new Float32Array(data, take(names.length * POSE_BYTES), names.length * 7);
  const places = new Float32Array(data, take(12 * n), 3 * n);
  const bones = new Uint8Array(data, take(4 * n), 4 * n);
  const weights = new Uint8Array(data, take(4 * n), 4 * n);
  const colours = new Uint8Array(data, take(4 * n), 4 * n);
  const triangles = new Uint16Array(data, take(6 * m), 3 * m);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(places, 3));
  geometry.setAttribute("skinIndex", new BufferAttribute(bones, 4));
  geometry.setAttribute("skinWeight", new BufferAttribute(weights, 4, true));
  geometry.setAttribute("color", new BufferAttribute(linear(colours, n), 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute("normal", new BufferAttribute(normals(places, triangles), 3));
  return { names, geometry, inverses: names.map((_, i) => inverse(bind.subarray(7 * i))) };
}

/** A skin on the bodies of a scene, or null if the scene lacks them. */
export function wear(
  skin: Skin,
  bodies: Bone[],
  names: string[],
  material: Material,
): SkinnedMesh | null {
  const bones = skin.names.map((name) => bodies[names.indexOf(name)]);
  if (bones.some((bone) => !bone)) return null;
  const mesh = new SkinnedMesh(skin.geometry, material);
  mesh.bind(new Skeleton(bones as Bone[], skin.inverses), new Matrix4());
  mesh.frustumCulled = false;
  // Otherwise three.js poses every vertex on the processor, only to sort the scene by distance.
  mesh.boundingSphere = new Sphere();
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

function inverse(pose: Float32Array): Matrix4 {
  const [x = 0, y = 0, z = 0, w = 1, i = 0, j = 0, k = 0] = pose;
  return new Matrix4()
    .compose(new Vector3(x, y, z), new Quaternion(i, j, k, w), new Vector3(1, 1, 1))
    .invert();
}

/** Linear colours from sRGB bytes, as three.js needs for vertices. */
function linear(colours: Uint8Array, n: number): Float32Array {
  const of = Float32Array.from({ length: 256 }, (_, byte) => new Color().setRGB(byte / 255, 0, 0, "srgb").r);
  const out = new Float32Array(3 * n);
  for (let i = 0; i < 3 * n; i++) out[i] = of[colours[i + Math.floor(i / 3)]!]!;
  return out;
}

/** Unit normals of vertices: means over their triangles, weighted by area. Plain numbers, as those of three.js take
 * several times as long, and a person waits for the first picture. */
function normals(places: Float32Array, triangles: Uint16Array): Float32Array {
  const out = new Float32Array(places.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t]!;
    const b = 3 * triangles[t + 1]!;
    const c = 3 * triangles[t + 2]!;
    const ux = places[b]! - places[a]!;
    const uy = places[b + 1]! - places[a + 1]!;
    const uz = places[b + 2]! - places[a + 2]!;
    const vx = places[c]! - places[a]!;
    const vy = places[c + 1]! - places[a + 1]!;
    const vz = places[c + 2]! - places[a + 2]!;
    for (let corner = 0; corner < 3; corner++) {
      const at = 3 * triangles[t + corner]!;
      out[at]! += uy * vz - uz * vy;
      out[at + 1]! += uz * vx - ux * vz;
      out[at + 2]! += ux * vy - uy * vx;
    }
  }
  for (let i = 0; i < out.length; i += 3) {
    const long = Math.hypot(out[i]!, out[i + 1]!, out[i + 2]!) || 1;
    out[i]! /= long;
    out[i + 1]! /= long;
    out[i + 2]! /= long;
  }
  return out;
}
