//! Measurements of walks.

use super::stitch::PieceSeam;
use super::{FrameSet, MotionGraph, Place, WalkPiece};
use crate::clip::{Clip, stillest_step, turn_change};
use crate::math::{Planar, quat, stats, wrap_angle};
use crate::skeleton::{Foot, WorldPose};
use glam::{DVec2, Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// The least excess of yaw within [`SPIN_SECS`] that counts as a spin, degrees.
const MIN_SPIN_DEG: f64 = 30.0;
/// The time within which spins are measured, seconds.
const SPIN_SECS: f64 = 0.2;
/// A step counts as a flash above this multiple of the 99.9th percentile of the clips' own steps.
const FLASH: f32 = 2.0;
/// The least rotation per frame that counts as a movement of a joint, radians: less is rounding in
/// single precision, or noise of a capture at rest.
const MIN_TURN_RADIANS: f32 = 2e-3;
/// The least step that counts as a movement of a root, metres.
const MIN_STEP_M: f32 = 5e-4;
/// The least difference of velocities for which a lag is measured, metres per second.
const MIN_CHANGE_MPS: f64 = 0.1;

/// The usual values in the clips of a set, measured once.
#[derive(Clone, Debug)]
pub struct WalkProfile {
    set: Arc<FrameSet>,
    /// Per joint, the 99th and 99.9th percentile of the turn from one frame to the next, radians.
    turns: Vec<[f32; 2]>,
    /// Per joint, the 99th percentile of the change of that turn, radians.
    changes: Vec<f32>,
    /// The 99.9th percentile of the root's step, metres.
    step: f32,
}

impl WalkProfile {
    /// Measures the clips. O(frames × joints).
    #[must_use]
    pub fn new(set: Arc<FrameSet>) -> Self {
        let mut profile = Self::begun(set);
        while !profile.advance(usize::MAX) {}
        profile
    }

    /// Returns a profile without measured joints: call [`advance`](Self::advance) until it is
    /// complete.
    #[must_use]
    pub fn begun(set: Arc<FrameSet>) -> Self {
        let steps = |clip: &Clip| -> Vec<f32> {
            clip.root_translations().windows(2).map(|pair| pair[0].distance(pair[1])).collect()
        };
        let steps: Vec<f32> = set.clips().iter().flat_map(|source| steps(source.clip())).collect();
        Self {
            step: stats::percentile(&steps, 0.999).unwrap_or(0.0),
            set,
            turns: Vec::new(),
            changes: Vec::new(),
        }
    }

    /// Measures up to `joints` more joints; returns `true` when all are measured.
    pub fn advance(&mut self, joints: usize) -> bool {
        let set = &self.set;
        let all = set.clips().first().map_or(0, |source| source.clip().skeleton().len());
        let percentile = |values: &[f32], p: f32| stats::percentile(values, p).unwrap_or(0.0);
        let (turns, changes) = (&mut self.turns, &mut self.changes);
        for joint in turns.len()..turns.len().saturating_add(joints).min(all) {
            let (mut turned, mut changed) = (Vec::new(), Vec::new());
            for source in set.clips() {
                let clip = source.clip();
                let mut before = None;
                for frame in 1..clip.frames() {
                    let turn = turn(clip.rotations(frame - 1)[joint], clip.rotations(frame)[joint]);
                    turned.push(turn.length());
                    changed.extend(before.map(|before: Vec3| turn.distance(before)));
                    before = Some(turn);
                }
            }
            turns.push([percentile(&turned, 0.99), percentile(&turned, 0.999)]);
            changes.push(percentile(&changed, 0.99));
        }
        turns.len() == all
    }

    fn planted(&self, place: Place, foot: Foot) -> bool {
        self.set.clip(place.clip).is_some_and(|motion| {
            place.frame < motion.clip().frames() && motion.contacts().planted(foot, place.frame)
        })
    }

    /// Returns the character's step into a frame of a clip; after its end, the last step.
    fn step_into(&self, place: Place) -> Planar {
        let last = self.set.frames_of(place.clip).saturating_sub(1);
        self.set
            .clip(place.clip)
            .map_or(Planar::IDENTITY, |source| source.step_into(place.frame.min(last)))
    }
}

/// The measurements of one transition of a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Seam {
    /// The frame of the walk at which it begins.
    pub at: usize,
    /// Number of its frames.
    pub frames: usize,
    /// The largest turn of a joint in one step, degrees, beyond the 99th percentile of that joint
    /// in the clips or the turn in the clips' very frames, whichever is larger.
    pub turn_deg: f32,
    /// The largest change of a joint's angular velocity from one step to the next, degrees per
    /// second, beyond the 99th percentile of that joint in the clips or the change in the clips'
    /// very frames, whichever is larger.
    pub change_dps: f32,
    /// The largest yaw within 0.2 s beyond that of both clips in the same time, degrees.
    pub spin_deg: f64,
    /// The largest step of the root or turn of a joint, as a multiple of the 99.9th percentile of
    /// the clips' own or of the value in the clips' very frames, whichever is larger: a jump that
    /// the capture contains is not attributed to the walk.
    pub flash: f32,
    /// The joint of [`flash`](Self::flash); `None` where it is the root's step.
    pub flash_joint: Option<usize>,
    /// The frame of the walk into which that step goes.
    pub flash_at: usize,
    /// The slide of a foot in the worst stance that overlaps the transition, centimetres; `None`
    /// without such stances.
    pub skate_cm: Option<f32>,
    /// Seconds until the velocity has covered 90 % of the difference to the entered clip's; `None`
    /// where the two are nearly equal.
    pub lag_s: Option<f64>,
}

