// "Lift and touch again": when the computer does not know for a while which finger is which.

import type { State } from "./protocol";

/** Below this the labels are a guess. */
const SURE = 0.5;
/** ms that doubt has to last: labels settle while a hand comes down. */
const LASTS = 700;

export class Doubt {
  private since = 0;

  /** True if the person should be told, at a time in ms. */
  now(state: State, at: number): boolean {
    const doubtful = state.hands.some((hand) => {
      const active = hand.contacts.filter((c) => c.state === "active");
      return active.length > 1 && (hand.probability < SURE || active.some((c) => c.label === null));
    });
    if (!doubtful || !this.since) this.since = doubtful ? at : 0;
    return doubtful && at - this.since > LASTS;
  }
}
