// A worker with one corpus: it reads ranges of its files, and asks its own WebAssembly
// (src/bin/corpus.rs). client.js makes it.
//
// The page posts { call, name, args } and { cancel: call }. The worker answers each call with
// { call, part } any number of times, and with { call, result } or { call, error }.

import init, { Corpus } from "./corpus.js";
import { FolderSource, SourceError, WebSource } from "./source.js";

const MANIFEST = "corpus.json";
/** The name of the columns unless corpus.json has another one: both are requested at once. */
const COLUMNS = "columns.bin";
/** The greatest gap between thumbnails that one request reads, and the most that it reads, bytes. */
const MAX_GAP_BYTES = 8 << 10;
const MAX_THUMBNAILS_BYTES = 256 << 10;
/** The number of clips whose poses are kept. */
const MAX_POSES = 8;

const started = init();
started.catch(() => {}); // the first call reports it
let source;
/** The corpus, once `open` is done. */
let corpus;
/** The index, once it is read. */
let index;
/** Lists of the index that are read or being read, by their numbers. */
const lists = new Map();
/** Poses of clips, by their rows, the latest last. */
const poses = new Map();
/** Calls that can be cancelled, by their numbers. */
const running = new Map();

self.onmessage = async ({ data: { call, name, args, cancel } }) => {
  if (cancel !== undefined) return running.get(cancel)?.abort();
  const controller = new AbortController();
  running.set(call, controller);
  const onPart = (part, transfer = []) => self.postMessage({ call, part }, transfer);
  try {
    const [result, transfer = []] = await calls[name](args, controller.signal, onPart);
    self.postMessage({ call, result }, transfer);
  } catch (reason) {
    self.postMessage({ call, error: errorOf(reason) });
  } finally {
    running.delete(call);
  }
};

/** Returns what can be posted of an error. */
function errorOf(reason) {
  // One of the sources, or of the WebAssembly.
  if (reason?.word) return { word: reason.word, values: reason.values ?? {} };
  if (reason?.name === "AbortError") return { isCancelled: true };
  if (reason instanceof WebAssembly.RuntimeError) return { word: "trapped", values: { reason: reason.message } };
  return { text: String(reason?.message ?? reason) };
}

