"""Reading of files."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, overload

from . import _core
from ._core import Clip
from ._errors import ReadError, ReadErrors

Path = str | os.PathLike[str]


@overload
def load(  # type: ignore[overload-overlap]
    path: Path,
    *,
    clip: int | str | None = None,
    unit: str | float | None = None,
    up: str | None = None,
    fps: float | None = None,
    skeleton: Path | Iterable[Path] | None = None,
    errors: str = "raise",
) -> Clip: ...
@overload
def load(
    path: Iterable[Path],
    *,
    clip: int | str | None = None,
    unit: str | float | None = None,
    up: str | None = None,
    fps: float | None = None,
    skeleton: Path | Iterable[Path] | None = None,
    errors: str = "raise",
) -> list[Clip]: ...
def load(
    path: Any,
    *,
    clip: int | str | None = None,
    unit: str | float | None = None,
    up: str | None = None,
    fps: float | None = None,
    skeleton: Path | Iterable[Path] | None = None,
    errors: str = "raise",
) -> Any:
    """Read motion files: one as a clip, a list of them as a list, on all cores.

    The format is found by the content: BVH, FBX, glTF, GLB, VRM, VRMA, ASF with AMC, C3D, TRC,
    NPZ and NPY (AMASS, SMPL, HumanML3D, Kimodo and Segue's own), the table of a Unitree G1, and
    gzip or zip with one of them. Unit and up axis are found by the body: clips are in metres,
    with Y up.

    Parameters
    ----------
    path : path or sequence of paths
        The file or files.
    clip : int or str, optional
        Which clip of a file that has several: its index, or its name.
    unit : {"mm", "cm", "m", "in", "ft"} or float, optional
        The unit of length in the files, or metres per unit. Found where it is not given.
    up : {"y", "z"}, optional
        The up axis in the files. Found where it is not given.
    fps : float, optional
        Frames per second, in place of those of the file.
    skeleton : path or sequence of paths, optional
        The skeletons of AMC files (.asf), or your SMPL model for NPZ files. An ASF file in the
        folder of an AMC file is found by itself.
    errors : {"raise", "return"}
        What becomes of files of a list that cannot be read. Every file is tried in any case.
        "raise" raises one `ReadErrors` at the end, whose `results` has all that was read;
        "return" puts the exception into the list, in the place of its clip.

    Returns
    -------
    Clip or list of Clip
        The clips of a list are in the order of the list.

    Raises
    ------
    ReadError
        The file cannot be read; with `file`, `line` and `column`.
    OSError
        There is no such file, or the system does not give it.

    Examples
    --------
    >>> import segue
    >>> walk = segue.load("walk.bvh")
    >>> walk.global_positions().shape
    (181, 24, 3)
    """
    if errors not in ("raise", "return"):
        raise ValueError(f"errors: found {errors!r}, expected 'raise' or 'return'")
    is_one = isinstance(path, (str, bytes, os.PathLike))
    paths = [path] if is_one else list(path)
    found = _each(paths, unit, up, fps, skeleton)
    results = [_one_of(clips, source, clip) for clips, source in zip(found, paths)]
    if is_one:
        if isinstance(results[0], Exception):
            raise results[0]
        return results[0]
    return _settled(results, errors)


def load_all(
    paths: Path | Iterable[Path],
    *,
    unit: str | float | None = None,
    up: str | None = None,
    fps: float | None = None,
    skeleton: Path | Iterable[Path] | None = None,
    errors: str = "raise",
) -> list[Any]:
    """Read all clips of files, folders, archives and patterns, on all cores.

    Parameters
    ----------
    paths : path or sequence of paths
        Files with all their clips, folders with all motion files below them, zips, and patterns
        such as ``"takes/**/*.bvh"``.
    unit, up, fps, skeleton
        As in `load`.
    errors : {"raise", "return"}
        As in `load`.

    Returns
    -------
    list of Clip
        In the order of the paths; those of a folder sorted by path.
    """
    if errors not in ("raise", "return"):
        raise ValueError(f"errors: found {errors!r}, expected 'raise' or 'return'")
    words: Any = [paths] if isinstance(paths, (str, bytes, os.PathLike)) else paths
    files = _core.find_files([os.fspath(own) for own in words])
    found = _each(files, unit, up, fps, skeleton)
    results = [own for clips in found for own in ([clips] if isinstance(clips, Exception) else clips)]
    return _settled(results, errors)


def read_bytes(
    data: bytes,
    name: str = "clip.bvh",
    *,
    clip: int | str | None = None,
    unit: str | float | None = None,
    up: str | None = None,
    fps: float | None = None,
) -> Clip:
    """Read a motion file that is in memory.

    Parameters
    ----------
    data : bytes
        The content of the file.
    name : str
        The file's name: for messages, and for its ending where the content is not conclusive.
    clip, unit, up, fps
        As in `load`.

    Returns
    -------
    Clip
    """
    made = _one_of(_core.read_bytes(data, name, unit=unit, up=up, fps=fps), name, clip)
    if isinstance(made, Exception):
        raise made
    return made


def _each(paths: list[Any], unit: Any, up: Any, fps: Any, skeleton: Any) -> list[Any]:
    skeletons = skeleton if skeleton is not None else []
    if isinstance(skeletons, (str, bytes, os.PathLike)):
        skeletons = [skeletons]
    return _core.load_each(list(paths), unit=unit, up=up, fps=fps, skeletons=list(skeletons))


def _one_of(clips: Any, source: Any, wanted: int | str | None) -> Clip | Exception:
    """Return the clip of a file that is meant, or the exception."""
    if isinstance(clips, Exception):
        return clips
    names = [own.name for own in clips]
    if wanted is None and len(clips) == 1:
        return clips[0]
    if isinstance(wanted, str) and names.count(wanted) == 1:
        return clips[names.index(wanted)]
    if isinstance(wanted, int) and -len(clips) <= wanted < len(clips):
        return clips[wanted]
    name = os.path.basename(os.fsdecode(source))
    listed = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
    if wanted is None:
        what = f"it has {len(clips)} clips ({listed}): name one by clip=, or use segue.load_all"
    else:
        what = f"it has no clip {wanted!r}, only {listed}"
    return ReadError(f"{name}: {what}", name)


def _settled(results: list[Any], errors: str) -> list[Any]:
    failed = [result for result in results if isinstance(result, Exception)]
    if failed and errors == "raise":
        text = f"{len(failed)} of {len(results)} files could not be read"
        raise ReadErrors(text, failed, results)
    return results
