// The page: creates its parts and connects them.

import { advise } from "./advice";
import { Connection } from "./connection";
import { make, show } from "./dom";
import { Doubt } from "./doubt";
import { type Change, type Finger, Fingers } from "./fingers";
import type { Frame } from "./frame";
import { Hint } from "./hint";
import { Hud } from "./hud";
import { touchRectangle } from "./lens";
import { Lift } from "./lift";
import { reload, spectator } from "./link";
import { measureScreen } from "./measure";
import { taskMenu } from "./menu";
import type { PlayerRequest, SceneMessage, StudyView, TaskName } from "./protocol";
import { type Ring, Rings } from "./rings";
import { calibrated, currentScreen, pxPerInch, touchable } from "./screen";
import { Sender } from "./sender";
import { Sheets } from "./sheet";
import { Sound } from "./sound";
import { Study } from "./study";
import { Stage } from "./stage";

/** ms between two reports of the latency from touch to picture. */
const REPORT_MS = 100;
/** ms within which a new scene counts as the substitute for one that is not available. */
const REFUSED_MS = 1000;
/** Share by which the page's size has to change before the trial is restarted with a new layout. */
const CHANGED = 0.08;

class Page {
  private readonly stage: Stage;
  private readonly rings: Rings;
  private readonly hud: Hud;
  private readonly sheets: Sheets;
  private readonly connection: Connection;
  private readonly sender: Sender;
  private readonly sound = new Sound();
  private readonly hint = new Hint();
  private readonly lift: Lift;
  private readonly doubt = new Doubt();
  private readonly study = new Study((up) => this.connection.say(up));
  private readonly again = make("div", "lift-again", { text: "Lift your fingers and touch again" });
  private readonly trouble = make("div", "trouble");
  private readonly curtain = make("div", "curtain", { text: "The screen is elsewhere now" });

  private glass: Fingers | null = null;
  private player = false;
  /** True if the player's touches drive a hand; otherwise another device does. */
  private counts = true;
  /** ms, time at which a scene was last not available. */
  private troubled = -Infinity;
  private inStudy: StudyView | null = null;
  private tasks: TaskName[] = [];
  private scene: SceneMessage | null = null;
  private frame: Frame | null = null;
  private fingers: Finger[] = [];
  private dirty = true;
  private reported = 0;
  private pressed = new Set<string>();
  private wasHeld = false;
  private laidOut = currentScreen();
  private asked = false;
  private settling = 0;

  constructor() {
    const scene = make("canvas", "scene");
    const overlay = make("canvas", "rings");
    const glass = make("div", "glass");
    document.body.append(scene, overlay, glass);
    this.stage = new Stage(scene, reload);
    this.rings = new Rings(overlay);
    this.hud = new Hud({
      again: () => this.ask("retry"),
      tasks: () => this.openTasks(),
      hand: () => this.ask("hand", this.scene?.hand === "right" ? "left" : "right"),
      sound: () => this.hud.setSound(this.sound.toggle()),
      settings: () => this.measure(),
    });
    this.hud.setSound(this.sound.muted);
    this.lift = new Lift((value) => this.sender.setLift(value));
    document.body.append(
      this.hud.root,
      this.lift.root,
      this.hint.root,
      this.again,
      this.trouble,
      this.study.root,
      this.curtain,
    );
    this.sheets = new Sheets(document.body, (open) => this.ask(open ? "pause" : "resume"));
    // Menus are shown or hidden only once the computer has sent its first message.
    for (const element of [this.again, this.trouble, this.curtain, this.hud.root])
      show(element, false);

    this.connection = new Connection({
      onCondition: (condition, words) => {
        this.hud.setConnection(condition, words);
        if (condition !== "open") this.glass?.cancelAll();
        const told = this.inStudy?.words[condition === "ended" ? "ended" : "lost"];
        this.curtain.textContent = told ?? words;
        const shut = condition === "ended" || condition === "lost";
        show(this.curtain, (shut || (!!told && condition !== "open")) && !this.study.over);
      },
      onWelcome: (welcome) => {
        this.tasks = welcome.tasks;
        if (welcome.study) this.enterStudy(welcome.study);
        show(this.hud.root, true);
        this.player = welcome.role === "player";
        this.counts = welcome.touch ?? true;
        this.sender.active = this.touches;
        this.hud.setPlayer(this.player);
        this.layOut();
        if (this.touches) this.firstTime();
        else this.sheets.close();
        this.lookOn();
      },
      onScene: (message) => this.open(message),
      onSkin: (skin) => {
        this.stage.dress(skin);
        this.dirty = true;
      },
      onSheet: (sheet) => this.study.lay(sheet),
      onRefusal: (refusal) => this.study.refuse(refusal),
      onTrouble: (text) => {
        this.troubled = performance.now();
        this.tell(text);
        this.hint.root.hidden = true;
      },
      onFrame: (frame) => this.take(frame),
      onRoundTrip: (ms) => this.hud.setRoundTrip(ms),
    });
    this.sender = new Sender(this.connection);
    this.glass = new Fingers(glass, (change) => this.touch(change));

    window.addEventListener("resize", () => this.resize());
    window.addEventListener("keydown", (e) => this.key(e));
    requestAnimationFrame((now) => this.draw(now));
  }

