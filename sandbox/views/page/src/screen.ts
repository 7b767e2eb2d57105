// CSS pixels per inch of this screen. Browsers do not report it, so it is guessed from the kind of
// device until the person calibrates it with a bank card.

import type { PageScreen } from "./protocol";
import { recall, recallHere, remember, rememberHere } from "./memory";

/** ISO/IEC 7810 ID-1: every bank card, in inches. */
export const CARD_WIDTH = 85.6 / 25.4;
export const CARD_HEIGHT = 53.98 / 25.4;
export const FEWEST = 60;
export const MOST = 320;

const sides = [window.screen.width, window.screen.height].sort((a, b) => a - b);
const key = `px-per-inch:${sides.join("x")}@${window.devicePixelRatio}`;

export const touchable = navigator.maxTouchPoints > 0;

/** An iPad calls itself a Macintosh, but no Macintosh has a touch screen. */
export const ipad =
  /iPad/.test(navigator.userAgent) || (/Macintosh/.test(navigator.userAgent) && touchable);

function guess(): number {
  const [short = 768] = sides;
  if (ipad) return short === 744 ? 163 : 132;
  if (touchable && short < 600) return 155;
  if (touchable) return 140;
  return 110;
}

function stored(): number | null {
  const value = Number(recall(key));
  return value >= FEWEST && value <= MOST ? value : null;
}

let measured = stored();

export const calibrated = (): boolean => measured !== null;
export const pxPerInch = (): number => measured ?? guess();

export function calibrate(value: number): void {
  measured = Math.min(Math.max(value, FEWEST), MOST);
  remember(key, String(measured));
}

const SHRUNK = "shrunk";

/** The person plays on a table that fits this small screen, until the tab is closed. */
export const shrink = (): void => rememberHere(SHRUNK, "yes");

/** Why the table fills the page: with a mouse size means nothing, and a phone is too small. */
function fit(): PageScreen["fit"] & string {
  if (document.documentElement.dataset["study"] === "yes") return "";
  if (!touchable) return "mouse";
  return small() && recallHere(SHRUNK) === "yes" ? "phone" : "";
}

export function currentScreen(): PageScreen {
  return {
    px_per_in: pxPerInch(),
    width_px: window.innerWidth,
    height_px: window.innerHeight,
    calibrated: calibrated(),
    fit: fit(),
  };
}

/** True if the screen is too small for a hand: less than about 9 cm on the short side. */
export const small = (): boolean =>
  Math.min(window.innerWidth, window.innerHeight) / pxPerInch() < 3.6;
