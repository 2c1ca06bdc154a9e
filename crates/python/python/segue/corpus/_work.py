"""The work on files, by threads of this process or by tasks of Ray."""

from __future__ import annotations

import concurrent.futures
import os
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from .. import _core
from ._needs import needed
from ._sources import Source, read


class Made(NamedTuple):
    """What became of a file: its key, and its record unless that was known. No key for a file
    whose bytes cannot be had: it is tried again the next time."""

    source: Source
    key: str | None
    record: bytes | None


def make(sources: Sequence[Source], clean: bool, known: frozenset[str]) -> list[Made]:
    """Return the records of some files: a pure function of their bytes."""
    return [_make_one(own, clean, known) for own in sources]


def _make_one(source: Source, clean: bool, known: frozenset[str]) -> Made:
    try:
        data = read(source.place, source.member)
        beside = [(name, read(place, member)) for name, place, member in source.beside]
    except Exception as error:  # noqa: BLE001
        # A failure of a disk, a zip or a network becomes a row; the build goes on.
        return Made(source, None, _core.corpus_failure(_reason(error)))
    name = source.member or source.path
    key = _core.corpus_key(name, data, beside, clean)
    if key in known:
        return Made(source, key, None)
    return Made(source, key, _core.corpus_record(name, data, beside, clean))


def _reason(error: BaseException) -> str:
    """Return an error without the place of the file, which depends on the machine."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return f"its bytes cannot be had: {text}"


class Threads:
    """Threads: the core works without the interpreter's lock."""

    files_per_task = 4

    def __init__(self, workers: int | None, clean: bool, known: frozenset[str]) -> None:
        self.workers = workers or os.cpu_count() or 1
        self._arguments = (clean, known)
        self._pool = concurrent.futures.ThreadPoolExecutor(self.workers)

    def submit(self, sources: Sequence[Source]) -> Any:
        return self._pool.submit(make, sources, *self._arguments)

    def finished(self, tasks: list[Any]) -> list[Any]:
        """Wait for one of the tasks at least; return all that are done."""
        return list(concurrent.futures.wait(tasks, return_when="FIRST_COMPLETED").done)

    def result(self, task: Any) -> list[Made]:
        return task.result()

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)


class RayTasks:
    """Tasks of Ray, on this machine or on a cluster."""

    files_per_task = 16

    def __init__(
        self, address: str | None, workers: int | None, clean: bool, known: frozenset[str]
    ) -> None:
        ray = self._ray = needed("ray")
        self._is_own = not ray.is_initialized()
        if self._is_own:
            here: dict[str, Any] = {"address": address} if address else {"num_cpus": workers}
            ray.init(include_dashboard=False, log_to_driver=False, **here)
        self.workers = workers or int(ray.cluster_resources().get("CPU", 1))
        self._make = ray.remote(num_cpus=1)(make)
        self._clean, self._known = clean, ray.put(known)

    def submit(self, sources: Sequence[Source]) -> Any:
        return self._make.remote(list(sources), self._clean, self._known)

    def finished(self, tasks: list[Any]) -> list[Any]:
        return self._ray.wait(tasks, num_returns=1)[0]

    def result(self, task: Any) -> list[Made]:
        return self._ray.get(task)

    def close(self) -> None:
        if self._is_own:
            self._ray.shutdown()


def made_by(workers: Any, sources: Sequence[Source]) -> Iterator[list[Made]]:
    """Return what becomes of the files, in the order in which it is done."""
    size = workers.files_per_task
    parts = iter([sources[at : at + size] for at in range(0, len(sources), size)])
    waiting: dict[Any, Sequence[Source]] = {}
    # A few tasks ahead keep all workers busy, and few results are in memory.
    ahead = 3 * workers.workers
    while True:
        while len(waiting) < ahead and (part := next(parts, None)) is not None:
            waiting[workers.submit(part)] = part
        if not waiting:
            return
        for task in workers.finished(list(waiting)):
            part = waiting.pop(task)
            try:
                yield workers.result(task)
            except Exception as error:  # noqa: BLE001
                # A worker that has died: its files are rows, and are tried again the next time.
                reason = f"its worker has stopped: {type(error).__name__}"
                yield [Made(own, None, _core.corpus_failure(reason)) for own in part]
