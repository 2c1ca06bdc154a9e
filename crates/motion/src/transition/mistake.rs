//! The classic mistakes of transitions, made on purpose: what each looks like is easier learned
//! from the picture than from the formula.
//!
//! Nothing here is on the way of a right transition. A mistake of placing moves B before the right
//! code runs, or turns one of its options; a mistake of interpolating makes the right transition
//! and then puts its own rotations into the frames that were mixed.

use super::concatenate::inertialize;
use super::moving::{MovingPose, View};
use super::{Inertialization, Method, TransitionOptions, concatenate};
use crate::blend::{
    BlendError, Concatenation, RootBlend, Source, WeightLaw, align_facing, alignment_of,
};
use crate::clip::Clip;
use crate::math::{Decay, Planar, quat, spring, wrap_angle};
use crate::registration::limb_weights;
use glam::{DVec2, EulerRot, Quat, Vec3};
use std::f64::consts::PI;

/// A mistake that nearly everybody makes once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Mistake {
    /// Quaternions are mixed with the signs that they come with. Half of B's joints (every second
    /// one) come with the other sign: the same rotations, as files may hold them; without the check
    /// for the nearer of `q` and `-q` they go the long way round.
    NoHemisphereCheck,
    /// Three Euler angles (Z, Y, X) are mixed, or decay, each for itself.
    EulerLerp,
    /// The difference of two rotations is told in degrees and used as if it were in radians.
    DegreesForRadians,
    /// The turn that lays B on A is `atan(A / B)`: half of all turns are off by half a turn. So
    /// that it shows, B is taken to face the other way in its file where it does not do so already.
    AtanForAtan2,
    /// The turn that lays B on A is told in degrees and used as if it were in radians. B is taken
    /// to face the other way in its file, as for [`Self::AtanForAtan2`].
    DegreesInTransform,
    /// B is laid on A by the first posture, and what counts as its facing is the root's own Y axis,
    /// `rotation · Y`. That axis points up, so that its shadow on the ground says which way the
    /// hips tilt.
    WrongFacingAxis,
    /// B stays where its file has it.
    NoAlignment,
    /// Differences from frame to frame are divided by the frame rate where they must be multiplied
    /// by it to be velocities. A dissolve has only the velocity over the ground to do that to, and
    /// is made with it.
    VelocityDividedTwice,
    /// Where A and B are in the world is mixed instead of how they go.
    WorldRoot,
}

impl Mistake {
    /// All of them, for a list to choose from.
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

    /// Whether a method gives the mistake an opportunity: a cut mixes nothing, and can only be laid
    /// down wrongly.
    #[must_use]
    pub fn concerns(self, method: &Method) -> bool {
        let mixes = match method {
            Method::Cut => false,
            Method::Dissolve { window, .. } => *window > 1,
            Method::Inertialize(_) => true,
        };
        mixes || self.is_of_placing() || self == Self::NoAlignment
    }

    /// Whether B is laid on A by a wrong transform.
    fn is_of_placing(self) -> bool {
        matches!(self, Self::AtanForAtan2 | Self::DegreesInTransform | Self::WrongFacingAxis)
    }
}

/// [`concatenate`] with one mistake in it. A method that the mistake does not
/// [concern](Mistake::concerns) comes out right.
///
/// # Errors
/// As [`concatenate`].
pub fn concatenate_mistaken(
    a: &Source,
    leave: usize,
    b: &Source,
    enter: usize,
    options: &TransitionOptions,
    mistake: Mistake,
) -> Result<Concatenation, BlendError> {
    let right = |options: &TransitionOptions| concatenate(a, leave, b, enter, options);
    if !mistake.concerns(&options.method) {
        return right(options);
    }
    let mixed = |mix| Mixing::new(a, leave, b, enter, options, mix).mixed(right(options)?);
    match mistake {
        Mistake::NoHemisphereCheck => mixed(Mix::AsSigned),
        Mistake::EulerLerp => mixed(Mix::Euler),
        Mistake::DegreesForRadians => mixed(Mix::Degrees),
        Mistake::AtanForAtan2 | Mistake::DegreesInTransform | Mistake::WrongFacingAxis => {
            laid_wrongly(a, leave, b, enter, options, mistake)
        }
        Mistake::NoAlignment => right(&TransitionOptions { align: false, ..*options }),
        Mistake::VelocityDividedTwice => {
            if let Method::Inertialize(how) = options.method {
                return inertialize(a, leave, b, enter, how, options, divided_again);
            }
            let (align, root) = (true, RootBlend::Velocity);
            standing_still(right(&TransitionOptions { align, root, ..*options })?)
        }
        Mistake::WorldRoot => {
            let (align, root) = (true, RootBlend::World);
            right(&TransitionOptions { align, root, ..*options })
        }
    }
}

/// How the difference of two rotations is told, and how it is put on one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mix {
    AsSigned,
    Euler,
    Degrees,
    /// The right way, to hold this file's frames and weights against those of the right code.
    #[cfg(test)]
    Right,
}

impl Mix {
    /// What lies between a joint's rotation in B and its rotation in A.
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

    /// How fast the difference changes, per second.
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

    /// A joint's rotation in B with a difference on it.
    fn on(self, difference: Vec3, b: Quat) -> Quat {
        if self == Self::Euler {
            let sum = angles(b) + difference;
            return Quat::from_euler(EulerRot::ZYX, sum.x, sum.y, sum.z);
        }
        quat::renormalize(quat::exp(difference) * b)
    }
}

