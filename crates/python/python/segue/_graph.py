"""Motion graphs and the database of motion matching."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import Clip, Result
from ._labs import Value, _values


class Distances(NamedTuple):
    """The distances of all windows of some clips.

    Attributes
    ----------
    cm : ndarray of float32, shape (n, n)
        Root-mean-square distance of the joints of two windows after the best alignment over the
        ground, centimetres on a body of 1.75 m. Row and column are frames of all clips, one after
        the other, at which windows begin; NaN where a window would cross the end of its clip.
    starts : ndarray of int64, shape (clips,)
        The row of each clip's first frame.
    window : int
        The length of the windows, frames.
    """

    cm: NDArray[np.float32]
    starts: NDArray[np.int64]
    window: int

    def place(self, row: int) -> tuple[int, int]:
        """Return the clip of a row, and its frame there."""
        clip = int(np.searchsorted(self.starts, row, side="right")) - 1
        return clip, int(row - self.starts[clip])


def distance_matrix(clips: Sequence[Clip], *, window: int = 30) -> Distances:
    """Compare all windows of some clips with all others, on all cores.

    Parameters
    ----------
    clips : sequence of Clip
        Clips of other bodies or rates are put on the body of the first, at its frame rate.
    window : int
        The number of frames that are compared.

    Returns
    -------
    Distances
        The matrix ``cm``, and where each clip begins in it.
    """
    cm, starts = _core.distance_matrix(list(clips), window)
    return Distances(cm, np.array(starts, dtype=np.int64), window)


class Graph:
    """A motion graph: stretches of clips, and transitions where they are alike.

    Attributes
    ----------
    clips : list of str
        The names of the clips.
    stretches : ndarray of int64, shape (nodes, 3)
        Clip, first frame, one past the last frame.
    jumps : ndarray of int64, shape (transitions, 4)
        Clip and frame that are left, clip and frame that are entered.
    jump_distances : ndarray of float64, shape (transitions,)
        The distance of the two windows of each transition, centimetres on a body of 1.75 m.
    """

    def __init__(self, core: _core.Graph) -> None:
        self._core = core
        self.clips = core.clips
        self.stretches = core.stretches
        self.jumps = core.jumps
        self.jump_distances = core.jump_distances

    def walk(self, *, seconds: float = 60, seed: int = 1, **parameters: Value) -> Result:
        """Walk through the graph.

        Parameters
        ----------
        seconds : float
            The length of the walk: 10 to 600, in steps of 10.
        seed : int
            The same seed takes the same walk.
        **parameters
            Further parameters of the lab "graph", such as ``continuity=0.9``.

        Returns
        -------
        Result
            The motion of the walk, with its ``metrics``.
        """
        given: dict[str, Value] = {"walk_seconds": seconds, "seed": seed, **parameters}
        return self._core.walk(_values("graph", given))

    def __repr__(self) -> str:
        return repr(self._core)


def graph(clips: Sequence[Clip], *, threshold_cm: float = 8, **parameters: Value) -> Graph:
    """Build a motion graph.

    Parameters
    ----------
    clips : sequence of Clip
        Clips of other bodies or rates are put on the body of the first, at its frame rate.
    threshold_cm : float
        The greatest distance of a transition, centimetres on a body of 1.75 m: the parameter
        ``edge_threshold``.
    **parameters
        Further parameters of the lab "graph"; ``window`` is short for ``blend_window`` (frames).

    Returns
    -------
    Graph
    """
    given: dict[str, Value] = {"edge_threshold": threshold_cm, **parameters}
    return Graph(_core.graph(list(clips), _values("graph", given)))


class Hits(NamedTuple):
    """The frames of a database that are nearest to some queries.

    Attributes
    ----------
    clips, frames : ndarray of int64, shape (queries, k)
        The clip of each hit by its place in the list, and the frame there at 60 frames per second.
        Of a mirrored copy the frame is that of its original.
    mirrored : ndarray of bool, shape (queries, k)
        Whether the hit is in the mirrored copy of the clip.
    costs : ndarray of float32, shape (queries, k)
        The sum of squared, weighted differences of normalised features; rising.
    """

    clips: NDArray[np.int64]
    frames: NDArray[np.int64]
    mirrored: NDArray[np.bool_]
    costs: NDArray[np.float32]


class MatchDatabase:
    """The frames of clips with the features of motion matching.

    Attributes
    ----------
    features : ndarray of float32, shape (frames, dims)
        The features of all frames, normalised: ``(value - means) / scales``, rounded to 1/4096.
    means, scales : ndarray of float32, shape (dims,)
        Of the values in metres, metres per second, and unit vectors.
    places : ndarray of int64, shape (frames, 3)
        Clip, frame, and 1 in a mirrored copy.
    valid : ndarray of int64
        The frames that a search may find: those whose trajectory is known.
    blocks : list of (str, int, int)
        The parts of a row: name, first dimension, one past the last. All are in the character's
        frame: forward is +Z, left is +X.
    fps : int
        Frames per second of all frames: 60.
    """

    def __init__(self, core: _core.Matches) -> None:
        self._core = core
        self.features = core.features
        self.means = core.means
        self.scales = core.scales
        self.places = core.places
        self.valid = core.valid
        self.blocks = core.blocks
        self.fps = core.fps

    def __len__(self) -> int:
        return len(self._core)

    def normalise(self, rows: ArrayLike) -> NDArray[np.float32]:
        """Normalise rows of features in their own units, shape (rows, dims)."""
        return self._core.normalise(np.ascontiguousarray(rows, dtype=np.float32))

    def search(
        self, queries: ArrayLike, k: int = 1, *, weights: Sequence[float] | None = None
    ) -> Hits:
        """Find the frames nearest to queries, on all cores.

        Parameters
        ----------
        queries : array_like, shape (queries, dims) or (dims,)
            Normalised features: rows of ``features``, or made by `normalise`.
        k : int
            The number of frames for each query.
        weights : sequence of 5 floats, optional
            The weight of each of `blocks`, 0 to 100. The page's where none are given.

        Returns
        -------
        Hits
            The nearest first.
        """
        rows = np.atleast_2d(np.ascontiguousarray(queries, dtype=np.float32))
        if k < 1:
            raise ValueError(f"k: found {k}, expected 1 or more")
        weights = None if weights is None else [float(own) for own in weights]
        clips, frames, mirrored, costs = self._core.search(rows, k, weights)
        return Hits(clips, frames, mirrored.astype(bool), costs)


def match_database(
    clips: Sequence[Clip], *, mirrored: bool = True, trajectory: Sequence[float] | None = None
) -> MatchDatabase:
    """Build a database of motion matching.

    Parameters
    ----------
    clips : sequence of Clip
        Clips of other bodies are put on the body of the first; all are resampled to 60 frames per
        second.
    mirrored : bool
        Whether each clip is followed by its mirror image.
    trajectory : sequence of float, optional
        The times of the trajectory, seconds ahead, rising. A third, two thirds and one second
        where none are given.

    Returns
    -------
    MatchDatabase
    """
    return MatchDatabase(_core.match_database(list(clips), mirrored, None if trajectory is None else list(trajectory)))
