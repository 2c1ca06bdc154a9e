//! The dissolve: a transition in which A fades out while B fades in.

use super::assembly::{Assembly, moving_joints, translation_of};
use super::{BlendError, Concatenation, WeightLaw, align_facing, align_onto};
use crate::clip::{Clip, Motion};
use crate::math::{Planar, quat, unwrap_near, wrap_angle};
use crate::registration::limb_weights;
use crate::skeleton::Skeleton;
use glam::{DVec2, Quat, Vec3};
use std::sync::Arc;

/// The blending of root motion.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum RootBlend {
    /// Forward speed, sideways speed and yaw rate are blended in the character's own frame and
    /// integrated from the frame at which A is left.
    #[default]
    Velocity,
    /// The two roots are interpolated in the world. For comparison: where the trajectories differ,
    /// the speed drops.
    World,
}

/// The features by which B is aligned with A.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum AlignBy {
    /// All joints over the whole window: the least squares of Kovar, Gleicher, Pighin 2002, section
    /// 3.1 ([`align_onto`]).
    #[default]
    Window,
    /// Position and facing in the first frame alone ([`align_facing`]).
    FirstPose,
}

/// Options of a dissolve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct DissolveOptions {
    /// Number of frames that overlap. 0 and 1 are a cut.
    pub window: usize,
    /// The curve of A's weight.
    pub law: WeightLaw,
    /// Whether B is first aligned with A. Without alignment, B stays at its own position, and roots
    /// are blended in the world for any value of `root`: the character glides to B's position
    /// during the window, or jumps there at a cut.
    pub align: bool,
    /// The features by which it is aligned.
    pub align_by: AlignBy,
    /// The blending of root motion.
    pub root: RootBlend,
}

impl Default for DissolveOptions {
    fn default() -> Self {
        Self {
            window: 30,
            law: WeightLaw::default(),
            align: true,
            align_by: AlignBy::default(),
            root: RootBlend::default(),
        }
    }
}

/// Dissolves from clip A to clip B: frame `leave` of A and frame `enter` of B are the first of
/// `options.window` overlapping frames.
///
/// The weight of A in frame p of a window of k is `law((p + 1) / k)`: the frame before the window
/// is all A, its last frame is all B (Kovar, Gleicher, Pighin 2002, section 3.3). Local rotations
/// slerp by the shorter way, translations and heights lerp. With [`RootBlend::Velocity`], poses are
/// blended in the character's frame, and the character's steps (forward, sideways, yaw; each step
/// at the weight of its middle) are blended and integrated from A's last frame; B then continues
/// rigidly from there, without a jump. With [`RootBlend::World`] root positions and orientations
/// are interpolated in the world after B was aligned with A.
///
/// # Errors
/// [`BlendError`] when the clips have different skeletons or frame rates (retarget or resample
/// first), or a window crosses the end of its clip.
pub fn dissolve(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    options: &DissolveOptions,
) -> Result<Concatenation, BlendError> {
    let window = if options.window < 2 { 0 } else { options.window };
    check(a, leave, b, enter, window)?;
    // A cut right after A's last frame is aligned by that frame.
    let meets = leave.min(a.clip().frames().saturating_sub(1));
    let aligned_b = if options.align {
        alignment_of(a, meets, b, enter, window, options.align_by)?
    } else {
        Planar::IDENTITY
    };
    let blend = Blend { a, leave, b, enter, window, law: options.law };
    let by_velocity = options.align && options.root == RootBlend::Velocity;
    let turns = if by_velocity { Vec::new() } else { blend.turns(&aligned_b) };
    let frames_during =
        if by_velocity { blend.integrated() } else { blend.between(&aligned_b, &turns) };
    let (b_during, world_from_b) = if by_velocity {
        let during: Vec<Planar> = frames_during
            .iter()
            .zip(&b.ground_frames()[enter..])
            .map(|(here, in_b)| here.after(&in_b.inverse()))
            .collect();
        let end = during
            .last()
            .copied()
            .unwrap_or_else(|| blend.start().after(&b.ground_frames()[enter].inverse()));
        (during, end)
    } else {
        (vec![aligned_b; window], aligned_b)
    };
    let placing = if by_velocity {
        PosePlacement::Character(&frames_during)
    } else {
        PosePlacement::World(aligned_b, &turns)
    };
    let clip = blend.clip(&placing, &world_from_b)?;
    let mut frames = a.ground_frames()[..leave].to_vec();
    frames.extend(frames_during);
    frames
        .extend(b.ground_frames()[enter + window..].iter().map(|frame| world_from_b.after(frame)));
    Ok(Concatenation {
        clip: Arc::new(clip),
        transition: leave..leave + window,
        enter,
        handover: leave + window / 2,
        aligned_b,
        b_during,
        world_from_b,
        frames,
    })
}

