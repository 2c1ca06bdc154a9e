//! The Match lab with keys, stick and pointer.

use super::*;
use eframe::egui::{Event, Modifiers};
use segue_motion::matching::{Control, Place};
use segue_session::{DriveCommand, DriveHistory, PlaybackCommand};

/// A link with a small database.
const SMALL: &str =
    "lab=match&mirrored=off&match_clips=idle,walk,walk_left,walk_right,walk(make_seconds:6)";

/// Returns the frame that is shown as a ghost.
fn ghost(harness: &Harness<'_, Page>) -> Option<Place> {
    let page = harness.state();
    highlights(&page.session, &page.state).candidate
}

fn driven(harness: &Harness<'_, Page>) -> Arc<DriveHistory> {
    outcome(harness.state()).driven().cloned().expect("a drive")
}

/// Runs frames in which time passes.
fn play(frames: usize, harness: &mut Harness<'_, Page>) {
    for _ in 0..frames {
        harness.state_mut().session.tick(1.0 / 60.0);
        harness.step();
    }
}

fn control(harness: &Harness<'_, Page>) -> Control {
    harness.state().session.control()
}

#[test]
fn keys_drive_away_from_the_camera_until_released() {
    let mut harness = harness(DESK, DARK, page(&format!("{SMALL}&camera_yaw=180")));
    harness.key_down(Keyboard::W);
    play(2, &mut harness);
    // The camera is behind the character: away from it is +Z.
    let velocity = control(&harness).velocity();
    assert!(velocity.distance(glam::DVec2::new(0.0, 1.4)) < 0.03, "{velocity}");
    play(60, &mut harness);
    assert!(driven(&harness).moments.last().expect("a tick").root.shift.y > 0.5);
    harness.key_down(Keyboard::D);
    play(2, &mut harness);
    let velocity = control(&harness).velocity();
    assert!(
        velocity.x < -0.9 && velocity.y > 0.9,
        "right of a camera that looks along +Z is -X: {velocity}"
    );
    harness.key_up(Keyboard::W);
    harness.key_up(Keyboard::D);
    play(2, &mut harness);
    assert_eq!(control(&harness), Control::default());
    // Arrows drive as well, and Shift runs; they do not step the playhead.
    harness.key_down(Keyboard::ArrowUp);
    play(1, &mut harness);
    step(vec![Event::ModifiersChanged(Modifiers::SHIFT)], &mut harness);
    play(1, &mut harness);
    let velocity = control(&harness).velocity();
    assert!((velocity.length() - 3.2).abs() < 0.05, "{velocity}");
    step(vec![Event::ModifiersChanged(Modifiers::NONE)], &mut harness);
    harness.key_up(Keyboard::ArrowUp);
    play(2, &mut harness);
    let stepped =
        |command: &Command| matches!(command, Command::Playback(PlaybackCommand::Step(_)));
    assert!(!harness.state().out.commands.iter().any(stepped));
    // Q strafes: the character faces away from the camera, wherever it goes.
    harness.key_press(Keyboard::Q);
    harness.key_down(Keyboard::A);
    play(2, &mut harness);
    assert!(control(&harness).facing().is_some_and(|yaw| yaw.abs() < 0.03));
    // In another lab the same keys turn the camera, and steer no character.
    harness.key_up(Keyboard::A);
    harness.key_press(Keyboard::Num1);
    play(2, &mut harness);
    let before = harness.state().out.commands.len();
    harness.key_press(Keyboard::W);
    harness.key_press(Keyboard::PageUp);
    play(2, &mut harness);
    let asked = &harness.state().out.commands[before..];
    let is_camera = |(key, _): &(Key, Value)| {
        matches!(key, Key::CameraYaw | Key::CameraPitch | Key::CameraDistance)
    };
    let turns =
        |command: &Command| matches!(command, Command::Set(values) if values.iter().all(is_camera));
    assert!(!asked.is_empty() && asked.iter().all(turns), "{asked:?}");
}

#[test]
fn stick_drives_while_held_and_leaves_the_camera() {
    let mut harness = harness(PHONE, DARK, page(&format!("{SMALL}&camera_yaw=180")));
    harness.run_steps(2);
    let stick = harness.get_by_label("Stick: drive the character").rect();
    assert!(stick.width() > 60.0);
    let yaw = harness.state().session.params().number(Key::CameraYaw);
    step(vec![Event::PointerMoved(stick.center())], &mut harness);
    step(vec![button(stick.center(), true)], &mut harness);
    let top = stick.center() - vec2(0.0, 60.0);
    step(vec![Event::PointerMoved(top)], &mut harness);
    play(2, &mut harness);
    let velocity = control(&harness).velocity();
    assert!(velocity.distance(glam::DVec2::new(0.0, 1.4)) < 0.06, "{velocity}");
    step(vec![button(top, false)], &mut harness);
    play(2, &mut harness);
    assert_eq!(control(&harness), Control::default());
    assert_eq!(harness.state().session.params().number(Key::CameraYaw), yaw);
    press("Run", &mut harness);
}

