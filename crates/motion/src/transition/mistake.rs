//! The classic mistakes of transitions, made on purpose, to show their effect.
//!
//! The code of correct transitions is not involved. A mistake of alignment moves B before the
//! correct code runs, or changes one of its options; a mistake of interpolation makes the correct
//! transition and then replaces the rotations of the mixed frames by its own.

use super::concatenate::inertialize;
use super::moving::{MovingPose, View};
use super::{Inertialization, Method, TransitionOptions, concatenate};
use crate::blend::{BlendError, Concatenation, RootBlend, WeightLaw, align_facing, alignment_of};
use crate::clip::{Clip, Motion};
use crate::math::{Decay, Planar, quat, spring, wrap_angle};
use crate::registration::limb_weights;
use glam::{DVec2, EulerRot, Quat, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A common mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Mistake {
    /// Quaternions are mixed without choosing the nearer of `q` and `-q`, so that half of B's
    /// joints turn the long way round. Every second joint of B is given the other sign, which is
    /// the same rotation, as files may hold it.
    NoHemisphereCheck,
    /// Three Euler angles (Z, Y, X) are mixed, or decay, separately.
    EulerLerp,
    /// The difference of two rotations is computed in degrees and used as radians.
    DegreesForRadians,
    /// The yaw that aligns B with A is `atan(A / B)`: half of all yaws are off by half a turn. To
    /// show the effect, B's file is treated as facing the other way where necessary.
    AtanForAtan2,
    /// The yaw that aligns B with A is computed in degrees and used as radians. B's file is treated
    /// as facing the other way, as for [`Self::AtanForAtan2`].
    DegreesInTransform,
    /// B is aligned with A by the first frame, with the root's own Y axis, `rotation · Y`, taken as
    /// its facing. That axis points up, so that its projection on the ground is the direction in
    /// which the hips tilt.
    WrongFacingAxis,
    /// B stays at its own position.
    NoAlignment,
    /// Differences from frame to frame are divided by the frame rate where they must be multiplied
    /// by it to be velocities. In a dissolve this concerns only the velocity over the ground.
    VelocityDividedTwice,
    /// The world positions of A and B are mixed instead of their velocities.
    WorldRoot,
}

impl Mistake {
    /// All mistakes, for a list of choices.
    pub const ALL: [Self; 9] = [
        Self::NoHemisphereCheck,
        Self::EulerLerp,
        Self::DegreesForRadians,
        Self::AtanForAtan2,
        Self::DegreesInTransform,
        Self::WrongFacingAxis,
        Self::NoAlignment,
        Self::VelocityDividedTwice,
        Self::WorldRoot,
    ];

    /// Returns whether a mistake can be made with a method: a cut mixes nothing, and can only be
    /// aligned wrongly.
    #[must_use]
    pub fn concerns(self, method: &Method) -> bool {
        let mixes = match method {
            Method::Cut => false,
            Method::Dissolve { window, .. } => *window > 1,
            Method::Inertialize(_) => true,
        };
        mixes || self.is_of_alignment() || self == Self::NoAlignment
    }

    /// Returns whether the mistake is a wrong alignment.
    fn is_of_alignment(self) -> bool {
        matches!(self, Self::AtanForAtan2 | Self::DegreesInTransform | Self::WrongFacingAxis)
    }
}

/// Makes a transition as [`concatenate()`] does, with one mistake. A method that the mistake does
/// not [concern](Mistake::concerns) gives the correct result.
///
/// # Errors
/// The same as for [`concatenate()`].
pub fn concatenate_mistaken(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    options: &TransitionOptions,
    mistake: Mistake,
) -> Result<Concatenation, BlendError> {
    let right = |options: &TransitionOptions| concatenate(a, leave, b, enter, options);
    if !mistake.concerns(&options.method) {
        return right(options);
    }
    let mixed = |mix| RotationMixing::new(a, leave, b, enter, options, mix).mixed(right(options)?);
    match mistake {
        Mistake::NoHemisphereCheck => mixed(RotationMix::AsSigned),
        Mistake::EulerLerp => mixed(RotationMix::Euler),
        Mistake::DegreesForRadians => mixed(RotationMix::Degrees),
        Mistake::AtanForAtan2 | Mistake::DegreesInTransform | Mistake::WrongFacingAxis => {
            with_wrong_alignment(a, leave, b, enter, options, mistake)
        }
        Mistake::NoAlignment => right(&TransitionOptions { align: false, ..*options }),
        Mistake::VelocityDividedTwice => {
            if let Method::Inertialize(how) = options.method {
                return inertialize(a, leave, b, enter, how, options, divided_again);
            }
            let (align, root) = (true, RootBlend::Velocity);
            with_divided_velocity(right(&TransitionOptions { align, root, ..*options })?)
        }
        Mistake::WorldRoot => {
            let (align, root) = (true, RootBlend::World);
            right(&TransitionOptions { align, root, ..*options })
        }
    }
}

/// The representation of the difference of two rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RotationMix {
    AsSigned,
    Euler,
    Degrees,
    /// The correct one, to verify this file's frames and weights against the correct code.
    #[cfg(test)]
    Right,
}

