// What stands on the table: built once per trial, moved by every frame. World: x right, y away, z up.

import {
  Bone,
  Color,
  DirectionalLight,
  EqualStencilFunc,
  Group,
  HemisphereLight,
  type Material,
  Mesh,
  MeshBasicMaterial,
  type MeshStandardMaterialParameters,
  NotEqualStencilFunc,
  type Object3D,
  type Skeleton,
  SkinnedMesh,
} from "three";
import { SKIN } from "./colours";
import type { Frame } from "./frame";
import { Ghost } from "./goal-copy";
import { matMaterial, outline } from "./ground";
import type { Geom, SceneMessage } from "./protocol";
import { MARKED, type Surfaced, TO_TOUCH, geometry, place, surfaced } from "./shapes";
import { type Skin, wear } from "./skin";

/** Opacity of a hand that passes through objects. */
const GHOSTLY = 0.5;
/** Opacity of a waiting hand, without a finger down. */
const FAINT = 0.22;
/** Opacity of the hand of a demonstration: what it touches is seen through it. */
const DEMONSTRATED = 0.55;
/** Opacity of a hand that holds something, where it covers an object or a goal. */
const THROUGH = 0.4;
/** N, grip from which a hand counts as holding something. */
const HELD = 1;
const NO_COLOUR = new MeshBasicMaterial({ colorWrite: false, transparent: true });

export class Table {
  /** Everything, lights included, in the world's coordinates. */
  readonly root = new Group();
  private content = new Group();
  private scene: SceneMessage | null = null;
  private bodies: Bone[] = [];
  /** Geoms of hands that are not drawn yet: a skin, which comes before the first frame, covers them. */
  private bare: Geom[] = [];
  private skins = new Map<string, Skin>();
  private ghosts = new Map<string, Ghost>();
  private skin: Surfaced;
  private skinned: Surfaced;
  /** The same where a hand covers what it holds. */
  private through: readonly [Surfaced, Surfaced];
  /** Meshes that cast a hand's shadow. */
  private hands: Mesh[] = [];
  private key = keyLight();

  /** @param plain See `surfaced`. */
  constructor(private readonly plain = false) {
    [this.skin, this.skinned, this.through] = this.handMaterials();
    const sky = new HemisphereLight(0xdfe8f2, 0x6b6560, 1.5);
    sky.position.set(0, 0, 1);
    this.root.add(sky, this.key, this.key.target);
  }

  /** Builds a new scene, and frees the last one. */
  open(scene: SceneMessage): void {
    this.root.remove(this.content);
    this.content.traverse(dispose);
    this.content = new Group();
    [this.skin, this.skinned, this.through] = this.handMaterials();
    this.scene = scene;
    this.hands = [];
    this.bodies = scene.bodies.map(() => new Bone());
    this.bare = scene.geoms.filter((geom) => geom.part === "hand");
    for (const geom of scene.geoms)
      if (geom.part !== "hand") this.bodies[geom.body]?.add(this.mesh(geom, material(geom, this.plain)));
    this.content.add(...this.bodies, outline(scene.surface));
    this.ghosts = new Map(
      scene.bodies.map((name, i) => [
        name,
        new Ghost(scene.geoms.filter((g) => g.body === i && g.part === "object")),
      ]),
    );
    this.root.add(this.content);
    this.light(scene);
    for (const skin of this.skins.values()) this.wear(skin);
  }

  /** Takes a hand's skin, which is kept for later scenes. */
  dress(skin: Skin): void {
    const palm = skin.names[0] ?? "";
    if (this.skins.has(palm) && this.scene) {
      // Another hand of the same name: the scene is rebuilt without the old one.
      this.skins.delete(palm);
      this.open(this.scene);
    }
    this.skins.set(palm, skin);
    this.wear(skin);
  }

  /** Sets all poses from a frame.
   *
   * @param live False if the connection is lost, and the hand stands where it was last.
   * @param demonstrated True for a frame of a demonstration, whose hand is seen before what it touches.
   */
  move(frame: Frame, live: boolean, demonstrated = false): void {
    const poses = frame.poses;
    this.addBareHands();
    this.bodies.forEach((body, i) => {
      const at = 7 * i;
      if (at + 7 > poses.length) return;
      body.position.set(poses[at]!, poses[at + 1]!, poses[at + 2]!);
      body.quaternion.set(poses[at + 4]!, poses[at + 5]!, poses[at + 6]!, poses[at + 3]!);
    });
    const { goals, hands, reached, held } = frame.state;
    for (const goal of goals) {
      const ghost = this.ghosts.get(goal.object);
      if (!ghost) continue;
      if (!ghost.group.parent) this.content.add(ghost.group);
      ghost.show(goal, reached, held);
    }
    const down = live && hands.some((hand) => hand.contacts.length);
    const solid = live && hands.some((hand) => hand.solid.length);
    const faint = solid ? 1 : down ? GHOSTLY : FAINT;
    const opacity = demonstrated ? DEMONSTRATED : faint;
    const holds = solid && !demonstrated && hands.some(({ contacts }) => contacts.some(({ stored }) => (stored ?? 0) >= HELD));
    this.skin.opacity = this.skinned.opacity = opacity;
    for (const part of [this.skin, this.skinned, NO_COLOUR]) {
      part.stencilWrite = (!demonstrated && !down && !solid) || (holds && part !== NO_COLOUR);
      part.stencilRef = TO_TOUCH;
      part.stencilFunc = NotEqualStencilFunc;
    }
    for (const part of this.through) part.visible = holds;
    // A hand that waits in the air is nearly transparent, and casts no shadow.
    for (const mesh of this.hands) mesh.castShadow = down || opacity === 1;
  }

