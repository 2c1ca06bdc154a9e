"""Labs: the same bytes as the command line, links that make the same result, and refusals."""

import numpy as np
import pytest
import segue

LABS = [
    ("blend", lambda a, b: segue.blend(a, b, window=24), ["--blend-window", "24"], 2),
    ("transition", lambda a, b: segue.transition(a, b, method="quintic", blend_time=0.5),
     ["--method", "quintic", "--blend-time", "0.5"], 2),
    ("transition", lambda a, b: segue.transition(a, b, method="inertialize", half_life=0.2),
     ["--method", "inertialize", "--half-life", "0.2"], 2),
    ("register", lambda a, b: segue.register([a, b], weight=0.25), ["--warp-weight", "0.25"], 2),
    ("layers", lambda a, b: segue.layers(a, b, mask="right_arm"), ["--mask", "right_arm"], 2),
    ("speed", lambda a, b: segue.speed(a, b, speed=2.2), ["--speed", "2.2"], 2),
    ("clean", lambda a, b: segue.clean(a), [], 1),
    ("loop", lambda a, b: segue.loop(a, loop_method="both"), ["--loop-method", "both"], 1),
    ("edit", lambda a, b: segue.edit(a, edit_from=0.5, edit_to=2, mirror=True),
     ["--edit-from", "0.5", "--edit-to", "2", "--mirror", "on"], 1),
    ("in-place", lambda a, b: segue.in_place(a), [], 1),
    ("path", lambda a, b: segue.path(a, path_smoothing=1), ["--path-smoothing", "1"], 1),
    ("view", lambda a, b: segue.view(a, foot_lock=True), ["--foot-lock", "on"], 1),
]


@pytest.fixture(scope="module")
def pair(files):
    return segue.load([files / "walk.bvh", files / "run.bvh"])


@pytest.mark.parametrize(("lab", "make", "options", "clips"), LABS, ids=lambda own: str(own)[:12])
def test_result_is_that_of_the_program(lab, make, options, clips, files, pair, program, tmp_path):
    made = make(*pair)
    names = ["walk.bvh", "run.bvh"][:clips]
    out = program(files, lab, *names, "-o", tmp_path / "out.bvh", *options, "--print-link")
    assert made.to_bytes("bvh") == (tmp_path / "out.bvh").read_bytes()
    # The same link, and the same result of it here, whatever the order of the files.
    link = segue.link(made)
    assert link == out.splitlines()[-1]
    again = segue.open_link(link, pair[:clips][::-1])
    np.testing.assert_array_equal(again.rotations, made.rotations)
    np.testing.assert_array_equal(again.root, made.root)
    assert segue.link(again) == link
    assert again.metrics == made.metrics


def test_retarget_is_that_of_the_program(files, pair, program, tmp_path, take):
    take.save(files / "take.bvh")
    body = segue.load(files / "take.bvh")
    made = segue.retarget(pair[0], body, foot_lock=True)
    words = ["walk.bvh", "--body", "take.bvh", "--foot-lock", "on", "-o", tmp_path / "out.bvh"]
    program(files, "retarget", *words)
    assert made.to_bytes("bvh") == (tmp_path / "out.bvh").read_bytes()
    assert made.names == take.names and made.frames == pair[0].frames
    assert made.body_height == pytest.approx(body.body_height)
    again = segue.open_link(segue.link(made), [files / "take.bvh", files / "walk.bvh"])
    np.testing.assert_array_equal(again.rotations, made.rotations)


def test_link_without_a_result_is_that_of_the_result(pair):
    made = segue.blend(*pair, window=20)
    assert segue.link("blend", *pair, window=20) == segue.link(made)
    assert segue.link(made, page="https://example.org/") == f"https://example.org/?{made.query}"
    assert made.link == segue.link(made)
    assert "lab=view" in segue.link(pair[0])
    np.testing.assert_array_equal(segue.open_link(segue.link(pair[0]), pair).root, pair[0].root)


def test_results_are_clips_of_other_labs(pair):
    blended = segue.blend(*pair, window=20)
    assert isinstance(blended, segue.Clip) and blended.id.startswith("blend(")
    cleaned = segue.clean(blended, clean_mend=False)
    assert cleaned.frames == blended.frames
    np.testing.assert_array_equal(cleaned.rotations, blended.rotations)
    # Its link names the recipe, and needs both files.
    again = segue.open_link(segue.link(cleaned), pair)
    np.testing.assert_array_equal(again.rotations, blended.rotations)
    turned = segue.edit(blended, edit_to=1.0)
    np.testing.assert_array_equal(turned.rotations, blended.rotations[:len(turned)])
    # As a file it stands for itself.
    alone = blended.as_file("mine")
    np.testing.assert_array_equal(alone.rotations, blended.rotations)
    assert alone.id.startswith("mine~")
    assert segue.loop(alone).frames > 10


