//! Swaps: the joints of the left hold the motion of the right, and the other way round.

use super::fault::{Fault, FaultKind, Form, TrackFault, confidence};
use super::steps::Steps;
use super::tracks::Tracks;
use crate::math::quat;
use crate::skeleton::{Mirror, Role, Roles, Side, Skeleton};
use std::ops::Range;

/// The least sum over a limb of departures in the step at which it is exchanged, radians.
const MIN_DEPARTURE: f32 = 0.15;
/// The least ratio of that sum to the usual one.
const MIN_RATIO: f32 = 3.5;
/// The exchange explains the step if what is left of it is below this share.
const MAX_LEFT: f32 = 0.45;

/// Joints that are exchanged together: pairs of left and right.
pub(super) type Limbs = Vec<(usize, usize)>;

/// Returns the legs, and the other joints of the sides, as pairs of tracks.
pub(super) fn limbs(skeleton: &Skeleton, roles: &Roles) -> Vec<Limbs> {
    let Ok(mirror) = Mirror::of(skeleton, roles) else {
        return Vec::new();
    };
    let thighs = Side::BOTH.map(|side| roles.get_within(Role::thigh(side), skeleton.len()));
    let mut in_leg = vec![false; skeleton.len()];
    for joint in 0..skeleton.len() {
        let above = skeleton.parent(joint).is_some_and(|parent| in_leg[parent]);
        in_leg[joint] = above || thighs.contains(&Some(joint));
    }
    let pairs = |leg: bool| -> Limbs {
        (0..skeleton.len())
            .filter(|&joint| in_leg[joint] == leg)
            .filter_map(|joint| Some((joint, mirror.counterpart(joint)?)))
            .filter(|(joint, other)| joint < other)
            .collect()
    };
    [pairs(true), pairs(false)].into_iter().filter(|pairs| !pairs.is_empty()).collect()
}

/// Returns the runs of frames in which the limbs are exchanged: the shorter part of the take.
pub(super) fn swaps(limbs: &Limbs, tracks: &Tracks) -> Vec<Fault> {
    let measured: Vec<(Steps, Steps)> = (limbs.iter())
        .map(|&(left, right)| [left, right].map(|at| Steps::of(&tracks.all[at], tracks)))
        .map(|[left, right]| (left, right))
        .collect();
    let steps = tracks.frames.saturating_sub(1);
    let sum = |at: usize| -> f32 {
        measured.iter().map(|(l, r)| l.departures[at] + r.departures[at]).sum()
    };
    let usual =
        |at: usize| -> f32 { measured.iter().map(|(l, r)| l.usual(at) + r.usual(at)).sum() };
    // The departures of a step from the motion around it: with the sides exchanged, and as it is.
    let explained = |at: usize| -> (f32, f32) {
        let mut sums = (0.0, 0.0);
        for (&(left, right), (l, r)) in limbs.iter().zip(&measured) {
            for ((here, there), (own, other)) in [((left, right), (l, r)), ((right, left), (r, l))]
            {
                let (a, b) = (&tracks.all[here], &tracks.all[there]);
                let (before, after) = (own.before(at), other.after(at + 1));
                sums.0 += (across(a, at, b, at + 1) - (before + after) * 0.5).length();
                sums.1 += (own.ways[at] - (before + own.after(at + 1)) * 0.5).length();
            }
        }
        sums
    };
    let mut turns: Vec<(usize, f32)> = Vec::new();
    for at in 0..steps {
        let departure = sum(at);
        if departure < MIN_DEPARTURE || departure < MIN_RATIO * usual(at) {
            continue;
        }
        let (left, whole) = explained(at);
        if whole > MIN_DEPARTURE && left < MAX_LEFT * whole {
            turns.push((at, whole / left.max(1e-3)));
        }
    }
    let parts: Vec<(Range<usize>, f32)> = segments(&turns, tracks.frames);
    let length = |odd: usize| -> usize {
        parts.iter().skip(odd).step_by(2).map(|(part, _)| part.len()).sum()
    };
    let odd = usize::from(length(0) >= length(1));
    parts
        .iter()
        .skip(odd)
        .step_by(2)
        .filter(|(part, _)| !part.is_empty())
        .map(|(part, score)| {
            let found = limbs.iter().flat_map(|&(left, right)| {
                let apart =
                    part.clone().map(|f| tracks.all[left].distance(f, &tracks.all[right], f));
                let size = tracks.size(left, apart.fold(0.0, f32::max));
                [(left, right), (right, left)].map(|(track, other)| TrackFault {
                    track,
                    frames: part.clone(),
                    form: Form::Exchange(other),
                    size,
                    confidence: confidence(*score, 2.0),
                })
            });
            Fault::of_tracks(FaultKind::Swap, found.collect(), tracks)
        })
        .collect()
}

/// Returns the rotation vector from a rotation of one track to one of another.
fn across(a: &super::tracks::Track, at: usize, b: &super::tracks::Track, to: usize) -> glam::Vec3 {
    use super::tracks::Track;
    match (a, b) {
        (Track::Turn(a), Track::Turn(b)) => quat::log(b[to] * a[at].conjugate()),
        (Track::Place(a), Track::Place(b)) => b[to] - a[at],
        _ => glam::Vec3::INFINITY,
    }
}

/// Returns the parts of a take between exchanges, each with the lower score of its ends.
fn segments(turns: &[(usize, f32)], frames: usize) -> Vec<(Range<usize>, f32)> {
    let mut parts = Vec::with_capacity(turns.len() + 1);
    let (mut start, mut before) = (0, f32::INFINITY);
    for &(at, score) in turns {
        parts.push((start..at + 1, score.min(before)));
        (start, before) = (at + 1, score);
    }
    parts.push((start..frames, before));
    parts
}
