//! The library and the panel of a clip.

use super::*;

/// Returns the built-in walk as a file, with a tail that no other skeleton has, and a T-pose in
/// front.
pub(super) fn file(session: &Session) -> String {
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

/// Returns a page with that file as A.
pub(super) fn with_file(link: &str) -> Page {
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
    page.session.tick(60.0);
    page.out = Out::default();
    page
}

pub(super) fn loaded(page: &Page) -> &Entry {
    let mut entries = page.session.library().entries().iter();
    entries
        .find(|entry| matches!(entry.origin, Origin::File(_)))
        .expect("a page as the tests need it")
}

#[test]
fn clip_panel_shows_the_facts_of_the_file() {
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
        for label in ["Unit", "Up axis", "Skip the T-pose", "Body parts"] {
            harness.get_by_label(label);
        }
        harness.get_by_label(&format!("Joints: {joints} "));
        harness.get_by_label_contains("Root: position X Y Z");
        // One height, and no other beside it.
        assert_eq!(harness.query_all_by_label_contains("Body height: ").count(), 1);
        assert_eq!(harness.query_all_by_label_contains("units tall").count(), 0);
        press("Joints", &mut harness);
        assert!(harness.state().state.joints_open);
        harness.get_by_label("Joints").scroll_to_me();
        harness.run();
        picture(name, &mut harness);
    }
}

#[test]
fn correction_by_hand_reads_the_file_again() {
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
    press("Skip the T-pose", &mut harness);
    let command = harness.state_mut().out.commands.pop();
    assert!(
        matches!(command, Some(Command::File(FileCommand::Reimport(_, options))) if !options.drop_t_pose),
        "{command:?}"
    );
    // A rate that the list lacks is typed.
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
fn joint_of_the_tree_is_chosen_by_pointer_and_by_keyboard() {
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
    // The last joint is scrolled into sight, and keeps the focus.
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
fn library_opens_the_clip_panel_under_the_row() {
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
fn library_shows_how_far_the_work_is_stored() {
    let mut harness = harness(DESK, DARK, page("lab=view&play=off"));
    for words in [text::SAVED.english(), text::SAVING.english(), text::NOT_ALL_SAVED.english()] {
        assert!(harness.query_by_label(words).is_none(), "{words} where nothing is stored");
    }
    for (stored, words) in [
        (StorageState::Done, "Saved"),
        (StorageState::UnderWay, "Saving…"),
        (StorageState::Incomplete, "Not all saved"),
    ] {
        harness.state_mut().state.stored = Some(stored);
        harness.run();
        harness.get_by_label(words);
    }
    picture("stored-desk-dark", &mut harness);
}

#[test]
fn memory_in_use_above_a_quarter_is_shown() {
    let mut harness = harness(DESK, DARK, page("lab=view&play=off"));
    for (bytes, is_shown) in [(750_000_000, false), (1_234_000_000, true)] {
        harness.state_mut().session.note_memory(PageMemory {
            bytes,
            limit: 3_000_000_000,
            coming: 0,
        });
        harness.run();
        assert_eq!(harness.query_by_label(text::MEMORY.english()).is_some(), is_shown, "{bytes}");
    }
    let memory = harness.state().session.memory().unwrap();
    assert_eq!(text::memory(memory).to_string(), "1234 MB of 3 GB");
}

#[test]
fn motion_is_saved_with_the_chosen_options() {
    let mut harness = harness(DESK, DARK, page("compare=blend_window:30,15,10&play=off"));
    harness.state_mut().state.filming = Filming { pictures: true, films: true, secs: Some(67.4) };
    press("Result", &mut harness);
    press("15 frames", &mut harness);
    press(text::SAVE_MENU.english(), &mut harness);
    press("Rotation order", &mut harness);
    press("X Y Z", &mut harness);
    picture("save-desk-dark", &mut harness);
    press("Save the file", &mut harness);
    press("Save as", &mut harness);
    press("FBX", &mut harness);
    press(text::UP_AXIS.english(), &mut harness);
    press("Z", &mut harness);
    picture("save-fbx-desk-dark", &mut harness);
    press("Save the file", &mut harness);
    press("Save as", &mut harness);
    press("GLB", &mut harness);
    press("Save the file", &mut harness);
    harness.get_by_label("Stop recording and save").click();
    press("Save the stage as a picture", &mut harness);
    harness.get_by_label("Recording, 1:07");
    let actions = &harness.state().out.actions;
    let [
        Action::Save { which, how },
        Action::Save { how: fbx, .. },
        Action::Save { how: glb, .. },
        rest @ ..,
    ] = actions.as_slice()
    else {
        panic!("{actions:?}")
    };
    assert_eq!((which.as_str(), how.format), ("result:1", ExportFormat::Bvh));
    assert_eq!(how.rotation_order, Some(segue_formats::bvh::RotationOrder::Xyz));
    let z_up = Some(segue_motion::clip::UpAxis::Z);
    assert_eq!((fbx.format, fbx.up), (ExportFormat::Fbx, z_up));
    assert_eq!(glb.format, ExportFormat::Glb);
    assert!(rest.contains(&Action::Record) && rest.contains(&Action::SavePicture));
}

#[test]
fn clip_without_a_motion_has_a_status() {
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
        skeleton_file: None,
        index: 0,
        options: ImportOptions::default(),
    };
    let being_read = Entry { origin: Origin::File(large), ..entry.clone() };
    assert_eq!(text::status(&being_read), text::READING);
    let given_up = Entry { unread: Some("Reading large.bvh was stopped.".into()), ..being_read };
    assert_eq!(text::status(&given_up), text::UNREAD);
    let mut harness = harness(DESK, DARK, page);
    harness.get_by_label_contains("alone, needs its skeleton");
    picture("waits-desk-dark", &mut harness);
}

#[test]
fn clip_of_another_skeleton_has_a_note_on_retargeting() {
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
    harness.get_by_label_contains("Retargeted to the skeleton of Walk:");
    let alone = self::page(
        "lab=graph&clips=idle&construction=segments&segment_size=20&blend_window=30&play=off",
    );
    let harness = self::harness(DESK, LIGHT, alone);
    assert!(harness.query_all_by_label_contains("raise the segment to 31").next().is_some());
}

#[test]
fn missing_clip_is_named_in_its_menu() {
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
