// "Lift and touch again": when a grip has failed; "use two fingers": when one is not enough. Doubt about the labels alone is a dashed ring: a player has
// nothing to do about it while the grip works.

import type { Frame } from "./frame";

/** s of simulated time for which a solid hand has to try: a computer that is behind real time moves objects as
 * late as it notes touches. */
const LASTS = 1.5;
/** m that the touches have to move meanwhile. */
const MOVED = 0.01;
/** m and rad by which an object that moves has moved, and progress that counts as some. */
const STIRRED = 0.002;
const TURNED = 0.035;
const GAINED = 0.01;
/** N on objects above which a finger presses. */
const PRESSES = 0.05;
/** Below this the labels are a guess. */
const SURE = 0.5;

type Place = readonly [number, number, number];

/** What a finger began with that is alone. */
interface Alone {
  id: number;
  at: number;
  progress: number;
  place: Place;
}

/** What a grip began with: places of its touches, and poses of the objects. */
interface Start {
  at: number;
  progress: number;
  fingers: Map<number, Place>;
  objects: Float32Array[];
}

export class FailedGrip {
  private start: Start | null = null;
  private alone: Alone | null = null;

  /** Id of the one finger with which a task that needs two gets nowhere; else null. */
  lone(frame: Frame, fewest: number): number | null {
    const { hands, progress, status, time: at } = frame.state;
    const contacts = hands.flatMap((hand) => hand.contacts.filter((c) => c.state === "active"));
    const [one] = contacts;
    const { alone } = this;
    if (status !== "running" || contacts.length !== 1 || fewest !== 2 || !one) this.alone = null;
    else if (alone?.id !== one.id || progress > alone.progress + GAINED)
      this.alone = { id: one.id, at, progress, place: one.position };
    else if (at - alone.at > LASTS && distance(one.position, alone.place) > MOVED) return one.id;
    return null;
  }

  /** True if a grip has failed: a solid hand whose labels are in doubt, or which presses on something, has moved
   * its touches, and neither an object nor the progress has moved.
   *
   * @param objects Rows of the objects among the frame's poses.
   */
  now(frame: Frame, objects: readonly number[]): boolean {
    const { hands, progress, status, time: at } = frame.state;
    const solid = hands.filter((hand) => hand.solid.length > 0);
    const contacts = solid.flatMap((hand) => hand.contacts.filter((c) => c.state === "active"));
    const doubtful = solid.some(
      (hand) => hand.probability < SURE || hand.contacts.some((c) => c.state === "active" && c.label === null),
    );
    const tried = doubtful || contacts.some((c) => c.force > PRESSES);
    if (status !== "running" || contacts.length < 2 || !tried) {
      this.start = null;
      return false;
    }
    const poses = objects.map((row) => frame.poses.slice(7 * row, 7 * row + 7));
    const { start } = this;
    const same = start !== null && contacts.every((c) => start.fingers.has(c.id));
    const gained = start !== null && progress > start.progress + GAINED;
    const earlier = start !== null && at < start.at;
    if (!same || gained || earlier || poses.some((pose, i) => stirred(start.objects[i]!, pose))) {
      const fingers = new Map(contacts.map((c) => [c.id, c.position]));
      this.start = { at, progress, fingers, objects: poses };
      return false;
    }
    const moved = contacts.every((c) => distance(c.position, start.fingers.get(c.id)!) > MOVED);
    return moved && at - start.at > LASTS;
  }
}

const distance = (a: Place, b: Place): number => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** True if a pose (position, quaternion) is another one than before. */
function stirred(before: Float32Array, now: Float32Array): boolean {
  const off = Math.hypot(now[0]! - before[0]!, now[1]! - before[1]!, now[2]! - before[2]!);
  let cosine = 0;
  for (let k = 3; k < 7; k++) cosine += now[k]! * before[k]!;
  return off > STIRRED || 2 * Math.acos(Math.min(Math.abs(cosine), 1)) > TURNED;
}
