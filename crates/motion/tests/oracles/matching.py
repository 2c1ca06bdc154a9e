"""Golden values for motion matching: `python3 tests/oracles/matching.py` writes matching.json beside it.

Nothing is shared with the program but the definitions. Simulation roots are scipy.signal.savgol_filter's (third degree, mode "interp"), features and their
normalisation NumPy's, and the way of the simulation object is integrated by scipy.integrate.solve_ivp from the differential equation of a critically
damped spring on the velocity: v'' = -2 y v' - y² (v - goal), y = 2 ln 2 / half-life.
"""

import json
import pathlib

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import savgol_filter

RATE = 60
AHEAD = [20, 40, 60]
# Hips, left thigh, left foot, right thigh, right foot: offsets in the parent's frame. Facing is the axis across the thighs.
OFFSETS = {"left": ([0.1, 0, 0], [0, -0.8, 0.02]), "right": ([-0.1, 0, 0], [0, -0.8, 0.02])}


def turn(yaw, v):
    s, c = np.sin(yaw), np.cos(yaw)
    return np.stack([v[..., 0] * c + v[..., 2] * s, v[..., 1], -v[..., 0] * s + v[..., 2] * c], -1)


def smoothed_roots(position, yaw):
    n = len(yaw)
    window = lambda secs: min(2 * round(0.5 * secs * RATE) + 1, n if n % 2 else n - 1)
    xz = savgol_filter(position[:, [0, 2]], window(1.0), 3, axis=0, mode="interp")
    facing = np.stack([np.sin(yaw), np.cos(yaw)], -1)
    d = savgol_filter(facing, window(1.6), 3, axis=0, mode="interp")
    return xz, np.arctan2(d[:, 0], d[:, 1])


def features(position, yaw, swing):
    n = len(yaw)
    xz, root_yaw = smoothed_roots(position, yaw)
    feet = {}
    for side, sign in (("left", 1), ("right", -1)):
        thigh, foot = (np.array(v) for v in OFFSETS[side])
        a = sign * swing
        bent = np.stack([np.full(n, foot[0]), foot[1] * np.cos(a) - foot[2] * np.sin(a), foot[1] * np.sin(a) + foot[2] * np.cos(a)], -1)
        feet[side] = position + turn(yaw, thigh + bent)
    velocity = lambda p: np.gradient(p, 1 / RATE, axis=0)
    local = lambda v: turn(-root_yaw, v)
    point = lambda p: local(p - np.stack([xz[:, 0], np.zeros(n), xz[:, 1]], -1))
    valid = n - AHEAD[-1]
    rows = np.zeros((valid, 27))
    for t, ahead in enumerate(AHEAD):
        off = xz[ahead : ahead + valid] - xz[:valid]
        off = turn(-root_yaw[:valid], np.stack([off[:, 0], 0 * off[:, 0], off[:, 1]], -1))
        face = root_yaw[ahead : ahead + valid] - root_yaw[:valid]
        rows[:, 2 * t], rows[:, 2 * t + 1] = off[:, 0], off[:, 2]
        rows[:, 6 + 2 * t], rows[:, 7 + 2 * t] = np.sin(face), np.cos(face)
    body = [point(feet["left"]), point(feet["right"]), local(velocity(feet["left"])), local(velocity(feet["right"])), local(velocity(position))]
    rows[:, 12:] = np.concatenate(body, -1)[:valid]
    blocks = [range(0, 6), range(6, 12), range(12, 18), range(18, 24), range(24, 27)]
    scales = [rows[:, list(block)].std(axis=0).mean() for block in blocks]
    return xz, root_yaw, rows, rows.mean(axis=0), scales


def simulated(rng):
    case = {
        "velocity": rng.normal(0, 1.5, 2),
        "acceleration": rng.normal(0, 3, 2),
        "goal": rng.normal(0, 1.5, 2),
        "half_life": rng.uniform(0.1, 0.6),
        "secs": rng.uniform(0.1, 1.5),
    }
    y = 2 * np.log(2) / case["half_life"]

    def rate(_, s):
        v, a = s[2:4], s[4:6]
        return np.concatenate([v, a, -2 * y * a - y * y * (v - case["goal"])])

    start = np.concatenate([[0, 0], case["velocity"], case["acceleration"]])
    end = solve_ivp(rate, (0, case["secs"]), start, rtol=1e-11, atol=1e-12).y[:, -1]
    return {key: np.asarray(value).tolist() for key, value in case.items()} | {"end": end.tolist()}


def main():
    rng = np.random.default_rng(8)
    n = 200
    t = np.arange(n) / RATE
    yaw = 0.9 * np.sin(1.3 * t) + 0.08 * np.sin(11 * t)
    position = np.stack([np.sin(0.7 * t) + 0.02 * np.sin(11 * t), 0.9 + 0.02 * np.cos(12 * t), 1.4 * t - 0.2 * t**2], -1)
    swing = 0.5 * np.sin(6 * t)
    # The program reads f32.
    position, yaw, swing = (np.float32(v).astype(float) for v in (position, yaw, swing))
    xz, root_yaw, rows, means, scales = features(position, yaw, swing)
    out = {
        "position": position.tolist(),
        "yaw": yaw.tolist(),
        "swing": swing.tolist(),
        "roots": np.column_stack([root_yaw, xz]).tolist(),
        "rows": {str(frame): rows[frame].tolist() for frame in (0, 1, 33, 90, len(rows) - 1)},
        "means": means.tolist(),
        "scales": list(scales),
        "simulation": [simulated(rng) for _ in range(8)],
    }
    path = pathlib.Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(out).replace("], ", "],\n") + "\n")


main()
