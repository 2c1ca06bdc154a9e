// A measurement without bounds: the distances of all windows of 6,000 frames and 31 joints by a
// compute shader, where Chromium has WebGPU, beside those of the Graph lab (a kernel of its own for
// the products of all pairs of frames, and running sums of them, on one core). Segue does not use
// the shader. Its sums differ from machine to machine in the last bits, and a walk must be the same
// everywhere; for pictures alone, it would have to be much faster.
//
//   node tests/browser/compute.mjs [--frames 6000] [--window 30]

import process from "node:process";
import { parseArgs } from "node:util";
import { striding } from "./help.mjs";
import { close, openSegue } from "./segue.mjs";

const { values } = parseArgs({ options: { frames: { type: "string", default: "6000" }, window: { type: "string", default: "30" } } });
const frames = Number(values.frames), window = Number(values.window), joints = 31;

// Each tile computes the terms of every pair of frames (two products on the ground, one of
// heights), then the sums along diagonals, and the distance after the best turn about the vertical
// and shift along the ground. Points are x, y, z and weight.
const SHADER = `
struct Size { frames: u32, joints: u32, window: u32, pad: u32, row: u32, column: u32, tile: u32, side: u32 }
@group(0) @binding(0) var<uniform> size: Size;
@group(0) @binding(1) var<storage, read> points: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> pairs: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> distances: array<f32>;
@group(0) @binding(4) var<storage, read> frame: array<vec4f>;

var<workgroup> a: array<vec4f, 256>;
var<workgroup> b: array<vec4f, 256>;

@compute @workgroup_size(16, 16)
fn products(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) at: vec3u) {
  let i = min(size.row + id.y, size.frames - 1);
  let j = min(size.column + id.x, size.frames - 1);
  let first = size.row + id.y - at.y;
  let other = size.column + id.x - at.x;
  var sum = vec3f();
  for (var begin = 0u; begin < size.joints; begin += 16u) {
    let joint = begin + at.x;
    let known = joint < size.joints;
    a[at.y * 16 + at.x] = select(vec4f(), points[min(first + at.y, size.frames - 1) * size.joints + min(joint, size.joints - 1)], known);
    b[at.y * 16 + at.x] = select(vec4f(), points[min(other + at.y, size.frames - 1) * size.joints + min(joint, size.joints - 1)], known);
    workgroupBarrier();
    for (var k = 0u; k < 16u; k++) {
      let p = a[at.y * 16 + k];
      let q = b[at.x * 16 + k];
      sum += p.w * vec3f(p.x * q.x + p.z * q.z, p.x * q.z - p.z * q.x, p.y * q.y);
    }
    workgroupBarrier();
  }
  if (id.x < size.side && id.y < size.side) { pairs[id.y * size.side + id.x] = vec4f(sum, 0); }
}

@compute @workgroup_size(16, 16)
fn windows(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= size.tile || id.y >= size.tile) { return; }
  var sum = vec3f();
  var mine = vec4f();
  var theirs = vec4f();
  for (var k = 0u; k < size.window; k++) {
    sum += pairs[(id.y + k) * size.side + id.x + k].xyz;
    mine += frame[min(size.row + id.y + k, size.frames - 1)];
    theirs += frame[min(size.column + id.x + k, size.frames - 1)];
  }
  // frame: weighted sums of x and z, of squares, and the weight.
  let weight = mine.w;
  let along = sum.x - (mine.x * theirs.x + mine.y * theirs.y) / weight;
  let across = sum.y - (mine.x * theirs.y - mine.y * theirs.x) / weight;
  let own = mine.z - dot(mine.xy, mine.xy) / weight + theirs.z - dot(theirs.xy, theirs.xy) / weight;
  distances[id.y * size.tile + id.x] = sqrt(max(own - 2 * sum.z - 2 * length(vec2f(along, across)), 0) / weight);
}`;

try {
  const { page, segue, load } = await openSegue("webgpu", "lab=graph&play=off&clips=walk", { viewport: [800, 600] });
  console.table({
    "compute shader": { seconds: await page.evaluate(byShader, { frames, joints, window, SHADER }) },
    "one core": await byCore(page, segue, load),
  });
} finally {
  await close();
}
process.exit();

/** Waits until the Graph lab has all distances, and so a histogram with the threshold. */
async function byCore(page, segue, load) {
  const clips = [];
  for (let i = 0; i < 6; i++) clips.push((await load(`clip${i}.bvh`, striding({ frames: frames / 6, hertz: 0.8 + 0.1 * i, swing: 25 + 3 * i }))).clips[0].id);
  const changed = (value) => page.evaluate(async (value) => {
    const start = performance.now();
    await window.segue.set(value);
    while ((await window.segue.stats()).jobs.length) await new Promise((done) => setTimeout(done, 1));
    return (performance.now() - start) / 1e3;
  }, value);
  await page.waitForTimeout(3000);
  const seconds = await changed({ clips: clips.join(","), walk_seconds: 10, blend_window: window });
  const other = await changed({ blend_window: window - 2 });
  return { seconds, "a new window": other };
}

