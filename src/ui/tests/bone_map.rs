//! The editor of body parts.

use super::*;
use segue_motion::skeleton::{Role as Part, RoleSource};

/// Returns a harness with the body parts of the clip unfolded.
fn opened(size: Vec2, theme: Theme, link: &str) -> Harness<'static, Page> {
    let mut page = with_file(link);
    let id = loaded(&page).id.clone();
    page.session.apply(Command::Set(vec![(Key::A, Value::Text(id))])).expect("a clip");
    let mut harness = harness(size, theme, page);
    press("Body parts", &mut harness);
    harness.get_by_label("Both sides").scroll_to_me();
    harness.run_steps(6);
    harness
}

fn joint_name(harness: &Harness<'_, Page>, part: Part) -> Option<String> {
    let motion = loaded(harness.state()).motion.clone().expect("a motion");
    let joint = motion.roles().get(part)?;
    Some(motion.clip().skeleton().joints()[joint].name.clone())
}

fn source(harness: &Harness<'_, Page>, part: Part) -> Option<RoleSource> {
    loaded(harness.state()).motion.as_ref().expect("a motion").roles().source(part)
}

/// Returns the place of the slot of a part.
fn slot_rect(part: &str, harness: &Harness<'_, Page>) -> Rect {
    let name = format!("{part}: ");
    let mut slots = harness.get_all_by_label_contains(&name);
    slots.find(|node| node.accesskit_node().role() == Role::Button).expect("a slot").rect()
}

/// Presses the slot of a part, by pointer, after scrolling to it.
fn press_slot(part: &str, harness: &mut Harness<'_, Page>) {
    let name = format!("{part}: ");
    let is_button = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == Role::Button;
    harness.get_all_by_label_contains(&name).find(is_button).expect("a button").scroll_to_me();
    harness.run_steps(6);
    let at = slot_rect(part, harness).center();
    step(vec![egui::Event::PointerMoved(at), button(at, true)], harness);
    step(vec![button(at, false)], harness);
    harness.run_steps(3);
}

/// Returns the place of a bone in the list: in that of a slot if one is open, which comes before
/// the list below the body.
fn bone_row(name: &str, harness: &Harness<'_, Page>) -> Rect {
    let rows = harness.get_all_by_label(name);
    let mut rows = rows.filter(|node| node.accesskit_node().role() == Role::MenuItem);
    rows.next().expect("a row").rect()
}

/// Presses a bone in the list of a slot.
fn press_bone(name: &str, harness: &mut Harness<'_, Page>) {
    let at = bone_row(name, harness).center();
    step(vec![egui::Event::PointerMoved(at), button(at, true)], harness);
    step(vec![button(at, false)], harness);
    harness.run_steps(3);
}

#[test]
fn bone_is_chosen_by_two_presses_on_both_sides() {
    let mut harness = opened(DESK, DARK, "lab=view&play=off");
    let shin = [Part::LeftShin, Part::RightShin].map(|part| joint_name(&harness, part).unwrap());
    press_slot("left foot", &mut harness);
    assert_eq!(
        harness.state().session.params().text(Key::Joint),
        "left foot",
        "it is marked on the stage"
    );
    picture("bone-map-list", &mut harness);
    press_bone(&shin[0], &mut harness);
    assert_eq!(joint_name(&harness, Part::LeftFoot), Some(shin[0].clone()));
    assert_eq!(joint_name(&harness, Part::RightFoot), Some(shin[1].clone()));
    assert_eq!(joint_name(&harness, Part::LeftShin), None, "a bone has one part");
    assert_eq!(source(&harness, Part::LeftFoot), Some(RoleSource::ByHand));
    assert!(harness.query_by_label_contains("Without a bone: left shin, right shin").is_some());
    press("Reset", &mut harness);
    harness.run_steps(3);
    assert_eq!(joint_name(&harness, Part::LeftShin), Some(shin[0].clone()));
    assert_eq!(source(&harness, Part::LeftFoot), Some(RoleSource::ByName));
    // One step each.
    for name in [Some(shin[0].clone()), None] {
        harness.state_mut().session.apply(Command::Undo).unwrap();
        harness.run_steps(2);
        let is_foot = joint_name(&harness, Part::LeftFoot) == name;
        assert!(is_foot || name.is_none());
    }
    assert_eq!(joint_name(&harness, Part::LeftShin), Some(shin[0].clone()));
}

