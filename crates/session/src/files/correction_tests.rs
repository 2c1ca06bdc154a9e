//! Tests of clips that are read better by what a notice offers.

use super::fixtures::zip;
use crate::Notice;
use crate::fixtures::*;
use segue_formats::ImportOptions;

fn walk_bvh() -> String {
    let walk = segue_motion::synth::synthesize(&segue_motion::synth::Params::new(
        segue_motion::synth::Action::Walk,
    ));
    segue_formats::bvh::write(&walk.unwrap().clip, &segue_formats::bvh::WriteOptions::default())
}

fn with_wild_row(text: &str) -> String {
    // The 40th row: its root is at 1e18 in the file's centimetres.
    let rows: Vec<&str> = text.lines().collect();
    let first = rows.iter().position(|row| row.starts_with("Frame Time")).unwrap() + 1;
    let (_, rest) = rows[first + 40].split_once(' ').unwrap();
    text.replace(rows[first + 40], &format!("1e20 {rest}"))
}

fn scaled(number: &str, factor: f64) -> String {
    (number.parse::<f64>().unwrap() * factor).to_string()
}

/// Returns the file with bones of other lengths.
fn with_bones(text: &str, factor: f64) -> String {
    let offset = |line: &str| {
        let (head, numbers) = line.split_once("OFFSET ")?;
        let numbers: Vec<String> =
            numbers.split_whitespace().map(|number| scaled(number, factor)).collect();
        Some(format!("{head}OFFSET {}", numbers.join(" ")))
    };
    let lines: Vec<String> =
        text.lines().map(|line| offset(line).unwrap_or_else(|| line.to_owned())).collect();
    lines.join("\n")
}

/// Returns the file in another unit: other lengths of bones, and other positions of the root.
fn with_size(text: &str, factor: f64) -> String {
    let text = with_bones(text, factor);
    let row = |line: &str| {
        let numbers: Vec<&str> = line.split_whitespace().collect();
        numbers.first()?.parse::<f64>().ok()?;
        let (root, others) = numbers.split_at(3);
        let root: Vec<String> = root.iter().map(|number| scaled(number, factor)).collect();
        Some(format!("{} {}", root.join(" "), others.join(" ")))
    };
    let lines: Vec<String> =
        text.lines().map(|line| row(line).unwrap_or_else(|| line.to_owned())).collect();
    lines.join("\n")
}

/// Returns the notice that offers to read clips better.
fn offer(session: &Session) -> Notice {
    let mut offers =
        session.notices().list().iter().filter(|notice| !notice.corrections.is_empty());
    let offer = offers.next().expect("an offer").clone();
    assert!(offers.next().is_none(), "one offer for all");
    offer
}

fn height_metres(session: &Session, id: &str) -> f32 {
    let motion = session.library().find(id).unwrap().motion.clone().unwrap();
    motion.roles().body_height(motion.clip().skeleton())
}

fn longest_step_metres(session: &Session, id: &str) -> f32 {
    let motion = session.library().find(id).unwrap().motion.clone().unwrap();
    let roots = motion.clip().root_translations();
    roots.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f32::max)
}

#[test]
fn clip_in_a_wrong_unit_or_with_a_wild_row_is_corrected_by_its_notice() {
    let text = walk_bvh();
    for (text, part) in [
        (with_wild_row(&text), "1 row with a root that is 1.0e18 m away"),
        (with_size(&text, 1e-12), "m tall: its unit may be wrong"),
        (with_size(&text, 1e12), "m tall: its unit may be wrong"),
    ] {
        let mut session = Session::new();
        let loaded = session.load("x.bvh", bytes(&text)).unwrap();
        assert!(
            loaded.warnings.iter().any(|warning| warning.to_string().contains(part)),
            "{part}: {:?}",
            loaded.warnings
        );
        let notice = offer(&session);
        assert_eq!(notice.corrections, loaded.ids);
        session.apply(Command::File(FileCommand::Correct(notice.id))).unwrap();
        assert!(session.notices().list().iter().all(|left| left.id != notice.id));
        let height = height_metres(&session, &loaded.ids[0]);
        assert!((0.9..2.5).contains(&height), "{part}: {height} m");
        if part.starts_with("1 row") {
            assert!(longest_step_metres(&session, &loaded.ids[0]) < 0.2, "{part}");
        }
        session.apply(Command::Undo).unwrap();
    }
    // A person of a usual size at a usual speed causes no such notice.
    let loaded = Session::new().load("x.bvh", bytes(&text)).unwrap();
    assert_eq!(loaded.warnings, []);
}

