"""Motion graphs, distances and the database of motion matching."""

import numpy as np
import pytest
import segue


@pytest.fixture(scope="module")
def clips():
    return [segue.builtin(name) for name in ("walk", "walk_left", "start", "stop")]


def test_distances_are_zero_for_the_same_motion_elsewhere(clips):
    moved = segue.view(clips[0], place_x=3.0, place_z=-2.0, place_heading=70.0)
    cm, starts, window = segue.distance_matrix([clips[0], moved], window=15)
    frames = clips[0].frames
    assert cm.shape == (2 * frames, 2 * frames) and window == 15
    np.testing.assert_array_equal(starts, [0, frames])
    windows = frames - 15 + 1
    inside = cm[:windows, :windows]
    assert np.isfinite(inside).all() and np.isnan(cm[windows:frames]).all()
    np.testing.assert_array_equal(inside, inside.T)
    assert np.diag(inside).max() < 1e-3
    # Distances do not depend on where a clip is on the ground, nor on its heading.
    across = cm[:windows, frames:frames + windows]
    assert np.diag(across).max() < 0.05
    np.testing.assert_allclose(across, inside, atol=0.05)
    assert inside.max() > 5


def test_distance_of_two_windows_is_that_of_the_best_alignment():
    # Two windows of one frame: the best turn about the vertical by SciPy, with the weights of the
    # set being those of the joints, is no better than the one that was found.
    from scipy.optimize import minimize

    walk = segue.builtin("walk")
    cm = segue.distance_matrix([walk], window=1).cm
    places = walk.global_positions().astype(float)
    a, b = places[10], places[25]

    def rms(x, weights=None):
        turn, shift = x[0], np.array([x[1], 0, x[2]])
        c, s = np.cos(turn), np.sin(turn)
        turned = b @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) + shift
        return np.sqrt(np.mean(np.sum((a - turned) ** 2, axis=1)))

    best = min((minimize(rms, [t, 0, 0], method="Nelder-Mead", options={"maxiter": 4000})
                for t in np.linspace(0, 2 * np.pi, 5)), key=lambda made: made.fun)
    scale = 175 / walk.body_height
    assert cm[10, 25] == pytest.approx(best.fun * scale, rel=0.25)


def test_graph_walks_by_its_seed(clips):
    graph = segue.graph(clips, threshold_cm=12, window=20)
    assert graph.clips and graph.stretches.shape[1] == 3 and len(graph.jumps) > 10
    assert (graph.jump_distances <= 12).all()
    walks = [graph.walk(seconds=20, seed=seed) for seed in (7, 7, 8)]
    assert walks[0].duration == pytest.approx(20, abs=4)
    np.testing.assert_array_equal(walks[0].rotations, walks[1].rotations)
    assert walks[0].query != walks[2].query
    assert walks[0].root.shape != walks[2].root.shape or (walks[0].root != walks[2].root).any()
    # Its link makes the same walk.
    again = segue.open_link(segue.link(walks[0]))
    np.testing.assert_array_equal(again.rotations, walks[0].rotations)
    assert "12 clips" not in repr(graph) and "4 clips" in repr(graph)


def test_distances_of_the_graph_are_those_of_the_matrix(clips):
    graph = segue.graph(clips, threshold_cm=12, window=20)
    cm, starts, _ = segue.distance_matrix(clips, window=20)
    jumps = graph.jumps
    found = cm[starts[jumps[:, 0]] + jumps[:, 1], starts[jumps[:, 2]] + jumps[:, 3]]
    np.testing.assert_allclose(found, graph.jump_distances, atol=2e-3)


def test_graph_without_transitions_says_what_to_change(clips):
    with pytest.raises(segue.LabError):
        segue.graph(clips[:1], threshold_cm=0.1)


def test_walk_is_that_of_the_program(files, program, tmp_path):
    clips = segue.load([files / "walk.bvh", files / "run.bvh"])
    graph = segue.graph(clips, threshold_cm=30)
    made = graph.walk(seconds=10, seed=7)
    words = ["--edge-threshold", "30", "--walk-seconds", "10", "--seed", "7"]
    program(files, "graph", "walk", "walk.bvh", "run.bvh", *words, "-o", tmp_path / "out.bvh")
    assert made.to_bytes("bvh") == (tmp_path / "out.bvh").read_bytes()


def test_search_is_that_of_numpy(clips):
    database = segue.match_database(clips)
    assert database.fps == 60 and len(database) == len(database.features) == len(database.places)
    assert database.blocks[0][:2] == ("TrajectoryPosition", 0)
    assert database.blocks[-1][2] == database.features.shape[1] == 27
    random = np.random.default_rng(7)
    rows = random.choice(database.valid, 20)
    queries = database.features[rows] + random.normal(0, 0.1, (20, 27)).astype(np.float32)
    hits = database.search(queries, k=5, weights=[1, 1, 1, 1, 1])
    every = database.features[database.valid]
    costs = ((every[None] - queries[:, None]) ** 2).sum(-1)
    np.testing.assert_allclose(hits.costs, np.sort(costs, axis=1)[:, :5], rtol=1e-4, atol=1e-5)
    best = database.places[database.valid[costs.argmin(axis=1)]]
    np.testing.assert_array_equal(best[:, 0], hits.clips[:, 0])
    np.testing.assert_array_equal(best[:, 1], hits.frames[:, 0])
    # A frame of the database is its own nearest neighbour.
    own = database.search(database.features[rows[0]])
    assert own.costs.shape == (1, 1) and own.costs[0, 0] == 0


def test_normalised_rows_are_those_of_the_database(clips):
    database = segue.match_database(clips, mirrored=False, trajectory=[0.5, 1.0])
    assert database.features.shape[1] == 23 and not database.places[:, 2].any()
    raw = database.features * database.scales + database.means
    np.testing.assert_allclose(database.normalise(raw), database.features, atol=2 / 4096)
    with pytest.raises(ValueError, match="expected .queries, 23."):
        database.search(np.zeros((2, 27)))
    with pytest.raises(ValueError, match="finite"):
        database.search(np.full(23, np.nan))
    with pytest.raises(segue.LabError, match="weight"):
        database.search(np.zeros(23), weights=[-1, 1, 1, 1, 1])
    with pytest.raises(ValueError, match="k: found 0"):
        database.search(np.zeros(23), k=0)
