"""Golden values for registration curves: `python3 tests/oracles/registration.py` writes registration.json beside it.

Nothing is shared with the program but the definitions. The turn that lays one window on another is an orthogonal Procrustes problem, solved by singular
values, and the distance is measured on the points that were laid. The path is a shortest path (SciPy's Dijkstra) in the graph of all states: cell, the way of the
last steps, and how many there were. Means for the timewarp are integrated numerically, and its curve is SciPy's PCHIP.
"""

import json
import pathlib

import numpy as np
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

SIDE_STEP = 1e-3


def clouds(rng):
    """Five points that swing along, and the same at another pace in another place."""
    phases, reach = rng.uniform(0, 6, 5), rng.uniform(0.2, 0.5, (5, 3))

    def clip(frames, phase, turn, shift):
        t = phase(np.arange(frames) / (frames - 1))[:, None]
        x = 0.3 * np.cos(phases) + reach[:, 0] * np.sin(t + phases)
        y = 1.0 + reach[:, 1] * np.cos(t + 2 * phases)
        z = 0.3 * np.sin(phases) + reach[:, 2] * np.sin(t - phases) + 0.4 * t
        c, s = np.cos(turn * t), np.sin(turn * t)
        return np.stack([x * c + z * s + shift[0], y, -x * s + z * c + shift[1]], -1).round(3)

    first = clip(24, lambda u: 9 * u, 0.05, (0, 0))
    second = clip(30, lambda u: 9 * (u + 0.12 * np.sin(6.28 * u)), -0.2, (3, -8))
    return first, second


def laid(p, q, w):
    """Turn, shift and root-mean-square distance of the best laying of q on p: clouds of frames × joints × 3."""
    w = np.broadcast_to(w, p.shape[:2]).ravel()
    p, q = p.reshape(-1, 3), q.reshape(-1, 3)
    flat_p, flat_q = p[:, [0, 2]], q[:, [0, 2]]
    cp, cq = np.average(flat_p, axis=0, weights=w), np.average(flat_q, axis=0, weights=w)
    u, _, vt = np.linalg.svd((flat_q - cq).T @ (w[:, None] * (flat_p - cp)))
    r = vt.T @ np.diag([1, np.linalg.det(vt.T @ u.T)]) @ u.T
    placed = (flat_q - cq) @ r.T + cp
    squares = ((placed - flat_p) ** 2).sum(1) + (p[:, 1] - q[:, 1]) ** 2
    # r is [[cos, sin], [-sin, cos]] on (x, z).
    return np.arctan2(r[0, 1], r[0, 0]), cp - r @ cq, np.sqrt(np.average(squares, weights=w))


def distances(p, q, w, window):
    rows, columns = len(p) - window + 1, len(q) - window + 1
    return np.array([[laid(p[i : i + window], q[j : j + window], w)[2] for j in range(columns)] for i in range(rows)])


def best_path(matrix, limit):
    rows, columns = matrix.shape
    states = [(0, 0)] + [(way, run) for way in (1, 2) for run in range(1, limit + 1)]
    number = lambda i, j, s: (i * columns + j) * len(states) + s
    graph = {}
    for i in range(rows):
        for j in range(columns):
            for s, (way, run) in enumerate(states):
                for step, (di, dj) in enumerate([(1, 1), (1, 0), (0, 1)]):
                    k, l = i + di, j + dj
                    further = run + 1 if step == way else 1
                    if k >= rows or l >= columns or (step and further > limit):
                        continue
                    cost = 2 * matrix[k, l] if step == 0 else matrix[k, l] + SIDE_STEP
                    graph[number(i, j, s), number(k, l, states.index((step, further) if step else (0, 0)))] = cost
    (sources, targets), size = zip(*graph), rows * columns * len(states)
    tree = csr_matrix((list(graph.values()), (sources, targets)), (size, size))
    start, ends = number(0, 0, 0), [number(rows - 1, columns - 1, s) for s in range(len(states))]
    costs, before = dijkstra(tree, indices=start, return_predecessors=True)
    at = min(ends, key=lambda end: costs[end])
    cells = []
    while at >= 0:
        cells.append(divmod(at // len(states), columns))
        at = before[at]
    cells.reverse()
    weights = [2] + [2 if a[0] != b[0] and a[1] != b[1] else 1 for a, b in zip(cells, cells[1:])]
    return cells, float(np.average([matrix[cell] for cell in cells], weights=weights))


def timewarp(cells, window, smoothing):
    half = (window - 1) / 2
    middle = [(i + half, j + half) for i, j in cells]
    begin, end = np.subtract(middle[0], half), np.add(middle[-1], half)
    i, j = np.array([begin, *middle, end]).T
    u, v = (i + j) / 2, j - i
    count = max(1, int(np.ceil((u[-1] - u[0]) / max(smoothing / 2, 1))))
    knots = np.linspace(u[0], u[-1], count + 1)
    lead = []
    for k in knots:
        width = min(smoothing, k - u[0], u[-1] - k)
        corners = u[(u > k - width) & (u < k + width)]
        edges = [k - width, *corners, k + width]
        area = sum(quad(lambda x: np.interp(x, u, v), a, b)[0] for a, b in zip(edges, edges[1:]))
        lead.append(area / (2 * width) if width > 1e-9 else np.interp(k, u, v))
    lead = np.array(lead)
    line = (lead[-1] - lead[0]) / (u[-1] - u[0])
    steepest = 2 - 2 * min(0.05, (2 - abs(line)) / 4)
    # The smallest share of the straight line that makes no piece too steep: by trying.
    for share in np.linspace(0, 1, 100001):
        drawn = lead + share * (lead[0] + line * (knots - knots[0]) - lead)
        if np.abs(np.diff(drawn) / np.diff(knots)).max() <= steepest + 1e-12:
            break
    return PchipInterpolator(knots - drawn / 2, knots + drawn / 2), float(share)


def main():
    rng = np.random.default_rng(16)
    p, q = clouds(rng)
    w = rng.uniform(0.5, 2, 5).round(2)
    golden = {"source": p.tolist(), "target": q.tolist(), "weights": w.tolist(), "windows": []}
    for window in (1, 4):
        matrix = distances(p, q, w, window)
        yaw, shift, _ = laid(p[5 : 5 + window], q[9 : 9 + window], w)
        entry = {"window": window, "rms_m": matrix.round(9).tolist(), "at_5_9": [yaw, *shift], "paths": []}
        for limit in (1, 2, 3):
            cells, mean = best_path(matrix, limit)
            warps = []
            for smoothing in (0, 3, 6):
                curve, straightened = timewarp(cells, window, smoothing)
                frames = np.arange(24)
                warps.append({"smoothing": smoothing, "straightened": straightened, "at_frames": curve(frames).tolist()})
            entry["paths"].append({"slope_limit": limit, "cells": [list(map(int, cell)) for cell in cells], "mean_m": mean, "warps": warps})
        golden["windows"].append(entry)
    path = pathlib.Path(__file__).with_name("registration.json")
    path.write_text(json.dumps(golden) + "\n")


main()
