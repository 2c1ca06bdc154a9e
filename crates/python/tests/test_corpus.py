"""Corpora: the same bytes whoever builds them, and what can be done with them."""

import json
import os
import signal
import subprocess
import sys
import time
import zipfile

import numpy as np
import pytest
import segue

pytest.importorskip("pyarrow")

from segue.corpus import Corpus, build  # noqa: E402
from segue.corpus._sources import find  # noqa: E402


@pytest.fixture(scope="module")
def takes(tmp_path_factory):
    """Return a folder of motion files: walks, copies, a zip, and files that are none."""
    folder = tmp_path_factory.mktemp("takes")
    (folder / "walks").mkdir()
    for number in range(6):
        walk = segue.synthesize(gait="walk", gait_speed=1.0 + 0.15 * number)
        walk.save(folder / "walks" / f"walk{number}.bvh")
    run = segue.synthesize(gait="run", gait_speed=3.0)
    run.save(folder / "run.bvh")
    run.save(folder / "the same run.glb")
    (folder / "again.bvh").write_bytes((folder / "run.bvh").read_bytes())
    text = (folder / "run.bvh").read_text()
    (folder / "broken.bvh").write_text(text.replace("OFFSET", "OFSET", 1))
    (folder / "empty.bvh").write_text("")
    (folder / "readme.txt").write_text("not a motion")
    with zipfile.ZipFile(folder / "set.zip", "w") as archive:
        archive.writestr("in/walk.bvh", (folder / "walks" / "walk3.bvh").read_bytes())
        turn = segue.synthesize(gait="walk", gait_speed=1.3, turn_rate=40)
        archive.writestr("in/turn.bvh", turn.to_bytes("bvh"))
    return folder


@pytest.fixture(scope="module")
def built(takes, tmp_path_factory):
    """Return the folder of a corpus of them, and the report."""
    out = tmp_path_factory.mktemp("corpus")
    return out, build(takes, out, workers=1)


