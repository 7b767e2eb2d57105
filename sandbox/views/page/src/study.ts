// A study's sheets over the scene: consent, instructions, forms and breaks. Their contents come from
// the computer; answers are sent there at once, and are valid only after it has checked them.

import { make, show, write } from "./dom";
import { showForm } from "./zoom";
import { type Field, type Value, makeField } from "./form-fields";
import type { Leave, Refusal, Sheet, StudyView, Up } from "./protocol";
import { type Key, say, speak } from "./words";

/** CSS pixels between two questions, as in study.css. */
const GAP = 18;

export class Study {
  readonly root = make("section", "study");
  private sheet: Sheet | null = null;
  private fields: Field[] = [];
  private pages: Field[][] = [];
  private page = 0;
  private timer = 0;

  constructor(private readonly say: (up: Up) => boolean) {
    showForm(this.root, false);
    this.root.tabIndex = -1;
    this.root.setAttribute("role", "dialog");
  }

  /** True once the session is over, and the connection no longer needed. */
  get over(): boolean {
    return this.sheet?.kind === "end";
  }

  enter(view: StudyView): void {
    speak(view.language, view.words);
    document.body.classList.add("in-study");
  }

  lay(sheet: Sheet): void {
    const again = sheet.sheet === this.sheet?.sheet && sheet.kind === "form" && this.fields.length;
    this.sheet = sheet;
    if (again) {
      // The page has reconnected: what the computer did not receive is told again.
      for (const field of this.fields) {
        field.settle();
        const known = sheet.answers[field.item.name] ?? null;
        if (field.value !== known) this.answer(field.item.name, field.value);
      }
      return;
    }
    window.clearInterval(this.timer);
    this.fields = [];
    this.root.replaceChildren();
    showForm(this.root, sheet.kind !== "none");
    this.root.dataset["kind"] = sheet.kind;
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
    if (sheet.kind === "none") return;
    // A dialog has a name, also where a sheet is only a text.
    this.root.setAttribute("aria-label", sheet.title || (sheet.text.trim().split("\n")[0] ?? ""));
    this.root.focus({ preventScroll: true });
    this.root.scrollTop = 0;
    if (sheet.kind === "form") this.form(sheet);
    else if (sheet.kind === "rest") this.rest(sheet);
    else this.text(sheet);
  }

  refuse(refusal: Refusal): void {
    if (refusal.sheet !== this.sheet?.sheet) return;
    const field = this.fields.find((f) => f.item.name === refusal.item);
    if (!field) return;
    this.turn(this.pages.findIndex((page) => page.includes(field)));
    field.complain(refusal.text);
    field.root.scrollIntoView({ block: "center" });
  }

  // -- the kinds of sheets ----------------------------------------------------------------------

  private text(sheet: Sheet): void {
    const card = make("div", "page words-page", {}, ...paragraphs(sheet.text));
    const foot: HTMLElement[] = [];
    if (sheet.kind === "consent")
      foot.push(this.button("decline", "quiet", () => this.leave("no")),
                this.button("agree", "primary", () => this.leave("yes")));
    if (sheet.kind === "text" || sheet.kind === "task")
      foot.push(this.button("next", "primary", () => this.leave("done")));
    if (sheet.kind === "task") {
      if (sheet.picture) {
        const picture = make("img", "task-picture");
        picture.alt = sheet.title;
        picture.src = sheet.picture;
        card.prepend(picture);
      }
      if (sheet.title) card.prepend(make("h2", "", { text: sheet.title }));
      card.prepend(make("p", "faint", { text: sheet.note ?? "" }));
    }
    if (sheet.kind === "wait") card.prepend(make("div", "waiting", {}, ...[0, 1, 2].map(() => make("i", ""))));
    this.root.append(card);
    if (foot.length) this.root.append(make("footer", "foot", {}, ...foot));
  }

  private rest(sheet: Sheet): void {
    const clock = make("div", "rest-clock");
    const go = this.button("next", "primary", () => this.leave("done"));
    const words = make("p", "", { text: sheet.text });
    const until = performance.now() + 1000 * sheet.seconds;
    const count = (): void => {
      const left = Math.ceil((until - performance.now()) / 1000);
      const whole = Math.max(left, 0);
      write(clock, `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`);
      show(clock, left > 0);
      show(go, left <= 0);
      words.classList.toggle("faint", left > 0);
    };
    this.timer = window.setInterval(count, 200);
    const title = make("h2", "", { text: sheet.title });
    this.root.append(
      make("div", "page words-page", {}, title, clock, words),
      make("footer", "foot", {}, go),
    );
    count();
  }

