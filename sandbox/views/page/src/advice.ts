// Advice before play: an iPad reserves gestures of four fingers, and a phone is small. Each advice is
// shown once.

import { make } from "./dom";
import { recall, remember } from "./memory";
import { ipad, small, touchable } from "./screen";
import type { Sheets } from "./sheet";

/** @param done Called when all advice has been read, or none is needed. */
export function advise(sheets: Sheets, done: () => void): void {
  if (!touchable || recall("advised") === "yes") {
    done();
    return;
  }
  const lines: string[] = [];
  if (ipad)
    lines.push(
      "Settings, Multitasking & Gestures: switch off Four & Five Finger Gestures. Else the iPad " +
        "takes your fingers away in the middle of a task.",
      "Settings, Display & Brightness: set Auto-Lock to Never while you play.",
    );
  else lines.push("Switch off gestures of three or more fingers, if your device has any.");
  if (small())
    lines.push("This screen is small for your hand: a tablet or a laptop has room for all tasks.");
  sheets.open(
    "Before you play",
    [make("ul", "", {}, ...lines.map((text) => make("li", "", { text })))],
    "Go on",
    () => {
      remember("advised", "yes");
      done();
    },
  );
}
