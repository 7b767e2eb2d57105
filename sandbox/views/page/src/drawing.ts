// Whether this browser can draw in 3D. Some cannot, in a virtual machine for one, and WebGL can be off.

import { say } from "./words";

/** False if there is no WebGL 2; then the page says so, in place of "Preparing the table". */
export function canDraw(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  // Browsers allow only a few contexts at a time.
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  if (context) return true;
  const line = document.querySelector<HTMLElement>(".preparing")!;
  line.setAttribute("role", "alert");
  line.textContent = say("no_drawing");
  return false;
}
