"""Clips and tools that the tests share."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
import segue

ROOT = Path(__file__).resolve().parents[3]
SAMPLES = ROOT / "assets" / "samples"


@pytest.fixture(scope="session")
def takes():
    """Return the folder of the bundled takes."""
    return SAMPLES


@pytest.fixture(scope="session")
def take():
    """Return a captured walk."""
    return segue.load(SAMPLES / "16_15.bvh.gz")


@pytest.fixture(scope="session")
def walk():
    """Return a synthesised walk."""
    return segue.builtin("walk")


@pytest.fixture(scope="session")
def run():
    """Return a synthesised run."""
    return segue.builtin("run")


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    """Return a folder with a walk and a run as BVH."""
    folder = tmp_path_factory.mktemp("clips")
    segue.builtin("walk").save(folder / "walk.bvh")
    segue.builtin("run").save(folder / "run.bvh")
    return folder


@pytest.fixture(scope="session")
def program():
    """Return a function that runs the command line in a folder."""
    path = os.environ.get("SEGUE_PROGRAM")
    if not path:
        pytest.fail("SEGUE_PROGRAM must name the program `segue`: use `cargo xtask test python`")

    def run(folder, *words):
        made = subprocess.run([path, *map(str, words)], cwd=folder, capture_output=True, text=True)
        assert made.returncode == 0, made.stderr
        return made.stdout

    return run


def rotated(quats, vectors):
    """Rotate vectors by quaternions w x y z, in double precision."""
    w, xyz = quats[..., :1], quats[..., 1:]
    twice = 2 * np.cross(xyz, vectors)
    return vectors + w * twice + np.cross(xyz, twice)


def multiplied(a, b):
    """Multiply quaternions w x y z."""
    w = a[..., :1] * b[..., :1] - np.sum(a[..., 1:] * b[..., 1:], axis=-1, keepdims=True)
    xyz = a[..., :1] * b[..., 1:] + b[..., :1] * a[..., 1:] + np.cross(a[..., 1:], b[..., 1:])
    return np.concatenate([w, xyz], axis=-1)


def kinematics(clip):
    """Compute places and rotations in the world by the definition, in double precision."""
    rotations = clip.rotations.astype(np.float64)
    offsets = clip.offsets.astype(np.float64)
    moves = clip.translations
    places, turns = np.zeros((*rotations.shape[:2], 3)), np.zeros(rotations.shape)
    for joint, parent in enumerate(clip.parents):
        if parent < 0:
            places[:, joint], turns[:, joint] = clip.root, rotations[:, joint]
            continue
        offset = moves[joint] if joint in moves else offsets[joint]
        offset = np.broadcast_to(offset, (len(clip), 3))
        places[:, joint] = places[:, parent] + rotated(turns[:, parent], offset)
        turns[:, joint] = multiplied(turns[:, parent], rotations[:, joint])
    return places, turns
