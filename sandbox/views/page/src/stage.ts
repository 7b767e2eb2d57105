// The scene in three.js: the table, and the picture of it. World: x right, y away, z up.

import { Color, Mesh, type MeshStandardMaterial, PCFShadowMap, Scene as World, Vector3, WebGLRenderer } from "three";
import { BACKGROUND } from "./colours";
import { freePlainContext, plainContext } from "./drawing";
import type { Frame } from "./frame";
import { Lens, type Rectangle } from "./camera";
import type { SceneMessage } from "./protocol";
import { Quality } from "./quality";
import type { Skin } from "./skin";
import { Table } from "./table";

/** Slices of an object for the rectangles that it fills. */
const SLICES = 8;

export class Stage {
  readonly canvas: HTMLCanvasElement;
  readonly lens = new Lens();
  private readonly renderer: WebGLRenderer;
  private readonly quality: Quality;
  private readonly world = new World();
  private readonly table: Table;
  /** Signals the end of the last picture. */
  private unfinished: WebGLSync | null = null;
  /** ms, time at which the last picture was begun. */
  private began = 0;

  constructor(reload: () => void) {
    this.quality = new Quality(() => {
      this.resize();
      this.world.traverse((o) => {
        if (o instanceof Mesh) (o.material as MeshStandardMaterial).needsUpdate = true;
      });
    });
    const { smooth } = this.quality;
    this.table = new Table(!smooth);
    const context = smooth ? null : plainContext();
    if (!context) freePlainContext();
    this.canvas = context ? (context.canvas as HTMLCanvasElement) : document.createElement("canvas");
    const { canvas } = this;
    this.renderer = new WebGLRenderer({ canvas, ...(context && { context }), antialias: smooth, stencil: true });
    this.renderer.shadowMap.type = PCFShadowMap;
    this.quality.apply(this.renderer);
    // A lost context comes back empty; reloading the page is simpler than filling it again.
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      window.setTimeout(reload, 500);
    });
    this.world.background = new Color(BACKGROUND);
    this.world.add(this.table.root);
    this.resize();
  }

  resize(): void {
    this.renderer.setSize(window.innerWidth, window.innerHeight, false);
  }

  /** Builds a new scene, and frees the last one. */
  open(scene: SceneMessage): void {
    this.table.open(scene);
  }

  /** Takes a hand's skin, which is kept for later scenes. */
  dress(skin: Skin): void {
    this.table.dress(skin);
  }

  /** Sets all poses from a frame.
   *
   * @param live False if the connection is lost, and the hand stands where it was last.
   * @param demonstrated True for a frame of a demonstration.
   */
  move(frame: Frame, live: boolean, demonstrated: boolean): void {
    this.table.move(frame, live, demonstrated);
  }

  /** Rectangles on the page, in CSS pixels, of the objects and of their goals. */
  things(): Rectangle[] {
    return this.table.things().flatMap((mesh) => this.frames(mesh));
  }

  /** Rectangles around the slices of a mesh along its longest side: a handle that lies askew fills no large one. */
  private frames(mesh: Mesh): Rectangle[] {
    mesh.updateWorldMatrix(true, false);
    mesh.geometry.computeBoundingBox();
    const { min, max } = mesh.geometry.boundingBox!;
    const size = max.clone().sub(min);
    const axis = (["x", "y", "z"] as const).reduce((a, b) => (size[b] > size[a] ? b : a));
    return Array.from({ length: SLICES }, (_, i) => {
      const [from, to] = [min.clone(), max.clone()];
      from[axis] = min[axis] + (size[axis] * i) / SLICES;
      to[axis] = min[axis] + (size[axis] * (i + 1)) / SLICES;
      return this.frame(mesh, from, to);
    });
  }

  private frame(mesh: Mesh, min: Vector3, max: Vector3): Rectangle {
    const [xs, ys]: [number[], number[]] = [[], []];
    for (const x of [min.x, max.x])
      for (const y of [min.y, max.y])
        for (const z of [min.z, max.z]) {
          const corner = new Vector3(x, y, z).applyMatrix4(mesh.matrixWorld);
          const seen = this.lens.project([corner.x, corner.y, corner.z]);
          xs.push(seen.x);
          ys.push(seen.y);
        }
    const [left, top] = [Math.min(...xs), Math.min(...ys)];
    return { left, top, width: Math.max(...xs) - left, height: Math.max(...ys) - top };
  }

  /** True once the last picture is finished: another one before would only wait for it, and with it
   * everything else on the page, such as touches. */
  get free(): boolean {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (!this.unfinished) return true;
    if (gl.clientWaitSync(this.unfinished, 0, 0) === gl.TIMEOUT_EXPIRED) return false;
    gl.deleteSync(this.unfinished);
    this.unfinished = null;
    this.quality.finished(performance.now() - this.began);
    return true;
  }

  draw(): void {
    this.began = performance.now();
    this.renderer.render(this.world, this.lens.camera);
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.unfinished = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }
}
