//! Tests of the panels. With `SEGUE_GALLERY` set to a folder, pictures of them are written there.

use super::out::Out;
use super::theme::{Theme, palette_of, space};
use super::*;
use clips::{loaded, with_file};
use eframe::egui::accesskit::Toggled;
use eframe::egui::{self, Key as Keyboard, Rect, Role, Shape, Ui, Vec2, vec2};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use segue_formats::{FileKind, ImportOptions};
use segue_scene::{Director, Look, StageOptions, Viewport};
use segue_session::choices;
use segue_session::choices::{Mistake, Selected as _};
use segue_session::export::{ExportFormat, ExportOptions, export};
use segue_session::reading::Content;
use segue_session::{
    Command, Entry, FileCommand, Key, Kind, LabId, Level, List, Origin, Outcome, PageMemory,
    Session, Slot, SourceFile, StorageState, Value,
};
use std::fmt::Write as _;
use std::sync::Arc;

mod bone_map;
mod chinese;
mod clean;
mod clips;
mod contacts;
mod convert;
mod curves;
mod drive;
mod edit;
mod footer;
mod graph;
mod joints;
mod lab_panels;
mod lessons;
mod library;
mod path;
mod quadruped;
mod register;
mod samples;
mod screens;
mod still;
mod strip;

const DESK: Vec2 = vec2(1440.0, 900.0);
const PHONE: Vec2 = vec2(390.0, 844.0);
const DARK: Theme = Theme { dark: true, projector: false, presents: false, touch: false };
const LIGHT: Theme = Theme { dark: false, ..DARK };

const HALL: Theme = Theme { projector: true, ..DARK };

/// A page without a renderer.
struct Page {
    session: Session,
    state: UiState,
    curves: CurveCache,
    director: Director,
    out: Out,
    /// The last place of the stage.
    stage: Rect,
    /// Whether commands are carried out, as in the app; otherwise they are only kept.
    obeys: bool,
}

impl Page {
    /// Sets the cameras as the app does.
    fn aim(&mut self, places: &[(usize, Rect)]) {
        let viewport = |rect: Rect| Viewport {
            x: 0,
            y: 0,
            width: rect.width() as u32,
            height: rect.height() as u32,
        };
        let shown: Vec<(usize, Viewport)> =
            places.iter().map(|&(pane, rect)| (pane, viewport(rect))).collect();
        let highlights = highlights(&self.session, &self.state);
        let options = StageOptions { panes: &shown, highlights, ..StageOptions::default() };
        self.director.stage(&self.session, &options, 10.0);
        let panes = self.session.panes().len();
        self.state.figures = (0..panes).map(|pane| self.director.figure(pane).to_vec()).collect();
        self.state.cameras = (0..panes).map(|pane| self.director.camera(pane).copied()).collect();
    }
}

fn page(link: &str) -> Page {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).expect("a page as the tests need it");
    while session.work() {}
    Page {
        session,
        state: UiState::default(),
        curves: CurveCache::default(),
        director: Director::default(),
        out: Out::default(),
        stage: Rect::NOTHING,
        obeys: true,
    }
}

fn harness(size: Vec2, theme: Theme, page: Page) -> Harness<'static, Page> {
    stepped_harness(size, theme, 0.25, page)
}

/// Shows a page by frames of `dt_secs`.
fn stepped_harness(size: Vec2, theme: Theme, dt_secs: f32, page: Page) -> Harness<'static, Page> {
    let builder = Harness::builder()
        .with_size(size)
        .with_max_steps(60)
        .with_step_dt(dt_secs)
        .with_context_setup(move |ctx| theme.install(ctx));
    let mut harness = builder.build_ui_state(
        |ui, page: &mut Page| {
            let mut places: Vec<(usize, Rect)> = Vec::new();
            let mut shown = Rect::NOTHING;
            let mut paint = |stage: Rect, panes: &[(usize, Rect)], ui: &mut Ui| {
                shown = stage;
                places = panes.to_vec();
                let colors = &palette_of(ui).stage;
                ui.painter().add(Shape::gradient_rect(
                    stage,
                    egui::Direction::TopDown,
                    [colors.sky, colors.horizon],
                ));
            };
            let whole = egui::UiBuilder::new().max_rect(ui.ctx().content_rect());
            let Page { session, state, curves, .. } = page;
            let out =
                ui.scope_builder(whole, |ui| show(session, state, curves, &mut paint, ui)).inner;
            // As the app does between frames.
            if state.labs.graph.drawing.is_incomplete() {
                while state.labs.graph.drawing.work() {}
                ui.ctx().request_repaint();
            }
            for command in &out.commands {
                if page.obeys {
                    page.session.apply(command.clone()).expect("a page as the tests need it");
                }
            }
            page.aim(&places);
            page.stage = shown;
            page.out.commands.extend(out.commands);
            page.out.actions.extend(out.actions);
        },
        page,
    );
    harness.run();
    harness
}

