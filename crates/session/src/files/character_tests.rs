//! Tests of files with a skinned mesh.

use super::fixtures::{figure, person};
use crate::fixtures::*;

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
    assert!(
        !session.library().get(&spider_id).unwrap().warnings.is_empty(),
        "it is said at its row as well"
    );
    let character = session.character().expect("its own clip is in A");
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

    // Beside clips of the user's it is not cast, nor without a motion of its own.
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=blend".into())).unwrap();
    for seed in [1.0, 2.0] {
        session.load(&format!("own {seed}.bvh"), made_bvh(seed)).unwrap();
    }
    let spider_id = session.load("spider.glb", spider()).unwrap().ids.remove(0);
    assert!(session.character().is_none() && session.character_note().is_none());
    session.apply(Command::Set(vec![(Key::Character, Value::Text(spider_id.clone()))])).unwrap();
    assert!(session.character().is_some(), "it can be chosen by hand");

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

/// Returns a file with a figure of eight legs that are named like those of a person, and `frames`
/// frames of a motion.
fn spider_with_legs(frames: usize) -> Arc<[u8]> {
    use segue_motion::clip::Clip;
    use segue_motion::skeleton::{Joint, Pose, Skeleton};
    let joint = |name: String, parent, offset, end_site| Joint {
        name,
        parent,
        offset,
        end_site,
        channels: vec![],
    };
    let mut joints = vec![joint("body".into(), None, glam::Vec3::ZERO, None)];
    for leg in 0..8 {
        let side = if leg < 4 { "L" } else { "R" };
        let angle = 0.75 - 0.5 * (leg % 4) as f32;
        let sign = if leg < 4 { 1.0 } else { -1.0 };
        let out = glam::Vec3::new(sign * angle.cos(), 0.0, angle.sin());
        let mut parent = 0;
        for part in 0..3 {
            let rise = [0.1, 0.3, -0.3][part];
            let end = (part == 2).then(|| out * 0.2 + glam::Vec3::Y * -0.4);
            let offset = out * 0.2 + glam::Vec3::Y * rise;
            joints.push(joint(format!("Leg{}_{part}.{side}", leg % 4), Some(parent), offset, end));
            parent = joints.len() - 1;
        }
    }
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    let poses = (0..frames).map(|frame| Pose {
        root_translation: glam::Vec3::new(0.0, 0.3, 0.01 * frame as f32),
        rotations: (0..skeleton.len())
            .map(|joint| glam::Quat::from_rotation_x(0.1 * ((joint + frame) % 3) as f32))
            .collect(),
        ..Pose::default()
    });
    let poses: Vec<Pose> = poses.collect();
    figure(&Clip::from_poses("spider", skeleton, 30.0, poses).unwrap())
}

#[test]
fn figure_with_eight_legs_is_moved_by_its_own_clips_alone() {
    let mut session = Session::new();
    let loaded = session.load("spider.glb", spider_with_legs(20)).unwrap();
    let character = session.character().unwrap();
    assert!(!character.has_limbs());
    assert_eq!(session.params().text(Key::A), loaded.ids[0]);
    for lab in ["view&a=walk", "blend&a=walk&b=run", "loop&a=walk"] {
        let link = format!("lab={lab}&character={}", loaded.ids[0]);
        session.apply(Command::OpenLink(link)).unwrap();
        settle(&mut session);
        let motion = Arc::clone(&session.main_outcome().unwrap().motion);
        assert!(!character.is_moved_by(motion.clip().skeleton(), motion.roles()), "{lab}");
        assert!(session.character_note().is_some(), "{lab}");
    }
}

#[test]
fn figure_that_nothing_moves_is_not_cast_and_can_be_chosen() {
    // Neither has it limbs, nor a clip of its own.
    let mut session = Session::new();
    let loaded = session.load("spider.glb", spider_with_legs(0)).unwrap();
    assert!(session.character().is_none() && session.character_note().is_none());
    assert!(
        loaded
            .warnings
            .iter()
            .any(|warning| warning.to_string().contains("only its own clips can animate it")),
        "{:?}",
        loaded.warnings
    );
    let choice = (Key::Character, Value::Text(loaded.ids[0].clone()));
    session.apply(Command::Set(vec![choice])).unwrap();
    settle(&mut session);
    assert!(session.character().is_some() && session.character_note().is_some());
}

#[test]
fn person_of_any_rig_is_cast_and_moved_by_other_clips() {
    for (name, skeleton, _) in segue_motion::skeleton::fixtures::all() {
        let clip = segue_motion::clip::Clip::new(name, Arc::clone(&skeleton), 30.0, vec![], vec![]);
        let mut session = Session::new();
        session.apply(Command::OpenLink("lab=view&a=walk".into())).unwrap();
        let loaded = session.load("person.glb", figure(&clip.unwrap())).unwrap();
        assert_eq!(session.params().text(Key::Character), loaded.ids[0], "{name}");
        settle(&mut session);
        assert_eq!(session.character_note(), None, "{name}");
    }
}

#[test]
fn character_with_a_motion_brings_both() {
    let mut session = Session::new();
    let loaded = session.load("walker.glb", person(60)).unwrap();
    assert_eq!(session.params().text(Key::A), loaded.ids[0]);
    assert_eq!(session.params().text(Key::Character), loaded.ids[0]);
    assert_eq!(loaded.warnings, []);
}
