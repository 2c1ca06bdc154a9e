// The points of the map as ink that adds up where they are dense. Whole numbers and tables make a
// picture of 100,000 points in a few hundredths of a second.

/** The ink on a pixel that a dot covers, and the greatest that is told from more. */
const COVERED = 32;
const MOST = 1023;
/** How soon the ink of dots hides the ground, and how much of it at most: of rows that fit the filters, and of others. */
const BRIGHT = { strength: 1.36, most: 1 };
const FAINT = { strength: 0.35, most: 0.6 };
/** The work of a step: points, and pixels. */
const POINTS_A_STEP = 10_000;
const PIXELS_A_STEP = 250_000;

export class Ink {
  #bright = new Uint16Array();
  #faint = new Uint16Array();

  /**
   * Draws points, in steps of a few milliseconds: a generator.
   * @param pixels of the picture: red, green, blue and opacity of each in 32 bits
   * @param view.width of the picture, pixels
   * @param view.points x and y of each row; not numbers where a row has no place
   * @param view.isBright 1 for rows that fit the filters
   * @param view.scale pixels for a unit along x and y
   * @param view.origin the pixel of the place 0, 0
   * @param view.radius of a dot, pixels
   * @param view.colors of rows that fit the filters, and of others: red, green and blue
   */
  *draw(pixels, { width, points, isBright, scale, origin, radius, colors }) {
    if (this.#bright.length === pixels.length) {
      this.#bright.fill(0);
      this.#faint.fill(0);
    } else {
      [this.#bright, this.#faint] = [new Uint16Array(pixels.length), new Uint16Array(pixels.length)];
    }
    const dot = dotOf(radius, width);
    const inks = [this.#faint, this.#bright];
    for (let row = 0; row < isBright.length; row += POINTS_A_STEP) {
      drop(inks, width, { points, isBright, scale, origin }, dot, row, Math.min(row + POINTS_A_STEP, isBright.length));
      yield;
    }
    const tables = tablesOf(colors);
    for (let at = 0; at < pixels.length; at += PIXELS_A_STEP) {
      mix(pixels, inks, tables, at, Math.min(at + PIXELS_A_STEP, pixels.length));
      yield;
    }
  }
}

/** Drops the dots of some rows: ink on pixels. */
function drop([faint, bright], width, { points, isBright, scale: [across, up], origin: [left, top] }, { reach, dx, dy, offsets, weights }, from, to) {
  const height = faint.length / width;
  const count = weights.length;
  for (let row = from; row < to; row++) {
    const x = Math.floor(left + points[2 * row] * across + 0.5);
    const y = Math.floor(top - points[2 * row + 1] * up + 0.5);
    // Not a number fails the comparison.
    if (!(x > -reach && y > -reach && x < width + reach && y < height + reach)) continue;
    const ink = isBright[row] ? bright : faint;
    const isInside = x >= reach && y >= reach && x < width - reach && y < height - reach;
    const middle = y * width + x;
    for (let part = 0; part < count; part++) {
      if (!isInside) {
        const [px, py] = [x + dx[part], y + dy[part]];
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
      }
      const at = middle + offsets[part];
      const sum = ink[at] + weights[part];
      ink[at] = sum > MOST ? MOST : sum;
    }
  }
}

/** Makes some of the pixels of the ink. */
function mix(pixels, [faint, bright], { above, below, ofBright, ofFaint, on, off }, from, to) {
  for (let at = from; at < to; at++) {
    const [one, other] = [bright[at], faint[at]];
    // Nearly all have at most one kind of ink.
    if (other === 0) pixels[at] = ofBright[one];
    else if (one === 0) pixels[at] = ofFaint[other];
    else pixels[at] = mixed(on, above[one], off, below[other] * (1 - above[one]));
  }
}

/** Returns the parts of the ground that amounts of ink hide, and the pixels that they make alone. */
function tablesOf([on, off]) {
  const hidden = ({ strength, most }) => Float64Array.from({ length: MOST + 1 }, (_, ink) => most * (1 - Math.exp((-ink / COVERED) * strength)));
  const [above, below] = [hidden(BRIGHT), hidden(FAINT)];
  const alone = (color, parts) => Uint32Array.from(parts, (part) => (part === 0 ? 0 : pixelOf(part, ...color)));
  return { above, below, ofBright: alone(on, above), ofFaint: alone(off, below), on, off };
}

/** Returns the pixels of a round dot: their offsets, and the ink on each. */
function dotOf(radius, width) {
  const reach = Math.ceil(radius);
  const [dx, dy, weights] = [[], [], []];
  for (let down = -reach; down <= reach; down++) {
    for (let right = -reach; right <= reach; right++) {
      const weight = Math.round(COVERED * Math.min(Math.max(radius + 0.5 - Math.hypot(right, down), 0), 1));
      if (weight === 0) continue;
      dx.push(right);
      dy.push(down);
      weights.push(weight);
    }
  }
  const offsets = Int32Array.from(dx, (right, part) => dy[part] * width + right);
  return { reach, dx: Int32Array.from(dx), dy: Int32Array.from(dy), offsets, weights: Int32Array.from(weights) };
}

/** Returns a pixel: its lowest byte is red, as in the data of a picture. */
const pixelOf = (opacity, red, green, blue) => ((Math.round(255 * opacity) << 24) | (blue << 16) | (green << 8) | red) >>> 0;

/** Returns the pixel of one colour over another, each with its part of the ground. */
function mixed(one, onePart, other, otherPart) {
  const opacity = onePart + otherPart;
  const share = onePart / opacity;
  return pixelOf(opacity, other[0] + (one[0] - other[0]) * share, other[1] + (one[1] - other[1]) * share, other[2] + (one[2] - other[2]) * share);
}
