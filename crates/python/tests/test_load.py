"""Reading of files: errors with their place, lists, folders, and the interpreter's lock."""

import gzip
import hashlib
import os
import pickle
import signal
import threading
import time
import zipfile

import pytest
import segue


def broken(text):
    """Return a BVH file with a word in place of the first number of its frames."""
    head, rows = text.split("Frame Time:")
    first, rest = rows.split("\n", 1)
    return f"{head}Frame Time:{first}\nx{rest}"


@pytest.fixture(scope="module")
def walk_text(files):
    return (files / "walk.bvh").read_text()


@pytest.fixture(scope="module")
def large(tmp_path_factory, walk_text):
    """Return a file of 2 MB, which all cores read."""
    head, motion = walk_text.split("MOTION\n")
    _, spacing, *rows = motion.splitlines()
    rows *= 2_000_000 // len(walk_text) + 1
    path = tmp_path_factory.mktemp("large") / "large.bvh"
    path.write_text("\n".join([f"{head}MOTION", f"Frames: {len(rows)}", spacing, *rows, ""]))
    return path


def test_error_names_file_line_and_column(tmp_path, walk_text):
    path = tmp_path / "走路.bvh"
    path.write_text(walk_text.replace("OFFSET", "OFSET", 1))
    with pytest.raises(segue.ReadError) as caught:
        segue.load(path)
    error = caught.value
    lines = walk_text.splitlines()
    line = next(at for at, own in enumerate(lines, 1) if "OFFSET" in own)
    assert (error.file, error.line) == ("走路.bvh", line)
    assert error.column == lines[line - 1].index("OFFSET") + 1
    assert (error.found, error.expected is None) == ("`OFSET`", False)
    assert str(error).startswith(f"走路.bvh:{line}:{error.column}: found `OFSET`, expected ")
    assert isinstance(error, ValueError) and isinstance(error, segue.SegueError)
    # It travels between processes.
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.line, again.hint) == (str(error), error.line, error.hint)


def test_broken_row_is_named_by_its_place(walk_text):
    text = broken(walk_text)
    line = next(at for at, own in enumerate(text.splitlines(), 1) if own.startswith("x"))
    with pytest.raises(segue.ReadError) as caught:
        segue.read_bytes(text.encode(), "walk.bvh")
    assert (caught.value.line, caught.value.column) == (line, 1)


def test_missing_file_is_the_error_of_python(tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        segue.load(tmp_path / "none.bvh")
    assert caught.value.filename == str(tmp_path / "none.bvh")
    with pytest.raises(IsADirectoryError):
        segue.load(tmp_path)


def test_list_keeps_its_order_and_loses_nothing(tmp_path, files, walk_text):
    (tmp_path / "bad.bvh").write_text("HIERARCHY\nROOT")
    paths = [files / "walk.bvh", tmp_path / "bad.bvh", files / "run.bvh", tmp_path / "none.bvh"] * 4
    found = segue.load(paths, errors="return")
    assert len(found) == 16
    for at in range(0, 16, 4):
        assert [own.name for own in (found[at], found[at + 2])] == ["walk", "run"]
        assert isinstance(found[at + 1], segue.ReadError)
        assert isinstance(found[at + 3], FileNotFoundError)
    with pytest.raises(segue.ReadErrors) as caught:
        segue.load(paths)
    assert len(caught.value.exceptions) == 8 and len(caught.value.results) == 16
    assert caught.value.results[2].name == "run"
    # By kind, as any group of exceptions.
    kept, rest = caught.value.split(segue.ReadError)
    assert (len(kept.exceptions), len(rest.exceptions)) == (4, 4)
    assert segue.load([]) == []
    with pytest.raises(ValueError, match="errors"):
        segue.load(paths, errors="ignore")


def test_folder_and_archive_give_all_clips(tmp_path, files, walk_text):
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "walk.bvh").write_text(walk_text)
    (tmp_path / "notes.txt").write_text("no motion")
    with zipfile.ZipFile(tmp_path / "set.zip", "w") as archive:
        archive.write(files / "run.bvh", "in/run.bvh")
        archive.write(files / "walk.bvh", "in/walk.bvh")
    (tmp_path / "a.bvh.gz").write_bytes(gzip.compress(walk_text.encode()))
    found = segue.load_all(tmp_path)
    assert [clip.name for clip in found] == ["a", "walk", "run", "walk"]
    assert [clip.name for clip in segue.load_all(str(tmp_path / "b" / "*.bvh"))] == ["walk"]
    with pytest.raises(FileNotFoundError, match="no file matches"):
        segue.load_all(str(tmp_path / "*.fbx"))
    with pytest.raises(segue.ReadError, match="2 clips .run, walk.: name one by clip="):
        segue.load(tmp_path / "set.zip")
    assert segue.load(tmp_path / "set.zip", clip="walk").name == "walk"
    assert segue.load(tmp_path / "set.zip", clip=0).name == "run"
    with pytest.raises(segue.ReadError, match="no clip 'jump'"):
        segue.load(tmp_path / "set.zip", clip="jump")


