"""The files of a corpus."""

from __future__ import annotations

import hashlib
import json
import posixpath
from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import itemgetter
from pathlib import Path
from typing import Any

from .. import _core
from ._needs import needed
from ._sources import Source
from ._store import Store, write_whole
from ._work import make

#: A column of the table: its name, its type, and what gives the value of a row.
Column = tuple[str, Any, Callable[[dict[str, Any]], Any]]

#: Rows of the table that are read together.
_ROWS_PER_GROUP = 1 << 16
#: The version of the format, and the name of the file with the columns for a page.
_FORMAT, _COLUMNS = _core.corpus_format()
#: The content of the last build, with the sizes of its files.
_DONE = "done.json"


class Gathered:
    """All files of a corpus, with their records."""

    def __init__(
        self,
        store: Store,
        found: Mapping[str, list[Source]],
        failures: Mapping[str, bytes],
        clean: bool,
        labels: Mapping[str, list[str]],
    ) -> None:
        self._store, self._failures, self._clean = store, failures, clean
        # Sorted: files of the same content come in the order in which they were read.
        self._sources = {key: sorted(sources) for key, sources in sorted(found.items())}
        self._labels = labels

    def write(self) -> tuple[dict[str, int], bool]:
        """Write the corpus, unless it is there already. Return its numbers, and whether it was
        written."""
        content, done = self._content(), self._store.work / _DONE
        last = _read_json(done)
        if last.get("content") == content and self._is_complete(last.get("sizes", {})):
            return last["counts"], False
        done.unlink(missing_ok=True)
        made = self._gather()
        self._write_files(made)
        manifest = json.loads(made["manifest"])
        counts = {
            name: manifest["counts"][name]
            for name in ("rows", "clips", "unplaced", "unreadable", "copies")
        }
        sizes = {name: (self._store.out / name).stat().st_size for name in self._names(made)}
        text = json.dumps({"content": content, "counts": counts, "sizes": sizes})
        write_whole(done, [text.encode()])
        return counts, True

    def _content(self) -> str:
        """Return a hash of all that the files of the corpus depend on."""
        pyarrow = needed("pyarrow")
        digest = hashlib.sha256()
        paths = {key: [own.path for own in sources] for key, sources in self._sources.items()}
        failed = {key: hashlib.sha256(own).hexdigest() for key, own in self._failures.items()}
        made_by = [_core.__version__, _FORMAT, pyarrow.__version__]
        about = [made_by, self._clean, paths, failed, self._labels]
        digest.update(json.dumps(about, sort_keys=True).encode())
        return digest.hexdigest()

    def _is_complete(self, sizes: Mapping[str, int]) -> bool:
        def is_there(name: str, size: int) -> bool:
            path = self._store.out / name
            return path.is_file() and path.stat().st_size == size

        return bool(sizes) and all(is_there(name, size) for name, size in sizes.items())

    def _gather(self) -> dict[str, Any]:
        gatherer = _core.CorpusGatherer(self._clean)
        for key, sources in self._sources.items():
            if key in self._failures:
                gatherer.add(key, self._failures[key])
                continue
            try:
                gatherer.add(key, self._store.record(key))
            except (OSError, ValueError):
                # A crash of the machine has damaged it.
                record = make(sources[:1], self._clean, frozenset())[0].record or b""
                self._store.put(key, record)
                gatherer.add(key, record)
        made = gatherer.finish()
        made["columns"] = gatherer.columns(
            [(self._paths(row)[0], self._name(row), self._labels_of(row)) for row in made["rows"]]
        )
        return made

    def _write_files(self, made: dict[str, Any]) -> None:
        out = self._store.out
        (out / "index").mkdir(exist_ok=True)
        for number, shard in enumerate(made["poses"]):
            write_whole(out / _poses(number), self._pieces(shard, 0))
        for number, shard in enumerate(made["thumbnails"]):
            write_whole(out / _thumbnails(number), self._pieces(shard, 1))
        write_whole(out / "index" / "centroids.bin", [made["centroids"]])
        for number, content in enumerate(made["lists"]):
            write_whole(out / _lists(number), [content])
        write_whole(out / _COLUMNS, [made["columns"]])
        self._write_table(made["rows"])
        # Last: a corpus that has it is complete.
        write_whole(out / "corpus.json", [made["manifest"].encode()])
        names = set(self._names(made))
        for path in [*out.glob("*.bin"), *out.glob("index/*.bin")]:
            if path.relative_to(out).as_posix() not in names:
                path.unlink()

    def _pieces(self, shard: Iterable[tuple[str, int]], part: int) -> Iterator[bytes]:
        """Return the bytes of a shard: the clips of a record lie beside each other."""
        known: tuple[str, list[tuple[bytes, bytes]]] = ("", [])
        for key, clip in shard:
            if known[0] != key:
                known = (key, self._store.parts(key))
            yield known[1][clip][part]

    def _names(self, made: dict[str, Any]) -> list[str]:
        names = ["corpus.json", "clips.parquet", _COLUMNS, "index/centroids.bin"]
        for part, name in [("poses", _poses), ("thumbnails", _thumbnails), ("lists", _lists)]:
            names.extend(name(number) for number in range(len(made[part])))
        return names

    def _write_table(self, rows: list[dict[str, Any]]) -> None:
        pyarrow, parquet = needed("pyarrow"), needed("pyarrow.parquet")
        columns = self._columns(pyarrow, rows)
        schema = pyarrow.schema([(name, kind) for name, kind, _ in columns])
        arrays = [pyarrow.array([of(row) for row in rows], kind) for _, kind, of in columns]
        table = pyarrow.Table.from_arrays(arrays, schema=schema)
        path = self._store.out / "clips.parquet"
        part = path.with_name(path.name + ".part")
        parquet.write_table(table, part, row_group_size=_ROWS_PER_GROUP, compression="snappy")
        part.replace(path)

    def _columns(self, arrow: Any, rows: list[dict[str, Any]]) -> list[Column]:
        """Return the columns of the table: name, type, and the value of a row."""
        text, number, count = arrow.string(), arrow.float32(), arrow.int32()
        texts, wide = arrow.list_(text), arrow.int64()
        columns: list[Column] = [
            ("id", text, lambda row: row["id"]),
            ("path", text, lambda row: self._paths(row)[0]),
            ("also", texts, lambda row: self._paths(row)[1:]),
            ("name", text, self._name),
            ("labels", texts, self._labels_of),
        ]
        for names, kind in [
            ("status message", text),
            ("line column", count),
            ("format", text),
            ("seconds", arrow.float64()),
            ("frames", count),
            ("fps", number),
            ("joints", count),
            ("rig", text),
            ("body_parts", count),
            ("height_m", number),
            ("mended", count),
            ("warnings", texts),
            ("moments", count),
            ("map_x map_y", number),
            ("copy_of", text),
            ("is_mirrored", arrow.bool_()),
        ]:
            columns.extend((name, kind, itemgetter(name)) for name in names.split())
        for part, prefix in [("poses", ""), ("thumbnail", "thumbnail_")]:
            kinds = [("shard", count), ("offset", wide), ("length", count)]
            for at, (name, kind) in enumerate(kinds):
                columns.append((prefix + name, kind, _place(part, at)))
        found = {name for row in rows for name in row["metrics"]}
        known = [row[0] for row in _core.corpus_columns() if row[0] in found]
        columns.extend((name, number, _metric(name)) for name in known)
        return columns

    def _paths(self, row: dict[str, Any]) -> list[str]:
        """Return all paths of a row's file, with the path in it where it is an archive."""
        inner = f"/{row['inner']}" if row["inner"] else ""
        return [own.path + inner for own in self._sources[row["key"]]]

    def _name(self, row: dict[str, Any]) -> str:
        """Return the clip's own name, otherwise that of its file."""
        name = posixpath.basename(self._paths(row)[0])
        if name.lower().endswith(".gz"):
            name = name[:-3]
        return row["name"] or posixpath.splitext(name)[0]

    def _labels_of(self, row: dict[str, Any]) -> list[str]:
        labels = [own for path in self._paths(row) for own in self._labels.get(path, [])]
        return list(dict.fromkeys(labels))


def _place(part: str, at: int) -> Callable[[dict[str, Any]], Any]:
    return lambda row: row[part] and row[part][at]


def _metric(name: str) -> Callable[[dict[str, Any]], Any]:
    return lambda row: row["metrics"].get(name)


def _poses(number: int) -> str:
    return f"poses-{number:05}.bin"


def _thumbnails(number: int) -> str:
    return f"thumbnails-{number:05}.bin"


def _lists(number: int) -> str:
    return f"index/lists-{number:05}.bin"


def _read_json(path: Path) -> dict[str, Any]:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError):
        return {}
