//! The Path lab with mouse, finger and keys.

use super::*;
use eframe::egui::{Event, Modifiers, Pos2, TouchDeviceId, TouchId, TouchPhase};
use glam::DVec2;
use segue_session::choices;
use segue_session::{Group, PathFacts};

fn path(harness: &Harness<'_, Page>) -> Arc<PathFacts> {
    outcome(harness.state()).path().cloned().expect("a path")
}

fn points(harness: &Harness<'_, Page>) -> Vec<DVec2> {
    path(harness).curve.spline().points().to_vec()
}

/// Returns a page whose cameras are set, with the path in sight.
fn lab(size: Vec2, theme: Theme, link: &str) -> Harness<'static, Page> {
    let mut harness = harness(size, theme, page(link));
    harness.run_steps(4);
    harness
}

fn handle(number: usize, harness: &Harness<'_, Page>) -> Pos2 {
    harness.get_by_label_contains(&format!("Control point {number} of")).rect().center()
}

fn is_handle(node: &egui_kittest::Node<'_>) -> bool {
    node.accesskit_node().label().is_some_and(|label| label.starts_with("Control point "))
}

/// Drags along these places.
fn drag(way: &[Pos2], harness: &mut Harness<'_, Page>) {
    step(vec![Event::PointerMoved(way[0])], harness);
    step(vec![button(way[0], true)], harness);
    for &pos in &way[1..] {
        step(vec![Event::PointerMoved(pos)], harness);
    }
    step(vec![button(way[way.len() - 1], false)], harness);
    harness.run_steps(2);
}

#[test]
fn path_lab_opens_with_its_path_in_sight() {
    for (name, size, theme, link) in [
        ("path-desk-dark", DESK, DARK, "lab=path&a=walk_left&play=off&t=1.5"),
        ("path-desk-light", DESK, LIGHT, "lab=path&a=walk_left&play=off&t=1.5"),
        (
            "path-compare-dark",
            DESK,
            DARK,
            "lab=path&a=walk_left&compare=control_points:4,8,16&play=off",
        ),
        ("path-phone-dark", PHONE, DARK, "lab=path&a=walk_left&play=off&others=run,walk_right"),
        ("path-projector", vec2(1280.0, 720.0), HALL, "lab=path&play=off&others=run,walk_right"),
        ("path-none-dark", DESK, DARK, "lab=path&a=idle&play=off"),
    ] {
        let harness = &mut lab(size, theme, link);
        let count =
            harness.query_all_by_label_contains(" of ").filter(|node| is_handle(node)).count();
        let wanted = match name {
            "path-none-dark" => 0,
            "path-compare-dark" => 4 + 8 + 16,
            _ => 8,
        };
        assert_eq!(count, wanted, "{name}");
        for node in harness.query_all_by_label_contains(" of ").filter(is_handle) {
            assert!(
                node.rect().width() >= 24.0 && node.rect().height() >= 24.0,
                "{name}: {:?}",
                node.rect()
            );
        }
        if name == "path-none-dark" {
            assert!(harness.query_all_by_label_contains("stays within").count() > 0);
        }
        picture(name, harness);
    }
}

#[test]
fn control_point_under_the_pointer_is_dragged() {
    for camera in ["", "&camera=top&camera_distance=9&follow=off"] {
        let mut harness = lab(DESK, DARK, &format!("lab=path&a=walk&play=off{camera}"));
        let (before, from) = (points(&harness), handle(4, &harness));
        let to = from + vec2(70.0, 24.0);
        step(vec![Event::PointerMoved(from)], &mut harness);
        step(vec![button(from, true)], &mut harness);
        for share in [0.3, 0.7, 1.0] {
            step(vec![Event::PointerMoved(from + (to - from) * share)], &mut harness);
            harness.step();
            assert!(path(&harness).is_edited, "live, not only in the end");
        }
        assert!(
            handle(4, &harness).distance(to) < 4.0,
            "{camera}: it stays under the hand: {:?} {to:?}",
            handle(4, &harness)
        );
        step(vec![button(to, false)], &mut harness);
        harness.run_steps(2);
        let after = points(&harness);
        assert!(after[3].distance(before[3]) > 0.2);
        assert!(
            after
                .iter()
                .zip(&before)
                .enumerate()
                .all(|(i, (a, b))| i == 3 || a.distance(*b) < 0.011)
        );
        // The edit is one step of undo.
        harness.state_mut().session.apply(Command::Undo).expect("a step");
        assert!(!path(&harness).is_edited, "{camera}");
    }
}

