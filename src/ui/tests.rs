//! What the panels show and ask for. With `SEGUE_GALLERY` set to a folder, pictures of them are
//! written there.

use super::out::Out;
use super::theme::{Theme, palette_of, space};
use super::*;
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
    Command, Entry, FileCommand, Key, Kind, Level, List, Origin, Outcome, PageMemory, Session,
    Slot, SourceFile, Storing, Value,
};
use std::fmt::Write as _;
use std::sync::Arc;

mod chinese;
mod drive;
mod graph;
mod lessons;
mod path;
mod register;
mod samples;

const DESK: Vec2 = vec2(1440.0, 900.0);
const PHONE: Vec2 = vec2(390.0, 844.0);
const DARK: Theme = Theme { dark: true, projector: false };
const LIGHT: Theme = Theme { dark: false, projector: false };

const HALL: Theme = Theme { dark: true, projector: true };

/// A page without a renderer.
struct Page {
    session: Session,
    state: UiState,
    curves: CurveCache,
    director: Director,
    out: Out,
    /// Where the stage was drawn last.
    stage: Rect,
    /// Commands are carried out, as the app does; otherwise they are only kept.
    obeys: bool,
}

impl Page {
    /// Puts the cameras where the app would.
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
    let builder =
        Harness::builder().with_size(size).with_max_steps(60).with_context_setup(move |ctx| {
            theme.install(ctx);
            kit::ENGLISH.install(ctx);
        });
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

/// One frame with these events.
fn step(events: Vec<egui::Event>, harness: &mut Harness<'_, Page>) {
    harness.input_mut().events.extend(events);
    harness.step();
}

/// A press or a release of the first button.
fn button(pos: egui::Pos2, pressed: bool) -> egui::Event {
    egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    }
}

/// Brings something into sight and presses it.
fn press(label: &str, harness: &mut Harness<'_, Page>) {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    harness.get_by_label(label).click();
    harness.run();
}

/// Writes a picture where pictures were asked for. They are to be looked at, not compared:
/// rasterisers differ.
fn picture(name: &str, harness: &mut Harness<'_, Page>) {
    if let Some(folder) = std::env::var_os("SEGUE_GALLERY") {
        let image = harness.render().expect("a rasteriser");
        image
            .save(std::path::Path::new(&folder).join(format!("{name}.png")))
            .expect("a folder that can be written to");
    }
}

