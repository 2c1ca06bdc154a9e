"""Golden values for artefacts of whole motions: `python3 tests/oracles/artefacts.py` writes artefacts.json beside it.

Nothing is shared with the program but the definitions. Bundled takes are read here, some are changed by a stated artefact, and each is measured beside
its sources (lengths on a body whose joints and end sites span 1.7 m at the median):

    flash      a joint's local rotation changes faster than twice the sources' 99.9th percentile for that joint (of sources with as many joints; its own
               where there are none), and by more than 2 degrees in a frame. Frames with no more than three between them are one flash.
    spin       the line from the right hip joint to the left one turns by more than 30 degrees, and more than twice what any source turns, in 0.2 s.
    root jump  a step in which the root is faster than twice the sources' 99.9th percentile.
    stance     a run of at least 0.1 s in which the toe (the ankle without one) is within 4 cm of the 5th percentile of its heights, at a median speed
               over the ground below 0.6 m/s; it slides by the diagonal of the box about the middle three fifths of its way.
    skating    the mean over frames and feet of |v| (2 - 2^(h / 2.5 cm)) for heights h below 2.5 cm above the 2nd percentile (Zhang et al. 2018).

The takes' first row is left out where it is a T-pose, as the program's reader does.
"""

import gzip
import json
import pathlib

import numpy as np
from scipy.spatial.transform import Rotation

HERE = pathlib.Path(__file__).parent
SAMPLES = HERE.parent.parent / "assets" / "samples"
# Rows left out, hip joints, toes.
TAKES = {
    "01_01": (1, ("LeftUpLeg", "RightUpLeg"), ("LeftToeBase", "RightToeBase")),
    "run": (1, ("LeftUpLeg", "RightUpLeg"), ("LeftToeBase", "RightToeBase")),
    "pirouette": (1, ("lThigh", "rThigh"), ("lFoot", "rFoot")),
}


class Motion:
    """Joints with parents and offsets; local rotations (frames, joints, 3, 3); root positions (frames, 3)."""

    def __init__(self, take):
        skipped, self.hips, self.toes = TAKES[take]
        words = gzip.open(SAMPLES / f"{take}.bvh.gz", "rt").read().split()
        self.names, self.parents, self.offsets, channels = [], [], [], []
        open_joints, ends = [], []
        at = 0
        while words[at] != "MOTION":
            word = words[at]
            if word in ("ROOT", "JOINT"):
                self.names.append(words[at + 1])
                self.parents.append(open_joints[-1] if open_joints else None)
                current = ("joint", len(self.names) - 1)
            elif word == "End":
                current = ("end", open_joints[-1])
            elif word == "{":
                open_joints.append(current[1])
            elif word == "}":
                open_joints.pop()
            elif word == "OFFSET":
                offset = np.array(words[at + 1 : at + 4], float)
                (self.offsets if current[0] == "joint" else ends).append(offset if current[0] == "joint" else (current[1], offset))
            elif word == "CHANNELS":
                channels += [(current[1], channel) for channel in words[at + 2 : at + 2 + int(words[at + 1])]]
            at += 1
        self.ends = ends
        frames = int(words[at + 2])
        self.dt = float(words[at + 5])
        rows = np.array(words[at + 6 :], float).reshape(frames, len(channels))[skipped:]
        self.local = np.tile(np.eye(3), (len(rows), len(self.names), 1, 1))
        self.root = np.zeros((len(rows), 3))
        for column, (joint, channel) in enumerate(channels):
            axis = "XYZ".index(channel[0])
            if channel.endswith("position"):
                assert joint == 0
                self.root[:, axis] = rows[:, column]
            else:
                self.local[:, joint] @= Rotation.from_rotvec(np.radians(rows[:, column])[:, None] * np.eye(3)[axis]).as_matrix()

    def places(self):
        positions, turns = [], []
        for joint, (parent, offset) in enumerate(zip(self.parents, self.offsets)):
            if parent is None:
                positions.append(self.root.copy())
                turns.append(self.local[:, joint])
            else:
                positions.append(positions[parent] + turns[parent] @ offset)
                turns.append(turns[parent] @ self.local[:, joint])
        tips = [positions[joint] + turns[joint] @ offset for joint, offset in self.ends]
        return np.array(positions), np.array(positions + tips)

    def height(self):
        heights = self.places()[1][:, :, 1]
        return np.median(heights.max(0) - heights.min(0))

    def changed(self, kind, frame=0, joint=None, amount=0.0):
        """Turns a joint by `amount` degrees about X from a frame on; turns the root by so much about the world's Y in the 12 frames behind one; moves
        the root along X by so many body heights from a frame on; or pulls it along X by so many body heights per second."""
        frames = np.arange(len(self.root))
        if kind == "flash":
            self.local[frame:, self.names.index(joint)] @= Rotation.from_euler("X", amount, degrees=True).as_matrix()
        elif kind == "spin":
            share = np.clip((frames - frame) / 12, 0, 1)
            self.local[:, 0] = Rotation.from_euler("Y", share[:, None] * amount, degrees=True).as_matrix() @ self.local[:, 0]
        elif kind == "jump":
            self.root[frame:, 0] += amount * self.height()
        elif kind == "pull":
            self.root[:, 0] += amount * self.height() * frames * self.dt
        return self


