//! Tests of contacts that are corrected by hand.

use super::*;
use crate::fixtures::*;
use crate::labs::CycleMade;
use segue_motion::clip::{ContactCorrection, StanceEnd};
use segue_motion::skeleton::Side;

/// Corrects the contacts of the clip in A, as the timeline does.
fn correct(session: &mut Session, change: impl Fn(&Motion) -> segue_motion::clip::Contacts) {
    let lab = session.params().lab();
    session.apply(Command::Set(vec![(Key::Lab, crate::LabId::View.into())])).unwrap();
    settle(session);
    let clip = session.contact_clips().remove(0);
    let wanted = change(&clip.motion);
    let corrections = ContactCorrections::between(clip.motion.found_contacts(), &wanted);
    let edits = session.params().contact_edits_with(&clip.id, corrections);
    session.apply(Command::Set(vec![(Key::ContactEdits, edits)])).unwrap();
    session.apply(Command::Settle).unwrap();
    session.apply(Command::Set(vec![(Key::Lab, lab.into())])).unwrap();
    settle(session);
}

/// Returns the contacts with all strikes later by so many frames.
fn late(motion: &Motion, frames: usize) -> segue_motion::clip::Contacts {
    let mut late = motion.contacts().clone();
    for side in Side::BOTH {
        for (index, stance) in motion.contacts().intervals(side).into_iter().enumerate() {
            late = late.with_end_at(side, index, StanceEnd::Strike, stance.start + frames);
        }
    }
    late
}

fn cut_secs(session: &Session) -> [f64; 2] {
    match session.main_outcome().unwrap().cycle.unwrap().made {
        CycleMade::Cut { from_secs, to_secs, .. } => [from_secs, to_secs],
        CycleMade::Gait { .. } => panic!("a cut"),
    }
}

fn edits(session: &Session) -> String {
    Key::ContactEdits.param().format(session.params().get(Key::ContactEdits))
}

fn contacts(session: &Session) -> segue_motion::clip::Contacts {
    session.main_outcome().unwrap().motion.contacts().clone()
}

#[test]
fn corrected_contacts_are_those_of_the_view_until_they_are_taken_back() {
    let mut session = opened("lab=view&a=walk&play=off");
    let found = contacts(&session);
    correct(&mut session, |motion| motion.contacts().with(Side::Left, 0..30, false));
    assert!(contacts(&session).intervals(Side::Left)[0].start >= 30, "{}", edits(&session));
    assert_eq!(contacts(&session).intervals(Side::Right), found.intervals(Side::Right));
    let shown = session.contact_clips().remove(0);
    assert_eq!((shown.id.as_str(), shown.motion.found_contacts()), ("walk", &found));
    // The correction stays under other thresholds.
    session.apply(Command::Set(vec![(Key::ContactHeight, Value::Number(8.0))])).unwrap();
    settle(&mut session);
    assert!(contacts(&session).intervals(Side::Left)[0].start >= 30);
    session.apply(Command::Undo).unwrap();
    // The lab was set together with nothing else, as a step of its own.
    while !edits(&session).is_empty() {
        session.apply(Command::Undo).unwrap();
    }
    settle(&mut session);
    assert_eq!(contacts(&session), found);
    session.apply(Command::Redo).unwrap();
    settle(&mut session);
    assert_ne!(contacts(&session), found);
    session.apply(Command::Reset(Key::ContactEdits)).unwrap();
    settle(&mut session);
    assert_eq!(contacts(&session), found);
    // Another clip is as it was.
    correct(&mut session, |motion| late(motion, 4));
    let mut other = opened("lab=view&a=run&play=off");
    session.apply(Command::Assign(Slot::A, "run".into())).unwrap();
    settle(&mut other);
    settle(&mut session);
    assert_eq!(contacts(&session), contacts(&other));
}

#[test]
fn corrected_contacts_change_the_results_of_other_labs() {
    for lab in ["loop", "speed", "path&foot_lock=on", "register", "blend", "view&foot_lock=on"] {
        let link = format!("lab={lab}&a=walk&b=run&play=off");
        let mut session = opened_without_problems(&link);
        let before = Arc::clone(session.main_outcome().unwrap());
        correct(&mut session, |motion| late(motion, 6));
        let after = session.main_outcome().unwrap();
        assert_eq!(session.panes()[0].problem, None, "{lab}");
        assert_ne!(before.motion.contacts(), after.motion.contacts(), "{lab}");
        session.apply(Command::Reset(Key::ContactEdits)).unwrap();
        settle(&mut session);
        let back = session.main_outcome().unwrap();
        assert_eq!(before.motion, back.motion, "{lab}");
    }
}

#[test]
fn corrected_strike_changes_the_cycle_of_a_loop() {
    let mut session = opened_without_problems("lab=loop&a=walk&play=off");
    let [from, to] = cut_secs(&session);
    // Only one foot stands at the ends that were found: other ends fit better.
    correct(&mut session, |motion| {
        let frames = [from, to].map(|secs| (secs * motion.clip().fps()).round() as usize);
        let end = frames[1];
        motion.contacts().with(Side::Left, end.saturating_sub(12)..end + 12, false).with(
            Side::Right,
            end.saturating_sub(12)..end + 12,
            true,
        )
    });
    assert_ne!(cut_secs(&session), [from, to]);
    session.apply(Command::Reset(Key::ContactEdits)).unwrap();
    settle(&mut session);
    assert_eq!(cut_secs(&session), [from, to]);
}

