//! Clips that are cycles: one round of them, which plays again and again.

use super::features::RATE;
use crate::blend::Source;
use crate::clip::{Clip, Interpolation};
use crate::gait::events_of;
use crate::math::Planar;
use crate::skeleton::Roles;
use crate::transition::{Loop, LoopOptions, WholeCycle};
use std::sync::Arc;

/// Ends that are this near to each other, as a share of the farthest that a pose of the clip is
/// away from the first, make a cycle of any clip.
const MEETS: f64 = 0.05;
/// Those of a single stride may be farther apart: cycles from a capture seldom close by themselves.
const STRIDE_MEETS: f64 = 0.35;

/// Closes a clip that is a cycle; `None` for one that is not.
///
/// A cycle is a clip whose end leads into its beginning ([`WholeCycle`]): any clip whose ends all
/// but meet, and a single stride, with one stance of each foot, whose ends are near each other.
pub(super) fn closed(clip: &Arc<Clip>, roles: &Roles) -> Option<Loop> {
    let source = Source::new(Arc::clone(clip), roles);
    let whole = WholeCycle::of(&source).filter(|whole| whole.gap_share <= STRIDE_MEETS)?;
    let looped = whole.close(&LoopOptions::default()).ok()?;
    let meets = whole.added_frames <= 1 && whole.gap_share <= MEETS;
    (meets || events_of(&looped, roles).is_some()).then_some(looped)
}

/// One round of a cycle at [`RATE`] frames per second, and where it leads: the frame behind its
/// last is its first, moved by that. A round takes a whole number of frames, so that it may be
/// faster or slower by up to half a frame.
pub(super) fn at_rate(looped: &Loop) -> Option<(Clip, Planar)> {
    let (clip, cycle) = (&looped.clip, looped.cycle);
    let secs = clip.frames() as f64 / clip.fps();
    let frames = (secs * RATE as f64).round().max(2.0) as usize;
    if clip.fps() == RATE as f64 {
        return Some((clip.clone(), cycle));
    }
    // Read in the middle of three rounds, so that no end is in the way, and laid back onto the
    // first.
    let three = looped.repeat(3).ok()?;
    let poses = (0..frames).map(|frame| {
        three.sample(secs * (1.0 + frame as f64 / frames as f64), Interpolation::Cubic)
    });
    let poses: Option<Vec<_>> = poses.collect();
    let round =
        Clip::from_poses(clip.name(), Arc::clone(clip.skeleton()), RATE as f64, poses?).ok()?;
    Some((round.transformed(&cycle.inverse()).with_provenance(clip.provenance()), cycle))
}

/// Where the character stands in a frame of a cycle that goes round, of which `stands` are one
/// round: also before it and behind it.
pub(super) fn standing(stands: &[Planar], cycle: &Planar, frame: isize) -> Planar {
    let (round, frame) =
        (frame.div_euclid(stands.len() as isize), frame.rem_euclid(stands.len() as isize));
    moved_by(cycle, round).after(&stands[frame as usize])
}

/// A cycle made `rounds` times, backwards where that is negative.
pub(super) fn moved_by(cycle: &Planar, rounds: isize) -> Planar {
    let once = if rounds < 0 { cycle.inverse() } else { *cycle };
    (0..rounds.unsigned_abs()).fold(Planar::IDENTITY, |all, _| once.after(&all))
}

/// The way of the mirror image: see [`crate::clip::mirror`].
pub(super) fn mirrored(cycle: &Planar) -> Planar {
    Planar::new(-cycle.yaw, -cycle.shift.x, cycle.shift.y)
}
