//! Tests of files that depend on others: motions and their skeletons, archives.

use super::messages::MAX_NAMED;
use crate::Notice;
use crate::fixtures::*;
use crate::reading::Content;
use segue_formats::ImportOptions;
use segue_formats::archive::MAX_FILES;
use std::io::Write as _;

#[test]
fn motion_without_a_skeleton_waits_for_it() {
    let mut session = Session::new();
    let loaded = session.load("01_02.amc", bytes(AMC)).unwrap();
    assert!(loaded.warnings[0].to_string().contains("drop the .asf file"), "{:?}", loaded.warnings);
    assert_eq!(files(&session), [("01_02".to_owned(), "amc", 0)]);
    // It waits after a reload, too.
    let mut restored = Session::new();
    restored.restore(&session.saved(), |_| Some(Content::Here(bytes(AMC))), None);
    for mut session in [session, restored] {
        session.load("01.asf", bytes(ASF)).unwrap();
        assert_eq!(
            files(&session),
            [("01_02".to_owned(), "amc", 2)],
            "and the skeleton has no row of its own"
        );
        assert_eq!(session.slot(Slot::A).unwrap().id, loaded.ids[0]);
    }
}

#[test]
fn waiting_motion_is_read_again_only_when_a_skeleton_arrives() {
    let mut session = Session::new();
    let task = session.begin_reading("01_02.amc", Content::Outside("file 1".into()), 2 << 20);
    let report = |setup: &crate::reading::ReadSetup| {
        crate::reading::read("01_02.amc", AMC.as_bytes(), setup, &mut |_| true).unwrap()
    };
    session
        .finish_reading(task, Ok(report(&crate::reading::ReadSetup::default())))
        .unwrap()
        .unwrap();
    session.take_requests();
    let asked = |session: &mut Session| {
        session.take_requests().into_iter().find_map(|request| match request {
            Request::Read(task) => Some(task),
            _ => None,
        })
    };
    session.load("walk.bvh", bytes(BVH)).unwrap();
    assert_eq!(asked(&mut session), None);
    session.load("01.asf", bytes(ASF)).unwrap();
    let again = asked(&mut session).unwrap();
    session.finish_reading(again.id, Ok(report(&again.setup))).unwrap().unwrap();
    let names: Vec<String> = files(&session).into_iter().map(|(name, ..)| name).collect();
    assert_eq!(names, ["01_02", "walk"], "the skeleton has no row of its own any longer");
}

/// Returns the bytes of a session's files by their SHA-256, as storage has them.
fn stored(session: &Session) -> impl Fn(&str) -> Option<Content> + Copy + '_ {
    |sha256| {
        session.library().entries().iter().find_map(|entry| match &entry.origin {
            Origin::File(file) if file.sha256 == sha256 => Some(file.content.clone()),
            _ => None,
        })
    }
}

/// Returns the number of notices of a level.
fn told(session: &Session, level: Level) -> usize {
    session.notices().list().iter().filter(|notice| notice.level == level).count()
}

