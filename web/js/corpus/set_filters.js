// The filters that are set, as chips that take them back.

import { button, element } from "./elements.js";
import { written } from "./table.js";
import { columnName, sentence, valueText } from "./words.js";

export class SetFilters {
  root = element("div", { class: "set-filters" });
  #columns;
  #filter;
  #changed;

  /**
   * @param columns those of the corpus
   * @param filter changed in place: { ranges, choices, copies }
   * @param changed called after each change
   */
  constructor(columns, filter, changed) {
    [this.#columns, this.#filter, this.#changed] = [columns, filter, changed];
  }

  /**
   * Shows the filters that are set, or none. Returns whether there is one. When the chip that had
   * the focus is gone, the next one gets it; `after` gets it when there is none.
   */
  show(isShown, after) {
    const focused = [...this.root.children].findIndex((chip) => chip === document.activeElement);
    const set = this.#set();
    const take = (filters) => {
      for (const { clear } of filters) clear();
      this.#changed();
    };
    const chips = set.map((filter) => button({
      icon: "close", text: filter.text, class: "chip", title: sentence("remove", { name: filter.text }), onclick: () => take([filter]),
    }));
    if (set.length > 1) chips.push(button({ text: sentence("clearFilters"), class: "quiet", onclick: () => take(set) }));
    this.root.replaceChildren(...(isShown ? chips : []));
    if (focused >= 0) (this.root.children[Math.min(focused, set.length - 1)] ?? after).focus({ preventScroll: true });
    return set.length > 0;
  }

  /** Returns the filters that are set, each with its text and how to clear it. */
  #set() {
    const { ranges, choices, copies } = this.#filter;
    const columnOf = (name) => this.#columns.find((column) => column.name === name);
    const set = Object.entries(ranges).map(([name, [from, to]]) => {
      const column = columnOf(name);
      const ends = from === null ? `≤ ${written(to, column)}` : to === null ? `≥ ${written(from, column)}` : `${written(from, column)} – ${written(to, column)}`;
      return { text: `${columnName(column)} ${ends}`, clear: () => delete ranges[name] };
    });
    for (const [name, values] of Object.entries(choices)) {
      set.push({ text: values.map((value) => valueText(columnOf(name), value)).join(", "), clear: () => delete choices[name] });
    }
    if (copies !== "all") {
      set.push({ text: `${sentence("copies")}: ${sentence(copies === "hide" ? "copiesHide" : "copiesOnly")}`, clear: () => { this.#filter.copies = "all"; } });
    }
    return set;
  }
}
