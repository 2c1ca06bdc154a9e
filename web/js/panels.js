// Panels for failures of the app: plain HTML over the rest of the picture, in the language of the
// page.

const ENGLISH = {
  unsupported: "This browser offers neither WebGPU nor WebGL2",
  unsupportedText: "Segue draws with one of the two. A current Chrome, Edge, Firefox or Safari has them; if yours is current, " +
    "hardware acceleration may be switched off in its settings.",
  download: "Segue could not be downloaded",
  downloadText: "The connection may have been interrupted. Nothing is lost: the link holds the state.",
  start: "Segue could not start",
  startText: "The graphics could not be set up.",
  lost: "The graphics device was lost",
  lostText: "It may have been reset or taken by another program. Reloading restores this state.",
  panic: "Segue has stopped",
  panicText: "This is an error in Segue, not in your files. Reloading restores this state; the report helps to fix it.",
  memory: "There is not enough memory",
  memoryText: "Segue uses {} MB, and this browser provides no more. Reloading restores what is stored; remove clips that you do not need.",
  again: "Try again",
  reload: "Reload with this state",
  report: "Copy a report",
  copied: "Copied",
};
const CHINESE = {
  unsupported: "這個瀏覽器沒有 WebGPU，也沒有 WebGL2",
  unsupportedText: "Segue 需要其中一種才能繪圖。新版的 Chrome、Edge、Firefox 或 Safari 都有；如果已是新版，可能是設定裡關閉了硬體加速。",
  download: "無法下載 Segue",
  downloadText: "連線可能中斷了。不會遺失任何內容：連結裡有完整的狀態。",
  start: "Segue 無法啟動",
  startText: "無法設定繪圖功能。",
  lost: "失去了繪圖裝置",
  lostText: "裝置可能被重設，或被其他程式占用。重新載入即可回到現在的狀態。",
  panic: "Segue 已停止運作",
  panicText: "這是 Segue 的錯誤，不是你的檔案有問題。重新載入即可回到現在的狀態；附上報告有助於修正。",
  memory: "記憶體不足",
  memoryText: "Segue 已使用 {} MB，瀏覽器無法再提供更多。重新載入即可回到已儲存的內容；請移除不需要的片段。",
  again: "再試一次",
  reload: "重新載入並保留狀態",
  report: "複製報告",
  copied: "已複製",
};

/** Returns the texts in the page's language, which the app may have changed. */
const words = () => (document.documentElement.lang === "zh-Hant" ? CHINESE : ENGLISH);

export function showUnsupported() {
  show({ title: words().unsupported, text: words().unsupportedText });
}

export function showDownloadFailed(reason) {
  show({ title: words().download, text: words().downloadText, detail: reason, buttons: [[words().again, reload]] });
}

export function showStartFailed(reason, facts) {
  show({ title: words().start, text: words().startText, detail: reason, buttons: [[words().again, reload], copyReport(reason, facts)] });
}

/** Shows that the graphics device is lost. `again` loads the page again. */
export function showLost(reason, facts, again = reload) {
  show({ title: words().lost, text: words().lostText, detail: reason, buttons: [[words().reload, again], copyReport(reason, facts)] });
}

export function showPanic(summary, facts) {
  show({ title: words().panic, text: words().panicText, detail: summary, buttons: [[words().reload, reload], copyReport(summary, facts)] });
}

/** Shows that an allocation has failed. `bytes` is the size of the memory. */
export function showNoMemory(bytes, summary, facts) {
  const text = words().memoryText.replace("{}", Math.round(bytes / 1e6));
  show({ title: words().memory, text, buttons: [[words().reload, reload], copyReport(summary, facts)] });
}

const copyReport = (text, facts) => [words().report, (button) => copy(report(text, facts), button)];

/** Reloads the page. The address holds the state. */
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
    button.textContent = words().copied;
    return;
  }
  // Without a clipboard (an insecure address, or a frame without the permission), the text is shown
  // and selected.
  const detail = button.closest(".panel").querySelector("pre");
  detail.textContent = text;
  window.getSelection().selectAllChildren(detail);
}

/** Shows a panel, unless one is shown already: the first failure is the cause of later ones. */
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
