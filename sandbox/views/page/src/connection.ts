// The WebSocket: sends hello, acknowledgements and heartbeats, and reconnects when it is lost.

import { openSocket, spectator } from "./link";
import { clientName, fileAddress, reload } from "./page-address";
import { parseDemonstration } from "./demonstration";
import { type Frame, parseFrame } from "./frame";
import { type Down, PROTOCOL, type Refusal, type SceneMessage, type Seat, type Sheet, type Localised, type Up, type Welcome } from "./protocol";
import { currentScreen } from "./screen";
import { type Skin, parseSkin } from "./skin";
import { sized } from "./window-size";
import { type Key, language } from "./words";

const BEAT_MS = 500;
/** After this silence the socket counts as dead; tablets notice that only minutes later. */
const SILENCE_MS = 4000;
/** A computer in the same network answers within a tenth of it. */
const CONNECT_MS = 1500;
const SHORTEST_WAIT_MS = 100;
/** So short that a page is back within two seconds of its network. */
const LONGEST_WAIT_MS = 500;
/** While the page is hidden, nobody waits. */
const HIDDEN_WAIT_MS = 5000;
/** After a goodbye, the program is perhaps started again some time. */
const PARTED_WAIT_MS = 3000;
/** Number of failures after each of which it asks why: perhaps another program answers by now. */
const ASKED_EVERY = 3;
/** Unsent bytes above which moves are held back: the network has stalled. */
const MOST_WAITING = 16384;

/** Close codes, as in sandbox/server/clients.py. */
const WRONG_VERSION = 4001;
const ENDS: Record<number, Key> = {
  4001: "other_version",
  4002: "too_many_pages",
  4003: "in_another_tab",
  4004: "not_understood",
  4005: "goodbye",
};
const GOODBYE = 4005;

export type Condition = "connecting" | "open" | "lost" | "ended";

export interface Listener {
  onCondition(condition: Condition, why: Key): void;
  onWelcome(welcome: Welcome): void;
  onScene(scene: SceneMessage): void;
  onSkin(skin: Skin): void;
  onDemonstration(frames: Frame[]): void;
  onTrouble(told: Localised[]): void;
  onSheet(sheet: Sheet): void;
  onRefusal(refusal: Refusal): void;
  onSeat(seat: Seat): void;
  onFrame(frame: Frame): void;
  onRoundTrip(ms: number): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait = SHORTEST_WAIT_MS;
  private failures = 0;
  private asking = false;
  private heard = 0;
  private roundTrip: number | null = null;
  private timer = 0;
  private isPresent = true;
  /** True after a goodbye: it says nothing while it looks whether the program is there again. */
  private parted = false;