/// Runs one frame with these events.
fn step(events: Vec<egui::Event>, harness: &mut Harness<'_, Page>) {
    harness.input_mut().events.extend(events);
    harness.step();
}

/// Returns a press or a release of the primary button.
fn button(pos: egui::Pos2, pressed: bool) -> egui::Event {
    egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    }
}

/// Presses a text, and drags to another.
fn select(from: egui::Pos2, to: egui::Pos2, harness: &mut Harness<'_, Page>) {
    step(vec![egui::Event::PointerMoved(from)], harness);
    step(vec![button(from, true)], harness);
    step(vec![egui::Event::PointerMoved(from.lerp(to, 0.5))], harness);
    step(vec![egui::Event::PointerMoved(to)], harness);
    step(vec![button(to, false)], harness);
}

/// Copies the selection, and returns it.
fn copied(harness: &mut Harness<'_, Page>) -> String {
    step(vec![egui::Event::Copy], harness);
    let commands = &harness.output().platform_output.commands;
    let texts = commands.iter().filter_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.as_str()),
        _ => None,
    });
    texts.collect()
}

/// Scrolls a widget into sight and presses it.
fn press(label: &str, harness: &mut Harness<'_, Page>) {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    harness.get_by_label(label).click();
    harness.run();
}

/// Writes a picture if pictures are wanted. They are to be looked at, not compared: rasterisers
/// differ.
fn picture(name: &str, harness: &mut Harness<'_, Page>) {
    if let Some(folder) = std::env::var_os("SEGUE_GALLERY") {
        let image = harness.render().expect("a rasteriser");
        image
            .save(std::path::Path::new(&folder).join(format!("{name}.png")))
            .expect("a folder that can be written to");
    }
}

/// Returns the comparison as in the link; empty for one pane.
fn compared(harness: &Harness<'_, Page>) -> String {
    let compare = harness.state().session.compare();
    compare.map(ToString::to_string).unwrap_or_default()
}

#[test]
fn stage_with_its_own_theme_has_its_colours_and_rows() {
    for (name, size) in [("stage-desk", vec2(1440.0, 900.0)), ("stage-phone", vec2(390.0, 844.0))] {
        let page = page("lab=view&a=walk&play=off&stage=paper&theme=dark");
        let mut harness = harness(size, Theme::default(), page);
        if name == "stage-desk" {
            harness
                .get_by_role_and_label(Role::DisclosureTriangle, text::STAGE.english())
                .scroll_to_me();
            harness.run();
            harness.get_by_role_and_label(Role::DisclosureTriangle, text::STAGE.english()).click();
            harness.run();
            harness.get_by_label("Hand twist").scroll_to_me();
            harness.run();
            harness.get_by_label("limbs").click();
            harness.run();
            assert_eq!(harness.state().session.params().choice::<choices::Look>().word(), "limbs");
        }
        picture(name, &mut harness);
    }
    let session = |stage: &str| page(&format!("stage={stage}")).session;
    let page = Theme::default();
    let dark = |stage: &str| stage_theme(&session(stage), page).dark;
    assert_eq!(["auto", "dark", "light", "paper"].map(dark), [true, true, false, false]);
    assert_eq!(stage_look(&session("paper"), page), Look::PAPER);
    assert_eq!(stage_look(&session("auto"), page), Look::DARK);
}

fn outcome(page: &Page) -> &Outcome {
    page.session.main_outcome().expect("a page as the tests need it")
}

/// Inside another page no panel covers another: the row with the play button was half under the
/// stage where tracks need room.
#[test]
fn embedded_page_of_any_size_shows_the_whole_timeline() {
    for lab in ["blend", "transition", "loop", "register", "graph", "match"] {
        for (name, size) in
            [("phone", PHONE), ("desk", vec2(800.0, 500.0)), ("projector", vec2(1280.0, 720.0))]
        {
            let link = format!("lab={lab}&play=off&embed=1&half_life=0.2&blend_window=12");
            let mut harness = harness(size, DARK, page(&link));
            picture(&format!("embed-{lab}-{name}"), &mut harness);
            let [slider, play] =
                ["Blend window", "Play"].map(|label| harness.get_by_label(label).rect());
            let last = harness
                .query_by_role_and_label(Role::Slider, "Timeline")
                .map_or(play, |timeline| timeline.rect());
            let stage = harness.state().stage;
            assert!(
                stage.height() > 150.0 && stage.bottom() <= slider.top(),
                "{lab}, {name}: {stage:?}"
            );
            assert!(
                slider.bottom() <= play.top() && last.bottom() <= size.y,
                "{lab}, {name}: {play:?}"
            );
        }
    }
}

