//! Tests of the steps of undo.

use crate::fixtures::*;

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
