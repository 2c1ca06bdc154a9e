//! The places of feet: where the source has them, held in stances, and above the ground.

use super::tracks::{FootTrack, Tracks};
use super::{SLIDE_ON_PURPOSE_M, Task};
use crate::clip::stillest_step;
use crate::math::stats;
use crate::skeleton::{Foot, FootPair, Side};
use crate::transition::FootLockOptions;
use crate::transition::anchor;
use crate::transition::envelope::{largest_around, smoothed};
use glam::Vec3;
use std::ops::Range;

/// The smoothing time, to either side, of lifting a foot out of the ground, seconds.
const LIFT_SECS: f64 = 0.08;
/// The share of the planted frames, those with the lowest ankle, in which the sole counts as flat.
const FLAT_SHARE: f32 = 0.3;

/// The places of the feet of a body on two legs, or of the hind feet.
#[derive(Debug)]
pub(super) struct FootGoals {
    /// The amount by which the whole body is raised, metres.
    pub(super) rise: f32,
    /// The shifts of the ankles from their positions by rotations only, on the raised body, metres;
    /// empty for a leg that one of the bodies lacks.
    pub(super) shifts: [Vec<Vec3>; 2],
}

/// Returns the goals of the feet at full weight.
pub(super) fn goals(task: &Task, tracks: &Tracks) -> FootGoals {
    let feet: Vec<(usize, &FootTrack)> = (tracks.legs.iter().enumerate())
        .filter_map(|(side, leg)| leg.as_ref().map(|(_, foot)| (side, foot)))
        .collect();
    let Some(levels) = Levels::of(task, FootPair::Hind, &feet) else {
        return FootGoals { rise: 0.0, shifts: Default::default() };
    };
    let mut shifts: [Vec<Vec3>; 2] = Default::default();
    for &(side, foot) in &feet {
        shifts[side] = (0..foot.source.len()).map(|f| levels.shift(task, foot, f)).collect();
    }
    // Raise the whole body by the typical correction of planted feet, and each leg by the rest.
    let contacts = task.source.contacts();
    let planted = feet.iter().flat_map(|&(side, _)| {
        let heights = shifts[side].iter().enumerate();
        heights.filter(move |(f, _)| contacts.planted(Side::BOTH[side], *f)).map(|(_, s)| s.y)
    });
    let mut heights: Vec<f32> = planted.collect();
    if heights.is_empty() {
        heights = shifts.iter().flatten().map(|shift| shift.y).collect();
    }
    let rise = stats::percentile(&heights, 0.5).unwrap_or(0.0);
    for shift in shifts.iter_mut().flatten() {
        shift.y -= rise;
    }
    for (side, foot) in feet {
        hold(task, Side::BOTH[side].into(), foot, &mut shifts[side]);
        lift(task, foot, rise, &mut shifts[side]);
    }
    FootGoals { rise, shifts }
}

/// Moves the goals of forefeet, shifts of the ends of arms, to the heights and stances of the
/// source. `rises` is how far the body is raised in each frame, metres.
pub(super) fn place_forefeet(
    task: &Task,
    tracks: &Tracks,
    rises: &[f32],
    shifts: &mut [Vec<Vec3>; 2],
) {
    let feet: Vec<(usize, &FootTrack)> = (tracks.forefeet.iter().enumerate())
        .filter_map(|(side, foot)| Some((side, foot.as_ref()?)))
        .collect();
    let Some(levels) = Levels::of(task, FootPair::Fore, &feet) else { return };
    for (side, foot) in feet {
        // From where directions alone put the foot, as for hind feet.
        let mut from_directions: Vec<Vec3> = (shifts[side].iter().enumerate())
            .map(|(frame, shift)| Vec3 { y: levels.shift(task, foot, frame).y, ..*shift })
            .collect();
        let of = Foot { pair: FootPair::Fore, side: Side::BOTH[side] };
        hold(task, of, foot, &mut from_directions);
        lift(task, foot, 0.0, &mut from_directions);
        shifts[side] = from_directions
            .iter()
            .zip(rises)
            .map(|(shift, rise)| *shift - Vec3::Y * rise)
            .collect();
    }
}

/// The heights of ankle, ball and tip on a flat sole, metres, of the source and of the target.
struct Levels {
    source: [f32; 3],
    target: [f32; 3],
    /// The kinds that both have.
    shared: [bool; 3],
}