/// Names and bytes of dropped files.
type Dropped<'a> = &'a [(&'a str, Arc<[u8]>)];

/// Returns the clips of files in the library, and the clips in A and B.
fn shown(session: &Session) -> (Vec<(String, &'static str, usize)>, [String; 2]) {
    (files(session), [Key::A, Key::B].map(|key| session.params().text(key).to_owned()))
}

#[test]
fn files_read_elsewhere_give_the_same_as_files_read_at_once() {
    let packed = {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(BVH.as_bytes()).unwrap();
        Arc::<[u8]>::from(encoder.finish().unwrap())
    };
    let archive = Arc::<[u8]>::from(zip(&[("01_03.amc", AMC)]));
    let dropped: [Dropped<'_>; 6] = [
        &[("walk.bvh", bytes(BVH))],
        &[("01_02.amc", bytes(AMC)), ("01.asf", bytes(ASF))],
        &[("01.asf", bytes(ASF)), ("01_02.amc", bytes(AMC))],
        &[("01.asf", bytes(ASF)), ("takes.zip", archive)],
        &[("person.glb", person(60))],
        &[("walk.bvh.gz", packed), ("broken.bvh", bytes("HIERARCHY ROOT"))],
    ];
    for files in dropped {
        let (mut at_once, mut elsewhere) = (Session::new(), Session::with_external_reader());
        for (name, bytes) in files {
            at_once.load(name, Arc::clone(bytes)).ok();
            assert_eq!(
                elsewhere.load(name, Arc::clone(bytes)),
                Ok(LoadedFile::default()),
                "it is asked for"
            );
        }
        assert!(elsewhere.clip_infos().iter().all(|info| info.sha256.is_none()));
        serve(&mut elsewhere);
        assert_eq!(shown(&elsewhere), shown(&at_once));
        assert_eq!(told(&elsewhere, Level::Error), told(&at_once, Level::Error));
        assert!(elsewhere.jobs().iter().all(|job| job.task.is_none()));

        // After a reload, and read with other options.
        let mut restored = Session::with_external_reader();
        restored.restore(&elsewhere.saved(), stored(&at_once), None);
        serve(&mut restored);
        assert_eq!(shown(&restored), shown(&at_once));
        let id = restored.clip_infos().into_iter().find(|info| info.sha256.is_some()).unwrap().id;
        let options = segue_formats::ImportOptions { fps: Some(60.0), ..Default::default() };
        restored.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
        serve(&mut restored);
        assert_eq!(restored.clip_infos().into_iter().find(|info| info.id == id).unwrap().fps, 60.0);
    }
}

#[test]
fn bundled_take_that_cannot_be_read_is_requested_by_the_next_command_only() {
    let sample = &Session::samples()[2];
    let mut session = Session::with_external_reader();
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
    session.load_sample(sample, b"").unwrap();
    let Some(Request::Read(task)) = session.take_requests().pop() else { panic!() };
    session
        .finish_reading(task.id, Err("the worker could not be started".into()))
        .unwrap()
        .unwrap_err();
    assert!(session.take_requests().is_empty() && !session.is_reading_small());
    session.load_sample(sample, b"").unwrap();
    serve(&mut session);
    assert!(
        session.take_requests().is_empty() && !session.is_reading_small(),
        "nor where it is damaged"
    );
    session.apply(Command::Set(vec![(Key::BlendTime, Value::Number(0.6))])).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
}

#[test]
fn clips_that_were_read_stay_read_after_undo() {
    let mut session = Session::with_external_reader();
    session.load("walk.bvh", bytes(BVH)).unwrap();
    session.load("01.asf", bytes(ASF)).unwrap();
    session.load("01_02.amc", bytes(AMC)).unwrap();
    serve(&mut session);
    let unread =
        |session: &Session| files(session).iter().filter(|(.., frames)| *frames == 0).count();
    let (mut before, mut late) = (Session::with_external_reader(), Session::with_external_reader());
    before.restore(&session.saved(), stored(&session), None);
    // Something changes while they are read, or before they arrive.
    let change = |session: &mut Session| {
        session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(9.0))])).unwrap();
    };
    change(&mut before);
    change(&mut late);
    late.restore_late(&session.saved(), stored(&session));
    for mut session in [before, late] {
        assert_eq!(unread(&session), 2);
        serve(&mut session);
        assert_eq!(unread(&session), 0);
        session.apply(Command::Undo).unwrap();
        assert_eq!(unread(&session), 0);
        session.apply(Command::Redo).unwrap();
        assert_eq!(unread(&session), 0);
    }
}

