// What the page says when the app cannot: plain HTML over whatever is left of the picture.

export function showUnsupported() {
  show({
    title: "This browser offers neither WebGPU nor WebGL2",
    text: "Segue draws with one of the two. A current Chrome, Edge, Firefox or Safari has them; if yours is current, " +
      "hardware acceleration may be switched off in its settings.",
  });
}

export function showDownloadFailed(reason) {
  show({
    title: "Segue could not be downloaded",
    text: "The connection may have been interrupted. Nothing is lost: the link holds the state.",
    detail: reason,
    buttons: [["Try again", reload]],
  });
}

export function showStartFailed(reason, facts) {
  show({
    title: "Segue could not start",
    text: "The graphics could not be set up.",
    detail: reason,
    buttons: [["Try again", reload], ["Copy a report", (button) => copy(report(reason, facts), button)]],
  });
}

export function showLost(reason, facts) {
  show({
    title: "The graphics device was lost",
    text: "It may have been reset or taken by another program. Reloading brings back this state.",
    detail: reason,
    buttons: [["Reload with this state", reload], ["Copy a report", (button) => copy(report(reason, facts), button)]],
  });
}

export function showPanic(summary, facts) {
  show({
    title: "Segue has stopped",
    text: "This is a mistake in Segue, not in your files. Reloading brings back this state; the report helps to mend it.",
    detail: summary,
    buttons: [["Reload with this state", reload], ["Copy a report", (button) => copy(report(summary, facts), button)]],
  });
}

/** The link holds the state, so the same address is the same state. */
function reload() {
  window.location.reload();
}

function report(text, { version, backend } = {}) {
  return [
    `Segue ${version ?? "(version unknown)"}`,
    text,
    "",
    `backend: ${backend ?? "unknown"}`,
    `browser: ${navigator.userAgent}`,
    `window: ${window.innerWidth}×${window.innerHeight} at ${window.devicePixelRatio}`,
    `address: ${window.location.href}`,
    `after: ${(performance.now() / 1000).toFixed(1)} s`,
  ].join("\n");
}

async function copy(text, button) {
  const done = await navigator.clipboard?.writeText(text).then(() => true, () => false);
  if (done) {
    button.textContent = "Copied";
    return;
  }
  // No clipboard here (an insecure address, or a frame without the permission): show it, selected, to copy by hand.
  const detail = button.closest(".panel").querySelector("pre");
  detail.textContent = text;
  window.getSelection().selectAllChildren(detail);
}

/** Shows one panel at a time: the first word is the cause, what follows is its wake. */
function show({ title, text, detail, buttons = [] }) {
  document.getElementById("loading")?.remove();
  if (document.querySelector(".veil")) return;
  const panel = element("div", { className: "panel", role: "alertdialog", ariaModal: "true", ariaLabel: title }, [
    element("h1", { textContent: title }),
    element("p", { textContent: text }),
    ...(detail ? [element("pre", { textContent: detail })] : []),
    element("div", { className: "buttons" }, buttons.map(([label, act], index) => {
      const button = element("button", { type: "button", textContent: label, className: index === 0 ? "first" : "" });
      button.addEventListener("click", () => act(button));
      return button;
    })),
  ]);
  document.body.append(element("div", { className: "veil" }, [panel]));
  panel.querySelector("button")?.focus();
}

function element(tag, properties, children = []) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}
