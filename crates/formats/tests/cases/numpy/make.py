"""Makes the files of this folder with NumPy, and for each the places of its joints in every frame by forward kinematics with SciPy's rotations:
what segue-formats must give. Written apart from the reader, with matrices in place of quaternions.

Run `python3 make.py` here, with numpy and scipy; it was run with 2.x and 1.x of them. `expected/NAME.f32` holds the places as little-endian floats
(frames, joints, 3), in metres with Y up.
"""

import pathlib
import pickle

import numpy as np
from scipy.spatial.transform import Rotation

FRAMES = 8
HERE = pathlib.Path(__file__).parent
chance = np.random.default_rng(20)

# The generic body of segue-formats (src/numpy/body.rs): parents and offsets of the joints that SMPL, SMPL-H and SMPL-X share.
PARENTS = [-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19]
OFFSETS = np.array(
    [
        [0, -0.22, 0.03], [0.06, -0.09, -0.01], [-0.06, -0.09, -0.01], [0, 0.11, -0.02], [0.04, -0.38, 0], [-0.04, -0.38, 0], [0, 0.13, 0],
        [-0.01, -0.4, -0.04], [0.01, -0.4, -0.04], [0, 0.06, 0.02], [0.03, -0.06, 0.12], [-0.03, -0.06, 0.12], [0, 0.21, -0.04],
        [0.07, 0.12, -0.02], [-0.07, 0.12, -0.02], [0, 0.09, 0.05], [0.12, 0.04, -0.02], [-0.12, 0.04, -0.02], [0.26, 0, -0.02],
        [-0.26, 0, -0.02], [0.25, 0, 0], [-0.25, 0, 0],
    ]
)  # fmt: skip
HANDS = [20, 22, 23, 20, 25, 26, 20, 28, 29, 20, 31, 32, 20, 34, 35, 21, 37, 38, 21, 40, 41, 21, 43, 44, 21, 46, 47, 21, 49, 50]
# +Z of the file is +Y of the result, and -Y is +Z.
Y_UP_FROM_Z_UP = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)


def smooth(*shape, size):
    """Values that change slowly from frame to frame."""
    phase = chance.uniform(0, 2 * np.pi, shape)
    pace = chance.uniform(0.1, 0.5, shape)
    return size * np.sin(phase + pace * np.arange(FRAMES).reshape(-1, *[1] * len(shape)))


def body_turns(joints):
    """Rotation vectors of a body that stands, most of them small."""
    return smooth(joints, 3, size=0.5)


def matrices(vectors):
    return Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix().reshape(*vectors.shape[:-1], 3, 3)


def places(parents, offsets, local, root):
    """Forward kinematics: places and rotations of all joints."""
    at, to = np.zeros((FRAMES, len(parents), 3)), np.zeros((FRAMES, len(parents), 3, 3))
    for joint, parent in enumerate(parents):
        if parent < 0:
            at[:, joint], to[:, joint] = root, local[:, joint]
        else:
            at[:, joint] = at[:, parent] + np.einsum("fij,j->fi", to[:, parent], offsets[joint])
            to[:, joint] = to[:, parent] @ local[:, joint]
    return at, to


def expect(name, positions):
    (HERE / "expected").mkdir(exist_ok=True)
    positions.astype("<f4").tofile(HERE / "expected" / f"{name}.f32")


def walk():
    """Translations along the ground of a world with Z up, in which the pelvis is at about 0.93 m."""
    path = smooth(3, size=0.03)
    path[:, 0] += 0.03 * np.arange(FRAMES)
    path[:, 2] += 0.9
    return path + [0, 0, 0.22]


def upright(turns):
    """The same with a root that stands a body with Y up on its feet where Z is up."""
    stand = Rotation.from_rotvec([np.pi / 2, 0, 0])
    turns = turns.copy()
    turns[:, 0] = (stand * Rotation.from_rotvec(0.3 * turns[:, 0])).as_rotvec()
    return turns


