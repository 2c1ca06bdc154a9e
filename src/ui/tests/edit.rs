//! The Edit lab, edits from the library, and the buttons beside a refusal.

use super::*;

fn params<'a>(harness: &'a Harness<'_, Page>) -> &'a segue_session::Params {
    harness.state().session.params()
}

fn frames(harness: &Harness<'_, Page>) -> usize {
    outcome(harness.state()).motion.clip().frames()
}

#[test]
fn edit_lab_says_what_is_done_and_keeps_it() {
    let link = "lab=edit&a=walk_left&edit_from=0.5&edit_to=1.6&mirror=on&scale=1.2&play=off&t=0.4";
    for (name, size, theme) in [
        ("edit-desk-dark", DESK, DARK),
        ("edit-desk-light", DESK, LIGHT),
        ("edit-tablet-dark", vec2(1024.0, 768.0), DARK),
        ("edit-projector", vec2(1280.0, 720.0), HALL),
        ("edit-phone-dark", PHONE, DARK),
        ("edit-phone-light", PHONE, LIGHT),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label_contains("0.50 to 1.60 s, mirrored, scaled by 1.2");
        picture(name, &mut harness);
    }
    let compare = "lab=edit&a=walk_left&compare=mirror:off,on&turn=40&play=off&t=1";
    let mut compared = harness(DESK, DARK, page(compare));
    picture("edit-compare-dark", &mut compared);
    let mut harness = harness(DESK, DARK, page("lab=edit&a=walk&play=off"));
    harness.get_by_label_contains("unchanged");
    press("mirrored", &mut harness);
    press("backwards", &mut harness);
    press("one cycle", &mut harness);
    press("Keep in library", &mut harness);
    let session = &harness.state().session;
    let kept = session.library().entries().last().unwrap();
    assert_eq!(kept.id, "edit(a:walk,as_loop:on,reverse:on,mirror:on)");
    assert!(kept.motion.as_ref().unwrap().is_cycle());
    // The comparison of the lab: the clip beside its mirror image, and back.
    let mut out = Out::default();
    labs::toggle_compare(session, &mut out);
    let opened = Command::Set(vec![(
        Key::Compare,
        Value::Compare(segue_session::Compare::parse("mirror:off,on").ok()),
    )]);
    assert_eq!(out.commands.first(), Some(&opened));
}

/// The ends of the part are dragged on the bar of the whole clip, which stays as long as it is.
#[test]
fn ends_of_the_part_are_dragged_and_moved_by_keys() {
    for (lab, keys) in
        [("edit", [Key::EditFrom, Key::EditTo]), ("loop", [Key::LoopFrom, Key::LoopTo])]
    {
        let link = format!(
            "lab={lab}&a=walk&play=off&{}=1&{}=2",
            keys[0].param().name,
            keys[1].param().name
        );
        let mut harness = harness(DESK, DARK, page(&link));
        let ends = |harness: &Harness<'_, Page>| keys.map(|key| params(harness).optional(key));
        let grip = harness.get_by_label("Start of the part").rect();
        let at = egui::pos2(grip.left() + 0.75 * grip.width(), grip.center().y);
        let end = harness.get_by_label("End of the part").rect();
        let second = end.left() + 0.25 * end.width() - at.x;
        step(vec![egui::Event::PointerMoved(at), button(at, true)], &mut harness);
        // In two moves, so that a bar that moved along would run away.
        for part in [-0.25, -0.5] {
            step(vec![egui::Event::PointerMoved(at + vec2(part * second, 0.0))], &mut harness);
        }
        step(vec![button(at - vec2(0.5 * second, 0.0), false)], &mut harness);
        harness.run_steps(2);
        let [from, to] = ends(&harness);
        assert!(from.is_some_and(|from| (from - 0.5).abs() < 0.02), "{lab}: {from:?}");
        assert_eq!(to, Some(2.0), "{lab}");
        // One drag is one step.
        harness.state_mut().session.apply(Command::Undo).unwrap();
        harness.run_steps(2);
        assert_eq!(ends(&harness), [Some(1.0), Some(2.0)], "{lab}");
        harness.get_by_label("End of the part").focus();
        harness.run_steps(2);
        harness.key_press(Keyboard::ArrowRight);
        harness.run_steps(2);
        let [_, to] = ends(&harness);
        assert!(to.is_some_and(|to| (to - 2.0 - 1.0 / 60.0).abs() < 2e-3), "{lab}: {to:?}");
        // Neither end passes the other.
        step(vec![egui::Event::PointerMoved(at), button(at, true)], &mut harness);
        step(vec![egui::Event::PointerMoved(at + vec2(2.0 * second, 0.0))], &mut harness);
        step(vec![button(at + vec2(2.0 * second, 0.0), false)], &mut harness);
        harness.run_steps(2);
        let [from, to] = ends(&harness);
        assert!(from <= to, "{lab}: {from:?} {to:?}");
    }
    // An end of the clip is no end of its own.
    let mut harness = harness(DESK, DARK, page("lab=edit&a=walk&edit_from=0.1&play=off"));
    let all = outcome(&page("lab=view&a=walk")).motion.clip().frames();
    assert!(frames(&harness) < all);
    harness.get_by_label("Start of the part").focus();
    harness.run_steps(2);
    for _ in 0..8 {
        harness.key_press(Keyboard::ArrowLeft);
        harness.run_steps(2);
    }
    assert_eq!((params(&harness).optional(Key::EditFrom), frames(&harness)), (None, all));
}

