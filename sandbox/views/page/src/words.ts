// Everything the page says, from one file a language (sandbox/words).

import ar from "../../../words/ar.json";
import de from "../../../words/de.json";
import en from "../../../words/en.json";
import es from "../../../words/es.json";
import fr from "../../../words/fr.json";
import ja from "../../../words/ja.json";
import zh from "../../../words/zh.json";
import { announce, base } from "./language";
import type { Localised } from "./protocol";

type Groups = Pick<typeof en, "page" | "headset" | "play" | "study" | "tasks" | "missing" | "notices">;
type Keys<G> = G extends unknown ? keyof G : never;
/** Name of a sentence. */
export type Key = Keys<Groups[keyof Groups]>;
type Value = string | string[];

interface File extends Groups {
  name: string;
  status: string;
}

/** In the order of the menu. */
export const FILES: Record<string, File> = { en, de, fr, es, zh, ja, ar };

const allOf = (file: File): Record<string, string> => ({
  ...file.page,
  ...file.headset,
  ...file.play,
  ...file.study,
  ...file.tasks,
  ...file.missing,
  ...file.notices,
});
const NUMBER = /^-?\d+(\.\d+)?$/;

let words: Record<string, string> = {};
/** Formats of numbers by their decimals. */
const numbers = new Map<number, Intl.NumberFormat>();
let several = new Intl.ListFormat();
/** By ISO 639-1, as the browser takes it. */
export let language = "";

/** Begins to speak a language.
 *
 * @param own Sentences of a study's design, which replace the page's or are in another language.
 */
export function speak(code: string, own: Record<string, string> = {}): void {
  language = [code, base(code)].find(isTag) ?? "en";
  announce(language);
  words = { ...allOf(en), ...allOf(FILES[base(code)] ?? en), ...own };
  several = new Intl.ListFormat(language, { type: "unit", style: "short" });
  numbers.clear();
}

/** True for a language that browsers take; they throw an error for `pt_BR`, and for none. */
function isTag(code: string): boolean {
  try {
    return Intl.getCanonicalLocales(code).length > 0;
  } catch (error) {
    if (error instanceof RangeError) return false;
    throw error;
  }
}

/** A sentence of the page. */
export const say = (key: Key, values: Record<string, Value> = {}): string =>
  fill(words[key] ?? "", values);

/** A sentence of the computer: in the page's language where that has it, else in English. */
export const repeat = ({ key, values, text }: Localised): string =>
  key in words ? fill(words[key]!, values) : text;

/** Words one after another. */
export const listed = (some: string[]): string => several.format(some);

/** A word whose name is made at run time, or what stands in for it. */
export const word = (key: string, otherwise: string): string => words[key] ?? otherwise;

export const taskName = (task: string): string => {
  const plain = task.replace(/[-_]/g, " ");
  return word(`task_${task}`, plain.charAt(0).toUpperCase() + plain.slice(1));
};

function fill(sentence: string, values: Record<string, Value>): string {
  return sentence.replace(/\{(\w+)\}/g, (whole, name: string) => {
    const value = values[name];
    if (value === undefined) return whole;
    if (typeof value === "string") return called(name, value);
    return several.format(value.map((one) => called(name, one)));
  });
}

/** A value in the page's language: a number, or a thing for which there is a word. */
function called(name: string, value: string): string {
  if (NUMBER.test(value)) return decimals(value.split(".")[1]?.length ?? 0).format(Number(value));
  return name === "task" ? taskName(value) : word(`${name}_${value}`, value);
}

/** As many decimals as were given, so that a clock does not change its width. */
function decimals(digits: number): Intl.NumberFormat {
  let format = numbers.get(digits);
  if (!format) {
    format = new Intl.NumberFormat(language, {
      numberingSystem: "latn",
      useGrouping: false,
      minimumFractionDigits: digits,
      maximumFractionDigits: digits,
    });
    numbers.set(digits, format);
  }
  return format;
}

speak(document.documentElement.lang);
