//! The Graph lab with the pointer.

use super::*;
use segue_session::Distances;

#[test]
fn graph_lab_shows_walk_distances_and_graph() {
    for (name, size, theme, link) in [
        ("graph-desk-dark", DESK, DARK, "lab=graph&play=off&t=12"),
        ("graph-desk-light", DESK, LIGHT, "lab=graph&play=off&t=12"),
        ("graph-compare", DESK, DARK, "lab=graph&play=off&t=12&compare=blend_window:30,15,10"),
        ("graph-phone-dark", PHONE, DARK, "lab=graph&play=off&t=12"),
        ("graph-tablet", vec2(900.0, 700.0), LIGHT, "lab=graph&play=off&t=12"),
        ("graph-projector", vec2(1280.0, 720.0), HALL, "lab=graph&play=off&t=12"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label(text::ALL_DISTANCES.english());
        harness.get_by_label(text::GRAPH_STRIP.english());
        picture(name, &mut harness);
        harness.get_by_label("First frame only").scroll_to_me();
        harness.run();
        picture(&format!("{name}-down"), &mut harness);
    }
}

#[test]
fn graph_lab_reacts_to_its_controls() {
    let link = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&play=off";
    let mut harness = harness(DESK, DARK, page(link));
    let text_of = |harness: &Harness<'_, Page>, key: Key| {
        key.param().format(harness.state().session.params().get(key))
    };
    let done = |harness: &mut Harness<'_, Page>| {
        harness.run();
        while harness.state_mut().session.work() {}
        harness.run();
    };
    // An arc and a ring under the pointer show both windows; the bar below sends the walk there.
    let strip = harness.get_by_label(text::GRAPH_STRIP.english()).rect();
    let bar = strip.left_bottom() + vec2(0.9 * strip.width(), -20.0);
    harness.drag_at(bar);
    harness.drop_at(bar);
    done(&mut harness);
    assert_eq!(text_of(&harness, Key::GoTo), "0:2");
    press(text::FORGET_VISITS.english(), &mut harness);
    assert_eq!(text_of(&harness, Key::GoTo), "");
    done(&mut harness);
    let (mark, field) = {
        let session = &harness.state().session;
        let built = session.graph_built().unwrap();
        let jump = built.graph().jumps()[0];
        let size = built.clips().set().frames() as f32;
        let number = |place| built.clips().set().number(place).unwrap() as f32 + 0.5;
        let field = harness.get_by_label(text::ALL_DISTANCES.english()).rect();
        (vec2(number(jump.leave), size - number(jump.enter)) / size, field)
    };
    let ring = field.min + mark * field.size();
    harness.hover_at(ring);
    harness.run();
    let ends = harness.state().state.labs.graph.hovered_jump.expect("pointed at");
    picture("graph-pointed-dark", &mut harness);
    harness.drag_at(ring);
    harness.drop_at(ring);
    done(&mut harness);
    assert_eq!(harness.state().session.params().jump(), Some(&ends));
    assert!(outcome(harness.state()).transition.is_some());
    let plays = harness.state().session.params().is_on(Key::Play);
    assert!(plays, "a transition that is asked for is seen, also where all stood still");
    picture("graph-transition-dark", &mut harness);
    press(text::BACK_TO_WALK.english(), &mut harness);
    done(&mut harness);
    assert!(harness.state().session.graph_walk().is_some_and(|walk| !walk.is_jump));
    // Clips are added and removed.
    press("Clips of the graph: 3", &mut harness);
    press("Remove Walk, turn left", &mut harness);
    done(&mut harness);
    assert_eq!(text_of(&harness, Key::Clips), "walk,walk_right");
    let add = harness.get_by_label(text::ADD_CLIP.english());
    assert_eq!(add.value().as_deref(), Some(text::CHOOSE_CLIP.english()), "no clip is chosen yet");
    press(text::ADD_CLIP.english(), &mut harness);
    press("Slow walk", &mut harness);
    done(&mut harness);
    assert_eq!(text_of(&harness, Key::Clips), "walk,walk_right,slow_walk");
    // A path is drawn on the ground.
    press(text::DRAW_PATH.english(), &mut harness);
    let stage = harness.state().state.stage;
    harness.drag_at(stage.center());
    for step in 1..6 {
        harness.hover_at(stage.center() + vec2(0.0, -12.0 * step as f32));
        harness.run();
    }
    harness.drop_at(stage.center() + vec2(0.0, -60.0));
    done(&mut harness);
    assert!(harness.state().session.graph_path().len() > 3, "{}", text_of(&harness, Key::WalkPath));
    assert!(harness.state().session.graph_walk().is_some_and(|walk| walk.followed.is_some()));
    press(text::REMOVE_PATH.english(), &mut harness);
    done(&mut harness);
    // Files and the table.
    press("JSON", &mut harness);
    press("DOT", &mut harness);
    for experiment in text::GRAPH_EXPERIMENTS {
        press(experiment.name.english(), &mut harness);
        done(&mut harness);
        assert!(harness.state().session.panes().len() > 1, "{}", experiment.name.english());
        for (index, pane) in harness.state().session.panes().iter().enumerate() {
            // A segment that is no longer than the window is refused, in words.
            let is_refused = experiment.query.contains("segment_size:60,30,20") && index == 2;
            assert_eq!(
                pane.problem.is_some(),
                is_refused,
                "{}: {:?}",
                experiment.name.english(),
                pane.problem
            );
        }
    }
    press(text::COPY_MARKDOWN.english(), &mut harness);
    press(text::COPY_CSV.english(), &mut harness);
    let actions = &harness.state().out.actions;
    let [
        Action::SaveText { name, text, .. },
        Action::SaveText { text: dot, .. },
        Action::CopyText(markdown),
        Action::CopyText(csv),
    ] = actions.as_slice()
    else {
        panic!("{actions:?}")
    };
    assert!(
        *name == "motion graph.json" && text.contains("\"edges\"") && dot.starts_with("digraph")
    );
    assert!(
        markdown.starts_with("| | whole clip | first frame only | first frame, then as recorded |")
            && csv.lines().count() == 12,
        "{markdown}{csv}"
    );
    // The last experiment again: one pane.
    press("First frame only", &mut harness);
    done(&mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
}

