// Whether and how this browser draws in 3D. Some cannot, in a virtual machine for one, and WebGL can be off.

import { say } from "./words";

/** Names of renderers that draw without a graphics card. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Smoothed edges are what a browser without a graphics card can afford least. */
const PLAIN: WebGLContextAttributes = { alpha: false, antialias: false, stencil: true };
let plain: WebGL2RenderingContext | null = null;

/** WebGL 2 on a canvas of its own, without smoothed edges; null if there is none. It is made once, as a browser
 * without a graphics card takes a tenth of a second for each. */
export function plainContext(): WebGL2RenderingContext | null {
  plain ??= document.createElement("canvas").getContext("webgl2", PLAIN);
  return plain;
}

/** Frees the plain context, if another one is used: browsers allow only a few at a time. */
export function freePlainContext(): void {
  plain?.getExtension("WEBGL_lose_context")?.loseContext();
  plain = null;
}

/** True if the browser draws without a graphics card. */
export function drawsSlowly(): boolean {
  const names = plainContext()?.getExtension("WEBGL_debug_renderer_info");
  return !!names && SOFTWARE.test(String(plain?.getParameter(names.UNMASKED_RENDERER_WEBGL)));
}

/** False if there is no WebGL 2; then the page says so, in place of "Preparing the table". */
export function canDraw(): boolean {
  if (plainContext()) return true;
  const line = document.querySelector<HTMLElement>(".preparing")!;
  line.setAttribute("role", "alert");
  line.textContent = say("no_drawing");
  return false;
}
