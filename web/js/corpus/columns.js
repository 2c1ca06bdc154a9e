// The columns of the table that there is room for.

import { LAST } from "./filters.js";

/** The widths of what a row has beside its numbers, and of a number, pixels, as in panel.css. */
const DESK = { rest: 384, number: 72 };
const PHONE = { rest: 327, number: 72 };

/**
 * Returns the columns of numbers that a table shows: those first that are looked at.
 * @param columns those of the corpus
 * @param filter { sort, ranges }
 * @param place.width of the table, pixels; isPhone; hasHits: whether it shows what a search has found
 */
export function shownColumns(columns, { sort, ranges }, { width, isPhone, hasHits }) {
  const rank = ({ name }) => (name === "seconds" ? -3 : name === sort.by ? -2 : name in ranges ? -1 : LAST.includes(name) ? 1 : 0);
  const numbers = columns.filter(({ kind }) => kind === "number").sort((one, other) => rank(one) - rank(other));
  const { rest, number } = isPhone ? PHONE : DESK;
  const distance = hasHits ? [{ name: "distance", label: "", kind: "number" }] : [];
  return [...distance, ...numbers].slice(0, Math.max(Math.floor((width - rest) / number), 1));
}
