//! The foot of the panel: keeping and saving the result, always in sight.

use super::*;
use eframe::egui::pos2;

const TABLET: Vec2 = vec2(800.0, 768.0);

fn node_of<'a>(label: &'a str, harness: &'a Harness<'_, Page>) -> egui_kittest::Node<'a> {
    harness.get_by_role_and_label(Role::Button, label)
}

#[test]
fn keep_and_save_are_in_sight_in_every_lab_and_layout() {
    let Kind::Choice(labs) = Key::Lab.param().kind else { panic!() };
    for (size, theme) in [
        (DESK, DARK),
        (vec2(1280.0, 720.0), HALL),
        (vec2(1024.0, 768.0), LIGHT),
        (TABLET, DARK),
        (PHONE, LIGHT),
    ] {
        for lab in labs {
            let link = format!("lab={}&play=off", lab.key);
            let mut harness = harness(size, theme, page(&link));
            picture(&format!("footer-{}-{}-{}", lab.key, size.x, theme.dark), &mut harness);
            let whole = Rect::from_min_size(egui::Pos2::ZERO, size);
            let buttons = [text::KEEP, text::SAVE_MENU]
                .map(|label| node_of(label.english(), &harness).rect());
            for button in buttons {
                assert!(whole.contains_rect(button), "{} {size}: {button:?}", lab.key);
            }
            assert!(
                !buttons[0].intersects(buttons[1]) && buttons[0].height() >= 24.0,
                "{} {size}: {buttons:?}",
                lab.key
            );
        }
    }
}

#[test]
fn result_is_kept_and_saved_from_the_footer() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    let entries = |harness: &Harness<'_, Page>| harness.state().session.library().entries().len();
    let before = entries(&harness);
    node_of(text::KEEP.english(), &harness).click();
    harness.run();
    assert_eq!(entries(&harness), before + 1);
    let is_open = |harness: &Harness<'_, Page>| {
        node_of(text::SAVE_MENU.english(), harness).accesskit_node().data().is_expanded()
    };
    assert_eq!(is_open(&harness), Some(false));
    assert!(harness.query_by_label(text::SAVE.english()).is_none());
    node_of(text::SAVE_MENU.english(), &harness).click();
    harness.run();
    assert_eq!(is_open(&harness), Some(true));
    picture("footer-options", &mut harness);
    press(text::SAVE_AS.english(), &mut harness);
    press("GLB", &mut harness);
    harness.run();
    harness.get_by_label(text::SAVE_BODY.english());
    node_of(text::SAVE.english(), &harness).click();
    harness.run();
    let [Action::Save { which, how }] = harness.state().out.actions.as_slice() else {
        panic!("{:?}", harness.state().out.actions)
    };
    assert_eq!((which.as_str(), how.format), ("result:0", ExportFormat::Glb));
    node_of(text::SAVE_MENU.english(), &harness).click();
    harness.run();
    assert_eq!(is_open(&harness), Some(false));
}

#[test]
fn pane_that_is_saved_is_chosen_in_the_footer() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,10&play=off"));
    press(text::SAVED_PANE.english(), &mut harness);
    press("10 frames", &mut harness);
    node_of(text::SAVE_MENU.english(), &harness).click();
    harness.run();
    node_of(text::SAVE.english(), &harness).click();
    harness.run();
    let [Action::Save { which, .. }] = harness.state().out.actions.as_slice() else {
        panic!("{:?}", harness.state().out.actions)
    };
    assert_eq!(which, "result:1");
}

#[test]
fn footer_without_a_result_says_why() {
    for (size, theme) in [(DESK, DARK), (PHONE, LIGHT)] {
        // A clip that stands still has no gait.
        let mut harness = harness(size, theme, page("lab=speed&a=idle&play=off"));
        assert!(harness.state().session.panes()[0].problem.is_some());
        for label in [text::KEEP, text::SAVE_MENU] {
            assert!(node_of(label.english(), &harness).accesskit_node().is_disabled());
        }
        let reason = text::NOTHING_TO_KEEP.english();
        assert_eq!(harness.query_all_by_label(reason).count(), 1, "once for both buttons");
        picture(&format!("footer-refused-{}", size.x), &mut harness);
        // Only the pointer's hint repeats it.
        let keep = node_of(text::KEEP.english(), &harness).rect().center();
        harness.hover_at(keep);
        harness.run_steps(40);
        assert_eq!(harness.query_all_by_label(reason).count(), 2);
    }
}