  constructor(private readonly listener: Listener) {
    window.setInterval(() => this.beat(), BEAT_MS);
    // A tablet that wakes up has lost its socket without an event.
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "visible") this.retryNow();
    });
    window.addEventListener("pageshow", (event) => {
      if (event.persisted) this.retryNow();
    });
    window.addEventListener("online", () => this.retryNow());
    this.open();
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** True while sent messages are still in the socket's buffer. */
  get stalled(): boolean {
    return (this.socket?.bufferedAmount ?? 0) > MOST_WAITING;
  }

  /** Tells the computer whether this page can be played, now and after each reconnection. */
  appear(here: boolean): void {
    if (here === this.isPresent) return;
    this.isPresent = here;
    this.say({ type: "presence", here });
  }

  say(message: Up): boolean {
    if (!this.isOpen) return false;
    this.socket!.send(JSON.stringify(message));
    return true;
  }

  private open(): void {
    window.clearTimeout(this.timer);
    if (!sized()) {
      // No table could be laid for it.
      this.timer = window.setTimeout(() => this.open(), SHORTEST_WAIT_MS);
      return;
    }
    if (!this.parted) this.listener.onCondition("connecting", "connecting");
    const socket = openSocket();
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard = performance.now();
    const greet = (): void => {
      this.say({
        type: "hello",
        protocol: PROTOCOL,
        client: clientName,
        role: spectator ? "spectator" : "player",
        screen: currentScreen(),
        language: language.slice(0, 64),
      });
      if (!this.isPresent) this.say({ type: "presence", here: false });
    };
    if (socket.readyState === WebSocket.OPEN) greet();
    else socket.onopen = greet;
    socket.onmessage = (event) => {
      if (socket === this.socket) this.hear(event.data);
    };
    socket.onclose = (event) => {
      if (socket === this.socket) this.lose(event.code);
    };
  }

  private hear(data: string | ArrayBuffer): void {
    this.heard = performance.now();
    if (typeof data !== "string") {
      const frame = parseFrame(data);
      if (!frame) {
        const skin = parseSkin(data);
        const demonstration = parseDemonstration(data);
        if (skin) this.listener.onSkin(skin);
        if (demonstration) this.listener.onDemonstration(demonstration);
        return;
      }
      // At once, before anything is drawn: slow drawing must not slow down the stream.
      this.say({ type: "got", frame: frame.number });
      this.listener.onFrame(frame);
      return;
    }
    const message = JSON.parse(data) as Down;
    switch (message.type) {
      case "welcome":
        this.wait = SHORTEST_WAIT_MS;
        this.failures = 0;
        this.parted = false;
        this.listener.onCondition("open", "connected");
        this.listener.onWelcome(message);
        break;
      case "scene":
        this.listener.onScene(message);
        break;
      case "trouble":
        this.listener.onTrouble(message.told);
        break;
      case "sheet":
        this.listener.onSheet(message);
        break;
      case "refusal":
        this.listener.onRefusal(message);
        break;
      case "seat":
        this.listener.onSeat(message);
        break;
      case "echo":
        this.roundTrip = Math.max(performance.now() - message.t, 0);
        this.listener.onRoundTrip(this.roundTrip);
        break;
    }
  }

  private beat(): void {
    this.dropSilent();
    if (!this.isOpen) return;
    const last = this.roundTrip === null ? {} : { round_trip_ms: Math.min(this.roundTrip, 60000) };
    this.roundTrip = null;
    this.say({ type: "beat", t: performance.now(), ...last });
  }

  /** Gives up a socket that says nothing. One that is still connecting counts as well: a tablet would
   * try for a minute or two. */
  private dropSilent(): void {
    const patience = this.socket?.readyState === WebSocket.CONNECTING ? CONNECT_MS : SILENCE_MS;
    if (!this.socket || performance.now() - this.heard <= patience) return;
    this.socket.close();
    this.lose(0);
  }

  private lose(code: number): void {
    this.socket = null;
    const why = ENDS[code];
    if (code === GOODBYE) this.listener.onCondition("ended", "goodbye");
    this.parted ||= code === GOODBYE;
    if (this.parted) {
      this.timer = window.setTimeout(() => this.open(), PARTED_WAIT_MS);
      if (code !== GOODBYE) void this.askWhetherValid();
      return;
    }
    if (why && code !== 4002) {
      this.listener.onCondition("ended", why);
      if (code === WRONG_VERSION && performance.now() > 10000) reload();
      return;
    }
    this.failures += 1;
    this.listener.onCondition("lost", why ?? (this.failures > 9 ? "no_answer" : "lost_trying"));
    const wait = document.hidden ? HIDDEN_WAIT_MS : this.wait;
    this.timer = window.setTimeout(() => this.open(), wait);
    this.wait = Math.min(this.wait * 1.7, LONGEST_WAIT_MS);
    if (this.failures % ASKED_EVERY === 0) void this.askWhetherValid();
  }

  /** A browser does not say why a socket was refused; a request says it. */
  private async askWhetherValid(): Promise<void> {
    if (this.asking) return;
    this.asking = true;
    const giveUp = new AbortController();
    const timer = window.setTimeout(() => giveUp.abort(), CONNECT_MS);
    const answer = await fetch(fileAddress("app.css"), { signal: giveUp.signal }).catch(() => null);
    window.clearTimeout(timer);
    this.asking = false;
    if (answer?.status !== 403 || this.isOpen) return;
    window.clearTimeout(this.timer);
    this.timer = 0;
    this.socket?.close();
    this.socket = null;
    this.listener.onCondition("ended", "link_invalid");
  }

  private retryNow(): void {
    this.dropSilent();
    if (this.socket || !this.timer) return;
    this.wait = SHORTEST_WAIT_MS;
    this.open();
  }
}
