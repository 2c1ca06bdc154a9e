"""The files of a corpus: where they are, and their bytes."""

from __future__ import annotations

import fnmatch
import io
import os
import posixpath
import zipfile
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from .. import _core
from ._needs import needed

MOTION_ENDINGS, _ARCHIVE_ENDINGS, MAX_BYTES = _core.corpus_endings()


class Source(NamedTuple):
    """A file of a corpus.

    Attributes
    ----------
    path : str
        The path below the input, with ``/`` between folders: that of the table.
    place : str
        The path or address by which it is opened; that of the zip for a member of one.
    member : str
        The path in the zip; empty for a file that is none's.
    beside : tuple of (str, str, str)
        Name, place and member of the skeletons in the same folder.
    """

    path: str
    place: str
    member: str = ""
    beside: tuple[tuple[str, str, str], ...] = ()


def find(inputs: Iterable[str]) -> list[Source]:
    """Return the motion files of files, folders, zips, patterns and addresses, sorted by path.

    Raises
    ------
    FileNotFoundError
        An input leads to no file.
    """
    found: list[Source] = []
    for word in inputs:
        before = len(found)
        for name, place, is_named in _listed(word):
            found.extend(_of_file(name, place, is_named))
        if len(found) == before:
            raise FileNotFoundError(f"there is no motion file in {word}")
    return sorted(set(_with_skeletons(found)))


def read(place: str, member: str = "") -> bytes:
    """Return the bytes of a file.

    Raises
    ------
    OSError, zipfile.BadZipFile
        They cannot be had.
    ValueError
        There are too many.
    """
    if member:
        archive = _opened_zip(place)
        _check_size(archive.getinfo(member).file_size)
        return archive.read(member)
    system, path = _system(place)
    if system is None:
        _check_size(os.stat(path).st_size)
        with open(path, "rb") as file:
            return file.read()
    with system.open_input_file(path) as file:
        _check_size(file.size())
        return file.read()


def _check_size(size: int) -> None:
    if size > MAX_BYTES:
        raise ValueError(f"it has {size >> 20} MB; files of up to {MAX_BYTES >> 20} MB are read")


def _ending(name: str) -> str:
    return name.rsplit(".", 1)[-1].lower() if "." in name else ""


def _is_motion(name: str) -> bool:
    own = name[:-3] if _ending(name) == "gz" else name
    return _ending(own) in MOTION_ENDINGS


def _of_file(name: str, place: str, is_named: bool) -> Iterator[Source]:
    """Return a file, or the members of a zip."""
    if _ending(name) == "zip":
        try:
            members = _opened_zip(place).namelist()
        except (OSError, zipfile.BadZipFile):
            # Becomes a row that says why.
            yield Source(name, place)
            return
        # The buffers of a glTF are beside it: such a zip is read as a whole.
        if any(_ending(member) == "gltf" for member in members):
            yield Source(name, place)
            return
        for member in members:
            if _is_motion(member) or _ending(member) == "zip":
                yield Source(f"{name}/{member}", place, member)
    elif is_named or _is_motion(name):
        yield Source(name, place)


def _with_skeletons(sources: list[Source]) -> Iterator[Source]:
    """Return the sources, those of AMC files with the ASF files of their folders."""
    skeletons: dict[tuple[str, str], list[tuple[str, str, str]]] = {}
    for own in sources:
        if _ending(own.path) == "asf":
            name = posixpath.basename(own.path)
            skeletons.setdefault(_folder(own), []).append((name, own.place, own.member))
    for own in sources:
        if _ending(own.path) != "amc":
            yield own
            continue
        beside = skeletons.get(_folder(own))
        if beside is None and not own.member:
            beside = _skeletons_near(own.place)
        yield Source(own.path, own.place, own.member, tuple(sorted(set(beside or []))))


def _folder(own: Source) -> tuple[str, str]:
    if own.member:
        return own.place, posixpath.dirname(own.member)
    return posixpath.dirname(own.place.replace(os.sep, "/")), ""


def _skeletons_near(place: str) -> list[tuple[str, str, str]]:
    """Return the ASF files of a file's folder, where the file was named alone."""
    system, path = _system(place)
    if system is not None:
        return []
    folder = os.path.dirname(path) or "."
    names = [name for name in os.listdir(folder) if _ending(name) == "asf"]
    return [(name, os.path.join(os.path.dirname(path), name), "") for name in names]


