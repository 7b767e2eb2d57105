// CSS pixels per inch of this screen. Browsers do not report it, so it is guessed from the kind of
// device until the person calibrates it with a bank card.

import type { PageScreen } from "./protocol";
import { recall, remember } from "./storage";
import { tableRoom } from "./phone";

/** ISO/IEC 7810 ID-1: every bank card, in inches. */
export const CARD_WIDTH = 85.6 / 25.4;
export const CARD_HEIGHT = 53.98 / 25.4;
export const FEWEST = 60;
export const MOST = 320;
/** The least that the computer takes, in a browser that is zoomed a lot. */
const LEAST = 20;

const sides = (): number[] => [window.screen.width, window.screen.height].sort((a, b) => a - b);
/** Another one after the browser was zoomed, and on another monitor. */
const key = (): string => `px-per-inch:${sides().join("x")}@${window.devicePixelRatio}`;

export const touchable = navigator.maxTouchPoints > 0;

/** An iPad calls itself a Macintosh, but no Macintosh has a touch screen. */
export const ipad =
  /iPad/.test(navigator.userAgent) || (/Macintosh/.test(navigator.userAgent) && touchable);

function guess(): number {
  const [short = 768] = sides();
  if (ipad) return short === 744 ? 163 : 132;
  if (touchable && short < 600) return 155;
  if (touchable) return 140;
  return 110;
}

/** The number that was measured last, for which pixels, and device pixels in one of them. */
let measured: { value: number; of: string; ratio: number } | null = null;
let looked = "";

/** The number that was measured for the pixels as they are now, or null. */
function here(): number | null {
  const now = key();
  if (now !== looked) {
    looked = now;
    const value = Number(recall(now));
    if (value >= FEWEST && value <= MOST)
      measured = { value, of: now, ratio: window.devicePixelRatio };
  }
  return measured?.of === now ? measured.value : null;
}

/** What is known of the pixels before: right if the browser was zoomed, and a guess on another monitor. */
const converted = (): number | null =>
  measured && Math.min(Math.max((measured.value * measured.ratio) / window.devicePixelRatio, LEAST), MOST);

export const calibrated = (): boolean => here() !== null;
export const pxPerInch = (): number => here() ?? converted() ?? guess();

export function calibrate(value: number): void {
  looked = key();
  measured = {
    value: Math.min(Math.max(value, FEWEST), MOST),
    of: looked,
    ratio: window.devicePixelRatio,
  };
  remember(looked, String(measured.value));
}

/** Tells when a CSS pixel has another size: the browser was zoomed, or has gone to another monitor. */
export function onOtherPixels(tell: () => void): void {
  const same = matchMedia(`(resolution: ${window.devicePixelRatio}dppx)`);
  const changed = (): void => {
    tell();
    onOtherPixels(tell);
  };
  same.addEventListener("change", changed, { once: true });
}

/** Why the table fills the page: with a mouse size means nothing, and a phone is too small. */
function fit(): PageScreen["fit"] & string {
  if (document.documentElement.dataset["study"] === "yes") return "";
  if (!touchable) return "mouse";
  return small() ? "phone" : "";
}

/** The page's part for the table: all of it, save on a phone. */
export function currentScreen(): PageScreen {
  const { innerWidth, innerHeight } = window;
  const why = fit();
  const phone = why === "phone" ? tableRoom(innerWidth, innerHeight) : null;
  return {
    px_per_in: pxPerInch(),
    width_px: phone?.width ?? innerWidth,
    height_px: phone?.height ?? innerHeight,
    calibrated: calibrated(),
    fit: why,
  };
}

/** True if the table is laid as on a phone. */
export const isPhone = (): boolean => fit() === "phone";

/** True if the screen is too small for a hand: less than about 9 cm on the short side. */
const small = (): boolean =>
  Math.min(window.innerWidth, window.innerHeight) / pxPerInch() < 3.6;
