// The filters: a histogram with a range for each number, and chips for choices.

import { element, segments } from "./elements.js";
import { Histogram, drawAll } from "./histogram.js";
import { columnName, number, sentence, valueText } from "./words.js";

/** The choices in the order in which they stand; others are left out. */
const CHOICES = ["labels", "format", "status", "rig"];
const MAX_CHIPS = 60;
/** Columns of numbers that come last: few look for them. */
export const LAST = ["frames", "fps", "height_m"];

export class Filters {
  root;
  #filter;
  #changed;
  #histograms;
  #choices;
  #copies;
  #frame = 0;
  #resized = new ResizeObserver(() => this.draw());

  /**
   * @param columns those of the corpus
   * @param filter changed in place: { ranges, choices, copies }
   * @param changed called after each change
   */
  constructor(columns, filter, changed) {
    [this.#filter, this.#changed] = [filter, changed];
    const numbers = columns.filter(({ kind, min, max }) => kind === "number" && min < max);
    const isLast = ({ name }) => Number(LAST.includes(name));
    this.#histograms = numbers.sort((one, other) => isLast(one) - isLast(other)).map((column) => new Histogram(column, filter, () => {
      this.draw();
      changed();
    }));
    for (const { canvas } of this.#histograms) this.#resized.observe(canvas);
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
    this.draw();
  }

  /** Draws the histograms in the next frame. */
  draw() {
    cancelAnimationFrame(this.#frame);
    this.#frame = requestAnimationFrame(() => drawAll(this.#histograms));
  }

  /** Ends what is under way. */
  end() {
    cancelAnimationFrame(this.#frame);
    this.#resized.disconnect();
  }

  /** Shows the filter after it was changed elsewhere. */
  update() {
    for (const each of [...this.#histograms, ...this.#choices]) each.update();
    this.#copies.replaceWith((this.#copies = this.#copiesElement()));
    this.draw();
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
