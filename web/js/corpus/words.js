// The texts of the panel in the languages of the page. `{name}` stands for a value.

const ENGLISH = {
  corpus: "Corpus",
  closeCorpus: "Close the corpus",
  resize: "Width of the corpus",
  table: "Table",
  map: "Map",
  view: "View",
  search: "Search names and labels",
  filters: "Filters",
  clearFilters: "Clear all",
  remove: "Remove the filter {name}",
  copies: "Copies",
  copiesAll: "All",
  copiesHide: "Hide",
  copiesOnly: "Only",
  allClips: "{count} clips",
  someClips: "{count} of {all} clips",
  length: "{hours} h {minutes} min",
  lengthMinutes: "{minutes} min",
  noClips: "No clip fits. Take back a filter, or search for less.",
  clips: "Clips",
  thumbnail: "Poses",
  putInto: "Use",
  name: "Name",
  seconds: "Length",
  frames: "Frames",
  fps: "Frame rate",
  height_m: "Height",
  format: "Format",
  rig: "Rig",
  labels: "Labels",
  status: "Status",
  distance: "Distance",
  ok: "read",
  unplaced: "not on the standard body",
  unreadable: "cannot be read",
  copy: "copy",
  mirrored: "mirrored copy",
  from: "{name} from",
  to: "{name} to",
  putA: "Use {name} as A",
  putB: "Use {name} as B",
  dropA: "Drop here for A",
  dropB: "Drop here for B",
  playing: "On the stage",
  nothing: "Click a clip: it plays here.",
  likeThis: "More like this moment",
  likeHelp: "Finds the clips with the moments most similar to the pose and motion at the playhead, of whatever is on the stage",
  likeTitle: "Like {name} at {seconds} s",
  at: "at {seconds} s",
  searching: "Searching…",
  back: "All clips",
  nearCopies: "{count, plural, one {# copy} other {# copies}}",
  copiesOf: "Copies of {name}",
  range: "Range of the clip",
  rangeFrom: "Beginning of the range",
  rangeTo: "End of the range",
  whole: "Whole clip",
  mapHelp: "All clips, placed by their motion: similar ones lie close together. Drag to move, scroll or pinch to zoom, click to play.",
  mapKeys: "Arrow keys move, plus and minus zoom, 0 shows all, Enter plays the clip in the middle.",
  zoomIn: "Zoom in",
  zoomOut: "Zoom out",
  showAll: "Show all",
  stage: "Stage",
  opening: "Opening {name}…",
  tryAgain: "Try again",
  other: "Open another corpus",
  chooseTitle: "Open a corpus",
  chooseText: "A corpus is a folder of static files, made of many motion files by `segue corpus build`. It is read where it lies, in small parts.",
  address: "Address",
  addressHint: "https://example.org/takes/corpus.json",
  open: "Open",
  folder: "Open a folder…",
  folderText: "Or drop the folder here. Its files stay on this computer, so that no link can name it.",
  local: "on this computer",
  localLink: "A link cannot name a corpus on this computer.",
  wrongAddress: "This is not the address of a corpus. Such an address begins with https:// and names the folder of the corpus, or its corpus.json.",
  noFolder: "There is no corpus.json in {name}. Choose the folder that `segue corpus build` has written.",
  noRead: "{name} could not be played: {reason}",
  // Errors of reading.
  offline: "There is no connection to the internet, so {file} was not read.",
  insecure: "A secure page cannot read from http://{host}. Use an address that begins with https://.",
  cors: "{host} does not let other pages read its files (CORS). Its owner can allow that with the header Access-Control-Allow-Origin: *. Or download the corpus, and open its folder here.",
  unreachable: "{host} cannot be reached. Check the address, and try again.",
  late: "{host} has sent nothing for {seconds} s, so reading {file} was stopped. Try again later.",
  notThere: "There is no {file} at this address of {host} (status {status}). Check the address: it is that of the folder in which corpus.json lies.",
  notAllowed: "{host} does not allow everyone to read {file} (status {status}).",
  wrongStatus: "{host} answered with status {status} instead of {file}. Try again later.",
  webPage: "{host} sends a web page instead of {file}. Use the address of the file itself.",
  noRanges: "{host} sends whole files instead of the parts that are asked for, and {file} is too large for that. Put the corpus on a host that serves ranges (most do), or download it and open its folder here.",
  shortFile: "{file} is shorter than corpus.json says. Copy the corpus again, or build it again.",
  noFile: "{file} is not in this folder. Copy the corpus again as a whole.",
  changedFile: "{file} can no longer be read. Open the folder again.",
  damaged: "The corpus is damaged: {reason}. Copy it again, or build it again.",
  noManifest: "{file} does not describe a corpus: it is not JSON. Copy the corpus again, or build it again.",
  olderCorpus: "This corpus was made by an older version of Segue, in another format. Build it again: what has been computed is kept.",
  newerCorpus: "This corpus was made by a newer version of Segue. Load the page again, or use a newer one.",
  tooShort: "This clip is too short: a moment is compared by the second that follows it.",
  noMotion: "This file has no motion.",
  fourLegs: "This body stands on four legs. Only the moments of people are compared.",
  noColumns: "This corpus was made by an older version of Segue, without what the page reads. Build it again: what has been computed is kept.",
  noClip: "There is no clip {id} in this corpus. It may have been built anew from other files.",
  noPoses: "{name} has no motion to play: {reason}",
  noClipAddress: "`{address}` is not a clip of a corpus. The address of one ends in corpus.json#, the clip's id and, if you like, @ and seconds, as in @1.5-4.",
  noWorker: "The reader of corpora could not start. Check the connection, and load the page again. {reason}",
  ended: "This corpus is no longer open. Open it again.",
  trapped: "The reader of corpora has stopped: {reason}. This is an error in Segue, not in your corpus. Open the corpus again.",
};