#[test]
fn options_changed_while_a_file_is_read_take_effect() {
    let mut session = Session::with_external_reader();
    session.load("walk.bvh", bytes(BVH)).unwrap();
    serve(&mut session);
    let id = session.clip_infos().into_iter().find(|info| info.sha256.is_some()).unwrap().id;
    let fps_of = |session: &Session| {
        session.clip_infos().into_iter().find(|info| info.id == id).unwrap().fps
    };
    let options_of = |session: &Session| match &session.library().get(&id).unwrap().origin {
        Origin::File(file) => file.options,
        _ => panic!(),
    };
    let reimport = |session: &mut Session, fps: Option<f64>, metres_per_unit: Option<f64>| {
        let options = segue_formats::ImportOptions { metres_per_unit, fps, ..options_of(session) };
        session.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
    };
    reimport(&mut session, Some(60.0), None);
    reimport(&mut session, Some(60.0), Some(0.5));
    serve(&mut session);
    assert_eq!((fps_of(&session), options_of(&session).metres_per_unit), (60.0, Some(0.5)));
    // Taken back before its report has arrived, the report is ignored.
    reimport(&mut session, Some(90.0), Some(0.5));
    session.apply(Command::Undo).unwrap();
    serve(&mut session);
    assert_eq!(fps_of(&session), 60.0);
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Undo).unwrap();
    serve(&mut session);
    assert_eq!(
        (fps_of(&session), options_of(&session)),
        (10.0, segue_formats::ImportOptions::default())
    );
}

#[test]
fn bundled_take_is_read_elsewhere_without_a_notice() {
    let sample = &Session::samples()[2];
    let packed = std::fs::read(format!(
        "{}/../../assets/samples/{}",
        env!("CARGO_MANIFEST_DIR"),
        sample.file
    ))
    .unwrap();
    let mut session = Session::with_external_reader();
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    let asks = |session: &mut Session| session.take_requests().contains(&Request::Sample(sample));
    assert!(asks(&mut session));
    session.load_sample(sample, &packed).unwrap();
    assert!(session.is_reading_small() && session.jobs().is_empty());
    session.apply(Command::Set(vec![(Key::BlendTime, Value::Number(0.6))])).unwrap();
    let told = session.notices().list().len();
    let reads: Vec<_> = session.take_requests();
    assert!(!reads.contains(&Request::Sample(sample)), "it has come");
    let Some(Request::Read(task)) =
        reads.into_iter().find(|request| matches!(request, Request::Read(_)))
    else {
        panic!()
    };
    let report = crate::reading::read(&task.name, &packed, &task.setup, &mut |_| true).unwrap();
    session.finish_reading(task.id, Ok(report)).unwrap().unwrap();
    assert!(session.library().get(sample.id).unwrap().motion.is_some());
    assert_eq!(session.notices().list().len(), told);
    assert!(!session.is_reading_small());
}

#[test]
fn motion_has_the_skeleton_of_its_name() {
    let of_16 = ASF.replace("length 85", "length 95");
    for ahead in [true, false] {
        for mut session in [Session::new(), Session::with_external_reader()] {
            let mut come = |files: &[(&str, &str)]| {
                for (name, text) in files {
                    session.load(name, bytes(text)).unwrap();
                }
                serve(&mut session);
                session
                    .notices()
                    .list()
                    .last()
                    .map(|notice| notice.text.clone())
                    .unwrap_or_default()
            };
            come(&[("16.asf", &of_16), ("16_22.amc", AMC)]);
            // The motion's own skeleton arrives before or after it.
            let own =
                [("01_01.amc", AMC.replace("spine 2", "spine 3")), ("01_01.asf", ASF.to_owned())];
            let own = [(own[0].0, own[0].1.as_str()), (own[1].0, own[1].1.as_str())];
            if ahead {
                come(&[own[1], own[0]]);
            } else {
                assert!(come(&own[..1]).to_string().contains("It is on the skeleton of 16.asf."));
                come(&own[1..]);
            }
            assert_eq!(
                files(&session),
                [("16_22".to_owned(), "amc", 2), ("01_01".to_owned(), "amc", 2)]
            );
            let companions =
                session.library().entries().iter().filter_map(|entry| match &entry.origin {
                    Origin::File(file) => Some(file.companion.as_ref()?.name.as_str()),
                    _ => None,
                });
            assert_eq!(companions.collect::<Vec<_>>(), ["16.asf", "01_01.asf"]);
        }
    }
}

