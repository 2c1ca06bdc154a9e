// A histogram of the filters: the clips by a number, whose range is dragged.

import { color, contextOf, element, sizeOf } from "./elements.js";
import { columnName, sentence, translated } from "./words.js";
import { written } from "./table.js";

/** The number of bars. */
export const BINS = 48;
/** How near the pointer takes an end of the range, pixels. */
const NEAR = 12;

/** Draws histograms. Sizes and colours are read before anything is drawn, so that the page is laid out once. */
export function drawAll(histograms) {
  const [first] = histograms;
  if (!first?.canvas.isConnected) return;
  const colors = ["bar", "bar-out", "line"].map((name) => color(name, first.canvas));
  const sizes = histograms.map(({ canvas }) => sizeOf(canvas));
  histograms.forEach((histogram, at) => {
    if (sizes[at].width) histogram.draw(sizes[at], colors);
  });
}

export class Histogram {
  root;
  column;
  canvas = element("canvas");
  #filter;
  #changed;
  #text;
  #handles;
  #counts;
  #dragged;

  constructor(column, filter, changed) {
    [this.column, this.#filter, this.#changed] = [column, filter, changed];
    const name = columnName(column);
    this.#text = element("span", { class: "value" });
    this.#handles = ["from", "to"].map((word, end) => element("div", {
      class: `handle ${word}`, role: "slider", tabIndex: 0, "aria-label": sentence(word, { name }), "aria-orientation": "horizontal", onkeydown: (event) => this.#key(event, end),
    }));
    const plot = element("div", {
      class: "plot", onpointerdown: (event) => this.#press(event), onpointermove: (event) => this.#move(event), onpointerup: () => this.#release(), onpointercancel: () => this.#release(),
      ondblclick: () => this.#set([null, null]),
    }, [this.canvas, ...this.#handles]);
    this.root = element("div", { class: "histogram", title: column.help ? translated(column.help) : undefined }, [
      element("div", { class: "label" }, [element("span", { textContent: name }), this.#text]), plot,
    ]);
    this.update();
  }

  setCounts(counts) {
    this.#counts = counts;
  }

  get #range() {
    return this.#filter.ranges[this.column.name] ?? [null, null];
  }

  /** Sets the range: null where it is open. */
  #set([from, to]) {
    const { min, max, name } = this.column;
    const range = [from === null || from <= min ? null : from, to === null || to >= max ? null : to];
    if (String(range) === String(this.#range)) return;
    if (range[0] === null && range[1] === null) delete this.#filter.ranges[name];
    else this.#filter.ranges[name] = range;
    this.update();
    this.#changed();
  }

  /** Returns the ends of the range as shares of the width. */
  #shares() {
    const { min, max } = this.column;
    const [from, to] = this.#range;
    const share = (value) => Math.min(Math.max((value - min) / (max - min), 0), 1);
    return [from === null ? 0 : share(from), to === null ? 1 : share(to)];
  }

  /** Returns the value at a share of the width, on the edge of a bin. */
  #value(share) {
    const { min, max } = this.column;
    return min + (Math.round(Math.min(Math.max(share, 0), 1) * BINS) / BINS) * (max - min);
  }

  #at(event) {
    const { left, width } = this.canvas.getBoundingClientRect();
    return { share: (event.clientX - left) / width, width };
  }

  #press(event) {
    if (event.button !== 0) return;
    const { share, width } = this.#at(event);
    const distances = this.#shares().map((end) => Math.abs(end - share) * width);
    const near = distances[0] <= distances[1] ? 0 : 1;
    // Away from both ends, a drag draws a new range.
    this.#dragged = distances[near] <= NEAR ? { end: near } : { from: this.#value(share), isNew: true };
    event.currentTarget.setPointerCapture(event.pointerId);
    if (!this.#dragged.isNew) this.#handles[near].focus({ preventScroll: true });
    event.preventDefault();
  }

  #move(event) {
    if (!this.#dragged) return;
    const value = this.#value(this.#at(event).share);
    const { min, max } = this.column;
    const least = (max - min) / BINS;
    if (this.#dragged.isNew) {
      const { from } = this.#dragged;
      if (Math.abs(value - from) >= least) this.#set([Math.min(from, value), Math.max(from, value)]);
      return;
    }
    const [from, to] = this.#range;
    if (this.#dragged.end === 0) this.#set([Math.min(value, (to ?? max) - least), to]);
    else this.#set([from, Math.max(value, (from ?? min) + least)]);
  }

  #release() {
    this.#dragged = undefined;
  }

  #key(event, end) {
    const { min, max } = this.column;
    const least = (max - min) / BINS;
    const [from, to] = [this.#range[0] ?? min, this.#range[1] ?? max];
    const now = end ? to : from;
    const next = { ArrowRight: now + least, ArrowUp: now + least, ArrowLeft: now - least, ArrowDown: now - least, PageUp: now + 6 * least, PageDown: now - 6 * least, Home: min, End: max }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.#set(end ? [this.#range[0], Math.max(next, from + least)] : [Math.min(next, to - least), this.#range[1]]);
  }

  update() {
    const { min, max, unit } = this.column;
    const [from, to] = this.#shares();
    const values = [this.#range[0] ?? min, this.#range[1] ?? max];
    const isOpen = this.#range[0] === null && this.#range[1] === null;
    const texts = values.map((value) => written(value, this.column));
    // Beyond the end there are a few clips more.
    const beyond = this.#range[1] === null ? "+" : "";
    this.#text.textContent = `${texts[0]} – ${texts[1]}${beyond}${unit ? ` ${translated(unit)}` : ""}`;
    this.root.classList.toggle("set", !isOpen);
    [from, to].forEach((share, end) => {
      const handle = this.#handles[end];
      handle.style.left = `${share * 100}%`;
      for (const [key, value] of [["valuemin", min], ["valuemax", max], ["valuenow", values[end]], ["valuetext", `${texts[end]}${unit ? ` ${translated(unit)}` : ""}`]]) handle.setAttribute(`aria-${key}`, value);
    });
  }

  /** Draws the bars: within the range, beyond it, and the line below them in colours. */
  draw(size, [inside, outside, line]) {
    const { width, height } = size;
    const [from, to] = this.#shares();
    const context = contextOf(this.canvas, size);
    context.fillStyle = line;
    context.fillRect(0, height - 1, width, 1);
    if (!this.#counts) return;
    // The square root shows the few clips of a long tail, too.
    const most = Math.sqrt(Math.max(...this.#counts, 1));
    this.#counts.forEach((count, bin) => {
      if (!count) return;
      const [left, right] = [(bin / BINS) * width, ((bin + 1) / BINS) * width];
      const bar = Math.max((Math.sqrt(count) / most) * (height - 3), 1.5);
      const middle = (bin + 0.5) / BINS;
      context.fillStyle = middle >= from && middle <= to ? inside : outside;
      context.fillRect(left + 0.5, height - 1 - bar, Math.max(right - left - 1, 1), bar);
    });
  }
}
