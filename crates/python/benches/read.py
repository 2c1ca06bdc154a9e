"""Measure reading beside other Python packages, and kinematics.

All in one run, because only ratios on one machine mean something: `python benches/read.py`, after
`pip install .` and `pip install -r tests/requirements.txt`. The wheel must be optimised, as `pip
install .` makes it. The files are made here, of Segue's own walk, and of a take of the CMU database
where the machine has it: there, all numbers have four decimals; Segue leaves out zeros at the end.
"""

import argparse
import os
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
import segue

MB = 1_000_000


def seconds(work, budget=10.0, most=7):
    """Return the median of some runs, fewer where one takes long."""
    times = []
    while len(times) < most and (not times or sum(times) < budget):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def takes(folder):
    """Return BVH files by name, of which larger ones are made."""
    found = {"walk": segue.builtin("walk").save(folder / "walk.bvh")}
    beside = [parent / "shared" / "data" for parent in Path(__file__).resolve().parents]
    places = [Path(os.environ["SEGUE_SHARED"])] if "SEGUE_SHARED" in os.environ else []
    for place in places + beside:
        if (place / "cmu" / "01_01.bvh").is_file():
            found["CMU 01_01"] = place / "cmu" / "01_01.bvh"
            break
    return found


def bvh_of(take, folder, megabytes):
    """Write a BVH file of a size: a take, over and over."""
    head, rows = take.read_text().split("MOTION\n")
    count, spacing, *frames = rows.splitlines()
    block = "".join(f"{frame}\n" for frame in frames)
    times = max(1, round((megabytes * MB - len(head)) / len(block)))
    path = folder / f"{take.stem} {megabytes} MB.bvh"
    with path.open("w") as file:
        file.write(f"{head}MOTION\nFrames: {len(frames) * times}\n{spacing}\n")
        for _ in range(times):
            file.write(block)
    return path


def others():
    """Return the readers of other packages by their names, for those that are installed."""
    found = {}
    try:
        from pymotion.io.bvh import BVH

        found["pymotion"] = lambda path: BVH().load(str(path))
    except ImportError:
        pass
    try:
        import pybvh

        found["pybvh"] = pybvh.read_bvh_file
    except ImportError:
        pass
    try:
        import bvhio

        found["bvhio"] = lambda path: bvhio.readAsBvh(str(path))
    except ImportError:
        pass
    return found


def read(folder, sizes, slow):
    """Print the times of reading, and the ratio to Segue's."""
    files = [(name, take, size) for size in sizes for name, take in takes(folder).items()]
    for name, take, size in files:
        path = bvh_of(take, folder, size)
        own = seconds(lambda: segue.load(path).rotations, most=50, budget=3.0)
        print(f"\n{path.stat().st_size / MB:.1f} MB of BVH, {name}")
        print(f"  {'segue':10} {own * 1e3:10.1f} ms   {path.stat().st_size / MB / own:6.0f} MB/s")
        for name, reader in others().items():
            if size > 10 and name in slow:
                print(f"  {name:10} left out: --all measures it, too")
                continue
            try:
                other = seconds(lambda: reader(path), most=3)
            except Exception as error:  # A reader that fails is a result, too.
                print(f"  {name:10} failed: {type(error).__name__}: {error}")
                continue
            print(f"  {name:10} {other * 1e3:10.1f} ms   {other / own:6.1f} times as long")


def kinematics():
    """Print the time of the places of 10,000 frames of 31 joints."""
    random = np.random.default_rng(7)
    frames, joints = 10_000, 31
    rotations = random.normal(size=(frames, joints, 4)).astype(np.float32)
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    clip = segue.from_arrays(
        names=[f"joint {at}" for at in range(joints)],
        parents=[at - 1 if at % 6 else 0 if at else -1 for at in range(joints)],
        offsets=random.normal(0, 0.2, (joints, 3)),
        rotations=rotations,
        root=random.normal(size=(frames, 3)),
        fps=120,
    )
    took = seconds(clip.global_positions, most=50)
    print(f"\nglobal_positions of {frames} × {joints}: {took * 1e3:.1f} ms (bar: 10 ms)")


def many(folder):
    """Print what a list of files gains from all cores."""
    paths = [bvh_of(takes(folder)["walk"], folder, 2)] * 32
    together = seconds(lambda: segue.load(paths), most=3)
    alone = seconds(lambda: [segue.load(path) for path in paths], most=3)
    print(f"\n32 files of 2 MB: {together:.2f} s as a list, {alone:.2f} s one by one")


def main():
    """Measure all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="*", default=[2, 100], help="MB of BVH")
    parser.add_argument("--all", action="store_true", help="read large files with slow readers")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kinematics()
        many(Path(folder))
        read(Path(folder), args.sizes, () if args.all else ("bvhio",))


if __name__ == "__main__":
    main()