def model(name, joints, betas):
    """A body model with a mesh of a few vertices: its joints, and their change by the betas."""
    parents = PARENTS + [-1] * (joints - 22)
    vertices = 3 * joints
    regressor = np.zeros((joints, vertices))
    rest = np.zeros((joints, 3))
    for joint in range(joints):
        parent = parents[joint] if joint < 22 else (HANDS[joint - 22] if joints == 52 else 15)
        own = OFFSETS[joint] if joint < 22 else chance.normal(0, 0.03, 3)
        rest[joint] = own + (rest[parent] if joint else 0)
        regressor[joint, 3 * joint : 3 * joint + 3] = [0.25, 0.25, 0.5]
    template = np.repeat(rest, 3, 0) + chance.normal(0, 0.01, (vertices, 3))
    directions = chance.normal(0, 0.003, (vertices, 3, betas))
    np.savez_compressed(
        HERE / name,
        v_template=template,
        shapedirs=directions,
        J_regressor=regressor,
        kintree_table=np.zeros((2, joints), np.uint32),
        posedirs=np.zeros((vertices, 3, 1)),
        f=np.zeros((4, 3), np.uint32),
    )
    return lambda own: np.einsum("jv,vi->ji", regressor, template + directions[:, :, : len(own)] @ own)


def amass():
    joints_by = model("SMPLH_FEMALE.npz", 52, 16)
    betas = chance.normal(0, 1, 16)
    turns, path = upright(body_turns(52)), walk()
    np.savez_compressed(
        HERE / "amass.npz", poses=turns.reshape(FRAMES, 156), trans=path, betas=betas, gender="female", mocap_framerate=60.0,
        dmpls=np.zeros((FRAMES, 8)),
    )  # fmt: skip
    parents = PARENTS + HANDS
    rest = joints_by(betas)
    offsets = rest - np.array([rest[parent] if parent >= 0 else np.zeros(3) for parent in parents])
    at, _ = places(parents, offsets, matrices(turns), path + rest[0])
    expect("amass", at @ Y_UP_FROM_Z_UP.T)
    # Without the model: the bones of the generic body.
    at, _ = places(PARENTS, OFFSETS, matrices(turns[:, :22]), path + OFFSETS[0])
    expect("amass_generic", at @ Y_UP_FROM_Z_UP.T)


def stage_two():
    turns, path = upright(body_turns(55)), walk()
    flat = turns.reshape(FRAMES, 165)
    np.savez(
        HERE / "stageii.npz", root_orient=flat[:, :3], pose_body=flat[:, 3:66], pose_jaw=flat[:, 66:69], pose_eye=flat[:, 69:75],
        pose_hand=flat[:, 75:], trans=path, betas=np.zeros(16), gender="neutral", mocap_frame_rate=120, surface_model_type="smplx",
    )  # fmt: skip
    at, _ = places(PARENTS, OFFSETS, matrices(turns[:, :22]), path + OFFSETS[0])
    expect("stageii", at @ Y_UP_FROM_Z_UP.T)


def smpl():
    turns, path = upright(body_turns(24)), walk()
    poses = np.asfortranarray(turns.reshape(FRAMES, 72).astype(">f4"))
    np.savez(HERE / "smpl72.npz", poses=poses, trans=path.astype("<f4"), mocap_time_length=(FRAMES - 1) / 30)
    at, _ = places(PARENTS, OFFSETS, matrices(turns[:, :22]), path + OFFSETS[0])
    expect("smpl72", at @ Y_UP_FROM_Z_UP.T)


def kimodo():
    """SOMA with 30 joints, in a world with Y up."""
    parents = [-1, 0, 1, 2, 3, 4, 5, 6, 6, 6, 3, 10, 11, 12, 13, 13, 3, 16, 17, 18, 19, 19, 0, 22, 23, 24, 0, 26, 27, 28]
    offsets = chance.normal(0, 0.01, (30, 3))
    for joint in range(1, 7):
        offsets[joint, 1] += 0.1
    for first, side in ((10, 1), (16, -1)):
        offsets[first : first + 6, 0] += side * np.array([0.05, 0.1, 0.27, 0.25, 0.05, 0.15])
    for first, side in ((22, 1), (26, -1)):
        offsets[first, 0] += 0.1 * side
        offsets[first : first + 3, 1] -= [0.05, 0.42, 0.41]
        offsets[first + 3, 2] += 0.15
    root = smooth(3, size=0.03) + [0, 0.95, 0]
    turns = body_turns(30)
    turns[:, 0] *= 0.3
    at, to = places(parents, offsets, matrices(turns), root)
    np.savez(
        HERE / "soma30.npz", posed_joints=at.astype("f4"), global_rot_mats=to.astype("f4"), foot_contacts=np.zeros((FRAMES, 4), bool)
    )
    np.savez(HERE / "soma30_local.npz", posed_joints=at[None], local_rot_mats=matrices(turns)[None], fps=24)
    expect("soma30", at)
    expect("soma30_local", at)


