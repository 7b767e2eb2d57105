// What stands on the table: built once per trial, moved by every frame. World: x right, y away, z up.

import {
  Bone,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  NotEqualStencilFunc,
  type Object3D,
  type Skeleton,
  SkinnedMesh,
} from "three";
import { SKIN } from "./colours";
import type { Frame } from "./frame";
import { Ghost } from "./ghost";
import { matMaterial, outline } from "./ground";
import type { Geom, SceneMessage } from "./protocol";
import { MARKED, TO_TOUCH, geometry, place } from "./shapes";
import { type Skin, wear } from "./skin";

/** Opacity of a hand that passes through objects. */
const GHOSTLY = 0.5;
/** Opacity of a waiting hand, without a finger down. */
const FAINT = 0.22;
const NO_COLOUR = new MeshBasicMaterial({ colorWrite: false, transparent: true });

export class Table {
  /** Everything, lights included, in the world's coordinates. */
  readonly root = new Group();
  private content = new Group();
  private scene: SceneMessage | null = null;
  private bodies: Bone[] = [];
  private skins = new Map<string, Skin>();
  private ghosts = new Map<string, Ghost>();
  private skin = handMaterial(SKIN);
  private skinned = handMaterial(0xffffff);
  /** Meshes that cast a hand's shadow. */
  private hands: Mesh[] = [];
  private key = keyLight();

  constructor() {
    const sky = new HemisphereLight(0xdfe8f2, 0x6b6560, 1.5);
    sky.position.set(0, 0, 1);
    this.root.add(sky, this.key, this.key.target);
  }

  /** Builds a new scene, and frees the last one. */
  open(scene: SceneMessage): void {
    this.root.remove(this.content);
    this.content.traverse(dispose);
    this.content = new Group();
    this.skin = handMaterial(SKIN);
    this.skinned = handMaterial(0xffffff);
    this.skinned.vertexColors = true;
    this.scene = scene;
    this.hands = [];
    this.bodies = scene.bodies.map(() => new Bone());
    for (const geom of scene.geoms) {
      const mesh = this.mesh(geom);
      this.bodies[geom.body]?.add(mesh);
      if (geom.part === "hand") this.bodies[geom.body]?.add(this.veil(mesh));
    }
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
   */
  move(frame: Frame, live: boolean): void {
    const poses = frame.poses;
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
    const opacity = solid ? 1 : down ? GHOSTLY : FAINT;
    this.skin.opacity = this.skinned.opacity = opacity;
    for (const part of [this.skin, this.skinned, NO_COLOUR]) {
      part.stencilWrite = !down && !solid;
      part.stencilRef = TO_TOUCH;
      part.stencilFunc = NotEqualStencilFunc;
    }
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
    if (!mesh || !veil) return;
    for (const body of (mesh.skeleton as Skeleton).bones)
      for (const child of body.children) child.visible = false;
    mesh.renderOrder = 4;
    veil.renderOrder = 3;
    veil.castShadow = false;
    this.hands.push(mesh);
    this.content.add(mesh, veil);
  }

  private mesh(geom: Geom): Mesh {
    const hand = geom.part === "hand";
    const mesh = new Mesh(geometry(geom, hand), hand ? this.skin : material(geom));
    place(mesh, geom);
    mesh.castShadow = geom.kind !== "plane";
    mesh.receiveShadow = true;
    if (hand) {
      mesh.renderOrder = 4;
      this.hands.push(mesh);
    }
    return mesh;
  }

  /** Draws a hand's nearest surface into the depth buffer before its colour, so that a translucent
   * hand shows one skin, and not every bone inside. */
  private veil(mesh: Mesh): Mesh {
    const veil = new Mesh(mesh.geometry, NO_COLOUR);
    veil.position.copy(mesh.position);
    veil.quaternion.copy(mesh.quaternion);
    veil.renderOrder = 3;
    return veil;
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

function keyLight(): DirectionalLight {
  const light = new DirectionalLight(0xfff1e0, 2.3);
  light.castShadow = true;
  light.shadow.mapSize.set(1024, 1024);
  light.shadow.bias = -0.0004;
  light.shadow.normalBias = 0.0015;
  return light;
}

function handMaterial(color: number): MeshStandardMaterial {
  return new MeshStandardMaterial({ color, roughness: 0.62, transparent: true });
}

function material(geom: Geom): MeshStandardMaterial {
  if (geom.kind === "plane") {
    const [a, b] = geom.size;
    return matMaterial(2 * (a || 2), 2 * (b || 2));
  }
  const [r, g, b, a] = geom.rgba;
  const colour = new Color().setRGB(r, g, b, "srgb");
  return new MeshStandardMaterial({
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