def test_options_override_the_file(files):
    path = files / "walk.bvh"
    found = segue.load(path)
    assert (found.unit, found.up) == ("cm", "y")
    assert segue.load(path, unit="m").body_height == pytest.approx(100 * found.body_height)
    assert segue.load(path, unit=0.02).body_height == pytest.approx(2 * found.body_height)
    assert segue.load(path, fps=30).fps == 30
    for wrong in ({"unit": "km"}, {"up": "x"}, {"fps": 0}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            segue.load(path, **wrong)


def test_asf_beside_an_amc_is_found(tmp_path):
    asf = """:version 1.10
:units
  mass 1
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name chest
    direction 0 1 0
    length 10
    axis 0 0 0 XYZ
    dof rx ry rz
  end
:hierarchy
  begin
    root chest
  end
"""
    amc = ":FULLY-SPECIFIED\n:DEGREES\n" + "".join(
        f"{frame}\nroot 0 17 0 0 0 0\nchest {frame} 0 0\n" for frame in range(1, 11)
    )
    (tmp_path / "01.asf").write_text(asf)
    (tmp_path / "01_01.amc").write_text(amc)
    clip = segue.load(tmp_path / "01_01.amc")
    assert len(clip) == 10 and "chest" in clip.names
    (tmp_path / "01.asf").rename(tmp_path / "01.txt")
    with pytest.raises(segue.ReadError, match="skeleton"):
        segue.load(tmp_path / "01_01.amc")
    assert len(segue.load(tmp_path / "01_01.amc", skeleton=tmp_path / "01.txt")) == 10


def test_other_threads_run_meanwhile(walk):
    clips = [walk] * 32
    done = threading.Event()

    def work():
        segue.distance_matrix(clips, window=30)
        done.set()

    thread = threading.Thread(target=work)
    start, ticks = time.perf_counter(), 0
    thread.start()
    while not done.is_set():
        time.sleep(0.001)
        ticks += 1
    thread.join()
    took = time.perf_counter() - start
    # With the lock held there would be one tick, at the end.
    assert took > 0.01 and ticks > 5, (took, ticks)


def test_id_of_a_large_file_is_its_sha256(tmp_path, large):
    data = large.read_bytes()
    digest = hashlib.sha256(data).hexdigest()
    path = tmp_path / "large.bvh"
    path.write_bytes(data)
    alone, (listed,) = segue.load(path), segue.load([path])
    # It is that of what was read, whatever becomes of the file.
    path.write_text("something else")
    path.unlink()
    in_memory = segue.read_bytes(data, "large.bvh")
    for clip in (alone, listed, in_memory):
        name, _, start = clip.id.partition("~")
        assert name == "large" and len(start) >= 8 and digest.startswith(start)
        assert segue.link(clip) == segue.link(in_memory)
        assert (clip.rotations.tobytes(), clip.fps) == (in_memory.rotations.tobytes(), in_memory.fps)


def test_large_file_with_an_error_names_its_place(tmp_path, large):
    lines = large.read_text().splitlines(keepends=True)
    at = len(lines) - 100
    lines[at] = "x" + lines[at]
    path = tmp_path / "bad.bvh"
    path.write_text("".join(lines))
    with pytest.raises(segue.ReadError) as caught:
        segue.load(path)
    assert (caught.value.line, caught.value.column) == (at + 1, 1)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_forked_process_reads_and_computes(large):
    clip = segue.load(large)
    positions = clip.global_positions()
    child = os.fork()
    if child == 0:
        # Fails by waiting for threads that it does not have.
        signal.alarm(60)
        again = segue.load(large)
        same = again.global_positions().tobytes() == positions.tobytes()
        os._exit(0 if same and again.id == clip.id and len(segue.load([large] * 4)) == 4 else 1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0
