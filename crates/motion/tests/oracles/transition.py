"""Golden values for springs, decays, dead blending and loops: `python3 tests/oracles/transition.py` writes transition.json beside it.

Nothing is shared with the program but the definitions. Springs are the matrix exponential of their differential equation, x'' = -2y x' - y² x with
y = 2 ln 2 / h. Cubic and quintic are polynomials found from their boundary conditions by solving for their coefficients. What a decaying velocity
makes is integrated numerically. The exact loop is found by superposition: the seam of unit inputs, and a linear system for none. Rotations are SciPy's; the
rate of a rotation offset is a numerical derivative.
"""

import json
import pathlib

import numpy as np
from scipy.integrate import quad
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

TIMES = [0.0, 0.01, 0.04, 0.1, 0.17, 0.25, 0.4, 0.7]


def flow(half_life, t):
    y = 2 * np.log(2) / half_life
    return expm(t * np.array([[0, 1], [-y * y, -2 * y]]))


def polynomial(conditions, period):
    """Coefficients, lowest first, of the polynomial with these (time, derivative, value)."""
    n = len(conditions)
    rows, values = [], []
    for t, derivative, value in conditions:
        row = np.zeros(n)
        for power in range(derivative, n):
            row[power] = np.prod([power - i for i in range(derivative)]) * t ** (power - derivative)
        rows.append(row)
        values.append(value)
    return np.polynomial.Polynomial(np.linalg.solve(rows, values))


def sampled(curve, period, t):
    if t >= period:
        return [0.0, 0.0]
    return [float(curve(t)), float(curve.deriv()(t))]


def cubic(x, v, period, t):
    return sampled(polynomial([(0, 0, x), (0, 1, v), (period, 0, 0), (period, 1, 0)], period), period, t)


def quintic(x, v, period, t):
    """Bollo's conditions for x > 0 > v; for v > 0 the velocity is kept, which he drops."""
    if v < 0:
        period = min(period, -5 * x / v)
    acceleration = max(0, (-8 * v * period - 20 * x) / period**2)
    ends = [(period, derivative, 0) for derivative in range(3)]
    return sampled(polynomial([(0, 0, x), (0, 1, v), (0, 2, acceleration), *ends], period), period, t)


def smooth(t):
    t = min(max(t, 0), 1)
    return 1 - t * t * (3 - 2 * t)


def made_way(half_life, t):
    return quad(lambda s: 0.5 ** (s / half_life), 0, t, epsabs=1e-13)[0]


def exact_loop(half_life, ratio, duration, d, v, times):
    far = flow(half_life, duration)

    def offset(fed, t):
        head = flow(half_life, t) @ (ratio * fed)
        tail = flow(half_life, duration - t) @ ((1 - ratio) * np.array([fed[0], -fed[1]]))
        return np.array([head[0] - tail[0], head[1] + tail[1]])

    seam = np.column_stack([offset(unit, 0) - offset(unit, duration) for unit in np.eye(2)])
    fed = np.linalg.solve(seam, [d, v])
    return [offset(fed, share * duration).tolist() for share in times]


def turns(rng):
    result = []
    for size in (0.3, 1.0, 1.5):
        old, new = rng.uniform(-size, size, (2, 2, 3)).round(3)
        at = lambda clip, t: Rotation.from_rotvec(clip[1] * t) * Rotation.from_rotvec(clip[0])
        difference = lambda t: (at(old, t) * at(new, t).inv()).as_rotvec()
        step = 1e-5
        x, v = difference(0), (difference(step) - difference(-step)) / (2 * step)
        half_life, (blend, running) = 0.12, (0.35, 0.2)
        spring, dead = [], []
        for t in TIMES:
            left = flow(half_life, t)[0] @ np.array([x, v])
            spring.append((Rotation.from_rotvec(left) * at(new, t)).as_rotvec().tolist())
            on = Rotation.from_rotvec(old[1] * made_way(running, t)) * Rotation.from_rotvec(old[0])
            rest = Rotation.from_rotvec(smooth(t / blend) * (on * at(new, t).inv()).as_rotvec())
            dead.append((rest * at(new, t)).as_rotvec().tolist())
        result.append(
            {"old": old.tolist(), "new": new.tolist(), "spring_half_life": half_life, "spring": spring, "dead_blend": [blend, running], "dead": dead}
        )
    return result


def main():
    rng = np.random.default_rng(16)
    decays = []
    for x, v in [(1.0, 0.0), (0.0, 1.0), (0.4, 2.5), (0.4, -2.5), (0.05, -6.0), (0.3, -2.2)]:
        entry = {"x": x, "v": v, "half_life": 0.15, "period": 0.5}
        entry["spring"] = [(flow(0.15, t) @ [x, v]).tolist() for t in TIMES]
        entry["cubic"] = [cubic(x, v, 0.5, t) for t in TIMES]
        entry["quintic"] = [quintic(x, v, 0.5, t) for t in TIMES] if x > 0 else None
        decays.append(entry)
    running = [[0.5 ** (t / 0.2), made_way(0.2, t)] for t in TIMES]
    loops = []
    shares = [0.0, 0.1, 0.5, 0.8, 1.0]
    for half_life, ratio, duration, d, v in [
        (0.2, 0.5, 0.5, 1, 0),
        (0.2, 0.5, 0.5, 0, 1),
        (0.2, 1.0, 0.5, 0.3, -1.1),
        (0.1, 0.0, 1.3, 0.3, 2.0),
        (0.4, 0.3, 0.7, -0.6, 0.9),
    ]:
        offsets = exact_loop(half_life, ratio, duration, d, v, shares)
        loops.append({"half_life": half_life, "ratio": ratio, "duration": duration, "d": d, "v": v, "shares": shares, "offsets": offsets})
    golden = {"times": TIMES, "decays": decays, "running_half_life": 0.2, "running": running, "loops": loops, "turns": turns(rng)}
    path = pathlib.Path(__file__).with_name("transition.json")
    path.write_text(json.dumps(golden, indent=1) + "\n")


main()