#[test]
fn motion_or_skeleton_alone_has_a_notice_until_its_other_half_arrives() {
    for files in [[("01_02.amc", AMC), ("01.asf", ASF)], [("01.asf", ASF), ("01_02.amc", AMC)]] {
        for mut session in [Session::new(), Session::with_external_reader()] {
            session.load(files[0].0, bytes(files[0].1)).unwrap();
            serve(&mut session);
            assert_eq!(told(&session, Level::Warning), 1);
            session.load(files[1].0, bytes(files[1].1)).unwrap();
            serve(&mut session);
            let texts: Vec<String> =
                session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
            assert!(
                !texts.iter().any(|text| text.contains("no animation") || text.contains("needs")),
                "{texts:?}"
            );
        }
    }
}

#[test]
fn skeleton_serves_all_its_motions() {
    let mut session = Session::new();
    session.load("01.asf", bytes(ASF)).unwrap();
    assert_eq!(files(&session), [("01".to_owned(), "asf", 0)]);
    session.load("01_01.amc", bytes(AMC)).unwrap();
    let id =
        session.load("01_02.amc", bytes(&AMC.replace("spine 2", "spine 9"))).unwrap().ids.remove(0);
    assert_eq!(files(&session), [("01_01".to_owned(), "amc", 2), ("01_02".to_owned(), "amc", 2)]);
    // The skeleton is stored with each, and used when the file is read again.
    let saved = session.saved();
    let mut restored = Session::new();
    restored.restore(&saved, stored(&session), None);
    assert_eq!(files(&restored), files(&session));
    let options = segue_formats::ImportOptions { fps: Some(60.0), ..Default::default() };
    restored.apply(Command::File(FileCommand::Reimport(id.clone(), options))).unwrap();
    let info = restored.clip_infos().into_iter().find(|info| info.id == id).unwrap();
    assert_eq!((info.frames, info.fps), (2, 60.0));
}

#[test]
fn archive_brings_all_its_motions() {
    // A zip archive with stored files, written by hand: the crate that reads archives writes none
    // in tests of the core.
    let names = [
        ("take/01.asf", ASF),
        ("take/01_01.amc", AMC),
        ("take/walk.bvh", BVH),
        ("notes.txt", "hello"),
    ];
    let mut session = Session::new();
    let loaded = session.load("takes.zip", Arc::from(zip(&names))).unwrap();
    assert_eq!(loaded.ids.len(), 2, "{loaded:?}");
    assert_eq!(files(&session), [("01_01".to_owned(), "amc", 2), ("walk".to_owned(), "bvh", 2)]);
    assert!(session.notices().list().last().unwrap().text.to_string().contains("2 files"));
    // Files from the archive are stored one by one.
    let mut restored = Session::new();
    restored.restore(&session.saved(), stored(&session), None);
    assert_eq!(files(&restored), files(&session));

    let packed = {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(BVH.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    session.load("other.bvh.gz", Arc::from(packed)).unwrap();
    assert!(files(&session).iter().any(|(name, ..)| name == "other"));
    assert!(session.load("cut.zip", Arc::from(&zip(&names)[..200])).is_err());
}

const BVH: &str = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n2";

/// Returns a zip archive of uncompressed files (PKWARE's application note, 4.3).
fn zip(files: &[(&str, &str)]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let mut crc = flate2::Crc::new();
        crc.update(text.as_bytes());
        let mut about = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        about.extend(crc.sum().to_le_bytes());
        about.extend((text.len() as u32).to_le_bytes());
        about.extend((text.len() as u32).to_le_bytes());
        about.extend((name.len() as u16).to_le_bytes());
        about.extend([0, 0]);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&about);
        directory.extend([0; 10]);
        directory.extend((out.len() as u32).to_le_bytes());
        directory.extend(name.as_bytes());
        out.extend(b"PK\x03\x04");
        out.extend(&about);
        out.extend(name.as_bytes());
        out.extend(text.as_bytes());
    }
    let at = out.len() as u32;
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend((files.len() as u16).to_le_bytes());
    out.extend((files.len() as u16).to_le_bytes());
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(at.to_le_bytes());
    out.extend([0, 0]);
    out
}

/// Returns a person in a file of another program: a mesh with a skin, and `frames` frames of a
/// walk.
fn person(frames: usize) -> Arc<[u8]> {
    let walk = segue_motion::synth::synthesize(&segue_motion::synth::Params::new(
        segue_motion::synth::Action::Walk,
    ))
    .unwrap()
    .clip;
    figure(&walk.crop(0..frames).unwrap())
}

