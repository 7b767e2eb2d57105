// The button for full screen, on every page that may be in full screen; iPhones have no such pages.

import { make, show } from "./dom";
import { say } from "./words";

/** What browsers have; Safari before 16.4 by names of its own. */
interface Whole {
  requestFullscreen?(options?: FullscreenOptions): Promise<void>;
  webkitRequestFullscreen?(): void;
}
interface Page {
  fullscreenElement?: Element | null;
  webkitFullscreenElement?: Element | null;
  exitFullscreen?(): Promise<void>;
  webkitExitFullscreen?(): void;
}

const page: Page = document;
const whole: Whole = document.documentElement;
const isFull = (): boolean => !!(page.fullscreenElement ?? page.webkitFullscreenElement);

export class FullScreen {
  readonly root: HTMLButtonElement;

  constructor() {
    this.root = make("button", "full", { onTap: () => this.toggle() });
    for (const event of ["fullscreenchange", "webkitfullscreenchange"])
      document.addEventListener(event, () => this.relabel());
    // An installed page fills the screen already.
    const possible = whole.requestFullscreen ?? whole.webkitRequestFullscreen;
    show(this.root, !!possible && !matchMedia("(display-mode: standalone)").matches);
    this.relabel();
  }

  /** Writes the label anew, also in a language that has come later. */
  relabel(): void {
    const words = say(isFull() ? "leave_full_screen" : "full_screen");
    this.root.setAttribute("aria-label", words);
    this.root.title = words;
    this.root.classList.toggle("is-full", isFull());
  }

  private toggle(): void {
    // A browser may refuse, as inside of another page.
    const ignore = (): void => undefined;
    if (isFull()) {
      if (page.exitFullscreen) page.exitFullscreen().catch(ignore);
      else page.webkitExitFullscreen?.();
    } else if (whole.requestFullscreen)
      whole.requestFullscreen({ navigationUI: "hide" }).catch(ignore);
    else whole.webkitRequestFullscreen?.();
  }
}