/// The angles about Z, Y and X, in the order that most files have them, radians.
fn angles(q: Quat) -> Vec3 {
    Vec3::from(q.to_euler(EulerRot::ZYX))
}

/// A transition whose joints are mixed in another way.
struct Mixing<'a> {
    a: &'a Source,
    leave: usize,
    b: &'a Source,
    enter: usize,
    options: &'a TransitionOptions,
    mix: Mix,
    /// Poses are mixed in the character's frame, not in the world.
    in_character: bool,
}

impl<'a> Mixing<'a> {
    fn new(
        a: &'a Source,
        leave: usize,
        b: &'a Source,
        enter: usize,
        options: &'a TransitionOptions,
        mix: Mix,
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

    fn view(&self, source: &'a Source, fixed: Planar) -> View<'a> {
        View { source, moving: &[], fixed: (!self.in_character).then_some(fixed) }
    }

    /// The transition with its rotations mixed anew.
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
                let left = match self.options.method {
                    Method::Cut => Vec3::ZERO,
                    Method::Dissolve { window, law } => {
                        self.mix.difference(joint, of_a[joint], b) * weight(law, p, window)
                    }
                    Method::Inertialize(how) => self.left(how, joint, b, &parting, &meeting, p),
                };
                *made = quat::renormalize(here * self.mix.on(left, b));
            }
        }
        with_rotations(right, rotations)
    }

    /// What an inertialization has left of the difference in its frame `p`.
    fn left(
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
                self.mix.difference(joint, running, b) * how.left(secs) as f32
            }
        }
    }

    /// The frames in which something of A is left.
    fn frames(&self, right: &Concatenation) -> usize {
        match self.options.method {
            Method::Inertialize(how) => {
                (how.settled_secs() * self.b.clip().fps()).ceil() as usize + 1
            }
            _ => right.transition.len(),
        }
    }
}

/// A's weight in frame `p` of a dissolve.
fn weight(law: WeightLaw, p: usize, window: usize) -> f32 {
    law.alpha((p + 1) as f64 / window as f64) as f32
}

fn rotations_of(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).iter().copied()).collect()
}

fn with_rotations(right: Concatenation, rotations: Vec<Quat>) -> Result<Concatenation, BlendError> {
    let roots = right.clip.root_translations().to_vec();
    let clip = rebuilt(&right.clip, rotations, roots)?;
    Ok(Concatenation { clip, ..right })
}

fn rebuilt(clip: &Clip, rotations: Vec<Quat>, roots: Vec<Vec3>) -> Result<Clip, BlendError> {
    let made = Clip::new(clip.name(), clip.skeleton().clone(), clip.fps(), rotations, roots)?;
    Ok(made.with_translations(clip.translations().to_vec())?.with_provenance(clip.provenance()))
}

/// Lays B on A by a wrong transform, and leaves it there.
fn laid_wrongly(
    a: &Source,
    leave: usize,
    b: &Source,
    enter: usize,
    options: &TransitionOptions,
    mistake: Mistake,
) -> Result<Concatenation, BlendError> {
    // Refuses what cannot be joined, before its frames are looked at.
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
        turned_wrongly(&right, middle(b.clip(), enter, window), turn)
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

/// What a program finds that writes `atan(A / B)`.
fn by_atan(yaw: f64) -> f64 {
    (yaw.sin() / yaw.cos()).atan()
}

/// What a program turns by that hands degrees to a function of radians.
fn by_degrees(yaw: f64) -> f64 {
    wrap_angle(wrap_angle(yaw).to_degrees())
}

/// Where the character stands, facing along the shadow of its root's Y axis.
fn standing_by_y(source: &Source, frame: usize) -> Planar {
    let axis = source.clip().rotations(frame).first().map_or(Vec3::Y, |root| *root * Vec3::Y);
    Planar { yaw: f64::from(axis.x).atan2(axis.z.into()), ..source.frames()[frame] }
}

/// The alignment of a program that gets the angle wrong: the right one, with the point cloud turned
/// about its middle by another angle.
fn turned_wrongly(right: &Planar, middle: DVec2, wrong: fn(f64) -> f64) -> Planar {
    // As if B's file had it face the other way: the turn is one that hides no mistake.
    let facing = if right.yaw.cos() > 0.0 { PI } else { 0.0 };
    let mistaken = wrong(right.yaw - facing) + facing;
    let turned = |yaw: f64| Planar { yaw, shift: DVec2::ZERO };
    let to = right.after(&Planar { yaw: 0.0, shift: middle });
    let back = turned(mistaken).after(&Planar { yaw: 0.0, shift: -middle });
    Planar { yaw: back.yaw, shift: back.shift + to.shift }
}

/// The middle of the point cloud that an alignment looks at, on the ground.
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

/// Velocities as they are when the difference of two frames is divided by the frame rate.
fn divided_again(pose: &mut MovingPose, fps: f64) {
    let by = (fps * fps).recip() as f32;
    for velocity in pose.angular_velocities.iter_mut().chain(&mut pose.velocities) {
        *velocity *= by;
    }
    pose.travel *= by;
    pose.steady_travel *= by;
}

/// A dissolve whose character goes over the ground with velocities that were divided by the frame
/// rate where they had to be multiplied.
fn standing_still(right: Concatenation) -> Result<Concatenation, BlendError> {
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
        clip: rebuilt(&right.clip, rotations, roots)?,
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