#[test]
fn unit_is_not_corrected_where_bones_and_positions_disagree() {
    let mut session = Session::new();
    let loaded = session.load("x.bvh", bytes(&with_bones(&walk_bvh(), 1e-4))).unwrap();
    assert!(loaded.warnings.iter().any(|warning| warning.to_string().contains("m tall")));
    let notices = session.notices().list();
    assert!(notices.iter().all(|notice| notice.corrections.is_empty()), "its walk would be 55 km");
}

#[test]
fn several_absurd_clips_are_corrected_at_once_from_an_archive_or_single_files() {
    let text = walk_bvh();
    let (tiny, huge, wild) = (with_size(&text, 1e-4), with_size(&text, 1e4), with_wild_row(&text));
    let files =
        [("tiny.bvh", &*tiny), ("usual.bvh", &*text), ("huge.bvh", &*huge), ("wild.bvh", &*wild)];
    for is_packed in [true, false] {
        let mut session = Session::new();
        let mut ids = Vec::new();
        if is_packed {
            ids.extend(session.load("takes.zip", Arc::from(zip(&files))).unwrap().ids);
        } else {
            for (name, text) in files {
                ids.extend(session.load(name, bytes(text)).unwrap().ids);
            }
            let text = offer(&session).text;
            assert_eq!(
                text.to_string(),
                "3 clips have a size or position that cannot be right: tiny, huge, wild."
            );
        }
        let notice = offer(&session);
        assert_eq!((ids.len(), notice.corrections.len()), (4, 3), "{notice:?}");
        // Clips that were removed or set by hand meanwhile are left alone.
        let (tiny, wild) = (ids_named(&session, "tiny"), ids_named(&session, "wild"));
        session.apply(Command::Remove(ids_named(&session, "huge"))).unwrap();
        let by_hand = ImportOptions { metres_per_unit: Some(150.0), ..ImportOptions::default() };
        session.apply(Command::File(FileCommand::Reimport(tiny.clone(), by_hand))).unwrap();
        let tall = height_metres(&session, &tiny);
        session.apply(Command::File(FileCommand::Correct(notice.id))).unwrap();
        assert_eq!(height_metres(&session, &tiny), tall);
        assert!(longest_step_metres(&session, &wild) < 0.2);
        // Reading better, setting by hand and removing are one step each.
        for _ in 0..3 {
            session.apply(Command::Undo).unwrap();
            settle(&mut session);
        }
        assert!(
            longest_step_metres(&session, &wild) > 1e17 && session.library().get(&ids[3]).is_some()
        );
        assert!(session.library().entries().iter().any(|entry| entry.name == "huge"));
    }
}

#[test]
fn correcting_several_clips_is_one_step_for_undo() {
    let text = walk_bvh();
    let (tiny, huge) = (with_size(&text, 1e-4), with_size(&text, 1e4));
    let mut session = Session::new();
    session
        .load("takes.zip", Arc::from(zip(&[("tiny.bvh", &*tiny), ("huge.bvh", &*huge)])))
        .unwrap();
    let ids = [ids_named(&session, "tiny"), ids_named(&session, "huge")];
    let heights = |session: &Session| ids.each_ref().map(|id| height_metres(session, id));
    let before = heights(&session);
    session.apply(Command::File(FileCommand::Correct(offer(&session).id))).unwrap();
    assert!(heights(&session).iter().all(|height| (0.9..2.5).contains(height)), "{before:?}");
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!(heights(&session), before);
    session.apply(Command::Undo).unwrap();
    assert!(session.library().get(&ids[0]).is_none(), "the step before is the loading");
}

fn ids_named(session: &Session, name: &str) -> String {
    let entry = session.library().entries().iter().find(|entry| entry.name == name);
    entry.map(|entry| entry.id.clone()).expect("a clip of that name")
}
