// The menu of tasks.

import { make } from "./dom";
import { title } from "./hud";
import type { TaskName } from "./protocol";
import type { Sheets } from "./sheet";

export function taskMenu(
  sheets: Sheets,
  tasks: TaskName[],
  current: string,
  choose: (task: string) => void,
  measure: () => void,
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
      make("strong", "", { text: title(task.name) }),
      make("span", "", { text: task.summary }),
    );
    if (task.lift) button.append(make("em", "", { text: "with the lift control" }));
    return button;
  });
  const size = make("button", "choice", { onTap: measure });
  size.append(
    make("strong", "", { text: "Measure this screen" }),
    make("span", "", { text: "With a bank card, so that the hand has the size of yours." }),
  );
  sheets.open("What do you want to do?", [make("div", "choices", {}, ...list, size)]);
}