const CHINESE = {
  corpus: "動作集",
  closeCorpus: "關閉動作集",
  resize: "動作集的寬度",
  table: "表格",
  map: "地圖",
  view: "檢視",
  search: "搜尋名稱與標籤",
  filters: "篩選",
  clearFilters: "全部清除",
  remove: "移除篩選：{name}",
  copies: "重複片段",
  copiesAll: "全部",
  copiesHide: "隱藏",
  copiesOnly: "只看重複",
  allClips: "{count} 個片段",
  someClips: "{all} 個片段中的 {count} 個",
  length: "{hours} 小時 {minutes} 分",
  lengthMinutes: "{minutes} 分鐘",
  noClips: "沒有符合的片段。請取消一項篩選，或縮短搜尋文字。",
  clips: "片段",
  thumbnail: "姿勢",
  putInto: "使用",
  name: "名稱",
  seconds: "長度",
  frames: "影格數",
  fps: "影格率",
  height_m: "身高",
  format: "格式",
  rig: "骨架",
  labels: "標籤",
  status: "狀態",
  distance: "距離",
  ok: "已讀取",
  unplaced: "無法套用到標準身體",
  unreadable: "無法讀取",
  copy: "重複",
  mirrored: "鏡像重複",
  from: "{name}：從",
  to: "{name}：到",
  putA: "把 {name} 放到 A",
  putB: "把 {name} 放到 B",
  dropA: "放在這裡當作 A",
  dropB: "放在這裡當作 B",
  playing: "舞台上",
  nothing: "點一個片段，就會在這裡播放。",
  likeThis: "找相似的瞬間",
  likeHelp: "依播放位置的姿勢與動作，找出最相似的瞬間；舞台上是什麼都可以",
  likeTitle: "與 {name} 第 {seconds} 秒相似",
  at: "第 {seconds} 秒",
  searching: "搜尋中…",
  back: "所有片段",
  nearCopies: "{count, plural, other {# 個重複}}",
  copiesOf: "{name} 的重複片段",
  range: "片段的範圍",
  rangeFrom: "範圍起點",
  rangeTo: "範圍終點",
  whole: "整個片段",
  mapHelp: "所有片段依動作的相似程度排列：越相似就越靠近。拖曳移動，滾輪或雙指縮放，點選播放。",
  mapKeys: "方向鍵移動，加號與減號縮放，0 顯示全部，Enter 播放正中央的片段。",
  zoomIn: "放大",
  zoomOut: "縮小",
  showAll: "顯示全部",
  stage: "舞台",
  opening: "正在開啟 {name}…",
  tryAgain: "再試一次",
  other: "開啟另一個動作集",
  chooseTitle: "開啟動作集",
  chooseText: "動作集是一個靜態檔案的資料夾，由 `segue corpus build` 從許多動作檔製作而成。檔案留在原處，需要時才讀取一小部分。",
  address: "網址",
  addressHint: "https://example.org/takes/corpus.json",
  open: "開啟",
  folder: "開啟資料夾…",
  folderText: "也可以把資料夾拖到這裡。檔案只留在這台電腦上，所以連結無法指向它。",
  local: "在這台電腦上",
  localLink: "連結無法指向這台電腦上的動作集。",
  wrongAddress: "這不是動作集的網址。網址以 https:// 開頭，指向動作集的資料夾或其中的 corpus.json。",
  noFolder: "{name} 裡沒有 corpus.json。請選擇 `segue corpus build` 寫出的資料夾。",
  noRead: "無法播放 {name}：{reason}",
  offline: "沒有網路連線，所以沒有讀取 {file}。",
  insecure: "安全的網頁無法讀取 http://{host}。請使用 https:// 開頭的網址。",
  cors: "{host} 不允許其他網頁讀取它的檔案（CORS）。擁有者可以用標頭 Access-Control-Allow-Origin: * 開放。也可以下載動作集，再在這裡開啟資料夾。",
  unreachable: "連不上 {host}。請檢查網址，再試一次。",
  late: "{host} 已有 {seconds} 秒沒有傳送資料，所以停止讀取 {file}。請稍後再試。",
  notThere: "{host} 的這個網址沒有 {file}（回應 {status}）。請檢查網址：應該是 corpus.json 所在的資料夾。",
  notAllowed: "{host} 不公開 {file}（回應 {status}）。",
  wrongStatus: "{host} 沒有傳送 {file}（回應 {status}）。請稍後再試。",
  webPage: "{host} 傳來的是網頁，不是 {file}。請使用檔案本身的網址。",
  noRanges: "{host} 只傳送整個檔案，不支援讀取一部分，而 {file} 太大了。請把動作集放到支援範圍要求的主機（大多數都支援），或下載後在這裡開啟資料夾。",
  shortFile: "{file} 比 corpus.json 所寫的短。請重新複製或重新製作動作集。",
  noFile: "這個資料夾裡沒有 {file}。請重新複製整個動作集。",
  changedFile: "{file} 已無法讀取。請再開啟一次資料夾。",
  damaged: "動作集已損壞：{reason}。請重新複製或重新製作。",
  noManifest: "{file} 不是動作集的說明檔：它不是 JSON。請重新複製或重新製作動作集。",
  olderCorpus: "這個動作集由較舊版本的 Segue 以另一種格式製作。請重新製作：已計算的部分會保留。",
  newerCorpus: "這個動作集由較新版本的 Segue 製作。請重新載入頁面，或使用較新的版本。",
  tooShort: "這個片段太短：比較一個時刻時，會用到它之後一秒的動作。",
  noMotion: "這個檔案裡沒有動作。",
  fourLegs: "這個角色有四條腿。只能比較人的動作時刻。",
  noColumns: "這個動作集由較舊版本的 Segue 製作，缺少網頁要讀取的資料。請重新製作：已計算的部分會保留。",
  noClip: "這個動作集裡沒有片段 {id}。它可能已用其他檔案重新製作。",
  noPoses: "{name} 沒有可播放的動作：{reason}",
  noClipAddress: "`{address}` 不是動作集裡的片段。網址結尾是 corpus.json#、片段的代號，也可以再加上 @ 與秒數，例如 @1.5-4。",
  noWorker: "無法啟動動作集的讀取程式。請檢查連線，再重新載入頁面。{reason}",
  ended: "這個動作集已經關閉。請再開啟一次。",
  trapped: "動作集的讀取程式已停止：{reason}。這是 Segue 的錯誤，不是你的動作集有問題。請再開啟一次動作集。",
};

