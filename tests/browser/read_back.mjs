// Comparison of exported files in three.js: BVH through its BVHLoader, GLB through its GLTFLoader,
// and VRM animations through the plug-in of three-vrm, against the positions that were exported as
// CSV. A test of the page uses it
// (exchange.test.mjs), and `cargo xtask test oracles` runs `node read_back.mjs FOLDER` on the files
// that the core's tests leave in target/tmp/exchange.

import { readFileSync } from "node:fs";
import process from "node:process";
import { pathToFileURL } from "node:url";
import { PropertyBinding, Quaternion, Scene, Texture, Vector3 } from "three";
import { BVHLoader } from "three/addons/loaders/BVHLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { VRMAnimationLoaderPlugin } from "@pixiv/three-vrm-animation";
import { VRMHumanBoneParentMap } from "@pixiv/three-vrm-core";
import validator from "gltf-validator";

/** A thousandth of a centimetre, metres. */
export const AS_GOOD_AS_SAME = 1e-5;

/**
 * Reads a CSV file. Returns `{ joints, frames }`: names, and for each frame the positions of the
 * joints in metres.
 */
export function fromCsv(text) {
  const [names, ...rows] = text.trimEnd().split("\r\n").map(cells);
  const columns = names.flatMap((name, column) => (name.endsWith(".x_m") ? [column] : []));
  return {
    joints: columns.map((column) => names[column].slice(0, -".x_m".length)),
    frames: rows.map((row) => columns.map((column) => new Vector3(...row.slice(column, column + 3).map(Number)))),
  };
}

/** Reads a BVH file. Returns joints and frames as for CSV. */
export function fromBvh(text, metresPerUnit) {
  const { skeleton, clip } = new BVHLoader().parse(text);
  const bones = skeleton.bones.filter((bone) => bone.name !== "ENDSITE");
  return { joints: bones.map((bone) => bone.name), frames: frames(bones[0], bones, clip, metresPerUnit) };
}

/**
 * Reads an animation of a GLB file by its name, or the only one. Returns joints and frames as for
 * CSV, in the order of its skin, with the names that three.js makes.
 */
export async function fromGlb(bytes, name) {
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  // Images are decoded by browsers alone; the validator reads them.
  const loader = new GLTFLoader().register(() => ({ name: "without images", loadTexture: async () => new Texture() }));
  const { scene, animations } = await loader.parseAsync(buffer, "");
  let skin;
  scene.traverse((object) => { if (object.isSkinnedMesh) skin = object; });
  const found = animations.filter((animation) => name === undefined || animation.name === name);
  if (!skin || found.length !== 1) throw new Error(`${found.length} animations, and ${skin ? "a" : "no"} skin`);
  return { joints: skin.skeleton.bones.map((bone) => bone.name), frames: frames(scene, skin.skeleton.bones, found[0], 1), skin };
}

/**
 * Reads a VRM animation. Returns joints and frames as for CSV: the bones of a body that rests as
 * the file does, and has the rotations that the plug-in hands to any body.
 */
export async function fromVrma(bytes) {
  const loader = new GLTFLoader().register((parser) => new VRMAnimationLoaderPlugin(parser));
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const { userData: { vrmAnimations: [animation] }, parser } = await loader.parseAsync(buffer, "");
  const nodes = await parser.getDependencies("node");
  const bones = new Map(Object.entries(parser.json.extensions.VRMC_vrm_animation.humanoid.humanBones)
    .map(([bone, { node }]) => [bone, { name: parser.json.nodes[node].name, rest: nodes[node].getWorldPosition(new Vector3()) }]));
  const { rotation, translation } = animation.humanoidTracks;
  const hips = translation.get("hips").values;
  const frameOf = (frame) => {
    const placed = new Map();
    const place = (bone) => {
      if (placed.has(bone)) return placed.get(bone);
      let above = VRMHumanBoneParentMap[bone];
      while (above && !bones.has(above)) above = VRMHumanBoneParentMap[above];
      const turn = new Quaternion().fromArray(rotation.get(bone)?.values ?? [0, 0, 0, 1], rotation.has(bone) ? 4 * frame : 0);
      const parent = above ? place(above) : undefined;
      const at = parent
        ? bones.get(bone).rest.clone().sub(bones.get(above).rest).applyQuaternion(parent.turn).add(parent.at)
        : new Vector3().fromArray(hips, 3 * frame);
      const own = { at, turn: parent ? turn.premultiply(parent.turn) : turn };
      placed.set(bone, own);
      return own;
    };
    return [...bones.keys()].map((bone) => place(bone).at);
  };
  return { joints: [...bones.values()].map(({ name }) => name), frames: Array.from({ length: hips.length / 3 }, (_, frame) => frameOf(frame)) };
}

