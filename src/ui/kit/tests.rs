//! Tests of the widgets: presses, drags, typing and screen readers.

use super::notice::notice_ui;
use super::*;
use crate::ui::language::{Text, Word};
use crate::ui::theme::Theme;
use eframe::egui::{
    self, Event, Key, Modifiers, PointerButton, Pos2, Role, ScrollArea, Ui, accesskit::Toggled,
    pos2, vec2,
};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use segue_text::Message;

mod help;
mod timeline;

/// Returns a panel 300 points wide with one widget and a state.
fn bench<S: 'static>(state: S, widget: impl Fn(&mut S, &mut Ui) + 'static) -> Harness<'static, S> {
    let builder = Harness::builder()
        .with_size(vec2(300.0, 240.0))
        .with_max_steps(120)
        .with_step_dt(1.0 / 60.0)
        .with_context_setup(|ctx| Theme::default().install(ctx));
    let mut harness = builder.build_ui_state(move |ui, state: &mut S| widget(state, ui), state);
    harness.run();
    harness
}

fn press<S>(harness: &mut Harness<'_, S>, pos: Pos2, pressed: bool) {
    harness.event(Event::PointerMoved(pos));
    harness.event(Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    });
    harness.step();
}

fn move_to<S>(harness: &mut Harness<'_, S>, pos: Pos2, modifiers: Modifiers) {
    harness.event(Event::ModifiersChanged(modifiers));
    harness.event(Event::PointerMoved(pos));
    harness.step();
}

/// A slider's value, and the input to it.
#[derive(Default)]
struct Slid {
    value: f64,
    source: Source,
    changes: usize,
    resets: usize,
    started: usize,
    ended: usize,
}

fn slider(value: f64, source: Source) -> Harness<'static, Slid> {
    bench(Slid { value, source, ..Slid::default() }, |state, ui| {
        let row = SliderRow::new(Word::new("Blend window"), 0.0..=100.0, 15.0)
            .step(1.0)
            .unit(Word::new("frames"))
            .source(state.source);
        let out = slider_row_ui(state.value, &row, ui);
        state.changes += usize::from(out.changed.is_some());
        state.resets += usize::from(out.reset);
        state.started += usize::from(out.drag_started);
        state.ended += usize::from(out.drag_ended);
        state.value = out.changed.unwrap_or(state.value);
    })
}

#[test]
fn slider_under_arrow_keys_steps_and_with_shift_finely() {
    let mut harness = slider(30.0, Source::Manual);
    harness.get_by_label("Blend window").focus();
    harness.run();
    for (key, modifiers, expected) in [
        (Key::ArrowRight, Modifiers::NONE, 31.0),
        (Key::ArrowLeft, Modifiers::NONE, 30.0),
        (Key::ArrowUp, Modifiers::SHIFT, 30.1),
        (Key::PageDown, Modifiers::NONE, 20.0),
        (Key::End, Modifiers::NONE, 100.0),
        (Key::ArrowRight, Modifiers::NONE, 100.0),
        (Key::Home, Modifiers::NONE, 0.0),
        (Key::ArrowLeft, Modifiers::NONE, 0.0),
    ] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
        assert!(
            (harness.state().value - expected).abs() < 1e-9,
            "{key:?}: {}",
            harness.state().value
        );
    }
    assert_eq!(harness.state().started, 0);
}

#[test]
fn slider_double_clicked_on_its_label_is_reset() {
    let mut harness = slider(30.0, Source::ManualOverAuto);
    // The label is a hidden target above the track; the track has the name.
    let track = harness.get_by_label("Blend window").rect();
    let label = pos2(track.left() + 20.0, track.top() - 6.0);
    for pressed in [true, false, true, false] {
        press(&mut harness, label, pressed);
    }
    assert_eq!((harness.state().resets, harness.state().value), (1, 15.0));
    assert_eq!(harness.state().started, 0, "the label does not drag");
}

