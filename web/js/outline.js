// Elements for screen readers and the Tab key: what the app draws on its canvas, as elements of the page over it, unseen.
//
// The app tells what has changed after each frame (`handle.setOutline`). What a reader does with an element goes back to it
// (`handle.act`). A pointer goes through the elements to the canvas.
//
// The keyboard: Tab moves through the elements as through any page's, in reading order. The element that has the focus has it
// in the app, too, and the other way round. All other keys are passed on to the app.

/** Which keys have no effect of the browser's own on an element of ours: the app has taken them. */
const KEEPS = /^(F\d+|Tab)$/;

export class Outline {
  #handle;
  #canvas;
  #root = document.createElement("div");
  /** The elements by their numbers, and what the app has told of each. */
  #elements = new Map();
  #told = new Map();
  /** Shown while it has the focus: past all other parts to the parameters. */
  #skip = document.createElement("button");
  /** The number of the element that has the focus in the app; 0 for none. */
  #focus = 0;
  /** The element that had the focus last: Tab goes on from there when nothing has it. */
  #last;
  /** Set while the focus follows that of the app. */
  #follows = false;
  /** Set when Tab goes out of the page, which then begins anew. */
  #leaves = false;
  /** The number of the element that was to get the focus in the app and has not got it yet, and of the one after it; 0 for none. */
  #sent = 0;
  #asked = 0;
  #late;

