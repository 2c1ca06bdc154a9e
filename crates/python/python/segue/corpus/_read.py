"""Reading of corpora on this machine."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import _core
from .._core import Clip
from ._needs import needed


class Like(NamedTuple):
    """A moment that is like another one.

    Attributes
    ----------
    row : int
        The clip's row in the table.
    seconds : float
        The time in the clip.
    distance : float
        The distance of the features: the square root of the cost of motion matching.
    """

    row: int
    seconds: float
    distance: float


class Corpus:
    """A corpus that was built by `build`.

    Parameters
    ----------
    folder : path
        Its folder.

    Raises
    ------
    ValueError
        It was built by an older Segue, or by a newer one.

    Attributes
    ----------
    manifest : dict
        The content of ``corpus.json``.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        self.manifest: dict[str, Any] = json.loads((self.folder / "corpus.json").read_text())
        found, known = self.manifest["format"], _core.corpus_format()[0]
        if found < known:
            raise ValueError("this corpus was built by an older Segue: build it again")
        if found > known:
            raise ValueError("this corpus was built by a newer Segue: update this one")
        self._index = _core.CorpusIndex((self.folder / "index" / "centroids.bin").read_bytes())

    def table(self, columns: list[str] | None = None) -> Any:
        """Return the table of clips, or some of its columns.

        Parameters
        ----------
        columns : list of str, optional
            The names of columns; all where they are not given.

        Returns
        -------
        pyarrow.Table
        """
        parquet = needed("pyarrow.parquet")
        return parquet.read_table(self.folder / "clips.parquet", columns=columns)

    def clip(self, row: int) -> Clip:
        """Return the clip of a row, on the standard body.

        Parameters
        ----------
        row : int
            Its row in the table.

        Returns
        -------
        Clip

        Raises
        ------
        ValueError
            The row has no poses: its ``message`` says why.
        """
        name, data = self._bytes(row, "")
        return _core.corpus_clip(name, data)

    def thumbnail(self, row: int) -> bytes:
        """Return the thumbnail of a row, a PNG.

        Parameters
        ----------
        row : int
            Its row in the table.

        Returns
        -------
        bytes
        """
        return self._bytes(row, "thumbnail_")[1]

    def like(
        self,
        clip: Clip,
        seconds: float,
        *,
        count: int = 10,
        probes: int | None = None,
        by_clip: bool = True,
    ) -> list[Like]:
        """Return the moments that are most like a moment of a clip, the nearest first.

        Parameters
        ----------
        clip : Clip
            Any clip, on any body. It lasts longer than a second.
        seconds : float
            The time in the clip.
        count : int
            How many are found at most.
        probes : int, optional
            How many lists are searched: more take longer and find more. That of the corpus where
            it is not given.
        by_clip : bool
            Whether the nearest moment of each clip is found, rather than all.

        Returns
        -------
        list of Like
        """
        scaling = self.manifest["features"]["scaling"]
        query = _core.corpus_query(clip, seconds, scaling["means"], scaling["factors"])
        if query is None:
            raise ValueError("the clip is too short: the features of a moment look 1 s ahead")
        row = np.asarray(query, np.float32)
        lists = []
        for own, file, offset, length in self._index.nearest_lists(
            row, probes or self.manifest["index"]["probes"]
        ):
            with open(self.folder / "index" / f"lists-{file:05}.bin", "rb") as shard:
                shard.seek(offset)
                lists.append((own, shard.read(length)))
        frames, fps = self.manifest["features"]["frames_per_row"], self.manifest["poses"]["fps"]
        hits = self._index.search(row, lists, count, by_clip)
        return [Like(own, moment * frames / fps, distance) for own, moment, distance in hits]

    def _bytes(self, row: int, prefix: str) -> tuple[str, bytes]:
        columns = [prefix + name for name in ("shard", "offset", "length")]
        found = self.table(["name", *columns]).slice(row, 1).to_pylist()
        if not found:
            raise IndexError(f"the table has no row {row}")
        shard, offset, length = (found[0][name] for name in columns)
        if shard is None:
            raise ValueError(f"row {row} is no clip of the corpus: its message says why")
        kind = "thumbnails" if prefix else "poses"
        with open(self.folder / f"{kind}-{shard:05}.bin", "rb") as file:
            file.seek(offset)
            return found[0]["name"], file.read(length)
