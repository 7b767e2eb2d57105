// The address of the page: its token is removed from the address bar, since links are photographed and
// shared, and stored in this tab so that the page can reconnect and reload (see return.html).

import { spectator, token, withToken } from "./link";
import { recall, recallHere, remember, rememberHere } from "./storage";

/** The browser's random name, the same in its next tab, so that it remains the player. */
export const clientName = recallHere("client") ?? recall("client") ?? randomName();

rememberHere("token", token);
rememberHere("client", clientName);
remember("client", clientName);
// An installed page begins in a tab of its own, at an address without the token (see return.html).
window.addEventListener("appinstalled", () => remember("token", token));
if (matchMedia("(display-mode: standalone)").matches) remember("token", token);
history.replaceState(null, "", location.pathname + (spectator ? "?role=spectator" : ""));

export const fileAddress = (name: string): string =>
  `/${name}?${new URLSearchParams({ token })}`;

/** Reloads the page with the token, without the detour of a plain reload. */
export function reload(): void {
  location.replace(withToken());
}

/** Looks on from now on, and leaves the place to another page. */
export function lookOn(): void {
  location.replace(`/?${new URLSearchParams({ token, role: "spectator" })}`);
}

function randomName(): string {
  // crypto.randomUUID does not exist on plain http; getRandomValues does.
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (b) => b.toString(16).padStart(2, "0")).join("");
}
