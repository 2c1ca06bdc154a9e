//! Help texts: told to the pointer, opened below their row, and always told to assistive
//! technology.

use super::*;

const HELP: Word = Word::new("Longer is smoother.");

/// Returns a slider, a switch, a menu and a choice, each with a help text. The state says whether
/// all help is shown.
fn rows() -> Harness<'static, bool> {
    bench(false, |all, ui| {
        set_all_help(*all, ui.ctx());
        let row = SliderRow::new(Word::new("Window"), 0.0..=100.0, 15.0).help(HELP);
        slider_row_ui(30.0, &row, ui);
        helped_switch_row_ui(Word::new("Align"), HELP.into(), true, ui);
        let options = [(0, Text::from(Word::new("sharp"))), (1, Word::new("soft").into())];
        helped_choice_row_ui(Word::new("Law").into(), HELP.into(), 0, &options, ui);
        let options = [(0, Word::new("cut")), (1, Word::new("fade"))];
        labelled_segmented_ui(Word::new("Method"), HELP.into(), 0, &options, ui);
    })
}

/// Returns the number of help texts that stand below their rows.
fn shown(harness: &Harness<'_, bool>) -> usize {
    harness.query_all_by_role_and_label(Role::Label, HELP.english()).count()
}

fn is_expanded(label: &str, harness: &Harness<'_, bool>) -> Option<bool> {
    harness.get_by_label(label).accesskit_node().data().is_expanded()
}

#[test]
fn folded_help_is_told_to_assistive_technology() {
    let harness = rows();
    assert_eq!(shown(&harness), 0);
    for (role, label) in [
        (Role::Slider, "Window"),
        (Role::Switch, "Align"),
        (Role::ComboBox, "Law"),
        (Role::RadioGroup, "Method"),
    ] {
        let node = harness.get_by_role_and_label(role, label);
        let description = node.accesskit_node().description();
        assert_eq!(description.as_deref(), Some(HELP.english()), "{label}");
    }
}

#[test]
fn press_of_the_sign_opens_and_closes_the_help_of_its_row_alone() {
    let mut harness = rows();
    for label in ["Window: help", "Align: help", "Law: help", "Method: help"] {
        assert_eq!(is_expanded(label, &harness), Some(false));
        harness.get_by_label(label).click();
        harness.run();
        assert_eq!((shown(&harness), is_expanded(label, &harness)), (1, Some(true)), "{label}");
        harness.get_by_label(label).click();
        harness.run();
        assert_eq!((shown(&harness), is_expanded(label, &harness)), (0, Some(false)), "{label}");
    }
    // Neither the switch nor the menu below the signs was pressed.
    assert!(harness.query_by_label("soft").is_none());
}

#[test]
fn keyboard_is_told_the_help_and_opens_it() {
    let mut harness = rows();
    harness.get_by_label("Window: help").focus();
    harness.run();
    assert_eq!(shown(&harness), 1, "a hint, since the keyboard has no pointer");
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(is_expanded("Window: help", &harness), Some(true));
    assert_eq!(shown(&harness), 1, "below the row");
    harness.get_by_role_and_label(Role::Slider, "Window").focus();
    harness.run();
    assert_eq!(shown(&harness), 1, "it stays");
}

#[test]
fn pointer_on_sign_or_label_is_told_the_help() {
    let mut harness = rows();
    let sign = harness.get_by_label("Window: help").rect().center();
    for at in [sign, sign - vec2(30.0, 0.0)] {
        harness.event(Event::PointerMoved(at));
        harness.run_steps(60);
        assert_eq!(shown(&harness), 1, "{at}");
        harness.event(Event::PointerMoved(pos2(290.0, 230.0)));
        harness.run_steps(60);
        assert_eq!(shown(&harness), 0);
    }
}

#[test]
fn all_help_is_shown_and_hidden_at_once() {
    let mut harness = rows();
    harness.get_by_label("Law: help").click();
    harness.run();
    *harness.state_mut() = true;
    harness.run();
    assert_eq!(shown(&harness), 4);
    // A single one can be closed, until all are asked for again.
    harness.get_by_label("Law: help").click();
    harness.run();
    assert_eq!(shown(&harness), 3);
    *harness.state_mut() = false;
    harness.run();
    assert_eq!(shown(&harness), 0);
}
