// A generated model as glTF: its JSON, its arrays and its image in three files.

import { deflateSync } from "node:zlib";

/** The corners of a cube: 0 or 1 along each axis. */
const CORNERS = Array.from({ length: 8 }, (_, corner) => [corner & 1, (corner >> 1) & 1, corner >> 2]);
/** The triangles of a cube, counter-clockwise from outside. */
const TRIANGLES = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]];
const FLOAT = 5126;
const BYTE = 5121;

/**
 * Returns the files `NAME.gltf`, `NAME.bin` and `skin.png`, each a name and its bytes: a standing
 * box with a skeleton of two joints, which turns by a quarter in a second. Its left half has the
 * first colour, its right half the second one, by the two pixels of the image.
 */
export function boxModel(name, colours) {
  const half = Math.SQRT1_2;
  const arrays = [
    [FLOAT, "VEC3", CORNERS.flatMap(([x, y, z]) => [0.6 * x - 0.3, 1.7 * y, 0.4 * z - 0.2])],
    [FLOAT, "VEC2", CORNERS.flatMap(([x]) => [x, 0.5])],
    [BYTE, "VEC4", CORNERS.flatMap(([, y]) => [y, 0, 0, 0])],
    [FLOAT, "VEC4", CORNERS.flatMap(() => [1, 0, 0, 0])],
    [BYTE, "SCALAR", TRIANGLES.flat()],
    [FLOAT, "SCALAR", [0, 1]],
    [FLOAT, "VEC4", [0, 0, 0, 1, 0, half, 0, half]],
  ];
  const parts = arrays.map(([type, , values]) => Buffer.from((type === FLOAT ? Float32Array : Uint8Array).from(values).buffer));
  const padded = parts.map((part) => Buffer.concat([part, Buffer.alloc(-part.length & 3)]));
  const offsets = padded.map((_, index) => padded.slice(0, index).reduce((sum, part) => sum + part.length, 0));
  const width = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
  const json = {
    asset: { version: "2.0" },
    scene: 0,
    scenes: [{ nodes: [0, 2] }],
    nodes: [{ name: "Hips", translation: [0, 0.9, 0], children: [1] }, { name: "Spine", translation: [0, 0.3, 0] }, { name: "Box", mesh: 0, skin: 0 }],
    skins: [{ joints: [0, 1], inverseBindMatrices: undefined }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1, JOINTS_0: 2, WEIGHTS_0: 3 }, indices: 4, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } }, doubleSided: true }],
    samplers: [{ magFilter: 9728, wrapS: 33071 }],
    textures: [{ source: 0, sampler: 0 }],
    images: [{ uri: "skin.png" }],
    animations: [{ channels: [{ sampler: 0, target: { node: 0, path: "rotation" } }], samplers: [{ input: 5, output: 6 }] }],
    buffers: [{ uri: `${name}.bin`, byteLength: Buffer.concat(padded).length }],
    bufferViews: parts.map((part, index) => ({ buffer: 0, byteOffset: offsets[index], byteLength: part.length })),
    accessors: arrays.map(([componentType, type, values], bufferView) => ({ bufferView, componentType, type, count: values.length / width[type], ...(bufferView === 0 && { min: [-0.3, 0, -0.2], max: [0.3, 1.7, 0.2] }) })),
  };
  return [[`${name}.gltf`, Buffer.from(JSON.stringify(json))], [`${name}.bin`, Buffer.concat(padded)], ["skin.png", rowOfPixels(colours)]];
}

/** Returns a PNG of one row of pixels. */
function rowOfPixels(colours) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(data.length);
    sum.writeUInt32BE(crc32(body));
    return Buffer.concat([length, body, sum]);
  };
  const header = Buffer.from([0, 0, 0, colours.length, 0, 0, 0, 1, 8, 2, 0, 0, 0]);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([signature, chunk("IHDR", header), chunk("IDAT", deflateSync(Buffer.from([0, ...colours.flat()]))), chunk("IEND", Buffer.alloc(0))]);
}

function crc32(bytes) {
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}