/** Returns whether the page is in Chinese, which the app may have changed. */
const isChinese = () => document.documentElement.lang === "zh-Hant";

/** Returns a text with its values. `{count, plural, …}` becomes the form for the number. */
export function sentence(key, values = {}) {
  const text = (isChinese() ? CHINESE : ENGLISH)[key] ?? key;
  const plural = /\{(\w+), plural, (?:one \{([^}]*)\} )?other \{([^}]*)\}\}/;
  const chosen = text.replace(plural, (_, name, one, other) => (values[name] === 1 && one ? one : other).replace("#", number(values[name])));
  return chosen.replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");
}

/** Returns a whole number as the language writes it. */
export const number = (value) => value.toLocaleString(isChinese() ? "zh-Hant-TW" : "en");

let catalogue;

/**
 * Loads the app's own translations, in which the names of the metrics stand. Without them, these
 * are English.
 */
export async function loadCatalogue() {
  if (!isChinese() || catalogue) return;
  try {
    const sections = await (await fetch(new URL("lang/zh-Hant.json", document.baseURI))).json();
    catalogue = Object.assign({}, ...Object.values(sections));
  } catch (reason) {
    console.info(reason);
  }
}

/** Returns a text of the corpus, such as the name of a metric, in the language of the page. */
export const translated = (text) => (isChinese() && catalogue?.[text]) || text;

/** Returns a value of a column of choices as it is shown. */
export function valueText({ name }, value) {
  if (name === "format") return value.toUpperCase();
  return name === "status" ? sentence(value) : value;
}

/** Returns the name of a column. */
export function columnName({ name, label }) {
  return Object.hasOwn(ENGLISH, name) ? sentence(name) : translated(label);
}
