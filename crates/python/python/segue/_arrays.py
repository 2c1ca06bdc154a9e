"""Clips of arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Clip


def from_arrays(
    *,
    names: Sequence[str],
    parents: ArrayLike,
    offsets: ArrayLike,
    rotations: ArrayLike,
    root: ArrayLike,
    fps: float,
    name: str = "clip",
) -> Clip:
    """Return a clip of arrays, such as those that a model has made.

    Parameters
    ----------
    names : sequence of str, length joints
        The joints, parents before children.
    parents : array_like of int, shape (joints,)
        The index of each joint's parent, -1 for the first joint alone.
    offsets : array_like, shape (joints, 3)
        The place of each joint in its parent at rest, metres.
    rotations : array_like, shape (frames, joints, 4)
        Rotations in the parent, unit quaternions w x y z.
    root : array_like, shape (frames, 3)
        The place of the first joint in the world, metres, Y up.
    fps : float
        Frames per second.
    name : str
        The clip's name.

    Returns
    -------
    Clip
        Its link names the file that ``clip.save(f"{name}.npz")`` writes.
    """
    places = _floats("offsets", offsets, 2)
    turns = _floats("rotations", rotations, 3)
    way = _floats("root", root, 2)
    indices = [int(own) for own in np.asarray(parents).ravel()]
    joints = [str(own) for own in names]
    return Clip._of_arrays(joints, indices, places, turns, way, float(fps), name)


def _floats(what: str, values: ArrayLike, axes: int) -> NDArray[np.float32]:
    made = np.ascontiguousarray(values, dtype=np.float32)
    if made.ndim != axes:
        raise ValueError(f"{what}: found {made.ndim} axes, expected {axes}")
    return made
