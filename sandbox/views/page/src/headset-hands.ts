// The hands that a headset sees, or its controllers, as the computer gets them: in the world of the table.

import { Matrix4, Quaternion, Vector3 } from "three";
import type { HeldController, PageHands, SeenJoints } from "./protocol";

const NUMBERS = 16;
const PLACES = 5;

/** What the types of WebXR lack; see WebXR Hand Input, 3.4. */
interface Filling {
  fillPoses(spaces: Iterable<XRSpace>, base: XRSpace, transforms: Float32Array): boolean;
}

type Vector = [number, number, number];

/** Hands and controllers of one picture. */
export type Seen = Pick<PageHands, "hands" | "controllers"> & { hands: SeenJoints[]; controllers: HeldController[] };

export class Hands {
  private readonly toWorld = new Matrix4();
  private readonly matrix = new Matrix4();
  private readonly place = new Vector3();
  private readonly turn = new Quaternion();
  private readonly scale = new Vector3();
  private poses = new Float32Array(0);

  /**
   * @param frame The headset's picture.
   * @param space Space of the room.
   * @param table Where the table is in that space.
   */
  seen(frame: XRFrame, space: XRReferenceSpace, table: Matrix4): Seen {
    this.toWorld.copy(table).invert();
    const seen: Seen = { hands: [], controllers: [] };
    for (const source of frame.session.inputSources) {
      const side = source.handedness;
      if (side === "none") continue;
      if (source.hand) {
        const joints = this.joints(frame as XRFrame & Filling, space, source.hand);
        if (joints) seen.hands.push({ side, joints });
      } else if (source.gripSpace) {
        const held = this.held(frame, space, source, source.gripSpace, side);
        if (held) seen.controllers.push(held);
      }
    }
    return seen;
  }

  /** Places of the joints in WebXR's order; null if the headset knows none. */
  private joints(frame: XRFrame & Filling, space: XRReferenceSpace, hand: XRHand): (Vector | null)[] | null {
    const spaces = [...hand.values()];
    if (this.poses.length !== NUMBERS * spaces.length)
      this.poses = new Float32Array(NUMBERS * spaces.length);
    if (frame.fillPoses(spaces, space, this.poses))
      return spaces.map((_, i) => this.world(this.matrix.fromArray(this.poses, NUMBERS * i)));
    const joints = spaces.map((joint) => {
      const pose = frame.getJointPose!(joint, space);
      return pose ? this.world(this.matrix.fromArray(pose.transform.matrix)) : null;
    });
    return joints.some((joint) => joint) ? joints : null;
  }

  private held(
    frame: XRFrame,
    space: XRReferenceSpace,
    source: XRInputSource,
    grip: XRSpace,
    side: "left" | "right",
  ): HeldController | null {
    const pose = frame.getPose(grip, space);
    if (!pose) return null;
    const position = this.world(this.matrix.fromArray(pose.transform.matrix));
    this.matrix.decompose(this.place, this.turn, this.scale);
    const { w, x, y, z } = this.turn;
    const trigger = Math.min(Math.max(source.gamepad?.buttons[0]?.value ?? 0, 0), 1);
    return { side, position, quaternion: [w, x, y, z], trigger };
  }

  /** Moves `matrix` into the world of the table; its place there, m. */
  private world(matrix: Matrix4): Vector {
    matrix.premultiply(this.toWorld);
    const [x = 0, y = 0, z = 0] = matrix.elements.slice(12, 15).map((c) => Number(c.toFixed(PLACES)));
    return [x, y, z];
  }
}
