// The filters: a histogram with a range for each number, and chips for choices.

import { button, color, contextOf, element } from "./elements.js";
import { columnName, number, sentence, translated, valueText } from "./words.js";
import { written } from "./table.js";

export const BINS = 48;
/** How near the pointer takes an end of the range, pixels. */
const NEAR = 12;
/** The choices in the order in which they stand; others are left out. */
const CHOICES = ["labels", "format", "status", "rig"];
const MAX_CHIPS = 60;
/** Columns of numbers that come last: few look for them. */
export const LAST = ["frames", "fps", "height_m"];

export class Filters {
  root;
  #columns;
  #filter;
  #changed;
  #histograms;
  #choices;
  #copies;

  /**
   * @param columns those of the corpus
   * @param filter changed in place: { ranges, choices, copies }
   * @param changed called after each change
   */
  constructor(columns, filter, changed) {
    [this.#columns, this.#filter, this.#changed] = [columns, filter, changed];
    const numbers = columns.filter(({ kind, min, max }) => kind === "number" && min < max);
    const isLast = ({ name }) => Number(LAST.includes(name));
    this.#histograms = numbers.sort((one, other) => isLast(one) - isLast(other)).map((column) => new Histogram(column, filter, changed));
    const known = columns.filter(({ kind, name, values = [] }) => kind === "choice" && CHOICES.includes(name) && values.length > 1);
    this.#choices = known.sort((one, other) => CHOICES.indexOf(one.name) - CHOICES.indexOf(other.name)).map((column) => new Choice(column, filter, changed));
    this.#copies = this.#copiesElement();
    this.root = element("div", { class: "filters", role: "group", "aria-label": sentence("filters") }, [
      this.#copies,
      ...this.#choices.filter(({ column }) => column.name !== "rig").map(({ root }) => root),
      element("div", { class: "histograms" }, this.#histograms.map(({ root }) => root)),
      // Digits that few know.
      ...this.#choices.filter(({ column }) => column.name === "rig").map(({ root }) => root),
    ]);
  }

  /** The columns whose counts are shown. */
  get counted() {
    return [...this.#histograms, ...this.#choices].map(({ column }) => column.name);
  }

  /** Shows counts of bins by the names of columns. */
  setCounts(counts) {
    for (const each of [...this.#histograms, ...this.#choices]) each.setCounts(counts[each.column.name]);
  }

  /** Shows the filter after it was changed elsewhere. */
  update() {
    for (const each of [...this.#histograms, ...this.#choices]) each.update();
    this.#copies.replaceWith((this.#copies = this.#copiesElement()));
  }

  #copiesElement() {
    const words = { all: "copiesAll", hide: "copiesHide", only: "copiesOnly" };
    const set = (copies) => {
      this.#filter.copies = copies;
      this.update();
      this.#copies.querySelector("[aria-checked='true']").focus();
      this.#changed();
    };
    return element("div", { class: "choice" }, [
      element("span", { class: "label", textContent: sentence("copies") }),
      segments(sentence("copies"), Object.entries(words).map(([value, word]) => ({ text: sentence(word), isChosen: this.#filter.copies === value, choose: () => set(value) }))),
    ]);
  }
}

/** Makes a row of which one is chosen. */
export function segments(name, choices) {
  const move = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const at = choices.findIndex(({ isChosen }) => isChosen);
    choices.at((at + step) % choices.length).choose();
  };
  return element("div", { class: "segments", role: "radiogroup", "aria-label": name, onkeydown: move }, choices.map(({ text, isChosen, choose }) => element("button", {
    type: "button", role: "radio", "aria-checked": String(isChosen), tabIndex: isChosen ? 0 : -1, textContent: text, onclick: choose,
  })));
}

/** A choice of some of many values. */
class Choice {
  root;
  column;
  #filter;
  #changed;
  #chips;
  #counts;

  constructor(column, filter, changed) {
    [this.column, this.#filter, this.#changed] = [column, filter, changed];
    const values = column.values.map((value, at) => ({ value, at })).filter(({ value }) => value !== "");
    this.#chips = values.slice(0, MAX_CHIPS).map(({ value, at }) => {
      const chip = element("button", { type: "button", class: "chip", onclick: () => this.#toggle(value) }, [element("span", { textContent: valueText(column, value) }), element("small")]);
      return { value, at, chip };
    });
    this.root = element("div", { class: "choice" }, [
      element("span", { class: "label", textContent: columnName(column) }),
      element("div", { class: "chips", role: "group", "aria-label": columnName(column) }, this.#chips.map(({ chip }) => chip)),
    ]);
    this.update();
  }

  #toggle(value) {
    const { choices } = this.#filter;
    const chosen = new Set(choices[this.column.name]);
    if (!chosen.delete(value)) chosen.add(value);
    if (chosen.size) choices[this.column.name] = [...chosen];
    else delete choices[this.column.name];
    this.update();
    this.#changed();
  }

  setCounts(counts) {
    this.#counts = counts;
    this.update();
  }

  update() {
    const chosen = this.#filter.choices[this.column.name] ?? [];
    this.#chips.forEach(({ value, at, chip }) => {
      chip.setAttribute("aria-pressed", String(chosen.includes(value)));
      const count = this.#counts?.[at];
      chip.lastChild.textContent = count === undefined ? "" : number(count);
      chip.classList.toggle("empty", count === 0);
    });
  }
}

/** A histogram of a number, whose range is dragged. */
class Histogram {
  root;
  column;
  #filter;
  #changed;
  #canvas;
  #text;
  #handles;
  #counts;
  #dragged;

  constructor(column, filter, changed) {
    [this.column, this.#filter, this.#changed] = [column, filter, changed];
    const name = columnName(column);
    this.#text = element("span", { class: "value" });
    this.#canvas = element("canvas");
    this.#handles = ["from", "to"].map((word, end) => element("div", {
      class: `handle ${word}`, role: "slider", tabIndex: 0, "aria-label": sentence(word, { name }), "aria-orientation": "horizontal", onkeydown: (event) => this.#key(event, end),
    }));
    const plot = element("div", {
      class: "plot", onpointerdown: (event) => this.#press(event), onpointermove: (event) => this.#move(event), onpointerup: () => this.#release(), onpointercancel: () => this.#release(),
      ondblclick: () => this.#set([null, null]),
    }, [this.#canvas, ...this.#handles]);
    this.root = element("div", { class: "histogram", title: column.help ? translated(column.help) : undefined }, [
      element("div", { class: "label" }, [element("span", { textContent: name }), this.#text]), plot,
    ]);
    new ResizeObserver(() => this.update()).observe(this.#canvas);
    window.queueMicrotask(() => this.update());
  }

  setCounts(counts) {
    this.#counts = counts;
    this.update();
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
    const { left, width } = this.#canvas.getBoundingClientRect();
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
    this.#draw(from, to);
  }

  #draw(from, to) {
    const canvas = this.#canvas;
    if (!canvas.isConnected || !canvas.clientWidth) return;
    const context = contextOf(canvas);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const [inside, outside, line] = [color("bar", canvas), color("bar-out", canvas), color("line", canvas)];
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
