// The same colours as in the window (sandbox/views/palette.py).

import { type Key, say } from "./words";

const FINGERS: Key[] = [
  "finger_thumb",
  "finger_index",
  "finger_middle",
  "finger_ring",
  "finger_little",
];

export const FINGER_COLOURS = ["#ed73b3", "#f2991a", "#f5db40", "#59b8f2", "#9980f2"] as const;
export const UNKNOWN = "#9ea3a8";

export const GOAL = 0x33cc7a;
export const REACHED = 0x73fa8c;
export const HELD = 0xffd64d;
export const OUTLINE = 0x9ebdcc;
export const SKIN = 0xe0b49a;
export const TABLE = 0x26333c;
export const BACKGROUND = 0x10161b;

export const fingerColour = (label: number | null): string =>
  label === null ? UNKNOWN : (FINGER_COLOURS[label] ?? UNKNOWN);

export const fingerName = (label: number | null, sure = true): string => {
  const key = label === null ? undefined : FINGERS[label];
  if (key === undefined) return say("finger_unknown");
  return sure ? say(key) : say("finger_unsure", { name: say(key) });
};