/// The metrics of a walk.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct WalkMetrics {
    /// Duration, seconds.
    pub secs: f64,
    /// The share of the set's frames that it plays at least once.
    pub variety: f64,
    /// Its transitions.
    pub seams: Vec<Seam>,
    /// The median slide of a foot in stances without a transition, centimetres, for comparison.
    pub own_skate_cm: Option<f32>,
}

/// The quantities of a walk that are read frame by frame.
#[derive(Clone, Debug, Default)]
struct WalkQuantities {
    steps: Vec<Planar>,
    turns: Vec<f32>,
    changes: Vec<f32>,
    flashes: Vec<(f32, Option<usize>)>,
    /// (first frame, last frame, slide in metres)
    stances: Vec<(usize, usize, f32)>,
}

impl WalkMetrics {
    /// Measures consecutive pieces of a walk.
    #[must_use]
    pub fn measure(pieces: &[WalkPiece], graph: &MotionGraph, profile: &WalkProfile) -> Self {
        let mut meter = WalkMeter::new(graph.set());
        for piece in pieces {
            meter.add(piece, profile);
        }
        meter.metrics(profile)
    }

    /// Returns the number of transitions with more than 30° of yaw within 0.2 s beyond both clips.
    #[must_use]
    pub fn spins(&self) -> usize {
        self.seams.iter().filter(|seam| seam.spin_deg > MIN_SPIN_DEG).count()
    }

    /// Returns the number of transitions with a step of the root or turn of a joint above twice the
    /// 99.9th percentile of the clips' own.
    #[must_use]
    pub fn flashes(&self) -> usize {
        self.seams.iter().filter(|seam| seam.flash > FLASH).count()
    }

    /// Returns the frame of the walk in the middle of the transition with the largest spin; `None`
    /// if none [counts](Self::spins).
    #[must_use]
    pub fn worst_spin_at(&self) -> Option<usize> {
        let spins = self.seams.iter().filter(|seam| seam.spin_deg > MIN_SPIN_DEG);
        let worst = spins.max_by(|a, b| a.spin_deg.total_cmp(&b.spin_deg))?;
        Some(worst.at + worst.frames / 2)
    }

    /// Returns the frame of the walk into which the largest flash goes; `None` if none
    /// [counts](Self::flashes).
    #[must_use]
    pub fn worst_flash_at(&self) -> Option<usize> {
        let flashes = self.seams.iter().filter(|seam| seam.flash > FLASH);
        flashes.max_by(|a, b| a.flash.total_cmp(&b.flash)).map(|seam| seam.flash_at)
    }

    /// Returns the number of transitions in a minute; `None` for an empty walk.
    #[must_use]
    pub fn seams_per_minute(&self) -> Option<f64> {
        (self.secs > 0.0).then(|| self.seams.len() as f64 * 60.0 / self.secs)
    }

    /// Returns the median lag of the transitions, seconds; `None` if none has a lag.
    #[must_use]
    pub fn median_lag_s(&self) -> Option<f64> {
        let lags: Vec<f32> =
            self.seams.iter().filter_map(|seam| seam.lag_s.map(|lag| lag as f32)).collect();
        stats::percentile(&lags, 0.5).map(f64::from)
    }
}

fn turn(from: Quat, to: Quat) -> Vec3 {
    quat::log(to * from.conjugate())
}

