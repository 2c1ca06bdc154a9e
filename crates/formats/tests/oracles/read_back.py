"""Whether exported BVH files are the same motion to `bvhio`: `python3 read_back.py FOLDER`, where the tests left their files
(target/tmp/exchange). `cargo xtask test oracles` runs it with the version of bvhio that it was made with, 1.5.4."""

import csv
import math
import pathlib
import sys

import bvhio

# A thousandth of a centimetre, metres.
AS_GOOD_AS_SAME = 1e-5


def expected(path):
    """For each joint its positions in metres, frame by frame."""
    with open(path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    joints = {name.removesuffix(".x_m"): column for column, name in enumerate(names) if name.endswith(".x_m")}
    return {joint: [tuple(map(float, row[column : column + 3])) for row in rows] for joint, column in joints.items()}


def farthest(path, metres_per_unit, positions):
    root = bvhio.readAsHierarchy(str(path))
    frames = len(next(iter(positions.values())))
    first, last = root.getKeyframeRange()
    assert (first, last) == (0, frames - 1), f"frames {first} to {last}, not 0 to {frames - 1}"
    most = 0.0
    for frame in range(frames):
        root.loadPose(frame)
        joints = [joint for joint, *_ in root.layout()]
        assert {joint.Name for joint in joints} == positions.keys(), "other joints"
        for joint in joints:
            here = [value * metres_per_unit for value in joint.PositionWorld]
            most = max(most, math.dist(here, positions[joint.Name][frame]))
    return most


def main():
    folder = pathlib.Path(sys.argv[1])
    cases = [line.split() for line in (folder / "cases.txt").read_text().splitlines()]
    assert cases, "no files: run the test formats_exchange first"
    failed = False
    for name, metres_per_unit in cases:
        most = farthest(folder / f"{name}.bvh", float(metres_per_unit), expected(folder / f"{name}.csv"))
        print(f"{name}.bvh: {100 * most:.6f} cm apart")
        failed |= not most < AS_GOOD_AS_SAME
    sys.exit("further apart than a thousandth of a centimetre" if failed else 0)


if __name__ == "__main__":
    main()