/// Opens the menu of a clip in the library.
fn open_menu(name: &str, harness: &mut Harness<'_, Page>) {
    // The row, which lies below its letter and its buttons.
    let rows = harness.get_all_by_label_contains(name).map(|row| row.rect());
    let rows: Vec<Rect> = rows.filter(|row| row.right() < 260.0).collect();
    let at = rows.first().expect("a row").center_top() + vec2(0.0, 12.0);
    for pressed in [true, false] {
        let event = egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Secondary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        step(vec![egui::Event::PointerMoved(at), event], harness);
    }
    harness.run_steps(3);
}

#[test]
fn menu_of_a_clip_edits_it() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off&scale=3"));
    for (item, id) in [
        ("Mirror", "edit(a:idle,mirror:on)"),
        ("Reverse", "edit(a:idle,reverse:on)"),
        ("Treat as loop", "edit(a:idle,as_loop:on)"),
    ] {
        open_menu("Stand", &mut harness);
        picture("edit-menu-dark", &mut harness);
        harness.get_by_label(item).click();
        harness.run_steps(3);
        let session = &harness.state().session;
        assert!(session.library().get(id).is_some(), "{item}");
        assert_eq!(session.params().lab().word(), "blend", "the stage stays");
        harness.state_mut().session.apply(Command::Undo).unwrap();
        harness.run_steps(3);
        assert!(harness.state().session.library().get(id).is_none());
    }
    open_menu("Stand", &mut harness);
    harness.get_by_label("Edit…").click();
    harness.run_steps(3);
    // With no edits left from before.
    assert_eq!(harness.state().session.query(), "lab=edit&a=idle&play=off");
}

/// Every button beside a refusal is pressed: then there is a result.
/// Returns the place of a button beside a refusal: on the stage or below it. A row of the library
/// has a button of the same name.
fn remedy_place(label: &str, harness: &Harness<'_, Page>) -> Rect {
    let stage = harness.state().stage;
    let is_there = |place: &Rect| {
        place.left() >= stage.left() && place.right() <= stage.right() && place.top() > stage.top()
    };
    let mut places = harness.get_all_by_label(label).map(|node| node.rect()).filter(is_there);
    places.next().expect("a button")
}

#[test]
fn button_beside_a_refusal_does_what_helps() {
    for (link, label) in [
        ("lab=speed&a=walk&b=edit(a:run,edit_to:0.32)", "Treat B as a loop"),
        ("lab=speed&a=idle", "Use Walk as A"),
        ("lab=speed&a=walk&b=walk", "Use Run as B"),
        ("lab=loop&a=edit(a:walk,edit_to:0.3)", "Treat A as a loop"),
        ("lab=blend&b=nobody", "Use Run as B"),
        ("lab=path&a=idle", "Edit the clip"),
    ] {
        let mut harness = harness(DESK, DARK, page(&format!("{link}&play=off")));
        assert!(harness.state().session.panes()[0].problem.is_some(), "{link}");
        let at = remedy_place(label, &harness).center();
        picture(&format!("refusal-{}", label.replace(' ', "-")), &mut harness);
        step(vec![egui::Event::PointerMoved(at), button(at, true)], &mut harness);
        step(vec![button(at, false)], &mut harness);
        harness.run();
        let pane = &harness.state().session.panes()[0];
        assert_eq!(pane.problem, None, "{link}");
    }
    for (name, size, theme) in [("phone", PHONE, DARK), ("projector", vec2(1280.0, 720.0), HALL)] {
        let mut harness = harness(size, theme, page("lab=path&a=idle&play=off"));
        for label in ["Use Walk as A", "Edit the clip"] {
            let place = remedy_place(label, &harness);
            assert!(place.height() > 20.0, "{name}: {place:?}");
        }
        picture(&format!("refusal-{name}"), &mut harness);
    }
}

/// The body parts of a clip are unfolded where a refusal asks for them.
#[test]
fn button_for_body_parts_shows_their_rows() {
    let text = "HIERARCHY\nROOT seg_1\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n JOINT seg_2\n {\n  OFFSET 0 0 0.3\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 0 0.3\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.03\n0 0 0 0 0 0 0 0 0\n0 0 1 0 5 0 0 5 0\n";
    let mut page = page("lab=blend&a=walk&play=off");
    let read = page.session.load("snake.bvh", Arc::from(text.as_bytes())).unwrap();
    let id = Value::Text(read.ids[0].clone());
    page.session
        .apply(Command::Set(vec![(Key::A, Value::Text("walk".into())), (Key::B, id)]))
        .unwrap();
    while page.session.work() {}
    let mut harness = harness(DESK, DARK, page);
    assert!(harness.query_by_label("Left thigh").is_none());
    press("Set body parts of snake", &mut harness);
    harness.run_steps(4);
    let session = &harness.state().session;
    assert!(session.params().lab().word() == "view" && session.panes()[0].result().is_ok());
    let part = segue_motion::skeleton::Role::LeftThigh.name();
    assert!(harness.query_all_by_label_contains(part).count() > 0, "the rows are shown");
    picture("body-parts-asked-for", &mut harness);
}