const calls = {
  /** Opens the corpus at an address, or in files by their paths. */
  async open({ address, files }, signal) {
    source = files ? new FolderSource(files) : new WebSource(address);
    const [manifest, columns] = [source.whole(MANIFEST, signal), source.whole(COLUMNS, signal)];
    columns.catch(() => {}); // corpus.json may have another name for it
    const text = new TextDecoder().decode(await manifest);
    const named = columnsOf(text);
    const bytes = named === COLUMNS ? await columns : await source.whole(named, signal);
    await started;
    corpus = readable(() => new Corpus(text, bytes));
    return [{ rows: corpus.rows(), counts: JSON.parse(corpus.counts()), columns: JSON.parse(corpus.columns()) }];
  },

  select({ filter }) {
    const rows = corpus.select(JSON.stringify(filter));
    return [rows, [rows.buffer]];
  },

  /** Returns the counts of several columns. Newer calls are answered between two of them. */
  async histograms({ columns, filter, bins }, signal) {
    const text = JSON.stringify(filter);
    const counts = {};
    for (const column of columns) {
      counts[column] = corpus.histogram(column, text, bins);
      await nextTask();
      signal.throwIfAborted();
    }
    return [counts];
  },

  cells: ({ rows }) => [JSON.parse(corpus.cells(Uint32Array.from(rows)))],
  find: ({ id }) => [corpus.find(id)],
  copiesOf: ({ row }) => [corpus.copiesOf(row)],

  map() {
    const points = corpus.map();
    return [points, [points.buffer]];
  },

  /** Reads thumbnails, several neighbours with one request. Each is a part: its row and its PNG. */
  async thumbnails({ rows }, signal, onPart) {
    const places = rows.map((row) => [row, corpus.thumbnail(row)]);
    for (const [row, place] of places) if (!place) onPart([row, null]);
    const known = places.filter(([, place]) => place).map(([row, [shard, offset, length]]) => ({ row, shard, offset, end: offset + length }));
    known.sort((one, other) => one.shard - other.shard || one.offset - other.offset);
    const groups = [];
    for (const place of known) {
      const group = groups.at(-1);
      const isNear = group?.shard === place.shard && place.offset - group.end <= MAX_GAP_BYTES && place.end - group.offset <= MAX_THUMBNAILS_BYTES;
      if (isNear) group.end = Math.max(group.end, place.end);
      else groups.push({ shard: place.shard, offset: place.offset, end: place.end, places: [] });
      groups.at(-1).places.push(place);
    }
    await Promise.all(groups.map(async ({ shard, offset, end, places }) => {
      const bytes = await source.range(shardName("thumbnails", shard), offset, end - offset, signal);
      for (const place of places) {
        const png = bytes.slice(place.offset - offset, place.end - offset);
        onPart([place.row, png], [png.buffer]);
      }
    }));
    return [undefined];
  },

  /** Reads a clip, or a range of it, as the bytes of an NPZ file. */
  async clip({ id, range }, signal) {
    const row = corpus.find(id);
    if (row === undefined) throw new SourceError("noClip", { id });
    const [{ name, status, message }] = JSON.parse(corpus.cells(Uint32Array.of(row)));
    const bytes = await posesOf(row, signal);
    if (!bytes) throw new SourceError("noPoses", { name, reason: message ?? status });
    const npz = readable(() => corpus.npz(name, bytes, range?.[0], range?.[1]));
    const sha256 = await digest(npz);
    return [{ row, name, bytes: npz, sha256 }, [npz.buffer]];
  },

  /** Finds the clips with the nearest moments to one of a clip of the corpus, or of a file. */
  async like({ row, name, bytes, seconds, count }, signal) {
    // What is kept for later searches is read to its end, also when this one is cancelled.
    await indexRead();
    const query = bytes ? corpus.queryOfFile(name, bytes, seconds) : corpus.queryOfPoses(await posesOf(row, signal), seconds);
    const places = corpus.nearestLists(query, 0);
    const wanted = [];
    const read = [];
    for (let at = 0; at < places.length; at += 4) {
      const [list, file, offset, length] = places.subarray(at, at + 4);
      wanted.push(list);
      if (!lists.has(list)) {
        const reading = source.range(shardName("index/lists", file), offset, length).then((bytes) => readable(() => corpus.takeList(list, bytes)));
        lists.set(list, reading);
        reading.catch(() => lists.delete(list));
      }
      read.push(lists.get(list));
    }
    await Promise.all(read);
    signal.throwIfAborted();
    return [JSON.parse(corpus.search(query, Uint32Array.from(wanted), count))];
  },

  /** Reads the index, so that the first search does not wait for it. */
  async prepare() {
    await indexRead();
    return [undefined];
  },
};

/** Returns what the WebAssembly makes of bytes of the corpus, which may be damaged. */
function readable(act) {
  try {
    return act();
  } catch (reason) {
    // Others have a sentence of their own, or are a trap.
    if (typeof reason !== "string") throw reason;
    throw new SourceError("damaged", { reason });
  }
}

/** Returns the name of the columns that corpus.json has. */
function columnsOf(manifest) {
  let page;
  try {
    ({ page } = JSON.parse(manifest));
  } catch {
    throw new SourceError("noManifest", { file: MANIFEST });
  }
  if (typeof page?.columns !== "string") throw new SourceError("noColumns", { file: MANIFEST });
  return page.columns;
}

/** Lets what has been posted meanwhile come first. A timer would wait some milliseconds. */
const nextTask = () => new Promise((resolve) => {
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    port1.close();
    resolve();
  };
  port2.postMessage(null);
});

const shardName = (kind, number) => `${kind}-${String(number).padStart(5, "0")}.bin`;

async function posesOf(row, signal) {
  const kept = poses.get(row);
  if (kept) {
    poses.delete(row);
    poses.set(row, kept);
    return kept;
  }
  const place = corpus.poses(row);
  if (!place) return null;
  const [shard, offset, length] = place;
  const bytes = await source.range(shardName("poses", shard), offset, length, signal);
  poses.set(row, bytes);
  for (const oldest of poses.keys()) if (poses.size > MAX_POSES) poses.delete(oldest);
  return bytes;
}

function indexRead() {
  index ??= source.whole("index/centroids.bin").then((bytes) => readable(() => corpus.setIndex(bytes)));
  index.catch(() => { index = undefined; });
  return index;
}

/** Returns the SHA-256 of some bytes; undefined on an insecure address. */
async function digest(bytes) {
  if (!self.crypto?.subtle) return undefined;
  const sum = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  return Array.from(sum, (byte) => byte.toString(16).padStart(2, "0")).join("");
}
