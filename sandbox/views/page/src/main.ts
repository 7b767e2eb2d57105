// The page: creates its parts and connects them.

import { Anew } from "./restart";
import { forColourBlind, standardColours, toggleColours } from "./colours";
import { Connection } from "./connection";
import { Delay } from "./delay";
import { Demonstration } from "./demonstration";
import { make, show, write } from "./dom";
import { canDraw } from "./drawing";
import { type Change, type Finger, Fingers } from "./fingers";
import type { Frame } from "./frame";
import { FullScreen } from "./full-screen";
import { FailedGrip } from "./grip";
import { Hint } from "./hint";
import { Hud } from "./hud";
import { type Rectangle, touchRectangle } from "./camera";
import { Lift, elsewhere } from "./lift-slider";
import { closeEarly, spectator } from "./link";
import { lookOn, reload } from "./page-address";
import { measureScreen } from "./measure";
import { type Switch, settingsMenu, taskMenu } from "./menu";
import { layoutOf, markLayout, tableRoom } from "./phone";
import { Presses } from "./palm-guard";
import {
  type ContactState,
  LIFT_STRIP_PX,
  NOTCH_PX,
  type PlayerRequest,
  type SceneMessage,
  type Sheet,
  type StudyView,
  type TaskName,
} from "./protocol";
import { Replay } from "./replay";
import { Result } from "./result";
import { type Ring, Rings, TOLD, ringHeight, ringRadius } from "./rings";
import { calibrated, currentScreen, ipad, isPhone, onOtherPixels, pxPerInch } from "./screen";
import { Sender } from "./sender";
import { Sheets } from "./sheet";
import { Sound } from "./sound";
import { Study } from "./study";
import { Stage } from "./stage";
import { type Hindrance, Turned } from "./unusable-table";
import { Vibration } from "./vibration";
import { sized } from "./window-size";
import { repeat, say } from "./words";
import { tableZoomed, watchZoom } from "./zoom";

/** ms between two reports of the latency from touch to picture. */
const REPORT_MS = 100;
/** ms within which a new scene counts as the substitute for one that is not available. */
const REFUSED_MS = 1000;
/** ms for which advice can be read. */
const ADVICE_MS = 9000;
/** ms for which a contact is ignored before the player is told. */
const IGNORED_MS = 600;
/** s without progress after which a player is shown how, and what counts as progress. */
const STUCK_S = 10;
const GAINED = 0.02;
const INCHES_PER_METRE = 1 / 0.0254;
/** Share by which the page's size has to change before the trial is restarted with a new layout. */
const CHANGED = 0.08;

class Page {
  private readonly stage: Stage;
  private readonly rings: Rings;
  private readonly hud: Hud;
  private readonly result: Result;
  private readonly replay = new Replay();
  private readonly demonstration = new Demonstration();
  private readonly delay = new Delay();
  private readonly anew: Anew;
  private readonly presses: Presses;
  private readonly sheets: Sheets;
  private readonly connection: Connection;
  private readonly sender: Sender;
  private readonly sound = new Sound();
  private readonly vibration = new Vibration();
  private readonly hint = new Hint();
  private readonly lift: Lift;
  private readonly grip = new FailedGrip();
  /** True while a touch lies that ended the demonstration after a trial: another trial begins once it lifts. */
  private turnTaken = false;
  private readonly study = new Study((up) => this.connection.say(up));
  private readonly again = make("div", "lift-again", { text: say("lift_again") });
  private readonly trouble = make("div", "trouble");
  private readonly curtain = make("div", "curtain");
  private readonly preparing = document.querySelector<HTMLElement>(".preparing")!;
  private readonly turned: Turned;
  private readonly full = new FullScreen();

