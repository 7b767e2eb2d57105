// Advice before play: an iPad reserves gestures of four fingers, and a phone is small. Each advice is
// shown once.

import { make } from "./dom";
import { recall, remember } from "./memory";
import { currentScreen, ipad, small, touchable } from "./screen";
import type { Sheets } from "./sheet";
import { say } from "./words";

/** @param done Called when all advice has been read, or none is needed. */
export function advise(sheets: Sheets, done: () => void): void {
  if (!touchable || recall("advised") === "yes") {
    done();
    return;
  }
  const lines: string[] = [];
  if (ipad)
    lines.push(say("advice_ipad_gestures"), say("advice_ipad_lock"));
  else lines.push(say("advice_gestures"));
  if (small() && currentScreen().fit === "") lines.push(say("advice_small"));
  sheets.open(
    say("advice_title"),
    [make("ul", "", {}, ...lines.map((text) => make("li", "", { text })))],
    say("advice_go_on"),
    () => {
      remember("advised", "yes");
      done();
    },
  );
}
