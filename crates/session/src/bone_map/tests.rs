//! Tests of bone maps: rigs, names, files, and clips that get the parts of their rig.

use super::*;
use crate::fixtures::*;
use glam::Vec3;
use proptest::prelude::*;
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Joint, RoleSource, fixtures};

fn joint(name: &str, parent: Option<usize>) -> Joint {
    Joint { name: name.into(), parent, offset: Vec3::Y, end_site: None, channels: vec![] }
}

fn skeleton(joints: &[(&str, Option<usize>)]) -> Skeleton {
    Skeleton::new(joints.iter().map(|&(name, parent)| joint(name, parent)).collect()).unwrap()
}

#[test]
fn rig_depends_on_names_and_parents_alone() {
    let body = fixtures::mixamo();
    let rig = rig_of(&body);
    assert_eq!(rig.len(), RIG_DIGITS);
    for seed in 0..4 {
        let (other, _) = fixtures::shuffled(&fixtures::uneven(&body, 0.7, 0.2, 0.3, seed), seed);
        assert_eq!(rig_of(&other), rig);
    }
    let mut joints = body.joints().to_vec();
    let last = joints.len() - 1;
    joints[last].name.push('x');
    assert_ne!(rig_of(&Skeleton::new(joints.clone()).unwrap()), rig);
    joints[last] = Joint { parent: Some(0), ..body.joints()[last].clone() };
    assert_ne!(rig_of(&Skeleton::new(joints).unwrap()), rig);
    assert_ne!(rig_of(&fixtures::lafan()), rig);
    // The places where names begin and end count.
    let one = skeleton(&[("a", None), ("bc", Some(0))]);
    let other = skeleton(&[("ab", None), ("c", Some(0))]);
    assert_ne!(rig_of(&one), rig_of(&other));
}

#[test]
fn names_tell_joints_of_one_name_apart() {
    let body = skeleton(&[
        ("Root", None),
        ("Arm", Some(0)),
        ("Hand", Some(1)),
        ("Wing", Some(0)),
        ("Hand", Some(3)),
        ("A/B", Some(0)),
        ("Twin", Some(0)),
        ("Twin", Some(0)),
    ]);
    let names: Vec<String> = (0..body.len()).map(|joint| name_of(&body, joint)).collect();
    assert_eq!(names[..6], ["Root", "Arm", "Hand", "Wing", "Wing/Hand", "A/B"]);
    for (joint, name) in names[..7].iter().enumerate() {
        assert_eq!(joint_named(&body, name), Some(joint), "{name}");
    }
    assert_eq!(joint_named(&body, &names[7]), Some(6), "nothing tells the twins apart");
    for name in ["", "hand", "Leg/Hand", "/Hand", "Root/Hand"] {
        assert_eq!(joint_named(&body, name), None, "{name}");
    }
}

#[test]
fn map_of_one_clip_gives_another_of_the_rig_the_same_joints() {
    for (rig, body, _) in fixtures::all() {
        let mut roles = fixtures::roles(&body);
        roles.set(Role::LeftToe, None);
        roles.set(Role::Head, roles.get(Role::Spine));
        let map = BoneMap::of(&body, &roles);
        assert_eq!(BoneMap::from_json(map.to_json().as_bytes()), Ok(map.clone()), "{rig}");
        let (other, _) = fixtures::shuffled(&body, 5);
        let found = Roles::detect(&other);
        let mapped = map.roles_for(&other, &found).unwrap();
        let named = |body: &Skeleton, roles: &Roles, role| {
            roles.get(role).map(|joint| body.joints()[joint].name.clone())
        };
        for role in Role::ALL {
            assert_eq!(named(&other, &mapped, role), named(&body, &roles, role), "{rig} {role:?}");
            let source = match role {
                Role::LeftToe | Role::Spine => None,
                Role::Head => Some(RoleSource::ByHand),
                _ => Some(RoleSource::ByName),
            };
            assert_eq!(mapped.source(role), source, "{rig} {role:?}");
        }
        let stranger = skeleton(&[("Root", None)]);
        assert_eq!(map.roles_for(&stranger, &Roles::default()), None);
    }
}