  /** Shows only the task, without requests, which are the experimenter's. */
  private enterStudy(view: StudyView): void {
    if (this.inStudy) return;
    this.inStudy = view;
    this.study.enter(view);
    this.hud.setStudy(view);
    this.lift.call(view.words["lift"] ?? "");
    this.again.textContent = view.words["lift_again"] ?? "";
    this.rings.plain = !view.shows.includes("fingers");
    this.sound.muted = !view.shows.includes("sound");
  }

  // -- messages of the computer -----------------------------------------------------------------

  private open(scene: SceneMessage): void {
    // Fingers that are still down belong to the trial before.
    if (this.inStudy && scene.scene !== this.scene?.scene) this.glass?.cancelAll();
    this.scene = scene;
    this.frame = null;
    this.pressed.clear();
    this.wasHeld = false;
    this.laidOut = currentScreen();
    // The requested scene is not available, and the current one continues.
    if (performance.now() - this.troubled < REFUSED_MS) this.hud.say(this.trouble.textContent ?? "");
    this.troubled = -Infinity;
    show(this.trouble, false);
    this.hud.setScene(scene);
    this.stage.open(scene);
    this.sender.active = this.touches;
    this.layOut();
    this.lift.open(this.touches && scene.lift > 0, scene.hand);
    this.sender.setLift(this.touches && scene.lift > 0 ? 0 : null);
    if (this.touches && !scene.caption && !this.inStudy) this.hint.open(scene.goal);
  }

  private take(frame: Frame): void {
    if (!this.scene || frame.scene !== this.scene.scene) return;
    this.frame = frame;
    this.dirty = true;
    const { state } = frame;
    const pressed = new Set<string>();
    state.hands.forEach((hand, i) =>
      hand.contacts.forEach((c) => {
        if (c.force <= 0.05 || c.label === null) return;
        pressed.add(`${i}:${c.label}`);
        if (!this.pressed.has(`${i}:${c.label}`)) this.sound.contact(c.label);
      }),
    );
    this.pressed = pressed;
    if (state.held && !this.wasHeld) this.sound.success();
    this.wasHeld = state.held;
  }

  // -- input of the person ----------------------------------------------------------------------

  private touch(change: Change): void {
    this.fingers = change.fingers;
    this.dirty = true;
    // While a hand is on the screen, accidental touches of buttons are ignored.
    document.body.classList.toggle("touching", change.fingers.length > 0);
    this.sender.touch(change);
  }

  private ask(what: PlayerRequest["what"], value = ""): void {
    if (this.player && !this.inStudy) this.connection.say({ type: "ask", what, value });
  }

  private key(event: KeyboardEvent): void {
    if (event.repeat || event.metaKey || event.altKey) return;
    // A plain reload would lack the token.
    if (event.key === "F5" || (event.ctrlKey && event.key === "r")) {
      event.preventDefault();
      reload();
    } else if (event.ctrlKey || this.inStudy) return;
    else if (event.key === "r") this.ask("retry");
    else if (event.key === "m") this.hud.setSound(this.sound.toggle());
    else if (event.key === "Escape") this.sheets.close();
  }

  private openTasks(): void {
    taskMenu(
      this.sheets,
      this.tasks,
      this.scene?.task ?? "",
      (task) => this.ask("task", task),
      () => this.measure(),
    );
  }

  private measure(): void {
    measureScreen(this.sheets, () => this.resized(true));
  }