/// After a drag Space plays the motion, unless the focus came by the keyboard.
#[test]
fn space_after_a_drag_plays() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    let plays = |harness: &Harness<'_, Page>| harness.state().session.params().is_on(Key::Play);
    let slider = harness.get_by_label("Blend window").rect();
    let track = slider.center_bottom() - vec2(0.0, 6.0);
    step(vec![egui::Event::PointerMoved(track), button(track, true)], &mut harness);
    step(vec![egui::Event::PointerMoved(track + vec2(20.0, 0.0))], &mut harness);
    step(vec![button(track + vec2(20.0, 0.0), false)], &mut harness);
    harness.run_steps(2);
    assert!(harness.get_by_label("Blend window").is_focused());
    harness.key_press(egui::Key::Space);
    harness.run_steps(2);
    assert!(plays(&harness));
    // A switch that got the focus by the keyboard is turned by Space.
    harness.get_by_label("Align to A").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Space);
    harness.run_steps(2);
    assert!(plays(&harness) && !harness.state().session.params().is_on(Key::Align));
}

/// Every pane of a comparison has its own slider.
#[test]
fn compared_values_have_a_slider_each() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,15,10&play=off"));
    picture("compare-rows", &mut harness);
    harness.get_by_label("Blend window · 2").focus();
    harness.step();
    harness.key_press(egui::Key::ArrowRight);
    harness.run_steps(2);
    assert_eq!(compared(&harness), "blend_window:30,16,10");
    press(text::PANE_MORE.english(), &mut harness);
    assert_eq!(compared(&harness), "blend_window:30,16,10,8");
    // There is no room for a fifth pane: the button keeps its place, disabled.
    press(text::PANE_MORE.english(), &mut harness);
    assert_eq!(compared(&harness), "blend_window:30,16,10,8");
    for _ in 0..3 {
        press(text::PANE_LESS.english(), &mut harness);
    }
    assert_eq!(compared(&harness), "");
    assert_eq!(harness.state().session.panes().len(), 1);
    harness.state_mut().session.apply(Command::Undo).unwrap();
    assert_eq!(compared(&harness), "blend_window:30,16");
}

#[test]
fn compared_choices_have_a_row_each() {
    let mut harness = harness(DESK, DARK, page("compare=weight_law:smooth,linear&play=off"));
    picture("compare-choices", &mut harness);
    assert!(harness.query_by_label("Weight law").is_none());
    press(text::PANE_MORE.english(), &mut harness);
    let three = compared(&harness);
    assert!(
        three.starts_with("weight_law:smooth,linear,") && three.matches(',').count() == 2,
        "{three}"
    );
    press(text::PANE_LESS.english(), &mut harness);
    press("One pane", &mut harness);
    assert_eq!(compared(&harness), "");
    assert_eq!(harness.state().session.params().choice::<choices::WeightLaw>().word(), "smooth");
}

/// Every row with a choice shows the current value: as the text of its menu, or as the chosen
/// option.
#[test]
fn choice_shows_the_current_value() {
    let shows = |link: &str, label: &str, words: &[(&str, bool)]| {
        let mut harness = harness(DESK, DARK, page(&format!("{link}&play=off")));
        harness.run_steps(2);
        if let Some(row) = harness.query_by_role_and_label(Role::ComboBox, label) {
            assert_eq!(row.accesskit_node().value().as_deref(), Some(words[0].0), "{label}");
            return;
        }
        for &(word, chosen) in words {
            let word = harness.get_by_label(word);
            assert_eq!(word.accesskit_node().toggled() == Some(Toggled::True), chosen, "{label}");
        }
    };
    shows("lab=match&scenario=left", "Input", &[("90° to the left", true)]);
    shows("lab=transition&method=cubic", "Method", &[("cubic", true)]);
    shows("lab=layers&layer_mode=additive", "Layer", &[("additive", true), ("partial", false)]);
}