/// The incremental measurement of a walk, piece by piece.
#[derive(Clone, Debug)]
pub struct WalkMeter {
    walked: WalkQuantities,
    /// The first measured frame of the walk.
    first: Option<usize>,
    /// The transitions, and the frames at which they begin.
    seams: Vec<(usize, PieceSeam)>,
    /// Number of measured frames of an incomplete piece.
    within: usize,
    /// Whether each frame of the set was played.
    seen: Vec<bool>,
    /// The points of each foot in the previous frame.
    feet: [Vec<Vec3>; 4],
    /// Per foot: the first frame of the stance, its greatest slide and its current slide, metres.
    stances: [Option<(usize, f32, Vec3)>; 4],
    /// The previous frame: ground frame, local rotations of the joints, and position of the root.
    before: Option<(Planar, Vec<Quat>, Vec3)>,
    turned: Vec<Vec3>,
    world_from_last: Planar,
}

impl WalkMeter {
    /// Returns a meter that has measured nothing yet.
    #[must_use]
    pub fn new(set: &FrameSet) -> Self {
        Self {
            walked: WalkQuantities::default(),
            first: None,
            seams: Vec::new(),
            within: 0,
            seen: vec![false; set.frames()],
            feet: Default::default(),
            stances: [None; 4],
            before: None,
            turned: Vec::new(),
            world_from_last: Planar::IDENTITY,
        }
    }

    /// Measures the next piece. O(frames × joints).
    pub fn add(&mut self, piece: &WalkPiece, profile: &WalkProfile) {
        while !self.advance(piece, profile, usize::MAX) {}
    }

    /// Measures up to `frames` more frames of a piece, at least one; returns `true` when the piece
    /// is complete. Until then every call must be given the same piece.
    pub fn advance(&mut self, piece: &WalkPiece, profile: &WalkProfile, frames: usize) -> bool {
        if self.within == 0 {
            self.begin(piece, profile);
        }
        let from = self.within;
        let to = from.saturating_add(frames.max(1)).min(piece.clip.frames());
        self.measure(piece, from..to, profile);
        let is_whole = to == piece.clip.frames();
        self.within = if is_whole { 0 } else { to };
        is_whole
    }

    fn begin(&mut self, piece: &WalkPiece, profile: &WalkProfile) {
        self.first.get_or_insert(piece.start);
        self.seams.extend(piece.seam.map(|seam| (piece.start, seam)));
        for frame in piece.stay.from..piece.stay.to {
            let place = Place { clip: piece.stay.clip, frame };
            if let Some(seen) =
                profile.set.number(place).and_then(|number| self.seen.get_mut(number))
            {
                *seen = true;
            }
        }
        self.bring_over(&piece.world_from_piece.inverse().after(&self.world_from_last));
        self.world_from_last = piece.world_from_piece;
    }

    fn measure(&mut self, piece: &WalkPiece, frames: Range<usize>, profile: &WalkProfile) {
        let roles = profile.set.clips().first().map(|motion| motion.roles());
        let feet = roles.map_or(&[][..], |roles| Foot::of(roles.body_plan()));
        let points_of = |&foot: &Foot| {
            roles.map_or_else(Vec::new, |roles| roles.foot_points(piece.clip.skeleton(), foot))
        };
        let points: Vec<(Foot, Vec<(usize, Vec3)>)> =
            feet.iter().map(|foot| (*foot, points_of(foot))).collect();
        let mut world = WorldPose::default();
        for frame in frames {
            let standing = piece.frames.get(frame).copied().unwrap_or(Planar::IDENTITY);
            let (rotations, root) =
                (piece.clip.rotations(frame), piece.clip.root_translations()[frame]);
            let sources = Sources::of(piece, frame, &profile.set);
            self.walked.step(
                self.before.as_ref(),
                (&standing, rotations, root),
                &mut self.turned,
                profile,
                &sources,
            );
            self.before = Some((standing, rotations.to_vec(), root));
            piece.clip.world_pose_into(frame, &mut world);
            let number = self.walked.steps.len() - 1;
            for (foot, points) in &points {
                let now: Vec<Vec3> =
                    points.iter().map(|&(joint, point)| world.point(joint, point)).collect();
                let stands = profile.planted(piece.shown_at(frame), *foot);
                let (feet, stance) =
                    (&mut self.feet[foot.index()], &mut self.stances[foot.index()]);
                if let (Some(step), Some((_, most, slid))) =
                    (stillest_step(feet, &now).filter(|_| stands), stance.as_mut())
                {
                    *slid += step;
                    *most = most.max(slid.length());
                } else {
                    self.walked
                        .stances
                        .extend(stance.take().map(|(first, most, _)| (first, number, most)));
                    *stance = stands.then_some((number, 0.0, Vec3::ZERO));
                }
                *feet = now;
            }
        }
    }

