"""Golden values for the dissolve of two clips: `python3 dissolve.py` writes dissolve.json.

Two joints: a root, which turns every way, and an arm on it. The root faces its own +Z in the first frame; from there on its heading is how far it has
turned about +Y since (the twist of R(f) R(0)⁻¹). Rotations are SciPy's, alignment is SciPy's least squares (align.py);
nothing is shared with the program but the definition: weight of A in frame p of k is 1 - s((p + 1) / k), s(t) = 3t² - 2t³, steps of the
character are blended at the weight of their middle.
"""

import json
import pathlib

import numpy as np
from align import minimised
from scipy.spatial.transform import Rotation, Slerp

FPS, OFFSET = 50, np.array([0.3, 0.4, -0.2])


def smooth(t):
    return 1 - (3 * t**2 - 2 * t**3)


def motion(frames, seed):
    rng = np.random.default_rng(seed)
    t = np.arange(frames) / FPS
    wave = lambda size: size * np.sin(rng.uniform(1, 5, 3) * t[:, None] + rng.uniform(0, 6, 3))
    root = np.cumsum(np.abs(wave(0.06)), axis=0) * [1, 0, 1] + [0, 1, 0] + wave(0.05) + rng.uniform(-3, 3, 3) * [1, 0, 1]
    heading = rng.uniform(-3, 3) + rng.uniform(0.5, 2) * t
    lean = wave(0.25)
    orientation = Rotation.from_euler("Y", heading[:, None]) * Rotation.from_rotvec(lean)
    arm = Rotation.from_rotvec(wave(0.9))
    single = lambda values: values.astype(np.float32).astype(float)
    return single(root), Rotation.from_quat(single(orientation.as_quat())), Rotation.from_quat(single(arm.as_quat()))


def facing(rotations):
    z = rotations[0].apply([0, 0, 1])
    since = (rotations * rotations[0].inv()).as_quat()
    return wrapped(np.arctan2(z[0], z[2]) + 2 * np.arctan2(since[:, 1], since[:, 3]))


def turn(yaw):
    return Rotation.from_euler("Y", yaw)


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def half_way(a, b, weight_of_a):
    return Slerp([0, 1], Rotation.concatenate([b, a]))(weight_of_a)


def points(clip, frames):
    root, orientation, _ = clip
    arm = root + orientation.apply(OFFSET)
    return np.concatenate([[root[f], arm[f]] for f in frames])


def steps(clip):
    """Per frame: the step into it, (sideways, forward, yaw) in the character's frame at the frame before."""
    root, orientation, _ = clip
    yaw = facing(orientation)
    out = np.zeros((len(root), 3))
    for f in range(1, len(root)):
        local = turn(-yaw[f - 1]).apply(root[f] - root[f - 1])
        out[f] = local[0], local[2], wrapped(yaw[f] - yaw[f - 1])
    out[0] = out[1]
    return out


def by_velocity(a, leave, b, enter, window):
    steps_a, steps_b = steps(a), steps(b)
    yaw_a, yaw_b = facing(a[1]), facing(b[1])
    at, yaw = a[0][leave - 1] * [1, 0, 1], yaw_a[leave - 1]
    rows = []
    for p in range(window):
        w = smooth((p + 0.5) / window)
        step = w * steps_a[leave + p] + (1 - w) * steps_b[enter + p]
        at = at + turn(yaw).apply([step[0], 0, step[1]])
        yaw = yaw + step[2]
        w = smooth((p + 1) / window)
        height = w * a[0][leave + p][1] + (1 - w) * b[0][enter + p][1]
        leaning = half_way(turn(-yaw_a[leave + p]) * a[1][leave + p], turn(-yaw_b[enter + p]) * b[1][enter + p], w)
        rows.append((at + [0, height, 0], turn(yaw) * leaning, half_way(a[2][leave + p], b[2][enter + p], w)))
    moved = turn(yaw - yaw_b[enter + window - 1])
    shift = at - moved.apply(b[0][enter + window - 1] * [1, 0, 1])
    return rows, moved, shift


def in_the_world(a, leave, b, enter, window):
    source, target = points(a, range(leave, leave + window)), points(b, range(enter, enter + window))
    yaw, x0, z0, _ = minimised(source, target, np.full(len(source), 0.5))
    moved, shift = turn(yaw), np.array([x0, 0, z0])
    rows = []
    for p in range(window):
        w = smooth((p + 1) / window)
        root = w * a[0][leave + p] + (1 - w) * (moved.apply(b[0][enter + p]) + shift)
        rows.append((root, half_way(a[1][leave + p], moved * b[1][enter + p], w), half_way(a[2][leave + p], b[2][enter + p], w)))
    return rows, moved, shift


def short(values):
    """The shortest decimals that are read back as the same 32-bit numbers."""
    return [float(str(np.float32(value))) for value in values]


def listed(clip):
    root, orientation, arm = clip
    rotations = [[short(q), short(r)] for q, r in zip(orientation.as_quat(), arm.as_quat())]
    return {"roots": [short(p) for p in root], "rotations": rotations}


def main():
    cases = []
    for seed, leave, enter, window in [(1, 20, 3, 12), (2, 9, 0, 20), (3, 26, 11, 2)]:
        a, b = motion(33, 10 * seed), motion(28, 10 * seed + 1)
        for name, law in [("Velocity", by_velocity), ("World", in_the_world)]:
            rows, moved, shift = law(a, leave, b, enter, window)
            last = moved.apply(b[0][-1]) + shift
            cases.append(
                {
                    "root": name,
                    "leave": leave,
                    "enter": enter,
                    "window": window,
                    "a": listed(a),
                    "b": listed(b),
                    "during": {
                        "roots": [short(row[0]) for row in rows],
                        "rotations": [[short(row[1].as_quat()), short(row[2].as_quat())] for row in rows],
                    },
                    "last_root": short(last),
                    "last_rotation": short((moved * b[1][len(b[0]) - 1]).as_quat()),
                }
            )
    text = json.dumps({"fps": FPS, "offset": OFFSET.tolist(), "cases": cases}, separators=(",", ":"))
    pathlib.Path(__file__).with_suffix(".json").write_text(text)


if __name__ == "__main__":
    main()