#[test]
fn control_point_under_a_finger_is_dragged() {
    let mut harness = lab(PHONE, LIGHT, "lab=path&a=walk&play=off");
    let from = handle(3, &harness);
    let touch = |phase, pos| Event::Touch {
        device_id: TouchDeviceId(0),
        id: TouchId(0),
        phase,
        pos,
        force: None,
    };
    let to = from + vec2(40.0, 10.0);
    step(
        vec![touch(TouchPhase::Start, from), Event::PointerMoved(from), button(from, true)],
        &mut harness,
    );
    step(
        vec![
            touch(TouchPhase::Move, from + vec2(20.0, 5.0)),
            Event::PointerMoved(from + vec2(20.0, 5.0)),
        ],
        &mut harness,
    );
    step(vec![touch(TouchPhase::Move, to), Event::PointerMoved(to)], &mut harness);
    step(vec![touch(TouchPhase::End, to), button(to, false), Event::PointerGone], &mut harness);
    harness.run_steps(2);
    assert!(path(&harness).is_edited);
    assert!(handle(3, &harness).distance(to) < 4.0);
}

#[test]
fn control_point_with_the_focus_is_moved_and_removed_by_keys() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk&play=off");
    harness.get_by_label_contains("Control point 3 of").focus();
    harness.run_steps(2);
    let before = points(&harness);
    harness.key_press(Keyboard::ArrowRight);
    harness.run_steps(2);
    assert!((points(&harness)[2].distance(before[2]) - 0.05).abs() < 0.011);
    harness.key_press_modifiers(Modifiers::SHIFT, Keyboard::ArrowUp);
    harness.run_steps(2);
    assert!(points(&harness)[2].distance(before[2]) > 0.2);
    harness.key_press(Keyboard::Tab);
    harness.run_steps(2);
    assert_eq!(harness.state().state.labs.path.chosen, Some(3));
    harness.key_press(Keyboard::Delete);
    harness.run_steps(2);
    assert_eq!(points(&harness).len(), 7);
    // A pinned end stays, with a note.
    harness.get_by_label_contains("Control point 1 of").focus();
    harness.run_steps(2);
    harness.key_press(Keyboard::Delete);
    harness.run_steps(2);
    assert!(harness.query_all_by_label_contains("cannot be removed").count() > 0);
    assert_eq!(points(&harness).len(), 7);
}

#[test]
fn path_double_clicked_has_a_new_point_there() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk&play=off");
    let [one, two] = [5, 6].map(|number| handle(number, &harness));
    let middle = one.lerp(two, 0.45);
    assert!(one.distance(two) > 60.0, "{one:?} {two:?}");
    step(vec![Event::PointerMoved(middle)], &mut harness);
    let [down, up] = [true, false].map(|pressed| button(middle, pressed));
    step(vec![down.clone(), up.clone(), down, up], &mut harness);
    harness.run_steps(2);
    let state = &harness.state().state;
    assert_eq!(points(&harness).len(), 9, "{:?}", state.labs.path);
}

#[test]
fn path_is_drawn_by_hand() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk&play=off");
    press(text::DRAW.english(), &mut harness);
    harness.get_by_label(text::DRAW_HINT.english());
    let stage = harness.state().state.stage;
    let way: Vec<Pos2> = (0..30)
        .map(|k| {
            let share = k as f32 / 29.0;
            stage.center() + vec2(300.0 * (share - 0.5), 90.0 + 60.0 * (share * 6.0).sin())
        })
        .collect();
    let camera = harness.state().session.params().number(Key::CameraYaw);
    drag(&way, &mut harness);
    assert_eq!(
        harness.state().session.params().number(Key::CameraYaw),
        camera,
        "the stage does not turn"
    );
    assert!(harness.state().state.drawing.is_none());
    assert!(path(&harness).is_edited);
    let first = handle(1, &harness);
    assert!(first.distance(way[0]) < 12.0, "{first:?} {:?}", way[0]);
    press(text::DRAW.english(), &mut harness);
    harness.key_press(Keyboard::Escape);
    harness.run_steps(2);
    assert!(harness.state().state.drawing.is_none());
    // A single point is refused as a path, with a note.
    press(text::DRAW.english(), &mut harness);
    drag(&[stage.center(), stage.center() + vec2(7.0, 0.0)], &mut harness);
    assert!(harness.query_all_by_label_contains("has no direction").count() > 0);
}

