"""Building of corpora."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

from ._labels import Labels, read_labels
from ._needs import needed
from ._sources import Source, find
from ._store import Store
from ._work import RayTasks, Threads, made_by
from ._write import Gathered


class Report(NamedTuple):
    """What a build has done.

    Attributes
    ----------
    rows : int
        Rows of the table.
    clips : int
        Clips in the corpus.
    unplaced : int
        Clips that were read, and are not on the standard body.
    unreadable : int
        Files that cannot be read.
    copies : int
        Clips that are copies of others.
    made : int
        Files that were computed now; the others were known.
    is_written : bool
        Whether files of the corpus were written. `False` where nothing has changed.
    """

    rows: int
    clips: int
    unplaced: int
    unreadable: int
    copies: int
    made: int
    is_written: bool


def build(
    inputs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    workers: int | None = None,
    ray: bool | str | None = None,
    clean: bool = False,
    labels: Labels | None = None,
    resume: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> Report:
    """Build a corpus: read all motion files, and write a table, poses, thumbnails and an index.

    The result depends on the files and nothing else: not on their order, the number of workers, or
    how often the build was stopped and begun again. Every file is computed once; its record is
    kept in ``out/.work`` under a hash of its content. A file that cannot be read is a row that
    says why.

    Parameters
    ----------
    inputs : path or sequence of paths
        Files, folders with all below them, zips, patterns such as ``"takes/**/*.bvh"``, and
        addresses such as ``"s3://bucket/takes"`` or ``"hf://datasets/user/name"``. An AMC file is
        read with the ASF files of its folder.
    out : path
        The folder of the corpus.
    workers : int, optional
        How many files are read at the same time; as many as there are cores where it is not given.
    ray : bool or str, optional
        Whether tasks of Ray do the work: `True` on this machine, or the address of a cluster. Each
        node needs this package, and sees the inputs under the same paths.
    clean : bool
        Whether faults of takes are mended, as by `segue.clean`. The table has the artefacts of the
        takes as they were.
    labels : mapping or path, optional
        Labels of clips by their paths in the table: a mapping to a text or a list of texts, or a
        CSV file whose first column is the path and whose others are labels.
    resume : bool
        Whether records that are known are used.
    progress : callable, optional
        Called with the number of files that are done, and of all.

    Returns
    -------
    Report

    Raises
    ------
    FileNotFoundError
        An input leads to no motion file.
    ImportError
        pyarrow is missing, or Ray where it is asked for.

    Examples
    --------
    >>> import segue.corpus
    >>> segue.corpus.build("takes/", "corpus/", workers=2).clips
    2988
    """
    needed("pyarrow")
    is_one = isinstance(inputs, (str, os.PathLike))
    words: list[Any] = [inputs] if is_one else list(inputs)  # type: ignore[arg-type, list-item]
    sources = find(os.fspath(own) for own in words)
    store = Store(Path(out), resume)
    known = store.keys()
    pool: Any
    if ray:
        pool = RayTasks(ray if isinstance(ray, str) else None, workers, clean, known)
    else:
        pool = Threads(workers, clean, known)
    found: dict[str, list[Source]] = {}
    failures: dict[str, bytes] = {}
    computed: set[str] = set()
    done = 0
    with contextlib.closing(pool):
        for part in made_by(pool, sources):
            for source, key, record in part:
                if key is None:
                    key = hashlib.sha256(source.path.encode()).hexdigest()[:32]
                    failures[key] = record or b""
                elif record is not None:
                    store.put(key, record)
                    computed.add(key)
                found.setdefault(key, []).append(source)
            done += len(part)
            if progress is not None:
                progress(done, len(sources))
    corpus = Gathered(store, found, failures, clean, read_labels(labels))
    counts, is_written = corpus.write()
    return Report(**counts, made=len(computed), is_written=is_written)
