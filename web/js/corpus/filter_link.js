// What the table of a corpus shows, as it stands behind the address of the corpus in a link:
//
//   …/corpus.json#search=walk&labels=run&labels=turn&seconds=2..5.5&copies=hide&sort=-seconds
//
// An end of a range may be open; `-` before the column of the order is for the greatest first.

const COPIES = ["all", "hide", "only"];
/** The significant digits of a range's ends, which are finer than its steps. */
const DIGITS = 6;

/** Returns a filter that leaves out nothing. */
export const noFilter = () => ({ text: "", ranges: {}, choices: {}, copies: "all", sort: { by: "name", down: false } });

/** Returns the text of a filter; empty for one that leaves out nothing and sorts by name. */
export function filterText({ text, ranges, choices, copies, sort }) {
  const parts = new URLSearchParams();
  if (text) parts.append("search", text);
  for (const name of Object.keys(choices).sort()) {
    for (const value of [...choices[name]].sort()) parts.append(name, value);
  }
  for (const name of Object.keys(ranges).sort()) parts.append(name, ranges[name].map(end).join(".."));
  if (copies !== "all") parts.append("copies", copies);
  if (sort.by !== "name" || sort.down) parts.append("sort", `${sort.down ? "-" : ""}${sort.by}`);
  return String(parts);
}

/** Returns the filter of a text. What the columns of the corpus do not have is left out. */
export function filterOf(text, columns) {
  const [parts, filter] = [new URLSearchParams(text), noFilter()];
  filter.text = parts.get("search") ?? "";
  if (COPIES.includes(parts.get("copies"))) filter.copies = parts.get("copies");
  const [, down, by] = /^(-?)(.*)$/s.exec(parts.get("sort") ?? "");
  if (by === "name" || columns.some(({ name, kind }) => name === by && kind === "number")) filter.sort = { by, down: down === "-" };
  for (const { name, kind, values = [] } of columns) {
    if (kind === "number") {
      const range = rangeOf(parts.get(name));
      if (range) filter.ranges[name] = range;
    } else if (kind === "choice") {
      const chosen = values.filter((value) => value !== "" && parts.getAll(name).includes(value));
      if (chosen.length) filter.choices[name] = chosen;
    }
  }
  return filter;
}

const end = (value) => (value === null ? "" : String(Number(value.toPrecision(DIGITS))));

/**
 * Returns the ends of a range, null where it is open. Undefined for a text that is no range, and for
 * one that is open at both ends.
 */
function rangeOf(text) {
  const ends = (text ?? "").split("..").map((part) => (part.trim() ? Number(part) : null));
  const set = ends.filter((each) => each !== null);
  if (ends.length !== 2 || !set.length || !set.every(Number.isFinite) || set[0] > set.at(-1)) return undefined;
  return ends;
}
