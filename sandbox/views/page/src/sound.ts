// Short synthesised tones: a tick when a finger touches an object, a chord at success.

import { recall, remember } from "./storage";

export class Sound {
  private context: AudioContext | null = null;
  muted = recall("muted") === "yes";

  constructor() {
    // A browser allows sound only after a touch.
    window.addEventListener("pointerup", () => this.wake());
    window.addEventListener("keydown", () => this.wake());
  }

  toggle(): boolean {
    this.muted = !this.muted;
    remember("muted", this.muted ? "yes" : "no");
    return this.muted;
  }

  /** Plays the tick of a finger that touches an object. */
  contact(label: number): void {
    this.tone(190 + 40 * label, 0, 0.07, 0.1, "triangle");
  }

  success(): void {
    [523.25, 659.25, 783.99, 1046.5].forEach((f, i) => this.tone(f, 0.09 * i, 0.45, 0.12, "sine"));
  }

  private wake(): void {
    const Kind = window.AudioContext as typeof AudioContext | undefined;
    if (!Kind) return;
    this.context ??= new Kind();
    if (this.context.state === "suspended") void this.context.resume().catch(() => undefined);
  }

  private tone(hertz: number, after: number, long: number, loud: number, type: OscillatorType): void {
    const context = this.context;
    if (this.muted || !context || context.state !== "running") return;
    const start = context.currentTime + after;
    const oscillator = context.createOscillator();
    const gain = context.createGain();
    oscillator.type = type;
    oscillator.frequency.value = hertz;
    gain.gain.setValueAtTime(0, start);
    gain.gain.linearRampToValueAtTime(loud, start + 0.006);
    gain.gain.exponentialRampToValueAtTime(0.0001, start + long);
    oscillator.connect(gain).connect(context.destination);
    oscillator.start(start);
    oscillator.stop(start + long + 0.02);
  }
}