  /** Shows the questions before the first trial on this screen, one after the other. */
  private firstTime(): void {
    if (this.sheets.isOpen) return;
    const then = (): void => advise(this.sheets, () => undefined);
    // With a mouse, objects need not have their true size.
    if (calibrated() || this.asked || (!touchable && !this.inStudy)) then();
    else
      measureScreen(this.sheets, () => {
        this.resized(true);
        then();
      });
    this.asked = true;
  }

  // -- layout -----------------------------------------------------------------------------------

  /** True if touches on this page drive the hand. */
  private get touches(): boolean {
    return this.player && this.counts && !this.scene?.in_air;
  }

  /** Tells a spectator that another page plays, or that there is no player yet. */
  private lookOn(): void {
    this.hud.setLooking(this.player || spectator || this.inStudy ? "" : "another page plays");
    if (!this.scene && !this.player && !this.inStudy) this.tell("Nobody plays yet.");
  }

  private tell(text: string): void {
    this.trouble.textContent = text;
    show(this.trouble, true);
  }

  private layOut(): void {
    const scene = this.scene;
    this.hud.setGuessed(this.touches && !calibrated());
    this.dirty = true;
    if (!scene) return;
    const [width, height] = [window.innerWidth, window.innerHeight];
    if (this.touches) {
      this.stage.lens.aim(scene.surface, pxPerInch(), width, height);
      const { left, top } = touchRectangle(scene.surface, pxPerInch(), width, height);
      this.sender.corner = { x: left, y: top };
    } else this.stage.lens.overlook(scene.surface, scene.hand, width, height, !!scene.in_air);
  }

  private resize(): void {
    this.stage.resize();
    this.rings.resize();
    this.layOut();
    window.clearTimeout(this.settling);
    this.settling = window.setTimeout(() => this.resized(false), 300);
  }

  /** Sends the page's size; if it has changed, the trial is restarted with a new layout. */
  private resized(measured: boolean): void {
    const screen = currentScreen();
    this.connection.say({ type: "resized", screen });
    this.layOut();
    const before = this.laidOut;
    const changed = (a: number, b: number): boolean => Math.abs(a / b - 1) > CHANGED;
    if (
      (measured && screen.px_per_in !== before.px_per_in) ||
      screen.calibrated !== before.calibrated ||
      changed(screen.width_px, before.width_px) ||
      changed(screen.height_px, before.height_px)
    ) {
      this.laidOut = screen;
      this.ask("retry");
    }
  }

  // -- the picture ------------------------------------------------------------------------------

  private draw(now: number): void {
    requestAnimationFrame((next) => this.draw(next));
    this.glass?.settle();
    this.sender.settle();
    if (!this.dirty) return;
    this.dirty = false;
    const { frame, scene } = this;
    this.rings.draw(this.ringsNow(), this.stage.lens.pxPerInch);
    if (!frame || !scene) return;
    this.stage.move(frame);
    this.stage.draw(now);
    this.report(frame);
    this.hud.setState(frame.state, scene.time_limit, this.player);
    this.hint.follow(this.fingers, frame.state);
    show(this.again, this.player && this.doubt.now(frame.state, now));
  }

  /** Rings of the fingers on this screen at their current places; of others, at the places that the
   * computer sent. */
  private ringsNow(): Ring[] {
    const contacts = this.frame?.state.hands.flatMap((hand) => hand.contacts) ?? [];
    if (this.player && !this.scene?.caption) {
      const known = new Map(contacts.map((c) => [c.id, c]));
      return this.fingers.map(({ id, x, y }) => {
        const c = known.get(id);
        return {
          x,
          y,
          label: c?.label ?? null,
          force: c?.force ?? 0,
          ignored: c?.state === "ignored",
          sure: c?.sure ?? true,
        };
      });
    }
    return contacts.map((c) => ({
      ...this.stage.lens.project(c.position),
      label: c.label,
      force: c.force,
      ignored: c.state === "ignored",
      sure: c.sure,
    }));
  }

  /** Reports now and then the latency from a touch to the first picture that contains it. */
  private report(frame: Frame): void {
    const after = this.sender.since(frame.touch);
    const now = performance.now();
    if (after === null || now - this.reported < REPORT_MS) return;
    this.reported = now;
    const after_ms = Math.min(Math.max(after, 0), 60000);
    this.connection.say({ type: "drawn", frame: frame.number, after_ms });
  }
}

new Page();
