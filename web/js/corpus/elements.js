// Making of elements.

/**
 * Makes an element: its properties, attributes where there is a dash or no such property, and
 * listeners, whose names begin with `on`.
 */
export function element(tag, properties = {}, children = []) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (typeof value === "function" && key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key === "class") made.className = value;
    else if (!key.includes("-") && key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const SVG = "http://www.w3.org/2000/svg";
const ICONS = {
  close: "M5 5l10 10M15 5L5 15",
  search: "M9 4a5 5 0 1 0 0 10a5 5 0 0 0 0-10M12.8 12.8L16 16",
  filter: "M4 6h12M6.5 10h7M9 14h2",
  like: "M4 8c3 0 3-3 6-3s3 3 6 3M4 14c3 0 3-3 6-3s3 3 6 3",
  plus: "M10 5v10M5 10h10",
  minus: "M5 10h10",
  all: "M4 8V4h4M12 4h4v4M16 12v4h-4M8 16H4v-4",
  left: "M12 5l-5 5l5 5",
  up: "M6 12l4-4l4 4",
  down: "M6 8l4 4l4-4",
  folder: "M3.5 6.5v8h13v-7h-6l-1.5-2h-5.5z",
  copies: "M7 7h9v9H7zM4 13V4h9",
};

/** Makes an icon of strokes in the colour of the text beside it. */
export function icon(name) {
  const svg = document.createElementNS(SVG, "svg");
  for (const [key, value] of Object.entries({ viewBox: "0 0 20 20", width: 20, height: 20, "aria-hidden": "true", class: "icon" })) svg.setAttribute(key, value);
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** Makes a button with an icon, a text, or both. A name stands in for the text. */
export function button({ icon: sign, text, name, title, ...properties }) {
  return element("button", { type: "button", "aria-label": text ? undefined : name, title: title ?? (text ? undefined : name), ...properties }, [
    sign ? icon(sign) : null, text ? element("span", { textContent: text }) : null,
  ]);
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

/** Returns the size of an element, in CSS pixels. */
export const sizeOf = ({ clientWidth, clientHeight }) => ({ width: clientWidth, height: clientHeight });

/** Sizes a canvas for its place, in device pixels, and returns its context, in CSS pixels. */
export function sized(canvas, { width, height } = sizeOf(canvas)) {
  const ratio = window.devicePixelRatio || 1;
  const pixels = { width: Math.round(width * ratio), height: Math.round(height * ratio) };
  if (canvas.width !== pixels.width || canvas.height !== pixels.height) Object.assign(canvas, pixels);
  // Drawn by the processor: making a context on the graphics card takes longer than drawing.
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return context;
}

/** Returns the context of a canvas that is sized for its place, and empty. */
export function contextOf(canvas, size = sizeOf(canvas)) {
  const context = sized(canvas, size);
  context.clearRect(0, 0, size.width, size.height);
  return context;
}

/** Returns a colour of panel.css by its name. */
export const color = (name, of) => getComputedStyle(of).getPropertyValue(`--${name}`).trim();

/** Returns a function that calls `act` once after the last of several calls, unless `cancel` is called before. */
export function delayed(act, ms) {
  let timer;
  const later = (...args) => {
    clearTimeout(timer);
    timer = setTimeout(act, ms, ...args);
  };
  return Object.assign(later, { cancel: () => clearTimeout(timer) });
}
