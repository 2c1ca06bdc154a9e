//! Tests of the curves of a joint on the timeline.

use super::*;
use segue_motion::skeleton::Role as Joint;

/// Returns the texts of all labels with a part.
fn labels(part: &str, harness: &Harness<'_, Page>) -> Vec<String> {
    let nodes = harness.query_all_by_label_contains(part);
    nodes.filter_map(|node| node.accesskit_node().value()).collect()
}

#[test]
fn values_of_all_curves_are_told_at_the_pointer() {
    let link = "lab=view&a=walk&play=off&joint=left shin&curve=height&more_curves=angle,speed";
    let mut harness = harness(DESK, DARK, page(link));
    let area = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let clip = Arc::clone(outcome(harness.state()).motion.clip());
    let x = area.left() + 0.75 / clip.duration_secs() as f32 * area.width();
    step(vec![egui::Event::PointerMoved(egui::pos2(x, area.bottom() - 50.0))], &mut harness);
    harness.run_steps(2);
    picture("curves-hovered", &mut harness);
    let roles = outcome(harness.state()).motion.roles();
    let knee = roles.get(Joint::LeftShin).expect("a knee");
    let height = clip.world_pose(45).positions[knee].y;
    let wanted = format!("0.75 s · left shin height {height:.2} m");
    assert_eq!(labels("0.75 s ·", &harness), [wanted]);
    assert_eq!(
        (labels("left shin angle", &harness).len(), labels("left shin speed", &harness).len()),
        (1, 1)
    );
}

#[test]
fn curves_are_chosen_in_the_menu_at_their_head() {
    let mut harness = harness(DESK, LIGHT, page("lab=blend&play=off&t=1.5"));
    let plotted = |harness: &Harness<'_, Page>| {
        let curves = harness.state().session.params().plotted_curves();
        curves.into_iter().map(choices::Curve::word).collect::<Vec<_>>().join(" ")
    };
    let item = |name: &str, harness: &mut Harness<'_, Page>| {
        harness.get_by_role_and_label(Role::MenuItem, name).click();
        harness.run_steps(3);
    };
    harness.get_by_role_and_label(Role::ComboBox, text::CURVES.english()).click();
    harness.run_steps(3);
    // The menu stays open.
    for (name, wanted) in [
        ("height", "speed height"),
        ("angle", "speed height angle"),
        ("turn rate", "speed height angle turn"),
        ("distance", "speed height angle turn"),
        ("speed", "height angle turn"),
        ("distance", "height angle turn distance"),
    ] {
        item(name, &mut harness);
        assert_eq!(plotted(&harness), wanted, "after {name}");
    }
    item("A and B", &mut harness);
    assert!(harness.state().session.query().contains("curves_of=sources"));
    item("A, B and result", &mut harness);
    picture("curves-menu", &mut harness);
    harness.key_press(Keyboard::Escape);
    harness.run_steps(3);
    picture("curves-four", &mut harness);
    assert!(harness.query_by_role_and_label(Role::MenuItem, "height").is_none());
    for size in [vec2(1024.0, 768.0), vec2(1280.0, 720.0)] {
        let link = format!("{}&play=off", harness.state().session.query());
        let theme = if size.x > 1200.0 { HALL } else { DARK };
        let mut small = super::harness(size, theme, page(&link));
        picture(&format!("curves-{}", size.x), &mut small);
    }
}
