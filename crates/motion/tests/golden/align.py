"""Golden values for the ground-plane alignment of two point clouds: `python3 align.py` writes align.json.

Knows nothing of the closed form. The squared distance is minimised over (turn, x, z) by SciPy's least squares from several first guesses, on
residuals that are spelled out point by point.
"""

import json
import pathlib

import numpy as np
from scipy.optimize import least_squares


def laid(parameters, cloud):
    """The cloud turned about +Y by the first parameter, then shifted by the other two in x and z."""
    turn, x0, z0 = parameters
    rotation = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    return cloud @ rotation.T + np.array([x0, 0, z0])


def minimised(source, target, weights):
    def residuals(parameters):
        return (np.sqrt(weights)[:, None] * (source - laid(parameters, target))).ravel()

    fits = [
        least_squares(residuals, [turn, 0, 0], xtol=1e-15, ftol=1e-15, gtol=1e-15)
        for turn in np.linspace(-np.pi, np.pi, 12, endpoint=False)
    ]
    best = min(fits, key=lambda fit: fit.cost)
    turn, x0, z0 = best.x
    return (turn + np.pi) % (2 * np.pi) - np.pi, x0, z0, 2 * best.cost


def main():
    rng = np.random.default_rng(20)
    cases = []
    for frames, joints, turn, noise, away in [(1, 5, 0.3, 0.05, 1), (5, 7, 2.9, 0.1, 3), (12, 6, -1.8, 0.3, 40), (3, 9, -3.1, 0.6, 2), (4, 4, 1.2, 3.0, 1)]:
        joint_weights = rng.uniform(0.1, 2.0, joints)
        weights = np.tile(joint_weights, frames)
        # f32 inputs, as the program has them.
        target = (rng.normal(0, 0.6, (frames * joints, 3)) + rng.normal(0, away, 3)).astype(np.float32).astype(float)
        source = laid((turn, rng.normal(0, away), rng.normal(0, away)), target) + rng.normal(0, noise, target.shape)
        source = source.astype(np.float32).astype(float)
        yaw, x0, z0, distance = minimised(source, target, weights)
        cases.append(
            {
                "weights": joint_weights.tolist(),
                "source": source.tolist(),
                "target": target.tolist(),
                "yaw": yaw,
                "x0": x0,
                "z0": z0,
                "distance": distance,
            }
        )
    pathlib.Path(__file__).with_suffix(".json").write_text(json.dumps({"cases": cases}))


if __name__ == "__main__":
    main()
