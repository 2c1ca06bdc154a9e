"""Whether exported FBX files are the same motion to Blender, without a warning:

    pip install bpy==5.0.1 && python3 read_back_fbx.py FOLDER

where the tests left their files (target/tmp/exchange). The importer in Python (io_scene_fbx) shares no code with ufbx.
"""

import contextlib
import io
import math
import pathlib
import sys

import bpy
from fbx_golden import takes
from read_back_npz import expected

# A millimetre.
MOST_M = 1e-3
COMPLAINTS = ("warn", "error", "traceback", "unsupported", "fail")


def main():
    folder = pathlib.Path(sys.argv[1])
    cases = [line.split()[0] for line in (folder / "cases.txt").read_text().splitlines()]
    assert cases, "no files: run the test formats_exchange first"
    failed = False
    for name in cases:
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            found = takes(folder / f"{name}.fbx")
        complaints = [line for line in said.getvalue().splitlines() if any(word in line.lower() for word in COMPLAINTS)]
        joints, _ = expected(folder / f"{name}.csv")
        fps = bpy.context.scene.render.fps / bpy.context.scene.render.fps_base
        assert len(found) == 1, f"{name}: {len(found)} takes"
        (take,) = found.values()
        ends = {joint for joint in take if joint.endswith("_end")}
        assert take.keys() - ends == joints.keys(), f"{name}: other joints: {take.keys() ^ joints.keys()}"
        frames = {len(take[joint]) for joint in joints} | {len(places) for places in joints.values()}
        assert len(frames) == 1, f"{name}: frames {frames}"
        most = max(math.dist(a, b) for joint in joints for a, b in zip(take[joint], joints[joint]))
        print(f"{name}.fbx: {100 * most:.6f} cm apart, {fps:.3f} fps, {len(complaints)} complaints")
        print(*complaints, sep="\n")
        failed |= not most < MOST_M or bool(complaints)
    sys.exit("further apart than a millimetre, or with complaints" if failed else 0)


if __name__ == "__main__":
    main()