  /** @param canvas returns the app's present canvas: one that is lost is replaced */
  constructor(handle, canvas) {
    this.#handle = handle;
    this.#canvas = canvas;
    this.#root.id = "outline";
    this.#skip.id = "skip";
    this.#skip.type = "button";
    this.#skip.addEventListener("click", () => this.#stops("[role='form']")[0]?.focus({ preventScroll: true }));
    canvas().after(this.#skip, this.#root);
    canvas().tabIndex = -1;
    this.#root.addEventListener("focusin", ({ target }) => this.#focused(target));
    this.#root.addEventListener("focusout", () => this.#handle.setOutlineFocus(false));
    this.#root.addEventListener("click", ({ target }) => this.#clicked(target));
    this.#root.addEventListener("input", ({ target }) => this.#act(target, "value", Number(target.value)));
    for (const type of ["keydown", "keyup"]) {
      this.#root.addEventListener(type, (event) => this.#key(event));
      document.addEventListener(type, (event) => this.#tab(event), { capture: true });
    }
    handle.setOutline((text) => this.#update(JSON.parse(text)));
  }

  #update({ values, elements, gone, focus, top, skip }) {
    if (values) return this.#setValues(values);
    const hadKeyboard = this.#root.contains(document.activeElement);
    setText(this.#skip, skip);
    for (const told of elements) this.#show(told);
    // Only now: a parent may name a child that comes after it.
    for (const { number, children = [] } of elements) arrange(this.#elements.get(number), children.map((child) => this.#elements.get(child)));
    for (const number of gone) {
      this.#elements.get(number)?.remove();
      this.#elements.delete(number);
      this.#told.delete(number);
    }
    arrange(this.#root, top.map((number) => this.#elements.get(number)));
    const modal = top.findLast((number) => this.#told.get(number).modal);
    for (const number of top) this.#elements.get(number).inert = modal !== undefined && number !== modal;
    this.#settle(focus);
    if (hadKeyboard) this.#keepKeyboard(modal);
    this.#nameEditor();
  }

  /** Takes new values of elements that are otherwise as they were: so it is in nearly all frames while a motion plays. */
  #setValues(values) {
    for (const { number, name, value, now } of values) {
      const told = this.#told.get(number);
      Object.assign(told, { name, value });
      if (told.range) told.range.now = now;
      showValue(this.#elements.get(number), told);
    }
    this.#settle(this.#focus);
  }

  /** Moves the keyboard from an element that is gone, or behind a dialog, into that dialog, or else to the canvas. */
  #keepKeyboard(modal) {
    const active = document.activeElement;
    if (active !== document.body && !active.closest("[inert]")) return;
    const first = modal === undefined ? undefined : this.#stops(`[data-number='${modal}']`)[0];
    (first ?? this.#canvas()).focus({ preventScroll: true });
  }

  /** Makes an element as the app tells. */
  #show(told) {
    const { number, role, description, range, state, expanded, popup, level, disabled, focusable, modal, place } = told;
    let element = this.#elements.get(number);
    let before = this.#told.get(number);
    const tag = TAGS[role] ?? "div";
    if (element?.localName !== tag || before.role !== role) {
      const old = element;
      before = undefined;
      element = document.createElement(tag);
      element.dataset.number = number;
      old?.replaceWith(element);
      this.#elements.set(number, element);
      if (!(role in TAGS)) element.setAttribute("role", role);
    }
    this.#told.set(number, told);

    const set = (attribute, value) => setAttribute(element, attribute, value);
    if (isText(told)) set("aria-label", "");
    set("aria-description", description);
    set("tabindex", focusable ? 0 : undefined);
    set("aria-disabled", disabled && "true");
    // A box with a menu says at all times whether that is open.
    set("aria-expanded", (expanded ?? (role === "combobox" ? false : undefined))?.toString());
    set("aria-haspopup", popup);
    set("aria-level", role === "heading" ? (level ?? 2) : level);
    set("aria-modal", modal && "true");
    for (const attribute of ["aria-checked", "aria-pressed", "aria-selected"]) set(attribute, state?.[0] === attribute ? state[1] : undefined);
    if (role === "slider") {
      const { min = 0, max = 1, step = "any" } = range ?? {};
      for (const [name, value] of Object.entries({ type: "range", min, max, step })) set(name, String(value));
    } else if (role === "edit") {
      element.type = "text";
    } else if (range) {
      set("aria-valuemin", range.min?.toString());
      set("aria-valuemax", range.max?.toString());
    }
    showValue(element, told);
    const [left, top, width, height] = place;
    // Not as an attribute: the page's policy forbids styles in its markup.
    if (String(before?.place) !== String(place)) {
      Object.assign(element.style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
    }
  }

  /**
   * Asks the app to move its focus, once it has moved it as it was asked before: of several that it gets in one frame, it would
   * take the one that it draws last.
   */
  #ask(number) {
    this.#asked = number;
    if (!this.#sent) this.#send();
  }

  #send() {
    clearTimeout(this.#late);
    [this.#sent, this.#asked] = [this.#asked, 0];
    if (!this.#sent) return;
    this.#handle.act(this.#sent, "focus");
    // An element that the app cannot focus holds up no other.
    this.#late = setTimeout(() => this.#send(), 3000);
  }

  /** Follows the focus of the app, unless the keyboard has gone on since. */
  #settle(focus) {
    const before = this.#focus;
    this.#focus = focus;
    if (this.#sent && focus === this.#sent) return this.#send();
    if (this.#sent && document.activeElement !== document.body) return;
    if (this.#sent) {
      // The element with the keyboard focus was moved, or something has opened in front of it.
      const ahead = this.#elements.get(this.#asked || this.#sent);
      if (ahead?.isConnected && !ahead.closest("[inert]")) return this.#place(ahead);
      clearTimeout(this.#late);
      this.#sent = this.#asked = 0;
    } else if (focus === before) return;
    this.#follow(focus);
  }

  /** The app has moved the focus. */
  #follow(focus) {
    const element = this.#elements.get(focus);
    const active = document.activeElement;
    const isHere = active === this.#canvas() || active === document.body || this.#root.contains(active);
    if (isHere && element !== active) this.#place(element);
  }

  /** Gives an element the keyboard as the app has it already. */
  #place(element) {
    this.#follows = true;
    // A text is edited in the app's own field, which gets the keyboard from the canvas.
    if (!element || element.localName === "input" && element.type === "text") this.#canvas().focus({ preventScroll: true });
    else element.focus({ preventScroll: true });
    this.#follows = false;
  }

  #focused(element) {
    this.#last = element;
    this.#handle.setOutlineFocus(true);
    if (this.#follows) return;
    const number = Number(element?.dataset.number);
    if (number) this.#ask(number);
    if (element.type === "text") this.#canvas().focus({ preventScroll: true });
  }

  /** Only what assistive technology does: a pointer's clicks are the canvas's, and keys are passed on. */
  #clicked(element) {
    this.#act(element.closest("[data-number]"), "click");
  }

  #act(element, action, value) {
    const number = Number(element?.dataset.number);
    if (number) this.#handle.act(number, action, value);
  }

  /** Passes a key on to the app. */
  #key(event) {
    const { key, code, type, shiftKey, ctrlKey, altKey, metaKey } = event;
    const command = ctrlKey || metaKey;
    // The browser tells whom the keyboard belongs to what was copied, cut or pasted.
    if (command && /^[cvx]$/i.test(key)) this.#canvas().focus({ preventScroll: true });
    if (KEEPS.test(key) || event.isComposing) return;
    // A key belongs to the widget that the keyboard has reached.
    if (this.#asked) this.#send();
    if (!command || /^[opsyz,]$/i.test(key)) event.preventDefault();
    const modifiers = [shiftKey, ctrlKey, altKey, metaKey].reduce((sum, on, bit) => sum + (on ? 2 ** bit : 0), 0);
    this.#handle.press(key, code, type === "keydown", modifiers);
  }

  /** Tab goes on from where the app's focus is, also where the canvas has the keyboard, or the field in which the app edits text. */
  #tab(event) {
    const { key, type, shiftKey, ctrlKey, altKey, metaKey, target } = event;
    if (key !== "Tab" || ctrlKey || altKey || metaKey) return;
    const all = [this.#skip, ...this.#stops()];
    const outermost = shiftKey ? all[0] : all.at(-1);
    if (all.includes(target)) {
      this.#leaves = target === outermost;
      return;
    }
    if (target !== this.#canvas() && target !== this.#editor() && target !== document.body) return;
    event.stopImmediatePropagation();
    if (type === "keyup") return event.preventDefault();
    const reached = this.#asked || this.#sent || this.#focus;
    const at = this.#leaves ? -1 : all.indexOf(this.#elements.get(reached) ?? this.#last);
    const next = at < 0 && shiftKey ? all.length - 1 : at + (shiftKey ? -1 : 1);
    this.#leaves = !all[next];
    // Beyond the outermost the browser goes on, out of the page.
    if (!this.#leaves) event.preventDefault();
    (all[next] ?? outermost).focus({ preventScroll: true });
  }

  /** Where Tab stops, within the elements that `within` selects. */
  #stops(within = "") {
    return [...this.#root.querySelectorAll(`${within} [tabindex='0']:not([inert] *)`)];
  }

  /** The unseen field in which the app edits text: it stands behind the canvas. */
  #editor() {
    return this.#canvas().parentElement.querySelector(":scope > input");
  }

  #nameEditor() {
    const editor = this.#editor();
    if (!editor) return;
    const name = this.#told.get(this.#focus)?.name || "Segue";
    if (editor.getAttribute("aria-label") !== name) editor.setAttribute("aria-label", name);
    if (editor.tabIndex !== -1) editor.tabIndex = -1;
  }
}

/** Which roles are elements of HTML; all others are `div`s with that role. */
const TAGS = { text: "span", slider: "input", edit: "input" };

/** Whether an element is a text, which is its name. */
function isText({ role, children }) {
  return ["text", "alert", "status"].includes(role) && !children;
}

/** Writes what changes of an element while all else stays as it is. */
function showValue(element, told) {
  const { role, name = "", value = "", range } = told;
  if (isText(told)) return setText(element, name);
  const hasOwnValue = range || role === "slider" || role === "edit";
  // A value without an attribute of its own goes into the name, such as the choice of a combo box.
  setAttribute(element, "aria-label", value && !hasOwnValue ? `${name}: ${value}` : name);
  if (role === "slider") element.value = range?.now ?? 0;
  else if (role === "edit") element.value = value;
  else if (range) setAttribute(element, "aria-valuenow", String(range.now));
  if (hasOwnValue && role !== "edit") setAttribute(element, "aria-valuetext", value);
}

/** Sets an attribute, or removes it for nothing. What is written again has the browser lay out the page again. */
function setAttribute(element, attribute, value) {
  if (value === undefined || value === "" || value === false) element.removeAttribute(attribute);
  else if (element.getAttribute(attribute) !== String(value)) element.setAttribute(attribute, value);
}

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Gives an element these children in this order, and moves only what is out of place: what is moved loses the focus. */
function arrange(parent, children) {
  const kept = new Set(children);
  for (const child of [...parent.children]) if (!kept.has(child)) child.remove();
  let next = parent.firstElementChild;
  for (const child of children) {
    if (child === next) next = next.nextElementSibling;
    else parent.insertBefore(child, next);
  }
}
