//! Frames at the ends of a take that do not belong to the motion: a T-pose, and standing still.

use super::fault::{Fault, FaultKind, Form, SizeUnit};
use super::tracks::{Track, Tracks};
use crate::math::quat;
use glam::Quat;

/// Joints that are rotated by less than this are at rest, radians (1°).
const AT_REST: f32 = 0.017_453_3;
/// The number of frames after the first that are compared.
const COMPARED: usize = 30;
/// The body stands still below these mean speeds: radians and metres per second.
const STILL: [f32; 2] = [0.03, 0.02];
/// Still ends that are shorter than this stay, and this much of longer ones, seconds.
const MIN_STILL_SECS: f64 = 1.0;
const KEPT_SECS: f64 = 0.25;

/// Returns whether the first frame is a T-pose that does not belong to the motion. `rotation` is
/// the local rotation of a joint in a frame, the identity at rest.
///
/// Two conditions must hold for the joints that move at all: most are at rest in the first frame
/// and not in the second, and the step from the first frame to the second is many times larger than
/// the following ones. A motion that starts in the rest pose and leaves it smoothly fails the
/// second condition, a cut within a take fails the first.
pub fn first_frame_is_t_pose(
    frames: usize,
    joints: usize,
    rotation: impl Fn(usize, usize) -> Quat,
) -> bool {
    let frames = frames.min(COMPARED);
    if frames < 3 {
        return false;
    }
    let moves = |joint: &usize| {
        (1..frames).any(|frame| {
            quat::angle_between(rotation(0, *joint), rotation(frame, *joint)) > AT_REST
        })
    };
    let moving: Vec<usize> = (0..joints).filter(moves).collect();
    let resting = |frame: usize| {
        let angle = |joint: &&usize| quat::angle_between(Quat::IDENTITY, rotation(frame, **joint));
        moving.iter().filter(|joint| angle(joint) < AT_REST).count()
    };
    let mostly_at_rest = resting(0) * 10 >= moving.len() * 6 && resting(1) * 10 <= moving.len() * 5;
    if moving.is_empty() || !mostly_at_rest {
        return false;
    }
    let step = |frame: usize| {
        let angle = |&joint: &usize| {
            quat::angle_between(rotation(frame, joint), rotation(frame + 1, joint))
        };
        moving.iter().map(angle).sum::<f32>() / moving.len() as f32
    };
    let mut later: Vec<f32> = (1..frames - 1).map(step).collect();
    later.sort_by(f32::total_cmp);
    let usual = later.get(later.len() / 2).copied().unwrap_or_default();
    step(0) > (5.0 * usual).max(3.0 * AT_REST)
}

/// Returns the ends that do not belong to the motion.
pub(super) fn ends(tracks: &Tracks) -> Vec<Fault> {
    let frames = tracks.frames;
    let rotation = |start: usize| {
        move |frame: usize, joint: usize| match tracks.all.get(joint) {
            Some(Track::Turn(values)) => {
                values.get(start + frame).copied().unwrap_or(Quat::IDENTITY)
            }
            _ => Quat::IDENTITY,
        }
    };
    let fault = |range: std::ops::Range<usize>, confidence: f32| {
        let size = (range.len() as f32, SizeUnit::Frames);
        Fault::of_body(FaultKind::Ends, range, Form::Outside, size, confidence)
    };
    let mut found = Vec::new();
    let speeds: Vec<bool> = (0..frames.saturating_sub(1)).map(|at| is_still(tracks, at)).collect();
    let first = speeds.iter().position(|still| !still).unwrap_or(speeds.len());
    let last = speeds.iter().rposition(|still| !still).map_or(frames, |at| at + 1);
    if first >= speeds.len() {
        // Nothing moves at all: there is no motion to cut free.
        return found;
    }
    // A T-pose may be held for some frames before it gives way to the motion.
    if first_frame_is_t_pose(frames - first, tracks.joints, rotation(first)) {
        found.push(fault(0..first + 1, 0.95));
    } else {
        let kept = tracks.frames_of(KEPT_SECS, 1);
        let least = tracks.frames_of(MIN_STILL_SECS, 8);
        if first >= least + kept {
            found.push(fault(0..first - kept, 0.45));
        }
    }
    let (kept, least) = (tracks.frames_of(KEPT_SECS, 1), tracks.frames_of(MIN_STILL_SECS, 8));
    if frames - last >= least + kept {
        found.push(fault(last + kept..frames, 0.45));
    }
    found
}

/// Returns whether the body stands still from a frame to the next.
fn is_still(tracks: &Tracks, at: usize) -> bool {
    let fps = tracks.fps as f32;
    let turned: f32 =
        tracks.all[..tracks.joints].iter().map(|track| track.way(at, at + 1).length()).sum();
    let moved = tracks.all.get(tracks.joints).map_or(0.0, |track| track.way(at, at + 1).length());
    turned / tracks.joints.max(1) as f32 * fps < STILL[0] && moved * fps < STILL[1]
}