  /** Meshes of the objects and of their goals. */
  things(): Mesh[] {
    const meshes: Mesh[] = [];
    const find = (object: Object3D): void => object.traverse((o) => {
      if (o instanceof Mesh) meshes.push(o);
    });
    for (const [i, body] of this.bodies.entries())
      if (this.scene?.geoms.some((g) => g.body === i && g.part === "object")) find(body);
    for (const ghost of this.ghosts.values()) if (ghost.group.parent) find(ghost.group);
    return meshes;
  }

  /** Hides a hand's bones behind its skin. */
  private wear(skin: Skin): void {
    if (!this.scene) return;
    const mesh = wear(skin, this.bodies, this.scene.bodies, this.skinned);
    const veil = wear(skin, this.bodies, this.scene.bodies, NO_COLOUR);
    const through = wear(skin, this.bodies, this.scene.bodies, this.through[1]);
    if (!mesh || !veil || !through) return;
    const covered = new Set<Object3D>((mesh.skeleton as Skeleton).bones);
    this.bare = this.bare.filter((geom) => !covered.has(this.bodies[geom.body]!));
    for (const body of covered) for (const child of body.children) child.visible = false;
    mesh.renderOrder = 4;
    veil.renderOrder = 3;
    through.renderOrder = 4;
    veil.castShadow = through.castShadow = false;
    this.hands.push(mesh);
    this.content.add(mesh, veil, through);
  }

  /** Materials of bones, of skins, and of the pixels of both that cover what has to be touched. */
  private handMaterials(): [Surfaced, Surfaced, readonly [Surfaced, Surfaced]] {
    const bones = { color: SKIN, roughness: 0.62, transparent: true };
    const skins = { ...bones, color: 0xffffff, vertexColors: true };
    const covering = {
      opacity: THROUGH,
      visible: false,
      stencilWrite: true,
      stencilRef: TO_TOUCH,
      stencilFunc: EqualStencilFunc,
    };
    const make = (look: MeshStandardMaterialParameters): Surfaced => surfaced(this.plain, look);
    return [make(bones), make(skins), [make({ ...bones, ...covering }), make({ ...skins, ...covering })]];
  }

  /** Adds the bones of the hands that no skin covers. */
  private addBareHands(): void {
    for (const geom of this.bare) {
      const mesh = this.mesh(geom, this.skin, true);
      mesh.renderOrder = 4;
      this.hands.push(mesh);
      this.bodies[geom.body]?.add(mesh, copy(mesh, NO_COLOUR, 3), copy(mesh, this.through[0], 4));
    }
    this.bare = [];
  }

  private mesh(geom: Geom, of: Material, fine = false): Mesh {
    const mesh = new Mesh(geometry(geom, fine), of);
    place(mesh, geom);
    mesh.castShadow = geom.kind !== "plane";
    mesh.receiveShadow = true;
    return mesh;
  }

  /** Adds the sun, with shadows around the touch rectangle. */
  private light(scene: SceneMessage): void {
    const [x, y] = scene.surface.origin;
    const reach = 0.2;
    this.key.target.position.set(x + 0.1, y - 0.08, 0.02);
    this.key.position.copy(this.key.target.position);
    this.key.position.x += scene.hand === "right" ? -0.35 : 0.35;
    this.key.position.y -= 0.2;
    this.key.position.z += 0.8;
    const eye = this.key.shadow.camera;
    eye.left = eye.bottom = -reach;
    eye.right = eye.top = reach;
    eye.near = 0.3;
    eye.far = 1.6;
    eye.updateProjectionMatrix();
  }
}

/** A mesh in the same place with another material. Without colour it draws a hand's nearest surface into the
 * depth buffer before its colour, so that a translucent hand shows one skin, and not every bone inside. */
function copy(mesh: Mesh, of: Material, order: number): Mesh {
  const other = new Mesh(mesh.geometry, of);
  other.position.copy(mesh.position);
  other.quaternion.copy(mesh.quaternion);
  other.renderOrder = order;
  return other;
}

function keyLight(): DirectionalLight {
  const light = new DirectionalLight(0xfff1e0, 2.3);
  light.castShadow = true;
  light.shadow.mapSize.set(1024, 1024);
  light.shadow.bias = -0.0004;
  light.shadow.normalBias = 0.0015;
  return light;
}

function material(geom: Geom, plain: boolean): Surfaced {
  if (geom.kind === "plane") {
    const [a, b] = geom.size;
    return matMaterial(2 * (a || 2), 2 * (b || 2), plain);
  }
  const [r, g, b, a] = geom.rgba;
  const colour = new Color().setRGB(r, g, b, "srgb");
  return surfaced(plain, {
    color: colour,
    roughness: 0.55,
    transparent: a < 1,
    opacity: a,
    ...(geom.part === "object" && MARKED),
  });
}

function dispose(object: Object3D): void {
  if (!(object instanceof Mesh)) return;
  // The geometry of a skin is shared by all scenes; only the skeleton's texture is freed.
  if (object instanceof SkinnedMesh) object.skeleton.dispose();
  else object.geometry.dispose();
  for (const m of [object.material].flat()) {
    m.map?.dispose();
    m.dispose();
  }
}
