// The map: all clips as points, similar motions near each other.

import { button, color, element, sized } from "./elements.js";
import { Ink } from "./ink.js";
import { sentence } from "./words.js";

/** The greatest magnification. */
const MAX_ZOOM = 400;
/** How near the pointer finds a point, pixels. */
const NEAR = 14;
/** How far the pointer may move in a click, pixels. */
const CLICK = 5;
/** The part of the canvas that all points take. */
const FILL = 0.94;
/** The time for which the points are drawn before other work has its turn, milliseconds. */
const TURN_MS = 12;

export class ClipMap {
  root;
  #hooks;
  #points;
  #canvas;
  #tip;
  /** How it is worked, until it is. */
  #hint = element("p", { class: "hint", id: "corpus-map-help", textContent: sentence("mapHelp") });
  #bright;
  #ink = new Ink();
  /** The points as they were drawn, and what tells that from other views. */
  #picture;
  #drawn;
  #isDrawing = false;
  /** Whether there is another view since the drawing began. */
  #isLate = false;
  /** How many times other rows were shown. */
  #version = 0;
  #current;
  #hits = [];
  #centre = [0, 0];
  #zoom = 1;
  #pointers = new Map();
  #moved = 0;
  #hovered;
  #frame = 0;
  #resized = new ResizeObserver(() => this.draw());