#[test]
fn escape_with_an_open_menu_closes_only_the_menu() {
    let mut harness = harness(DESK, DARK, page("lab=transition&play=off"));
    harness.state_mut().state.help_open = true;
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::ComboBox, "Method").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("dead blend").is_some(), "the menu is open");
    harness.key_press(Keyboard::Escape);
    harness.run_steps(3);
    assert!(harness.query_by_label("dead blend").is_none(), "the menu is closed");
    assert!(harness.state().state.help_open);
    harness.key_press(Keyboard::Escape);
    harness.run_steps(2);
    assert!(!harness.state().state.help_open);
}

#[test]
fn first_visit_has_a_hint() {
    assert!(labs::welcome(&Session::new()).is_some());
    assert!(labs::welcome(&page("lab=transition").session).is_none());
}

#[test]
fn embedded_page_keeps_the_rows_of_its_link() {
    let link = "lab=blend&embed=1&blend_window=30&a=walk&look=both&play=off";
    let mut harness = harness(vec2(800.0, 500.0), DARK, page(link));
    harness.run_steps(2);
    assert!(
        harness.query_by_label("Blend window").is_some()
            && harness.query_by_label(Slot::A.label()).is_some()
    );
    // The row stays when the parameter is at its default.
    harness.state_mut().session.apply(Command::Reset(Key::BlendWindow)).unwrap();
    harness.run_steps(2);
    assert!(harness.query_by_label("Blend window").is_some());
}

#[test]
fn every_lab_has_a_key() {
    let Kind::Choice(labs) = Key::Lab.param().kind else { panic!() };
    assert_eq!(labs.len(), commands::LAB_KEYS.len());
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    for (lab, key) in labs.iter().zip(commands::LAB_KEYS).rev() {
        harness.key_press(key);
        harness.step();
        assert_eq!(harness.state().session.params().lab().word(), lab.key);
    }
}

/// Opens the list of notices.
fn open_notices(chip: &str, harness: &mut Harness<'_, Page>) {
    harness.get_by_role_and_label(Role::Button, chip).click();
    harness.run();
}

#[test]
fn notice_of_any_length_can_be_closed() {
    for size in [DESK, PHONE] {
        let mut page = page("lab=view&play=off");
        for n in 0..6 {
            page.session.say(Level::Error, format!("{n}: {}", "word ".repeat(400)));
        }
        let mut harness = harness(size, DARK, page);
        let count = harness.state().session.notices().list().len();
        open_notices(&format!("{count} errors"), &mut harness);
        picture(&format!("notices-{}", size.x), &mut harness);
        for left in (0..count).rev() {
            harness
                .get_all_by_label(kit::DISMISS.english())
                .last()
                .expect("a cross")
                .scroll_to_me();
            harness.run();
            let cross = harness.get_all_by_label(kit::DISMISS.english()).last();
            let at = cross.expect("a cross").rect().center();
            assert!(
                Rect::from_min_size(egui::Pos2::ZERO, size).contains(at),
                "{left} left, and the cross is at {at}"
            );
            step(vec![egui::Event::PointerMoved(at)], &mut harness);
            step(vec![button(at, true)], &mut harness);
            step(vec![button(at, false)], &mut harness);
            harness.run();
            assert_eq!(harness.state().session.notices().list().len(), left);
        }
        assert!(harness.query_by_role(Role::Alert).is_none(), "without notices there is no chip");
    }
}

#[test]
fn notice_about_a_damaged_clip_offers_to_correct_it() {
    let mut page = page("lab=view&play=off");
    page.obeys = false;
    let walk = page
        .session
        .library()
        .get("walk")
        .expect("a built-in clip")
        .motion
        .clone()
        .expect("it is looked at");
    let text = segue_formats::bvh::write(walk.clip(), &segue_formats::bvh::WriteOptions::default());
    let rows: Vec<&str> = text.lines().collect();
    let row = rows.len() - 20;
    let (_, rest) = rows[row].split_once(' ').expect("a row of numbers");
    let wild = text.replace(rows[row], &format!("1e9 {rest}"));
    page.session.load("x.bvh", Arc::from(wild.as_bytes())).expect("a file that is read");
    let mut harness = harness(DESK, DARK, page);
    open_notices("1 clip added · 1 with notes", &mut harness);
    press(text::CORRECT.english(), &mut harness);
    let commands = &harness.state().out.commands;
    assert!(
        matches!(commands.as_slice(), [.., Command::File(FileCommand::Correct(_))]),
        "{commands:?}"
    );
}
