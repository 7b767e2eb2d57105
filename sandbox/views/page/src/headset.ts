// A headset's page: enters VR, shows the table at its true size, and sends the person's hands.

import {
  Color,
  type Material,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  PCFShadowMap,
  Scene as World,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { BACKGROUND } from "./colours";
import { Connection } from "./connection";
import { make, show, write } from "./dom";
import { canDraw, freePlainContext } from "./drawing";
import type { Frame } from "./frame";
import { Hands, type Seen } from "./headset-hands";
import { Lens } from "./camera";
import { spectator } from "./link";
import { reload } from "./page-address";
import type { SceneMessage, State } from "./protocol";
import { Quality } from "./quality";
import { Sign } from "./sign";
import { Table } from "./table";
import { repeat, say, taskName, word } from "./words";

/** m from the eyes to the middle of the table, ahead and down. */
const [AHEAD, DOWN] = [0.42, 0.42];
/** m, where the sign stands behind the table's middle, and how high its middle is. */
const [BEHIND, ABOVE] = [0.36, 0.2];
/** m, the ball that begins again: its radius, and its distance from the table's edge. */
const [BALL, ASIDE] = [0.025, 0.09];
/** ms for which a finger stays in the ball. */
const DWELL_MS = 700;
const TIPS = [4, 9, 14, 19, 24];
const IN_THE_WORLD = new Matrix4().makeRotationX(-Math.PI / 2);

class HeadsetPage {
  private readonly canvas = make("canvas", "flat");
  private readonly line = make("p", "line");
  private readonly goal = make("p", "goal");
  private readonly enter = make("button", "enter", {
    text: say("headset_enter"),
    onTap: () => void this.begin(),
  });
  private readonly world = new World();
  private readonly quality = new Quality(() =>
    this.world.traverse((o) => {
      if (o instanceof Mesh) (o.material as Material).needsUpdate = true;
    }),
  );
  private readonly renderer = new WebGLRenderer({
    canvas: this.canvas,
    antialias: this.quality.smooth,
    stencil: true,
  });
  private readonly table = new Table();
  private readonly sign = new Sign();
  private readonly ball = new Mesh(
    new SphereGeometry(BALL, 24, 12),
    new MeshStandardMaterial({ color: 0x2f7fd1, roughness: 0.5, transparent: true, opacity: 0.8 }),
  );
  private readonly lens = new Lens();
  private readonly hands = new Hands();
  private readonly connection: Connection;
  private scene: SceneMessage | null = null;
  private state: State | null = null;
  private live = false;
  private laid = false;
  private seq = 0;
  /** ms, time of the last picture. */
  private drawn = 0;
  /** ms, since when a finger has been in the ball; null while there is none. */
  private since: number | null = null;

  constructor() {
    document.querySelector(".preparing")?.remove();
    this.line.setAttribute("role", "status");
    document.body.append(
      this.canvas,
      make("div", "panel", {}, this.line, this.goal, this.enter),
    );
    show(this.enter, false);
    freePlainContext();
    this.quality.apply(this.renderer);
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.xr.enabled = true;
    this.renderer.xr.setReferenceSpaceType("local");
    this.world.background = new Color(BACKGROUND);
    this.table.root.matrixAutoUpdate = false;
    this.table.root.add(this.sign.mesh, this.ball);
    this.sign.mesh.position.set(0, BEHIND, ABOVE);
    this.world.add(this.table.root);
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      window.setTimeout(reload, 500);
    });
    window.addEventListener("resize", () => this.resize());
    this.resize();
    this.connection = new Connection({
      onCondition: (condition, why) => {
        this.live = condition === "open";
        if (condition === "open") void this.offer();
        else this.tell(say(why));
      },
      onWelcome: () => undefined,
      onScene: (scene) => this.open(scene),
      onDemonstration: () => undefined,
      onSkin: (skin) => this.table.dress(skin),
      onTrouble: (told) => this.tell(told.map(repeat).join(" ")),
      onSheet: () => undefined,
      onRefusal: () => undefined,
      onSeat: () => undefined,
      onFrame: (frame) => this.take(frame),
      onRoundTrip: () => undefined,
    });
    this.renderer.setAnimationLoop((now, frame) => this.draw(now, frame));
  }

  private resize(): void {
    if (this.renderer.xr.isPresenting) return;
    this.renderer.setSize(window.innerWidth, window.innerHeight, false);
    this.aim();
  }

  private aim(): void {
    const { scene } = this;
    if (scene)
      this.lens.overlook(scene.surface, scene.hand, window.innerWidth, window.innerHeight, true);
  }

  private tell(text: string): void {
    write(this.line, text);
  }

  /** Offers VR, or says in one line why there is none. */
  private async offer(): Promise<void> {
    if (this.renderer.xr.isPresenting) return;
    const there =
      (await navigator.xr?.isSessionSupported("immersive-vr").catch(() => false)) ?? false;
    show(this.enter, there && !spectator);
    if (spectator) this.tell("");
    else if (there) this.tell(say("headset_ready"));
    else this.tell(say(window.isSecureContext ? "headset_none" : "headset_insecure"));
  }

  /** Enters VR; called by a tap, as browsers ask for one. */
  private async begin(): Promise<void> {
    try {
      const session = await navigator.xr!.requestSession("immersive-vr", {
        optionalFeatures: ["hand-tracking"],
      });
      session.addEventListener("end", () => this.leave());
      session.addEventListener("visibilitychange", () =>
        this.connection.appear(session.visibilityState === "visible"),
      );
      this.laid = false;
      await this.renderer.xr.setSession(session);
      // Who holds the headset's button down looks straight ahead again: the table comes, too.
      this.renderer.xr.getReferenceSpace()?.addEventListener("reset", () => (this.laid = false));
    } catch {
      this.tell(say("headset_refused"));
      return;
    }
    this.connection.appear(true);
    show(this.enter, false);
    this.tell(say("headset_inside"));
  }

  private leave(): void {
    this.connection.appear(false);
    this.table.root.matrix.identity();
    this.resize();
    show(this.enter, true);
    this.tell(say("headset_left"));
  }

  private open(scene: SceneMessage): void {
    this.scene = scene;
    this.table.open(scene);
    const half = (scene.surface.width_in / 2) * 0.0254;
    this.ball.position.set(scene.hand === "right" ? half + ASIDE : -half - ASIDE, 0, 2 * BALL);
    write(this.goal, word(`goal_${scene.task}`, scene.goal));
    this.aim();
  }

  private take(frame: Frame): void {
    if (frame.scene !== this.scene?.scene) return;
    this.state = frame.state;
    this.table.move(frame, this.live);
  }

  private draw(now: number, frame: XRFrame | undefined): void {
    const space = this.renderer.xr.getReferenceSpace();
    if (frame && space) this.inside(now, frame, space);
    else if (!this.scene) return;
    this.post();
    this.renderer.render(this.world, this.lens.camera);
    this.quality.note(now - this.drawn);
    this.drawn = now;
  }

  /** Lays the table before the person once, and sends their hands. */
  private inside(now: number, frame: XRFrame, space: XRReferenceSpace): void {
    if (!this.laid) this.lay(frame, space);
    if (!this.laid) return;
    const seen = this.hands.seen(frame, space, this.table.root.matrix);
    // Only the newest hands count: on a slow network older ones would queue.
    if (!this.connection.stalled) this.connection.say({ type: "hands", seq: ++this.seq, t: now, ...seen });
    this.again(now, seen);
  }

  /** Lays the table before the eyes, turned towards them. */
  private lay(frame: XRFrame, space: XRReferenceSpace): void {
    const pose = frame.getViewerPose(space);
    if (!pose) return;
    const head = new Matrix4().fromArray(pose.transform.matrix);
    const eyes = new Vector3().setFromMatrixPosition(head);
    const ahead = new Vector3(0, 0, -1).transformDirection(head).setY(0);
    if (ahead.lengthSq() < 0.01) return;
    ahead.normalize();
    const middle = eyes.addScaledVector(ahead, AHEAD).add(new Vector3(0, -DOWN, 0));
    this.table.root.matrix
      .makeRotationY(Math.atan2(-ahead.x, -ahead.z))
      .multiply(IN_THE_WORLD)
      .setPosition(middle);
    this.table.root.matrixWorldNeedsUpdate = true;
    this.laid = true;
  }

  /** A fingertip that stays in the ball, or a controller whose trigger is pulled there, begins again. */
  private again(now: number, seen: Seen): void {
    const points = [
      ...seen.hands.flatMap(({ joints }) => TIPS.map((tip) => joints[tip] ?? null)),
      ...seen.controllers.map(({ position, trigger }) => (trigger > 0.5 ? position : null)),
    ];
    const inside = points.some(
      (at) => at && this.ball.position.distanceTo(new Vector3(...at)) < 1.3 * BALL,
    );
    if (!inside) this.since = null;
    else if (this.since === null) this.since = now;
    else if (now - this.since > DWELL_MS) {
      this.since = Infinity;
      this.connection.say({ type: "ask", what: "retry" });
    }
  }

  /** Writes the sign. */
  private post(): void {
    const { scene, state } = this;
    if (!scene) return;
    const notices = state?.notices.map(repeat) ?? [];
    const over = state !== null && state.status !== "running";
    this.sign.write([
      taskName(scene.task),
      word(`goal_${scene.task}`, scene.goal),
      state ? say("seconds", { time: state.time.toFixed(0) }) : "",
      this.live ? this.words(state, over) : say("lost_trying"),
      ...(over ? [] : notices),
      say("headset_again"),
    ]);
  }

  private words(state: State | null, over: boolean): string {
    if (!state) return "";
    if (state.held) return say("success");
    if (over) return say(state.status === "timeout" ? "time_up" : "over");
    if (state.pause) return say("headset_hands");
    return state.reason ? repeat(state.reason) : "";
  }
}

if (canDraw()) new HeadsetPage();
