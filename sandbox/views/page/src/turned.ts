// A page that was turned, or made smaller, while its trial runs: the table has no room on it any more.

import { make, show, write } from "./dom";
import { touchable } from "./screen";
import { say } from "./words";

export class Turned {
  readonly root: HTMLElement;
  private readonly words = make("p", "", { text: say(touchable ? "turned" : "window_smaller") });
  private readonly anew: HTMLButtonElement;

  /** @param again Asks for a new trial, laid for the page as it is now. */
  constructor(again: () => void) {
    this.anew = make("button", "button", { text: say("start_anew"), onTap: again });
    this.root = make("div", "turned", {}, this.words, this.anew);
    this.root.setAttribute("role", "alert");
    this.root.hidden = true;
  }

  get shown(): boolean {
    return !this.root.hidden;
  }

  /** @param inStudy True in a study, where nobody starts anew. */
  show(turned: boolean, inStudy: boolean): void {
    if (inStudy) write(this.words, say("turn_back"));
    show(this.anew, !inStudy);
    show(this.root, turned);
  }
}
