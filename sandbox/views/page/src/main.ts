// The page: creates its parts and connects them.

import { advise } from "./advice";
import { forColourBlind, standardColours, toggleColours } from "./colours";
import { Connection } from "./connection";
import { make, show, write } from "./dom";
import { Doubt } from "./doubt";
import { canDraw } from "./drawing";
import { type Change, type Finger, Fingers } from "./fingers";
import type { Frame } from "./frame";
import { FullScreen } from "./full";
import { Hint } from "./hint";
import { Hud, goalOf } from "./hud";
import { touchRectangle } from "./lens";
import { Lift } from "./lift";
import { lookOn, reload, spectator } from "./link";
import { measureScreen } from "./measure";
import { type Switch, taskMenu } from "./menu";
import {
  LIFT_STRIP_PX,
  type PlayerRequest,
  type SceneMessage,
  type StudyView,
  type TaskName,
} from "./protocol";
import { askPhone } from "./phone";
import { type Ring, Rings, TOLD, ringHeight } from "./rings";
import { calibrated, currentScreen, onOtherPixels, pxPerInch, small, sized, touchable } from "./screen";
import { Sender } from "./sender";
import { Sheets } from "./sheet";
import { Sound } from "./sound";
import { Study } from "./study";
import { Stage } from "./stage";
import { type Hindrance, Turned } from "./turned";
import { Vibration } from "./vibration";
import { repeat, say } from "./words";
import { tableZoomed, watchZoom } from "./zoom";

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
  private readonly vibration = new Vibration();
  private readonly hint = new Hint();
  private readonly lift: Lift;
  private readonly doubt = new Doubt();
  private readonly study = new Study((up) => this.connection.say(up));
  private readonly again = make("div", "lift-again", { text: say("lift_again") });
  private readonly trouble = make("div", "trouble");
  private readonly curtain = make("div", "curtain");
  private readonly preparing = document.querySelector<HTMLElement>(".preparing")!;
  private readonly turned: Turned;
  private readonly full = new FullScreen();

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
  private resting: Finger[] = [];
  private linked = false;
  private dirty = true;
  private reported = 0;
  private pressed = new Set<string>();
  private wasHeld = false;
  private gripped = false;
  private laidOut = currentScreen();
  private fitted = true;
  private asked = false;
  /** True while another table is asked for. */
  private awaited = false;
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
    this.turned = new Turned(() => this.ask("retry"));
    document.body.append(
      this.lift.root,
      this.hud.root,
      this.hint.root,
      this.again,
      this.trouble,
      this.study.root,
      this.turned.root,
      this.curtain,
      this.full.root,
    );
    for (const alert of [this.again, this.trouble, this.curtain]) alert.setAttribute("role", "alert");
    this.sheets = new Sheets(document.body, (open) => this.ask(open ? "pause" : "resume"));
    // Menus are shown or hidden only once the computer has sent its first message.
    for (const element of [this.again, this.trouble, this.curtain, this.hud.root])
      show(element, false);

    this.connection = new Connection({
      onCondition: (condition, why) => {
        this.hud.setConnection(condition, say(why));
        this.linked = condition === "open";
        this.dirty = true;
        // Fingers that rest while the connection is lost go on afterwards.
        if (condition === "ended") this.glass?.cancelAll();
        if (condition === "ended") show(this.preparing, false);
        const study = this.inStudy !== null;
        // While it tries again, the words stay.
        if (study) write(this.curtain, say(condition === "ended" ? "ended" : "lost"));
        else if (condition !== "connecting") write(this.curtain, say(why));
        const again = condition === "connecting" && (study || !this.curtain.hidden);
        const shut = condition === "ended" || condition === "lost" || again;
        show(this.curtain, shut && !this.study.over);
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
        if (this.sheets.isOpen) this.ask("pause");
        this.lookOn();
      },
      onScene: (message) => this.open(message),
      onSkin: (skin) => {
        this.stage.dress(skin);
        this.dirty = true;
      },
      onSheet: (sheet) => this.study.lay(sheet),
      onRefusal: (refusal) => this.study.refuse(refusal),
      onTrouble: (told) => {
        this.troubled = performance.now();
        this.tell(told.map(repeat).join("\n"));
        this.hint.root.hidden = true;
      },
      onFrame: (frame) => this.take(frame),
      onRoundTrip: (ms) => this.hud.setRoundTrip(ms, performance.now()),
    });
    this.sender = new Sender(this.connection);
    this.glass = new Fingers(glass, (change) => this.touch(change));

    document.addEventListener("visibilitychange", () => {
      this.appear();
      if (!document.hidden && this.sheets.isOpen) this.ask("pause");
    });
    window.addEventListener("pagehide", () => this.lift.keep());
    this.appear();
    window.addEventListener("resize", () => this.resize());
    onOtherPixels(() => this.resize());
    watchZoom(() => this.fit());
    window.addEventListener("keydown", (e) => this.key(e));
    requestAnimationFrame((now) => this.draw(now));
  }

  /** Shows only the task, without requests, which are the experimenter's. */
  private enterStudy(view: StudyView): void {
    if (this.inStudy) return;
    this.inStudy = view;
    this.study.enter(view);
    this.hud.setStudy(view);
    this.lift.relabel();
    this.full.relabel();
    this.again.textContent = say("lift_again");
    if (!this.preparing.hidden) write(this.preparing, say("preparing"));
    this.rings.plain = !view.shows.includes("fingers");
    this.sound.muted = !view.shows.includes("sound");
    this.vibration.muted = true;
    standardColours();
  }

  // -- messages of the computer -----------------------------------------------------------------

  private open(scene: SceneMessage): void {
    // Fingers that are still down belong to the trial before.
    const same = this.scene !== null && JSON.stringify(this.scene) === JSON.stringify(scene);
    if (this.inStudy && !same) this.glass?.cancelAll();
    this.scene = scene;
    this.awaited = false;
    this.frame = null;
    this.pressed.clear();
    this.wasHeld = false;
    if (!same) {
      this.laidOut = currentScreen();
      this.fitted = this.hasRoom(scene, window.innerWidth, window.innerHeight);
    }
    // The requested scene is not available, and the current one continues.
    if (performance.now() - this.troubled < REFUSED_MS) this.hud.say(this.trouble.textContent ?? "");
    this.troubled = -Infinity;
    show(this.trouble, false);
    this.hud.setScene(scene);
    if (!same) this.stage.open(scene);
    this.sender.active = this.touches;
    const lifts = this.touches && scene.lift > 0;
    this.lift.open(lifts, scene.hand, `${scene.scene} ${scene.task} ${scene.seed}`);
    this.layOut();
    this.sender.setLift(lifts ? this.lift.value : null);
    if (this.touches && !scene.caption && !this.inStudy) this.hint.open(goalOf(scene, false), lifts);
  }

  private take(frame: Frame): void {
    if (!this.scene || frame.scene !== this.scene.scene) return;
    const first = this.frame === null;
    this.frame = frame;
    this.dirty = true;
    const { state } = frame;
    if (first) this.fit();
    const pressed = new Set<string>();
    state.hands.forEach((hand, i) =>
      hand.contacts.forEach((c) => {
        if (c.force <= 0.05 || c.label === null) return;
        pressed.add(`${i}:${c.label}`);
        if (!this.pressed.has(`${i}:${c.label}`)) this.sound.contact(c.label);
      }),
    );
    this.pressed = pressed;
    const grip = Math.max(0, ...state.hands.flatMap((h) => h.contacts.map((c) => c.stored ?? 0)));
    if (grip >= TOLD && !this.gripped) this.vibration.grip();
    // A grip that trembles is one grip.
    this.gripped = grip >= TOLD || (this.gripped && grip > 0);
    if (state.held && !this.wasHeld) {
      this.sound.success();
      this.vibration.success();
    }
    this.wasHeld = state.held;
  }

  // -- input of the person ----------------------------------------------------------------------

  private touch(change: Change): void {
    this.fingers = change.fingers;
    this.resting = change.resting;
    this.dirty = true;
    // While a hand is on the screen, accidental touches of buttons are ignored.
    document.body.classList.toggle("touching", change.fingers.length > 0);
    this.sender.touch(change);
  }

  private ask(what: PlayerRequest["what"], value = ""): void {
    if (!this.player || this.inStudy) return;
    const sent = this.connection.say({ type: "ask", what, value });
    // Another table takes the computer a moment.
    if (!sent || what === "pause" || what === "resume") return;
    // What was wrong before is not the answer to this.
    this.troubled = -Infinity;
    this.awaited = true;
    show(this.preparing, true);
  }

  private key(event: KeyboardEvent): void {
    if (event.repeat || event.metaKey || event.altKey) return;
    // Without the detour of a plain reload, which has to find the token first.
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
      this.switches(),
      reload,
    );
  }

  /** What can be switched on this device. */
  private switches(): Switch[] {
    const colours: Switch = {
      name: say("colours"),
      why: say("colours_why"),
      on: forColourBlind,
      toggle: () => {
        toggleColours();
        this.dirty = true;
      },
    };
    const vibration: Switch = {
      name: say("vibration"),
      why: say("vibration_why"),
      on: () => this.vibration.on,
      toggle: () => this.vibration.toggle(),
    };
    return this.vibration.possible ? [colours, vibration] : [colours];
  }

  private measure(): void {
    measureScreen(this.sheets, () => this.resized(true));
  }

  /** Shows the questions before the first trial on this screen, one after the other. */
  private firstTime(): void {
    if (this.sheets.isOpen) return;
    if (small() && currentScreen().fit === "" && !this.inStudy && touchable) {
      this.askPhone();
      return;
    }
    const then = (): void => advise(this.sheets, () => undefined);
    // With a mouse, objects need not have their true size.
    if (calibrated() || currentScreen().fit !== "" || this.asked || (!touchable && !this.inStudy)) then();
    else
      measureScreen(this.sheets, () => {
        this.resized(true);
        then();
      });
    this.asked = true;
  }

  /** Asks the owner of a screen that is too small for a hand, before anything else. */
  private askPhone(): void {
    askPhone(this.sheets, {
      look: lookOn,
      play: () => {
        this.resized(true);
        this.ask("retry");
        this.firstTime();
      },
      measure: () =>
        measureScreen(this.sheets, () => {
          this.asked = true;
          this.resized(true);
          this.firstTime();
        }),
    });
  }

  // -- layout -----------------------------------------------------------------------------------

  /** True if touches on this page drive the hand. */
  private get touches(): boolean {
    return this.player && this.counts && !this.scene?.in_air;
  }

  /** Tells a spectator that another page plays, or that there is no player yet. */
  private lookOn(): void {
    this.hud.setLooking(this.player || spectator || this.inStudy ? "" : say("another_plays"));
    if (!this.scene && !this.player && !this.inStudy) this.tell(say("nobody_plays"));
  }

  private tell(text: string): void {
    write(this.trouble, text);
    show(this.trouble, true);
    this.awaited = false;
    this.dirty = true;
    show(this.preparing, false);
  }

  /** Tells the computer whether somebody can play here now. */
  private appear(): void {
    this.connection.appear(!document.hidden && !this.turned.shown);
  }

  /** A table that was laid for the page held the other way has no room on it now. While its trial runs,
   * time stands still until the page is turned back, or the person asks for another table. So it does on
   * a zoomed page, also before the trial has begun. */
  private fit(): void {
    const { frame, scene } = this;
    if (!frame || !scene) return;
    const running = frame.state.status === "running";
    const begun = running && frame.state.pause !== "start";
    const { innerWidth, innerHeight } = window;
    const room = this.hasRoom(scene, innerWidth, innerHeight);
    // Beside a window, a table may be larger than this page ever is: then nothing can be turned back.
    this.fitted ||= room || this.hasRoom(scene, innerHeight, innerWidth);
    let why: Hindrance = begun && !room && this.fitted ? "turned" : "";
    if (running && tableZoomed()) why = "zoomed";
    this.turned.show(this.touches ? why : "", this.inStudy !== null);
    this.appear();
  }

  /** True if all of a scene's table is seen on a page of so many CSS pixels. */
  private hasRoom(scene: SceneMessage, width: number, height: number): boolean {
    const strip = scene.lift > 0 ? LIFT_STRIP_PX : 0;
    const scale = this.pxPerTableInch * (1 - CHANGED);
    const { width_in, height_in } = scene.surface;
    return width_in * scale <= width - strip && height_in * scale <= height;
  }

  /** CSS pixels on this page of an inch on the table. */
  private get pxPerTableInch(): number {
    return pxPerInch() * (this.scene?.surface.scale ?? 1);
  }

  /** What the player has to know about the size of the table. */
  private sizeInWords(): string {
    if (!this.touches) return "";
    const scale = this.scene?.surface.scale ?? 1;
    if (scale === 1) return calibrated() ? "" : say("size_guessed");
    if (this.scene?.scored ?? true) return say("scaled_window");
    return say("scaled_phone", { percent: (100 * scale).toFixed(0) });
  }

  private layOut(): void {
    const scene = this.scene;
    this.hud.setSize(this.sizeInWords());
    this.dirty = true;
    if (!scene) return;
    const [width, height] = [window.innerWidth, window.innerHeight];
    if (this.touches) {
      const side = scene.lift > 0 ? this.lift.side : null;
      const place = touchRectangle(scene.surface, this.pxPerTableInch, width, height, side);
      this.stage.lens.aim(scene.surface, this.pxPerTableInch, width, height, place);
      this.sender.corner = { x: place.left, y: place.top };
      this.lift.stand(place);
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
    if (!sized()) return;
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
      const running = this.frame?.state.status === "running" && this.frame.state.pause !== "start";
      // Where a task has no room, nothing is played until the page has another size.
      const begun = running && this.trouble.hidden;
      if (begun && !measured) this.fit();
      else {
        this.laidOut = screen;
        this.ask("retry");
      }
    } else this.fit();
  }

  // -- the picture ------------------------------------------------------------------------------

  private draw(now: number): void {
    requestAnimationFrame((next) => this.draw(next));
    this.glass?.settle();
    this.sender.settle();
    // Asked for every time, as it measures how long the last picture took.
    const { free } = this.stage;
    if (!this.dirty || !free) return;
    this.dirty = false;
    const { frame, scene } = this;
    const rings = this.ringsNow();
    const told = rings.some((ring) => ring.word !== undefined && !ring.palm);
    // What keeps from playing comes before what a finger has to do.
    const atFinger = told && this.shut.every((message) => message.hidden);
    if (!atFinger) for (const ring of rings) if (!ring.palm) delete ring.word;
    // A finger has its true size, also on a smaller table.
    this.rings.draw(rings, Math.max(this.stage.lens.pxPerInch, this.touches ? pxPerInch() : 0));
    this.sayOneThing(atFinger);
    if (!frame || !scene) return;
    // Pictures of the table before may still come while another one is prepared.
    show(this.preparing, this.awaited);
    this.stage.move(frame, this.linked);
    this.stage.draw();
    this.report(frame);
    this.hud.setState(frame.state, scene.time_limit, this.player, this.turned.shown, atFinger);
    this.hint.follow(this.fingers, this.lift.value, frame.state);
    if (!this.hint.root.hidden && !this.fingers.length) this.standAside();
    show(this.again, this.player && this.doubt.now(frame.state, now));
    if (!this.again.hidden) this.above(this.again);
    this.sayOneThing(atFinger);
  }

  /** Moves the hint away from what has to be touched. */
  private standAside(): void {
    const strip = this.lift.root.hidden ? 0 : LIFT_STRIP_PX;
    const [left, right] = this.lift.side === "left" ? [strip, 0] : [0, strip];
    this.hint.stand(this.stage.things(), left, right);
  }

  /** Puts a message above the fingers that it is about, or below them where there is no room. */
  private above(message: HTMLElement): void {
    if (!this.fingers.length) return;
    const [xs, ys] = [this.fingers.map((f) => f.x), this.fingers.map((f) => f.y)];
    const { offsetWidth: width, offsetHeight: height } = message;
    const middle = (Math.min(...xs) + Math.max(...xs) - width) / 2;
    const clear = ringHeight(this.stage.lens.pxPerInch);
    const top = Math.min(...ys) - clear - height;
    const y = top >= 0 ? top : Math.min(Math.max(...ys) + clear, window.innerHeight - height);
    message.style.left = `${Math.min(Math.max(middle, 0), window.innerWidth - width)}px`;
    message.style.top = `${y}px`;
  }

  /** Messages that keep from playing, the most important one first. */
  private get shut(): HTMLElement[] {
    return [this.curtain, this.trouble, this.turned.root, this.preparing, this.hud.end];
  }

  /** Of several messages only the most important one is visible, as they might disagree.
   *
   * @param atFinger True if something is said beside a finger.
   */
  private sayOneThing(atFinger: boolean): void {
    const others = [this.again, this.hud.toast, this.hint.root];
    let said = false;
    for (const message of this.shut) {
      message.classList.toggle("outranked", said);
      said ||= !message.hidden;
    }
    said ||= atFinger;
    for (const message of others) {
      message.classList.toggle("outranked", said);
      said ||= !message.hidden;
    }
  }

  /** Rings of the fingers on this screen at their current places; of others, at the places that the
   * computer sent. */
  private ringsNow(): Ring[] {
    const contacts = this.frame?.state.hands.flatMap((hand) => hand.contacts) ?? [];
    if (this.player && !this.scene?.caption) {
      const known = new Map(contacts.map((c) => [c.id, c]));
      const rings: Ring[] = this.fingers.map(({ id, x, y, width, height }) => {
        const c = this.linked ? known.get(id) : undefined;
        return {
          x,
          y,
          label: c?.label ?? null,
          force: c?.force ?? 0,
          stored: c?.stored ?? 0,
          full: c?.full ?? false,
          ignored: !this.linked || c?.state === "ignored",
          sure: c?.sure ?? true,
          ...(c?.inside && { word: say("move_apart") }),
          ...(c?.state === "palm" && { word: say("palm"), palm: { width, height } }),
        };
      });
      const gone = { label: null, force: 0, stored: 0, full: false, ignored: true, sure: true };
      for (const { x, y } of this.resting) rings.push({ x, y, ...gone });
      // One of them says it for all.
      const first = rings[this.fingers.length];
      if (first) first.word = this.again.textContent ?? "";
      return rings;
    }
    return contacts.map((c) => ({
      ...this.stage.lens.project(c.position),
      label: c.label,
      force: c.force,
      stored: c.stored ?? 0,
      full: c.full ?? false,
      ignored: c.state === "ignored",
      sure: c.sure,
      ...(c.inside && { word: say("move_apart") }),
      ...(c.state === "palm" && { word: say("palm"), palm: { width: 0, height: 0 } }),
    }));
  }

  /** Reports now and then the latency from a touch to the first picture that contains it. */
  private report(frame: Frame): void {
    const after = this.sender.since(frame.touch);
    const now = performance.now();
    if (after === null || now - this.reported < REPORT_MS) return;
    this.reported = now;
    const after_ms = Math.min(Math.max(after, 0), 60000);
    this.hud.setDelay(after_ms, now);
    this.connection.say({ type: "drawn", frame: frame.number, after_ms });
  }
}

if (canDraw()) new Page();
