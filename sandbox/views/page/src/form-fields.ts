// The questions of a study's form: one field for every kind of item. A field has no value before the
// participant gives one.

import { make, show, write } from "./dom";
import type { ItemView } from "./protocol";
import { say } from "./words";

export type Value = string | number | null;

/** Largest number of positions at which a scale is shown as buttons; beyond it as a line. */
const MOST_BUTTONS = 11;
/** Largest number of positions at which a line has marks. */
const MOST_MARKS = 41;
/** ms after the last key until a text is sent. */
const TYPED_MS = 300;

export interface Field {
  readonly item: ItemView;
  readonly root: HTMLElement;
  readonly value: Value;
  /** True while something is shown to be wrong with the answer. */
  readonly wrong: boolean;
  /** Shows an earlier answer, without sending it. */
  put(value: Value): void;
  /** Shows what is wrong with the answer; an empty text means that it is valid. */
  complain(text: string): void;
  /** Sends what is still being typed. */
  settle(): void;
}

/** @param tell Called with every answer. */
export function makeField(
  item: ItemView,
  tell: (value: Value) => void,
): Field {
  const wrong = make("p", "wrong");
  show(wrong, false);
  let value: Value = null;
  const complain = (text: string): void => {
    // The place of the words stays once they were there, so that nothing moves under the finger.
    if (text !== "") {
      write(wrong, text);
      show(wrong, true);
    }
    wrong.classList.toggle("answered", text === "");
    root.classList.toggle("is-wrong", text !== "");
  };
  const give = (given: Value): void => {
    value = given;
    complain("");
    tell(given);
  };
  const control = CONTROLS[item.kind](item, give, complain);
  const ask = make("p", "ask", { text: item.ask });
  if (item.optional) ask.append(make("span", "optional", { text: ` (${say("optional")})` }));
  const root = make("div", `item item-${item.kind}`, {}, ask, control.root, wrong);
  return {
    item,
    root,
    get value() {
      return value;
    },
    get wrong() {
      return root.classList.contains("is-wrong");
    },
    put(given) {
      value = given;
      control.put(given);
    },
    complain,
    settle: () => control.settle?.(),
  };
}

interface Control {
  root: HTMLElement;
  put(value: Value): void;
  settle?(): void;
}

type Maker = (
  item: ItemView,
  give: (value: Value) => void,
  complain: (text: string) => void,
) => Control;

/** Buttons of which one is chosen; a second tap removes an optional answer. */
function buttons(
  name: string,
  item: ItemView,
  options: { value: Value; label: string }[],
  give: (value: Value) => void,
): Control {
  let chosen: Value = null;
  const all = options.map(({ value, label }) => {
    const button = make("button", "option", {
      text: label,
      onTap: () => {
        put(item.optional && chosen === value ? null : value);
        give(chosen);
      },
    });
    button.setAttribute("role", "radio");
    return button;
  });
  const put = (value: Value): void => {
    chosen = value;
    all.forEach((button, i) => {
      const on = options[i]!.value === value;
      button.classList.toggle("chosen", on);
      button.setAttribute("aria-checked", String(on));
    });
  };
  const root = make("div", name, { label: item.ask }, ...all);
  root.setAttribute("role", "radiogroup");
  put(null);
  return { root, put };
}

function ends(item: ItemView): HTMLElement {
  const row = make(
    "div",
    "ends",
    {},
    make("span", "", { text: item.low_means }),
    make("span", "", { text: item.high_means }),
  );
  show(row, item.low_means !== "" || item.high_means !== "");
  return row;
}

const steps = (item: ItemView): number => Math.floor((item.high - item.low) / item.step + 1e-9);
const at = (item: ItemView, step: number): number =>
  Number((item.low + step * item.step).toPrecision(12));

/** True where people read from right to left: a scale begins at the right, as its two ends say. */
const backwards = (): boolean => document.documentElement.dir === "rtl";

/** Digits as 0 to 9, however they are written where people type them. */
const plain = (typed: string): string =>
  typed
    .trim()
    .normalize("NFKC")
    .replace(/[٠-٩]/g, (digit) => String(digit.charCodeAt(0) - 0x660))
    .replace(/[۰-۹]/g, (digit) => String(digit.charCodeAt(0) - 0x6f0));

/** Three digits after a sign: 40,000 is forty in one country and forty thousand in the next. */
const AMBIGUOUS = /^[+-]?(?!0+[.,٫٬])\d{1,3}([.,٫٬]\d{3})+$/;

/** A number as people type it; NaN if it is none, or may mean two. */
function read(typed: string): number {
  const digits = plain(typed);
  return AMBIGUOUS.test(digits) ? NaN : Number(digits.replace(/[,٫]/, "."));
}