impl RotationMix {
    /// Returns the difference between a joint's rotation in B and in A.
    fn difference(self, joint: usize, a: Quat, b: Quat) -> Vec3 {
        match self {
            Self::AsSigned => {
                let signed = if joint % 2 == 1 { -b } else { b };
                quat::log_as_given(a * signed.conjugate())
            }
            Self::Euler => angles(a) - angles(b),
            Self::Degrees => quat::log(a * b.conjugate()) * 1f32.to_degrees(),
            #[cfg(test)]
            Self::Right => quat::log(a * b.conjugate()),
        }
    }

    /// Returns the rate of the difference, per second.
    fn rate(
        self,
        joint: usize,
        [a, b]: [Quat; 2],
        [a_velocity, b_velocity]: [Vec3; 2],
        dt_secs: f32,
    ) -> Vec3 {
        let rate =
            |vector| quat::vector_rate(vector, a_velocity - (a * b.conjugate()) * b_velocity);
        match self {
            Self::Euler => {
                let next = |q: Quat, velocity: Vec3| quat::exp(velocity * dt_secs) * q;
                let after = self.difference(joint, next(a, a_velocity), next(b, b_velocity));
                (after - self.difference(joint, a, b)) / dt_secs
            }
            Self::Degrees => rate(quat::log(a * b.conjugate())) * 1f32.to_degrees(),
            Self::AsSigned => rate(self.difference(joint, a, b)),
            #[cfg(test)]
            Self::Right => rate(self.difference(joint, a, b)),
        }
    }

    /// Returns a joint's rotation in B with a difference applied.
    fn on(self, difference: Vec3, b: Quat) -> Quat {
        if self == Self::Euler {
            let sum = angles(b) + difference;
            return Quat::from_euler(EulerRot::ZYX, sum.x, sum.y, sum.z);
        }
        quat::renormalize(quat::exp(difference) * b)
    }
}

/// Returns the angles about Z, Y and X, in the usual order of files, radians.
fn angles(q: Quat) -> Vec3 {
    Vec3::from(q.to_euler(EulerRot::ZYX))
}

/// A transition whose joints are mixed in another way.
struct RotationMixing<'a> {
    a: &'a Motion,
    leave: usize,
    b: &'a Motion,
    enter: usize,
    options: &'a TransitionOptions,
    mix: RotationMix,
    /// Whether poses are mixed in the character's frame, not in the world.
    in_character: bool,
}

impl<'a> RotationMixing<'a> {
    fn new(
        a: &'a Motion,
        leave: usize,
        b: &'a Motion,
        enter: usize,
        options: &'a TransitionOptions,
        mix: RotationMix,
    ) -> Self {
        Self {
            a,
            leave,
            b,
            enter,
            options,
            mix,
            in_character: options.align && options.root == RootBlend::Velocity,
        }
    }