#[test]
fn unchanged_clip_is_saved_and_not_kept() {
    let mut harness = harness(DESK, DARK, page("lab=view&a=run&play=off"));
    let is_disabled = |label: Word, harness: &Harness<'_, Page>| -> bool {
        node_of(label.english(), harness).accesskit_node().is_disabled()
    };
    assert!(is_disabled(text::KEEP, &harness) && !is_disabled(text::SAVE_MENU, &harness));
    harness.get_by_label(text::KEPT_ALREADY.english());
    node_of(text::SAVE_MENU.english(), &harness).click();
    harness.run();
    node_of(text::SAVE.english(), &harness).click();
    harness.run();
    let [Action::Save { which, .. }] = harness.state().out.actions.as_slice() else {
        panic!("{:?}", harness.state().out.actions)
    };
    assert_eq!(which, "run");
    // A clip that is moved is another one.
    let values = vec![(Key::PlaceX, Value::Number(2.0))];
    harness.state_mut().session.apply(Command::Set(values)).expect("a place");
    while harness.state_mut().session.work() {}
    harness.run();
    assert!(!is_disabled(text::KEEP, &harness));
    node_of(text::SAVE.english(), &harness).click();
    harness.run();
    let Some(Action::Save { which, .. }) = harness.state().out.actions.last() else { panic!() };
    assert_eq!(which, "result:0");
}

/// A live drive is kept; it is saved as a file when it is replayed.
#[test]
fn live_drive_is_kept_and_not_saved() {
    let link = "lab=match&mirrored=off&match_clips=idle,walk,walk_left";
    let mut harness = harness(DESK, DARK, page(link));
    harness.state_mut().session.tick(0.5);
    harness.run_steps(3);
    assert!(harness.state().session.is_driven());
    assert!(node_of(text::SAVE_MENU.english(), &harness).accesskit_node().is_disabled());
    harness.get_by_label(text::LIVE_NOT_SAVED.english());
}

#[test]
fn every_lab_has_a_line_about_it_and_more() {
    let Kind::Choice(labs) = Key::Lab.param().kind else { panic!() };
    for lab in labs {
        let mut harness = harness(DESK, DARK, page(&format!("lab={}&play=off", lab.key)));
        let sign = format!("{} lab: help", lab.label);
        let is_open = |harness: &Harness<'_, Page>| {
            harness.get_by_label(&sign).accesskit_node().data().is_expanded()
        };
        assert_eq!(is_open(&harness), Some(false), "{}", lab.key);
        harness.get_by_label(&sign).click();
        harness.run();
        assert_eq!(is_open(&harness), Some(true), "{}", lab.key);
    }
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    harness.get_by_label(text::BLEND_ABOUT.english());
    assert!(harness.query_by_label(text::BLEND_DETAILS.english()).is_none());
    press(text::ALL_HELP.english(), &mut harness);
    harness.get_by_label(text::BLEND_DETAILS.english());
    harness.get_by_label(Key::BlendWindow.param().help);
    picture("help-all-desk", &mut harness);
    // It stays in another lab, until it is switched off.
    harness.key_press(Keyboard::Num1);
    harness.run();
    harness.get_by_label(text::VIEW_DETAILS.english());
    press(text::ALL_HELP.english(), &mut harness);
    assert!(harness.query_by_label(text::VIEW_DETAILS.english()).is_none());
}

#[test]
fn save_options_of_a_low_panel_scroll_and_cover_nothing() {
    for (size, theme) in [(PHONE, Theme { touch: true, ..DARK }), (vec2(1280.0, 720.0), HALL)] {
        let mut harness = harness(size, theme, page("compare=blend_window:30,10&play=off"));
        node_of(text::SAVE_MENU.english(), &harness).click();
        harness.run();
        picture(&format!("footer-low-{}", size.x), &mut harness);
        let stage = harness.state().stage;
        let whole = Rect::from_min_max(pos2(0.0, stage.bottom()), size.to_pos2());
        let rows = [text::SAVED_PANE, text::KEEP, text::SAVE_MENU, text::SAVE];
        let rows = rows.map(|label| harness.get_by_label(label.english()).rect());
        for (index, row) in rows.into_iter().enumerate() {
            assert!(size.x > 500.0 || whole.contains_rect(row), "{index}: {row:?} in {whole:?}");
            assert!(row.bottom() <= size.y, "{index}: {row:?}");
        }
        assert!(rows[0].bottom() <= rows[3].top(), "{rows:?}");
        assert!(rows[3].bottom() <= rows[1].top(), "{rows:?}");
    }
}
