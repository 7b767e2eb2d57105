// The language of the page: a study's, else the one in the link or chosen in the menu, else the browser's.

import { recall, recallHere, remember, rememberHere } from "./storage";

const KEPT = "language";
/** Languages that are written from right to left. */
const RIGHT_TO_LEFT = ["ar", "ckb", "dv", "fa", "he", "ps", "sd", "ug", "ur", "yi"];

/** `de` for `de-AT`, and for `de_AT`. */
export const base = (tag: string): string => tag.toLowerCase().split(/[-_]/)[0] ?? "";

/** Chooses a language with a file; to be called before the link is taken out of the address bar. */
export function choose(codes: readonly string[]): string {
  const asked = base(new URLSearchParams(location.search).get("lang") ?? "");
  if (codes.includes(asked)) rememberHere(KEPT, asked);
  const wanted = [recallHere(KEPT), recall(KEPT), ...navigator.languages];
  return wanted.map((tag) => base(tag ?? "")).find((code) => codes.includes(code)) ?? "en";
}

/** Keeps the choice of the person for this tab and for later ones. */
export function prefer(code: string): void {
  rememberHere(KEPT, code);
  remember(KEPT, code);
}

/** Tells the browser the page's language, on which fonts, voices and direction depend. */
export function announce(code: string): void {
  document.documentElement.lang = code;
  document.documentElement.dir = RIGHT_TO_LEFT.includes(base(code)) ? "rtl" : "ltr";
}