/** A line that can be touched anywhere; it has no mark before the first touch. */
function line(item: ItemView, give: (v: Value) => void): Control {
  const last = steps(item);
  const mark = make("div", "mark");
  const hint = make("span", "line-hint", { text: say("slide") });
  const track = make("div", "track", {}, hint);
  if (last < MOST_MARKS)
    for (let i = 0; i <= last; i++) {
      const tick = make("i", i % 5 === 0 || last <= 10 ? "tick long" : "tick");
      tick.style.insetInlineStart = `${(100 * i) / last}%`;
      track.append(tick);
    }
  track.append(mark);
  const root = make("div", "line", { label: item.ask }, track);
  root.tabIndex = 0;
  root.setAttribute("role", "slider");
  root.setAttribute("aria-valuemin", String(item.low));
  root.setAttribute("aria-valuemax", String(item.high));
  let step: number | null = null;
  let pointer: number | null = null;
  const draw = (): void => {
    show(mark, step !== null);
    show(hint, step === null);
    if (step === null) return;
    mark.style.insetInlineStart = `${(100 * step) / last}%`;
    root.setAttribute("aria-valuenow", String(at(item, step)));
  };
  const follow = (event: PointerEvent): void => {
    const box = track.getBoundingClientRect();
    const along = backwards() ? box.right - event.clientX : event.clientX - box.left;
    const share = Math.min(Math.max(along / box.width, 0), 1);
    step = Math.round(share * last);
    draw();
  };
  root.addEventListener("pointerdown", (event) => {
    if (pointer !== null) return;
    pointer = event.pointerId;
    follow(event);
  });
  window.addEventListener("pointermove", (event) => {
    if (event.pointerId === pointer && root.isConnected) follow(event);
  });
  for (const end of ["pointerup", "pointercancel"] as const)
    window.addEventListener(end, (event) => {
      if (event.pointerId !== pointer) return;
      pointer = null;
      if (step !== null && root.isConnected) give(at(item, step));
    });
  root.addEventListener("keydown", (event) => {
    const right = backwards() ? -1 : 1;
    const keys = { ArrowRight: right, ArrowUp: 1, ArrowLeft: -right, ArrowDown: -1 };
    const by = keys[event.key as keyof typeof keys];
    if (!by) return;
    event.preventDefault();
    step = step === null ? 0 : Math.min(Math.max(step + by, 0), last);
    draw();
    give(at(item, step));
  });
  draw();
  return {
    root: make("div", "", {}, root, ends(item)),
    put(value) {
      step = typeof value === "number" ? Math.round((value - item.low) / item.step) : null;
      draw();
    },
  };
}

function scale(item: ItemView, give: (v: Value) => void): Control {
  const last = steps(item);
  if (last >= MOST_BUTTONS) return line(item, give);
  const options = Array.from({ length: last + 1 }, (_, i) => at(item, i)).map((value) => ({
    value,
    label: String(value),
  }));
  const row = buttons("points", item, options, give);
  return { root: make("div", "", {}, row.root, ends(item)), put: row.put };
}

function written(
  input: HTMLInputElement | HTMLTextAreaElement,
  read: (text: string) => void,
): Control {
  let timer = 0;
  const now = (): void => {
    if (!timer) return;
    window.clearTimeout(timer);
    timer = 0;
    read(input.value);
  };
  input.addEventListener("input", () => {
    window.clearTimeout(timer);
    timer = window.setTimeout(now, TYPED_MS);
  });
  input.addEventListener("blur", now);
  return {
    root: input,
    put(value) {
      if (document.activeElement !== input) input.value = value === null ? "" : String(value);
    },
    settle: now,
  };
}

const CONTROLS: Record<ItemView["kind"], Maker> = {
  choice: (item, give) => buttons("options", item, item.choices, give),
  scale,
  number(item, give, complain) {
    const input = make("input", "entry short", { label: item.ask });
    input.inputMode = "decimal";
    input.autocomplete = "off";
    input.placeholder = `${item.low} – ${item.high}`;
    return written(input, (text) => {
      const value = text.trim() === "" ? null : read(text);
      if (value === null || (value >= item.low && value <= item.high)) return give(value);
      give(null);
      const [low, high] = [String(item.low), String(item.high)];
      complain(say("number", { low, high }));
    });
  },
  text(item, give) {
    const input = make("textarea", "entry", { label: item.ask });
    input.rows = 3;
    input.maxLength = 2000;
    input.placeholder = say("write");
    return written(input, (text) => give(text.trim() === "" ? null : text));
  },
};