def measured(motion):
    size = 1.7 / motion.height()
    joints, _ = motion.places()
    joint = lambda name: joints[motion.names.index(name)] * size
    relative = np.einsum("fjki,fjkl->fjil", motion.local[:-1], motion.local[1:])
    angles = np.degrees(Rotation.from_matrix(relative.reshape(-1, 3, 3)).magnitude()).reshape(relative.shape[:2])
    left, right = (joint(name) for name in motion.hips)
    heading = np.unwrap(np.arctan2((left - right)[:, 0], (left - right)[:, 2]))
    window = max(1, round(0.2 / motion.dt))
    stances, skating = [], []
    for name in motion.toes:
        way = joint(name)
        ground, heights = way[:, [0, 2]], way[:, 1]
        speed = np.concatenate([[0], np.linalg.norm(np.diff(ground, axis=0), axis=1) / motion.dt])
        low = np.concatenate([[False], heights < np.percentile(heights, 5) + 0.04, [False]])
        for start, end in zip(*(np.flatnonzero(np.diff(low.astype(int)) == step) for step in (1, -1))):
            if (end - start) * motion.dt >= 0.1 and np.median(speed[start:end]) < 0.6:
                edge = (end - start) // 5
                part = ground[start + edge : end - edge]
                stances.append(100 * np.linalg.norm(part.max(0) - part.min(0)))
        above = heights - np.percentile(heights, 2)
        skating.append(100 * np.mean(np.where(above < 0.025, 2 - 2 ** (np.maximum(above, 0) / 0.025), 0) * speed))
    return {
        "frame_deg": angles,
        "dps": angles / motion.dt,
        "mps": np.linalg.norm(np.diff(motion.root, axis=0), axis=1) * size / motion.dt,
        "turned": np.degrees(np.abs(heading[window:] - heading[:-window])),
        "stances": stances,
        "skating": np.mean(skating),
    }


def artefacts(motion, sources):
    of, beside = measured(motion), [measured(source) for source in sources]
    alike = [source for source in beside if source["dps"].shape[1] == of["dps"].shape[1]] or [of]
    rare = np.max([np.percentile(source["dps"], 99.9, axis=0) for source in alike], axis=0)
    flashing = np.flatnonzero(((of["dps"] > 2 * rare + 1e-6) & (of["frame_deg"] > 2)).any(axis=1))
    fast = max(np.percentile(source["mps"], 99.9) for source in beside)
    turned = max(30, 2 * max(source["turned"].max() for source in beside))
    spinning = np.concatenate([[0], (of["turned"] > turned).astype(int)])
    return {
        "frames": len(motion.root),
        "flashes": int((np.diff(flashing, prepend=-100) > 3).sum()),
        "spins": int((np.diff(spinning) == 1).sum()),
        "root_jumps": int((of["mps"] > 2 * fast + 1e-6).sum()),
        "max_turn_deg": float(of["turned"].max()),
        "stances": len(of["stances"]),
        "stance_median_cm": float(np.median(of["stances"])) if of["stances"] else None,
        "stance_p90_cm": float(np.percentile(of["stances"], 90)) if of["stances"] else None,
        "skating_cm_per_sec": float(of["skating"]),
    }


CASES = [
    ("01_01", ["01_01"], None),
    ("run", ["run"], None),
    ("pirouette", ["pirouette"], None),
    ("run", ["01_01"], None),
    ("01_01", ["run"], None),
    ("pirouette", ["01_01", "run"], None),
    ("01_01", ["01_01"], {"kind": "flash", "frame": 900, "joint": "LeftForeArm", "amount": 70.0}),
    ("01_01", ["run", "01_01"], {"kind": "flash", "frame": 2000, "joint": "Spine1", "amount": 25.0}),
    ("01_01", ["01_01"], {"kind": "spin", "frame": 300, "amount": 170.0}),
    ("run", ["run"], {"kind": "spin", "frame": 20, "amount": -110.0}),
    ("01_01", ["01_01"], {"kind": "jump", "frame": 1500, "amount": 0.2}),
    ("pirouette", ["pirouette"], {"kind": "jump", "frame": 200, "amount": 0.1}),
    ("01_01", ["01_01"], {"kind": "pull", "amount": 0.05}),
    ("pirouette", ["pirouette"], {"kind": "pull", "amount": 0.2}),
]

if __name__ == "__main__":
    made = []
    for take, sources, change in CASES:
        motion = Motion(take)
        if change:
            motion.changed(**change)
        numbers = artefacts(motion, [Motion(source) for source in sources])
        made.append({"take": take, "sources": sources, "change": change, "numbers": numbers})
        print(take, sources, change, numbers)
    pathlib.Path(HERE / "artefacts.json").write_text(json.dumps(made, indent=1) + "\n")
