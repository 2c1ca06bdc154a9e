//! Tests of motions and their skeletons in files of their own (ASF and AMC).

use super::fixtures::{BVH, count_notices, stored};
use crate::fixtures::*;

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
            let skeleton_files =
                session.library().entries().iter().filter_map(|entry| match &entry.origin {
                    Origin::File(file) => Some(file.skeleton_file.as_ref()?.name.as_str()),
                    _ => None,
                });
            assert_eq!(skeleton_files.collect::<Vec<_>>(), ["16.asf", "01_01.asf"]);
        }
    }
}

#[test]
fn motion_or_skeleton_alone_has_a_notice_until_its_other_half_arrives() {
    for files in [[("01_02.amc", AMC), ("01.asf", ASF)], [("01.asf", ASF), ("01_02.amc", AMC)]] {
        for mut session in [Session::new(), Session::with_external_reader()] {
            session.load(files[0].0, bytes(files[0].1)).unwrap();
            serve(&mut session);
            assert_eq!(count_notices(&session, Level::Warning), 1);
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
