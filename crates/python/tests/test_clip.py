"""Clips as arrays, against NumPy and SciPy."""

import numpy as np
import pytest
import segue
from conftest import kinematics

CLIPS = ["take", "walk", "run"]


@pytest.mark.parametrize("name", CLIPS)
def test_arrays_have_the_documented_shapes(name, request):
    clip = request.getfixturevalue(name)
    frames, joints = clip.frames, len(clip.names)
    assert len(clip) == frames > 1 and joints > 10
    assert clip.root.shape == (frames, 3) and clip.root.dtype == np.float32
    assert clip.rotations.shape == (frames, joints, 4) and clip.rotations.dtype == np.float32
    assert clip.offsets.shape == (joints, 3) and clip.parents.shape == (joints,)
    assert clip.parents[0] == -1
    assert (clip.parents[1:] >= 0).all() and (clip.parents[1:] < np.arange(1, joints)).all()
    assert clip.duration == pytest.approx((frames - 1) / clip.fps)
    np.testing.assert_allclose(np.linalg.norm(clip.rotations, axis=-1), 1, atol=1e-5)
    # A body of human size that stands upright, in metres.
    assert 1.2 < clip.body_height < 2.2
    assert 0.5 < np.median(clip.root[:, 1]) < 1.3


@pytest.mark.parametrize("name", CLIPS)
def test_global_positions_are_those_of_numpy(name, request):
    clip = request.getfixturevalue(name)
    places, turns = kinematics(clip)
    made = clip.global_positions()
    assert made.shape == places.shape and made.dtype == np.float32 and made.flags.writeable
    np.testing.assert_allclose(made, places, atol=1e-5)
    same = np.abs(np.sum(clip.global_rotations() * turns, axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-5)


def test_arrays_of_attributes_are_made_once_and_read_only(take):
    for name in ("root", "rotations", "offsets", "parents"):
        array = getattr(take, name)
        assert array is getattr(take, name), name
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_as_scipy_is_the_same_rotations(take):
    from scipy.spatial.transform import Rotation

    made = take.as_scipy()
    assert isinstance(made, Rotation) and len(made) == take.rotations[..., 0].size
    # Rotated vectors are the same, so the order of components is.
    vector = np.array([0.3, -1.0, 2.0])
    turned = made[:len(take.names)].apply(vector)
    by_hand = Rotation.from_quat(np.roll(take.rotations[0], -1, axis=-1)).apply(vector)
    np.testing.assert_allclose(turned, by_hand, atol=1e-6)


def test_clip_of_arrays_is_the_clip(take):
    made = segue.from_arrays(
        names=take.names,
        parents=take.parents,
        offsets=take.offsets,
        rotations=take.rotations.astype(np.float64),
        root=take.root,
        fps=take.fps,
        name="copy",
    )
    assert (made.name, made.names, made.fps) == ("copy", take.names, take.fps)
    np.testing.assert_allclose(made.global_positions(), take.global_positions(), atol=1e-5)
    assert made.roles == take.roles


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"root": np.zeros((5, 2))}, "root: found shape"),
        ({"rotations": np.zeros((4, 3))}, "rotations: found 2 axes"),
        ({"rotations": np.zeros((5, 2, 4))}, "unit quaternions"),
        ({"offsets": np.full((2, 3), np.nan)}, "offsets: expected finite"),
        ({"parents": [-1]}, "parents: found shape"),
        ({"parents": [-1, -1]}, "without a parent"),
        ({"fps": 0.0}, "frame rate"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(change, reason):
    turns = np.zeros((5, 2, 4))
    turns[..., 0] = 1
    fine = {
        "names": ["hips", "head"],
        "parents": [-1, 0],
        "offsets": np.array([[0, 0, 0], [0, 1, 0]]),
        "rotations": turns,
        "root": np.zeros((5, 3)),
        "fps": 30,
    }
    assert len(segue.from_arrays(**fine)) == 5
    with pytest.raises(ValueError, match=reason):
        segue.from_arrays(**{**fine, **change})


def test_contacts_and_metrics_are_plausible(walk, run):
    planted = segue.contacts(walk)
    assert planted.shape == (len(walk), 2) and planted.dtype == bool
    # A walk has a foot on the ground at all times, and each for more than half of the time.
    assert planted.any(axis=1).mean() > 0.95
    assert (planted.mean(axis=0) > 0.5).all() and (planted.mean(axis=0) < 0.75).all()
    # A run is in the air between steps.
    assert (~segue.contacts(run).any(axis=1)).mean() > 0.1
    numbers = segue.metrics(walk)
    assert set(numbers) <= set(segue.METRICS)
    assert 0 <= numbers["skating_cmps"] < 3
    assert segue.metrics([walk, run]) == [numbers, segue.metrics(run)]
    assert segue.METRICS["skating_cmps"]["unit"] == "cm/s"


def test_speed_of_a_planted_foot_is_low(walk):
    foot = walk.names.index(walk.roles["left foot"])
    places = walk.global_positions()[:, foot]
    speed = np.linalg.norm(np.gradient(places, 1 / walk.fps, axis=0)[:, [0, 2]], axis=1)
    planted = walk.contacts()[:, 0]
    assert np.median(speed[planted]) < 0.1 < 1.0 < np.median(speed[~planted])