/// Returns the transform that aligns B with A by the windows or by their first frames:
/// `a_world_from_b_world`.
pub(crate) fn alignment_of(
    a: &Motion,
    frame_a: usize,
    b: &Motion,
    frame_b: usize,
    window: usize,
    by: AlignBy,
) -> Result<Planar, BlendError> {
    if by == AlignBy::FirstPose {
        return Ok(align_facing(&a.ground_frames()[frame_a], &b.ground_frames()[frame_b]));
    }
    let facing = a.ground_frames()[frame_a].yaw - b.ground_frames()[frame_b].yaw;
    let weights = limb_weights(a.clip().skeleton());
    let window = window.max(1);
    Ok(align_onto(a.clip(), frame_a, b.clip(), frame_b, window, &weights, facing)?.transform)
}

/// Checks that B can follow A with this overlap.
pub(crate) fn check(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    window: usize,
) -> Result<(), BlendError> {
    check_bodies(a, b)?;
    // B must have at least one frame; A may end right before a cut.
    for (which, clip, at, window) in
        [("outgoing", a.clip(), leave, window), ("incoming", b.clip(), enter, window.max(1))]
    {
        let frames = clip.frames();
        if frames == 0 || at > frames || frames - at < window {
            return Err(BlendError::Window { which, frames, at, window });
        }
    }
    Ok(())
}

/// Checks that the clips have the same skeleton and frame rate.
pub(super) fn check_bodies(a: &Motion, b: &Motion) -> Result<(), BlendError> {
    let (a_fps, b_fps) = (a.clip().fps(), b.clip().fps());
    if !same_body(a.clip().skeleton(), b.clip().skeleton()) {
        return Err(BlendError::Skeletons { a: a.clip().name().into(), b: b.clip().name().into() });
    }
    if (a_fps - b_fps).abs() > 1e-4 * a_fps {
        return Err(BlendError::FrameRates { a_fps, b_fps });
    }
    Ok(())
}

/// Returns whether the joints have the same names and parents, and offsets that agree to a tenth of
/// a millimetre.
fn same_body(a: &Arc<Skeleton>, b: &Arc<Skeleton>) -> bool {
    Arc::ptr_eq(a, b)
        || (a.len() == b.len()
            && a.joints().iter().zip(b.joints()).enumerate().all(|(index, (a, b))| {
                // The root's rest offset is not used: its translation is given in every frame.
                a.parent == b.parent
                    && a.name == b.name
                    && (index == 0 || a.offset.abs_diff_eq(b.offset, 1e-4))
            }))
}

struct Blend<'a> {
    a: &'a Motion,
    leave: usize,
    b: &'a Motion,
    enter: usize,
    window: usize,
    law: WeightLaw,
}