#[test]
fn whole_path_is_edited_by_buttons_and_reset() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk_left&play=off");
    let original = points(&harness);
    for label in [
        text::TURN_LEFT.english(),
        text::LARGER_PATH.english(),
        text::MIRROR.english(),
        text::STRAIGHTEN.english(),
        text::SMOOTH.english(),
        text::CLOSE_LOOP.english(),
    ] {
        let before = points(&harness);
        press(label, &mut harness);
        assert_ne!(points(&harness), before, "{label}");
    }
    assert!(path(&harness).curve.spline().is_closed());
    harness.get_by_label(text::OPEN_LOOP.english());
    picture("path-loop-dark", &mut harness);
    press("Pin the start", &mut harness);
    press(text::RESET_PATH.english(), &mut harness);
    assert_eq!(points(&harness), original);
    press(text::ADD_POINT.english(), &mut harness);
    assert_eq!(points(&harness).len(), 9);
    press(text::JOIN.english(), &mut harness);
    assert_eq!(harness.state().session.extra_characters().len(), 1);
    picture("path-company-dark", &mut harness);
}

/// A button that needs a point is disabled without one, and says so; pins are switches.
#[test]
fn remove_button_awaits_a_point_and_pins_are_switches() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk&play=off");
    let remove = |harness: &Harness<'_, Page>| {
        let node = harness.get_by_label(text::REMOVE_POINT.english());
        (node.accesskit_node().is_disabled(), node.rect().center())
    };
    harness.get_by_label(text::REMOVE_POINT.english()).scroll_to_me();
    harness.run();
    let (is_disabled, at) = remove(&harness);
    assert!(is_disabled);
    harness.hover_at(at);
    harness.run_steps(40);
    harness.get_by_label(text::CHOOSE_POINT.english());
    harness.get_by_label_contains("Control point 3 of").focus();
    harness.run_steps(2);
    assert!(!remove(&harness).0);
    press(text::REMOVE_POINT.english(), &mut harness);
    assert_eq!(points(&harness).len(), 7);
    for (key, label) in [(Key::PinStart, "Pin the start"), (Key::PinEnd, "Pin the end")] {
        let node = harness.get_by_role_and_label(Role::Switch, label);
        assert_eq!(node.accesskit_node().toggled(), Some(Toggled::False));
        press(label, &mut harness);
        assert!(harness.state().session.params().is_on(key), "{label}");
    }
}

#[test]
fn camera_is_restored_when_the_path_lab_is_left() {
    let mut harness = lab(DESK, DARK, "lab=path&a=walk&play=off");
    assert_eq!(harness.state().session.params().choice::<choices::Follow>().word(), "off");
    press("View", &mut harness);
    assert_eq!(harness.state().session.params().choice::<choices::Follow>().word(), "result");
    // A camera that was moved by hand stays.
    let harness = lab(DESK, DARK, "lab=path&a=walk&play=off&camera_yaw=10");
    assert_eq!(harness.state().session.params().choice::<choices::Follow>().word(), "result");
}

#[test]
fn step_out_of_the_path_lab_and_back_moves_the_camera_with_it() {
    let mut harness = lab(DESK, DARK, "lab=blend&play=off");
    let camera = |harness: &Harness<'_, Page>| -> Vec<(Key, Value)> {
        let changed = harness.state().session.params().changed();
        let camera = changed.filter(|(param, _)| param.group == Group::Camera);
        camera.map(|(param, value)| (param.key, value.clone())).collect()
    };
    press("Path", &mut harness);
    harness.run_steps(4);
    let whole_path = camera(&harness);
    assert!(whole_path.len() > 3, "{whole_path:?}");
    for _ in 0..2 {
        harness.state_mut().session.apply(Command::Undo).expect("a step");
        harness.run_steps(4);
        assert_eq!(harness.state().session.params().lab(), LabId::Blend);
        assert_eq!(camera(&harness), []);
        harness.state_mut().session.apply(Command::Redo).expect("a step");
        harness.run_steps(4);
        assert_eq!(harness.state().session.params().lab(), LabId::Path);
        assert_eq!(camera(&harness), whole_path);
    }
    press("Blend", &mut harness);
    harness.run_steps(4);
    assert_eq!(camera(&harness), []);
}