#[test]
fn damaged_map_is_refused_with_its_place() {
    let refused = |text: &str| BoneMap::from_json(text.as_bytes()).unwrap_err();
    assert_eq!(
        refused("{\"segue_bone_map\": 1,\n \"roles\": {\"head\" \"Head\"}}"),
        BoneMapError::NotJson { line: 2, column: 19 }
    );
    assert_eq!(refused("{}"), BoneMapError::Version);
    assert_eq!(refused("[1]"), BoneMapError::Version);
    assert_eq!(refused("{\"segue_bone_map\": 2, \"roles\": {}}"), BoneMapError::Version);
    assert_eq!(refused("{\"segue_bone_map\": 1, \"rig\": 3}"), BoneMapError::Rig);
    assert_eq!(refused("{\"segue_bone_map\": 1}"), BoneMapError::Roles);
    let parts = |parts: &str| refused(&format!("{{\"segue_bone_map\":1,\"roles\":{{{parts}}}}}"));
    assert_eq!(parts("\"tail\": \"T\""), BoneMapError::UnknownRole { word: "tail".into() });
    for name in ["3", "\"\"", "[\"a\"]"] {
        let word = "head".into();
        assert_eq!(parts(&format!("\"head\": {name}")), BoneMapError::NotAName { word });
    }
    assert_eq!(
        parts("\"head\": \"H\", \"left_foot\": \"H\""),
        BoneMapError::SameBone { first: "head".into(), second: "left_foot".into() }
    );
    let long = " ".repeat(MAX_BONE_MAP_BYTES + 1);
    assert_eq!(refused(&long), BoneMapError::TooLarge);
    assert_eq!(refused(&"[".repeat(5000)).to_string().split(',').next(), Some("line 1"));
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Ok(map) = BoneMap::from_json(&bytes) {
            prop_assert_eq!(BoneMap::from_json(map.to_json().as_bytes()), Ok(map));
        }
        let _says = is_bone_map(&bytes);
    }

    #[test]
    fn any_names_survive_a_file(names in prop::collection::vec(any::<Option<String>>(), Role::COUNT)) {
        let mut seen = std::collections::BTreeSet::new();
        let kept = |name: Option<String>| name.filter(|name| !name.is_empty() && seen.insert(name.clone()));
        let roles = Role::ALL.into_iter().zip(names.into_iter().map(kept)).collect();
        let map = BoneMap { rig: "0123".into(), roles };
        prop_assert!(is_bone_map(map.to_json().as_bytes()));
        prop_assert_eq!(BoneMap::from_json(map.to_json().as_bytes()), Ok(map));
    }
}

proptest! {
    #[test]
    fn any_names_survive_a_link(
        names in prop::collection::btree_map(0..Role::COUNT, any::<Option<String>>(), 1..6)
    ) {
        let mut seen = std::collections::BTreeSet::new();
        let mut kept = |name: Option<String>| name.filter(|name| !name.is_empty() && seen.insert(name.clone()));
        let roles = names.into_iter().map(|(role, name)| (Role::ALL[role], kept(name))).collect();
        let map = BoneMap { rig: "0123456789abcdef".into(), roles };
        let mut query = "t=1".to_owned();
        crate::link::add_bone_maps(&mut query, std::slice::from_ref(&map));
        let link = crate::link::read(&query);
        if map.to_link().is_some() {
            prop_assert_eq!(link.bone_maps, [map]);
        } else {
            prop_assert_eq!(query, "t=1");
        }
    }
}

#[test]
fn damaged_map_in_a_link_is_refused_with_the_reason() {
    let rig = "0123456789abcdef";
    let problem = |part: &str| {
        let link = crate::link::read(&format!("bones={part}&blend_window=12"));
        assert_eq!((link.values.len(), link.bone_maps.len()), (1, 0), "{part}");
        link.problems[0].to_string()
    };
    for part in ["", "head-Head", "0123:head-Head", "0123456789abcdeg:head-H", rig] {
        assert!(problem(part).starts_with("bones: expected a rig and its corrected"), "{part}");
    }
    assert!(problem(&format!("{rig}:tail-T")).contains("no body part `tail`"));
    assert!(problem(&format!("{rig}:head-H;left_foot-H")).contains("have the same bone"));
    let long = "x".repeat(1000);
    assert!(problem(&format!("{rig}:head-{long}")).contains("at most 800 characters"));
    let many: Vec<String> = (0..6).map(|rig| format!("bones={rig:016x}:head-H")).collect();
    let link = crate::link::read(&many.join("&"));
    assert_eq!((link.bone_maps.len(), link.problems.len()), (4, 2));
}