#[test]
fn bone_is_dragged_onto_a_slot() {
    let mut harness = opened(vec2(1440.0, 1100.0), DARK, "lab=view&play=off");
    press("Both sides", &mut harness);
    harness.run_steps(2);
    let hips = joint_name(&harness, Part::Hips).unwrap();
    let from = bone_row(&hips, &harness).center();
    let slot = slot_rect("left toe", &harness);
    step(vec![egui::Event::PointerMoved(from), button(from, true)], &mut harness);
    for part in [0.3, 0.7, 1.0] {
        let at = from + part * (slot.center() - from);
        step(vec![egui::Event::PointerMoved(at)], &mut harness);
    }
    picture("bone-map-drag", &mut harness);
    step(vec![button(slot.center(), false)], &mut harness);
    harness.run_steps(3);
    assert_eq!(joint_name(&harness, Part::LeftToe), Some(hips));
    assert_eq!(source(&harness, Part::RightToe), Some(RoleSource::ByName), "one side alone");
    assert_eq!(joint_name(&harness, Part::Hips), None);
}

#[test]
fn bone_is_found_by_typing_and_enter() {
    let mut harness = opened(DESK, DARK, "lab=view&play=off");
    press_slot("head", &mut harness);
    // The search has the focus.
    assert!(harness.query_by_label("No bone").is_some());
    step(vec![egui::Event::Text("tail".to_owned())], &mut harness);
    harness.run_steps(2);
    assert!(harness.query_by_label("No bone").is_none());
    harness.key_press(Keyboard::Enter);
    harness.run_steps(3);
    assert_eq!(joint_name(&harness, Part::Head).as_deref(), Some("Tail"));
    // A part is also freed.
    press_slot("head", &mut harness);
    press_bone("No bone", &mut harness);
    assert_eq!(joint_name(&harness, Part::Head), None);
}

#[test]
fn map_is_saved_as_a_file_that_is_read_back() {
    let mut harness = opened(DESK, DARK, "lab=view&play=off");
    press("Save as JSON", &mut harness);
    harness.run_steps(2);
    let saved = harness.state().out.actions.iter().find_map(|action| match action {
        out::Action::SaveText { name: "bone-map.json", text, .. } => Some(text.clone()),
        _ => None,
    });
    let map = segue_session::bone_map::BoneMap::from_json(saved.unwrap().as_bytes()).unwrap();
    let motion = loaded(harness.state()).motion.clone().expect("a motion");
    assert_eq!(map.roles[&Part::Head].as_deref(), joint_name(&harness, Part::Head).as_deref());
    assert_eq!(
        map.roles_for(motion.clip().skeleton(), motion.roles()).as_ref(),
        Some(motion.roles())
    );
}

#[test]
fn slots_are_as_large_as_a_fingertip_on_a_phone() {
    let touch = Theme { touch: true, ..DARK };
    let harness = opened(PHONE, touch, "lab=view&play=off");
    let slots: Vec<Rect> = harness
        .get_all_by_label_contains(", found by name")
        .filter(|node| node.accesskit_node().role() == Role::Button)
        .map(|node| node.rect())
        .collect();
    assert_eq!(slots.len(), Part::COUNT);
    for (index, slot) in slots.iter().enumerate() {
        assert!(slot.width() >= 44.0 && slot.height() >= 44.0, "{slot:?}");
        assert!(slot.left() >= 0.0 && slot.right() <= PHONE.x, "{slot:?}");
        assert!(slots[..index].iter().all(|other| !other.intersects(slot.shrink(0.5))));
    }
}

#[test]
fn editor_is_drawn_in_both_themes_and_languages() {
    for (name, size, theme, link) in [
        ("dark", DESK, DARK, "lab=view&play=off"),
        ("light", DESK, LIGHT, "lab=view&play=off"),
        ("projector", vec2(1280.0, 720.0), HALL, "lab=view&play=off"),
        ("phone", PHONE, Theme { touch: true, ..DARK }, "lab=view&play=off"),
        ("zh", DESK, DARK, "lab=view&play=off"),
    ] {
        let mut harness = opened(size, theme, link);
        press_slot("left foot", &mut harness);
        let motion = loaded(harness.state()).motion.clone().expect("a motion");
        let id = loaded(harness.state()).id.clone();
        let hips = motion.roles().get(Part::Hips);
        let changes =
            vec![(Part::LeftToe, hips), (Part::RightShin, None), (Part::RightUpperArm, None)];
        let session = &mut harness.state_mut().session;
        session.apply(Command::File(FileCommand::SetRoles(id, changes))).unwrap();
        harness.run_steps(3);
        if name == "zh" {
            let pack = chinese::pack();
            harness.state_mut().state.language = chinese::language();
            pack.install_fonts(&harness.ctx);
            harness.run();
            pack.activate(&harness.ctx);
            harness.run();
        }
        picture(&format!("bone-map-{name}"), &mut harness);
    }
}
