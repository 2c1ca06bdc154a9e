"""Golden values for motion graphs: `python3 tests/oracles/graph.py` writes graph.json beside it.

Nothing is shared with the program but the definitions. Windows are laid on each other by singular values and their distance is measured on the
points that were laid; minima are looked for cell by cell; components are SciPy's; the generator is PCG-XSH-RR 64/32 as its paper has it (O'Neill 2014),
and chance is drawn in whole numbers.
"""

import json
import pathlib

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

WINDOW, THRESHOLD_CM, MIN_JUMP, HEIGHT, CONTINUITY = 5, 9.0, 10, 1.75, 0.6
SEED, STREAM, STAYS = 20, 0x0A02BDBF7BB3C0A7, 60


def clips():
    """Four points that swing, twice, at another pace and in another place. Weights are uniform."""
    rng = np.random.default_rng(4)
    phases, reach = rng.uniform(0, 6, 4), rng.uniform(0.2, 0.5, (4, 3))

    def clip(frames, pace, turn, shift):
        t = (pace * np.arange(frames) + 0.3 * np.sin(0.11 * np.arange(frames)))[:, None]
        x = 0.3 * np.cos(phases) + reach[:, 0] * np.sin(t + phases)
        y = 1.0 + reach[:, 1] * np.cos(t + 2 * phases)
        z = 0.3 * np.sin(phases) + reach[:, 2] * np.sin(t - phases) + 0.2 * t
        c, s = np.cos(turn * t), np.sin(turn * t)
        return np.stack([x * c + z * s + shift[0], y, -x * s + z * c + shift[1]], -1).round(3)

    return [clip(70, 0.29, 0.03, (0, 0)), clip(60, 0.33, -0.05, (3, -8))]


def distance_cm(p, q):
    p, q = p.reshape(-1, 3), q.reshape(-1, 3)
    a, b = p[:, ::2] - p[:, ::2].mean(0), q[:, ::2] - q[:, ::2].mean(0)
    u, _, vt = np.linalg.svd(b.T @ a)
    u[:, -1] *= np.linalg.det(u @ vt)
    laid = b @ (u @ vt)
    return 100 * np.sqrt((((a - laid) ** 2).sum(1) + (p[:, 1] - q[:, 1]) ** 2).mean()) * 1.75 / HEIGHT


def matrix(p, q):
    return np.array([[distance_cm(p[i:i + WINDOW], q[j:j + WINDOW]) for j in range(len(q) - WINDOW + 1)] for i in range(len(p) - WINDOW + 1)])


def pcg32(seed):
    mask = (1 << 64) - 1
    step = lambda state: (state * 6364136223846793005 + (STREAM << 1 | 1)) & mask
    state = step((seed + (STREAM << 1 | 1)) & mask)
    while True:
        x, turn = ((state >> 18) ^ state) >> 27 & 0xFFFFFFFF, state >> 59
        state = step(state)
        yield (x >> turn | x << (-turn & 31)) & 0xFFFFFFFF


def jumps(motion):
    found = []
    for a in range(2):
        for b in range(a, 2):
            d = matrix(motion[a], motion[b])
            for i, j in np.ndindex(*d.shape):
                around = d[max(i - 1, 0):i + 2, max(j - 1, 0):j + 2]
                if (a == b and j - i < MIN_JUMP) or d[i, j] > THRESHOLD_CM or d[i, j] > around.min():
                    continue
                for (leave, enter) in (((a, i), (b, j)), ((b, j), (a, i))):
                    if leave[1] >= 1 and enter[1] + WINDOW < len(motion[enter[0]]):
                        found.append((round(float(d[i, j]), 3), leave, enter))
    return sorted(found)


def graph(motion, found):
    nodes = []
    for clip in range(2):
        cuts = {0, len(motion[clip])}
        cuts |= {leave[1] for _, leave, _ in found if leave[0] == clip}
        cuts |= {enter[1] + WINDOW for _, _, enter in found if enter[0] == clip}
        cuts = sorted(cuts)
        nodes += [(clip, s, e) for s, e in zip(cuts, cuts[1:])]
    ends, starts = {(c, e): n for n, (c, s, e) in enumerate(nodes)}, {(c, s): n for n, (c, s, e) in enumerate(nodes)}
    edges = [(n, n + 1, None) for n in range(len(nodes) - 1) if nodes[n][0] == nodes[n + 1][0]]
    edges += [(ends[jump[1]], starts[(jump[2][0], jump[2][1] + WINDOW)], jump) for jump in found]
    rows, columns = [e[0] for e in edges], [e[1] for e in edges]
    _, label = connected_components(csr_matrix(([1] * len(edges), (rows, columns)), (len(nodes),) * 2), True, "strong")
    sizes = [sum(e - s for (_, s, e), of in zip(nodes, label) if of == component) for component in range(label.max() + 1)]
    kept = [n for n in range(len(nodes)) if label[n] == int(np.argmax(sizes))]
    return nodes, kept, [e for e in edges if e[0] in kept and e[1] in kept]


def walk(nodes, kept, edges):
    draw, at, stays = pcg32(SEED), kept[0], []
    since = nodes[at][1]
    while len(stays) < STAYS:
        ways = [e for e in edges if e[0] == at]
        far = [e[2][0] for e in ways if e[2]]
        whole = 1 << 32
        on = (round(CONTINUITY * whole) if far else whole) if len(far) < len(ways) else 0
        total = sum(1 / max(d, 0.01) for d in far)
        shares = [int(1 / max(e[2][0], 0.01) / total * (whole - on)) if e[2] else on for e in ways]
        if far:
            shares[[bool(e[2]) and e[2][0] == min(far) for e in ways].index(True)] += whole - sum(shares)
        shares = [share << 16 for share in shares]
        low = next(draw)
        ticket = (low | next(draw) << 32) * sum(shares) >> 64
        for edge, share in zip(ways, shares):
            if ticket < share:
                break
            ticket -= share
        if edge[2]:
            stays.append([nodes[at][0], since, edge[2][1][1]])
            since = edge[2][2][1]
        at = edge[1]
    return stays


def main():
    motion = clips()
    found = jumps(motion)
    nodes, kept, edges = graph(motion, found)
    values = {
        "window": WINDOW, "threshold_cm": THRESHOLD_CM, "min_jump": MIN_JUMP, "height": HEIGHT, "continuity": CONTINUITY, "seed": SEED,
        "clips": [clip.tolist() for clip in motion],
        "jumps": found,
        "nodes": nodes,
        "kept": [nodes[n] for n in kept],
        "stays": walk(nodes, kept, edges),
    }
    print(len(found), "jumps,", len(nodes), "nodes,", len(kept), "kept")
    pathlib.Path(__file__).with_suffix(".json").write_text(json.dumps(values) + "\n")


main()
