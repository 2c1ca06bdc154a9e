//! The Register lab with the pointer.

use super::*;

#[test]
fn register_lab_shows_the_map_and_its_curves() {
    for (name, size, theme, link) in [
        ("register-desk-dark", DESK, DARK, "lab=register&play=off&t=1"),
        (
            "register-desk-light",
            DESK,
            LIGHT,
            "lab=register&compare=warp_with:registered,plain&play=off&t=1",
        ),
        (
            "register-small-dark",
            vec2(1280.0, 720.0),
            DARK,
            "lab=register&warp_mode=join&compare=warp_with:registered,plain&play=off&t=1",
        ),
        (
            "register-small-light",
            vec2(1280.0, 720.0),
            LIGHT,
            "lab=register&warp_mode=join&pins=100-90&play=off&t=1",
        ),
        ("register-phone-dark", PHONE, DARK, "lab=register&play=off&t=1"),
        ("register-phone-light", PHONE, LIGHT, "lab=register&warp_mode=join&play=off&t=1"),
        ("register-projector", vec2(1280.0, 720.0), HALL, "lab=register&play=off&t=1"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label(text::REGISTER_ABOUT.english());
        harness.get_by_label(text::DISTANCES.english());
        harness.get_by_label_contains("cm per joint");
        picture(name, &mut harness);
        if size == PHONE {
            harness.get_by_label(text::DISTANCES.english()).scroll_to_me();
            harness.run();
            picture(&format!("{name}-map"), &mut harness);
        }
    }
}

#[test]
fn weight_over_time_is_drawn_by_hand() {
    let mut harness = harness(DESK, DARK, page("lab=register&play=off"));
    press(text::WEIGHT_OVER_TIME.english(), &mut harness);
    let label = Key::WarpCurve.param().label;
    let keys =
        |harness: &Harness<'_, Page>| harness.state().session.params().weight_curve().to_vec();
    assert_eq!(keys(&harness), [(0, 0), (100, 100)]);
    let image = harness.get_by_role_and_label(Role::Image, label);
    image.scroll_to_me();
    harness.run();
    let field = harness.get_by_role_and_label(Role::Image, label).rect().shrink(6.0);
    let at = |x: f32, y: f32| field.left_bottom() + vec2(x * field.width(), -y * field.height());
    harness.hover_at(at(0.5, 0.8));
    harness.run();
    // Both clicks are in one frame: frames of tests are too long for a double click.
    step(
        [true, false, true, false].map(|pressed| button(at(0.5, 0.8), pressed)).to_vec(),
        &mut harness,
    );
    harness.run();
    assert_eq!(keys(&harness).len(), 3, "{:?}", keys(&harness));
    harness.drag_at(at(0.5, 0.8));
    harness.run();
    harness.hover_at(at(0.3, 0.2));
    harness.run();
    harness.drop_at(at(0.3, 0.2));
    harness.run();
    let (share, weight) = keys(&harness)[1];
    assert!(share.abs_diff(30) <= 2 && weight.abs_diff(20) <= 2, "{share} {weight}");
    let frame_pairs = &outcome(harness.state()).registered().unwrap().frame_pairs;
    assert!((frame_pairs[frame_pairs.len() * 3 / 10].weights[1] - 0.2).abs() < 0.06);
    picture("register-weights-dark", &mut harness);
    press(text::ONE_WEIGHT.english(), &mut harness);
    assert_eq!(keys(&harness), []);
}

#[test]
fn map_under_the_pointer_previews_seeks_and_pins() {
    let mut harness = harness(DESK, DARK, page("lab=register&play=off"));
    let field = harness.get_by_label(text::DISTANCES.english()).rect();
    let at = |x: f32, y: f32| field.min + vec2(x * field.width(), y * field.height());
    harness.hover_at(at(0.5, 0.5));
    harness.run();
    let spans = [Key::A, Key::B].map(|key| {
        let session = &harness.state().session;
        let entry = session.library().find(session.params().text(key)).unwrap();
        entry.motion.as_ref().unwrap().clip().duration_secs()
    });
    let [a, b] = harness.state().state.labs.register.hovered_pair.expect("pointed at");
    let fps = harness.state().session.distance_map().unwrap().fps();
    assert!(
        (a / fps - 0.5 * spans[0]).abs() < 0.02 && (b / fps - 0.5 * spans[1]).abs() < 0.02,
        "{a} {b}"
    );
    // A click goes to the nearest time of the result.
    let click = |harness: &mut Harness<'_, Page>, pos| {
        harness.drag_at(pos);
        harness.drop_at(pos);
        harness.run();
    };
    click(&mut harness, at(0.5, 0.5));
    let now = harness.state().session.now_secs();
    let frame_pair = outcome(harness.state()).registered().unwrap().frame_pair_at(now).unwrap();
    let off = |secs: f64| {
        let frames =
            outcome(harness.state()).registered().unwrap().frame_pair_at(secs).unwrap().frames;
        (frames[0] - a).hypot(frames[1] - b)
    };
    assert!(
        off(now) < 20.0 && off(now) < off(now - 0.1) && off(now) < off(now + 0.1),
        "{frame_pair:?} for {a} {b}"
    );
    // A drag sets a pin, and the curve passes through it.
    let pins = |harness: &Harness<'_, Page>| harness.state().session.params().pins().to_vec();
    let drag = |harness: &mut Harness<'_, Page>, from, to| {
        harness.drag_at(from);
        harness.run();
        harness.hover_at(to);
        harness.run();
        harness.drop_at(to);
        harness.run();
    };
    drag(&mut harness, at(0.4, 0.4), at(0.5, 0.45));
    let [(pin_a, pin_b)] = pins(&harness)[..] else { panic!("{:?}", pins(&harness)) };
    let warped =
        outcome(harness.state()).registered().unwrap().registration.warp().at(pin_a as f64);
    assert!((warped - pin_b as f64).abs() < 0.01, "{warped} {pin_b}");
    picture("register-pinned-dark", &mut harness);
    // The pin is moved, and dragged out; each is one step of undo.
    drag(&mut harness, at(0.5, 0.45), at(0.5, 0.5));
    let moved = pins(&harness);
    assert!(moved.len() == 1 && moved[0] != (pin_a, pin_b), "{moved:?}");
    drag(&mut harness, at(0.5, 0.5), at(1.3, 0.5));
    assert_eq!(pins(&harness), []);
    for expected in [moved.as_slice(), &[(pin_a, pin_b)], &[]] {
        harness.state_mut().session.apply(Command::Undo).unwrap();
        assert_eq!(harness.state().session.params().pins(), expected);
    }
    harness.state_mut().session.apply(Command::Redo).unwrap();
    harness.run();
    press("Remove pins", &mut harness);
    assert_eq!(pins(&harness), []);
    // A pin that cannot be met is refused with a reason, without a result.
    let set = Command::Set(vec![(Key::Pins, List::Pins(vec![(100, 90), (120, 80)]).into())]);
    harness.state_mut().session.apply(set).unwrap();
    harness.run();
    assert!(harness.query_all_by_label_contains("exclude each other").count() >= 1);
    assert!(harness.state().session.main_outcome().is_none());
    picture("register-problem-dark", &mut harness);
    press("Compare registered and plain", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 2);
}