#[test]
fn gamepad_drives_in_proportion_to_its_push() {
    let mut harness = harness(DESK, DARK, page(&format!("{SMALL}&camera_yaw=180")));
    let mut pad = Gamepad { walk: [0.0, 0.1], ..Gamepad::default() };
    harness.state_mut().state.gamepad = Some(pad);
    play(2, &mut harness);
    assert_eq!(control(&harness), Control::default(), "it trembles");
    pad.walk = [0.0, 0.59];
    harness.state_mut().state.gamepad = Some(pad);
    play(2, &mut harness);
    let half = control(&harness).velocity().y;
    assert!((half - 0.7).abs() < 0.05, "{half}");
    pad.run = true;
    pad.look = [1.0, 0.0];
    harness.state_mut().state.gamepad = Some(pad);
    play(2, &mut harness);
    assert!(control(&harness).velocity().y > 1.5);
    assert!(harness.state().session.params().number(Key::CameraYaw) < 180.0);
}

#[test]
fn candidate_under_the_pointer_is_shown_as_a_ghost() {
    let mut harness = harness(DESK, DARK, page(SMALL));
    harness.key_down(Keyboard::W);
    play(45, &mut harness);
    harness.key_up(Keyboard::W);
    harness.key_press(Keyboard::Space);
    harness.run();
    assert!(!harness.state().session.params().is_on(Key::Play));
    let search =
        driven(&harness).moments.last().and_then(|moment| moment.search.clone()).expect("a search");
    assert_eq!(ghost(&harness), None);
    let rows: Vec<Rect> =
        harness.get_all_by_label_contains(" s: ").map(|node| node.rect()).collect();
    assert_eq!(rows.len(), 1 + search.candidates.len());
    let second = rows[2].center();
    step(vec![Event::PointerMoved(second)], &mut harness);
    step(vec![button(second, true)], &mut harness);
    step(vec![button(second, false)], &mut harness);
    step(vec![Event::PointerGone], &mut harness);
    harness.run();
    assert_eq!(ghost(&harness), Some(search.candidates[1].place));
    picture("match-why-dark", &mut harness);
}

#[test]
fn recorded_input_is_replayed_and_control_taken_again() {
    let mut harness = harness(DESK, LIGHT, page(SMALL));
    harness.key_down(Keyboard::W);
    play(40, &mut harness);
    harness.key_up(Keyboard::W);
    press("Replay", &mut harness);
    while harness.state_mut().session.work() {}
    harness.run();
    assert!(!harness.state().session.is_driven());
    assert!(harness.state().session.query().contains("drive="));
    press("Take control", &mut harness);
    while harness.state_mut().session.work() {}
    harness.run();
    assert!(
        harness.state().session.is_driven() && harness.state().session.recording().ticks() == 0
    );
}

#[test]
fn match_lab_fits_every_page() {
    for (name, size, theme, link) in [
        ("match-desk-dark", DESK, DARK, "lab=match"),
        ("match-desk-light", DESK, LIGHT, "lab=match&scenario=spin&play=off&t=2.2"),
        (
            "match-compare-dark",
            DESK,
            DARK,
            "lab=match&scenario=left&compare=hysteresis:none,bias,votes&play=off&t=3",
        ),
        ("match-phone-dark", PHONE, DARK, "lab=match"),
        ("match-phone-light", PHONE, LIGHT, "lab=match&scenario=run&play=off&t=4"),
        ("match-projector", vec2(1280.0, 720.0), HALL, "lab=match"),
    ] {
        let mut harness = harness(size, theme, page(link));
        let walk = Control::new(glam::DVec2::new(0.6, 1.2), None);
        harness
            .state_mut()
            .session
            .apply(Command::Drive(DriveCommand::Steer(walk)))
            .expect("a page as the tests need it");
        for _ in 0..150 {
            harness.state_mut().session.tick(1.0 / 60.0);
        }
        harness.run();
        harness.get_by_label("All clips, with the current frame");
        assert!(driven(&harness).jumps_secs().count() > 0, "{name}");
        picture(name, &mut harness);
    }
}

#[test]
fn stretch_is_tagged_by_hand() {
    let mut harness = harness(DESK, DARK, page(SMALL));
    play(5, &mut harness);
    press(text::TAGS.english(), &mut harness);
    press(text::TAG_WHAT_PLAYS.english(), &mut harness);
    press(&text::tag_as("exclude", false).to_string(), &mut harness);
    let tags = harness.state().session.params().tags();
    let [tag] = tags else { panic!("{tags:?}") };
    assert!(tag.word == "exclude" && tag.secs[1] - tag.secs[0] > 0.2 && !tag.takes_away, "{tag:?}");
    press(text::TAKE_TAG_AWAY.english(), &mut harness);
    assert!(harness.state().session.params().tags().is_empty());
}