    /// Converts the last frame of the previous piece to the frame of reference of the next one, so
    /// that nothing is compared far from the origin.
    fn bring_over(&mut self, here_from_last: &Planar) {
        for point in self.feet.iter_mut().flatten() {
            *point = here_from_last.apply(*point);
        }
        if let Some(root_turn) = self.turned.first_mut() {
            *root_turn = here_from_last.apply_vector(*root_turn);
        }
        for (_, _, slid) in self.stances.iter_mut().flatten() {
            *slid = here_from_last.apply_vector(*slid);
        }
        if let Some((standing, rotations, root)) = &mut self.before {
            *standing = here_from_last.after(standing);
            *root = here_from_last.apply(*root);
            if let Some(q) = rotations.first_mut() {
                *q = here_from_last.rotation() * *q;
            }
        }
    }

    /// Returns the number of measured frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.walked.steps.len()
    }

    /// Returns the metrics of the frames measured so far. `profile` is the one with which the
    /// pieces were measured.
    #[must_use]
    pub fn metrics(&self, profile: &WalkProfile) -> WalkMetrics {
        let fps = profile.set.fps();
        let first = self.first.unwrap_or(0);
        let last = self.walked.steps.len().saturating_sub(1);
        let open = self.stances.iter().flatten().map(|&(first, most, _)| (first, last, most));
        let stances: Vec<(usize, usize, f32)> =
            self.walked.stances.iter().copied().chain(open).collect();
        let seams: Vec<Seam> = (self.seams.iter())
            .map(|(start, of)| seam(start - first, of, &self.walked, &stances, profile))
            .collect();
        let touches = |stance: &(usize, usize, f32)| {
            seams.iter().any(|seam| stance.0 <= seam.at + seam.frames && seam.at <= stance.1)
        };
        let own: Vec<f32> = stances
            .iter()
            .filter(|stance| !touches(stance))
            .map(|stance| stance.2 * 100.0)
            .collect();
        WalkMetrics {
            secs: self.walked.steps.len() as f64 / fps,
            variety: self.seen.iter().filter(|seen| **seen).count() as f64
                / self.seen.len().max(1) as f64,
            seams,
            own_skate_cm: stats::percentile(&own, 0.5),
        }
    }
}

impl WalkQuantities {
    /// Measures the step into a frame.
    fn step(
        &mut self,
        before: Option<&(Planar, Vec<Quat>, Vec3)>,
        (standing, rotations, root): (&Planar, &[Quat], Vec3),
        turned: &mut Vec<Vec3>,
        profile: &WalkProfile,
        sources: &Sources<'_>,
    ) {
        let (mut turn_excess, mut change_excess, mut flash) = (0.0_f32, 0.0_f32, (0.0_f32, None));
        let mut step = Planar::IDENTITY;
        if let Some((stood, were, root_was)) = before {
            step = stood.inverse().after(standing);
            flash.0 = root.distance(*root_was) / profile.step.max(MIN_STEP_M).max(sources.step());
            let turns: Vec<Vec3> =
                were.iter().zip(rotations).map(|(&from, &to)| turn(from, to)).collect();
            for (joint, turn) in turns.iter().enumerate() {
                let (Some([p99, p999]), Some(change)) =
                    (profile.turns.get(joint), profile.changes.get(joint))
                else {
                    continue;
                };
                let (length, changed) =
                    (turn.length(), turned.get(joint).map_or(0.0, |before| before.distance(*turn)));
                // Evaluate the clips' own values only where they matter.
                if length / p999.max(MIN_TURN_RADIANS) > flash.0 {
                    let unusual = length / p999.max(MIN_TURN_RADIANS).max(sources.turn(joint));
                    if unusual > flash.0 {
                        flash = (unusual, Some(joint));
                    }
                }
                if length - p99 > turn_excess {
                    turn_excess = turn_excess.max(length - p99.max(sources.turn(joint)));
                }
                if changed - change > change_excess {
                    change_excess = change_excess.max(changed - change.max(sources.change(joint)));
                }
            }
            *turned = turns;
        }
        self.steps.push(step);
        self.turns.push(turn_excess);
        self.changes.push(change_excess);
        self.flashes.push(flash);
    }
}

/// The frames of the clips that play in a frame of a walk: one, or two in a transition.
struct Sources<'a>([Option<(&'a Clip, usize)>; 2]);

