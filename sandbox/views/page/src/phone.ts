// A screen too small for a hand: its owner looks on, or plays on a table that is smaller than a hand and
// does not count.

import { make } from "./dom";
import { currentScreen, shrink } from "./screen";
import type { Sheets } from "./sheet";
import { say } from "./words";

const CM_PER_INCH = 2.54;

export interface PhoneChoices {
  /** Looks on. */
  look(): void;
  /** Plays on a scaled table. */
  play(): void;
  /** Measures the screen, which may be larger than it seems. */
  measure(): void;
}

export function askPhone(sheets: Sheets, choices: PhoneChoices): void {
  const { px_per_in, width_px, height_px } = currentScreen();
  const [width, height] = [width_px / px_per_in, height_px / px_per_in];
  const size = {
    width_in: width.toFixed(1),
    height_in: height.toFixed(1),
    width_cm: (CM_PER_INCH * width).toFixed(1),
    height_cm: (CM_PER_INCH * height).toFixed(1),
  };
  const play = make("button", "button large primary", {
    text: say("phone_play"),
    onTap: () => {
      shrink();
      sheets.close();
      choices.play();
    },
  });
  const measure = make("button", "button", { text: say("measure_screen"), onTap: choices.measure });
  sheets.open(
    say("phone_title"),
    [
      make("p", "", { text: say("phone_how", size) }),
      make("p", "", { text: say("phone_unscored") }),
      make("div", "row", {}, play, measure),
    ],
    say("phone_look"),
    choices.look,
  );
}