#[test]
fn slider_dragged_by_its_handle_moves_in_one_gesture() {
    let mut harness = slider(50.0, Source::Manual);
    let track = harness.get_by_label("Blend window").rect();
    // A press beside the middle of the handle keeps the value.
    let start = pos2(track.center().x + 5.0, track.bottom() - 9.0);
    press(&mut harness, start, true);
    assert_eq!((harness.state().value, harness.state().started), (50.0, 1));
    let tenth = (track.width() - 14.0) / 10.0;
    move_to(&mut harness, start + vec2(tenth, 0.0), Modifiers::NONE);
    assert_eq!(harness.state().value, 60.0);
    // With Shift, a drag moves a tenth of the way, in fine steps.
    move_to(&mut harness, start + vec2(2.0 * tenth, 0.0), Modifiers::SHIFT);
    assert!((harness.state().value - 61.0).abs() < 0.11, "{}", harness.state().value);
    // Beyond the end the value is the end; the way back is as long as the way there.
    move_to(&mut harness, start + vec2(30.0 * tenth, 0.0), Modifiers::NONE);
    assert_eq!(harness.state().value, 100.0);
    press(&mut harness, start + vec2(30.0 * tenth, 0.0), false);
    assert_eq!((harness.state().started, harness.state().ended), (1, 1));
    // A press elsewhere on the track moves the value there.
    press(&mut harness, pos2(track.left() + 7.0 + 2.0 * tenth, start.y), true);
    assert_eq!((harness.state().value, harness.state().started), (20.0, 2));
}

#[test]
fn slider_value_can_be_typed_and_escape_keeps_it() {
    let mut harness = slider(30.0, Source::Manual);
    let value = "Blend window: Click to type a value";
    for (typed, key, expected) in [
        ("42", Key::Enter, 42.0),
        ("77", Key::Escape, 42.0),
        ("1000 frames", Key::Enter, 100.0),
        ("x", Key::Enter, 100.0),
    ] {
        harness.get_by_label(value).click();
        harness.run();
        // The field has the number selected: typing overwrites it.
        harness.event(Event::Text(typed.to_owned()));
        harness.step();
        harness.key_press(key);
        harness.run();
        assert_eq!(harness.state().value, expected, "after {typed} and {key:?}");
        assert!(harness.query_by_label(value).is_some(), "the field is gone after {typed}");
    }
}

#[test]
fn slider_dragged_from_automatic_is_set() {
    let mut harness = slider(50.0, Source::Auto);
    assert_eq!(harness.state().changes, 0);
    let track = harness.get_by_label("Blend window").rect();
    let y = track.bottom() - 9.0;
    press(&mut harness, pos2(track.left() + 7.0, y), true);
    press(&mut harness, pos2(track.left() + 7.0, y), false);
    assert_eq!((harness.state().value, harness.state().changes), (0.0, 1));
}

#[test]
fn slider_reset_by_auto_is_automatic() {
    let mut harness = slider(30.0, Source::ManualOverAuto);
    harness.get_by_label("Blend window: auto").click();
    harness.run();
    assert_eq!(harness.state().resets, 1);
    harness.state_mut().source = Source::Auto;
    harness.run();
    assert!(
        harness.query_by_label("Blend window: auto").is_none(),
        "nothing to press while the app decides"
    );
}

#[test]
fn text_field_is_finished_by_enter_and_not_by_escape() {
    let mut harness = bench((String::new(), 0), |(text, committed), ui| {
        *committed +=
            usize::from(text_field_ui(Word::new("Name"), Word::new("a name"), text, ui).committed);
        value_row_ui(Word::new("Distance"), "4.1", Word::new("cm"), ui);
    });
    for (typed, key, expected) in [("draft", Key::Escape, 0), ("done", Key::Enter, 1)] {
        harness.get_by_label("Name").click();
        harness.run();
        harness.event(Event::Text(typed.to_owned()));
        harness.step();
        harness.key_press(key);
        harness.run();
        assert_eq!(harness.state().1, expected, "{key:?}");
    }
    assert!(harness.state().0.contains("done"), "{}", harness.state().0);
    assert!(harness.query_by_label("Distance: 4.1 cm").is_some());
}

#[test]
fn slider_can_be_read_and_set_by_screen_readers() {
    let mut harness = slider(30.0, Source::Manual);
    let node = harness.get_by_label("Blend window");
    assert_eq!(node.accesskit_node().numeric_value(), Some(30.0));
    assert_eq!(node.value().as_deref(), Some("30.00 frames"));
    node.set_value_accesskit(12.0);
    harness.run();
    assert_eq!(harness.state().value, 12.0);
    harness.get_by_label("Blend window").increment_accesskit();
    harness.run();
    assert_eq!(harness.state().value, 13.0);
}

#[test]
fn switch_turns_by_click_and_by_key() {
    let mut harness = bench(false, |on, ui| {
        if let Some(asked) = switch_row_ui(Word::new("Foot lock"), *on, ui) {
            *on = asked;
        }
    });
    assert_eq!(harness.get_by_label("Foot lock").accesskit_node().toggled(), Some(Toggled::False));
    harness.get_by_label("Foot lock").click();
    harness.run();
    assert!(*harness.state());
    assert_eq!(harness.get_by_label("Foot lock").accesskit_node().toggled(), Some(Toggled::True));
    harness.get_by_label("Foot lock").focus();
    harness.run();
    harness.key_press(Key::Space);
    harness.run();
    assert!(!*harness.state());
}

