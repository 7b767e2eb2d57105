// Calibration of the screen's size: the person fits an outline to a bank card.

import { make, write } from "./dom";
import { CARD_HEIGHT, CARD_WIDTH, FEWEST, MOST, calibrate, pxPerInch } from "./screen";
import type { Sheets } from "./sheet";

/** CSS pixels beside the card. */
const MARGIN = 90;

/** @param done Called once the size is known, or the person has skipped the calibration. */
export function measureScreen(sheets: Sheets, done: () => void): void {
  let value = pxPerInch();
  const card = make("div", "card", {}, make("span", "", { text: "your card" }));
  const inches = make("p", "quiet-words");
  const slider = make("input", "slider", { label: "Width of the card" });
  slider.type = "range";
  slider.min = String(FEWEST);
  slider.max = String(MOST);
  slider.step = "0.25";
  const fit = (px: number): void => {
    value = Math.min(Math.max(px, FEWEST), MOST);
    slider.value = String(value);
    // If the card does not fit in landscape, it is shown in portrait.
    const lies = CARD_WIDTH * value < window.innerWidth - MARGIN;
    card.style.width = `${(lies ? CARD_WIDTH : CARD_HEIGHT) * value}px`;
    card.style.height = `${(lies ? CARD_HEIGHT : CARD_WIDTH) * value}px`;
    const [w, h] = [window.innerWidth / value, window.innerHeight / value];
    write(inches, `This page is then ${w.toFixed(2)} by ${h.toFixed(2)} inches.`);
  };
  slider.addEventListener("input", () => fit(Number(slider.value)));
  const step = (text: string, by: number): HTMLElement =>
    make("button", "button step", { text, onTap: () => fit(value + by) });
  fit(value);
  const save = make("button", "button large primary", {
    text: "It fits",
    onTap: () => {
      calibrate(value);
      sheets.close();
      done();
    },
  });
  sheets.open(
    "How large is this screen?",
    [
      make("p", "", {
        text: "Hold a bank card to the screen and move the slider until the outline is as large.",
      }),
      make(
        "div",
        "measure",
        {},
        card,
        make(
          "div",
          "measure-controls",
          {},
          make("div", "row", {}, step("−", -0.5), slider, step("+", 0.5)),
          inches,
          make("div", "row", {}, save),
        ),
      ),
    ],
    "Skip: guess the size",
    done,
  );
}