def features():
    """The 272 values of a frame, by their definition."""
    turns = body_turns(22)
    turns[:, 0] *= 0.3
    root = smooth(3, size=0.05) + [0, 0.93, 0]
    local = matrices(turns)
    at, _ = places(PARENTS, OFFSETS, local, root)
    expect("humanml272", at)
    yaw = smooth(1, size=1.2)[:, 0]
    heading = matrices(np.stack([0 * yaw, yaw, 0 * yaw], 1))
    rows = np.zeros((FRAMES, 272), "f4")
    before, place_before = np.eye(3), np.zeros(3)
    for frame in range(FRAMES):
        velocity = before @ (root[frame] - place_before)
        step = heading[frame] @ before.T
        over_origin = at[frame] - root[frame] * [1, 0, 1]
        no_heading = over_origin @ heading[frame].T
        own = local[frame].copy()
        own[0] = heading[frame] @ own[0]
        rows[frame, :2] = velocity[[0, 2]]
        rows[frame, 2:8] = step[:2].ravel()
        rows[frame, 8:74] = no_heading.ravel()
        rows[frame, 140:272] = own[:, :2].ravel()
        before, place_before = heading[frame], root[frame]
    np.save(HERE / "humanml272.npy", rows)
    np.save(HERE / "normalised272.npy", (rows - rows.mean(0)) / (rows.std(0) + 0.01))


def plain():
    """Rotations alone: the body stands in its place, with its feet on the ground."""
    turns = body_turns(24)
    turns[:, 0] *= 0.3
    local = matrices(turns)
    rest = np.zeros((22, 3))
    for joint, parent in enumerate(PARENTS):
        rest[joint] = (rest[parent] + OFFSETS[joint]) if parent >= 0 else 0
    at, _ = places(PARENTS, OFFSETS, local[:, :22], np.tile([0, -rest[:, 1].min(), 0], (FRAMES, 1)))
    xyzw = Rotation.from_rotvec(turns.reshape(-1, 3)).as_quat().reshape(FRAMES, 24, 4)
    np.save(HERE / "xyzw.npy", xyzw)
    np.save(HERE / "wxyz.npy", xyzw[..., [3, 0, 1, 2]].astype("f4"))
    np.save(HERE / "matrices.npy", local)
    np.save(HERE / "six.npy", local[:, :, :2].reshape(FRAMES, 24, 6).astype("<f2"))
    np.save(HERE / "vectors.npy", turns)
    for name in ("xyzw", "wxyz", "matrices", "six", "vectors"):
        expect(name, at)


def pickles():
    """The dictionary that MDM saves with a mesh, in every protocol."""
    turns = body_turns(24)
    turns[:, 0] *= 0.3
    local, root = matrices(turns), smooth(3, size=0.03) + [0, 1.15, 0]
    six = local[:, :, :2].reshape(FRAMES, 24, 6)
    data = {
        "thetas": np.ascontiguousarray(six.transpose(1, 2, 0)).astype("f4"),
        "root_translation": root.T.astype("f4"),
        "text": ["a person turns", "人"],
        "length": np.int64(FRAMES),
        "num_samples": 1,
        "anything": complex(1, 2),
    }
    at, _ = places(PARENTS, OFFSETS, local[:, :22], root + OFFSETS[0])
    for protocol in range(6):
        name = f"pickle{protocol}"
        with open(HERE / f"{name}.pkl", "wb") as file:
            pickle.dump(data, file, protocol)
        expect(name, at)
    np.save(HERE / "dictionary.npy", np.array(data, dtype=object), allow_pickle=True)
    expect("dictionary", at)


def points():
    """Places of joints alone, and the dictionary that MDM saves with them."""
    samples = []
    for name in ("joints22", "joints22_z_up"):
        turns = body_turns(22)
        turns[:, 0] *= 0.3
        at, _ = places(PARENTS, OFFSETS, matrices(turns), smooth(3, size=0.05) + [0, 0.93, 0])
        np.save(HERE / f"{name}.npy", (at @ Y_UP_FROM_Z_UP if name.endswith("z_up") else at).astype("f4"))
        expect(name, at)
        samples.append(at.transpose(1, 2, 0).astype("f4"))
    results = {"motion": np.array(samples), "text": ["one", "two"], "lengths": np.array([FRAMES, 5]), "num_samples": 2, "num_repetitions": 1}
    np.save(HERE / "results.npy", np.array(results, dtype=object), allow_pickle=True)


amass()
stage_two()
smpl()
kimodo()
features()
plain()
pickles()
points()