def content(folder):
    """Return the bytes of all files of a corpus."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    named = ((path.relative_to(folder).as_posix(), path.read_bytes()) for path in paths)
    return {name: own for name, own in named if not name.startswith(".work/")}


def rows_of(folder):
    """Return the rows of the table by path."""
    return {row["path"]: row for row in Corpus(folder).table().to_pylist()}


def test_rows_are_those_of_the_files(takes, built):
    out, report = built
    rows = rows_of(out)
    # `again.bvh` has the content of `run.bvh`, as has a walk in the zip.
    assert report[:4] == (11, 9, 0, 2) and report.made == 11 and report.is_written
    assert rows["again.bvh"]["also"] == ["run.bvh"]
    assert rows["set.zip/in/walk.bvh"]["also"] == ["walks/walk3.bvh"]
    assert "readme.txt" not in rows
    run = rows["again.bvh"]
    assert run["status"] == "ok" and run["joints"] == 22 and run["format"] == "bvh"
    own = segue.metrics(segue.load(takes / "run.bvh"))
    told = {name: value for name, value in own.items() if value is not None}
    assert len(told) > 5
    for name, value in told.items():
        assert run[name] == pytest.approx(value, rel=1e-6, abs=1e-9), name


def test_error_is_a_row_with_its_place(built):
    rows = rows_of(built[0])
    broken = rows["broken.bvh"]
    assert (broken["status"], broken["line"], broken["column"]) == ("unreadable", 4, 2)
    assert broken["message"].startswith("found `OFSET`") and broken["shard"] is None
    assert rows["empty.bvh"]["status"] == "unreadable"


def test_copy_in_another_format_is_found(built):
    rows = rows_of(built[0])
    run, same = rows["again.bvh"], rows["the same run.glb"]
    assert {run["copy_of"], same["copy_of"]} == {None, run["id"] if same["copy_of"] else same["id"]}
    assert built[1].copies == 1


def test_bytes_do_not_depend_on_workers(takes, built, tmp_path):
    words = sorted((str(path) for path in takes.iterdir()), reverse=True)
    two = tmp_path / "two"
    assert build(takes, two, workers=2)[:5] == built[1][:5]
    assert content(two) == content(built[0])
    # Files that are named one by one have other paths; their content is the same.
    named = tmp_path / "named"
    build([word for word in words if not word.endswith(".txt")], named, workers=2)
    assert content(named)["poses-00000.bin"] == content(two)["poses-00000.bin"]


def test_page_gets_columns_of_all_rows(takes, built, tmp_path):
    out, report = built
    corpus = Corpus(out)
    assert corpus.manifest["page"] == {"columns": "columns.bin"}
    columns = (out / "columns.bin").read_bytes()
    assert columns[:4] == b"SGCO"
    assert int.from_bytes(columns[8:12], "little") == report.rows
    # They have paths, names and labels, which records have not.
    other = tmp_path / "labelled"
    build(takes, other, labels={"run.bvh": "fast"})
    assert (other / "columns.bin").read_bytes() != columns
    assert content(other)["poses-00000.bin"] == content(out)["poses-00000.bin"]
    rows = corpus.table(["moments", "map_x", "map_y"]).to_pylist()
    for row in rows:
        if row["moments"]:
            assert -1 <= row["map_x"] <= 1 and -1 <= row["map_y"] <= 1
        else:
            assert row["map_x"] is None and row["map_y"] is None


@pytest.mark.parametrize(("format", "message"), [(1, "build it again"), (99, "newer Segue")])
def test_corpus_of_another_format_is_refused(built, tmp_path, format, message):
    manifest = dict(Corpus(built[0]).manifest, format=format)
    (tmp_path / "corpus.json").write_text(json.dumps(manifest))
    with pytest.raises(ValueError, match=message):
        Corpus(tmp_path)


def test_corpus_of_an_older_format_is_gathered_again(takes, built, tmp_path, monkeypatch):
    from segue.corpus import _write

    out = tmp_path / "out"
    monkeypatch.setattr(_write, "_FORMAT", 1)
    build(takes, out)
    monkeypatch.undo()
    report = build(takes, out)
    assert (report.made, report.is_written) == (0, True)
    assert content(out) == content(built[0])


def test_second_build_does_nothing(takes, built, tmp_path):
    out = tmp_path / "out"
    build(takes, out)
    times = {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()}
    report = build(takes, out)
    assert (report.made, report.is_written) == (0, False)
    assert {path: path.stat().st_mtime_ns for path in out.rglob("*") if path.is_file()} == times
    # A file of the corpus that is missing is written again, without computing anything.
    (out / "poses-00000.bin").unlink()
    report = build(takes, out)
    assert (report.made, report.is_written) == (0, True)
    assert content(out) == content(built[0])


def test_new_and_removed_files_are_noticed(takes, built, tmp_path):
    out, more = tmp_path / "out", tmp_path / "more"
    more.mkdir()
    segue.builtin("idle").save(more / "idle.bvh")
    build([takes, more], out)
    assert content(out) != content(built[0])
    report = build(takes, out)
    assert (report.made, report.is_written) == (0, True)
    assert content(out) == content(built[0])


def test_damaged_record_is_made_again(takes, built, tmp_path):
    out = tmp_path / "out"
    build(takes, out)
    records = sorted(path for path in (out / ".work").rglob("*") if path.parent.name != ".work")
    records[3].write_bytes(records[3].read_bytes()[:-5])
    (out / "corpus.json").unlink()
    build(takes, out)
    assert content(out) == content(built[0])


def test_build_that_is_killed_goes_on(takes, built, tmp_path):
    out = tmp_path / "out"
    words = [sys.executable, "-m", "segue.corpus", "build", str(takes), str(out), "--workers", "1"]
    for _ in range(3):
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        before = len(list(out.rglob("*")))
        # As soon as another record is there: in the middle of the work.
        deadline = time.monotonic() + 120
        while len(list(out.rglob("*"))) <= before + 1 and process.poll() is None:
            assert time.monotonic() < deadline
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL if os.name == "posix" else signal.SIGTERM)
        process.wait()
    subprocess.run(words, check=True, capture_output=True)
    assert content(out) == content(built[0])


def test_clip_of_the_corpus_is_the_clip_on_the_standard_body(built):
    corpus = Corpus(built[0])
    rows = corpus.table(["path", "seconds"]).to_pylist()
    place = next(at for at, row in enumerate(rows) if row["path"] == "walks/walk0.bvh")
    clip = corpus.clip(place)
    assert clip.fps == 30 and len(clip.names) == 22 and clip.name == "walk0"
    assert abs(clip.duration - rows[place]["seconds"]) < 0.04
    walk = segue.synthesize(gait="walk", gait_speed=1.0)
    step = round(walk.fps / 30)
    own, back = walk.global_positions()[::step], clip.global_positions()
    hand = walk.names.index("LeftHand"), clip.names.index("LeftHand")
    count = min(len(own), len(back))
    assert np.abs(own[:count, hand[0]] - back[:count, hand[1]]).max() < 0.03
    assert clip.contacts().any(axis=1).mean() > 0.5
    assert corpus.thumbnail(place).startswith(b"\x89PNG")
    broken = next(at for at, row in enumerate(rows) if row["path"] == "broken.bvh")
    with pytest.raises(ValueError, match="message says why"):
        corpus.clip(broken)


def test_moment_of_a_clip_is_most_like_itself(built, takes):
    corpus = Corpus(built[0])
    paths = corpus.table(["path"])["path"].to_pylist()
    walk = segue.load(takes / "walks" / "walk2.bvh")
    hits = corpus.like(walk, 1.0, count=4)
    assert paths[hits[0].row] == "walks/walk2.bvh" and hits[0].distance < 0.1
    assert abs(hits[0].seconds - 1.0) < 1e-6
    # Its speed lies between those of its neighbours, and a run is far from it.
    near = {paths[hit.row] for hit in hits[1:3]}
    assert near <= {"walks/walk1.bvh", "walks/walk3.bvh", "set.zip/in/walk.bvh"}
    everywhere = corpus.like(walk, 1.0, count=50, probes=10_000, by_clip=False)
    assert everywhere[0] == hits[0] and len(everywhere) == 50
    assert all(a.distance <= b.distance for a, b in zip(everywhere, everywhere[1:]))


def test_labels_stand_in_the_table(takes, tmp_path):
    out, table = tmp_path / "out", tmp_path / "labels.csv"
    table.write_text("walks/walk1.bvh,slow,walk\nrun.bvh,fast\n")
    build([takes / "run.bvh", takes], out, labels=table)
    rows = rows_of(out)
    assert rows["walks/walk1.bvh"]["labels"] == ["slow", "walk"]
    # `run.bvh` has the content of `again.bvh`.
    assert rows["again.bvh"]["labels"] == ["fast"] and rows["broken.bvh"]["labels"] == []
    report = build([takes / "run.bvh", takes], out, labels={"walks/walk1.bvh": "other"})
    assert report.made == 0 and rows_of(out)["walks/walk1.bvh"]["labels"] == ["other"]


def test_cleaned_corpus_mends_what_the_table_tells(tmp_path):
    take = segue.builtin("walk")
    rotations = take.rotations.copy()
    rotations[40, take.names.index("LeftArm")] = [0, 1, 0, 0]
    spoilt = segue.from_arrays(
        names=take.names,
        parents=take.parents,
        offsets=take.offsets,
        rotations=rotations,
        root=take.root,
        fps=take.fps,
    )
    spoilt.save(tmp_path / "spoilt.bvh")
    own = build(tmp_path / "spoilt.bvh", tmp_path / "own")
    mended = build(tmp_path / "spoilt.bvh", tmp_path / "mended", clean=True)
    assert own.clips == mended.clips == 1
    rows = [rows_of(tmp_path / name)["spoilt.bvh"] for name in ("own", "mended")]
    assert [row["mended"] > 0 for row in rows] == [False, True]
    assert rows[0]["pose_jump_deg"] == rows[1]["pose_jump_deg"] > 30
    clips = [Corpus(tmp_path / name).clip(0) for name in ("own", "mended")]
    jumps = [segue.metrics(clip)["pose_jump_deg"] for clip in clips]
    assert jumps[1] < 0.5 * jumps[0]


def test_sources_are_found_in_patterns_zips_and_addresses(takes):
    paths = [own.path for own in find([str(takes / "**" / "walk*.bvh")])]
    assert paths == [f"walks/walk{number}.bvh" for number in range(6)]
    assert [own.path for own in find([str(takes / "set.zip")])] == [
        "set.zip/in/turn.bvh",
        "set.zip/in/walk.bvh",
    ]
    assert find([f"file://{takes}"]) == find([str(takes)])
    with pytest.raises(FileNotFoundError, match="nowhere"):
        find([str(takes / "nowhere")])


def test_address_is_read_as_a_folder(takes, built, tmp_path, monkeypatch):
    from pyarrow import fs
    from segue.corpus import _sources

    # The file system of an address, on this machine.
    here = fs.SubTreeFileSystem(str(takes.parent), fs.LocalFileSystem())
    monkeypatch.setattr(_sources, "_SYSTEMS", {f"s3://{takes.name}": here})
    address = f"s3://{takes.name}"
    assert [own.path for own in find([address])] == [own.path for own in find([str(takes)])]
    found = [own.path for own in find([f"{address}/**/walk*.bvh"])]
    assert found == [f"walks/walk{number}.bvh" for number in range(6)]
    build(address, tmp_path / "out")
    assert content(tmp_path / "out") == content(built[0])


def test_motion_is_read_with_the_skeleton_of_its_folder(tmp_path):
    folder = tmp_path / "acclaim"
    folder.mkdir()
    toys = os.path.join(os.path.dirname(__file__), "../../session/src/fixtures/toy")
    for ending in ("asf", "amc"):
        with open(f"{toys}.{ending}", "rb") as file:
            (folder / f"toy.{ending}").write_bytes(file.read())
    build(folder, tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    # Two bones are no body; but the motion was read.
    assert rows["toy.amc"]["frames"] == 2 and rows["toy.amc"]["joints"] is not None
    assert list(rows) == ["toy.amc"]
    (folder / "toy.asf").unlink()
    build(folder, tmp_path / "out")
    assert "skeleton" in rows_of(tmp_path / "out")["toy.amc"]["message"]


def test_file_whose_bytes_cannot_be_had_is_a_row_and_tried_again(takes, tmp_path, monkeypatch):
    from segue.corpus import _work

    own = _work.read

    def read(place, member=""):
        if place.endswith("run.bvh"):
            raise PermissionError(13, "Permission denied", place)
        return own(place, member)

    out = tmp_path / "out"
    monkeypatch.setattr(_work, "read", read)
    build([takes / "run.bvh", takes / "walks"], out)
    row = rows_of(out)["run.bvh"]
    assert row["status"] == "unreadable" and "Permission denied" in row["message"]
    assert str(takes) not in row["message"]
    monkeypatch.setattr(_work, "read", own)
    assert build([takes / "run.bvh", takes / "walks"], out).made == 1
    assert rows_of(out)["run.bvh"]["status"] == "ok"


def test_ray_makes_the_same_bytes(takes, built, tmp_path):
    pytest.importorskip("ray")
    report = build(takes, tmp_path / "out", ray=True, workers=2)
    assert report[:5] == built[1][:5]
    assert content(tmp_path / "out") == content(built[0])


def test_command_tells_what_it_has_done(takes, tmp_path):
    words = [sys.executable, "-m", "segue.corpus", "build"]
    made = subprocess.run([*words, takes, tmp_path / "out"], capture_output=True, text=True)
    assert made.returncode == 0 and "11 rows: 9 clips" in made.stdout, made.stderr
    failed = subprocess.run([*words, "nowhere", tmp_path / "x"], capture_output=True, text=True)
    assert failed.returncode == 1 and "nowhere" in failed.stderr
