// A page that was turned, or made smaller, while its trial runs: the table has no room on it any more. Or
// one that is zoomed: nothing on the table has its true size.

import { make, show, write } from "./dom";
import { touchable } from "./screen";
import { say } from "./words";

/** Why nobody can play on the table as it is shown. */
export type Hindrance = "" | "turned" | "zoomed";

export class Turned {
  readonly root: HTMLElement;
  private readonly words = make("p", "");
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
  show(why: Hindrance, inStudy: boolean): void {
    const smaller = touchable ? "turned" : "window_smaller";
    const turned = inStudy ? "turn_back" : smaller;
    if (why) write(this.words, say(why === "zoomed" ? why : turned));
    show(this.anew, !inStudy && why === "turned");
    show(this.root, why !== "");
    this.stand(why === "zoomed");
  }

  /** On a zoomed page, in the part that is seen, at its usual size. */
  private stand(zoomed: boolean): void {
    const { style } = this.root;
    const view = zoomed ? window.visualViewport : null;
    style.left = view ? `${view.offsetLeft + view.width / 2}px` : "";
    style.top = view ? `${view.offsetTop + 0.46 * view.height}px` : "";
    style.transformOrigin = view ? "top" : "";
    style.transform = view ? `translateX(-50%) scale(${1 / view.scale})` : "";
  }
}
