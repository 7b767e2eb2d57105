// Decodes a binary frame; the layout is in sandbox/server/page_frames.py.

import { FRAME_KIND, POSE_BYTES, PROTOCOL, type State } from "./protocol";

const HEADER_BYTES = 32;
const text = new TextDecoder();

export interface Frame {
  scene: number;
  number: number;
  /** Sequence number of the newest touch message that took effect in it. */
  touch: number;
  time: number;
  /** Seven numbers per body: position (m) and quaternion (w, x, y, z). */
  poses: Float32Array;
  state: State;
}

/** The frame in a message, or null if the message is not a frame of this protocol. */
export function parseFrame(data: ArrayBuffer): Frame | null {
  if (data.byteLength < HEADER_BYTES) return null;
  const view = new DataView(data);
  const bodies = view.getUint16(2, true);
  const length = view.getUint32(24, true);
  const tail = HEADER_BYTES + bodies * POSE_BYTES;
  if (view.getUint8(0) !== PROTOCOL || view.getUint8(1) !== FRAME_KIND) return null;
  if (data.byteLength !== tail + length) return null;
  return {
    scene: view.getUint32(4, true),
    number: view.getUint32(8, true),
    touch: view.getUint32(12, true),
    time: view.getFloat64(16, true),
    poses: new Float32Array(data, HEADER_BYTES, bodies * 7),
    state: JSON.parse(text.decode(new Uint8Array(data, tail, length))) as State,
  };
}
