//! Foot lock: planted feet are held in place by two-bone inverse kinematics.

use super::limb::{Limb, LimbPose};
use crate::blend::MAX_SECS;
use crate::clip::{Clip, ClipError, Contacts};
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Foot, Roles, Side, Skeleton, WorldPose};
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

pub(crate) mod anchor;
pub(crate) mod envelope;
pub(crate) mod hips;

/// Options of the foot lock. Lengths are those of a character 1.75 m tall and are scaled to the
/// clip's character.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FootLockOptions {
    /// Time over which the correction of a foot fades in before a stance, and out after it,
    /// seconds; less where the next stance is nearer.
    pub blend_secs: f64,
    /// The farthest that a foot is moved over the ground, metres. From half of this limit on the
    /// correction approaches it smoothly; the rest of the slide remains. Without a limit, a foot
    /// with a wrong contact during its swing would tear the leg.
    pub max_shift_m: f32,
    /// The height of the ground, metres: planted feet are lifted above it. `None` leaves heights
    /// unchanged.
    pub ground_m: Option<f32>,
    /// The least height of a swinging foot above its height in the adjacent stances, metres: a
    /// lower foot scrapes over the ground, and is raised. People clear it by 1 to 2 cm with their
    /// toes (Winter 1992, "The foot trajectory in human gait"); a little more does not look like
    /// sliding. `None` leaves swings unchanged.
    pub clearance_m: Option<f32>,
}

impl Default for FootLockOptions {
    fn default() -> Self {
        Self { blend_secs: 0.2, max_shift_m: 0.3, ground_m: Some(0.0), clearance_m: Some(0.025) }
    }
}

/// Error of the foot lock.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum FootLockError {
    /// The skeleton has no leg of thigh, shin and foot, one below the other.
    #[error(
        "this skeleton has no leg with thigh, shin and foot: set these body parts to lock its feet"
    )]
    NoLegs,
    /// The contacts have another number of frames than the clip.
    #[error(
        "the contacts are known for {contacts} frames, but the clip has {frames}: detect them on this clip"
    )]
    Contacts {
        /// Frames of the contacts.
        contacts: usize,
        /// Frames of the clip.
        frames: usize,
    },
    /// A number out of range.
    #[error("a {what} of {value} cannot be used: give a number from 0 to {most}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The largest number.
        most: f64,
    },
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// Plants the feet: a foot does not slide while it is planted according to `contacts`. These have
/// two feet, or the four of a body on four legs, whose forelegs are its arms.
///
/// *Planted feet.* In every step between two planted frames the point of the foot (ball, tip, or
/// ankle; the ankle alone where there are no toes) that moves least over the ground is taken as
/// standing. The foot is moved so that this point stands exactly; its rotation stays, so that it
/// still rolls from heel to ball to tip, and stays as flat as in the clip. This determines the
/// foot's position over a stance up to a constant, which is chosen so that the correction vanishes
/// where the foot is stillest: a mean over the stance with weights of inverse squared speed. Points
/// below the ground are lifted above it. Before and after a stance the correction decays from its
/// own velocity ([`Decay::Cubic`](crate::math::Decay)), so that the foot does not jerk off the
/// ground.
///
/// *Swinging feet.* Where the foot swings from one stance to the next, each of its points is raised
/// smoothly to [`FootLockOptions::clearance_m`] above the height that it has in these stances,
/// while it moves faster than a slow step. Between two motions a foot may pass the ground lower
/// than in either.
///
/// *Legs.* Thigh and shin are rotated about the knee's own axis to bring the ankle to its target,
/// then the leg is swung the shortest way ([`two_bone_ik`](crate::skeleton::two_bone_ik)); joints
/// between hip, knee and ankle keep their local rotations. Only the *difference* to the solution
/// for the unchanged ankle is applied, so that the knee keeps its plane, also when it is nearly
/// straight.
///
/// *Hips.* A nearly straight leg has to bend a lot to become a little shorter, and cannot become
/// longer. The hips are raised or lowered to the height at which both knees change least (least
/// squares of the change of flexion), smoothed, and lowered further where a leg would have to
/// stretch past its reach; where even that is not enough, the foot slides.
///
/// Frames without a correction stay exactly the same. Cost: O(frames × joints), one pass of forward
/// kinematics.
///
/// # Errors
/// [`FootLockError`] when there are no legs, the contacts have another number of frames, or an
/// option is out of range.
pub fn foot_lock(
    clip: &Clip,
    roles: &Roles,
    contacts: &Contacts,
    options: &FootLockOptions,
) -> Result<Clip, FootLockError> {
    let mut state = State::new(clip, roles, contacts, options)?;
    while state.advance(clip, clip.frames()) {}
    state.finish(clip)
}

