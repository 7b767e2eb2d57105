// What other programs find in our files, as JSON.
//
//   node read.mjs validate FILE.glb            the validator's counts of issues, and the first few
//   node read.mjs bvh FILE.bvh FRAME ...       places of all joints at some frames, file's units
//   node read.mjs glb FILE.glb SECONDS ...     places of all joints, and of some of the skin's vertices

import fs from "node:fs";
import * as THREE from "three";
import { BVHLoader } from "three/addons/loaders/BVHLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import validator from "gltf-validator";

globalThis.self = globalThis;

const [what, file, ...rest] = process.argv.slice(2);
const bytes = fs.readFileSync(file);

function places(root) {
  root.updateMatrixWorld(true);
  const found = {};
  root.traverse((node) => {
    if (node.name) found[node.name] = new THREE.Vector3().setFromMatrixPosition(node.matrixWorld).toArray();
  });
  return found;
}

function skinned(root) {
  const found = {};
  root.traverse((mesh) => {
    if (!mesh.isSkinnedMesh) return;
    mesh.skeleton.update();
    const out = [];
    for (let i = 0; i < mesh.geometry.attributes.position.count; i += 50) {
      const at = new THREE.Vector3().fromBufferAttribute(mesh.geometry.attributes.position, i);
      mesh.applyBoneTransform(i, at);
      out.push(at.applyMatrix4(mesh.matrixWorld).toArray());
    }
    found[mesh.name] = out;
  });
  return found;
}

function playOnce(mixer, clip) {
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true; // the last key is not the first one again
  action.play();
}

if (what === "validate") {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  console.log(JSON.stringify({
    errors: issues.numErrors, warnings: issues.numWarnings, infos: issues.numInfos, first: issues.messages.slice(0, 5),
  }));
} else if (what === "bvh") {
  const { skeleton, clip } = new BVHLoader().parse(bytes.toString("utf8"));
  const root = skeleton.bones[0];
  const mixer = new THREE.AnimationMixer(root);
  playOnce(mixer, clip);
  const frames = clip.tracks[0].times.length;
  const out = rest.map((frame) => {
    mixer.setTime(clip.tracks[0].times[Number(frame)]);
    return places(root);
  });
  console.log(JSON.stringify({ frames, duration: clip.duration, places: out }));
} else {
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await new GLTFLoader().parseAsync(buffer, "");
  const mixer = new THREE.AnimationMixer(gltf.scene);
  playOnce(mixer, gltf.animations[0]);
  const out = rest.map((time) => {
    mixer.setTime(Number(time));
    return { places: places(gltf.scene), skin: skinned(gltf.scene) };
  });
  console.log(JSON.stringify({ duration: gltf.animations[0].duration, moments: out }));
}
