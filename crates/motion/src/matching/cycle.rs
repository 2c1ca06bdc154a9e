//! Clips that are cycles, and their repetition.

use super::features::RATE;
use crate::clip::{Clip, ContactCorrections, Interpolation, Motion};
use crate::gait::events_of;
use crate::math::Planar;
use crate::skeleton::Roles;
use crate::transition::{Loop, LoopOptions, WholeCycle};
use std::sync::Arc;

/// The greatest distance between the ends of a cycle, as a share of the greatest distance of any
/// pose of the clip to the first.
const MAX_GAP_SHARE: f64 = 0.05;
/// The greatest distance for a single stride, which may be larger: captured cycles seldom close by
/// themselves.
const MAX_STRIDE_GAP_SHARE: f64 = 0.35;

/// Closes a clip that is a cycle; `None` for one that is not.
///
/// A cycle is a clip whose end leads into its beginning ([`WholeCycle`]): any clip whose ends
/// nearly meet, and a single stride, with one stance of each foot, whose ends are near each other.
/// A clip that was declared a cycle is one.
pub(super) fn closed(
    clip: &Arc<Clip>,
    roles: &Roles,
    corrections: &ContactCorrections,
    is_declared: bool,
) -> Option<Loop> {
    let source = Motion::with_roles(Arc::clone(clip), roles).declared_cycle(is_declared);
    let whole = WholeCycle::of(&source).filter(|whole| whole.gap_share <= MAX_STRIDE_GAP_SHARE)?;
    let looped = whole.close(&LoopOptions::default()).ok()?;
    let meets = whole.added_frames <= 1 && whole.gap_share <= MAX_GAP_SHARE;
    let by_hand = |side, frame| corrections.planted(side, frame);
    (meets || events_of(&looped, roles, by_hand).is_some()).then_some(looped)
}

/// Returns one repetition of a cycle at [`RATE`] frames per second, and its transform: the frame
/// after its last one is its first, moved by that. A repetition has a whole number of frames, so
/// that it may be faster or slower by up to half a frame.
pub(super) fn at_rate(looped: &Loop) -> Option<(Clip, Planar)> {
    let (clip, cycle) = (&looped.clip, looped.cycle);
    let secs = clip.frames() as f64 / clip.fps();
    let frames = (secs * RATE as f64).round().max(2.0) as usize;
    if clip.fps() == RATE as f64 {
        return Some((clip.clone(), cycle));
    }
    // Sampled in the middle one of three repetitions, away from both ends, and moved back onto the
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

/// Returns the ground frame of a repeated cycle at any frame, before it and after it, from those of
/// one repetition.
pub(super) fn cycle_frame(stands: &[Planar], cycle: &Planar, frame: isize) -> Planar {
    let (round, frame) =
        (frame.div_euclid(stands.len() as isize), frame.rem_euclid(stands.len() as isize));
    cycle_power(cycle, round).after(&stands[frame as usize])
}

/// Returns the transform of `rounds` repetitions, backwards where that is negative.
pub(super) fn cycle_power(cycle: &Planar, rounds: isize) -> Planar {
    let once = if rounds < 0 { cycle.inverse() } else { *cycle };
    (0..rounds.unsigned_abs()).fold(Planar::IDENTITY, |all, _| once.after(&all))
}