impl<'a> Sources<'a> {
    fn of(piece: &WalkPiece, frame: usize, set: &'a FrameSet) -> Self {
        let clip = |place: Place| {
            let clip = set.clip(place.clip)?.clip();
            (place.frame < clip.frames()).then_some((clip.as_ref(), place.frame))
        };
        let entered = Place { clip: piece.stay.clip, frame: piece.stay.from + frame };
        let left = piece
            .seam
            .filter(|seam| frame <= seam.frames)
            .map(|seam| Place { frame: seam.leave.frame + frame, ..seam.leave });
        Self([clip(entered), left.and_then(clip)])
    }

    fn most(&self, of: impl Fn(&Clip, usize) -> Option<f32>) -> f32 {
        let found = self.0.iter().flatten().filter_map(|&(clip, frame)| of(clip, frame));
        found.fold(0.0, f32::max)
    }

    /// Returns the larger of the clips' own steps of the root into the frame, metres.
    fn step(&self) -> f32 {
        self.most(|clip, frame| {
            let roots = clip.root_translations();
            Some(roots.get(frame.checked_sub(1)?)?.distance(*roots.get(frame)?))
        })
    }

    /// Returns the larger of the clips' own turns of a joint in the step into the frame, radians.
    fn turn(&self, joint: usize) -> f32 {
        self.most(|clip, frame| {
            let at = |frame: usize| clip.rotations(frame).get(joint).copied();
            Some(turn(at(frame.checked_sub(1)?)?, at(frame)?).length())
        })
    }

    /// Returns the larger of the clips' own changes of that turn from the step before, radians.
    fn change(&self, joint: usize) -> f32 {
        self.most(|clip, frame| turn_change(clip, frame.checked_sub(1)?, joint))
    }
}

fn seam(
    at: usize,
    of: &PieceSeam,
    walked: &WalkQuantities,
    stances: &[(usize, usize, f32)],
    profile: &WalkProfile,
) -> Seam {
    let fps = profile.set.fps();
    let end = (at + of.frames).min(walked.steps.len().saturating_sub(1));
    let most = |values: &[f32]| {
        values.get(at..=end).unwrap_or_default().iter().copied().fold(0.0, f32::max)
    };
    let behind = |place: Place, steps: usize| Place { frame: place.frame + steps, ..place };
    let steps: Vec<[Planar; 3]> = (at..=end)
        .map(|frame| {
            let source = |place| profile.step_into(behind(place, frame - at));
            [walked.steps[frame], source(of.leave), source(of.enter)]
        })
        .collect();
    let flashes = walked.flashes.get(at..=end).unwrap_or_default().iter();
    let flashes = flashes.enumerate().map(|(step, &(flash, joint))| (flash, joint, at + step));
    let (flash, flash_joint, flash_at) =
        flashes.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, None, at));
    let stances = stances.iter().filter(|stance| stance.0 <= end && at <= stance.1);
    Seam {
        at,
        frames: of.frames,
        turn_deg: most(&walked.turns).to_degrees(),
        change_dps: most(&walked.changes).to_degrees() * fps as f32,
        spin_deg: spin(&steps, (SPIN_SECS * fps).round().max(1.0) as usize).to_degrees(),
        flash,
        flash_joint,
        flash_at,
        skate_cm: stances.map(|stance| stance.2 * 100.0).max_by(f32::total_cmp),
        lag_s: lag(&steps, fps),
    }
}

/// Returns the largest turn of the first beyond both others, over any run of at most `longest`
/// steps, radians.
fn spin(steps: &[[Planar; 3]], longest: usize) -> f64 {
    let mut worst = 0.0_f64;
    for start in 0..steps.len() {
        let mut turned = [0.0; 3];
        for step in steps[start..].iter().take(longest) {
            for (turned, step) in turned.iter_mut().zip(step) {
                *turned += wrap_angle(step.yaw);
            }
            let [r, a, b] = turned;
            worst = worst.max(r - a.max(b).max(0.0)).max(a.min(b).min(0.0) - r);
        }
    }
    worst
}

fn lag(steps: &[[Planar; 3]], fps: f64) -> Option<f64> {
    let apart: f64 = steps.iter().map(|[_, a, b]| a.shift.distance_squared(b.shift)).sum();
    let apart = (apart / steps.len().max(1) as f64).sqrt();
    if apart * fps < MIN_CHANGE_MPS {
        return None;
    }
    let off = |[r, _, b]: &[Planar; 3]| DVec2::distance(r.shift, b.shift) > 0.1 * apart;
    Some(steps.iter().rposition(off).map_or(0.0, |last| (last + 1) as f64 / fps))
}
