//! Tests of the steps of undo.

use crate::fixtures::*;
use crate::params::{Mark, PARAMS};
use proptest::prelude::*;
use proptest::sample::Index;

/// Returns what undo restores: parameters, and the ids and names of the clips.
fn restored(session: &Session) -> Vec<String> {
    let params = PARAMS.iter().filter(|param| !param.has(Mark::NoUndo));
    let values =
        params.map(|param| format!("{}={:?}", param.name, session.params().get(param.key)));
    let clips = session.library().entries().iter();
    values.chain(clips.map(|clip| format!("{}: {}", clip.id, clip.name))).collect()
}

/// A command. An [`Index`] chooses one of the clips that the library then has, or a parameter.
#[derive(Clone, Debug)]
enum Change {
    Set(Vec<(Key, Value)>),
    Reset(Index),
    Assign(Slot, Index),
    Remove(Index),
    Rename(Index, String),
    Keep,
    Load(u8),
    Settle,
    Undo,
    Redo,
}

impl Change {
    fn any() -> impl Strategy<Value = Self> {
        let row = any::<Index>().prop_map(|index| index.index(PARAMS.len()));
        let outside = [Key::Src, Key::Lesson, Key::Corpus];
        let value = row
            .prop_flat_map(any_value)
            .prop_filter("outside", move |(key, _)| !outside.contains(key));
        let slot = prop_oneof![Just(Slot::A), Just(Slot::B)];
        prop_oneof![
            6 => prop::collection::vec(value, 1..4).prop_map(Self::Set),
            1 => any::<Index>().prop_map(Self::Reset),
            2 => (slot, any::<Index>()).prop_map(|(slot, clip)| Self::Assign(slot, clip)),
            1 => any::<Index>().prop_map(Self::Remove),
            1 => (any::<Index>(), "[a-z]{1,4}").prop_map(|(clip, name)| Self::Rename(clip, name)),
            1 => Just(Self::Keep),
            1 => (0..3_u8).prop_map(Self::Load),
            1 => Just(Self::Settle),
            2 => Just(Self::Undo),
            1 => Just(Self::Redo),
        ]
    }

    /// Returns whether the session has carried it out.
    fn apply(self, session: &mut Session) -> bool {
        let clips = session.library().entries();
        let id = |clip: Index| clips[clip.index(clips.len())].id.clone();
        let command = match self {
            Self::Set(values) => Command::Set(values),
            Self::Reset(index) => Command::Reset(PARAMS[index.index(PARAMS.len())].key),
            Self::Assign(slot, clip) => Command::Assign(slot, id(clip)),
            Self::Remove(clip) => Command::Remove(id(clip)),
            Self::Rename(clip, name) => Command::Rename(id(clip), name),
            Self::Keep => Command::Keep(0),
            Self::Load(seed) => {
                return session.load(&format!("{seed}.bvh"), made_bvh(f64::from(seed))).is_ok();
            }
            Self::Settle => Command::Settle,
            Self::Undo => Command::Undo,
            Self::Redo => Command::Redo,
        };
        session.apply(command).is_ok()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn all_steps_are_taken_back_and_made_again(changes in prop::collection::vec(Change::any(), 1..16)) {
        let mut session = Session::new();
        let first = restored(&session);
        for change in changes {
            let before = restored(&session);
            if !change.clone().apply(&mut session) {
                prop_assert_eq!(&restored(&session), &before, "{:?} was refused", change);
            }
        }
        let last = restored(&session);
        while session.can_undo() {
            session.apply(Command::Undo).unwrap();
        }
        prop_assert_eq!(&restored(&session), &first);
        while session.can_redo() {
            session.apply(Command::Redo).unwrap();
        }
        // Steps that were taken back before are made again, too: only then the last state differs.
        while session.can_undo() && restored(&session) != last {
            session.apply(Command::Undo).unwrap();
        }
        prop_assert_eq!(&restored(&session), &last);
    }
}

#[test]
fn drag_of_a_slider_is_one_step() {
    let mut session = Session::new();
    for frames in [31.0, 32.0, 40.0] {
        blend_window(&mut session, frames);
    }
    session.apply(Command::Settle).unwrap();
    blend_window(&mut session, 50.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 40.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
    assert!(!session.can_undo());
    session.apply(Command::Redo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 40.0);
}

#[test]
fn joined_changes_are_one_step() {
    let mut session = Session::new();
    session.join_steps(true);
    blend_window(&mut session, 20.0);
    let id = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    session.apply(Command::Settle).unwrap();
    blend_window(&mut session, 25.0);
    session.join_steps(false);
    blend_window(&mut session, 40.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 25.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
    assert!(session.library().get(&id).is_none() && !session.can_undo());
    // After an undo among the joined changes, the next change begins a step of its own.
    session.join_steps(true);
    blend_window(&mut session, 20.0);
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Settle).unwrap();
    blend_window(&mut session, 25.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
    // Nothing changed: no step.
    session.join_steps(true);
    session.join_steps(false);
    assert!(!session.can_undo());
}

#[test]
fn undo_keeps_playhead_and_camera() {
    let mut session = Session::new();
    blend_window(&mut session, 20.0);
    session.apply(Command::Playback(PlaybackCommand::Seek(1.0))).unwrap();
    session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(5.0))])).unwrap();
    session.apply(Command::Undo).unwrap();
    assert_eq!((session.now_secs(), session.params().number(Key::CameraYaw)), (1.0, 5.0));
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
}

#[test]
fn undo_restores_marks_speed_and_camera_target() {
    let mut session = Session::new();
    let values = [
        (Key::In, Value::Number(1.0)),
        (Key::Rate, Value::Number(0.5)),
        (Key::Follow, Value::Choice("off")),
    ];
    for (key, value) in values.clone() {
        session.apply(Command::Set(vec![(key, value)])).unwrap();
        session.apply(Command::Settle).unwrap();
    }
    for (key, value) in values.into_iter().rev() {
        assert_eq!(session.params().get(key), &value);
        session.apply(Command::Undo).unwrap();
        assert_eq!(session.params().get(key), &key.param().default_value());
    }
}

#[test]
fn discarded_clip_leaves_without_a_step_and_a_notice() {
    let mut session = Session::new();
    let id = session.load("x.bvh", made_bvh(1.0)).unwrap().ids.remove(0);
    session.apply(Command::Assign(Slot::A, id.clone())).unwrap();
    session.apply(Command::Assign(Slot::A, "walk".into())).unwrap();
    let notices = session.notices().list().len();
    session.apply(Command::Discard(id.clone())).unwrap();
    assert!(session.library().get(&id).is_none() && session.notices().list().len() == notices);
    assert_eq!(session.params().text(Key::A), "walk");
    // The state before has it, and the one after does not.
    session.apply(Command::Undo).unwrap();
    assert!(session.library().get(&id).is_some() && session.params().text(Key::A) == id);
    session.apply(Command::Redo).unwrap();
    assert!(session.library().get(&id).is_none() && session.params().text(Key::A) == "walk");
    session.apply(Command::Discard(id)).unwrap_err();
}