/// The placement of the window's poses.
enum PosePlacement<'a> {
    /// Blended in the character's frame, then placed in these ground frames.
    Character(&'a [Planar]),
    /// Blended in the world, with B transformed, and the yaw from A to B in each frame.
    World(Planar, &'a [f64]),
}

impl Blend<'_> {
    /// Returns A's weight in frame `p` of the window, or at a time between frames.
    fn weight(&self, p: f64) -> f64 {
        self.law.alpha((p + 1.0) / self.window as f64)
    }

    /// Returns the ground frame after A's last one when the character makes B's step: the first
    /// frame after a cut.
    fn start(&self) -> Planar {
        match self.leave.checked_sub(1) {
            Some(last) => self.a.ground_frames()[last].after(&self.b.step_into(self.enter)),
            None => self.a.ground_frames()[0],
        }
    }

    /// Returns the ground frames in the window: steps blended in the character's frame, integrated
    /// from A's last frame before it.
    fn integrated(&self) -> Vec<Planar> {
        let mut here = self.leave.checked_sub(1).map(|last| self.a.ground_frames()[last]);
        (0..self.window)
            .map(|p| {
                let next = match here {
                    // The window starts with A's first frame.
                    None => self.a.ground_frames()[0],
                    Some(here) => {
                        let (a, b) =
                            (self.a.step_into(self.leave + p), self.b.step_into(self.enter + p));
                        here.after(&mixed(
                            &a,
                            &b,
                            wrap_angle(b.yaw - a.yaw),
                            self.weight(p as f64 - 0.5),
                        ))
                    }
                };
                here = Some(next);
                next
            })
            .collect()
    }

    /// Returns the yaw from A to B in every frame of the window, radians: the shorter way in the
    /// middle of the window, and the same way round in all other frames. If it were chosen anew in
    /// every frame, the side would change whenever the two pass half a turn; if it were taken from
    /// the first frame, B could be turned the long way round where its weight is greatest.
    fn turns(&self, world_from_b: &Planar) -> Vec<f64> {
        let turn = |p: usize, near: f64| {
            let yaw = world_from_b.yaw + self.b.ground_frames()[self.enter + p].yaw
                - self.a.ground_frames()[self.leave + p].yaw;
            unwrap_near(yaw, near)
        };
        let mut turns = vec![0.0; self.window];
        for (p, before) in from_the_middle(self.window) {
            turns[p] = turn(p, before.map_or(0.0, |before| turns[before]));
        }
        turns
    }

    /// Returns for every frame of the window and every joint whether the sign of A's rotation
    /// changes, so that each joint turns by the shorter way in the middle of the window and the
    /// same way round in all other frames.
    fn sides(&self, placing: &PosePlacement<'_>) -> Vec<bool> {
        let joints = self.a.clip().skeleton().len();
        let mut flips = vec![false; self.window * joints];
        let mut known: Vec<Quat> = vec![Quat::IDENTITY; self.window * joints];
        for (p, before) in from_the_middle(self.window) {
            for joint in 0..joints {
                let (b, a) = match joint {
                    0 => self.root_rotations(p, placing),
                    _ => (
                        self.b.clip().rotations(self.enter + p)[joint],
                        self.a.clip().rotations(self.leave + p)[joint],
                    ),
                };
                let between = b.conjugate() * a;
                let near = before.map_or(Quat::IDENTITY, |before| known[before * joints + joint]);
                let flip = between.dot(near) < 0.0;
                flips[p * joints + joint] = flip;
                known[p * joints + joint] = if flip { -between } else { between };
            }
        }
        flips
    }

    /// Returns the roots' rotations in frame `p`, B's and A's, each relative to its placement.
    fn root_rotations(&self, p: usize, placing: &PosePlacement<'_>) -> (Quat, Quat) {
        let (fa, fb) = (self.leave + p, self.enter + p);
        let (a_from, b_from) = self.blend_frames(p, placing);
        (
            b_from.rotation() * self.b.clip().rotations(fb)[0],
            a_from.rotation() * self.a.clip().rotations(fa)[0],
        )
    }

    /// Returns the transforms of A and B to the frame in which they are blended in frame `p`.
    fn blend_frames(&self, p: usize, placing: &PosePlacement<'_>) -> (Planar, Planar) {
        match placing {
            PosePlacement::Character(_) => (
                self.a.ground_frames()[self.leave + p].inverse(),
                self.b.ground_frames()[self.enter + p].inverse(),
            ),
            PosePlacement::World(world_from_b, _) => (Planar::IDENTITY, *world_from_b),
        }
    }

    /// Returns the ground frames in the window, interpolated in the world.
    fn between(&self, world_from_b: &Planar, turns: &[f64]) -> Vec<Planar> {
        let in_window = turns.iter().enumerate();
        in_window
            .map(|(p, turn)| {
                let a = &self.a.ground_frames()[self.leave + p];
                let b = world_from_b.after(&self.b.ground_frames()[self.enter + p]);
                mixed(a, &b, *turn, self.weight(p as f64))
            })
            .collect()
    }

    /// Returns A's weight in frame `p`, and the translation and rotation of the blended root.
    /// `flip` changes the sign of A's rotation ([`Self::sides`]).
    fn root(&self, p: usize, placing: &PosePlacement<'_>, flip: bool) -> (f32, Vec3, Quat) {
        let weight = self.weight(p as f64) as f32;
        let (a_from, b_from) = self.blend_frames(p, placing);
        let a = a_from.apply(self.a.clip().root_translations()[self.leave + p]);
        let b = b_from.apply(self.b.clip().root_translations()[self.enter + p]);
        let translation = b.lerp(a, weight);
        let (b_rotation, a_rotation) = self.root_rotations(p, placing);
        let a_rotation = match placing {
            PosePlacement::Character(_) => signed(a_rotation, flip),
            // The body turns the same way round as the ground frames.
            PosePlacement::World(_, turns) => {
                let turn = Quat::from_rotation_y(-turns[p] as f32);
                quat::in_hemisphere_of(a_rotation, turn * b_rotation)
            }
        };
        let rotation = quat::slerp_as_given(b_rotation, a_rotation, weight);
        match placing {
            PosePlacement::Character(frames) => (
                weight,
                frames[p].apply(translation),
                quat::renormalize(frames[p].rotation() * rotation),
            ),
            PosePlacement::World(..) => (weight, translation, rotation),
        }
    }

    fn clip(&self, placing: &PosePlacement<'_>, world_from_b: &Planar) -> Result<Clip, BlendError> {
        let (a, b) = (self.a.clip(), self.b.clip());
        let after = self.enter + self.window;
        let mut made = Assembly::new(a, b, self.leave + self.window + (b.frames() - after));
        made.play(a, 0..self.leave);
        let moving = moving_joints(a, b);
        let (mut rotations, mut translations) = (Vec::new(), Vec::new());
        let (joints, flips) = (a.skeleton().len(), self.sides(placing));
        for p in 0..self.window {
            let (fa, fb) = (self.leave + p, self.enter + p);
            let (weight, translation, rotation) = self.root(p, placing, flips[p * joints]);
            rotations.clear();
            rotations.push(rotation);
            let both = a.rotations(fa).iter().zip(b.rotations(fb)).enumerate().skip(1);
            rotations.extend(both.map(|(joint, (&a, &b))| {
                quat::slerp_as_given(b, signed(a, flips[p * joints + joint]), weight)
            }));
            translations.clear();
            let between = |&joint: &usize| {
                translation_of(b, joint, fb).lerp(translation_of(a, joint, fa), weight)
            };
            translations.extend(moving.iter().map(between));
            made.push(translation, &rotations, &translations);
        }
        made.play_moved(b, after..b.frames(), world_from_b);
        Ok(made.finish(format!("{} → {}", a.name(), b.name()))?)
    }
}

fn signed(q: Quat, flip: bool) -> Quat {
    if flip { -q } else { q }
}

/// Returns the frames of a window from its middle to its end, then from there back to its
/// beginning, each with the neighbour that came before it.
fn from_the_middle(window: usize) -> impl Iterator<Item = (usize, Option<usize>)> {
    let middle = window / 2;
    let later = (middle..window).map(move |p| (p, (p > middle).then(|| p - 1)));
    later.chain((0..middle.min(window)).rev().map(|p| (p, Some(p + 1))))
}

/// Returns `weight` of `a` and the rest of `b`, whose yaw from `a` is `turn`.
fn mixed(a: &Planar, b: &Planar, turn: f64, weight: f64) -> Planar {
    let shift: DVec2 = b.shift + (a.shift - b.shift) * weight;
    Planar { yaw: wrap_angle(a.yaw + turn * (1.0 - weight)), shift }
}

#[cfg(test)]
mod tests;
