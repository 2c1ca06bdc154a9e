//! Tests of a body on four legs in the labs, from its file to the numbers.

use crate::fixtures::*;
use glam::Vec3;
use segue_formats::bvh;
use segue_motion::clip::fixtures::QuadrupedWalk;
use segue_motion::clip::{ContactCorrections, Motion};
use segue_motion::skeleton::Foot;

/// Returns a session with files of these walks, and the ids of their clips.
fn with_walks(walks: &[QuadrupedWalk]) -> (Session, Vec<String>) {
    let mut session = Session::new();
    let mut ids: Vec<String> = Vec::new();
    for (index, walk) in walks.iter().enumerate() {
        let text = bvh::write(&walk.clip(), &bvh::WriteOptions::default());
        session.load(&format!("dog{index}.bvh"), text.into_bytes().into()).unwrap();
        settle(&mut session);
        let of_files = session.library().entries().iter();
        let new = of_files.filter(|entry| matches!(entry.origin, Origin::File(_)));
        let new = new.map(|entry| entry.id.clone()).find(|id| !ids.contains(id));
        ids.push(new.unwrap());
    }
    (session, ids)
}

/// Returns two walks of one rig, the second one faster.
fn two_walks(axis: Option<Vec3>) -> [QuadrupedWalk; 2] {
    [0.42, 0.6].map(|speed_mps| QuadrupedWalk { speed_mps, axis, ..QuadrupedWalk::default() })
}

fn open(link: &str, session: &mut Session) {
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(session);
}

#[test]
fn every_lab_with_a_body_on_four_legs_has_a_result_with_four_feet() {
    for axis in [None, Some(Vec3::X)] {
        let (mut session, ids) = with_walks(&two_walks(axis));
        let (a, b) = (&ids[0], &ids[1]);
        for link in [
            format!("lab=view&a={a}"),
            format!("lab=blend&a={a}&b={b}"),
            format!("lab=transition&a={a}&b={b}"),
            format!("lab=speed&a={a}&b={b}"),
            format!("lab=loop&a={a}"),
            format!("lab=layers&a={a}&b={b}&mask=whole"),
            format!("lab=register&a={a}&b={b}"),
            format!("lab=register&a={a}&b={b}&warp_mode=join"),
            format!("lab=path&a={a}"),
            format!("lab=graph&clips={a},{b}&walk_seconds=6"),
            format!("lab=match&match_clips={a},{b}&scenario=spin"),
            format!("lab=in_place&a={a}"),
            format!("lab=edit&a={a}&mirror=on"),
            format!("lab=clean&a={a}"),
        ] {
            open(&format!("{link}&foot_lock=on&play=off"), &mut session);
            let problems: Vec<String> = (session.panes().iter())
                .filter_map(|pane| pane.problem.as_ref().map(|problem| format!("{problem:?}")))
                .collect();
            assert_eq!(problems, Vec::<String>::new(), "{axis:?}: {link}");
            let outcome = session.main_outcome().unwrap();
            let motion = &outcome.motion;
            assert!(motion.roles().is_quadruped(), "{axis:?}: {link}");
            assert_eq!(motion.contacts().feet(), Foot::ALL, "{axis:?}: {link}");
            for foot in Foot::ALL {
                let stances = motion.contacts().intervals(foot).len();
                assert!(stances >= 2, "{axis:?}: {link}, {foot:?}: {stances} stances");
            }
            let slid = number_of(outcome, MetricId::FootSlide);
            assert!(slid < 3.0, "{axis:?}: {link}: {slid} cm");
        }
    }
}

#[test]
fn foot_lock_of_a_file_holds_its_forefeet() {
    let sliding = QuadrupedWalk { fore_slide_mps: 0.12, ..QuadrupedWalk::default() };
    let (mut session, ids) = with_walks(&[sliding]);
    open(&format!("lab=view&a={}&foot_lock=on", ids[0]), &mut session);
    let outcome = session.main_outcome().unwrap();
    let before = number_of(outcome, MetricId::FootSlideBefore);
    let after = number_of(outcome, MetricId::FootSlide);
    assert!(before > 3.0 && after < 0.3, "{before} to {after} cm");
}

#[test]
fn contacts_of_forefeet_are_corrected_in_the_link() {
    let (mut session, ids) = with_walks(&[QuadrupedWalk::default()]);
    open(&format!("lab=view&a={}", ids[0]), &mut session);
    let clip = session.contact_clips().remove(0);
    let fore = Foot::ALL[3];
    let wanted = clip.motion.contacts().with(fore, 0..60, true);
    let corrections = ContactCorrections::between(clip.motion.found_contacts(), &wanted);
    let edits = session.params().contact_edits_with(&clip.id, corrections);
    session.apply(Command::Set(vec![(Key::ContactEdits, edits)])).unwrap();
    settle(&mut session);
    assert!(session.query().contains("RF"), "{}", session.query());
    let shown = |session: &Session| session.main_outcome().unwrap().motion.contacts().clone();
    assert_eq!(shown(&session), wanted);
    let query = session.query();
    session.apply(Command::Reset(Key::ContactEdits)).unwrap();
    settle(&mut session);
    assert_ne!(shown(&session), wanted);
    open(&query, &mut session);
    assert_eq!(shown(&session), wanted);
}

/// A body on four legs keeps its plan with roles that were set by hand, and in storage.
#[test]
fn roles_by_hand_keep_the_plan() {
    for axis in [None, Some(Vec3::X)] {
        let (mut session, ids) = with_walks(&[QuadrupedWalk { axis, ..QuadrupedWalk::default() }]);
        let id = &ids[0];
        let motion = |session: &Session| -> Arc<Motion> {
            session.library().get(id).unwrap().motion.clone().unwrap()
        };
        let hand = motion(&session).clip().skeleton().find("LeftHand").unwrap();
        for joint in [None, Some(hand)] {
            let changes = vec![(segue_motion::skeleton::Role::LeftHand, joint)];
            session.apply(Command::File(FileCommand::SetRoles(id.clone(), changes))).unwrap();
            settle(&mut session);
            serve(&mut session);
            let roles = motion(&session).roles().clone();
            assert!(roles.is_quadruped(), "{axis:?}, {joint:?}");
            let text = serde_json::to_string(&roles).unwrap();
            assert_eq!(
                serde_json::from_str::<segue_motion::skeleton::Roles>(&text).unwrap(),
                roles
            );
        }
    }
}
