// What a person has done on this device: the best time of every task, on tables of true size and on scaled
// ones, whose results do not count.

import { recall, remember } from "./storage";

const key = (task: string, scored: boolean): string => `${scored ? "best" : "best-scaled"}:${task}`;

/** s, best time of a task; null before the first success. */
export function best(task: string, scored: boolean): number | null {
  const time = Number(recall(key(task, scored)) ?? NaN);
  return time > 0 ? time : null;
}

/** s, best time of a task that was done, on any table; null before. */
export const done = (task: string): number | null => best(task, true) ?? best(task, false);

/** Notes a success after some s. */
export function note(task: string, scored: boolean, time: number): void {
  const before = best(task, scored);
  if (before === null || time < before) remember(key(task, scored), time.toFixed(2));
}

/** The task to play after another one: the next that was not done yet, else the next. Tasks are in the order of
 * their difficulty. */
export function following(tasks: readonly string[], task: string): string | null {
  const at = tasks.indexOf(task);
  const later = [...tasks.slice(at + 1), ...tasks.slice(0, Math.max(at, 0))];
  return later.find((name) => done(name) === null) ?? later[0] ?? null;
}