impl Levels {
    /// Returns the levels of bodies with these feet; `None` without any.
    fn of(task: &Task, pair: FootPair, feet: &[(usize, &FootTrack)]) -> Option<Self> {
        let (_, first) = feet.first()?;
        let has =
            |body: usize| [0, 1, 2].map(|kind| feet.iter().all(|(_, foot)| foot.has[body][kind]));
        let (theirs, ours) = (has(0), has(1));
        let shared = [0, 1, 2].map(|kind| theirs[kind] && ours[kind]);
        let contacts = task.source.contacts();
        let frames = || {
            feet.iter().flat_map(|&(side, foot)| {
                (0..foot.source.len()).map(move |frame| (side, foot, frame))
            })
        };
        let is_planted = |side: usize, frame: usize| {
            contacts.planted(Foot { pair, side: Side::BOTH[side] }, frame)
        };
        let any = frames().any(|(side, _, frame)| is_planted(side, frame));
        let standing: Vec<(&FootTrack, usize)> = frames()
            .filter(|&(side, _, frame)| !any || is_planted(side, frame))
            .map(|(_, foot, frame)| (foot, frame))
            .collect();
        let ankles: Vec<f32> = standing.iter().map(|(foot, f)| foot.source[*f][0].y).collect();
        let low = stats::percentile(&ankles, FLAT_SHARE)?;
        let flat = || standing.iter().filter(|(foot, frame)| foot.source[*frame][0].y <= low);
        let median = |height: &dyn Fn(&FootTrack, usize) -> f32| {
            let heights: Vec<f32> = flat().map(|(foot, frame)| height(foot, *frame)).collect();
            stats::percentile(&heights, 0.5).unwrap_or(0.0)
        };
        let source = [0, 1, 2].map(|kind| median(&|foot, frame| foot.source[frame][kind].y));
        // Above the ankle: the ankle itself may be anywhere as yet.
        let above = [0, 1, 2].map(|kind| {
            median(&|foot, frame| foot.target[frame][kind].y - foot.target[frame][0].y)
        });
        let least = |values: [f32; 3], of: [bool; 3]| {
            let kept = (0..3).filter(|kind| of[*kind]).map(|kind| values[kind]);
            kept.fold(f32::INFINITY, f32::min)
        };
        debug_assert!(shared[0] && first.has[1][0], "a leg has an ankle");
        // The lowest shared points are as high as the source's; no point is in the ground.
        let ankle = (task.scale * least(source, shared) - least(above, shared))
            .max(task.ground_m() - least(above, ours));
        Some(Self { source, target: above.map(|above| ankle + above), shared })
    }

    /// Returns the shift of the ankle in a frame from where directions put it.
    fn shift(&self, task: &Task, foot: &FootTrack, frame: usize) -> Vec3 {
        let (source, target) = (&foot.source[frame], &foot.target[frame]);
        let clearance = |points: &[Vec3; 3], levels: [f32; 3]| {
            let kinds = (0..3).filter(|kind| self.shared[*kind]);
            kinds.map(|kind| points[kind].y - levels[kind]).fold(f32::INFINITY, f32::min)
        };
        let wanted = clearance(source, self.source) * task.scale;
        let place = source[0] * task.scale - target[0];
        Vec3::new(place.x, wanted - clearance(target, self.target), place.z)
    }
}

/// Holds the foot in the source's stances.
fn hold(task: &Task, of: Foot, foot: &FootTrack, shifts: &mut [Vec3]) {
    let fps = task.plain.fps();
    let size = task.size();
    let stances = task.source.contacts().intervals(of);
    let kept = slides_on_purpose(task, foot, &stances);
    let kinds: Vec<usize> = (0..3).filter(|kind| foot.has[1][*kind]).collect();
    let moved = |frame: usize, kind: usize| foot.target[frame][kind] + shifts[frame] - kept[frame];
    let ankles = (0..foot.target.len()).map(|frame| moved(frame, 0)).collect();
    let points = (0..foot.target.len())
        .flat_map(|frame| kinds.iter().map(move |&kind| (frame, kind)))
        .map(|(frame, kind)| moved(frame, kind))
        .collect();
    let held = anchor::Foot::moving(ankles, kinds.len(), points);
    let options =
        FootLockOptions { ground_m: None, clearance_m: None, ..FootLockOptions::default() };
    let stances = held.merged(&stances, fps, size);
    for (shift, held) in shifts.iter_mut().zip(held.shifts(&stances, fps, size, &options)) {
        *shift += held;
    }
}

/// Returns how far the foot has slid on purpose up to each frame, on the target's scale.
fn slides_on_purpose(task: &Task, foot: &FootTrack, stances: &[Range<usize>]) -> Vec<Vec3> {
    let kinds: Vec<usize> = (0..3).filter(|kind| foot.has[0][*kind]).collect();
    let at = |frame: usize| kinds.iter().map(|&k| foot.source[frame][k]).collect::<Vec<_>>();
    let mut steps = vec![Vec3::ZERO; foot.source.len()];
    for stance in stances {
        let inner = stance.start + 1..stance.end.min(foot.source.len());
        let slid: Vec<Vec3> = inner
            .clone()
            .map(|frame| stillest_step(&at(frame - 1), &at(frame)).unwrap_or(Vec3::ZERO))
            .collect();
        let whole: Vec3 = slid.iter().sum();
        if whole.length() * task.scale > SLIDE_ON_PURPOSE_M * task.size() {
            for (step, slid) in steps[inner].iter_mut().zip(slid) {
                *step = slid * task.scale;
            }
        }
    }
    let mut sum = Vec3::ZERO;
    steps
        .into_iter()
        .map(|step| {
            sum += step;
            sum
        })
        .collect()
}

/// Lifts the foot smoothly out of the ground.
fn lift(task: &Task, foot: &FootTrack, rise: f32, shifts: &mut [Vec3]) {
    let ground = task.ground_m();
    let depth = |(points, shift): (&[Vec3; 3], &Vec3)| {
        let kinds = (0..3).filter(|kind| foot.has[1][*kind]);
        let lowest = kinds.map(|kind| points[kind].y).fold(f32::INFINITY, f32::min);
        (ground - lowest - rise - shift.y).max(0.0)
    };
    let depths: Vec<f32> = foot.target.iter().zip(&*shifts).map(depth).collect();
    let reach = ((LIFT_SECS * task.plain.fps()).round() as usize).max(1);
    for (shift, lift) in shifts.iter_mut().zip(smoothed(&largest_around(&depths, reach), reach)) {
        shift.y += lift;
    }
}
