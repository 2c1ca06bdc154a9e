// Reads the PNG files that browsers write: 8 bits per channel, RGB or RGBA, not interlaced.

import zlib from "node:zlib";

/**
 * @returns {{ width: number, height: number, data: Uint8Array, at(x: number, y: number): number[],
 * colours(): number }}
 */
export function decodePng(bytes) {
  let width, height, channels;
  const packed = [];
  for (let at = 8; at < bytes.length; ) {
    const length = bytes.readUInt32BE(at);
    const type = bytes.toString("latin1", at + 4, at + 8);
    const body = bytes.subarray(at + 8, at + 8 + length);
    if (type === "IHDR") {
      width = body.readUInt32BE(0);
      height = body.readUInt32BE(4);
      channels = { 2: 3, 6: 4 }[body[9]];
      if (body[8] !== 8 || !channels || body[12] !== 0) throw new Error("not a PNG of the kind that browsers write");
    } else if (type === "IDAT") {
      packed.push(body);
    }
    at += length + 12;
  }

  const filtered = zlib.inflateSync(Buffer.concat(packed));
  const stride = width * channels;
  const rows = new Uint8Array(stride * height);
  for (let y = 0; y < height; y++) {
    const filter = filtered[y * (stride + 1)];
    for (let x = 0; x < stride; x++) {
      const here = y * stride + x;
      const left = x >= channels ? rows[here - channels] : 0;
      const up = y > 0 ? rows[here - stride] : 0;
      const upLeft = x >= channels && y > 0 ? rows[here - stride - channels] : 0;
      const guess = [0, left, up, (left + up) >> 1, paeth(left, up, upLeft)][filter];
      rows[here] = filtered[y * (stride + 1) + 1 + x] + guess;
    }
  }

  const at = (x, y) => Array.from({ length: 4 }, (_, c) => (c < channels ? rows[y * stride + x * channels + c] : 255));
  return {
    width,
    height,
    data: rows,
    /** [red, green, blue, alpha] of one pixel */
    at,
    /** the number of different colours */
    colours() {
      const seen = new Set();
      for (let i = 0; i < rows.length; i += channels) seen.add((rows[i] << 16) | (rows[i + 1] << 8) | rows[i + 2]);
      return seen.size;
    },
  };
}

/** The Paeth predictor of the PNG specification: the neighbour nearest to left + up − upLeft. */
function paeth(left, up, upLeft) {
  const estimate = left + up - upLeft;
  const [toLeft, toUp, toUpLeft] = [Math.abs(estimate - left), Math.abs(estimate - up), Math.abs(estimate - upLeft)];
  if (toLeft <= toUp && toLeft <= toUpLeft) return left;
  return toUp <= toUpLeft ? up : upLeft;
}
