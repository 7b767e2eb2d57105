// The same colours as in the window (sandbox/views/palette.py), or ones for colour-blind people: those of
// Masataka Okabe and Kei Ito, Color Universal Design (2008), https://jfly.uni-koeln.de/color/, with white in
// the place of black, as the table is dark.

import palettes from "./palettes.json";
import { recall, remember } from "./storage";
import { type Key, say } from "./words";

const FINGERS: Key[] = [
  "finger_thumb",
  "finger_index",
  "finger_middle",
  "finger_ring",
  "finger_little",
];

type Palette = keyof typeof palettes;
const KEPT = "colours";
const OTHER: Palette = "okabe-ito";

let chosen: Palette = recall(KEPT) === OTHER ? OTHER : "standard";
announce();

/** True if this device shows the colours for colour-blind people. */
export const forColourBlind = (): boolean => chosen === OTHER;

/** Keeps the other choice on this device; pictures have it from the next one on. */
export function toggleColours(): void {
  chosen = forColourBlind() ? "standard" : OTHER;
  remember(KEPT, chosen);
  announce();
}

/** The same colours for all participants of a study. */
export function standardColours(): void {
  chosen = "standard";
  announce();
}

/** Tells the style sheet. */
function announce(): void {
  document.documentElement.dataset["colours"] = chosen;
}

export const goalColour = (reached: boolean, held: boolean): string => {
  const { goal, reached: there, held: stayed } = palettes[chosen];
  return held ? stayed : reached ? there : goal;
};

export const UNKNOWN = "#9ea3a8";
export const OUTLINE = 0x9ebdcc;
export const SKIN = 0xe0b49a;
export const TABLE = 0x26333c;
export const BACKGROUND = 0x10161b;

export const fingerColour = (label: number | null): string =>
  label === null ? UNKNOWN : (palettes[chosen].fingers[label] ?? UNKNOWN);

export const fingerName = (label: number | null, sure = true): string => {
  const key = label === null ? undefined : FINGERS[label];
  if (key === undefined) return say("finger_unknown");
  return sure ? say(key) : say("finger_unsure", { name: say(key) });
};