/// Returns whether a skeleton has a leg of thigh, shin and foot, one below the other, which a foot
/// lock needs.
#[must_use]
pub fn has_legs(skeleton: &Skeleton, roles: &Roles) -> bool {
    Side::BOTH.into_iter().any(|side| Limb::leg(skeleton, roles, side).is_some())
}

/// The computation of [`foot_lock`] in slices, for long clips.
#[derive(Debug)]
pub struct FootLocking {
    clip: Arc<Clip>,
    state: State,
}

impl FootLocking {
    /// Prepares the foot lock. Nothing is computed yet: call [`advance`](Self::advance).
    ///
    /// # Errors
    /// The same as for [`foot_lock`].
    pub fn new(
        clip: Arc<Clip>,
        roles: &Roles,
        contacts: &Contacts,
        options: &FootLockOptions,
    ) -> Result<Self, FootLockError> {
        let state = State::new(&clip, roles, contacts, options)?;
        Ok(Self { clip, state })
    }

    /// Sets the yaw by which the whole body was turned in every frame, as on a bent path, radians;
    /// missing frames count as 0. A planted foot does not turn with the body: in its stances it is
    /// turned back, by up to 30°, about the vertical. Its own rotation stays.
    ///
    /// Call this before the first [`advance`](Self::advance).
    #[must_use]
    pub fn with_body_yaws(mut self, yaws_radians: &[f64]) -> Self {
        self.state.body_yaws = yaws_radians.to_vec();
        self
    }

    /// Processes up to `frames` more frames (at least one). Returns `false` when nothing is left to
    /// do. A frame of 31 joints takes 2 µs, in each of two passes. Between the passes, each call
    /// computes the corrections of one foot, in all frames at once.
    pub fn advance(&mut self, frames: usize) -> bool {
        self.state.advance(&self.clip, frames)
    }

    /// Returns the progress, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f32 {
        let frames = self.clip.frames().max(1) as f32;
        let turned = self.state.plan.as_ref().map_or(0, |plan| plan.turned);
        (self.state.posed_frames() + turned) as f32 / (2.0 * frames)
    }

    /// Computes the remaining frames and returns the clip with planted feet.
    ///
    /// # Errors
    /// The same as for [`foot_lock`].
    pub fn finish(mut self) -> Result<Clip, FootLockError> {
        while self.advance(self.clip.frames()) {}
        self.state.finish(&self.clip)
    }
}

/// The measurements of a clip whose feet are being planted.
#[derive(Debug)]
struct State {
    options: FootLockOptions,
    scale: f32,
    stances: Vec<Vec<Range<usize>>>,
    legs: Vec<Limb>,
    feet: Vec<anchor::Foot>,
    posed: Vec<Vec<LimbPose>>,
    body_yaws: Vec<f64>,
    /// For each foot so far, its shifts, metres, and its turns as rotation vectors, radians, in
    /// every frame. One foot is computed in a slice, after all frames are posed.
    corrections: Vec<(Vec<Vec3>, Vec<Vec3>)>,
    /// Computed when every foot has its corrections.
    plan: Option<Plan>,
}

/// The corrections, and the results so far.
#[derive(Debug)]
struct Plan {
    shifts: Vec<Vec<Vec3>>,
    /// Rotations of the feet, as rotation vectors.
    turns: Vec<Vec<Vec3>>,
    heights: Vec<f32>,
    axes: Vec<Vec3>,
    rotations: Vec<Quat>,
    /// Number of frames that are done.
    turned: usize,
    /// Whether no foot needs a correction.
    is_idle: bool,
}

impl State {
    fn new(
        clip: &Clip,
        roles: &Roles,
        contacts: &Contacts,
        options: &FootLockOptions,
    ) -> Result<Self, FootLockError> {
        let check = |what, value: f64, most: f64| {
            let fits = (0.0..=most).contains(&value);
            if fits { Ok(()) } else { Err(FootLockError::Option { what, value, most }) }
        };
        check("blend time (s)", options.blend_secs, MAX_SECS)?;
        check("largest shift (m)", f64::from(options.max_shift_m), 10.0)?;
        check("clearance (m)", f64::from(options.clearance_m.unwrap_or(0.0)), 1.0)?;
        let leg = |&foot: &Foot| Some((foot, Limb::on(clip.skeleton(), roles, foot)?));
        // The contacts may be those of a clip of another body.
        let of_both = Foot::of(roles.body_plan()).iter().zip(contacts.feet());
        let (feet, legs): (Vec<Foot>, Vec<Limb>) =
            of_both.filter_map(|(foot, _)| leg(foot)).unzip();
        if legs.is_empty() {
            return Err(FootLockError::NoLegs);
        }
        if contacts.frames() != clip.frames() {
            let (contacts, frames) = (contacts.frames(), clip.frames());
            return Err(FootLockError::Contacts { contacts, frames });
        }
        Ok(Self {
            options: *options,
            scale: roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M as f32,
            stances: feet.iter().map(|foot| contacts.intervals(*foot)).collect(),
            feet: (feet.iter().zip(&legs))
                .map(|(foot, leg)| anchor::Foot::new(clip, roles, *foot, leg.joints()[2]))
                .collect(),
            posed: legs.iter().map(|_| Vec::with_capacity(clip.frames())).collect(),
            body_yaws: Vec::new(),
            corrections: Vec::new(),
            legs,
            plan: None,
        })
    }