  /**
   * @param points x and y of each row, −1 to 1; not numbers where a clip has no place
   * @param hooks play(row), describe(row): a promise of the elements of its hint
   */
  constructor(points, hooks) {
    [this.#points, this.#hooks] = [points, hooks];
    this.#bright = new Uint8Array(points.length / 2);
    this.#canvas = element("canvas", {
      role: "application", tabIndex: 0, "aria-label": sentence("map"), "aria-describedby": "corpus-map-help corpus-map-keys", "aria-keyshortcuts": "Enter",
      onpointerdown: (event) => this.#press(event), onpointermove: (event) => this.#point(event), onpointerup: (event) => this.#release(event),
      onpointercancel: (event) => this.#pointers.delete(event.pointerId), onpointerleave: () => this.#hover(undefined),
    });
    this.#canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    this.#tip = element("div", { class: "tip", hidden: true });
    this.root = element("div", { class: "map", onkeydown: (event) => this.#key(event) }, [
      this.#canvas, this.#tip,
      this.#hint,
      element("p", { class: "hint keys", id: "corpus-map-keys", textContent: sentence("mapKeys") }),
      element("div", { class: "zoom" }, [
        button({ icon: "plus", name: sentence("zoomIn"), title: `${sentence("zoomIn")} (+)`, "aria-keyshortcuts": "Plus", onclick: () => this.#zoomBy(1.6) }),
        button({ icon: "minus", name: sentence("zoomOut"), title: `${sentence("zoomOut")} (-)`, "aria-keyshortcuts": "-", onclick: () => this.#zoomBy(1 / 1.6) }),
        button({ icon: "all", name: sentence("showAll"), title: `${sentence("showAll")} (0)`, "aria-keyshortcuts": "0", onclick: () => this.#reset() }),
      ]),
    ]);
    this.#resized.observe(this.#canvas);
  }

  focus() {
    this.#canvas.focus({ preventScroll: true });
  }

  /** Shows which rows fit the filters. */
  setRows(rows) {
    this.#bright.fill(0);
    for (const row of rows) this.#bright[row] = 1;
    this.#version++;
    this.draw();
  }

  /** Marks the clip on the stage, and the clips that a search has found. */
  setMarks(current, hits) {
    [this.#current, this.#hits] = [current, hits];
    this.draw();
  }

  /** Ends what is under way. */
  end() {
    cancelAnimationFrame(this.#frame);
    this.#resized.disconnect();
  }

  /** Draws in the next frame. */
  draw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => this.#draw());
  }

  /** Pixels for a unit along x and y. The axes have no common measure, so that both fill the canvas. */
  get #scale() {
    const { clientWidth, clientHeight } = this.#canvas;
    return [clientWidth, clientHeight].map((side) => (side / 2) * FILL * this.#zoom);
  }

  /** Returns the place of a row on the canvas, pixels; undefined if it has none. */
  #place(row) {
    const [x, y] = [this.#points[2 * row], this.#points[2 * row + 1]];
    if (Number.isNaN(x)) return undefined;
    const { clientWidth, clientHeight } = this.#canvas;
    const [across, up] = this.#scale;
    return [clientWidth / 2 + (x - this.#centre[0]) * across, clientHeight / 2 - (y - this.#centre[1]) * up];
  }

  /** Draws the points, unless they are there already, and the rings around some. */
  async #draw() {
    const canvas = this.#canvas;
    if (this.#isDrawing) return void (this.#isLate = true);
    if (!canvas.isConnected || !canvas.clientWidth || !canvas.clientHeight) return;
    const context = sized(canvas);
    const view = this.#view();
    if (this.#drawn !== view.text) {
      const { width, height } = canvas;
      const hasSize = this.#picture?.width === width && this.#picture.height === height;
      const picture = hasSize ? this.#picture : context.createImageData(width, height);
      this.#isDrawing = true;
      try {
        await inTurns(this.#ink.draw(new Uint32Array(picture.data.buffer), view));
      } finally {
        this.#isDrawing = false;
      }
      [this.#picture, this.#drawn] = [picture, view.text];
      if (this.#isLate) this.draw();
      this.#isLate = false;
    }
    context.putImageData(this.#picture, 0, 0);
    this.#drawRings(context);
  }

  /** Returns what the picture of the points depends on. */
  #view() {
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.#canvas;
    const count = this.#bright.length;
    // Few points, and those that are looked at closely, are drawn larger.
    const radius = ratio * Math.min(Math.max(900 / Math.max(count, 1), 1.1) ** 0.5 * this.#zoom ** 0.3 * 1.1, 4.5);
    const scale = this.#scale.map((side) => side * ratio);
    const origin = [width / 2 - this.#centre[0] * scale[0], height / 2 + this.#centre[1] * scale[1]];
    const colors = ["point", "muted"].map((name) => rgb(color(name, this.#canvas)));
    const text = [width, height, radius, scale, origin, colors, this.#version].join();
    return { text, width, points: this.#points, isBright: this.#bright, scale, origin, radius, colors };
  }

  #drawRings(context) {
    const ring = (row, radius, paint) => {
      const place = row === undefined ? undefined : this.#place(row);
      if (!place) return;
      context.beginPath();
      context.arc(...place, radius, 0, 2 * Math.PI);
      context.lineWidth = 2;
      context.strokeStyle = paint;
      context.stroke();
    };
    const [accent, a, text] = ["accent-ink", "a-ink", "text"].map((name) => color(name, this.#canvas));
    for (const row of this.#hits) ring(row, 4.5, accent);
    ring(this.#hovered, 6, text);
    ring(this.#current, 7, a);
  }

  #at(event) {
    const { left, top } = this.#canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  /** Returns the nearest row to a place: of those that fit the filters, if there is one. */
  #find([x, y], near = NEAR) {
    let found;
    let least = near * near;
    const [across, up] = this.#scale;
    const { clientWidth, clientHeight } = this.#canvas;
    // The place in units, so that nothing is computed for each row but a difference.
    const [ownX, ownY] = [this.#centre[0] + (x - clientWidth / 2) / across, this.#centre[1] - (y - clientHeight / 2) / up];
    for (let row = 0; row < this.#bright.length; row++) {
      const [dx, dy] = [(this.#points[2 * row] - ownX) * across, (this.#points[2 * row + 1] - ownY) * up];
      const distance = dx * dx + dy * dy + (this.#bright[row] ? 0 : NEAR * NEAR / 2);
      // Not a number fails the comparison.
      if (distance < least) [found, least] = [row, distance];
    }
    return found;
  }

  #press(event) {
    if (event.button !== 0) return;
    this.#hint.hidden = true;
    this.#hover(undefined);
    this.#canvas.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, this.#at(event));
    this.#moved = this.#pointers.size > 1 ? Infinity : 0;
  }

  #point(event) {
    const at = this.#at(event);
    const before = this.#pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType === "mouse") this.#hover(this.#find(at), at);
      return;
    }
    const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
    this.#moved += Math.hypot(dx, dy);
    if (this.#pointers.size === 2) {
      const [other] = [...this.#pointers].find(([id]) => id !== event.pointerId).slice(1);
      const spread = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]);
      this.#zoomBy(spread(at) / Math.max(spread(before), 1), other);
    } else if (this.#moved > CLICK) {
      this.#pan(dx, dy);
    }
    this.#pointers.set(event.pointerId, at);
  }

  #release(event) {
    if (!this.#pointers.delete(event.pointerId) || this.#moved > CLICK) return;
    const row = this.#find(this.#at(event), event.pointerType === "touch" ? 2 * NEAR : NEAR);
    if (row !== undefined) this.#hooks.play(row);
  }

  #wheel(event) {
    event.preventDefault();
    this.#hint.hidden = true;
    const step = event.deltaMode === 1 ? 16 * event.deltaY : event.deltaY;
    this.#zoomBy(Math.exp(-Math.min(Math.max(step, -120), 120) / 300), this.#at(event));
  }

  #pan(dx, dy) {
    const [across, up] = this.#scale;
    this.#move([this.#centre[0] - dx / across, this.#centre[1] + dy / up]);
  }

  /** Zooms about a place, which stays where it is; without one, about the middle. */
  #zoomBy(factor, place) {
    const { clientWidth, clientHeight } = this.#canvas;
    const [x, y] = place ?? [clientWidth / 2, clientHeight / 2];
    const before = this.#scale;
    this.#zoom = Math.min(Math.max(this.#zoom * factor, 1), MAX_ZOOM);
    const [fromLeft, fromTop] = [x - clientWidth / 2, y - clientHeight / 2];
    const after = this.#scale;
    const [right, up] = [fromLeft / before[0] - fromLeft / after[0], fromTop / before[1] - fromTop / after[1]];
    this.#move(this.#zoom === 1 ? [0, 0] : [this.#centre[0] + right, this.#centre[1] - up]);
  }

  #reset() {
    this.#zoom = 1;
    this.#move([0, 0]);
  }

  /** Shows another place of the map in the middle. The hint was at a point that has moved. */
  #move(centre) {
    this.#centre = centre.map((value) => Math.min(Math.max(value, -1), 1));
    this.#hover(undefined);
    this.draw();
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = 40;
    const moves = { ArrowLeft: [step, 0], ArrowRight: [-step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (event.key in moves) this.#pan(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") this.#zoomBy(1.4);
    else if (event.key === "-") this.#zoomBy(1 / 1.4);
    else if (event.key === "0") this.#reset();
    else if (event.key === "Enter" && event.target === this.#canvas) {
      const row = this.#find([this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2], Infinity);
      if (row !== undefined) this.#hooks.play(row);
    } else return;
    event.preventDefault();
  }

  async #hover(row, at) {
    if (row === this.#hovered) return;
    this.#hovered = row;
    this.#canvas.style.cursor = row === undefined ? "" : "pointer";
    this.draw();
    if (row === undefined) return void (this.#tip.hidden = true);
    const parts = await this.#hooks.describe(row).catch(() => null);
    if (!parts || this.#hovered !== row) return;
    this.#tip.replaceChildren(...parts);
    this.#tip.hidden = false;
    const { offsetWidth, offsetHeight } = this.#tip;
    const { clientWidth } = this.#canvas;
    this.#tip.style.left = `${Math.min(Math.max(at[0] - offsetWidth / 2, 8), Math.max(clientWidth - offsetWidth - 8, 8))}px`;
    this.#tip.style.top = `${at[1] - offsetHeight - 14 > 4 ? at[1] - offsetHeight - 14 : at[1] + 18}px`;
  }
}

/** Takes the steps of a generator. When they last, other work comes between. */
async function inTurns(steps) {
  let start = performance.now();
  for (;;) {
    if (steps.next().done) return;
    if (performance.now() - start < TURN_MS) continue;
    await new Promise((resolve) => setTimeout(resolve));
    start = performance.now();
  }
}

/** Returns the parts of a colour that is written as `#rrggbb`. */
const rgb = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