/// Returns a creature with eight legs, none of which a person has.
fn spider() -> Arc<[u8]> {
    let leg = |number: u32| {
        let angle = f64::from(number) * std::f64::consts::FRAC_PI_4 + 0.4;
        let (x, z) = (20.0 * angle.sin(), 20.0 * angle.cos());
        format!(
            "  JOINT segment_{number}_a\n  {{\n    OFFSET {x:.3} 4 {z:.3}\n    CHANNELS 3 Zrotation Xrotation Yrotation\n    JOINT segment_{number}_b\n    {{\n      OFFSET {x:.3} 10 {z:.3}\n      CHANNELS 3 Zrotation Xrotation Yrotation\n      End Site\n      {{\n        OFFSET {x:.3} -40 {z:.3}\n      }}\n    }}\n  }}\n"
        )
    };
    let legs: String = (0..8).map(leg).collect();
    let row = |frame: u32| {
        let turns: Vec<String> =
            (0..48).map(|channel| (5 * ((channel + frame) % 3)).to_string()).collect();
        format!("0 30 {frame} 0 0 0 {}\n", turns.join(" "))
    };
    let rows: String = (0..40).map(row).collect();
    let text = format!(
        "HIERARCHY\nROOT trunk\n{{\n  OFFSET 0 0 0\n  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n{legs}}}\nMOTION\nFrames: 40\nFrame Time: 0.033333\n{rows}"
    );
    let read = segue_formats::import(
        "spider.bvh",
        text.as_bytes(),
        &segue_formats::ImportOptions::default(),
    );
    figure(&read.unwrap().clips[0].clip)
}

/// Returns a clip in a file of another program, with a mesh around its bones.
fn figure(clip: &segue_motion::clip::Clip) -> Arc<[u8]> {
    use segue_formats::gltf::{GlbOptions, write_glb};
    let mut bytes = write_glb(clip, &GlbOptions { smooth: true, ..GlbOptions::default() }).unwrap();
    let at = bytes.windows(6).position(|w| w == b"Segue ").unwrap();
    bytes[at..at + 5].copy_from_slice(b"Other");
    bytes.into()
}

#[test]
fn dropped_file_with_a_skin_becomes_the_character() {
    let mut session = Session::new();
    assert!(session.character().is_none());
    let before = session.params().text(Key::A).to_owned();
    let loaded = session.load("person.glb", person(0)).unwrap();
    let character = session.character().unwrap();
    assert_eq!(session.params().text(Key::Character), loaded.ids[0]);
    assert!(character.mesh.positions.len() > 1000);
    // A character without a motion plays nothing.
    assert_eq!(session.params().text(Key::A), before);
    let outcome = Arc::clone(session.main_outcome().unwrap());
    let drive =
        segue_motion::skin::Drive::new(outcome.motion.clip(), outcome.motion.roles(), &character)
            .unwrap();
    let mut transforms = Vec::new();
    drive.transforms(&outcome.motion.clip().world_pose(10), &character.mesh, &mut transforms);
    assert_eq!(transforms.len(), character.skeleton.len());
    assert!(
        transforms.iter().all(
            |transform| transform.translation.is_finite() && transform.rotation.is_normalized()
        )
    );
    // It is stored with the library and comes back with it.
    let saved = session.saved();
    let mut again = Session::new();
    let bytes = person(0);
    again.restore(&saved, |_| Some(Content::Here(Arc::clone(&bytes))), None);
    assert_eq!(again.character().unwrap().mesh, character.mesh);
    // It is removed by the parameter, by undo, and with its clip.
    session.apply(Command::Set(vec![(Key::Character, Value::Text(String::new()))])).unwrap();
    assert!(session.character().is_none());
    session.apply(Command::Undo).unwrap();
    assert!(session.character().is_some());
    session.apply(Command::Remove(loaded.ids[0].clone())).unwrap();
    assert!(session.character().is_none() && session.params().text(Key::Character).is_empty());
}

