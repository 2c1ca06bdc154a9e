//! The panel in which many files are converted.

use super::*;
use crate::ui::out::ConvertAction;
use crate::ui::state::ConvertShown;
use segue_session::conversion::ConversionRow;
use std::sync::Arc;

fn row(
    source: &str,
    output: Result<&str, &'static str>,
    odd: &'static [&'static str],
) -> ConversionRow {
    ConversionRow {
        source: source.into(),
        clip: Some(("walk".into(), 192, 60.0, 22)),
        output: output.map(str::to_owned).map_err(Into::into),
        odd: odd.iter().map(|sentence| (*sentence).into()).collect(),
    }
}

/// Returns a page whose panel is open, with some files.
fn opened(size: eframe::egui::Vec2) -> Harness<'static, Page> {
    let mut page = page("lab=blend&play=off");
    page.state.convert.is_open = true;
    page.state.convert.shown.waiting = 12;
    harness(size, DARK, page)
}

#[test]
fn many_files_are_converted_with_the_chosen_options() {
    let mut harness = opened(DESK);
    press(text::SAVE_AS.english(), &mut harness);
    press("FBX", &mut harness);
    press(text::CONVERT_BODY.english(), &mut harness);
    press(text::BODY_OF_A.english(), &mut harness);
    picture("convert-desk-dark", &mut harness);
    press(text::CHOOSE_FILES.english(), &mut harness);
    press(text::CONVERT.english(), &mut harness);
    let actions = &harness.state().out.actions;
    let [
        Action::OpenFiles,
        Action::Convert(ConvertAction::Start { how, onto_a, in_one_file: false }),
    ] = actions.as_slice()
    else {
        panic!("{actions:?}")
    };
    assert_eq!((how.format, *onto_a), (ExportFormat::Fbx, true));
}

#[test]
fn chosen_clips_are_saved_together_in_a_format_that_holds_several() {
    let mut page = page("lab=blend&play=off");
    page.state.library.picked.insert("walk".into());
    let mut harness = harness(DESK, DARK, page);
    harness.run();
    assert!(harness.query_by_label(text::SAVE_TOGETHER.english()).is_none());
    harness.state_mut().state.library.picked.insert("run".into());
    harness.run();
    press(text::SAVE_TOGETHER.english(), &mut harness);
    let clips = ConvertAction::AddClips(vec!["walk".into(), "run".into()]);
    assert_eq!(harness.state().out.actions, [Action::Convert(clips)]);
    harness.state_mut().state.convert.shown.waiting = 2;
    harness.state_mut().out.actions.clear();
    harness.run();
    press(text::CONVERT.english(), &mut harness);
    let actions = &harness.state().out.actions;
    let [Action::Convert(ConvertAction::Start { how, in_one_file: true, .. })] = actions.as_slice()
    else {
        panic!("{actions:?}")
    };
    assert_eq!(how.format, ExportFormat::Glb);
    // Of a format for one clip each gets a file.
    press(text::SAVE_AS.english(), &mut harness);
    press("BVH", &mut harness);
    harness.state_mut().out.actions.clear();
    press(text::CONVERT.english(), &mut harness);
    let actions = &harness.state().out.actions;
    let start = ConvertAction::Start {
        how: ExportOptions { format: ExportFormat::Bvh, ..*how_of(actions) },
        onto_a: false,
        in_one_file: false,
    };
    assert_eq!(actions.as_slice(), [Action::Convert(start)]);
}

/// Returns the options of the only conversion that is asked for.
fn how_of(actions: &[Action]) -> &ExportOptions {
    match actions {
        [Action::Convert(ConvertAction::Start { how, .. })] => how,
        other => panic!("{other:?}"),
    }
}

#[test]
fn conversion_under_way_can_be_stopped() {
    let mut harness = opened(DESK);
    harness.state_mut().state.convert.shown.progress = Some((0.4, 8, 20));
    harness.run();
    assert!(harness.query_by_label(text::CONVERT.english()).is_none());
    picture("convert-under-way-dark", &mut harness);
    press("Cancel", &mut harness);
    assert_eq!(harness.state().out.actions, [Action::Convert(ConvertAction::Stop)]);
}

#[test]
fn conversion_table_begins_with_what_failed() {
    for (name, size) in [("convert-done-desk", DESK), ("convert-done-phone", PHONE)] {
        let mut harness = opened(size);
        let rows = vec![
            row("set/walk.fbx", Ok("set/walk.bvh"), &[]),
            row("set/robot.csv", Ok("set/robot.bvh"), &["the format has no frame rate"]),
            row("broken/cut.bvh", Err("found the end of the file, expected `}`"), &[]),
        ];
        let shown = ConvertShown { waiting: 0, progress: None, rows: Arc::new(rows) };
        harness.state_mut().state.convert.shown = shown;
        harness.run();
        picture(name, &mut harness);
        let top = |label: &str| harness.get_by_label(label).rect().top();
        let (failed, odd) = (top("broken/cut.bvh"), top("set/robot.csv → set/robot.bvh"));
        assert!(failed < odd && odd < top("set/walk.fbx → set/walk.bvh"));
        harness.get_by_label("2 saved, 1 of them with warnings; 1 failed");
    }
}

#[test]
fn chosen_clips_go_to_the_panel_of_conversions() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    harness.state_mut().state.library.picked.insert("walk".into());
    harness.state_mut().state.library.picked.insert("run".into());
    harness.run();
    press(text::CONVERT_CLIPS.english(), &mut harness);
    let clips = ConvertAction::AddClips(vec!["walk".into(), "run".into()]);
    assert_eq!(harness.state().out.actions, [Action::Convert(clips)]);
    assert!(harness.state().state.convert.is_open);
    // Escape closes the panel.
    harness.key_press(eframe::egui::Key::Escape);
    harness.run();
    assert!(!harness.state().state.convert.is_open);
}

/// Keys choose a line of a menu as a pointer does: the menu closes, and they go on at its button.
#[test]
fn menu_closes_after_a_choice_by_keys() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    let opener = |harness: &Harness<'_, Page>| {
        harness.get_by_label(text::SHARE.english()).accesskit_node().is_focused()
    };
    harness.get_by_label(text::SHARE.english()).focus();
    harness.run();
    harness.key_press(eframe::egui::Key::Enter);
    harness.run();
    harness.get_by_label(text::CONVERT_FILES.english()).focus();
    harness.run();
    harness.key_press(eframe::egui::Key::Enter);
    harness.run();
    assert!(harness.state().state.convert.is_open);
    assert!(
        harness.query_by_role_and_label(Role::MenuItem, text::CONVERT_FILES.english()).is_none()
    );
    assert!(opener(&harness), "the button of the menu has the keyboard");
    harness.key_press(eframe::egui::Key::Escape);
    harness.run();
    assert!(!harness.state().state.convert.is_open);
}