/** Returns the messages of Khronos' validator for a GLB file, none where it is valid. */
export async function complaints(bytes) {
  const { issues } = await validator.validateBytes(new Uint8Array(bytes));
  return issues.messages.filter(({ severity }) => severity < 2).map(({ code, message, pointer }) => `${code} at ${pointer}: ${message}`);
}

/**
 * Returns the greatest error of a joint's position over all frames, metres. Joints are matched by
 * `key(names, index)`.
 */
export function farthest(expected, found, key = (names, index) => names[index]) {
  if (expected.frames.length !== found.frames.length) throw new Error(`${found.frames.length} frames, not ${expected.frames.length}`);
  if (expected.joints.length !== found.joints.length) throw new Error(`${found.joints.length} joints, not ${expected.joints.length}`);
  const places = new Map(found.joints.map((_, index) => [key(found.joints, index), index]));
  return expected.joints.reduce((most, _, joint) => {
    const place = places.get(key(expected.joints, joint));
    if (place === undefined) throw new Error(`no joint ${expected.joints[joint]}`);
    return expected.frames.reduce((most, positions, frame) => Math.max(most, positions[joint].distanceTo(found.frames[frame][place])), most);
  }, 0);
}

export const byIndex = (_, index) => index;

/** Poses the bones by the clip's own keys, one after the other. */
function frames(root, bones, clip, metresPerUnit) {
  const scene = new Scene().add(root);
  const tracks = clip.tracks.map((track) => {
    const { nodeName, propertyName } = PropertyBinding.parseTrackName(track.name);
    return { property: PropertyBinding.findNode(root, nodeName)[propertyName], values: track.values, size: track.getValueSize() };
  });
  return Array.from({ length: clip.tracks[0].times.length }, (_, frame) => {
    for (const { property, values, size } of tracks) property.fromArray(values, frame * size);
    scene.updateMatrixWorld(true);
    return bones.map((bone) => bone.getWorldPosition(new Vector3()).multiplyScalar(metresPerUnit));
  });
}

/** Returns the cells of a line. Commas in quotation marks do not separate. */
function cells(line) {
  return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(([, quoted, plain]) => quoted?.replaceAll('""', '"') ?? plain);
}

async function main(folder) {
  const cases = readFileSync(`${folder}/cases.txt`, "utf8").trim().split("\n").map((line) => line.split(" "));
  let failed = false;
  const tell = (name, metres) => {
    console.log(`${name}: ${(100 * metres).toFixed(6)} cm apart`);
    failed ||= !(metres < AS_GOOD_AS_SAME);
  };
  for (const [name, metresPerUnit] of cases) {
    const expected = fromCsv(readFileSync(`${folder}/${name}.csv`, "utf8"));
    tell(`${name}.bvh`, farthest(expected, fromBvh(readFileSync(`${folder}/${name}.bvh`, "utf8"), Number(metresPerUnit))));
    const glb = readFileSync(`${folder}/${name}.glb`);
    tell(`${name}.glb`, farthest(expected, await fromGlb(glb), byIndex));
    for (const complaint of await complaints(glb)) {
      console.log(`${name}.glb: ${complaint}`);
      failed = true;
    }
  }
  const together = readFileSync(`${folder}/together.glb`);
  for (const name of readFileSync(`${folder}/together.txt`, "utf8").trim().split("\n")) {
    const expected = fromCsv(readFileSync(`${folder}/together ${name}.csv`, "utf8"));
    tell(`together.glb, ${name}`, farthest(expected, await fromGlb(together, name), byIndex));
  }
  for (const name of readFileSync(`${folder}/bones.txt`, "utf8").trim().split("\n")) {
    const expected = fromCsv(readFileSync(`${folder}/bones ${name}.csv`, "utf8"));
    tell(`${name}.vrma`, farthest(expected, await fromVrma(readFileSync(`${folder}/bones ${name}.vrma`))));
  }
  for (const complaint of await complaints(together)) {
    console.log(`together.glb: ${complaint}`);
    failed = true;
  }
  if (failed) throw new Error("not the same motion, or not valid");
}

if (process.argv[1] && import.meta.url === pathToFileURL(process.argv[1]).href) await main(process.argv[2]);