#[test]
fn figure_that_no_other_clip_moves_is_no_character_for_others() {
    // Alone, it serves its own clips. A motion that cannot move it is shown with a body of its own,
    // and a note.
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=blend".into())).unwrap();
    let loaded = session.load("spider.glb", spider()).unwrap();
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.to_string().contains("only its own clips can animate it")),
        "{:?}",
        loaded.warnings
    );
    let spider_id = loaded.ids[0].clone();
    let character = session.character().unwrap();
    let show = |session: &mut Session, a: &str| {
        let link = format!("lab=view&a={a}&character={spider_id}");
        session.apply(Command::OpenLink(link)).unwrap();
        settle(session);
        let motion = Arc::clone(&session.main_outcome().unwrap().motion);
        let drive = segue_motion::skin::Drive::new(motion.clip(), motion.roles(), &character);
        (drive.is_some(), session.character_note())
    };
    assert_eq!(show(&mut session, &spider_id), (true, None));
    let (is_moved, note) = show(&mut session, "walk");
    assert!(!is_moved);
    assert!(note.unwrap().to_string().contains("This clip cannot animate"));

    // A person that is the character stays.
    let mut session = Session::new();
    let person_id = session.load("person.glb", person(0)).unwrap().ids.remove(0);
    session.load("spider.glb", spider()).unwrap();
    assert_eq!(session.params().text(Key::Character), person_id);
    // A person replaces a spider.
    let mut session = Session::new();
    session.load("spider.glb", spider()).unwrap();
    session.load("person.glb", person(0)).unwrap();
    assert_eq!(session.params().text(Key::Character), person_id);
}

#[test]
fn motion_file_without_a_motion_waits_for_nothing() {
    for text in ["", ":FULLY-SPECIFIED\n:DEGREES\n", "<html>not found</html>", ":DEGREES\n1\n"] {
        let mut session = Session::new();
        let before = session.library().entries().len();
        let error = session.load("01_02.amc", bytes(text)).unwrap_err();
        assert!(error.to_string().starts_with("01_02.amc:"), "{error}");
        assert_eq!(session.library().entries().len(), before, "{text}");
        assert!(
            session
                .notices()
                .list()
                .iter()
                .all(|notice| !notice.text.to_string().contains("needs")),
            "{text}"
        );
    }
}

#[test]
fn skeleton_that_does_not_fit_is_named() {
    let other = ASF.replace("thigh", "leg").replace("spine", "trunk");
    let said = |session: &Session| {
        session
            .notices()
            .list()
            .iter()
            .map(|notice| notice.text.to_string())
            .collect::<Vec<_>>()
            .join("\n")
    };
    for files in [
        [("01_02.amc", AMC), ("01.asf", other.as_str())],
        [("01.asf", other.as_str()), ("01_02.amc", AMC)],
    ] {
        let mut session = Session::new();
        for (name, text) in files {
            session.load(name, bytes(text)).unwrap();
        }
        let said = said(&session);
        assert!(said.contains("The skeleton of 01.asf does not fit: 1 of 3 bones"), "{said}");
        // The one that fits is used when it arrives.
        session.load("02.asf", bytes(ASF)).unwrap();
        let motions = files_with_motion(&session);
        assert_eq!(motions, ["01_02"], "{said}");
    }
}

fn files_with_motion(session: &Session) -> Vec<String> {
    let with_motion = files(session).into_iter().filter(|(.., frames)| *frames > 0);
    with_motion.map(|(name, ..)| name).collect()
}

#[test]
fn character_with_a_motion_brings_both() {
    let mut session = Session::new();
    let loaded = session.load("walker.glb", person(60)).unwrap();
    assert_eq!(session.params().text(Key::A), loaded.ids[0]);
    assert_eq!(session.params().text(Key::Character), loaded.ids[0]);
    assert_eq!(loaded.warnings, []);
}

