//! Gaps: joints that hold still while they ought to move.

use super::fault::{Fault, FaultKind, Form, TrackFault, confidence};
use super::steps::Steps;
use super::tracks::{Track, Tracks};
use crate::math::sort::sort_by_key;
use std::ops::Range;

/// Steps below this are no movement: what rounding leaves of equal values, radians or metres.
const STILL: f32 = 2e-6;
/// The least duration of a gap, seconds, and frames.
const MIN_SECS: f64 = 0.04;
const MIN_FRAMES: usize = 2;
/// The least way that is missed in a gap, radians and metres.
const MIN_WAY: [f32; 2] = [0.026, 0.015];
/// The share of this way that is made up for in the first step after the gap.
const MIN_CATCH_UP: f32 = 0.35;

/// A track that holds still.
#[derive(Clone, Debug)]
pub(super) struct Hold {
    track: usize,
    /// The frames that repeat the one before.
    frames: Range<usize>,
    /// The way that is missed, radians or metres; 0 where nothing moved before and after either.
    missed: f32,
    /// The ratio of the first step after the hold to the usual departure there.
    jump: f32,
}

/// Returns where a track holds still between frames in which it moves or not.
pub(super) fn holds(track: &Track, index: usize, tracks: &Tracks) -> Vec<Hold> {
    let steps = Steps::of(track, tracks);
    let least = tracks.frames_of(MIN_SECS, MIN_FRAMES);
    let mut found = Vec::new();
    let mut at = 0;
    while at < steps.ways.len() {
        if steps.ways[at].length() > STILL {
            at += 1;
            continue;
        }
        let end = (at..steps.ways.len()).find(|&next| steps.ways[next].length() > STILL);
        let Some(end) = end else {
            break;
        };
        // The steps at..end are still: the frames at + 1..end + 1 repeat frame `at`.
        if at > 0 && end - at >= least {
            let moved = steps.before(at).length().max(steps.after(end + 1).length());
            let way = moved * (end - at + 1) as f32;
            let step = steps.ways[end].length();
            let usual = steps.after(end + 1).length().max(1e-4);
            let missed = if step > MIN_CATCH_UP * way && step > 1.8 * usual { step } else { 0.0 };
            found.push(Hold { track: index, frames: at + 1..end + 1, missed, jump: step / usual });
        }
        at = end;
    }
    found
}

/// Returns the gaps: holds of the same frames in which some joints miss their way.
pub(super) fn gaps(mut holds: Vec<Hold>, tracks: &Tracks) -> Vec<Fault> {
    sort_by_key(&mut holds, |hold| (hold.frames.start, hold.frames.end));
    let mut faults = Vec::new();
    for held in holds.chunk_by(|a, b| a.frames == b.frames) {
        let score =
            |hold: &Hold| hold.missed / MIN_WAY[usize::from(!tracks.all[hold.track].is_turn())];
        let strongest = held.iter().map(score).fold(0.0, f32::max);
        let jump = held.iter().filter(|hold| hold.missed > 0.0).map(|hold| hold.jump);
        let jump = jump.fold(0.0, f32::max);
        if strongest < 1.0 || jump < 2.0 {
            continue;
        }
        let parts = held.iter().map(|hold| TrackFault {
            track: hold.track,
            frames: hold.frames.clone(),
            form: Form::Run,
            size: tracks.size(hold.track, hold.missed),
            confidence: confidence(strongest.min(jump), 1.5),
        });
        faults.push(Fault::of_tracks(FaultKind::Gap, parts.collect(), tracks));
    }
    faults
}
