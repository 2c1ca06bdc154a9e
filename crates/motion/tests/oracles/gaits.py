"""Golden values for gaits by speed and for layers: `python3 tests/oracles/gaits.py` writes gaits.json beside it.

Nothing is shared with the program but the definitions: weight (v - v1)/(v2 - v1), stride as the weighted mean of strides, events mixed by the second
gait's share of the stride, phases linear between events (NumPy's interp over three cycles). A layer on top of a pose is
base * exp(w log(reference^-1 pose)), one in its place slerp(base, over, w); rotations are SciPy's.
"""

import json
import pathlib

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

WALK = {"speed": 1.4, "secs": 1.06, "left_lift": 0.61, "right_strike": 0.49, "right_lift": 1.11}
RUN = {"speed": 3.5, "secs": 0.72, "left_lift": 0.34, "right_strike": 0.52, "right_lift": 0.85}


def mixed(a, b, share):
    return (1 - share) * a + share * b


def phases(speed, ats):
    weight = np.clip((speed - WALK["speed"]) / (RUN["speed"] - WALK["speed"]), -0.25, 1.25)
    made = mixed(WALK["speed"], RUN["speed"], weight)
    strides = [gait["speed"] * gait["secs"] for gait in (WALK, RUN)]
    stride = mixed(*strides, weight)
    share = weight * strides[1] / stride
    events = {name: mixed(WALK[name], RUN[name], share) for name in ("left_lift", "right_strike")}
    stance = mixed(*[gait["right_lift"] - gait["right_strike"] for gait in (WALK, RUN)], share)
    events["right_lift"] = events["right_strike"] + stance

    def warped(gait, knots):
        of = lambda table: np.concatenate([np.array([table.get(knot, 0.0) for knot in knots]) + cycle for cycle in (-2, -1, 0, 1)])
        return np.interp(ats, of(events), of(gait)).tolist()

    parts = (["start", "right_strike"], ["start", "left_lift"], ["right_strike", "right_lift"])
    return {
        "speed": speed,
        "made": made,
        "weight": weight,
        "stride": stride,
        "secs": stride / made,
        "events": events,
        "walk": [warped(WALK, knots) for knots in parts],
        "run": [warped(RUN, knots) for knots in parts],
    }


def layers(rng):
    result = []
    for weight in [0.0, 0.3, 0.5, 1.0]:
        for _ in range(4):
            base, over, reference = [Rotation.from_rotvec(rng.uniform(-1.2, 1.2, 3)) for _ in range(3)]
            delta = (reference.inv() * over).as_rotvec()
            quat = lambda rotation: rotation.as_quat().tolist()
            result.append(
                {
                    "weight": weight,
                    "base": quat(base),
                    "over": quat(over),
                    "reference": quat(reference),
                    "additive": quat(base * Rotation.from_rotvec(weight * delta)),
                    "in_place": quat(Slerp([0, 1], Rotation.concatenate([base, over]))(weight)),
                }
            )
    return result


def main():
    ats = [0.0, 0.02, 0.2, 0.4, 0.5, 0.6, 0.9, 1.0, 1.3]
    speeds = [0.5, 1.2, 1.4, 1.9, 2.45, 3.1, 3.5, 3.8, 9.0]
    golden = {"walk": WALK, "run": RUN, "ats": ats, "speeds": [phases(speed, ats) for speed in speeds], "layers": layers(np.random.default_rng(4))}
    path = pathlib.Path(__file__).with_name("gaits.json")
    path.write_text(json.dumps(golden, indent=1) + "\n")


main()
