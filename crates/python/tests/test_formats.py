"""Every format that is written is read again, and BVH by others."""

import numpy as np
import pytest
import segue
from conftest import kinematics, multiplied, rotated

# BVH has angles as text, FBX as degrees in single precision, VRMA joints of its own.
FORMATS = [("bvh", 1e-5), ("fbx", 1e-4), ("glb", 1e-5), ("npz", 0.0), ("vrma", 1e-4)]


@pytest.mark.parametrize(("ending", "tolerance"), FORMATS)
def test_written_file_is_read_again(ending, tolerance, tmp_path, walk):
    path = walk.save(tmp_path / f"walk.{ending}")
    assert path == tmp_path / f"walk.{ending}"
    again = segue.load(path)
    assert again.frames == walk.frames and again.fps == pytest.approx(walk.fps, rel=1e-6)
    ours, theirs = walk.global_positions(), again.global_positions()
    pairs = [(walk.names.index(walk.roles[role]), again.names.index(again.roles[role]))
             for role in walk.roles if role in again.roles]
    assert len(pairs) > 12
    own, other = zip(*pairs)
    # VRMA has no place on the ground of its own; the file's first root is that of the clip.
    assert np.abs(ours[:, own] - theirs[:, other]).max() <= tolerance
    assert walk.to_bytes(ending) == path.read_bytes()


def test_captured_take_is_the_same_in_every_format(tmp_path, take):
    for ending, tolerance in FORMATS[:4]:
        again = segue.load(take.save(tmp_path / f"take.{ending}"))
        assert again.names == take.names
        apart = np.abs(again.global_positions() - take.global_positions()).max()
        assert apart <= max(tolerance, 0.0), (ending, apart)


def test_table_has_a_row_for_each_frame(tmp_path, walk):
    rows = walk.save(tmp_path / "walk.csv").read_text().splitlines()
    assert len(rows) == walk.frames + 1
    with pytest.raises(segue.WriteError):
        walk.save(tmp_path / "walk.csv", format="g1")


def test_options_of_writing(tmp_path, take):
    path = take.save(tmp_path / "take.bvh", unit="m", up="z", fps=30)
    again = segue.load(path)
    assert (again.unit, again.up, round(again.fps)) == ("m", "z", 30)
    still = segue.load(take.save(tmp_path / "still.bvh", root="in-place"))
    assert np.ptp(still.root[:, [0, 2]], axis=0).max() < 0.3 < np.ptp(take.root[:, 2])
    for wrong in ({"format": "max"}, {"root": "up"}, {"body": "fat"}, {"unit": -1}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            take.save(tmp_path / "x.bvh", **wrong)
    with pytest.raises(ValueError, match="end the path in it"):
        take.save(tmp_path / "x")
    with pytest.raises(FileNotFoundError):
        take.save(tmp_path / "none" / "x.bvh")


def test_npz_is_read_by_numpy_alone(tmp_path, take):
    with np.load(take.save(tmp_path / "take.npz")) as arrays:
        assert float(arrays["fps"]) == take.fps
        joints = len(take.names)
        np.testing.assert_array_equal(arrays["rotations"][:, -joints:], take.rotations)


@pytest.fixture(scope="module")
def bvh(tmp_path_factory, take):
    """Return a BVH file in metres with Y up, and its clip.

    All joints move, and so have channels: the others do not read a joint without any, as some of
    the takes of CMU are.
    """
    angle = 0.02 * np.sin(np.arange(take.frames) / 9)[:, None]
    sway = np.stack([np.cos(angle), np.sin(angle), 0 * angle, 0 * angle], axis=-1)
    moving = segue.from_arrays(
        names=take.names, parents=take.parents, offsets=take.offsets,
        rotations=multiplied(take.rotations.astype(float), sway), root=take.root, fps=take.fps)
    path = moving.save(tmp_path_factory.mktemp("others") / "take.bvh", unit="m", up="y")
    return path, segue.load(path, unit="m", up="y")


def compare(clip, names, places):
    own = clip.global_positions()[:, [clip.names.index(name) for name in names]]
    assert own.shape == places.shape and len(names) == len(clip.names)
    apart = np.abs(own - places).max()
    assert apart < 1e-5, apart


def test_bvh_is_that_of_bvhio(bvh):
    import bvhio

    path, clip = bvh
    root = bvhio.readAsHierarchy(str(path))
    joints = [joint for joint, *_ in root.layout()]
    some = range(0, clip.frames, 37)
    places = []
    for frame in some:
        root.loadPose(frame)
        places.append([[*joint.PositionWorld] for joint in joints])
    own = clip.global_positions()[list(some)]
    own = own[:, [clip.names.index(joint.Name) for joint in joints]]
    assert np.abs(own - np.array(places)).max() < 1e-5


def test_bvh_is_that_of_pymotion(bvh):
    from pymotion.io.bvh import BVH
    from pymotion.ops.skeleton import fk

    path, clip = bvh
    file = BVH()
    file.load(str(path))
    turns, moves, parents, offsets, *_ = file.get_data()
    places, _ = fk(turns, moves[:, 0], offsets, parents)
    compare(clip, list(file.data["names"]), places)


def test_bvh_is_that_of_pybvh(bvh):
    import pybvh

    path, clip = bvh
    file = pybvh.read_bvh_file(path)
    places = file.joint_positions()
    names = sorted(file.joint_index, key=file.joint_index.get)
    compare(clip, names, places)


def test_definition_of_kinematics_is_that_of_scipy(take):
    from scipy.spatial.transform import Rotation

    # The oracle of the other tests, by other means.
    rotations = take.rotations.astype(float)
    rotations /= np.linalg.norm(rotations, axis=-1, keepdims=True)
    a, b = rotations[5], rotations[9]
    of = lambda quats: Rotation.from_quat(np.roll(quats, -1, axis=-1))
    np.testing.assert_allclose((of(a) * of(b)).as_matrix(), of(multiplied(a, b)).as_matrix(),
                               atol=1e-12)
    vectors = take.offsets.astype(float)
    np.testing.assert_allclose(of(a).apply(vectors), rotated(a, vectors), atol=1e-12)
    assert kinematics(take)[0].shape == (take.frames, len(take.names), 3)
