"""Whether exported NPZ files are the same motion to NumPy: `python3 read_back_npz.py FOLDER`, where the tests left their files
(target/tmp/exchange). `cargo xtask test oracles` runs it."""

import csv
import pathlib
import sys

import numpy as np

# A thousandth of a centimetre, metres.
AS_GOOD_AS_SAME = 1e-5


def expected(path):
    """For each joint its positions in metres: (frames, 3)."""
    with open(path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    values = np.array([[float(cell or "nan") for cell in row] for row in rows])
    columns = {name.removesuffix(".x_m"): column for column, name in enumerate(names) if name.endswith(".x_m")}
    return {joint: values[:, column : column + 3] for joint, column in columns.items()}, values[:, 0]


def matrices(quaternions):
    """Rotation matrices of unit quaternions w x y z."""
    w, x, y, z = np.moveaxis(quaternions.astype(float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), [0, 1], [-2, -1])


def positions(clip):
    """World positions: (frames, joints, 3)."""
    local = matrices(clip["rotations"])
    frames, joints = local.shape[:2]
    places = np.broadcast_to(clip["offsets"].astype(float), (frames, joints, 3)).copy()
    for track, joint in enumerate(clip["moving"]):
        places[:, joint] = clip["moves"][track]
    turned, at = np.zeros_like(local), np.zeros((frames, joints, 3))
    for joint, parent in enumerate(clip["parents"]):
        if parent < 0:
            turned[:, joint], at[:, joint] = local[:, joint], clip["root"]
        else:
            turned[:, joint] = turned[:, parent] @ local[:, joint]
            at[:, joint] = at[:, parent] + np.einsum("fij,fj->fi", turned[:, parent], places[:, joint])
    return at


def main():
    folder = pathlib.Path(sys.argv[1])
    cases = [line.split()[0] for line in (folder / "cases.txt").read_text().splitlines()]
    assert cases, "no files: run the test formats_exchange first"
    failed = False
    for name in cases:
        clip = np.load(folder / f"{name}.npz")
        joints, times = expected(folder / f"{name}.csv")
        found = positions(clip)
        assert list(joints) == list(clip["names"]), f"{name}: other joints"
        most = max(np.abs(found[:, index] - places).max() for index, places in enumerate(joints.values()))
        late = np.abs(np.arange(len(found)) / float(clip["fps"]) - times).max()
        print(f"{name}.npz: {100 * most:.6f} cm and {late:.1e} s apart")
        failed |= not (most < AS_GOOD_AS_SAME and late < 1e-5)
    sys.exit("further apart than a thousandth of a centimetre" if failed else 0)


if __name__ == "__main__":
    main()