#[test]
fn segment_is_chosen_by_click_and_by_arrows() {
    let mut harness = bench((0, 0), |(chosen, asked), ui| {
        if let Some(value) = segmented_ui(
            Word::new("Method"),
            *chosen,
            &[(0, Word::new("cut")), (1, Word::new("dissolve")), (2, Word::new("inertialize"))],
            ui,
        ) {
            (*chosen, *asked) = (value, *asked + 1);
        }
    });
    harness.get_by_label("inertialize").click();
    harness.run();
    assert_eq!(*harness.state(), (2, 1));
    // Choosing the chosen option again changes nothing.
    harness.get_by_label("inertialize").click();
    harness.run();
    assert_eq!(*harness.state(), (2, 1));
    harness.get_by_label("inertialize").focus();
    harness.run();
    harness.key_press(Key::ArrowLeft);
    harness.run();
    assert_eq!(harness.state().0, 1);
    assert!(harness.get_by_label("dissolve").is_focused(), "the focus goes along");
    harness.key_press(Key::ArrowLeft);
    harness.run();
    harness.key_press(Key::ArrowLeft);
    harness.run();
    assert_eq!(harness.state().0, 0, "no way beyond the first");
}

#[test]
fn choice_opens_closes_and_returns_the_option() {
    let mut harness = bench('a', |chosen, ui| {
        if let Some(value) = choice_row_ui(
            Word::new("Blend in"),
            *chosen,
            &[('a', Word::new("joint rotations")), ('b', Word::new("world space"))],
            ui,
        ) {
            *chosen = value;
        }
    });
    assert!(harness.query_by_label("world space").is_none());
    harness.get_by_label("Blend in").click();
    harness.run();
    harness.get_by_label("world space").click();
    harness.run();
    assert_eq!(*harness.state(), 'b');
    assert!(harness.query_by_label("world space").is_none(), "it closes after the choice");
    assert_eq!(harness.get_by_label("Blend in").value().as_deref(), Some("world space"));
}

#[test]
fn clip_row_tells_clicks_on_row_letter_and_actions_apart() {
    use ClipRowEvent::{Action, Chosen, Letter};
    let mut harness = bench(Vec::new(), |done: &mut Vec<ClipRowEvent>, ui| {
        let actions = [(Icon::Pencil, Word::new("Rename")), (Icon::Trash, Word::new("Remove"))];
        let letter = |part, held, name| SlotLetter { part, held, name: Text::Data(name) };
        let letters =
            [letter(Part::A, true, "Use walk as A"), letter(Part::B, false, "Use walk as B")];
        let row = ClipRow {
            name: Text::Data("walk"),
            detail: Text::Data("3.9 s"),
            letters: &letters,
            actions: &actions,
            ..ClipRow::default()
        };
        done.extend(clip_row_ui(row, ui).event);
    });
    assert!(harness.query_by_label("Remove").is_none(), "actions wait for the pointer");
    let row = harness.get_by_label("walk, 3.9 s").rect();
    harness.hover_at(pos2(row.center().x, row.bottom() - 6.0));
    harness.run();
    harness.get_by_label("Remove").click();
    harness.run();
    for (letter, is_held) in [("Use walk as A", true), ("Use walk as B", false)] {
        let letter = harness.get_by_label(letter);
        assert_eq!(letter.accesskit_node().toggled() == Some(Toggled::True), is_held);
        letter.click();
        harness.run();
    }
    let row_pos = pos2(row.center().x, row.bottom() - 6.0);
    press(&mut harness, row_pos, true);
    press(&mut harness, row_pos, false);
    harness.run();
    assert_eq!(*harness.state(), [Action(1), Letter(0), Letter(1), Chosen]);
}