async function byShader({ frames, joints, window, SHADER }) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) return NaN;
  const device = await adapter.requestDevice();
  const problems = [];
  device.onuncapturederror = ({ error }) => problems.push(error.message);
  const tile = 512, side = tile + window - 1;
  const points = Float32Array.from({ length: frames * joints * 4 }, (_, i) => (i % 4 === 3 ? 1 : Math.sin(i * 12.9898) * Math.cos(i * 0.0071)));
  const sums = new Float32Array(frames * 4);
  for (let at = 0; at < frames * joints; at++) {
    const [x, y, z, w] = points.subarray(4 * at, 4 * at + 4);
    const sum = sums.subarray(4 * Math.floor(at / joints));
    sum[0] += w * x; sum[1] += w * z; sum[2] += w * (x * x + y * y + z * z); sum[3] += w;
  }
  const { STORAGE, UNIFORM, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
  const buffer = (size, usage, data) => {
    const made = device.createBuffer({ size, usage });
    if (data) device.queue.writeBuffer(made, 0, data);
    return made;
  };
  const out = buffer(tile * tile * 4, STORAGE | COPY_SRC);
  const read = buffer(tile * tile * 4, MAP_READ | COPY_DST);
  const size = buffer(32, UNIFORM | COPY_DST);
  const module = device.createShaderModule({ code: SHADER });
  const types = ["uniform", "read-only-storage", "storage", "storage", "read-only-storage"];
  const layout = device.createBindGroupLayout({ entries: types.map((type, binding) => ({ binding, visibility: GPUShaderStage.COMPUTE, buffer: { type } })) });
  const pipelines = ["products", "windows"].map((entryPoint) => device.createComputePipeline({
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }), compute: { module, entryPoint },
  }));
  const buffers = [size, buffer(points.byteLength, STORAGE | COPY_DST, points), buffer(side * side * 16, STORAGE), out, buffer(sums.byteLength, STORAGE | COPY_DST, sums)];
  const group = device.createBindGroup({ layout, entries: buffers.map((buffer, binding) => ({ binding, resource: { buffer } })) });
  const of = async (row, column) => {
    device.queue.writeBuffer(size, 0, new Uint32Array([frames, joints, window, 0, row, column, tile, side]));
    const encoder = device.createCommandEncoder();
    pipelines.forEach((pipeline, at) => {
      const pass = encoder.beginComputePass();
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, group);
      const groups = Math.ceil((at === 0 ? side : tile) / 16);
      pass.dispatchWorkgroups(groups, groups);
      pass.end();
    });
    encoder.copyBufferToBuffer(out, 0, read, 0, tile * tile * 4);
    device.queue.submit([encoder.finish()]);
    await read.mapAsync(GPUMapMode.READ);
    const found = new Float32Array(read.getMappedRange()).slice();
    read.unmap();
    return found;
  };
  // One distance is computed here, so that the measured result is known to be right.
  const [i, j] = [37, 411], found = (await of(0, 0))[i * tile + j];
  let [a, b, c, own, n] = [0, 0, 0, 0, 0];
  const [m, t] = [[0, 0], [0, 0]];
  for (let k = 0; k < window; k++) {
    for (let joint = 0; joint < joints; joint++) {
      const p = points.subarray(4 * ((i + k) * joints + joint)), q = points.subarray(4 * ((j + k) * joints + joint));
      a += p[0] * q[0] + p[2] * q[2]; b += p[0] * q[2] - p[2] * q[0]; c += p[1] * q[1]; n += 1;
      own += p[0] ** 2 + p[1] ** 2 + p[2] ** 2 + q[0] ** 2 + q[1] ** 2 + q[2] ** 2;
      m[0] += p[0]; m[1] += p[2]; t[0] += q[0]; t[1] += q[2];
    }
  }
  a -= (m[0] * t[0] + m[1] * t[1]) / n;
  b -= (m[0] * t[1] - m[1] * t[0]) / n;
  own -= (m[0] ** 2 + m[1] ** 2 + t[0] ** 2 + t[1] ** 2) / n;
  const right = Math.sqrt((own - 2 * c - 2 * Math.hypot(a, b)) / n);
  if (!(Math.abs(found - right) < 1e-3)) throw new Error(`the shader found ${found}, it is ${right}: ${problems[0]}`);
  const start = performance.now();
  // Distances are symmetric.
  for (let row = 0; row < frames; row += tile) for (let column = row; column < frames; column += tile) await of(row, column);
  return (performance.now() - start) / 1e3;
}