    fn view(&self, source: &'a Motion, fixed: Planar) -> View<'a> {
        View { source, moving: &[], fixed: (!self.in_character).then_some(fixed) }
    }

    /// Returns the transition with its rotations mixed again.
    fn mixed(&self, right: Concatenation) -> Result<Concatenation, BlendError> {
        let (old, new) = (self.view(self.a, Planar::IDENTITY), self.view(self.b, right.aligned_b));
        let joints = right.clip.skeleton().len();
        let mut rotations = rotations_of(&right.clip);
        let (mut of_a, mut of_b, mut unused) = (Vec::new(), Vec::new(), Vec::new());
        let (parting, _) = old.before(self.leave);
        let (meeting, _) = new.before(self.enter);
        for (p, made) in
            rotations.chunks_mut(joints).skip(self.leave).take(self.frames(&right)).enumerate()
        {
            new.pose_into(self.enter + p, &mut of_b, &mut unused);
            if let Method::Dissolve { .. } = self.options.method {
                old.pose_into(self.leave + p, &mut of_a, &mut unused);
            }
            let here = if self.in_character {
                right.frames[self.leave + p].rotation()
            } else {
                Quat::IDENTITY
            };
            for (joint, made) in made.iter_mut().enumerate() {
                let here = if joint == 0 { here } else { Quat::IDENTITY };
                let b = of_b[joint];
                let remaining = match self.options.method {
                    Method::Cut => Vec3::ZERO,
                    Method::Dissolve { window, law } => {
                        self.mix.difference(joint, of_a[joint], b) * weight(law, p, window)
                    }
                    Method::Inertialize(how) => {
                        self.remaining(how, joint, b, &parting, &meeting, p)
                    }
                };
                *made = quat::renormalize(here * self.mix.on(remaining, b));
            }
        }
        with_rotations(right, rotations)
    }

    /// Returns the rest of the difference in frame `p` of an inertialization.
    fn remaining(
        &self,
        how: Inertialization,
        joint: usize,
        b: Quat,
        old: &MovingPose,
        new: &MovingPose,
        p: usize,
    ) -> Vec3 {
        let fps = self.b.clip().fps();
        let secs = (p + 1) as f64 / fps;
        let (from, velocity) = (old.rotations[joint], old.angular_velocities[joint]);
        match how {
            Inertialization::Offset(decay) => {
                let (to, to_velocity) = (new.rotations[joint], new.angular_velocities[joint]);
                let rate =
                    self.mix.rate(joint, [from, to], [velocity, to_velocity], fps.recip() as f32);
                Decay::of_vec3(decay, self.mix.difference(joint, from, to), rate, secs).0
            }
            Inertialization::DeadBlend { extrapolation_half_life_secs, .. } => {
                let (_, run_on_secs) = spring::velocity_decay(extrapolation_half_life_secs, secs);
                let running = quat::exp(velocity * run_on_secs as f32) * from;
                self.mix.difference(joint, running, b) * how.remaining(secs) as f32
            }
        }
    }

    /// Returns the number of frames in which something of A is left.
    fn frames(&self, right: &Concatenation) -> usize {
        match self.options.method {
            Method::Inertialize(how) => {
                (how.settling_secs() * self.b.clip().fps()).ceil() as usize + 1
            }
            _ => right.transition.len(),
        }
    }
}

/// Returns A's weight in frame `p` of a dissolve.
fn weight(law: WeightLaw, p: usize, window: usize) -> f32 {
    law.alpha((p + 1) as f64 / window as f64) as f32
}

fn rotations_of(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied()).collect()
}

fn with_rotations(right: Concatenation, rotations: Vec<Quat>) -> Result<Concatenation, BlendError> {
    let roots = right.clip.root_translations().to_vec();
    let clip = rebuilt(&right.clip, rotations, roots)?;
    Ok(Concatenation { clip: Arc::new(clip), ..right })
}

fn rebuilt(clip: &Clip, rotations: Vec<Quat>, roots: Vec<Vec3>) -> Result<Clip, BlendError> {
    let made = Clip::new(clip.name(), clip.skeleton().clone(), clip.fps(), rotations, roots)?;
    Ok(made.with_translations(clip.translations().to_vec())?.with_provenance(clip.provenance()))
}

/// Aligns B with A by a wrong transform, and makes the transition without further alignment.
fn with_wrong_alignment(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    options: &TransitionOptions,
    mistake: Mistake,
) -> Result<Concatenation, BlendError> {
    // Refuses incompatible clips before their frames are read.
    concatenate(a, leave, b, enter, options)?;
    let window = match options.method {
        Method::Dissolve { window, .. } if window > 1 => window,
        _ => 1,
    };
    let meets = leave.min(a.clip().frames().saturating_sub(1));
    let wrong = if mistake == Mistake::WrongFacingAxis {
        align_facing(&standing_by_y(a, meets), &standing_by_y(b, enter))
    } else {
        let right = alignment_of(a, meets, b, enter, window, options.align_by)?;
        let turn = if mistake == Mistake::AtanForAtan2 { by_atan } else { by_degrees };
        with_wrong_yaw(&right, middle(b.clip(), enter, window), turn)
    };
    let made = concatenate(
        a,
        leave,
        &b.moved(&wrong),
        enter,
        &TransitionOptions { align: false, ..*options },
    )?;
    let placed = |world_from_moved: &Planar| world_from_moved.after(&wrong);
    Ok(Concatenation {
        aligned_b: placed(&made.aligned_b),
        b_during: made.b_during.iter().map(placed).collect(),
        world_from_b: placed(&made.world_from_b),
        ..made
    })
}