#[test]
fn notice_and_task_report_their_buttons() {
    let mut harness = bench(
        (Vec::new(), false),
        |(events, stopped): &mut (Vec<NoticeEvent>, bool), ui| {
            let text = "A long notice that needs more than one line in a panel as narrow as this one is, and is not cut.";
            let text = &Message::word(text);
            events.extend(notice_ui(
                &Notice { text, mood: Mood::Warning, action: Word::new("Show") },
                ui,
            ));
            *stopped |=
                progress_row_ui(Word::new("Distance matrix"), Some(0.5), Word::new("half"), ui);
        },
    );
    harness.get_by_label("Dismiss").click();
    harness.run();
    harness.get_by_label("Show").click();
    harness.run();
    harness.get_by_label("Cancel").click();
    harness.run();
    assert_eq!(harness.state().0, [NoticeEvent::Dismissed, NoticeEvent::Acted]);
    assert!(harness.state().1);
    let notice = harness.get_by_label_contains("A long notice").rect();
    assert!(notice.height() > 40.0 && notice.right() < 300.0, "{notice:?}");
    assert!(harness.get_by_label("Show").rect().top() >= notice.bottom());
    assert_eq!(harness.get_by_label("Distance matrix").accesskit_node().numeric_value(), Some(0.5));
}

#[test]
fn tabs_without_room_fold_into_a_menu() {
    const LABS: [(usize, Word); 4] = [
        (0, Word::new("View")),
        (1, Word::new("Blend")),
        (2, Word::new("Transition")),
        (3, Word::new("Graph")),
    ];
    for (width, folded) in [(600.0, false), (120.0, true)] {
        let mut harness = bench(1, move |chosen, ui| {
            let picked = ui
                .horizontal(|ui| {
                    tabs_ui([Word::new("Lab"), Word::new("More labs")], *chosen, &LABS, width, ui)
                })
                .inner;
            *chosen = picked.unwrap_or(*chosen);
        });
        assert_eq!(harness.query_by_role_and_label(Role::Button, "Lab").is_some(), folded);
        assert_eq!(harness.query_by_role_and_label(Role::TabList, "Lab").is_some(), !folded);
        if folded {
            harness.get_by_label("Lab").click();
            harness.run();
        }
        harness.get_by_label("Graph").click();
        harness.run();
        assert_eq!(*harness.state(), 3);
    }
}

#[test]
fn tabs_beyond_the_width_are_in_a_menu() {
    const NAMES: [&str; 10] = [
        "View",
        "Make",
        "Blend",
        "Transition",
        "Speed",
        "Loop",
        "Layers",
        "Register",
        "Graph",
        "Path",
    ];
    let labs: Vec<(usize, Word)> = NAMES.into_iter().map(Word::new).enumerate().collect();
    let mut harness = bench(0, move |chosen, ui| {
        let picked = ui
            .horizontal(|ui| {
                tabs_ui([Word::new("Lab"), Word::new("More labs")], *chosen, &labs, 280.0, ui)
            })
            .inner;
        *chosen = picked.unwrap_or(*chosen);
    });
    assert!(harness.query_by_label("Blend").is_some() && harness.query_by_label("Path").is_none());
    harness.get_by_label("More labs").click();
    harness.run();
    harness.get_by_label("Path").click();
    harness.run();
    assert_eq!(*harness.state(), 9);
    // It has taken the place of the last tab.
    harness.get_by_label("Path");
    harness.get_by_label("View").click();
    harness.run();
    assert_eq!(*harness.state(), 0);
}

#[test]
fn widget_that_gets_the_focus_by_keyboard_is_scrolled_into_view() {
    let mut harness = bench((), |(), ui| {
        ScrollArea::vertical().max_height(120.0).show(ui, |ui| {
            for number in 0..20 {
                button_ui(Button::new(Text::Data(&number.to_string())), ui);
            }
        });
    });
    let visible = harness.get_by_label("0").rect();
    harness.get_by_label("19").focus();
    harness.run();
    let last = harness.get_by_label("19").rect();
    assert!(last.bottom() <= visible.top() + 121.0, "{last} beside {visible}");
}

#[test]
fn metric_of_many_digits_stays_in_its_column() {
    let place = egui::Rect::from_min_size(pos2(16.0, 16.0), vec2(70.0, 38.0));
    for value in ["1.2", "1234.5", "999999.9", "−1.0e18", "−123456789012345.6"] {
        let harness = bench((), move |(), ui| {
            let [unit, name] = ["cm", "Slide"].map(Word::new);
            let metric = Metric { value, unit, name, short: name, ..Metric::default() };
            metric_cell_ui(&metric, place, egui::Id::unique("metric"), ui);
        });
        let end = |shape: &egui::epaint::ClippedShape| match &shape.shape {
            egui::Shape::Text(text) => Some(text.visual_bounding_rect().right()),
            _ => None,
        };
        let end = harness.output().shapes.iter().filter_map(end).fold(0.0, f32::max);
        let limit = place.right() + crate::ui::theme::space::M;
        assert!(place.left() < end && end < limit, "{value} ends at {end}, past {limit}");
    }
}