  private glass: Fingers | null = null;
  private player = false;
  /** s until this page, which waits, may play; null while the player is there. */
  private seat: number | null = null;
  /** True if the player's touches drive a hand; otherwise another device does. */
  private counts = true;
  /** ms, time at which a scene was last not available. */
  private troubled = -Infinity;
  private inStudy: StudyView | null = null;
  private tasks: TaskName[] = [];
  private scene: SceneMessage | null = null;
  /** Rows of the scene's objects among a frame's poses. */
  private objects: number[] = [];
  private frame: Frame | null = null;
  private fingers: Finger[] = [];
  private resting: Finger[] = [];
  private linked = false;
  private dirty = true;
  private reported = 0;
  private pressed = new Set<string>();
  /** s, simulated time at which the goal was held; null before. */
  private heldAt: number | null = null;
  private gripped = false;
  private laidOut = currentScreen();
  private fitted = true;
  /** Progress that was made last, and when, in s. */
  private gained = { progress: 0, time: 0 };
  /** Contacts that are no fingers of this hand, by id: since when, in ms. */
  private readonly ignored = new Map<number, number>();
  /** True once this trial's player was shown how. */
  private helped = false;
  /** True while time stands still for it. */
  private paused = false;
  /** True once the words at the top have their place on this table. */
  private placed = false;
  /** True while another table is asked for. */
  private awaited = false;
  private settling = 0;