def _listed(word: str) -> Iterator[tuple[str, str, bool]]:
    """Return the files that an input names: path in the table, place, and whether it was named."""
    system, path = _system(word)
    if system is not None:
        yield from _listed_remotely(word, system, path)
    elif os.path.isdir(path):
        for folder, folders, names in os.walk(path):
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            for name in sorted(names):
                place = os.path.join(folder, name)
                if not name.startswith("."):
                    yield os.path.relpath(place, path).replace(os.sep, "/"), place, False
    elif os.path.exists(path):
        yield os.path.basename(path), path, True
    else:
        yield from _matching(path)


def _matching(pattern: str) -> Iterator[tuple[str, str, bool]]:
    import glob

    base = _base_of(pattern)
    for place in sorted(glob.glob(pattern, recursive=True)):
        if os.path.isfile(place):
            yield os.path.relpath(place, base or ".").replace(os.sep, "/"), place, False


def _base_of(pattern: str) -> str:
    """Return the folder in front of the first sign of a pattern."""
    signs = [pattern.find(sign) for sign in "*?[" if sign in pattern]
    return os.path.dirname(pattern[: min(signs)] if signs else pattern)


def _system(place: str) -> tuple[Any, str]:
    """Return the file system of an address and the path in it; no system for a local path."""
    if "://" not in place:
        return None, place
    scheme, rest = place.split("://", 1)
    if scheme == "file":
        return None, rest
    return _remote(scheme, place)


#: The file systems of addresses.
_SYSTEMS: dict[str, Any] = {}


def _remote_system(scheme: str, root: str) -> Any:
    """Return the file system of an address."""
    fs = needed("pyarrow.fs")
    if scheme in ("s3", "gs", "gcs", "hdfs", "abfs", "abfss", "mock"):
        return fs.FileSystem.from_uri(root)[0]
    # Those of fsspec, such as `hf://` of huggingface_hub.
    fsspec = needed("fsspec")
    return fs.PyFileSystem(fs.FSSpecHandler(fsspec.filesystem(scheme)))


def _remote(scheme: str, place: str) -> tuple[Any, str]:
    address, _, options = place.partition("?")
    rest = address.split("://", 1)[1]
    root = f"{scheme}://{rest.split('/', 1)[0]}" + (f"?{options}" if options else "")
    if root not in _SYSTEMS:
        _SYSTEMS[root] = _remote_system(scheme, root)
    return _SYSTEMS[root], rest


def _listed_remotely(word: str, system: Any, path: str) -> Iterator[tuple[str, str, bool]]:
    fs = needed("pyarrow.fs")
    scheme, options = word.split("://", 1)[0], word.partition("?")[2]
    is_pattern = any(sign in path for sign in "*[")
    base = _base_of(path) if is_pattern else path.rstrip("/")

    def place(own: str) -> str:
        return f"{scheme}://{own}" + (f"?{options}" if options else "")

    if not is_pattern and system.get_file_info(base).type == fs.FileType.File:
        yield posixpath.basename(base), place(base), True
        return
    listed = system.get_file_info(fs.FileSelector(base, recursive=True, allow_not_found=True))
    for own in sorted(info.path for info in listed if info.type == fs.FileType.File):
        name = posixpath.relpath(own, base)
        is_hidden = any(part.startswith(".") for part in name.split("/"))
        # `**/` also stands for no folder at all.
        patterns = (path, path.replace("**/", ""))
        if not is_hidden and (
            not is_pattern or any(fnmatch.fnmatchcase(own, each) for each in patterns)
        ):
            yield name, place(own), False


#: Zips that are open, by place, size and time of their last change.
_ZIPS: dict[tuple[Any, ...], zipfile.ZipFile] = {}
_MAX_ZIPS = 16


def _opened_zip(place: str) -> zipfile.ZipFile:
    """Return a zip that is open; it is read by several threads."""
    system, path = _system(place)
    about = os.stat(path) if system is None else None
    key = (place, about and about.st_size, about and about.st_mtime_ns)
    found = _ZIPS.get(key)
    if found is None:
        if system is None:
            found = zipfile.ZipFile(path)
        else:
            file: Any = io.BufferedReader(system.open_input_file(path))
            found = zipfile.ZipFile(file)
        if len(_ZIPS) >= _MAX_ZIPS:
            # A thread that still reads one of them holds it open.
            _ZIPS.clear()
        _ZIPS[key] = found
    return found
