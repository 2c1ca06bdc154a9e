//! Tests of contacts that are corrected on the timeline.

use super::*;
use segue_motion::clip::Contacts;
use segue_motion::skeleton::Side;
use std::ops::Range;

fn view() -> Harness<'static, Page> {
    harness(DESK, DARK, page("lab=view&a=walk&play=off"))
}

fn contacts(harness: &Harness<'_, Page>) -> Contacts {
    let clips = harness.state().session.contact_clips();
    clips.first().expect("a clip with feet").motion.contacts().clone()
}

fn left(harness: &Harness<'_, Page>) -> Vec<Range<usize>> {
    contacts(harness).intervals(Side::Left)
}

fn edits(harness: &Harness<'_, Page>) -> String {
    let value = harness.state().session.params().get(Key::ContactEdits);
    Key::ContactEdits.param().format(value)
}

fn drag(from: egui::Pos2, by: Vec2, harness: &mut Harness<'_, Page>) {
    step(vec![egui::Event::PointerMoved(from)], harness);
    step(vec![button(from, true)], harness);
    for part in [0.3, 0.7, 1.0] {
        step(vec![egui::Event::PointerMoved(from + part * by)], harness);
    }
    step(vec![button(from + by, false)], harness);
    harness.run_steps(2);
}

#[test]
fn end_of_a_contact_is_dragged_as_one_step() {
    let mut harness = view();
    let found = left(&harness);
    let bar = harness.get_by_label("Left foot, contact 2").rect();
    drag(bar.right_center() - vec2(1.0, 0.0), vec2(14.0, 0.0), &mut harness);
    let moved = left(&harness);
    assert!(moved[1].end > found[1].end && moved[1].start == found[1].start, "{moved:?}");
    assert_eq!((&moved[0], moved.len()), (&found[0], found.len()));
    drag(bar.left_center() + vec2(1.0, 0.0), vec2(14.0, 0.0), &mut harness);
    assert!(left(&harness)[1].start > found[1].start);
    picture("contacts-view", &mut harness);
    for wanted in [&moved, &found] {
        harness.state_mut().session.apply(Command::Undo).unwrap();
        assert_eq!(&left(&harness), wanted);
    }
    // The playhead stays; between the ends it follows the pointer as anywhere.
    assert_eq!(harness.state().session.now_secs(), 0.0);
    drag(bar.center(), vec2(5.0, 0.0), &mut harness);
    assert!(harness.state().session.now_secs() > 0.0 && edits(&harness).is_empty());
}

#[test]
fn contact_is_corrected_by_the_keyboard() {
    let mut harness = view();
    let found = left(&harness);
    harness.get_by_label("Left foot, contact 2").focus();
    harness.run_steps(2);
    harness.key_press(Keyboard::ArrowRight);
    harness.run_steps(2);
    assert_eq!(left(&harness)[1], found[1].start + 1..found[1].end);
    harness.key_press_modifiers(egui::Modifiers::SHIFT, Keyboard::ArrowLeft);
    harness.run_steps(2);
    assert_eq!(left(&harness)[1], found[1].start + 1..found[1].end - 1);
    let node = harness.get_by_label("Left foot, contact 2");
    let said = node.accesskit_node().value().unwrap_or_default();
    assert!(said.starts_with(&format!("{:.2} to", (found[1].start + 1) as f64 / 60.0)), "{said}");
    harness.key_press(Keyboard::Delete);
    harness.run_steps(2);
    assert_eq!(left(&harness).len(), found.len() - 1);
    assert!(!contacts(&harness).planted(Side::Left, found[1].start + 5));
    harness.state_mut().session.apply(Command::Undo).unwrap();
    harness.run_steps(2);
    assert_eq!(left(&harness)[1], found[1].start + 1..found[1].end - 1, "a step of its own");
}

#[test]
fn contact_is_added_by_a_double_click_and_all_go_back_to_what_was_found() {
    let mut harness = view();
    let found = left(&harness);
    let [one, two] = ["Left foot, contact 1", "Left foot, contact 2"]
        .map(|label| harness.get_by_label(label).rect());
    let gap = one.right_center().lerp(two.left_center(), 0.5);
    step(vec![egui::Event::PointerMoved(gap)], &mut harness);
    // Both clicks are in one frame: frames of tests are too long for a double click.
    step([true, false, true, false].map(|pressed| button(gap, pressed)).to_vec(), &mut harness);
    harness.run_steps(2);
    let with = left(&harness);
    assert_eq!(with.len(), found.len() + 1, "{with:?}");
    assert!(with[1].start > found[0].end && with[1].end < found[1].start);
    // The menu before the stripes says that something is corrected, and takes it back.
    harness.get_by_role_and_label(Role::ComboBox, "Contacts").click();
    harness.run_steps(3);
    picture("contacts-menu", &mut harness);
    harness.get_by_label("Back to what was found").click();
    harness.run_steps(3);
    assert_eq!((left(&harness), edits(&harness).as_str()), (found.clone(), ""));
    // At the playhead, which stands in a gap.
    let middle = 0.5 * (found[0].end + found[1].start) as f64 / 60.0;
    let seek = segue_session::PlaybackCommand::Seek(middle);
    harness.state_mut().session.apply(Command::Playback(seek)).unwrap();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::ComboBox, "Contacts").click();
    harness.run_steps(3);
    harness.get_by_label("Add a left contact at the playhead").click();
    harness.run_steps(3);
    assert_eq!(left(&harness).len(), found.len() + 1);
}

#[test]
fn menu_of_a_contact_removes_it() {
    for size in [DESK, PHONE] {
        let mut harness = harness(size, LIGHT, page("lab=view&a=walk&play=off"));
        let found = left(&harness);
        let bar = harness.get_by_label("Left foot, contact 1").rect();
        harness.get_by_label("Left foot, contact 1").click_secondary();
        harness.run_steps(3);
        harness.get_by_label("Remove this contact").click();
        harness.run_steps(3);
        assert_eq!(left(&harness), found[1..], "{size}: {bar}");
        picture(&format!("contacts-{}", size.x), &mut harness);
    }
}

/// Only a lab that shows a clip frame by frame has contacts to correct.
#[test]
fn results_have_no_contacts_to_correct() {
    for lab in ["loop", "blend", "register", "make"] {
        let harness = harness(DESK, DARK, page(&format!("lab={lab}&play=off")));
        assert!(harness.query_by_label("Left foot, contact 1").is_none(), "{lab}");
    }
}
