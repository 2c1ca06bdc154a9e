//! Tests of motions without bones and body models in files of their own (`NumPy`).

use super::fixtures::stored;
use crate::fixtures::*;

const MODEL: &[u8] = include_bytes!("../../../formats/tests/cases/numpy/SMPLH_FEMALE.npz");
const MOTION: &[u8] = include_bytes!("../../../formats/tests/cases/numpy/amass.npz");
const KIMODO: &[u8] = include_bytes!("../../../formats/tests/cases/numpy/soma30.npz");

/// Returns the distance from the left hip to the knee in a clip, metres.
fn thigh(session: &Session, name: &str) -> f32 {
    let entries = session.library().entries();
    let entry = entries.iter().find(|entry| entry.name == name).unwrap();
    let clip = entry.motion.as_ref().unwrap().clip();
    let knee = clip.skeleton().find("left_knee").unwrap();
    clip.skeleton().joints()[knee].offset.length()
}

fn warnings(session: &Session, name: &str) -> String {
    let entries = session.library().entries();
    let entry = entries.iter().find(|entry| entry.name == name).unwrap();
    entry.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

#[test]
fn motion_takes_the_bones_of_a_model_in_either_order() {
    for ahead in [true, false] {
        for mut session in [Session::new(), Session::with_external_reader()] {
            let mut both = [("SMPLH_FEMALE.npz", MODEL), ("amass.npz", MOTION)];
            if !ahead {
                both.reverse();
            }
            session.load("other.npz", Arc::from(KIMODO)).unwrap();
            for (name, bytes) in both {
                session.load(name, Arc::from(bytes)).unwrap();
                serve(&mut session);
            }
            let mut names: Vec<_> = files(&session);
            names.sort();
            let expected = [("amass", "npz", 8), ("other", "npz", 8)];
            assert_eq!(names, expected.map(|(name, kind, n)| (name.to_owned(), kind, n)));
            assert!((thigh(&session, "amass") - 0.382_099_46).abs() > 1e-5, "generic bones");
            let told = warnings(&session, "amass");
            assert_eq!(told, "its bones are those of SMPLH_FEMALE.npz");
            // After a reload the model comes with the motion.
            let mut restored = Session::new();
            restored.restore(&session.saved(), stored(&session), None);
            serve(&mut restored);
            assert!((thigh(&restored, "amass") - thigh(&session, "amass")).abs() < 1e-6);
            // Another motion takes it as well.
            restored.load("again.npz", Arc::from([MOTION, &[0]].concat())).unwrap();
            serve(&mut restored);
            assert_eq!(warnings(&restored, "again"), "its bones are those of SMPLH_FEMALE.npz");
        }
    }
}

#[test]
fn motion_without_a_model_says_so_and_plays() {
    let mut session = Session::new();
    let loaded = session.load("amass.npz", Arc::from(MOTION)).unwrap();
    assert!(warnings(&session, "amass").contains("open the SMPL model"));
    assert_eq!(session.slot(Slot::A).unwrap().id, loaded.ids[0]);
    assert!((thigh(&session, "amass") - 0.382_099_46).abs() < 1e-5);
}

#[test]
fn model_alone_is_no_motion() {
    let mut session = Session::new();
    let before = session.slot(Slot::A).map(|entry| entry.id.clone());
    let loaded = session.load("SMPLH_FEMALE.npz", Arc::from(MODEL)).unwrap();
    assert!(loaded.warnings[0].to_string().contains("no animation"), "{:?}", loaded.warnings);
    assert_eq!(session.slot(Slot::A).map(|entry| entry.id.clone()), before);
    // Its mesh is not kept with the work.
    let entry = session.library().get(&loaded.ids[0]).unwrap();
    let Origin::File(file) = &entry.origin else { panic!("{entry:?}") };
    let small = file.skeleton_file.as_ref().unwrap();
    assert!(small.bytes.len() * 3 < MODEL.len() && small.sha256 == file.sha256);
}
