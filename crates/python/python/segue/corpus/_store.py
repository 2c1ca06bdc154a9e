"""The records of files, which outlive a build that is stopped."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from .. import _core

#: The ending of a file that is being written.
_PART = ".part"


def write_whole(path: Path, parts: Iterable[bytes]) -> None:
    """Write a file that is there as a whole or not at all."""
    part = path.with_name(path.name + _PART)
    with open(part, "wb") as file:
        file.writelines(parts)
    os.replace(part, path)


class Store:
    """The records in the folder of a corpus, by their keys."""

    def __init__(self, out: Path, resume: bool) -> None:
        self.out = out
        self.work = out / ".work"
        if not resume:
            shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir(parents=True, exist_ok=True)

    def keys(self) -> frozenset[str]:
        """Return the keys of all records. Parts that a killed build has left are removed."""
        found = []
        for folder in self.work.iterdir():
            if not folder.is_dir():
                continue
            for file in folder.iterdir():
                if file.name.endswith(_PART):
                    file.unlink(missing_ok=True)
                else:
                    found.append(file.name)
        return frozenset(found)

    def put(self, key: str, record: bytes) -> None:
        """Keep a record."""
        path = self._path(key)
        path.parent.mkdir(exist_ok=True)
        write_whole(path, [record])

    def record(self, key: str) -> bytes:
        """Return a record."""
        return self._path(key).read_bytes()

    def parts(self, key: str) -> list[tuple[bytes, bytes]]:
        """Return poses and thumbnail of every clip of a record."""
        return _core.corpus_parts(self.record(key))

    def _path(self, key: str) -> Path:
        return self.work / key[:2] / key
