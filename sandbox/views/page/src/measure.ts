// Calibration of the screen's size: the person fits an outline to a bank card.

import { make, show, write } from "./dom";
import { knownDevices } from "./devices";
import { CARD_HEIGHT, CARD_WIDTH, FEWEST, MOST, calibrate, calibrated, pxPerInch } from "./screen";
import type { Sheets } from "./sheet";
import { say } from "./words";

/** CSS pixels beside the card. */
const MARGIN = 90;

const CM_PER_INCH = 2.54;

/** A length in both units; a language says one of them. */
const lengths = (name: string, inches: number): Record<string, string> => ({
  [`${name}_in`]: inches.toFixed(2),
  [`${name}_cm`]: (CM_PER_INCH * inches).toFixed(1),
});

/** @param done Called once the size is known, or the person has skipped the calibration. */
export function measureScreen(sheets: Sheets, done: () => void): void {
  let value = pxPerInch();
  const card = make("div", "card", {}, make("span", "", { text: say("card_here") }));
  const size = make("p", "quiet-words");
  const slider = make("input", "slider", { label: say("card_width") });
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
    write(size, say("card_page", { ...lengths("width", w), ...lengths("height", h) }));
  };
  // A guess that has not been compared with a card is no measurement.
  const adjust = (px: number): void => {
    fit(px);
    save.disabled = false;
  };
  slider.addEventListener("input", () => adjust(Number(slider.value)));
  const step = (text: string, label: string, by: number): HTMLElement =>
    make("button", "button step", { text, label, onTap: () => adjust(value + by) });
  fit(value);
  const save = make("button", "button large primary", {
    text: say("card_fits"),
    onTap: () => {
      calibrate(value);
      sheets.close();
      done();
    },
  });
  save.disabled = !calibrated();
  const devices = knownDevices();
  const choice = make("select", "devices", { label: say("device_is") });
  choice.append(make("option", "", { text: say("device_is") }));
  devices.forEach(({ name }, i) => {
    const option = make("option", "", { text: name });
    option.value = String(i);
    choice.append(option);
  });
  choice.addEventListener("change", () => {
    const device = choice.value === "" ? undefined : devices[Number(choice.value)];
    if (device) adjust(device.pxPerInch);
  });
  choice.firstElementChild!.setAttribute("value", "");
  show(choice, devices.length > 0);
  sheets.open(
    say("card_title"),
    [
      make("p", "", { text: say("card_how") }),
      choice,
      make(
        "div",
        "measure",
        {},
        card,
        make(
          "div",
          "measure-controls",
          {},
          make("div", "row", {}, step("−", say("card_smaller"), -0.5), slider, step("+", say("card_larger"), 0.5)),
          size,
          make("div", "row", {}, save),
        ),
      ),
    ],
    say("card_skip"),
    done,
    false,
  );
}
