// Writes the VRM files and the VRM animation of tests/cases/vrm, and the positions of their bones
// in every frame by three.js and three-vrm: `node vrm.mjs ../cases/vrm`, with three 0.187.0,
// @pixiv/three-vrm 3.5.5 and @pixiv/three-vrm-animation 3.5.5 installed beside this file.

import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { AnimationMixer, Matrix4, Quaternion, Vector3 } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { VRMLoaderPlugin, VRMUtils } from "@pixiv/three-vrm";
import { VRMAnimationLoaderPlugin, createVRMAnimationClip } from "@pixiv/three-vrm-animation";

const FRAMES = 24;
const FPS = 30;

// Bone, parent, and offset from it in a T-pose that faces +Z, metres.
const BONES = [
  ["hips", null, [0, 0.93, 0]],
  ["spine", 0, [0, 0.08, 0]],
  ["chest", 1, [0, 0.13, 0]],
  ["neck", 2, [0, 0.27, 0]],
  ["head", 3, [0, 0.09, 0]],
  ...["left", "right"].flatMap((side, index) => {
    const sign = index === 0 ? 1 : -1;
    const arm = 5 + 9 * index;
    return [
      [`${side}Shoulder`, 2, [0.03 * sign, 0.2, 0]],
      [`${side}UpperArm`, arm, [0.13 * sign, 0, 0]],
      [`${side}LowerArm`, arm + 1, [0.26 * sign, 0, 0]],
      [`${side}Hand`, arm + 2, [0.23 * sign, 0, 0]],
      [`${side}IndexProximal`, arm + 3, [0.08 * sign, 0, 0.02]],
      [`${side}UpperLeg`, 0, [0.09 * sign, -0.05, 0]],
      [`${side}LowerLeg`, arm + 5, [0, -0.41, 0]],
      [`${side}Foot`, arm + 6, [0, -0.39, 0]],
      [`${side}Toes`, arm + 7, [0, -0.07, 0.12]],
    ];
  }),
];
// Joints that a reader knows by the bone map; the others it can only know by their names.
const NAMED = /Shoulder|Index|neck|chest/;

/** Returns numbers in -1 to 1 that depend on the seed alone. */
function noise(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 31 - 1;
  };
}

function rotation(random, size) {
  const axis = new Vector3(random(), random(), random()).normalize();
  return new Quaternion().setFromAxisAngle(axis, size * random());
}

/** A body of the bones, its nodes with axes of their own, below a root node. */
function body({ seed, size, turned, rootAt }) {
  const random = noise(seed);
  const facing = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), turned ? Math.PI : 0);
  const axes = BONES.map(() => rotation(random, Math.PI));
  const root = { name: "root", translation: rootAt, rotation: rotation(random, 1), children: [1] };
  const nodes = BONES.map(([bone, parent, offset], index) => {
    const above = parent === null ? root.rotation : axes[parent];
    const place = new Vector3(...offset).multiplyScalar(size).applyQuaternion(facing);
    if (parent === null) place.sub(new Vector3(...rootAt));
    return {
      name: NAMED.test(bone) ? bone : `node ${seed}.${(index * 7) % BONES.length}`,
      translation: place.applyQuaternion(above.clone().invert()).toArray(),
      rotation: above.clone().invert().multiply(axes[index]),
      children: BONES.flatMap((child, at) => (child[1] === index ? [at + 1] : [])),
    };
  });
  return { nodes: [root, ...nodes], axes };
}

/** Rotations of all bones in the world's axes at rest, and places of the hips, frame by frame. */
function motion() {
  const random = noise(5);
  const waves = BONES.map(() => [rotation(random, 1), 1 + random(), 3 * random()]);
  const turn = (bone, frame) => {
    const [peak, speed, start] = waves[bone];
    return new Quaternion().slerp(peak, 0.8 * Math.sin(start + 0.2 * speed * frame));
  };
  const hips = (frame) => [0.04 * frame, 0.93 + 0.05 * Math.sin(frame), -0.02 * frame];
  return { turn, hips };
}

class Glb {
  constructor({ nodes }) {
    const plain = nodes.map((node) => ({ ...node, rotation: node.rotation.toArray() }));
    for (const node of plain) if (node.children.length === 0) delete node.children;
    this.json = { asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: plain };
    this.floats = [];
  }

  accessor(type, width, values) {
    const { json } = this;
    json.accessors ??= [];
    json.bufferViews ??= [];
    json.bufferViews.push({ buffer: 0, byteOffset: 4 * this.floats.length, byteLength: 4 * values.length });
    this.floats.push(...values);
    const range = width === 1 ? { min: [Math.min(...values)], max: [Math.max(...values)] } : {};
    return json.accessors.push({
      bufferView: json.bufferViews.length - 1, componentType: 5126, count: values.length / width, type, ...range,
    }) - 1;
  }

  bytes() {
    const binary = Buffer.from(new Float32Array(this.floats).buffer);
    if (binary.length) this.json.buffers = [{ byteLength: binary.length }];
    let text = JSON.stringify(this.json);
    text += " ".repeat((4 - (text.length % 4)) % 4);
    const chunk = (kind, bytes) => {
      const head = Buffer.alloc(8);
      head.writeUInt32LE(bytes.length, 0);
      head.write(kind, 4, "latin1");
      return Buffer.concat([head, bytes]);
    };
    const chunks = [chunk("JSON", Buffer.from(text)), ...(binary.length ? [chunk("BIN\0", binary)] : [])];
    const head = Buffer.alloc(12);
    head.write("glTF", 0, "latin1");
    head.writeUInt32LE(2, 4);
    head.writeUInt32LE(12 + chunks.reduce((sum, part) => sum + part.length, 0), 8);
    return Buffer.concat([head, ...chunks]);
  }
}