  private form(sheet: Sheet): void {
    this.fields = sheet.items.map((item) => {
      const field = makeField(item, (value) => this.answer(item.name, value));
      field.put(sheet.answers[item.name] ?? null);
      return field;
    });
    const title = make("h2", "", { text: sheet.title });
    show(title, sheet.title !== "");
    const note = make("p", "wording", { text: sheet.note ?? "" });
    show(note, !!sheet.note);
    const list = make("div", "items");
    const bar = make("div", "form-bar", {}, make("i", ""));
    const back = this.button("back", "quiet", () => this.turn(this.page - 1));
    const next = this.button("next", "primary", () => this.next());
    back.classList.add("go-back");
    next.classList.add("go-on");
    this.root.append(
      make("div", "page form-page", {}, title, note, list),
      make("footer", "foot", {}, back, bar, next),
    );
    this.divide(list);
    const open = this.pages.findIndex((page) =>
      page.some((f) => !f.item.optional && f.value === null),
    );
    const started = this.fields.some((f) => f.value !== null);
    this.turn(!started ? 0 : open < 0 ? this.pages.length - 1 : open);
  }

  /** Splits the questions into pages that fit on the screen. */
  private divide(list: HTMLElement): void {
    list.append(...this.fields.map((f) => f.root));
    const foot = this.root.querySelector<HTMLElement>(".foot")!;
    // Of this element, and not of the window: on a large monitor it is zoomed.
    const room = this.root.clientHeight - list.offsetTop - foot.offsetHeight;
    this.pages = [];
    let height = Infinity;
    for (const field of this.fields) {
      const own = field.root.offsetHeight;
      if (height + own > room) {
        this.pages.push([]);
        height = 0;
      }
      this.pages[this.pages.length - 1]!.push(field);
      height += own + GAP;
    }
  }

  private turn(to: number): void {
    this.page = Math.min(Math.max(to, 0), this.pages.length - 1);
    const now = this.pages[this.page] ?? [];
    this.root.querySelector(".items")!.replaceChildren(...now.map((f) => f.root));
    this.root.scrollTop = 0;
    const last = this.page === this.pages.length - 1;
    show(this.root.querySelector<HTMLElement>(".go-back")!, this.page > 0);
    write(this.root.querySelector<HTMLElement>(".go-on")!, say(last ? "done" : "next"));
    const bar = this.root.querySelector<HTMLElement>(".form-bar")!;
    bar.style.visibility = this.pages.length > 1 ? "visible" : "hidden";
    const share = (this.page + 1) / this.pages.length;
    (bar.firstElementChild as HTMLElement).style.transform = `scaleX(${share})`;
  }

  private next(): void {
    for (const field of this.fields) field.settle();
    const open = (this.pages[this.page] ?? []).filter(
      (f) => f.wrong || (!f.item.optional && f.value === null),
    );
    for (const field of open) if (!field.wrong) field.complain(say("required"));
    if (open[0]) open[0].root.scrollIntoView({ block: "center" });
    else if (this.page < this.pages.length - 1) this.turn(this.page + 1);
    else this.leave("done");
  }

  // -- what goes to the computer ----------------------------------------------------------------

  private answer(item: string, value: Value): void {
    if (this.sheet) this.say({ type: "answer", sheet: this.sheet.sheet, item, value });
  }

  leave(how: Leave["how"]): void {
    if (this.sheet) this.say({ type: "leave", sheet: this.sheet.sheet, how });
  }

  private button(word: Key, kind: string, onTap: () => void): HTMLButtonElement {
    return make("button", `button large ${kind}`, { text: say(word), onTap });
  }
}

/** Makes paragraphs of a text, separated by empty lines; lines that begin with - become a list. */
function paragraphs(text: string): HTMLElement[] {
  return text
    .trim()
    .split(/\n\s*\n/)
    .map((part) => {
      const lines = part.split("\n").map((l) => l.trim());
      if (lines.every((l) => l.startsWith("- ")))
        return make("ul", "", {}, ...lines.map((l) => make("li", "", { text: l.slice(2) })));
      return make("p", "", { text: lines.join(" ") });
    });
}
