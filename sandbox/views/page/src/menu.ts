// The menu of tasks, and that of languages.

import { make } from "./dom";
import { prefer } from "./language";
import type { TaskName } from "./protocol";
import type { Sheets } from "./sheet";
import { FILES, language, say, taskName, word } from "./words";

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

export function taskMenu(
  sheets: Sheets,
  tasks: TaskName[],
  current: string,
  choose: (task: string) => void,
  measure: () => void,
  switches: Switch[],
  reload: () => void,
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
      make("strong", "", { text: taskName(task.name) }),
      make("span", "", { text: word(`goal_${task.name}`, task.summary) }),
    );
    if (task.lift) button.append(make("em", "", { text: say("with_lift") }));
    return button;
  });
  const size = make("button", "choice", { onTap: measure });
  size.append(
    make("strong", "", { text: say("measure_screen") }),
    make("span", "", { text: say("measure_why") }),
  );
  const tongue = make("button", "choice", { onTap: () => languageMenu(sheets, reload) });
  // In all of them, as somebody who looks for it may not read this one.
  const names = make("span", "");
  for (const [code, { name }] of Object.entries(FILES)) {
    const own = make("bdi", "", { text: name });
    own.lang = code;
    names.append(...(names.firstChild ? [" · "] : []), own);
  }
  tongue.append(make("strong", "", { text: say("language") }), names);
  sheets.open(say("menu_title"), [
    make("div", "choices", {}, ...list, size, tongue, ...switches.map(switchOf)),
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