const boneMap = () => Object.fromEntries(BONES.map(([bone], index) => [bone, { node: index + 1 }]));

function vrmOne() {
  const glb = new Glb(body({ seed: 11, size: 0.8, turned: false, rootAt: [0, 0, 0] }));
  glb.json.extensionsUsed = ["VRMC_vrm"];
  const meta = { name: "one", authors: ["Segue"], licenseUrl: "https://vrm.dev/licenses/1.0/" };
  glb.json.extensions = { VRMC_vrm: { specVersion: "1.0", meta, humanoid: { humanBones: boneMap() } } };
  return glb.bytes();
}

function vrmZero() {
  const glb = new Glb(body({ seed: 12, size: 1.25, turned: true, rootAt: [0, 0, 0] }));
  glb.json.extensionsUsed = ["VRM"];
  const humanBones = BONES.map(([bone], index) => ({ bone, node: index + 1, useDefaultValues: true }));
  glb.json.extensions = {
    VRM: { specVersion: "0.0", meta: { title: "zero" }, humanoid: { humanBones }, materialProperties: [] },
  };
  return glb.bytes();
}

function animation() {
  const own = body({ seed: 13, size: 1, turned: false, rootAt: [0.1, 0.2, -0.1] });
  const [root] = own.nodes;
  const glb = new Glb(own);
  const { turn, hips } = motion();
  const frames = [...Array(FRAMES).keys()];
  const input = glb.accessor("SCALAR", 1, frames.map((frame) => frame / FPS));
  const [samplers, channels] = [[], []];
  const channel = (node, path, output) => {
    channels.push({ sampler: samplers.push({ input, output }) - 1, target: { node, path } });
  };
  for (const [index, [, parent]] of BONES.entries()) {
    const above = parent === null ? root.rotation : own.axes[parent];
    const values = frames.flatMap((frame) =>
      above.clone().invert().multiply(turn(index, frame)).multiply(own.axes[index]).toArray());
    channel(index + 1, "rotation", glb.accessor("VEC4", 4, values));
  }
  const down = root.rotation.clone().invert();
  const places = frames.flatMap((frame) =>
    new Vector3(...hips(frame)).sub(new Vector3(...root.translation)).applyQuaternion(down).toArray());
  channel(1, "translation", glb.accessor("VEC3", 3, places));
  const happy = glb.json.nodes.push({ name: "happy" }) - 1;
  glb.json.scenes[0].nodes.push(happy);
  channel(happy, "translation", glb.accessor("VEC3", 3, frames.flatMap((frame) => [frame / FRAMES, 0, 0])));
  glb.json.animations = [{ name: "sway", samplers, channels }];
  glb.json.extensionsUsed = ["VRMC_vrm_animation"];
  glb.json.extensions = {
    VRMC_vrm_animation: {
      specVersion: "1.0", humanoid: { humanBones: boneMap() },
      expressions: { preset: { happy: { node: happy } } },
    },
  };
  return glb.bytes();
}

async function load(bytes) {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  loader.register((parser) => new VRMAnimationLoaderPlugin(parser));
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  return loader.parseAsync(buffer, "");
}

/** Plays a clip, and returns the world positions of all bones in each frame. */
function positions(scene, clip, boneNode, update) {
  const mixer = new AnimationMixer(scene);
  mixer.clipAction(clip).play();
  return [...Array(FRAMES).keys()].map((frame) => {
    // The end of a clip wraps to its start.
    mixer.setTime(Math.min(frame / FPS, clip.duration - 1e-9));
    update();
    scene.updateMatrixWorld(true);
    return BONES.map(([bone]) => {
      const at = new Vector3().setFromMatrixPosition(boneNode(bone)?.matrixWorld ?? new Matrix4());
      return at.toArray().map((value) => Math.round(value * 1e6) / 1e6);
    });
  });
}

const folder = process.argv[2];
const files = { "motion.vrma": animation(), "one.vrm": vrmOne(), "zero.vrm": vrmZero() };
for (const [name, bytes] of Object.entries(files)) writeFileSync(join(folder, name), bytes);

const own = await load(files["motion.vrma"]);
const nodes = await Promise.all(BONES.map((_, index) => own.parser.getDependency("node", index + 1)));
const expected = {
  bones: BONES.map(([bone]) => bone),
  "motion.vrma": positions(own.scene, own.animations[0],
    (bone) => nodes[BONES.findIndex(([name]) => name === bone)], () => {}),
};
for (const name of ["one.vrm", "zero.vrm"]) {
  const { vrm } = (await load(files[name])).userData;
  VRMUtils.rotateVRM0(vrm);
  const clip = createVRMAnimationClip(own.userData.vrmAnimations[0], vrm);
  expected[name] = positions(vrm.scene, clip,
    (bone) => vrm.humanoid.getRawBoneNode(bone), () => vrm.update(0));
}
writeFileSync(join(folder, "expected.json"), `${JSON.stringify(expected)}\n`);
