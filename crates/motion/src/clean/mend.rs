//! Mends of faults.

use super::fault::{Fault, FaultKind, Form, TrackFault};
use super::jitter;
use super::steps::{NEAR_FRAMES, NEAR_SECS};
use super::tracks::{Track, Tracks};
use crate::clip::{Clip, ClipError, Contacts, Motion};
use crate::math::{Planar, quat, sort::sort_by_key};
use crate::skeleton::Foot;
use crate::transition::{FootLockError, FootLockOptions, FootLocking, has_legs};
use std::ops::Range;
use std::sync::Arc;

/// Options for mends.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MendOptions {
    /// The cut-off frequency of the filter against jitter, hertz; `None` to choose it for each
    /// joint by its noise.
    pub cutoff_hz: Option<f64>,
    /// How sliding feet are held; the ground is the motion's own.
    pub foot_lock: FootLockOptions,
}

/// Error mending a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum MendError {
    /// A mended clip is not valid.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// Its feet cannot be held.
    #[error(transparent)]
    Feet(#[from] FootLockError),
    /// The faults were found in another clip.
    #[error("these faults were found in another clip: look for them again")]
    OtherClip,
}

/// A mended motion.
#[derive(Clone, Debug)]
pub struct Mended {
    /// The motion.
    pub motion: Arc<Motion>,
    /// The frames of the source that it has: all but the ends that were cut off.
    pub frames: Range<usize>,
}

/// Returns a motion without these faults, mended in the order of [`FaultKind::ALL`]. Frames and
/// joints that no fault names keep their values, but for what a foot lock moves.
///
/// # Errors
/// [`MendError`] if the faults belong to another clip, or feet cannot be held.
pub fn mend(
    source: &Arc<Motion>,
    faults: &[&Fault],
    options: &MendOptions,
) -> Result<Mended, MendError> {
    let mut mending = Mending::new(source, faults, options)?;
    while mending.advance()? {}
    Ok(mending.finish())
}

/// The frames of a foot lock that one slice processes.
const LOCKED_PER_SLICE: usize = 500;

/// The work of [`mend`] in slices, for long takes.
#[derive(Debug)]
pub struct Mending {
    source: Arc<Motion>,
    faults: Vec<Fault>,
    options: MendOptions,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    /// Mends the tracks of one fault after the other.
    Tracks {
        tracks: Option<Box<Tracks>>,
        next: usize,
    },
    /// Holds the feet.
    Feet {
        motion: Box<Motion>,
        frames: Range<usize>,
        locking: Box<FootLocking>,
    },
    Done(Mended),
}

impl Mending {
    /// Begins to mend. Nothing is computed yet: call [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`MendError::OtherClip`] if the faults do not fit the clip.
    pub fn new(
        source: &Arc<Motion>,
        faults: &[&Fault],
        options: &MendOptions,
    ) -> Result<Self, MendError> {
        let clip = source.clip();
        let tracks = clip.skeleton().len() + 1 + clip.translations().len();
        let fits = |fault: &&Fault| {
            fault.frames.end <= clip.frames()
                && fault.joints.iter().all(|&joint| joint < clip.skeleton().len())
                && fault.tracks.iter().all(|part| part.track < tracks)
        };
        if !faults.iter().all(fits) {
            return Err(MendError::OtherClip);
        }
        let mut faults: Vec<Fault> = faults.iter().map(|&fault| fault.clone()).collect();
        sort_by_key(&mut faults, |fault| (fault.kind, fault.frames.start));
        let stage = if faults.is_empty() {
            Stage::Done(Mended { motion: Arc::clone(source), frames: 0..clip.frames() })
        } else {
            Stage::Tracks { tracks: None, next: 0 }
        };
        Ok(Self { source: Arc::clone(source), faults, options: *options, stage })
    }

    /// Does one part of the work. Returns `false` when all is done.
    ///
    /// # Errors
    /// [`MendError`] if feet cannot be held.
    pub fn advance(&mut self) -> Result<bool, MendError> {
        match &mut self.stage {
            Stage::Tracks { tracks, next } => {
                let of_tracks = self.faults.iter().filter(|fault| fault.is_in_tracks());
                if let Some(fault) = of_tracks.clone().nth(*next) {
                    let tracks =
                        tracks.get_or_insert_with(|| Box::new(Tracks::of(self.source.clip())));
                    in_tracks(fault, tracks, self.options.cutoff_hz);
                    *next += 1;
                } else {
                    let tracks = tracks.take();
                    self.stage = self.whole_body(tracks.as_deref())?;
                }
            }
            Stage::Feet { motion, frames, locking } => {
                if !locking.advance(LOCKED_PER_SLICE) {
                    let (motion, frames) = (motion.clone(), frames.clone());
                    let Stage::Feet { locking, .. } = std::mem::replace(
                        &mut self.stage,
                        Stage::Tracks { tracks: None, next: usize::MAX },
                    ) else {
                        return Ok(false);
                    };
                    let places = motion.ground_frames().to_vec();
                    let motion = Arc::new(motion.with_clip(locking.finish()?, places));
                    self.stage = Stage::Done(Mended { motion, frames });
                }
            }
            Stage::Done(_) => return Ok(false),
        }
        Ok(true)
    }