#[test]
fn visit_without_a_way_has_a_note() {
    let link =
        "lab=graph&clips=walk,walk_left,walk_right,idle&walk_seconds=20&blend_window=20&play=off";
    for theme in [DARK, LIGHT] {
        let mut harness = harness(DESK, theme, page(link));
        let strip = harness.get_by_label(text::GRAPH_STRIP.english()).rect();
        let bar = strip.left_bottom() + vec2(0.9 * strip.width(), -20.0);
        harness.drag_at(bar);
        harness.drop_at(bar);
        harness.run();
        while harness.state_mut().session.work() {}
        harness.run();
        let walk = harness.state().session.graph_walk().unwrap();
        assert_eq!(walk.missed, [(0.0, 3)]);
        let sentence =
            "Stand cannot be reached from the walk at 0.0 s: a higher threshold may connect them.";
        assert!(harness.query_all_by_label(sentence).count() > 0);
        picture(
            if theme == DARK { "graph-no-way-dark" } else { "graph-no-way-light" },
            &mut harness,
        );
    }
}

#[test]
fn separate_components_are_drawn() {
    let link = "lab=graph&clips=walk,run,idle,jump,walk_left&walk_seconds=20&edge_threshold=5&prune=off&play=off";
    for (name, theme) in [("graph-parts-dark", DARK), ("graph-parts-light", LIGHT)] {
        let mut harness = harness(DESK, theme, page(link));
        let rings = harness.state().session.graph_built().unwrap().component_shares().len();
        assert!(rings > 1, "{rings}");
        picture(name, &mut harness);
    }
}

#[test]
fn distances_of_many_frames_are_drawn_at_every_zoom() {
    let clips = "walk(make_seconds:30),walk(turn_rate:20,make_seconds:30),run(make_seconds:30),walk(turn_rate:-20,make_seconds:20)";
    let link = format!("lab=graph&clips={clips}&walk_seconds=20&play=off&t=5");
    let mut harness = harness(DESK, DARK, page(&link));
    let (mark, ends, frames) = {
        let session = &harness.state().session;
        let (built, field) = (session.graph_built().unwrap(), session.graph_field().unwrap());
        let frames = built.clips().set().frames();
        assert!(frames > 6_000 && matches!(field.distances(), Distances::Overview(_)), "{frames}");
        let jump = built.whole().jumps()[0];
        let number = |place| built.clips().set().number(place).unwrap() as f32 + 0.5;
        let at = vec2(number(jump.leave), frames as f32 - number(jump.enter)) / frames as f32;
        (at, [jump.leave, jump.enter], frames)
    };
    let field = harness.get_by_label(text::ALL_DISTANCES.english()).rect();
    picture("graph-afar-dark", &mut harness);
    // The wheel over a ring keeps its place, and the picture gets finer until all of it is
    // computed.
    let ring = field.min + mark * field.size();
    harness.hover_at(ring);
    for (name, turns) in
        [("graph-nearer-dark", 2), ("graph-nearby-dark", 4), ("graph-cells-dark", 4)]
    {
        for _ in 0..turns {
            harness.event(egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Point,
                delta: vec2(0.0, 150.0),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: egui::Modifiers::NONE,
            });
            harness.run_steps(20);
        }
        let mut steps = 0;
        while harness.try_run().is_err() {
            steps += 1;
            assert!(steps < 20, "tiles are still made");
        }
        if name == "graph-nearer-dark" {
            assert_eq!(harness.state().state.labs.graph.hovered_jump, Some(ends));
        }
        picture(name, &mut harness);
    }
    // With the whole picture again, the same ring is pressed.
    assert!(frames as f32 / field.width() > 8.0);
    harness.get_by_label(text::ALL_DISTANCES.english()).focus();
    harness.run();
    harness.key_press(Keyboard::Num0);
    harness.run();
    harness.hover_at(ring);
    harness.run();
    let pointed = harness.state().state.labs.graph.hovered_jump.expect("there are rings");
    harness.drag_at(ring);
    harness.drop_at(ring);
    harness.run();
    let jump = *harness.state().session.params().jump().unwrap();
    assert_eq!(jump, pointed);
    // The transition that plays has no preview, although the pointer is on its ring.
    while harness.state_mut().session.work() {}
    harness.run_steps(3);
    assert!(harness.state().session.graph_walk().unwrap().is_jump);
    assert_eq!(harness.state().state.labs.graph.last_jump, None);
}

/// The number in the title of a folded section changes with every clip that is removed.
#[test]
fn list_of_clips_stays_open_when_one_is_removed() {
    let mut harness = harness(DESK, DARK, page("lab=graph&clips=walk,run,idle&play=off"));
    press("Clips of the graph: 3", &mut harness);
    press("Remove Run", &mut harness);
    harness.get_by_label("Clips of the graph: 2");
    assert!(harness.query_by_label("Remove Walk").is_some());
}