#[test]
fn clip_at_another_rate_or_on_another_skeleton_takes_its_corrections_along() {
    // B is resampled to A's rate.
    let mut session =
        opened_without_problems("lab=register&a=walk&b=walk(body_height:1.5)&play=off");
    let stances = |session: &Session| {
        let registered = session.main_outcome().unwrap().registered().unwrap().clone();
        registered.stances(Some(Slot::B), Side::Left)
    };
    let before = stances(&session);
    let correction = ContactCorrection { foot: Side::Left.into(), frames: 0..240, planted: false };
    let edits = session
        .params()
        .contact_edits_with("walk(body_height:1.5)", [correction].into_iter().collect());
    session.apply(Command::Set(vec![(Key::ContactEdits, edits)])).unwrap();
    settle(&mut session);
    assert!(!before.is_empty() && stances(&session).is_empty(), "{:?}", stances(&session));
}

#[test]
fn result_of_a_corrected_clip_is_made_again_alike() {
    for link in [
        "lab=loop&a=walk",
        "lab=view&a=walk",
        "lab=view&a=walk&foot_lock=on",
        "lab=speed&a=walk&b=run",
    ] {
        let mut session = opened_without_problems(&format!("{link}&play=off"));
        // Those of a clip that is not used are not part of the recipe.
        let unused = ContactCorrection { foot: Side::Left.into(), frames: 0..9, planted: true };
        let unused = session.params().contact_edits_with("idle", [unused].into_iter().collect());
        session.apply(Command::Set(vec![(Key::ContactEdits, unused)])).unwrap();
        correct(&mut session, |motion| late(motion, 5));
        session.apply(Command::Keep(0)).unwrap();
        let kept = Arc::clone(session.library().entries().last().unwrap());
        assert!(kept.id.contains("contact_edits") && !kept.id.contains("idle"), "{}", kept.id);
        assert!(session.apply(Command::Keep(0)).is_err(), "{link}: it is kept already");
        // The kept one stays as it is when the correction is taken back.
        session.apply(Command::Reset(Key::ContactEdits)).unwrap();
        let mut restored = Session::new();
        restored.restore(&session.saved(), |_| None, None);
        let view =
            format!("lab=view&play=off&a={}", kept.id.replace('%', "%25").replace(';', "%3B"));
        restored.apply(Command::OpenLink(view)).unwrap();
        settle(&mut restored);
        let again = &restored.main_outcome().unwrap().motion;
        assert_eq!(&kept.motion, &Some(Arc::clone(again)), "{link}");
    }
}

#[test]
fn corrections_of_files_stay_when_a_link_opens_and_are_stored() {
    let mut session = opened("lab=view&play=off");
    let id = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    settle(&mut session);
    correct(&mut session, |motion| late(motion, 3));
    let of_file = edits(&session);
    assert!(of_file.starts_with(&id), "{of_file}");
    session.apply(Command::Assign(Slot::A, "walk".into())).unwrap();
    settle(&mut session);
    correct(&mut session, |motion| late(motion, 3));
    // The link is about the clips that it names.
    assert!(session.query().contains("contact_edits=walk:") && !session.query().contains("x~"));
    let saved = session.saved();
    session.apply(Command::OpenLink("lab=view".into())).unwrap();
    assert_eq!(edits(&session), of_file, "the built-in clip is as it was");
    session.apply(Command::OpenLink(format!("lab=view&a={id}&contact_edits={id}:L1-2"))).unwrap();
    assert_eq!(edits(&session), format!("{id}:L1-2"));

    for query in [None, Some("lab=blend")] {
        let mut restored = Session::new();
        restored.restore(&saved, |_| Some(crate::reading::Content::Here(made_bvh(1.0))), query);
        settle(&mut restored);
        assert!(edits(&restored).contains(&of_file), "{query:?}: {}", edits(&restored));
        assert_eq!(edits(&restored).contains("walk:"), query.is_none());
    }
    let mut late_one = Session::new();
    late_one.restore_late(&saved, |_| Some(crate::reading::Content::Here(made_bvh(1.0))));
    assert_eq!(edits(&late_one), of_file);

    session.apply(Command::Remove(id.clone())).unwrap();
    assert_eq!(edits(&session), "");
    session.apply(Command::Undo).unwrap();
    assert_eq!(edits(&session), format!("{id}:L1-2"));
}

#[test]
fn corrections_of_a_renamed_file_are_found_by_its_content() {
    let mut session = opened("lab=view&play=off");
    let id = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    let (_, sha, _) = split_reference(&id);
    let link = format!("lab=view&play=off&a=y~{sha}&contact_edits=z~{sha}:-L0-20");
    session.apply(Command::OpenLink(link)).unwrap();
    settle(&mut session);
    let clip = session.contact_clips().remove(0);
    assert_eq!(clip.id, id);
    assert!((0..=20).all(|frame| !contacts(&session).planted(Side::Left, frame)));
    assert!(session.query().contains("contact_edits"), "{}", session.query());
    let none = session.params().contact_edits_with(&id, ContactCorrections::default());
    session.apply(Command::Set(vec![(Key::ContactEdits, none)])).unwrap();
    assert_eq!(edits(&session), "");
}