fn motion(session: &Session, id: &str) -> Arc<Motion> {
    session.library().get(id).unwrap().motion.clone().unwrap()
}

fn head(session: &Session, id: &str) -> Option<usize> {
    motion(session, id).roles().get(Role::Head)
}

fn set_head(session: &mut Session, id: &str, joint: Option<usize>) {
    let changes = vec![(Role::Head, joint)];
    session.apply(Command::File(FileCommand::SetRoles(id.into(), changes))).unwrap();
}

#[test]
fn correction_holds_for_all_clips_of_the_rig_and_is_one_step() {
    let mut session = Session::new();
    let first = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    let second = session.load("y.bvh", made_bvh(2.0)).unwrap().ids.remove(0);
    let found = head(&session, &first);
    assert_eq!(head(&session, &second), found);
    set_head(&mut session, &first, Some(1));
    let third = session.load("z.bvh", made_bvh(3.0)).unwrap().ids.remove(0);
    for id in [&first, &second, &third] {
        assert_eq!(head(&session, id), Some(1), "{id}");
        assert_eq!(motion(&session, id).roles().source(Role::Head), Some(RoleSource::ByHand));
        assert_eq!(motion(&session, id).roles().source(Role::Hips), Some(RoleSource::ByName));
    }
    session.apply(Command::File(FileCommand::ResetRoles(second.clone()))).unwrap();
    for id in [&first, &second, &third] {
        assert_eq!(head(&session, id), found, "{id}");
        assert_eq!(session.library().get(id).unwrap().roles_by_hand, None);
    }
    session.apply(Command::Undo).unwrap();
    assert!([&first, &second, &third].iter().all(|id| head(&session, id) == Some(1)));
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Undo).unwrap();
    assert!([&first, &second].iter().all(|id| head(&session, id) == found));
    let fourth = session.load("w.bvh", made_bvh(4.0)).unwrap().ids.remove(0);
    assert_eq!(head(&session, &fourth), found, "the correction was taken back");
}

#[test]
fn correction_is_part_of_the_link_of_its_clip() {
    let bytes = made_bvh(1.0);
    let mut session = Session::new();
    let first = session.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    session.apply(Command::Assign(Slot::A, first.clone())).unwrap();
    let found = motion(&session, &first).roles().clone();
    assert!(!session.query().contains("bones="), "nothing is corrected");
    set_head(&mut session, &first, Some(1));
    let removed = vec![(Role::LeftToe, None)];
    session.apply(Command::File(FileCommand::SetRoles(first.clone(), removed))).unwrap();
    let corrected = motion(&session, &first).roles().clone();
    let link = session.query_for_others();
    assert!(link.contains("bones=") && link.contains("left_toe-"), "{link}");
    assert!(!link.contains("hips-"), "only what differs: {link}");
    // With clips of other rigs alone, it is of no use.
    let other = String::from_utf8(made_bvh(2.0).to_vec()).unwrap().replace("LeftUpLeg", "Thigh");
    let other = session.load("y.bvh", Arc::from(other.as_bytes())).unwrap().ids.remove(0);
    for slot in [Slot::A, Slot::B] {
        session.apply(Command::Assign(slot, other.clone())).unwrap();
    }
    assert!(!session.query().contains("bones="), "{}", session.query());

    // Somebody else opens the link before the file, and after it.
    let mut theirs = Session::new();
    theirs.apply(Command::OpenLink(link.clone())).unwrap();
    assert_eq!(theirs.query_for_others(), link, "it waits for its file");
    let id = theirs.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    assert_eq!(theirs.query_for_others(), link);
    assert_eq!(*motion(&theirs, &id).roles(), corrected);
    let mut theirs = Session::new();
    let id = theirs.load("x.bvh", bytes).unwrap().ids.remove(0);
    theirs.apply(Command::OpenLink(link.clone())).unwrap();
    assert_eq!(*motion(&theirs, &id).roles(), corrected);
    assert_eq!(theirs.query_for_others(), link);
    theirs.apply(Command::Undo).unwrap();
    assert_eq!(*motion(&theirs, &id).roles(), found, "opening a link is one step");
}