/// Returns the yaw of a program that uses `atan(A / B)`.
fn by_atan(yaw: f64) -> f64 {
    libm::atan(libm::sin(yaw) / libm::cos(yaw))
}

/// Returns the yaw of a program that passes degrees as radians.
fn by_degrees(yaw: f64) -> f64 {
    wrap_angle(wrap_angle(yaw).to_degrees())
}

/// Returns the ground frame of a character whose facing is the projection of its root's Y axis.
fn standing_by_y(source: &Motion, frame: usize) -> Planar {
    let axis = source.clip().rotations(frame).first().map_or(Vec3::Y, |root| *root * Vec3::Y);
    Planar { yaw: libm::atan2(f64::from(axis.x), axis.z.into()), ..source.ground_frames()[frame] }
}

/// Returns the alignment of a program that gets the yaw wrong: the correct one, with the point
/// cloud rotated about its middle by another angle.
fn with_wrong_yaw(right: &Planar, middle: DVec2, wrong: fn(f64) -> f64) -> Planar {
    // B is treated as facing the other way if the mistake would otherwise have no effect.
    let facing = if libm::cos(right.yaw) > 0.0 { PI } else { 0.0 };
    let mistaken = wrong(right.yaw - facing) + facing;
    let turned = |yaw: f64| Planar { yaw, shift: DVec2::ZERO };
    let to = right.after(&Planar { yaw: 0.0, shift: middle });
    let back = turned(mistaken).after(&Planar { yaw: 0.0, shift: -middle });
    Planar { yaw: back.yaw, shift: back.shift + to.shift }
}

/// Returns the middle of the point cloud of an alignment, on the ground.
fn middle(clip: &Clip, frame: usize, window: usize) -> DVec2 {
    let weights = limb_weights(clip.skeleton());
    let points = clip.world_positions(frame..frame + window);
    let sum: DVec2 = points
        .iter()
        .zip(weights.iter().cycle())
        .map(|(p, &w)| w * DVec2::new(f64::from(p.x), f64::from(p.z)))
        .sum();
    let total: f64 = weights.iter().sum::<f64>() * window as f64;
    sum / total
}

/// Divides velocities by the square of the frame rate, as if differences of frames were divided by
/// the rate.
fn divided_again(pose: &mut MovingPose, fps: f64) {
    let by = (fps * fps).recip() as f32;
    for velocity in pose.angular_velocities.iter_mut().chain(&mut pose.velocities) {
        *velocity *= by;
    }
    pose.travel *= by;
    pose.steady_travel *= by;
}

/// Returns a dissolve whose character moves over the ground with velocities that were divided by
/// the frame rate instead of multiplied.
fn with_divided_velocity(right: Concatenation) -> Result<Concatenation, BlendError> {
    let by = (right.clip.fps() * right.clip.fps()).recip();
    let window = right.transition.clone();
    let (mut frames, mut moved) =
        (Vec::with_capacity(right.frames.len()), Vec::with_capacity(right.frames.len()));
    for (frame, right_here) in right.frames.iter().enumerate() {
        let here = match (frame.checked_sub(1), frames.last()) {
            (Some(before), Some(here)) => {
                let step = right.frames[before].inverse().after(right_here);
                let by = if window.contains(&frame) { by } else { 1.0 };
                Planar::after(here, &Planar { yaw: step.yaw * by, shift: step.shift * by })
            }
            _ => *right_here,
        };
        moved.push(if frame < window.start {
            Planar::IDENTITY
        } else {
            here.after(&right_here.inverse())
        });
        frames.push(here);
    }
    let joints = right.clip.skeleton().len();
    let mut rotations = rotations_of(&right.clip);
    let mut roots = right.clip.root_translations().to_vec();
    for ((pose, root), moved) in rotations.chunks_mut(joints).zip(&mut roots).zip(&moved) {
        *root = moved.apply(*root);
        pose[0] = quat::renormalize(moved.rotation() * pose[0]);
    }
    let placed = |frame: usize, b: &Planar| moved.get(frame).map_or(*b, |moved| moved.after(b));
    Ok(Concatenation {
        clip: Arc::new(rebuilt(&right.clip, rotations, roots)?),
        b_during: right
            .b_during
            .iter()
            .enumerate()
            .map(|(p, b)| placed(window.start + p, b))
            .collect(),
        world_from_b: placed(window.end.max(1) - 1, &right.world_from_b),
        frames,
        ..right
    })
}

#[cfg(test)]
mod tests;