    /// Mends what is wrong with the whole body, and begins to hold the feet where they slide.
    fn whole_body(&self, tracks: Option<&Tracks>) -> Result<Stage, MendError> {
        let source = &self.source;
        let mut clip = match tracks {
            Some(tracks) => Arc::new(tracks.clip(source.clip())?),
            None => Arc::clone(source.clip()),
        };
        let mut frames = 0..clip.frames();
        for fault in &self.faults {
            match fault.whole {
                Some(Form::Level { from_m, rise_mps }) => {
                    clip = Arc::new(levelled(&clip, from_m, rise_mps));
                }
                Some(Form::Drift { velocity_mps, turn_rps }) => {
                    clip = Arc::new(without_drift(&clip, velocity_mps, turn_rps));
                }
                // The last one: the others are told in seconds of the take as it is.
                Some(Form::Rate(fps)) => clip = Arc::new(Clip::clone(&clip).at_rate(fps)?),
                Some(Form::Outside) if fault.frames.start == 0 => frames.start = fault.frames.end,
                Some(Form::Outside) => frames.end = frames.end.min(fault.frames.start),
                _ => {}
            }
        }
        let all = clip.frames();
        let mut motion = Motion::with_roles(clip, source.roles())
            .with_feet(source.feet())
            .with_contact_corrections(source.contact_corrections().clone());
        if frames.is_empty() {
            frames = 0..all;
        }
        if frames.len() < all {
            motion = motion.cropped(frames.clone())?;
        }
        let slides = self.faults.iter().filter_map(|fault| match fault.whole {
            Some(Form::Slide(foot)) => Some((foot, within(&fault.frames, &frames))),
            _ => None,
        });
        let slides: Vec<(Foot, Range<usize>)> = slides.collect();
        if slides.is_empty() || !has_legs(motion.clip().skeleton(), motion.roles()) {
            return Ok(Stage::Done(Mended { motion: Arc::new(motion), frames }));
        }
        let contacts = sliding_contacts(&motion, &slides);
        let options =
            FootLockOptions { ground_m: Some(motion.ground_m()), ..self.options.foot_lock };
        let locking =
            FootLocking::new(Arc::clone(motion.clip()), motion.roles(), &contacts, &options)?;
        Ok(Stage::Feet { motion: Box::new(motion), frames, locking: Box::new(locking) })
    }

    /// Returns the share of the work that is done, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f32 {
        match &self.stage {
            Stage::Tracks { next, .. } => {
                0.5 * (*next).min(self.faults.len()) as f32 / self.faults.len().max(1) as f32
            }
            Stage::Feet { locking, .. } => 0.5 + 0.5 * locking.progress(),
            Stage::Done(_) => 1.0,
        }
    }

    /// Returns the mended motion; the source, where the work was not done.
    #[must_use]
    pub fn finish(self) -> Mended {
        match self.stage {
            Stage::Done(mended) => mended,
            _ => Mended { frames: 0..self.source.clip().frames(), motion: self.source },
        }
    }
}

/// Returns the frames of a range in a part of the clip, numbered from its start.
fn within(range: &Range<usize>, part: &Range<usize>) -> Range<usize> {
    let at = |frame: usize| frame.clamp(part.start, part.end) - part.start;
    at(range.start)..at(range.end)
}

/// Mends the tracks of a fault.
pub(super) fn in_tracks(fault: &Fault, tracks: &mut Tracks, cutoff_hz: Option<f64>) {
    for part in &fault.tracks {
        match part.form {
            Form::Run => bridge(part, fault.kind == FaultKind::Gap, tracks),
            Form::Exchange(other) if part.track < other => exchange(part, other, tracks),
            Form::Flip(over) => turn_back(part, over, tracks),
            Form::Noise(deviation) => {
                let fps = tracks.fps;
                if let Some(track) = tracks.all.get_mut(part.track) {
                    jitter::filter(track, &part.frames, deviation, cutoff_hz, fps);
                }
            }
            _ => {}
        }
    }
}