def test_clips_of_arrays_have_links(pair, tmp_path):
    clip = pair[0].as_file("mine")
    made = segue.edit(clip, edit_to=1.0)
    again = segue.open_link(segue.link(made), clip.save(tmp_path / "mine.npz"))
    np.testing.assert_array_equal(again.rotations, made.rotations)


def test_several_clips_are_made_on_all_cores(pair):
    made = segue.edit(pair, edit_to=1.0)
    assert [own.frames for own in made] == [segue.edit(own, edit_to=1.0).frames for own in pair]
    assert made[1].id != made[0].id


def test_clean_tells_its_faults(pair):
    clip = pair[0]
    rotations = clip.rotations.copy()
    joint = clip.names.index(clip.roles["left forearm"])
    # One frame in which the elbow is bent by 60°.
    spike = np.array([np.cos(np.pi / 6), 0, 0, np.sin(np.pi / 6)])
    rotations[40, joint] = spike
    damaged = segue.from_arrays(
        names=clip.names, parents=clip.parents, offsets=clip.offsets,
        rotations=rotations, root=clip.root, fps=clip.fps, name="damaged")
    made = segue.clean(damaged)
    found = [own for own in made.faults if own["frames"][0] <= 40 < own["frames"][1]]
    assert any(clip.names[joint] in own["joints"] and own["is_mended"] for own in found), made.faults
    apart = np.abs(made.global_positions() - clip.global_positions()).max()
    assert apart < 0.02 < np.abs(damaged.global_positions() - clip.global_positions()).max()


def test_compare_gives_a_list(pair):
    made = segue.blend(*pair, compare="blend_window:30,15,10")
    assert [own.transition["window_frames"] for own in made] == [30, 15, 10]
    assert len({own.variant for own in made}) == 3


def test_three_clips_are_registered_with_the_same_weight(pair):
    made = segue.register([*pair, segue.builtin("fast_walk")])
    assert "warp_weight=0.33" in made.query and "0.33:fast_walk" in made.query.replace("%3A", ":")
    with pytest.raises(segue.LabError, match="two to eight clips; here are 9"):
        segue.register([segue.builtin("walk")] * 9)


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (lambda a, b: segue.blend(a, b, window=1000), "blend_window: found 1000, expected 1 to 240"),
        (lambda a, b: segue.blend(a, b, colour="red"), "`colour` is not a parameter"),
        (lambda a, b: segue.blend(a, b, loop_ratio=0.5), "not a parameter of `blend`"),
        (lambda a, b: segue.run_lab("blend", [a]), "takes two clips"),
        (lambda a, b: segue.open_link("?lab=loop&a=take~0a1b2c3d"), "`take` is not here"),
        (lambda a, b: segue.builtin("dance"), "no built-in clip"),
    ],
)
def test_what_does_not_fit_is_refused_with_a_sentence(make, reason, pair):
    with pytest.raises(segue.LabError, match=reason):
        make(*pair)


def test_lab_and_value_of_a_wrong_kind_are_refused(pair):
    with pytest.raises(ValueError, match="there is no lab .dance."):
        segue.parameters("dance")
    with pytest.raises(TypeError, match="blend_window"):
        segue.blend(*pair, blend_window=object())
    with pytest.raises(TypeError, match="name a lab"):
        segue.link(*pair)


def test_parameters_are_those_of_the_table():
    rows = segue.parameters("blend")
    assert rows["blend_window"]["range"] == (1.0, 240.0) and rows["blend_window"]["unit"] == "frames"
    assert rows["leave_a"]["auto"] and "smooth" in rows["weight_law"]["choices"]
    assert "loop_ratio" not in rows


def test_builtin_clips_need_no_file():
    names = segue.builtins()
    assert {"walk", "run", "cmu16_walk"} <= set(names)
    assert segue.builtin("cmu16_walk").frames > 100
    assert segue.builtin("run(turn_rate:20)").id == "run(turn_rate:20)"
    made = segue.synthesize(gait="run", make_seconds=2)
    assert made.duration == pytest.approx(2, abs=0.3)
    np.testing.assert_array_equal(segue.open_link(segue.link(made)).root, made.root)
