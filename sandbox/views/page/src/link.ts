// The link that opened the page, and the address of its WebSocket.

import { recallHere } from "./storage";

declare global {
  interface Window {
    /** The socket that was opened while the rest of the page was still coming. */
    earlySocket?: WebSocket | undefined;
  }
}

const query = new URLSearchParams(location.search);

export const token = query.get("token") ?? recallHere("token") ?? "";
export const spectator = query.get("role") === "spectator";

export function withToken(): string {
  const kept = new URLSearchParams({ token });
  if (spectator) kept.set("role", "spectator");
  return `/?${kept}`;
}

function socketAddress(): string {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${withToken()}`;
}

/** Opens the page's socket before the page can use it. */
export function openEarly(): void {
  window.earlySocket = new WebSocket(socketAddress());
}

/** The early socket for its first use, if it still lives; else a new one. */
export function openSocket(): WebSocket {
  const { earlySocket } = window;
  window.earlySocket = undefined;
  const alive = earlySocket && earlySocket.readyState <= WebSocket.OPEN;
  return alive ? earlySocket : new WebSocket(socketAddress());
}

/** Closes the early socket of a page that cannot use it; while it still connects, a browser would call that an
 * error. */
export function closeEarly(): void {
  const { earlySocket } = window;
  if (earlySocket?.readyState === WebSocket.CONNECTING) earlySocket.onopen = closeEarly;
  else earlySocket?.close();
}