#[test]
fn unreadable_files_of_an_archive_are_counted_in_one_notice() {
    let names: Vec<String> = (0..200).map(|n| format!("{n:03}.bvh")).collect();
    let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
    let mut session = Session::new();
    let loaded = session.load("many.zip", Arc::from(zip(&files))).unwrap();
    let errors: Vec<String> =
        session.notices().errors_since(0).iter().map(|notice| notice.text.to_string()).collect();
    assert_eq!(errors.len(), MAX_NAMED + 1, "{errors:#?}");
    assert_eq!(
        errors[MAX_NAMED],
        "197 more failed: many.zip/003.bvh, many.zip/004.bvh, many.zip/005.bvh, …."
    );
    assert_eq!(loaded.warnings.len(), 200, "whoever loads it by the API is told of each");
}

#[test]
fn limit_of_an_archive_is_reported_even_if_nothing_in_it_can_be_read() {
    let names: Vec<String> = (0..MAX_FILES + 50).map(|n| format!("{n:05}.bvh")).collect();
    let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
    let mut session = Session::new();
    session.load("many.zip", Arc::from(zip(&files))).unwrap();
    let told: Vec<String> =
        session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    assert!(
        told.iter().any(|text| text == "50 motion files of the archive left out: the first 2000 are read."),
        "{told:#?}"
    );
}

#[test]
fn name_of_a_file_is_cleaned_and_its_id_is_short() {
    let name = format!("a\nb\0\u{202e}hvb.{}.amc", "x".repeat(4000));
    let mut session = Session::new();
    let loaded = session.load(&name, bytes(AMC)).unwrap();
    let entry = session.library().find(&loaded.ids[0]).unwrap();
    assert!(
        entry.name.starts_with("a bhvb.xxx") && entry.name.chars().count() <= 202,
        "{}",
        entry.name
    );
    assert!(entry.id.chars().count() < 120, "{}", entry.id);
    session.load("b.asf", bytes(ASF)).unwrap();
    assert_eq!(files(&session)[0].2, 2, "it is read by that name");
    session.apply(Command::Rename(loaded.ids[0].clone(), "x\ny\u{202e}".into())).unwrap();
    assert_eq!(files(&session)[0].0, "x y");
}

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

fn with_size(text: &str, factor: f64) -> String {
    let offset = |line: &str| {
        let (head, numbers) = line.split_once("OFFSET ")?;
        let numbers: Vec<String> = numbers
            .split_whitespace()
            .map(|n| (n.parse::<f64>().unwrap() * factor).to_string())
            .collect();
        Some(format!("{head}OFFSET {}", numbers.join(" ")))
    };
    let lines: Vec<String> =
        text.lines().map(|line| offset(line).unwrap_or_else(|| line.to_owned())).collect();
    lines.join("\n")
}