  constructor() {
    this.stage = new Stage(reload);
    const scene = this.stage.canvas;
    scene.className = "scene";
    scene.setAttribute("role", "img");
    scene.setAttribute("aria-label", say("table"));
    const overlay = make("canvas", "rings");
    const glass = make("div", "glass");
    document.body.append(scene, overlay, glass);
    this.rings = new Rings(overlay);
    this.anew = new Anew({
      pause: () => this.ask("pause"),
      resume: () => this.ask("resume"),
      retry: () => this.ask("retry"),
    });
    this.presses = new Presses({
      palm: () => this.hud.say(say("use_fingertip")),
      short: () => this.hud.say(say("hold_button")),
      needsHold: () => this.running,
    });
    this.hud = new Hud({
      again: () => this.beginAgain(),
      tasks: () => this.openTasks(),
      settings: () => this.openSettings(),
      help: () => this.help(),
      seat: () => this.connection.say({ type: "ask", what: "seat" }),
    });
    this.result = new Result({
      again: () => this.ask("retry"),
      tasks: () => this.openTasks(),
      play: (task) => this.ask("task", task),
      replay: () => this.replay.start(performance.now()),
      help: () => this.help(),
      measure: () => this.measure(),
    });
    this.hud.root.append(this.result.root);
    this.lift = new Lift(
      (value) => this.sender.setLift(value),
      () => this.glass?.mouse.opens ?? false,
    );
    window.addEventListener("wheel", (e) => this.wheel(e), { passive: true });
    this.turned = new Turned(() => this.ask("retry"));
    document.body.append(
      this.lift.root,
      this.hud.root,
      this.hint.root,
      this.again,
      this.trouble,
      this.anew.root,
      this.study.root,
      this.turned.root,
      this.curtain,
      this.full.root,
    );
    for (const alert of [this.again, this.trouble, this.curtain]) alert.setAttribute("role", "alert");
    this.sheets = new Sheets(document.body, (open) => {
      if (open) this.anew.stop();
      if (open) this.endHelp();
      this.ask(open ? "pause" : "resume");
    });
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
        const inStudy = condition === "ended" ? "ended" : "lost";
        if (study) write(this.curtain, say(why === "goodbye" ? why : inStudy));
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
        if (!this.touches) this.sheets.close();
        if (this.sheets.isOpen) this.ask("pause");
        this.lookOn();
      },
      onScene: (message) => this.open(message),
      onSkin: (skin) => {
        this.stage.dress(skin);
        this.dirty = true;
      },
      onDemonstration: (frames) => {
        if (frames[0]?.scene !== this.scene?.scene) return;
        this.demonstration.take(frames);
        this.demonstrate();
      },
      onSheet: (sheet) => this.lay(sheet),
      onRefusal: (refusal) => this.study.refuse(refusal),
      onTrouble: (told) => {
        this.troubled = performance.now();
        this.tell(told.map(repeat).join("\n"));
        this.hint.root.hidden = true;
      },
      onSeat: (seat) => {
        const where = { settings: say("settings"), look_on: say("look_on") };
        if (seat.requested) this.hud.say(say("seat_asked", where), ADVICE_MS);
        if (!this.player) this.seat = seat.wait_s ?? null;
        this.lookOn();
      },
      onFrame: (frame) => this.take(frame),
      onRoundTrip: (ms) => (this.delay.link = ms),
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
    this.sender.named = false;
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
    this.objects = [...new Set(scene.geoms.filter((g) => g.part === "object").map((g) => g.body))];
    this.awaited = false;
    this.frame = null;
    this.pressed.clear();
    this.anew.stop();
    this.heldAt = null;
    this.replay.stop();
    this.result.close();
    if (!same) {
      this.laidOut = currentScreen();
      this.fitted = this.hasRoom(scene, window.innerWidth, window.innerHeight);
    }
    // The requested scene is not available, and the current one continues.
    if (performance.now() - this.troubled < REFUSED_MS) this.hud.say(this.trouble.textContent ?? "");
    this.troubled = -Infinity;
    show(this.trouble, false);
    this.hud.setScene(scene);
    this.placed = false;
    if (!same) this.stage.open(scene);
    this.sender.active = this.touches;
    const lifts = this.touches && scene.lift > 0;
    this.lift.open(lifts, scene.lift, scene.hand, `${scene.scene} ${scene.task} ${scene.seed}`);
    this.layOut();
    this.sender.setLift(lifts ? this.lift.value : null);
    this.demonstration.forget();
    this.gained = { progress: 0, time: 0 };
    this.helped = false;
    this.hint.hide();
    if (!this.touches || scene.caption) return;
    this.hint.begin(scene, lifts, this.inStudy !== null);
    if (!this.hint.root.hidden) this.ask("demo");
  }

  private take(frame: Frame): void {
    if (!this.scene || frame.scene !== this.scene.scene) return;
    const first = this.frame === null;
    this.frame = frame;
    this.dirty = true;
    const { state } = frame;
    if (first) this.fit();
    if (first) this.demonstrate();
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
    this.replay.note(frame);
    if (state.progress > this.gained.progress + GAINED || state.time < this.gained.time)
      this.gained = { progress: state.progress, time: state.time };
    // Somebody who does not get on is shown how, once in a trial.
    const waits = state.pause || state.reached;
    const stuck = this.running && !waits && state.time - this.gained.time > STUCK_S;
    if (stuck && !this.fingers.length && !this.helped) this.help();
    if (!state.held) this.heldAt = null;
    else if (this.heldAt === null) {
      this.heldAt = state.time;
      this.sound.success();
      this.vibration.success();
    }
  }

  // -- input of the person ----------------------------------------------------------------------

  private touch(change: Change): void {
    this.fingers = change.fingers;
    this.resting = change.resting;
    this.dirty = true;
    // While a hand is on the screen, accidental touches of buttons are ignored.
    document.body.classList.toggle("touching", change.fingers.some(({ pinned }) => !pinned));
    if (change.fingers.length > 0) {
      this.anew.undo();
      this.turnTaken ||= this.demonstration.shown && this.over;
      this.endHelp();
      this.presses.release();
    } else if (this.turnTaken) {
      this.turnTaken = false;
      this.ask("retry");
    }
    this.sender.touch(change);
    if (change.stolen && !this.inStudy) this.hud.say(say(ipad ? "gestures_ipad" : "gestures"), ADVICE_MS);
  }

  private ask(what: PlayerRequest["what"], value = ""): void {
    if (!this.player || this.inStudy) return;
    const sent = this.connection.say({ type: "ask", what, value });
    // Another table takes the computer a moment.
    if (!sent || what === "pause" || what === "resume" || what === "demo") return;
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
    } else if (this.handKey(event) || event.ctrlKey || this.inStudy) return;
    else if (event.key === "r") this.beginAgain();
    else if (event.key === "m") this.sound.toggle();
    else if ((event.key === "?" || event.key === "h") && !this.hint.asked) this.help();
    else if (event.key === "?" || event.key === "h") this.hint.finish();
    else if (event.key === "Escape" && this.hint.asked && !this.sheets.isOpen) this.hint.finish();
    else if (event.key === "Escape") this.sheets.close();
  }

  /** A key that puts down or lifts a hand of the mouse, as in the program's window; true if it was one. */
  private handKey(event: KeyboardEvent): boolean {
    const mouse = this.glass?.mouse;
    const onButton = event.target instanceof Element && event.target.closest("button") !== null;
    if (!mouse || !this.touches || event.ctrlKey || elsewhere(event)) return false;
    if (/^[1-5]$/.test(event.key)) mouse.hand(Number(event.key));
    else if (event.key === " " && !onButton) mouse.lift();
    else return false;
    this.glass?.tellNow();
    return true;
  }

  /** The wheel opens, closes and turns the fingers that a mouse has put down. */
  private wheel(event: WheelEvent): void {
    const mouse = this.glass?.mouse;
    if (!mouse?.opens || event.ctrlKey || elsewhere(event)) return;
    // With shift, some systems report a sideways turn of the wheel.
    mouse.wheel(-(event.deltaY || event.deltaX) / NOTCH_PX, event.shiftKey);
    this.glass?.tellNow();
  }

  /** Shows how the task is done, in words and by a demonstration as soon as there is one; time stands still
   * until the next touch. */
  private help(): void {
    if (!this.touches || this.inStudy || !this.scene || this.scene.caption) return;
    this.helped = true;
    this.hint.open();
    if (this.running && this.frame?.state.pause !== "menu") this.ask("pause");
    this.paused = this.running;
    if (!this.demonstration.ready) this.ask("demo");
    this.demonstrate();
  }

  /** Shows the demonstration if there is one, and somebody waits for it. */
  private demonstrate(): void {
    const { state } = this.frame ?? {};
    // In a study one comes where the design shows it.
    const begins = state?.pause === "start" && (this.inStudy !== null || !this.hint.root.hidden);
    const over = this.helped && this.over;
    if (this.fingers.length || this.sheets.isOpen || !(begins || this.paused || over)) return;
    if (!this.demonstration.ready) return;
    // Words have their place before things begin to move.
    this.stage.move(this.frame!, this.linked, false);
    this.standAside();
    this.demonstration.start(performance.now());
    this.dirty = true;
  }

  /** Begins again: the demonstration before a trial, else the trial. */
  private beginAgain(): void {
    const begins = this.demonstration.shown && !this.running && !this.over;
    this.endHelp();
    if (begins) this.demonstration.start(performance.now());
    else this.anew.ask(this.running);
  }

  private endHelp(): void {
    this.demonstration.stop();
    if (this.paused) this.ask("resume");
    this.paused = false;
  }

  private openTasks(): void {
    taskMenu(this.sheets, this.tasks, this.scene?.task ?? "", (task) => this.ask("task", task));
  }

  private openSettings(): void {
    const hand = this.scene?.hand ?? "right";
    settingsMenu(this.sheets, {
      hand,
      otherHand: () => this.ask("hand", hand === "right" ? "left" : "right"),
      fingers: this.scene?.finger_sets ?? null,
      useFingers: (sets) => this.ask("fingers", sets),
      measure: () => this.measure(),
      lookOn,
      reload,
      switches: this.switches(),
      delay: this.delay.words,
    });
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
    const sound: Switch = {
      name: say("sound"),
      why: say("sound_why"),
      on: () => !this.sound.muted,
      toggle: () => this.sound.toggle(),
    };
    const vibration: Switch = {
      name: say("vibration"),
      why: say("vibration_why"),
      on: () => this.vibration.on,
      toggle: () => this.vibration.toggle(),
    };
    return this.vibration.possible ? [sound, colours, vibration] : [sound, colours];
  }

  private measure(): void {
    measureScreen(this.sheets, () => this.resized(true));
  }

  /** Lays a sheet of a study; that of its experimenter is the one that measures the screen. */
  private lay(sheet: Sheet): void {
    this.study.lay(sheet);
    this.sheets.close();
    if (sheet.kind !== "measure") return;
    measureScreen(this.sheets, () => {
      this.resized(true);
      this.study.leave("done");
    });
  }

  // -- layout -----------------------------------------------------------------------------------

  /** True once the trial has ended. */
  private get over(): boolean {
    const { state } = this.frame ?? {};
    return state !== undefined && state.status !== "running";
  }

  /** True while a trial runs that has begun. */
  private get running(): boolean {
    const { state } = this.frame ?? {};
    return state?.status === "running" && state.pause !== "start";
  }

  /** True if touches on this page drive the hand. */
  private get touches(): boolean {
    return this.player && this.counts && !this.scene?.in_air;
  }

  /** Tells a spectator that another page plays, or that there is no player yet. */
  private lookOn(): void {
    const waits = !this.player && !spectator && !this.inStudy;
    const away = this.seat !== null;
    const words = away ? say("seat_wait", { time: String(this.seat) }) : say("another_plays");
    this.hud.setLooking(waits ? words : "");
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

  /** True if the table has its true size, if only its screen's size were known. */
  private get sizeGuessed(): boolean {
    return this.touches && this.scene?.surface.scale === 1 && !calibrated();
  }

  private layOut(): void {
    const scene = this.scene;
    this.dirty = true;
    this.placed = false;
    if (!scene) return;
    const [width, height] = [window.innerWidth, window.innerHeight];
    if (this.touches) {
      const side = scene.lift > 0 ? this.lift.side : null;
      const phone = isPhone();
      const page = { left: 0, top: 0, width, height };
      const room = phone ? tableRoom(width, height, scene.hand) : page;
      markLayout(phone ? layoutOf(width, height) : null, room);
      const place = touchRectangle(scene.surface, this.pxPerTableInch, room, side);
      this.stage.lens.aim(scene.surface, this.pxPerTableInch, width, height, place);
      this.sender.corner = { x: place.left, y: place.top };
      this.glass?.mouse.stand(place, this.pxPerTableInch * INCHES_PER_METRE, scene.hand);
      this.lift.stand(place);
      this.hud.stand(place, side, phone);
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
      // Where a task has no room, nothing is played until the page has another size.
      const begun = this.running && this.trouble.hidden;
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
    if (!(this.dirty || this.replay.shown || this.demonstration.shown) || !free) return;
    const { frame, scene } = this;
    const demonstrated = this.demonstration.at(now);
    const earlier = demonstrated ?? this.replay.at(now);
    this.dirty = earlier !== null;
    const rings = earlier ? this.ringsOf(earlier) : this.ringsNow();
    const told = rings.some((ring) => ring.word !== undefined && !ring.palm);
    // What keeps from playing comes before what a finger has to do.
    const atFinger = told && this.shut.every((message) => message.hidden);
    // What a person has to do is not said in a demonstration.
    if (!atFinger || demonstrated) for (const ring of rings) if (!ring.palm) delete ring.word;
    // Nor is a label in doubt there: the simulated user knows its fingers.
    if (demonstrated) for (const ring of rings) ring.sure = true;
    // A finger has its true size, also on a smaller table.
    this.rings.draw(rings, Math.max(this.stage.lens.pxPerInch, this.touches ? pxPerInch() : 0));
    this.sayOneThing(atFinger);
    if (!frame || !scene) return;
    // Pictures of the table before may still come while another one is prepared.
    show(this.preparing, this.awaited);
    this.stage.move(earlier ?? frame, this.linked, demonstrated !== null);
    this.lift.demonstrate(demonstrated && this.raised(demonstrated));
    this.stage.draw();
    this.report(frame);
    const { player, heldAt } = this;
    const turned = this.turned.shown;
    const moment = { player, turned, demonstrated: demonstrated !== null, atFinger, heldAt };
    this.hud.setState(frame.state, scene.time_limit, moment);
    this.conclude(frame, scene);
    this.hint.follow(frame.state);
    if (!this.fingers.length && (!demonstrated || isPhone())) this.standAside();
    show(this.again, this.player && this.grip.now(frame, this.objects));
    if (!this.again.hidden) this.above(this.again);
    this.sayOneThing(atFinger);
  }

  /** Shows the result of a trial that is over to its player. */
  private conclude({ state }: Frame, scene: SceneMessage): void {
    if (state.status === "running" || !this.player || this.inStudy) {
      this.result.close();
      return;
    }
    this.result.open(state, this.heldAt ?? state.time, {
      task: scene.task,
      limit: scene.time_limit,
      scored: scene.scored ?? true,
      own: !scene.caption,
      sizeGuessed: this.sizeGuessed,
      tasks: this.tasks.map(({ name }) => name),
    });
    this.result.root.classList.toggle("watching", this.replay.shown || this.demonstration.shown);
  }

  /** Moves the hint and, before a trial, the words at the top away from what has to be seen. */
  private standAside(): void {
    const hinted = !this.hint.root.hidden;
    if (!hinted && this.placed) return;
    if (isPhone()) {
      this.placed = true;
      this.hint.standIn(this.hud.slot);
      return;
    }
    const strip = this.lift.root.hidden ? 0 : LIFT_STRIP_PX;
    const [left, right] = this.lift.side === "left" ? [strip, 0] : [0, strip];
    const things = [...this.stage.things(), ...this.demonstratedTouches()];
    if (!this.placed) this.hud.standAside(things, left, right);
    this.placed = true;
    if (!hinted) return;
    // To hide a word is worse than to hide a part of an object as large.
    const { texts } = this.hud;
    this.hint.stand([...things, ...texts, ...texts, ...texts], left, right);
  }

  /** m, height to which an object is raised in a demonstration: that of the hand that holds it. */
  private raised({ poses }: Frame): number {
    const first = this.demonstration.frames[0]?.poses;
    const rises = this.objects.map((row) => poses[7 * row + 2]! - (first?.[7 * row + 2] ?? 0));
    return Math.max(0, ...rises);
  }

  /** Rectangles of the touches of a demonstration, in CSS pixels. */
  private demonstratedTouches(): Rectangle[] {
    const side = 2 * ringRadius(pxPerInch());
    const taken = new Map<string, Rectangle>();
    for (const frame of this.demonstration.frames)
      for (const { position } of contactsOf(frame)) {
        const { x, y } = this.stage.lens.project(position);
        const [left, top] = [Math.round(x / side - 0.5) * side, Math.round(y / side - 0.5) * side];
        taken.set(`${left} ${top}`, { left, top, width: side, height: side });
      }
    return [...taken.values()];
  }

  /** Puts a message above the fingers that it is about, or below them where there is no room. */
  private above(message: HTMLElement): void {
    if (!this.fingers.length) return;
    const [xs, ys] = [this.fingers.map((f) => f.x), this.fingers.map((f) => f.y)];
    const { offsetWidth: width, offsetHeight: height } = message;
    const middle = (Math.min(...xs) + Math.max(...xs) - width) / 2;
    const clear = ringHeight(this.stage.lens.pxPerInch);
    const top = Math.min(...ys) - clear - height;
    const y = top >= this.hud.headerHeight ? top : Math.min(Math.max(...ys) + clear, window.innerHeight - height);
    message.style.left = `${Math.min(Math.max(middle, 0), window.innerWidth - width)}px`;
    message.style.top = `${y}px`;
  }

  /** Messages that keep from playing, the most important one first. */
  private get shut(): HTMLElement[] {
    const { curtain, trouble, turned, preparing, anew, result } = this;
    return [curtain, trouble, turned.root, preparing, anew.root, result.root];
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
    const contacts = this.frame ? contactsOf(this.frame) : [];
    if (this.player && !this.scene?.caption) {
      const known = new Map(contacts.map((c) => [c.id, c]));
      const { frame, scene } = this;
      const lone = frame && scene && this.grip.lone(frame, scene.fingers ?? 1);
      for (const id of this.ignored.keys()) if (!known.has(id)) this.ignored.delete(id);
      const rings: Ring[] = this.fingers.map(({ id, x, y, width, height }) => {
        const c = this.linked ? known.get(id) : undefined;
        const word = c && (c.id === lone ? say("use_two") : this.wordOf(c));
        return {
          x,
          y,
          label: c?.label ?? null,
          force: c?.force ?? 0,
          stored: c?.stored ?? 0,
          full: c?.full ?? false,
          ignored: !this.linked || c?.state === "ignored",
          sure: c?.sure ?? true,
          ...(word !== undefined && { word }),
          ...(c?.state === "palm" && { palm: { width, height } }),
        };
      });
      const gone = { label: null, force: 0, stored: 0, full: false, ignored: true, sure: true };
      for (const { x, y } of this.resting) rings.push({ x, y, ...gone });
      // One of them says it for all.
      const first = rings[this.fingers.length];
      if (first) first.word = this.again.textContent ?? "";
      return rings;
    }
    return this.frame ? this.ringsOf(this.frame) : [];
  }

  /** The word of a contact that is no finger of this hand, once it has rested for a moment. */
  private wordOf({ id, state, inside }: ContactState): string | undefined {
    if (state !== "ignored") this.ignored.delete(id);
    else if (!this.ignored.has(id)) this.ignored.set(id, performance.now());
    if (state === "palm") return say("palm");
    if (inside) return say("move_apart");
    // One of them says it for all.
    const [first] = this.ignored;
    return first?.[0] === id && performance.now() - first[1] > IGNORED_MS ? say("one_hand") : undefined;
  }

  /** Rings at the places that the computer sent. */
  private ringsOf(frame: Frame): Ring[] {
    return contactsOf(frame).map((c) => ({
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
    this.delay.touch = after_ms;
    this.connection.say({ type: "drawn", frame: frame.number, after_ms });
  }
}

const contactsOf = ({ state }: Frame): ContactState[] => state.hands.flatMap(({ contacts }) => contacts);

if (canDraw()) new Page();
else closeEarly();
