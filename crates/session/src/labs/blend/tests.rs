//! Tests of frames set by hand, and of the match.

use crate::Transition;
use crate::fixtures::opened;
use crate::session::Session;
use segue_motion::clip::Clip;
use segue_motion::registration::{align, limb_weights, rms_cm};

/// Returns the frames at which A is left and B is entered, and the transition.
fn place(session: &Session) -> ([usize; 2], Transition) {
    let outcome = session.main_outcome().unwrap();
    let transition = outcome.transition.unwrap();
    let fps = outcome.motion.clip().fps();
    let frame = |secs: f64| (secs * fps).round() as usize;
    ([frame(transition.leave_a_secs), frame(transition.enter_b_secs)], transition)
}

/// Returns the distance of two windows by the closed form of the alignment, centimetres.
fn distance_cm(
    a: &Clip,
    b: &Clip,
    [leave, enter]: [usize; 2],
    window: usize,
    body_height: f64,
) -> f64 {
    let points = |clip: &Clip, frame: usize| clip.world_positions(frame..frame + window);
    let found =
        align(&points(a, leave), &points(b, enter), &limb_weights(a.skeleton()), 0.0).unwrap();
    rms_cm(found.distance, found.weight, body_height)
}

#[test]
fn frame_set_near_an_end_is_matched_and_measured() {
    for (link, frame_a, frame_b) in [
        ("mix_frame_a=110", Some(110), None),
        ("mix_frame_a=118", Some(118), None),
        ("mix_frame_b=70", None, Some(70)),
        ("mix_frame_a=115&mix_frame_b=72", Some(115), Some(72)),
        ("mix_frame_a=60", Some(60), None),
    ] {
        let session = opened(&format!("lab=transition&match_by=window&{link}"));
        let (found, transition) = place(&session);
        let sources = &session.main_outcome().unwrap().sources;
        let [a, b] = [0, 1].map(|source: usize| &sources[source].motion);
        let (frames_a, frames_b) = (a.clip().frames(), b.clip().frames());
        assert!(frames_a > 119 && frames_b > 73, "{frames_a} {frames_b}");
        let search = transition.search.unwrap();
        let left = [frame_a.map(|frame| frames_a - frame), frame_b.map(|frame| frames_b - frame)];
        let window = left.into_iter().flatten().fold(30, usize::min);
        assert_eq!((search.window_frames, search.is_shortened), (window, window < 30), "{link}");
        assert!(!search.is_widened && !search.by_pose, "{link}");
        assert_eq!(frame_a.unwrap_or(found[0]), found[0], "{link}");
        assert_eq!(frame_b.unwrap_or(found[1]), found[1], "{link}");
        let height = f64::from(a.roles().body_height(a.clip().skeleton()));
        let apart = |pair| distance_cm(a.clip(), b.clip(), pair, window, height);
        assert!(
            (f64::from(transition.distance_cm) - apart(found)).abs() < 0.01,
            "{link}: {transition:?}"
        );
        // The other frame is the best for this one. The search refines near the coarse grid's
        // minima.
        if let (Some(frame), None) = (frame_a, frame_b) {
            let best =
                (0..frames_b / 2).map(|enter| apart([frame, enter])).fold(f64::INFINITY, f64::min);
            assert!(apart(found) <= best + 0.2, "{link}: {} against {best}", apart(found));
        }
    }
}

#[test]
fn pose_set_near_an_end_is_matched_and_measured() {
    let pair = place(&opened("lab=transition&mix_frame_a=118"));
    assert_eq!(pair.0[0], 118);
    assert!(pair.1.search.unwrap().by_pose);
    // The distance shown is that of the pair: the same when both frames are set.
    let both = place(&opened(&format!("lab=transition&mix_frame_a=118&mix_frame_b={}", pair.0[1])));
    assert_eq!(both.0, pair.0);
    assert_eq!(both.1.distance_cm, pair.1.distance_cm);
    let other = place(&opened("lab=transition&mix_frame_a=60"));
    assert_ne!(other.1.distance_cm, pair.1.distance_cm);
}

#[test]
fn panes_with_different_windows_share_the_leave_frame() {
    let session = opened("lab=blend&compare=blend_window:60,10&leave_a=2.5");
    let shown = |pane: usize| session.panes()[pane].outcome.as_ref().unwrap().transition.unwrap();
    let (wide, narrow) = (shown(0), shown(1));
    assert_eq!(wide.leave_a_secs, narrow.leave_a_secs);
    assert_eq!(wide.enter_b_secs, narrow.enter_b_secs);
    assert_eq!(wide.distance_cm, narrow.distance_cm);
    let search = narrow.search.unwrap();
    assert_eq!(search.latest_secs[0], narrow.leave_a_secs, "{search:?}");
}
