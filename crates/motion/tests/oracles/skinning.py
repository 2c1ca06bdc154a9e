"""Golden values for skinning: `python3 tests/oracles/skinning.py` writes skinning.json beside it.

Nothing is shared with the program but the definitions. Linear blend is a weighted sum of 4x4 matrices. The mean motion of dual quaternion skinning
(Kavan, Collins, Zara, O'Sullivan 2007) is made into a matrix by their equations, written out for 2x4 arrays (w first); what twists a limb by half a turn
is checked against the closed form. Rotations are SciPy's.
"""

import json
import pathlib

import numpy as np
from scipy.spatial.transform import Rotation

BONES, VERTICES = 6, 40


def product(a, b):
    (aw, *av), (bw, *bv) = a, b
    av, bv = np.array(av), np.array(bv)
    return np.concatenate([[aw * bw - av @ bv], aw * bv + bw * av + np.cross(av, bv)])


def dual_quaternion(rotation, translation):
    x, y, z, w = rotation.as_quat()
    real = np.array([w, x, y, z])
    return np.stack([real, 0.5 * product(np.concatenate([[0.0], translation]), real)])


def matrix(dual):
    real, dual = dual / np.linalg.norm(dual[0])
    w, x, y, z = real
    rotation = np.array(
        [
            [1 - 2 * y * y - 2 * z * z, 2 * x * y - 2 * w * z, 2 * x * z + 2 * w * y],
            [2 * x * y + 2 * w * z, 1 - 2 * x * x - 2 * z * z, 2 * y * z - 2 * w * x],
            [2 * x * z - 2 * w * y, 2 * y * z + 2 * w * x, 1 - 2 * x * x - 2 * y * y],
        ]
    )
    dw, dx, dy, dz = dual
    translation = 2 * np.array(
        [-dw * x + dx * w - dy * z + dz * y, -dw * y + dx * z + dy * w - dz * x, -dw * z - dx * y + dy * x + dz * w]
    )
    return rotation, translation


def main():
    rng = np.random.default_rng(12)
    rotations = Rotation.from_rotvec(rng.uniform(-2.0, 2.0, (BONES, 3)))
    translations = rng.uniform(-1.0, 1.0, (BONES, 3))
    duals = np.array([dual_quaternion(r, t) for r, t in zip(rotations, translations)])
    positions = rng.uniform(-0.5, 0.5, (VERTICES, 3))
    normals = rng.normal(size=(VERTICES, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    joints = np.array([rng.permutation(BONES)[:4] for _ in range(VERTICES)])
    weights = -np.sort(-rng.dirichlet(np.ones(4), VERTICES), axis=1)
    linear, dual = [], []
    for p, n, js, ws in zip(positions, normals, joints, weights):
        axes = sum(w * rotations[j].as_matrix() for j, w in zip(js, ws))
        moved = axes @ n
        linear.append([(axes @ p + ws @ translations[js]).tolist(), (moved / np.linalg.norm(moved)).tolist()])
        signs = np.where(duals[js, 0] @ duals[js[0], 0] < 0, -1.0, 1.0)
        rotation, translation = matrix(np.einsum("i,ijk->jk", ws * signs, duals[js]))
        dual.append([(rotation @ p + translation).tolist(), (rotation @ n).tolist()])
    # The same rotations with other signs and lengths must give the same.
    quats = rotations.as_quat() * rng.choice([-1.0, 1.0], BONES)[:, None] * rng.uniform(0.5, 2.0, BONES)[:, None]
    golden = {
        "rotations": quats.tolist(),
        "translations": translations.tolist(),
        "positions": positions.tolist(),
        "normals": normals.tolist(),
        "joints": joints.tolist(),
        "weights": weights.tolist(),
        "linear": linear,
        "dual": dual,
    }
    path = pathlib.Path(__file__).with_name("skinning.json")
    path.write_text(json.dumps(golden, indent=1) + "\n")


main()