#[test]
fn correction_survives_a_reload_for_files_that_are_new_then() {
    let bytes = made_bvh(1.0);
    let mut session = Session::new();
    let first = session.load("x.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    set_head(&mut session, &first, Some(1));
    let stored = serde_json::to_string(&session.saved()).unwrap();
    let saved = serde_json::from_str(&stored).unwrap();
    let restored = |late: bool| {
        let mut session = Session::new();
        let content = |_: &str| Some(Content::Here(Arc::clone(&bytes)));
        if late {
            session.restore_late(&saved, content);
        } else {
            session.restore(&saved, content, None);
        }
        read_clip(&mut session, &first);
        session
    };
    for mut session in [restored(false), restored(true)] {
        assert_eq!(head(&session, &first), Some(1));
        session.apply(Command::Remove(first.clone())).unwrap();
        let new = session.load("y.bvh", made_bvh(5.0)).unwrap().ids.remove(0);
        assert_eq!(head(&session, &new), Some(1));
    }
    // A record of an earlier version has no maps, and its clips keep their own roles.
    let mut old: serde_json::Value = serde_json::from_str(&stored).unwrap();
    old.as_object_mut().unwrap().remove("bone_maps");
    let mut session = Session::new();
    let old = serde_json::from_value(old).unwrap();
    session.restore(&old, |_| Some(Content::Here(Arc::clone(&bytes))), None);
    read_clip(&mut session, &first);
    assert_eq!(head(&session, &first), Some(1));
}

#[test]
fn file_of_a_map_is_applied_to_the_clips_that_it_fits() {
    let mut session = Session::new();
    let first = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    let body = motion(&session, &first);
    let names = [1, 2].map(|joint| name_of(body.clip().skeleton(), joint));
    let text = format!(
        "{{\"segue_bone_map\": 1, \"roles\": {{\"head\": \"{}\", \"left_toe\": null}}}}",
        names[0]
    );
    let loaded = session.load("map.json", Arc::from(text.as_bytes())).unwrap();
    assert!(loaded.ids.is_empty() && loaded.warnings.is_empty());
    assert_eq!(head(&session, &first), Some(1));
    assert_eq!(motion(&session, &first).roles().get(Role::LeftToe), None);
    let said = session.notices().list().last().unwrap().text.to_string();
    assert!(said.starts_with("The bone map was applied to"), "{said}");
    session.apply(Command::Undo).unwrap();
    assert_ne!(head(&session, &first), Some(1));
    // One whose bones no clip has is refused in words, one with a rig waits for it.
    let strange = "{\"segue_bone_map\": 1, \"roles\": {\"head\": \"no such bone\"}}";
    session.load("map.json", Arc::from(strange.as_bytes())).unwrap();
    let said = session.notices().list().last().unwrap().text.to_string();
    assert!(said.contains("fits no clip here. Open a clip"), "{said}");
    let broken = session.load("map.json", Arc::from(&b"{\"segue_bone_map\": 1,"[..])).unwrap();
    assert!(broken.warnings[0].to_string().starts_with("map.json: line 1, column"));

    let mut corrected = body.roles().clone();
    corrected.set(Role::Head, Some(1));
    let map = BoneMap::of(body.clip().skeleton(), &corrected).to_json();
    let mut session = Session::new();
    session.apply(Command::Remove("walk".into())).ok();
    session.load("map.json", Arc::from(map.as_bytes())).unwrap();
    let later = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    assert_eq!(head(&session, &later), Some(1));
}

#[test]
fn both_sides_are_set_by_the_counterpart() {
    for (rig, body, _) in fixtures::all() {
        let rest = vec![glam::Quat::IDENTITY; body.len()];
        let clip = Clip::new("one", Arc::clone(&body), 30.0, rest, vec![Vec3::ZERO]).unwrap();
        let motion = Motion::analyze(clip);
        let roles = motion.roles().clone();
        let (foot, shin) = (roles.get(Role::LeftFoot), roles.get(Role::LeftShin));
        assert_eq!(
            role_changes(&motion, Role::LeftFoot, shin, true),
            [(Role::LeftFoot, shin), (Role::RightFoot, roles.get(Role::RightShin))],
            "{rig}"
        );
        assert_eq!(role_changes(&motion, Role::LeftFoot, foot, false), [(Role::LeftFoot, foot)]);
        assert_eq!(
            role_changes(&motion, Role::LeftToe, None, true),
            [(Role::LeftToe, None), (Role::RightToe, None)]
        );
        let spine = roles.get(Role::Spine);
        assert_eq!(role_changes(&motion, Role::Head, spine, true), [(Role::Head, spine)]);
    }
}
