// The link that opened the page: its token goes out of sight, since links are photographed and
// sent around, and stays in this tab so that the page can reconnect and reload.

import { recallHere, rememberHere } from "./memory";

const query = new URLSearchParams(location.search);

export const token = query.get("token") ?? recallHere("token") ?? "";
export const spectator = query.get("role") === "spectator";

/** The page's own random name: the same after a reload, so that it gets its own seat back. */
export const clientName = recallHere("client") ?? randomName();

rememberHere("token", token);
rememberHere("client", clientName);
history.replaceState(null, "", location.pathname + (spectator ? "?role=spectator" : ""));

function withToken(): string {
  const kept = new URLSearchParams({ token });
  if (spectator) kept.set("role", "spectator");
  return `/?${kept}`;
}

export function socketAddress(): string {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${withToken()}`;
}

/** Loads the page anew; a plain reload would come without the token, and be refused. */
export function reload(): void {
  location.replace(withToken());
}

function randomName(): string {
  // crypto.randomUUID does not exist on plain http; getRandomValues does.
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (b) => b.toString(16).padStart(2, "0")).join("");
}
