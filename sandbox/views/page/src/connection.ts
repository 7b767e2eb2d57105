// The WebSocket: sends hello, acknowledgements and heartbeats, and reconnects when it is lost.

import { clientName, reload, socketAddress, spectator } from "./link";
import { type Frame, parseFrame } from "./frame";
import { type Down, PROTOCOL, type Refusal, type SceneMessage, type Sheet, type Up, type Welcome } from "./protocol";
import { currentScreen } from "./screen";
import { type Skin, parseSkin } from "./skin";

const BEAT_MS = 500;
/** After this silence the socket counts as dead; tablets notice that only minutes later. */
const SILENCE_MS = 4000;
const SHORTEST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 5000;
/** Unsent bytes above which moves are held back: the network has stalled. */
const MOST_WAITING = 16384;

/** Close codes, as in sandbox/server/audience.py. */
const WRONG_VERSION = 4001;
const ENDS: Record<number, string> = {
  4001: "The program on the computer has another version. Load this page anew.",
  4002: "Too many pages are open. Close one of them.",
  4003: "You play in another tab now.",
  4004: "The computer did not understand this page. Load it anew.",
};

export type Condition = "connecting" | "open" | "lost" | "ended";

export interface Listener {
  onCondition(condition: Condition, words: string): void;
  onWelcome(welcome: Welcome): void;
  onScene(scene: SceneMessage): void;
  onSkin(skin: Skin): void;
  onTrouble(text: string): void;
  onSheet(sheet: Sheet): void;
  onRefusal(refusal: Refusal): void;
  onFrame(frame: Frame): void;
  onRoundTrip(ms: number): void;
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait = SHORTEST_WAIT_MS;
  private failures = 0;
  private heard = 0;
  private roundTrip: number | null = null;
  private timer = 0;

  constructor(private readonly listener: Listener) {
    window.setInterval(() => this.beat(), BEAT_MS);
    // A tablet that wakes up has lost its socket without an event.
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "visible") this.retryNow();
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

  say(message: Up): boolean {
    if (!this.isOpen) return false;
    this.socket!.send(JSON.stringify(message));
    return true;
  }

  private open(): void {
    window.clearTimeout(this.timer);
    this.listener.onCondition("connecting", "Connecting");
    const socket = new WebSocket(socketAddress());
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard = performance.now();
    socket.onopen = () => {
      this.say({
        type: "hello",
        protocol: PROTOCOL,
        client: clientName,
        role: spectator ? "spectator" : "player",
        screen: currentScreen(),
      });
    };
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
        if (skin) this.listener.onSkin(skin);
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
        this.listener.onCondition("open", "Connected");
        this.listener.onWelcome(message);
        break;
      case "scene":
        this.listener.onScene(message);
        break;
      case "trouble":
        this.listener.onTrouble(message.text);
        break;
      case "sheet":
        this.listener.onSheet(message);
        break;
      case "refusal":
        this.listener.onRefusal(message);
        break;
      case "echo":
        this.roundTrip = Math.max(performance.now() - message.t, 0);
        this.listener.onRoundTrip(this.roundTrip);
        break;
    }
  }

  private beat(): void {
    // A socket that is still connecting counts as well: a tablet would try for a minute or two.
    if (this.socket && performance.now() - this.heard > SILENCE_MS) {
      this.socket.close();
      this.lose(0);
    }
    if (!this.isOpen) return;
    const last = this.roundTrip === null ? {} : { round_trip_ms: Math.min(this.roundTrip, 60000) };
    this.roundTrip = null;
    this.say({ type: "beat", t: performance.now(), ...last });
  }

  private lose(code: number): void {
    this.socket = null;
    const words = ENDS[code];
    if (words && code !== 4002) {
      this.listener.onCondition("ended", words);
      if (code === WRONG_VERSION && performance.now() > 10000) reload();
      return;
    }
    this.failures += 1;
    const patience = "Connection lost. Trying again";
    const help = "No answer. Does `sandbox play` still run? If it was started anew, scan its code.";
    this.listener.onCondition("lost", words ?? (this.failures > 4 ? help : patience));
    this.timer = window.setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(this.wait * 1.7, LONGEST_WAIT_MS);
  }

  private retryNow(): void {
    if (this.socket || !this.timer) return;
    this.wait = SHORTEST_WAIT_MS;
    this.open();
  }
}