    fn posed_frames(&self) -> usize {
        self.posed.first().map_or(0, Vec::len)
    }

    /// Processes up to `frames` more frames. Returns `false` when nothing is left to do.
    fn advance(&mut self, clip: &Clip, frames: usize) -> bool {
        let (posed, last) = (self.posed_frames(), clip.frames());
        let end = |done: usize| done.saturating_add(frames.max(1)).min(last);
        if posed < last {
            self.pose(clip, posed..end(posed));
            return true;
        }
        let Some(plan) = &mut self.plan else {
            match self.feet.get(self.corrections.len()) {
                Some(foot) => self.corrections.push(self.correction(foot, clip.fps())),
                None => self.plan = Some(self.plan(clip)),
            }
            return true;
        };
        if plan.is_idle || plan.turned >= last {
            return false;
        }
        for frame in plan.turned..end(plan.turned) {
            let first = plan.rotations.len();
            plan.rotations.extend_from_slice(clip.rotations(frame));
            let (local, height) = (&mut plan.rotations[first..], plan.heights[frame]);
            for (index, leg) in self.legs.iter().enumerate() {
                let (shift, turn) = (plan.shifts[index][frame], plan.turns[index][frame]);
                if shift != Vec3::ZERO || turn != Vec3::ZERO || height != 0.0 {
                    let [upper, lower] =
                        self.posed[index][frame].turned(shift - Vec3::Y * height, plan.axes[index]);
                    let turns = [upper, lower, Quat::from_scaled_axis(turn)];
                    leg.write(&self.posed[index][frame], turns, local);
                }
            }
        }
        plan.turned = end(plan.turned);
        true
    }

    fn pose(&mut self, clip: &Clip, frames: Range<usize>) {
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_into(frame, &mut world);
            for ((leg, posed), foot) in self.legs.iter().zip(&mut self.posed).zip(&mut self.feet) {
                posed.push(leg.pose(&world));
                foot.push(&world);
            }
        }
    }

    /// Returns the shifts and turns of a foot, the one after those in `corrections`, in every
    /// frame.
    fn correction(&self, foot: &anchor::Foot, fps: f64) -> (Vec<Vec3>, Vec<Vec3>) {
        let stances = self.stances.get(self.corrections.len()).map_or(&[][..], Vec::as_slice);
        let stances = foot.merged(stances, fps, self.scale);
        let turns = foot.turns(&stances, &self.body_yaws, fps, &self.options);
        let shifts = |foot: &anchor::Foot| foot.shifts(&stances, fps, self.scale, &self.options);
        let stays = turns.iter().all(|turn| *turn == Vec3::ZERO);
        (if stays { shifts(foot) } else { shifts(&foot.turned(&turns)) }, turns)
    }

    fn plan(&mut self, clip: &Clip) -> Plan {
        let (shifts, turns): (Vec<Vec<Vec3>>, Vec<Vec<Vec3>>) =
            std::mem::take(&mut self.corrections).into_iter().unzip();
        let is_idle = shifts.iter().chain(&turns).flatten().all(|value| *value == Vec3::ZERO);
        Plan {
            heights: hips::heights(&self.posed, &shifts, clip.fps()),
            axes: (self.legs.iter().zip(&self.posed))
                .map(|(leg, posed)| leg.usual_axis(posed.iter().copied()))
                .collect(),
            rotations: Vec::with_capacity(if is_idle {
                0
            } else {
                clip.frames() * clip.skeleton().len()
            }),
            turned: 0,
            shifts,
            turns,
            is_idle,
        }
    }

    fn finish(self, clip: &Clip) -> Result<Clip, FootLockError> {
        let Some(plan) = self.plan.filter(|plan| !plan.is_idle) else {
            return Ok(clip.clone());
        };
        let mut roots = clip.root_translations().to_vec();
        for (root, height) in roots.iter_mut().zip(&plan.heights) {
            root.y += height;
        }
        let locked =
            Clip::new(clip.name(), clip.skeleton().clone(), clip.fps(), plan.rotations, roots)?;
        Ok(locked
            .with_translations(clip.translations().to_vec())?
            .with_provenance(clip.provenance()))
    }
}

#[cfg(test)]
mod tests;
