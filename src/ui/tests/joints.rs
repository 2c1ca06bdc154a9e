//! Tests of joints that are chosen on the figure.

use super::*;
use segue_motion::skeleton::Role as Joint;

/// Returns the place of a joint on the page.
fn place(joint: Joint, harness: &Harness<'_, Page>) -> egui::Pos2 {
    let page = harness.state();
    let joint = outcome(page).motion.roles().get(joint).expect("a role");
    let camera = page.state.cameras[0].expect("a camera");
    let stage = page.stage;
    let size = glam::Vec2::new(stage.width(), stage.height());
    let at = camera.project(page.state.figures[0][joint], size).expect("in sight");
    stage.min + vec2(at.x, at.y)
}

fn chosen(harness: &Harness<'_, Page>) -> String {
    harness.state().session.params().text(Key::Joint).to_owned()
}

fn click(at: egui::Pos2, harness: &mut Harness<'_, Page>) {
    step(vec![egui::Event::PointerMoved(at)], harness);
    for pressed in [true, false] {
        step(vec![button(at, pressed)], harness);
    }
    harness.run_steps(2);
}

#[test]
fn joint_under_the_pointer_is_named_and_chosen_by_a_click() {
    let mut harness = harness(DESK, DARK, page("lab=view&a=walk&play=off&t=0.5"));
    for (joint, name) in [(Joint::Head, "head"), (Joint::RightHand, "right hand")] {
        let at = place(joint, &harness);
        step(vec![egui::Event::PointerMoved(at)], &mut harness);
        harness.run_steps(2);
        assert!(harness.query_all_by_label(name).count() > 0, "{name} is named");
        assert_ne!(chosen(&harness), name);
        if joint == Joint::Head {
            picture("joint-hovered", &mut harness);
        }
        click(at, &mut harness);
        assert_eq!(chosen(&harness), name);
        assert!(highlights(&harness.state().session, &harness.state().state).joint, "{name}");
    }
    // A drag turns the camera, and chooses nothing.
    let head = place(Joint::Head, &harness);
    step(vec![egui::Event::PointerMoved(head)], &mut harness);
    step(vec![button(head, true)], &mut harness);
    step(vec![egui::Event::PointerMoved(head + vec2(60.0, 0.0))], &mut harness);
    step(vec![button(head + vec2(60.0, 0.0), false)], &mut harness);
    assert_eq!(chosen(&harness), "right hand");
    // A click beside the body takes the mark away.
    let beside = harness.state().stage.left_center() + vec2(30.0, 0.0);
    click(beside, &mut harness);
    assert!(!highlights(&harness.state().session, &harness.state().state).joint);
    assert_eq!(chosen(&harness), "right hand", "its curves stay");
}

#[test]
fn joint_of_any_pane_is_chosen() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,15&play=off"));
    let stage = harness.state().stage;
    let right = Rect::from_min_max(stage.center_top(), stage.max);
    let page = harness.state();
    let joint = outcome(page).motion.roles().get(Joint::LeftFoot).expect("a role");
    let camera = page.state.cameras[1].expect("a camera");
    let size = glam::Vec2::new(right.width(), right.height());
    let at = camera.project(page.state.figures[1][joint], size).expect("in sight");
    click(right.min + vec2(at.x, at.y), &mut harness);
    assert_eq!(chosen(&harness), "left foot");
}
