"""Golden values for path fits: `python3 tests/oracles/path.py` writes path.json beside it.

Nothing is shared with the program but the definitions. Least squares are SciPy's make_lsq_spline. With smoothing or pinned ends they are NumPy's dense lstsq on
SciPy's design matrix: rows of the penalty under those of the points, pinned points taken to the right-hand side. Places, derivatives and curvature are
BSpline's, lengths scipy.integrate.quad's, inserted knots scipy.interpolate.insert's.
"""

import json
import pathlib

import numpy as np
from scipy.integrate import quad
from scipy.interpolate import BSpline, insert, make_lsq_spline


def ways():
    u = np.linspace(0, 1, 120)
    rng = np.random.default_rng(7)
    yield "turn", np.stack([4 * np.sin(2.2 * u), 3 * u**2], -1) + 0.03 * np.sin(60 * u)[:, None]
    yield "eight", np.stack([3 * np.sin(2 * np.pi * u), 2 * np.sin(4 * np.pi * u)], -1)
    yield "wander", np.cumsum(rng.normal(0, 0.2, (90, 2)) + [0.05, 0.1], 0)
    yield "far", np.stack([100 + 5 * u, -80 + np.cos(3 * u)], -1)


def chord(points):
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    along = np.concatenate([[0], np.cumsum(steps)])
    return along / along[-1]


def knots(count):
    return np.concatenate([np.zeros(4), np.linspace(0, 1, count - 2)[1:-1], np.ones(4)])


def penalised(points, u, count, smoothing, pinned):
    t = knots(count)
    design = BSpline.design_matrix(u, t, 3).toarray() / np.sqrt(len(u))
    right = points / np.sqrt(len(u))
    greville = np.array([t[i + 1 : i + 4].mean() for i in range(count)])
    slopes = np.diff(np.eye(count), axis=0) / np.diff(greville)[:, None]
    penalty = np.sqrt(smoothing / (count - 2)) / (count - 1) * np.diff(slopes, axis=0)
    rows, right = np.vstack([design, penalty]), np.vstack([right, np.zeros((count - 2, 2))])
    found = np.zeros((count, 2))
    free = np.arange(count)
    if pinned:
        found[0], found[-1] = points[0], points[-1]
        free = free[1:-1]
        right = right - rows @ found
    found[free] = np.linalg.lstsq(rows[:, free], right, rcond=None)[0]
    return found


def main():
    fits, curves = [], []
    for name, points in ways():
        points = points.round(6)
        u = chord(points)
        for count in (4, 5, 8, 14):
            spline = make_lsq_spline(u, points, knots(count), 3)
            cases = [(0.0, False, spline.c)]
            cases += [(s, pinned, penalised(points, u, count, s, pinned)) for s, pinned in ((0.0, True), (0.3, False), (20.0, True))]
            for smoothing, pinned, control in cases:
                fits.append({"name": name, "control_points": count, "smoothing": smoothing, "pin_ends": pinned, "found": control.tolist()})
        ats = [0.0, 0.1, 0.37, 0.5, 0.81, 1.0]
        speed = lambda x: np.linalg.norm(spline(x, 1))
        ends = np.unique(spline.t)
        length = lambda to: sum(quad(speed, a, min(b, to), epsabs=1e-11, epsrel=1e-11)[0] for a, b in zip(ends, ends[1:]) if a < to)
        d, dd = spline(ats, 1), spline(ats, 2)
        # Left is where yaw about +Y grows: from +Z (second coordinate) towards +X (first).
        curvature = (d[:, 1] * dd[:, 0] - d[:, 0] * dd[:, 1]) / np.linalg.norm(d, axis=1) ** 3
        t, c, _ = insert(0.43, (spline.t, list(spline.c.T), 3))
        curves.append({
            "name": name,
            "points": spline.c.tolist(),
            "at": ats,
            "position": spline(ats).tolist(),
            "first": d.tolist(),
            "second": dd.tolist(),
            "curvature": curvature.tolist(),
            "length": [length(x) for x in ats],
            "insert_at": 0.43,
            "inserted": np.array(c)[:, : len(spline.c) + 1].T.tolist(),
        })
    data = {"ways": {name: points.round(6).tolist() for name, points in ways()}, "fits": fits, "curves": curves}
    pathlib.Path(__file__).with_suffix(".json").write_text(json.dumps(data) + "\n")


main()