#[test]
fn the_stage_has_its_own_colours_and_rows() {
    for (name, size) in [("stage-desk", vec2(1440.0, 900.0)), ("stage-phone", vec2(390.0, 844.0))] {
        let page = page("lab=view&a=walk&play=off&stage=paper&theme=dark");
        let mut harness = harness(size, Theme::default(), page);
        if name == "stage-desk" {
            press(text::STAGE, &mut harness);
            harness.get_by_label("Twist of the hands").scroll_to_me();
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

/// The comparison as the link has it; nothing for one pane.
fn compared(harness: &Harness<'_, Page>) -> String {
    let compare = harness.state().session.compare();
    compare.map(ToString::to_string).unwrap_or_default()
}

/// The built-in walk as a file, with a tail that no other skeleton has, and a T-pose in front.
fn file(session: &Session) -> String {
    let motion = session
        .library()
        .find("walk")
        .and_then(|entry| entry.motion.clone())
        .expect("a page as the tests need it");
    let text = String::from_utf8(
        export(&motion, None, &[], &ExportOptions::default()).expect("a page as the tests need it"),
    )
    .expect("a page as the tests need it");
    let (head, rows) = text.split_once("MOTION\n").expect("a page as the tests need it");
    let frames = motion.clip().frames();
    let root_end = head
        .match_indices('\n')
        .filter(|(at, _)| head[..*at].contains("CHANNELS"))
        .map(|(at, _)| at)
        .next()
        .expect("a page as the tests need it");
    let tail = "\n  JOINT Tail\n  {\n    OFFSET 0 0 -20\n    CHANNELS 0\n    End Site\n    {\n      OFFSET 0 0 -20\n    }\n  }";
    let (time, rows) = rows
        .split_once("Frame Time")
        .map(|(_, rest)| rest.split_once('\n').expect("a page as the tests need it"))
        .expect("a page as the tests need it");
    let columns =
        rows.lines().next().expect("a page as the tests need it").split_whitespace().count();
    let mut first: Vec<&str> = rows
        .lines()
        .next()
        .expect("a page as the tests need it")
        .split_whitespace()
        .take(3)
        .collect();
    first.resize(columns, "0");
    let mut out = format!("{}{tail}{}MOTION\n", &head[..root_end], &head[root_end..]);
    write!(out, "Frames: {}\nFrame Time{time}\n{}\n{rows}", frames + 1, first.join(" "))
        .expect("a page as the tests need it");
    out
}

/// A page with that file as A.
fn with_file(link: &str) -> Page {
    let mut page = page(link);
    page.session.make_all();
    let text = file(&page.session);
    page.session
        .load("takes/tailed.bvh", Arc::from(text.into_bytes()))
        .expect("a page as the tests need it");
    while page.session.work() {}
    page.session
        .apply(Command::Dismiss(page.session.notices().list().last().map_or(0, |n| n.id)))
        .expect("a page as the tests need it");
    page.out = Out::default();
    page
}

fn loaded(page: &Page) -> &Entry {
    let mut entries = page.session.library().entries().iter();
    entries
        .find(|entry| matches!(entry.origin, Origin::File(_)))
        .expect("a page as the tests need it")
}

fn outcome(page: &Page) -> &Outcome {
    page.session.main_outcome().expect("a page as the tests need it")
}

#[test]
fn the_clip_panel_tells_what_was_read() {
    let page = with_file("lab=view&play=off");
    let entry = loaded(&page);
    assert!(entry.about.as_ref().unwrap().t_pose_first_row, "{:?}", entry.about);
    let joints = entry.motion.as_ref().unwrap().clip().skeleton().len();
    for (name, size, theme) in [
        ("view-desk-dark", DESK, DARK),
        ("view-desk-light", DESK, LIGHT),
        ("view-projector", vec2(1280.0, 720.0), HALL),
        ("view-phone-dark", PHONE, DARK),
        ("view-phone-light", PHONE, LIGHT),
    ] {
        let mut harness = harness(size, theme, with_file("lab=view&play=off"));
        for label in ["Unit", "Up axis", "Leave out the T-pose", "GLB", "Body parts"] {
            harness.get_by_label(label);
        }
        harness.get_by_label(&format!("Joints: {joints} "));
        harness.get_by_label_contains("Root: position X Y Z");
        harness.get_by_label_contains("read as centimetres");
        press("Joints", &mut harness);
        assert!(harness.state().state.joints_open);
        harness.get_by_label("Joints").scroll_to_me();
        harness.run();
        picture(name, &mut harness);
    }
}

#[test]
fn what_is_said_by_hand_reads_the_file_again() {
    let mut page = with_file("lab=view&play=off");
    page.obeys = false;
    let mut harness = harness(DESK, DARK, page);
    let mut choose = |row: &str, item: &str| {
        press(row, &mut harness);
        press(item, &mut harness);
        match harness.state_mut().out.commands.pop() {
            Some(Command::File(FileCommand::Reimport(_, options))) => options,
            other => panic!("{row}: {other:?}"),
        }
    };
    assert_eq!(choose("Unit", "inch").metres_per_unit, Some(0.0254));
    assert_eq!(choose("Up axis", "Z").up, Some(segue_motion::clip::UpAxis::Z));
    assert_eq!(choose("Frame rate", "25").fps, Some(25.0));
    press("Leave out the T-pose", &mut harness);
    let command = harness.state_mut().out.commands.pop();
    assert!(
        matches!(command, Some(Command::File(FileCommand::Reimport(_, options))) if !options.drop_t_pose),
        "{command:?}"
    );
    // A rate that is in no list is typed.
    press("Frame rate", &mut harness);
    press("other…", &mut harness);
    harness.get_by_label("Frames per second").type_text("50");
    harness.run();
    harness.key_press(Keyboard::Enter);
    harness.run();
    let command = harness.state_mut().out.commands.pop();
    assert!(
        matches!(command, Some(Command::File(FileCommand::Reimport(_, options))) if options.fps == Some(50.0)),
        "{command:?}"
    );
}

#[test]
fn a_joint_of_the_tree_is_chosen_by_pointer_and_by_keyboard() {
    let mut harness = harness(DESK, DARK, with_file("lab=view&play=off&joint=tail"));
    press("Joints", &mut harness);
    let chosen =
        |harness: &Harness<'_, Page>| harness.state().session.params().text(Key::Joint).to_owned();
    let tail = harness.get_by_label("Tail");
    assert_eq!(tail.accesskit_node().is_selected(), Some(true));
    tail.focus();
    harness.run();
    harness.key_press(Keyboard::ArrowUp);
    harness.run();
    assert_eq!(chosen(&harness), "hips");
    harness.key_press(Keyboard::ArrowLeft);
    harness.run();
    assert!(harness.query_by_label("Tail").is_none(), "folded");
    harness.key_press(Keyboard::ArrowRight);
    harness.run();
    harness.key_press(Keyboard::ArrowRight);
    harness.run();
    assert_eq!(chosen(&harness), "Tail");
    // The last joint is brought into sight, and keeps the keyboard.
    harness.key_press(Keyboard::End);
    harness.run();
    let last = chosen(&harness);
    assert_ne!(last, "Tail");
    harness.key_press(Keyboard::ArrowUp);
    harness.run();
    assert_ne!(chosen(&harness), last);
    let commands = &harness.state().out.commands;
    assert!(
        commands.contains(&Command::Set(vec![(Key::Joint, Value::Text("Tail".into()))])),
        "{commands:?}"
    );
    picture("tree-desk-dark", &mut harness);
}

#[test]
fn the_library_opens_the_same_panel_under_the_row() {
    for (name, size, theme) in [
        ("details-desk-dark", DESK, DARK),
        ("details-projector", vec2(1280.0, 720.0), HALL),
        ("details-phone-light", PHONE, LIGHT),
    ] {
        let mut page = with_file("lab=blend&play=off");
        page.state.details = Some(loaded(&page).id.clone());
        page.state.library_open = true;
        let mut harness = harness(size, theme, page);
        harness.get_by_label("Up axis");
        press("Joints", &mut harness);
        assert!(harness.state().state.joints_open);
        picture(name, &mut harness);
    }
}

#[test]
fn the_library_tells_how_far_the_work_is_stored() {
    let mut harness = harness(DESK, DARK, page("lab=view&play=off"));
    for words in [text::SAVED, text::SAVING, text::NOT_ALL_SAVED] {
        assert!(harness.query_by_label(words).is_none(), "{words} where nothing is stored");
    }
    for (stored, words) in [
        (Storing::Done, "Saved"),
        (Storing::UnderWay, "Saving…"),
        (Storing::Incomplete, "Not all saved"),
    ] {
        harness.state_mut().state.stored = Some(stored);
        harness.run();
        harness.get_by_label(words);
    }
    picture("stored-desk-dark", &mut harness);
}

#[test]
fn memory_in_use_is_shown_once_it_is_more_than_a_quarter() {
    let mut harness = harness(DESK, DARK, page("lab=view&play=off"));
    for (bytes, is_shown) in [(750_000_000, false), (1_234_000_000, true)] {
        harness.state_mut().session.note_memory(PageMemory {
            bytes,
            limit: 3_000_000_000,
            coming: 0,
        });
        harness.run();
        assert_eq!(harness.query_by_label(text::MEMORY).is_some(), is_shown, "{bytes}");
    }
    let memory = harness.state().session.memory().unwrap();
    assert_eq!(text::memory(memory).to_string(), "1234 MB of 3 GB");
}

#[test]
fn a_motion_is_saved_as_it_is_wanted() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,15,10&play=off"));
    harness.state_mut().state.filming = Filming { pictures: true, films: true, secs: Some(67.4) };
    press("Result", &mut harness);
    press("15 frames", &mut harness);
    press("File options", &mut harness);
    press("Rotation order", &mut harness);
    press("X Y Z", &mut harness);
    picture("save-desk-dark", &mut harness);
    press("Save the file", &mut harness);
    press("GLB", &mut harness);
    press("Save the file", &mut harness);
    harness.get_by_label("End the recording and save it").click();
    press("Save the stage as a picture", &mut harness);
    harness.get_by_label("Recording, 1:07");
    let actions = &harness.state().out.actions;
    let [Action::Save { which, how }, Action::Save { how: glb, .. }, rest @ ..] =
        actions.as_slice()
    else {
        panic!("{actions:?}")
    };
    assert_eq!((which.as_str(), how.format), ("result:1", ExportFormat::Bvh));
    assert_eq!(how.rotation_order, Some(segue_formats::bvh::RotationOrder::Xyz));
    assert_eq!(glb.format, ExportFormat::Glb);
    assert!(rest.contains(&Action::Record) && rest.contains(&Action::SavePicture));
}

#[test]
fn a_blend_of_two_skeletons_says_what_was_not_matched() {
    let page = with_file("lab=blend&b=run&play=off");
    assert_eq!(outcome(&page).retargeted.as_ref().unwrap().unmatched, ["Tail"]);
    for (name, size, theme) in
        [("retarget-desk-light", DESK, LIGHT), ("retarget-phone-dark", PHONE, DARK)]
    {
        let mut harness = harness(size, theme, with_file("lab=blend&b=run&play=off"));
        harness.get_by_label("B's motion is moved onto A's skeleton; not matched: Tail.");
        picture(name, &mut harness);
    }
    assert!(outcome(&self::page("lab=blend&play=off")).retargeted.is_none());
}

#[test]
fn a_clip_without_a_motion_says_why() {
    let mut page = page("lab=blend&play=off");
    let text = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 0 0 0\n";
    page.session.load("alone.amc", Arc::from(text.as_bytes())).unwrap();
    let entry = loaded(&page);
    assert_eq!(text::status(entry), text::AWAITS_SKELETON);
    let large = SourceFile {
        name: "large.bvh".into(),
        sha256: String::new(),
        content: Content::Outside("1".into()),
        size: 9 << 20,
        kind: FileKind::Bvh,
        companion: None,
        index: 0,
        options: ImportOptions::default(),
    };
    let being_read = Entry { origin: Origin::File(large), ..entry.clone() };
    assert_eq!(text::status(&being_read), text::READING);
    let given_up = Entry { unread: Some("Reading large.bvh was stopped.".into()), ..being_read };
    assert_eq!(text::status(&given_up), text::UNREAD);
    let mut harness = harness(DESK, DARK, page);
    harness.get_by_label_contains("alone, waits for its skeleton");
    picture("waits-desk-dark", &mut harness);
}

#[test]
fn a_gait_takes_any_speed_and_says_when_that_is_a_guess() {
    for (name, size, theme, link) in [
        ("speed-desk-dark", DESK, DARK, "lab=speed&play=off&t=1"),
        ("speed-desk-light", DESK, LIGHT, "lab=speed&speed=9&foot_lock=on&play=off"),
        ("speed-compare-desk-dark", DESK, DARK, "lab=speed&compare=speed:1.4,2.2,3.9&play=off"),
        ("speed-phone-dark", PHONE, DARK, "lab=speed&play=off"),
        ("speed-projector", vec2(1280.0, 720.0), HALL, "lab=speed&play=off"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label(text::SPEED_ABOUT);
        assert_eq!(
            harness.query_all_by_label_contains("Too far beyond both clips").count(),
            usize::from(link.contains("speed=9"))
        );
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=speed&play=off"));
    press("A, half way, B", &mut harness);
    assert_eq!(compared(&harness), "speed:1.4,2.45,3.5");
    let back = harness.get_by_label("One pane").rect();
    assert!(
        back.right() < DESK.x - space::M,
        "the row of buttons is as wide as the panel at most: {back:?}"
    );
    press("One pane", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    assert_eq!(harness.state().session.params().number(Key::Speed), 1.4, "as the first pane was");
}

#[test]
fn lock_settings_are_offered_while_feet_are_held() {
    let rows = ["Lock blend", "Lock reach", "Swing clearance"];
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    press(text::FEET, &mut harness);
    assert!(harness.query_by_label("Contact height").is_some());
    assert!(rows.iter().all(|row| harness.query_by_label(row).is_none()));
    press("Foot lock", &mut harness);
    for row in rows {
        let slider = harness.get_by_label(row);
        assert!(slider.rect().height() > 0.0, "{row}");
    }
}

#[test]
fn a_loop_says_where_it_was_cut_and_what_its_method_does() {
    for (name, size, theme, link) in [
        ("loop-desk-dark", DESK, DARK, "lab=loop&play=off&t=1"),
        (
            "loop-desk-light",
            DESK,
            LIGHT,
            "lab=loop&a=walk_left&loop_method=linear&loop_from=0.5&foot_lock=on&play=off",
        ),
        (
            "loop-compare-desk-dark",
            DESK,
            DARK,
            "lab=loop&compare=loop_method:exact,end,both&play=off",
        ),
        ("loop-phone-dark", PHONE, DARK, "lab=loop&play=off"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label_contains("Makes a seamless cycle");
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=loop&play=off"));
    harness.get_by_label_contains("solved so that pose and velocity close");
    press("Exact against classic", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 3);
    press("Exact against classic", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    // The keys follow the tabs.
    harness.key_press(Keyboard::Num5);
    harness.run();
    assert_eq!(harness.state().session.params().lab().word(), "speed");
}

#[test]
fn the_layers_lab_says_how_time_goes_and_where_the_layer_is() {
    for (name, size, theme, link) in [
        ("layers-desk-dark", DESK, DARK, "lab=layers&play=off&t=1"),
        ("layers-additive-light", DESK, LIGHT, "lab=layers&layer_mode=additive&b=jump&play=off"),
        ("layers-compare-dark", DESK, DARK, "lab=layers&compare=layer_weight:1,0.5,0.33&play=off"),
        ("layers-phone-dark", PHONE, DARK, "lab=layers&play=off"),
    ] {
        let page = page(link);
        let sentence = text::fit(outcome(&page).layer().expect("a layer")).to_string();
        let additive = link.contains("additive");
        assert_eq!(sentence.starts_with("No steps"), additive, "{sentence}");
        let mut harness = harness(size, theme, page);
        harness.get_by_label(&sentence);
        // What does not concern the kind of layer is not offered.
        assert_eq!(harness.query_by_label("Keep B's posture").is_none(), additive);
        assert_eq!(harness.query_by_label("first frame").is_some(), additive);
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=layers&play=off"));
    press("additive", &mut harness);
    press("Mask", &mut harness);
    press("left arm", &mut harness);
    let params = harness.state().session.params();
    assert_eq!(
        (params.choice::<choices::LayerMode>().word(), params.choice::<choices::Mask>().word()),
        ("additive", "left_arm")
    );
    harness.get_by_label("first frame");
}

#[test]
fn a_mistake_is_chosen_explained_and_held_against_the_right_way() {
    let mut harness = harness(DESK, DARK, page("lab=transition&play=off&t=2.3"));
    assert!(harness.query_by_label(text::RIGHT_AND_WRONG).is_none());
    press("Break it", &mut harness);
    press("Euler angles mixed", &mut harness);
    harness.get_by_label(text::mistake(Mistake::Euler));
    picture("break-desk-dark", &mut harness);
    press(text::RIGHT_AND_WRONG, &mut harness);
    assert_eq!(harness.state().session.panes().len(), 2);
    assert_eq!(compared(&harness), "mistake:none,euler");
    harness.get_by_label(text::mistake(Mistake::Euler));
    picture("break-compare-dark", &mut harness);
    press(text::RIGHT_AND_WRONG, &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    // A cut has nothing to be mixed wrongly, and that is said.
    let cut =
        self::harness(DESK, LIGHT, page("lab=transition&method=cut&mistake=degrees&play=off"));
    cut.get_by_label(text::MISTAKE_IDLE);
    let dissolve =
        self::harness(DESK, DARK, page("lab=transition&method=smooth&mistake=velocity&play=off"));
    dissolve.get_by_label(text::VELOCITY_IN_DISSOLVE);
    let turned =
        self::harness(PHONE, LIGHT, page("lab=transition&method=cut&mistake=atan&play=off"));
    turned.get_by_label(text::mistake(Mistake::Atan));
}

#[test]
fn every_mistake_has_its_sentence() {
    for &mistake in Mistake::ALL {
        assert_eq!(text::mistake(mistake).is_empty(), mistake == Mistake::None, "{mistake:?}");
    }
}

#[test]
fn a_clip_of_another_skeleton_is_said_to_be_moved() {
    let mut page = with_file("lab=graph&clips=walk,walk_left&walk_seconds=10&play=off");
    let id = loaded(&page).id.clone();
    page.session
        .apply(Command::Set(vec![(
            Key::Clips,
            List::ClipIds(vec!["walk".to_owned(), id.clone()]).into(),
        )]))
        .expect("a page as the tests need it");
    while page.session.work() {}
    let harness = harness(DESK, DARK, page);
    harness.get_by_label_contains("Moved onto the skeleton of Walk:");
    let alone = self::page(
        "lab=graph&clips=idle&construction=segments&segment_size=20&blend_window=30&play=off",
    );
    let harness = self::harness(DESK, LIGHT, alone);
    assert!(harness.query_all_by_label_contains("raise the segment to 31").next().is_some());
}

/// Inside another page no panel may cover another: the row with the play button stood half under
/// the stage where the tracks need room.
#[test]
fn an_embedded_page_shows_all_of_its_timeline() {
    for lab in ["blend", "transition", "loop", "register", "graph", "match"] {
        for (name, size) in
            [("phone", PHONE), ("desk", vec2(800.0, 500.0)), ("projector", vec2(1280.0, 720.0))]
        {
            let link = format!("lab={lab}&play=off&embed=1&half_life=0.2&blend_window=12");
            let mut harness = harness(size, DARK, page(&link));
            picture(&format!("embed-{lab}-{name}"), &mut harness);
            let [slider, play] =
                ["Blend window", "Play"].map(|label| harness.get_by_label(label).rect());
            let last = harness.query_by_label("Timeline").map_or(play, |timeline| timeline.rect());
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

#[test]
fn a_clip_that_is_not_here_is_named_where_it_is_missed() {
    for (name, size, theme) in [("missing-desk", DESK, LIGHT), ("missing-phone", PHONE, DARK)] {
        let mut harness = harness(
            size,
            theme,
            page("lab=blend&a=mine~1234abcd&b=run&compare=blend_window:30,15,10&play=off"),
        );
        picture(name, &mut harness);
        harness.get_by_value("mine · missing");
        assert!(harness.query_all_by_label_contains("drop its file").count() > 0);
    }
}

/// One drags, and wants to see it play: Space is the motion's, unless the focus came by the
/// keyboard.
#[test]
fn space_plays_after_a_drag() {
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
    // By the keyboard a switch has the focus, and Space is its own.
    harness.get_by_label("Align to A").focus();
    harness.run_steps(2);
    harness.key_press(egui::Key::Space);
    harness.run_steps(2);
    assert!(plays(&harness) && !harness.state().session.params().is_on(Key::Align));
}

/// What a first visitor drags is what the panes show: every pane of a comparison has its own
/// slider.
#[test]
fn values_side_by_side_are_dragged_one_by_one() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,15,10&play=off"));
    picture("compare-rows", &mut harness);
    harness.get_by_label("Blend window · 2").focus();
    harness.step();
    harness.key_press(egui::Key::ArrowRight);
    harness.run_steps(2);
    assert_eq!(compared(&harness), "blend_window:30,16,10");
    press(text::PANE_MORE, &mut harness);
    assert_eq!(compared(&harness), "blend_window:30,16,10,8");
    // There is no room for a fifth: the button keeps its place, and does nothing.
    press(text::PANE_MORE, &mut harness);
    assert_eq!(compared(&harness), "blend_window:30,16,10,8");
    for _ in 0..3 {
        press(text::PANE_LESS, &mut harness);
    }
    assert_eq!(compared(&harness), "");
    assert_eq!(harness.state().session.panes().len(), 1);
    harness.state_mut().session.apply(Command::Undo).unwrap();
    assert_eq!(compared(&harness), "blend_window:30,16");
}

#[test]
fn choices_side_by_side_have_a_row_each() {
    let mut harness = harness(DESK, DARK, page("compare=weight_law:smooth,linear&play=off"));
    picture("compare-choices", &mut harness);
    assert!(harness.query_by_label("Weight law").is_none());
    press(text::PANE_MORE, &mut harness);
    let three = compared(&harness);
    assert!(
        three.starts_with("weight_law:smooth,linear,") && three.matches(',').count() == 2,
        "{three}"
    );
    press(text::PANE_LESS, &mut harness);
    press("One pane", &mut harness);
    assert_eq!(compared(&harness), "");
    assert_eq!(harness.state().session.params().choice::<choices::WeightLaw>().word(), "smooth");
}

/// Every row with a choice shows the value in force: as the text of its menu, or as the chosen one
/// of its words.
#[test]
fn choices_show_the_value_in_force() {
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
fn escape_closes_a_menu_and_nothing_behind_it() {
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
fn hysteresis_shows_the_rows_of_its_choice() {
    for (link, bias, time) in [
        ("hysteresis=bias", true, false),
        ("hysteresis=time", false, true),
        ("compare=hysteresis:bias,time", true, true),
    ] {
        let mut harness = harness(
            vec2(1440.0, 2400.0),
            DARK,
            page(&format!("lab=match&scenario=straight&{link}&play=off")),
        );
        harness.run_steps(2);
        let has = |key: Key| harness.query_by_label(key.param().label).is_some();
        assert_eq!((has(Key::BiasShare), has(Key::MinimumTime)), (bias, time), "{link}");
    }
}

#[test]
fn the_first_visit_says_what_to_watch() {
    assert!(labs::welcome(&Session::new()).is_some());
    assert!(labs::welcome(&page("lab=transition").session).is_none());
}

#[test]
fn an_embedded_page_keeps_the_rows_that_its_link_names() {
    let link = "lab=blend&embed=1&blend_window=30&a=walk&look=both&play=off";
    let mut harness = harness(vec2(800.0, 500.0), DARK, page(link));
    harness.run_steps(2);
    assert!(
        harness.query_by_label("Blend window").is_some()
            && harness.query_by_label(Slot::A.label()).is_some()
    );
    // At its default a parameter is still there to be tried.
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

#[test]
fn notices_of_any_length_can_be_closed_one_after_the_other() {
    for size in [DESK, PHONE] {
        let mut page = page("lab=view&play=off");
        for n in 0..6 {
            page.session.say(Level::Error, format!("{n}: {}", "word ".repeat(400)));
        }
        let mut harness = harness(size, DARK, page);
        for left in (0..harness.state().session.notices().list().len()).rev() {
            let cross = |harness: &Harness<'_, Page>| {
                harness
                    .get_all_by_label(kit::ENGLISH.dismiss)
                    .last()
                    .map(|cross| cross.rect().center())
            };
            harness.get_all_by_label(kit::ENGLISH.dismiss).last().expect("a cross").scroll_to_me();
            harness.run();
            let at = cross(&harness).expect("a cross");
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
    }
}

#[test]
fn notice_offers_to_mend_a_clip() {
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
    press(text::MEND, &mut harness);
    let commands = &harness.state().out.commands;
    assert!(
        matches!(commands.as_slice(), [.., Command::File(FileCommand::Mend(_))]),
        "{commands:?}"
    );
}