/// Returns the notice that offers to read clips better.
fn offer(session: &Session) -> Notice {
    let mut offers = session.notices().list().iter().filter(|notice| !notice.mends.is_empty());
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
fn clip_in_a_wrong_unit_or_with_a_wild_row_is_mended_by_its_notice() {
    let text = walk_bvh();
    for (text, part) in [
        (with_wild_row(&text), "1 row with a root that is 1.0e18 m away"),
        (with_size(&text, 1e-12), "m tall: its unit may be another one"),
        (with_size(&text, 1e12), "m tall: its unit may be another one"),
    ] {
        let mut session = Session::new();
        let loaded = session.load("x.bvh", bytes(&text)).unwrap();
        assert!(
            loaded.warnings.iter().any(|warning| warning.to_string().contains(part)),
            "{part}: {:?}",
            loaded.warnings
        );
        let notice = offer(&session);
        assert_eq!(notice.mends, loaded.ids);
        session.apply(Command::File(FileCommand::Mend(notice.id))).unwrap();
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
fn several_absurd_clips_are_mended_at_once_from_an_archive_or_single_files() {
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
        assert_eq!((ids.len(), notice.mends.len()), (4, 3), "{notice:?}");
        // Clips that were removed or set by hand meanwhile are left alone.
        let (tiny, wild) = (ids_named(&session, "tiny"), ids_named(&session, "wild"));
        session.apply(Command::Remove(ids_named(&session, "huge"))).unwrap();
        let by_hand = ImportOptions { metres_per_unit: Some(150.0), ..ImportOptions::default() };
        session.apply(Command::File(FileCommand::Reimport(tiny.clone(), by_hand))).unwrap();
        let tall = height_metres(&session, &tiny);
        session.apply(Command::File(FileCommand::Mend(notice.id))).unwrap();
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
fn mending_several_clips_is_one_step_for_undo() {
    let text = walk_bvh();
    let (tiny, huge) = (with_size(&text, 1e-4), with_size(&text, 1e4));
    let mut session = Session::new();
    session
        .load("takes.zip", Arc::from(zip(&[("tiny.bvh", &*tiny), ("huge.bvh", &*huge)])))
        .unwrap();
    let ids = [ids_named(&session, "tiny"), ids_named(&session, "huge")];
    let heights = |session: &Session| ids.each_ref().map(|id| height_metres(session, id));
    let before = heights(&session);
    session.apply(Command::File(FileCommand::Mend(offer(&session).id))).unwrap();
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

#[test]
fn empty_motion_is_reported_as_an_empty_file_and_waits_for_no_skeleton() {
    for empty in ["", " \r\n"] {
        for skeleton in [None, Some(ASF)] {
            let mut session = Session::new();
            if let Some(skeleton) = skeleton {
                session.load("01.asf", bytes(skeleton)).unwrap();
            }
            let before = files(&session);
            let error = session.load("01_02.amc", bytes(empty)).unwrap_err().to_string();
            assert_eq!(error, "01_02.amc:1:1: found an empty file, expected a motion file");
            let told: Vec<String> =
                session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
            assert!(told.contains(&error), "{told:?}");
            assert_eq!(files(&session), before, "nothing waits");
        }
    }
}

#[test]
fn skeleton_whose_hierarchy_names_unknown_bones_is_reported_with_its_motion() {
    let asf = ASF.replace("root thigh spine", "root thigh spine tail");
    let mut session = Session::new();
    session.load("01.asf", bytes(&asf)).unwrap();
    let loaded = session.load("01_02.amc", bytes(AMC)).unwrap();
    assert!(
        loaded.warnings.iter().any(|warning| warning.to_string().contains("such as `tail`")),
        "{:?}",
        loaded.warnings
    );
}

#[test]
fn long_values_of_a_link_are_shortened_and_its_problems_counted() {
    let long = "x".repeat(100_000);
    let nested = format!("{}walk{}", "blend(a:".repeat(2000), ")".repeat(2000));
    let keys: Vec<String> = (0..500).map(|n| format!("key{n}=1")).collect();
    let links = [
        format!("lab={long}"),
        format!("{long}=1"),
        format!("blend_window={long}"),
        format!("compare={long}"),
        format!("compare=blend_window:{long},2"),
        format!("a={nested}"),
        format!("a=x~{}", "0".repeat(10_000)),
        format!("lab=graph&clips={long}:"),
        format!("lab=graph&clips=walk&go_to={long}"),
        format!("lab=graph&clips=walk&jump={long}"),
        format!("lab=match&tags={long}"),
        format!("lab=register&also={long}"),
        format!("lab=register&pins={long}"),
        format!("src=ftp://{long}"),
        format!("lesson={long}"),
        keys.join("&"),
    ];
    for link in links {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.clone())).unwrap();
        while session.work() {}
        let said = session.notices().list().iter().map(|notice| notice.text.to_string());
        let problems = session
            .panes()
            .iter()
            .filter_map(|pane| pane.problem.as_ref().map(ToString::to_string));
        let lesson = session.lesson().and_then(|lesson| match lesson {
            Lesson::Failed(reason) => Some(reason.to_string()),
            _ => None,
        });
        let texts: Vec<String> = said.chain(problems).chain(lesson).collect();
        assert!(!texts.is_empty(), "{}", link.get(..40).unwrap_or(&link));
        for text in texts {
            assert!(
                text.chars().count() < 600,
                "{} letters: {}…",
                text.len(),
                text.get(..200).unwrap_or(&text)
            );
        }
    }
    let error = Command::Assign(Slot::A, long);
    assert!(Session::new().apply(error).unwrap_err().to_string().len() < 200);
}