/// Draws the frames of a run anew between the good ones: a cubic with the velocities of both sides
/// (on rotation vectors from the last good frame). At an end of the clip the good frame is held.
fn bridge(part: &TrackFault, is_gap: bool, tracks: &mut Tracks) {
    let near = tracks.frames_of(NEAR_SECS, NEAR_FRAMES);
    let Some(track) = tracks.all.get_mut(part.track) else {
        return;
    };
    let (from, to) = (part.frames.start.checked_sub(1), part.frames.end);
    if let Some(from) = from.filter(|_| to < track.len()) {
        let (before, after) = (from.saturating_sub(near), to + near);
        // Beside a spike there may be more of it, so that only the median is safe.
        let (leave, arrive) = if is_gap {
            (track.velocity_at(before, from, true), track.velocity_at(to, after, false))
        } else {
            (track.velocity(before, from), track.velocity(to, after))
        };
        let drawn = track.bridge(from, to, leave, arrive);
        track.put(from + 1, &drawn);
        track.align_signs();
    }
}

/// Exchanges the frames of two tracks.
fn exchange(part: &TrackFault, other: usize, tracks: &mut Tracks) {
    let Some([a, b]) = tracks.all.get_disjoint_mut([part.track, other]).ok() else {
        return;
    };
    match (&mut *a, &mut *b) {
        (Track::Turn(a), Track::Turn(b)) => {
            a[part.frames.clone()].swap_with_slice(&mut b[part.frames.clone()]);
        }
        (Track::Place(a), Track::Place(b)) => {
            a[part.frames.clone()].swap_with_slice(&mut b[part.frames.clone()]);
        }
        _ => {}
    }
    a.align_signs();
    b.align_signs();
}

/// Takes a constant rotation out of some frames. It is one in the parent's frame or in the joint's
/// own, whichever leaves the smaller step behind them.
fn turn_back(part: &TrackFault, over: glam::Vec3, tracks: &mut Tracks) {
    let Some(track) = tracks.all.get_mut(part.track) else {
        return;
    };
    let Track::Turn(values) = &mut *track else {
        return;
    };
    let (start, end) = (part.frames.start, part.frames.end.min(values.len()));
    if start == 0 || start >= end {
        return;
    }
    let in_parent = quat::exp(-over);
    // q = over · good = good · own, with own = good⁻¹ · over · good at the first of the frames.
    let good = in_parent * values[start];
    let in_joint = values[start].conjugate() * good;
    let last_step =
        |value: glam::Quat| values.get(end).map_or(0.0, |&next| quat::angle_between(value, next));
    let last = values[end - 1];
    let is_in_parent = last_step(in_parent * last) <= last_step(last * in_joint);
    for value in &mut values[start..end] {
        let back = if is_in_parent { in_parent * *value } else { *value * in_joint };
        *value = quat::renormalize(back);
    }
    track.align_signs();
}

/// Returns a clip lowered by a height that grows evenly.
pub(super) fn levelled(clip: &Clip, from_m: f32, rise_mps: f32) -> Clip {
    let mut tracks = Tracks::of(clip);
    let (fps, root) = (tracks.fps as f32, tracks.joints);
    if let Some(Track::Place(places)) = tracks.all.get_mut(root) {
        for (frame, place) in places.iter_mut().enumerate() {
            place.y -= from_m + rise_mps * frame as f32 / fps;
        }
    }
    tracks.clip(clip).unwrap_or_else(|_| clip.clone())
}

/// Returns a clip moved against an even drift.
pub(super) fn without_drift(clip: &Clip, velocity_mps: glam::DVec2, turn_rps: f64) -> Clip {
    let centre = glam::DVec2::new(velocity_mps.y, -velocity_mps.x) / turn_rps;
    let moves: Vec<Planar> = (0..clip.frames())
        .map(|frame| {
            let secs = clip.time_of(frame);
            if turn_rps.abs() < 1e-4 {
                let shift = -velocity_mps * secs;
                Planar::new(0.0, shift.x, shift.y)
            } else {
                Planar::turn_about(-turn_rps * secs, centre)
            }
        })
        .collect();
    clip.transformed_by_frame(&moves)
}

/// Returns the stances that touch some frames.
fn sliding_contacts(motion: &Motion, slides: &[(Foot, Range<usize>)]) -> Contacts {
    let contacts = motion.contacts();
    Contacts::of_feet(contacts.feet(), |foot| {
        let mut flags = vec![false; contacts.frames()];
        for stance in contacts.intervals(foot) {
            let touches = |(of, frames): &(Foot, Range<usize>)| {
                *of == foot && frames.start < stance.end && stance.start < frames.end
            };
            if slides.iter().any(touches) {
                flags[stance].fill(true);
            }
        }
        flags
    })
}
