//! Tests of what is shown of a body on four legs.

use super::*;
use segue_formats::bvh;
use segue_motion::clip::fixtures::QuadrupedWalk;
use std::sync::Arc;

/// Returns a page that shows the walk of a dog, from a file.
fn with_dog(link: &str) -> Page {
    let mut page = page(link);
    let text = bvh::write(&QuadrupedWalk::default().clip(), &bvh::WriteOptions::default());
    page.session.load("dog.bvh", Arc::from(text.into_bytes())).expect("a file of a dog");
    while page.session.work() {}
    let id = loaded(&page).id.clone();
    page.session.apply(Command::Set(vec![(Key::A, Value::Text(id))])).expect("a clip");
    while page.session.work() {}
    page.out = Out::default();
    page
}

#[test]
fn contacts_of_four_feet_are_on_the_timeline() {
    let mut harness = harness(DESK, DARK, with_dog("lab=view&play=off"));
    let tops: Vec<f32> = ["Left hind foot", "Right hind foot", "Left forefoot", "Right forefoot"]
        .into_iter()
        .map(|foot| harness.get_by_label(&format!("{foot}, contact 2")).rect().top())
        .collect();
    assert!(tops.is_sorted_by(|above, below| above + 4.0 < *below), "{tops:?}");
    picture("quadruped-view", &mut harness);
    // A stance of a forefoot is a widget like any other.
    let found = harness.state().session.contact_clips()[0].motion.contacts().clone();
    harness.get_by_label("Right forefoot, contact 2").click();
    harness.run_steps(2);
    harness.key_press(egui::Key::Delete);
    harness.run_steps(3);
    let left = harness.state().session.contact_clips()[0].motion.contacts().clone();
    let fore = segue_motion::skeleton::Foot::ALL[3];
    assert_eq!(left.intervals(fore).len() + 1, found.intervals(fore).len());
    assert!(harness.state().session.query().contains("-RF"));
}

#[test]
fn body_parts_of_a_dog_have_their_own_names() {
    let mut harness = harness(DESK, DARK, with_dog("lab=view&play=off"));
    press("Body parts", &mut harness);
    harness.get_by_label("Both sides").scroll_to_me();
    harness.run_steps(6);
    for part in ["left upper foreleg", "right forefoot", "left hind thigh", "right hind toe"] {
        harness.get_by_label_contains(&format!("{part}: "));
    }
    picture("quadruped-parts", &mut harness);
}

#[test]
fn feet_of_a_dog_are_in_chinese() {
    let pack = chinese::pack();
    let mut page = with_dog("lab=view&play=off");
    page.state.language = chinese::language();
    let mut harness = harness(DESK, DARK, page);
    pack.install_fonts(&harness.ctx);
    harness.run();
    pack.activate(&harness.ctx);
    harness.run();
    for foot in ["左後腳", "右後腳", "左前腳", "右前腳"] {
        harness.get_by_label_contains(&format!("{foot}，第 2 次著地"));
    }
    picture("zh-quadruped-view", &mut harness);
}
