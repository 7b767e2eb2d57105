// The menu of tasks, and the settings of this device.

import { fingerName } from "./colours";
import { make } from "./dom";
import { handPicture } from "./hand-picture";
import { prefer } from "./language";
import type { TaskName } from "./protocol";
import { fileAddress } from "./page-address";
import { done } from "./records";
import type { Sheets } from "./sheet";
import { FILES, language, listed, say, taskName, word } from "./words";

/** Something that is on or off on this device. */
export interface Switch {
  name: string;
  why: string;
  on(): boolean;
  toggle(): void;
}

function switchOf({ name, why, on, toggle }: Switch): HTMLElement {
  const state = make("em", "");
  const button = make("button", "choice", {
    onTap: () => {
      toggle();
      tell();
    },
  });
  const tell = (): void => {
    state.textContent = say(on() ? "on" : "off");
    button.setAttribute("aria-checked", String(on()));
  };
  button.setAttribute("role", "switch");
  button.append(make("strong", "", { text: name }), make("span", "", { text: why }), state);
  tell();
  return button;
}

/** The tasks in the order of their difficulty, with a tick and the best time at those that were done. */
export function taskMenu(
  sheets: Sheets,
  tasks: TaskName[],
  current: string,
  choose: (task: string) => void,
): void {
  const list = tasks.map((task) => {
    const button = make("button", "choice", {
      onTap: () => {
        sheets.close();
        choose(task.name);
      },
    });
    if (task.name === current) button.classList.add("current");
    button.append(
      picture(task.name),
      make("strong", "", { text: taskName(task.name) }),
      make("span", "", { text: word(`goal_${task.name}`, task.summary) }),
    );
    if (task.lift) button.append(make("em", "", { text: say("with_lift") }));
    const time = done(task.name);
    if (time !== null) button.append(make("b", "", { text: say("done_in", { time: time.toFixed(1) }) }));
    return button;
  });
  sheets.open(say("menu_title"), [
    make("p", "quiet-words", { text: say("menu_order") }),
    make("div", "choices", {}, ...list),
  ]);
}

/** A picture of a task, loaded when it is to be seen; none for a task that has none. */
function picture(task: string): HTMLElement {
  const image = make("img", "menu-picture");
  image.alt = "";
  image.loading = "lazy";
  image.addEventListener("error", () => image.remove());
  image.src = fileAddress(`pictures/${encodeURIComponent(task)}.webp`);
  return image;
}

/** Sets of fingers that a player may choose, as in the program's settings; empty for any. */
const FINGER_SETS = ["", "thumb+index", "thumb+index+middle", "thumb+index+middle+ring+little"];
const FINGERS = ["thumb", "index", "middle", "ring", "little"];

function fingersMenu(sheets: Sheets, settings: Settings): void {
  const list = FINGER_SETS.map((set) => {
    const fingers = set ? set.split("+").map((name) => FINGERS.indexOf(name)) : [0, 1, 2, 3, 4];
    const some = fingers.map((label) => fingerName(label));
    const text = !set ? say("fingers_any") : some.length < 5 ? listed(some) : say("fingers_all");
    const button = make("button", "choice with-picture", {
      onTap: () => {
        sheets.close();
        settings.useFingers(set);
      },
    });
    if (set === settings.fingers) button.classList.add("current");
    button.append(handPicture(new Set(set ? fingers : []), settings.hand), make("strong", "", { text }));
    return button;
  });
  sheets.open(say("fingers_used"), [
    make("p", "quiet-words", { text: say("fingers_why") }),
    make("div", "choices", {}, ...list),
  ]);
}

/** What belongs to this device and to its person. */
export interface Settings {
  hand: "right" | "left";
  otherHand(): void;
  /** Sets of fingers that the player uses; null if they cannot be chosen. */
  fingers: string | null;
  useFingers(sets: string): void;
  measure(): void;
  lookOn(): void;
  reload(): void;
  switches: Switch[];
  /** The time from a touch to its picture, or to the computer and back. */
  delay: string;
}

export function settingsMenu(sheets: Sheets, settings: Settings): void {
  const choice = (name: string, more: HTMLElement, onTap: () => void): HTMLElement => {
    const button = make("button", "choice", { onTap });
    button.append(make("strong", "", { text: name }), more);
    return button;
  };
  const explained = (text: string): HTMLElement => make("span", "", { text });
  const other = settings.hand === "right" ? "left_hand" : "right_hand";
  const hand = choice(
    say(settings.hand === "right" ? "right_hand" : "left_hand"),
    explained(say("change_hand", { hand: say(other) })),
    () => {
      sheets.close();
      settings.otherHand();
    },
  );
  // In all of them, as somebody who looks for it may not read this one.
  const names = make("span", "");
  for (const [code, { name }] of Object.entries(FILES)) {
    const own = make("bdi", "", { text: name });
    own.lang = code;
    names.append(...(names.firstChild ? [" · "] : []), own);
  }
  sheets.open(say("settings"), [
    make(
      "div",
      "choices",
      {},
      choice(say("language"), names, () => languageMenu(sheets, settings.reload)),
      hand,
      ...(settings.fingers === null
        ? []
        : [choice(say("fingers_used"), explained(say("fingers_why")), () => fingersMenu(sheets, settings))]),
      choice(say("measure_screen"), explained(say("measure_why")), settings.measure),
      ...settings.switches.map(switchOf),
      choice(say("look_on"), explained(say("look_on_why")), settings.lookOn),
    ),
    make("p", "quiet-words", { text: settings.delay }),
  ]);
}

function languageMenu(sheets: Sheets, reload: () => void): void {
  const list = Object.entries(FILES).map(([code, file]) => {
    const button = make("button", "choice", {
      onTap: () => {
        prefer(code);
        reload();
      },
    });
    button.lang = code;
    button.dir = "auto";
    if (code === language) button.classList.add("current");
    button.append(make("strong", "", { text: file.name }));
    if (file.status.startsWith("not")) button.append(make("span", "", { text: file.play.unread }));
    return button;
  });
  sheets.open(say("language"), [make("div", "choices", {}, ...list)]);
}
