//! Layers: a part of one body over another, in place or added.

use super::assembly::{Assembly, moving_joints, translation_of};
use super::{BodyPart, mask};
use crate::clip::{Clip, ClipError, Motion};
use crate::math::{Planar, quat, wrap_angle};
use crate::skeleton::{Pose, WorldPose, world_pose_into};
use glam::{Quat, Vec3};
use std::borrow::Cow;

/// The greatest time between the start of a layer and the start of the base, seconds.
const MAX_START_SECS: f64 = 3_600.0;

/// Error laying one clip over another.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum LayerError {
    /// The clips have different skeletons.
    #[error("`{base}` and `{over}` move different skeletons: retarget one onto the other first")]
    Skeletons {
        /// Name of the clip below.
        base: String,
        /// Name of the layer.
        over: String,
    },
    /// A frame that the layer does not have.
    #[error(
        "the layer has {frames} frames, and no frame {frame}: choose another frame of reference or another clip"
    )]
    NoFrame {
        /// The frame asked for.
        frame: usize,
        /// Number of frames of the layer.
        frames: usize,
    },
    /// A number out of range.
    #[error("a {what} of {value} cannot be used: give a number from {least} to {most}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The smallest number.
        least: f64,
        /// The largest number.
        most: f64,
    },
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// The reference pose of an additive layer.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Reference {
    /// The rest pose of the skeleton.
    Rest,
    /// A frame of the layer's own clip.
    Frame(usize),
    /// The mean of the layer's own frames. The mean of rotations is the normalised sum of
    /// quaternions in one hemisphere (for poses of one clip within a degree of the mean of Markley,
    /// Cheng, Crassidis, Oshman 2007).
    Mean,
}

/// The effect of a layer on the base.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum LayerMode {
    /// The layer replaces the base, joint by joint: slerp by mask × weight.
    Override,
    /// The difference of the layer to a reference pose is added:
    /// `base · exp(w log(reference⁻¹ · over))`, in every joint's own frame, so that a bent arm
    /// waves as a straight one does.
    Additive(Reference),
}

/// The behaviour of a layer at its end.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum LayerTime {
    /// It repeats: its last frame counts as its first.
    #[default]
    Loop,
    /// It stays in its last frame, and before its beginning in its first.
    Hold,
}

/// Options of a layer.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LayerOptions {
    /// The parts of the body that the layer affects.
    pub parts: Vec<BodyPart>,
    /// Number of joints over which each part fades in ([`mask()`]).
    pub feather: usize,
    /// The weight of the layer, 0 to 1.
    pub weight: f32,
    /// Its effect on the base.
    pub mode: LayerMode,
    /// Its behaviour at its end.
    pub time: LayerTime,
    /// The layer's time at the base's first frame, seconds; negative to begin later than the base.
    pub start_secs: f64,
    /// Whether the joints at the border of the mask keep the layer's orientation in the
    /// *character's* frame instead of that relative to their parents. The hips of a walk tilt and
    /// turn: an upper body that only keeps its angles to other hips nods with them. Only for
    /// [`LayerMode::Override`].
    pub keep_orientation: bool,
}

impl Default for LayerOptions {
    fn default() -> Self {
        Self {
            parts: vec![BodyPart::UpperBody],
            feather: 2,
            weight: 1.0,
            mode: LayerMode::Override,
            time: LayerTime::Loop,
            start_secs: 0.0,
            keep_orientation: false,
        }
    }
}

/// Lays a part of one clip over another, for example the upper body of `over` on the legs of
/// `base`. The parts are those of the base's roles.
///
/// The result has the base's frames and rate; the layer is sampled between its frames where its
/// rate or start differ. Joints outside the mask, and with them the root, are the base's, bit for
/// bit. If the mask contains the root, its lean and its height are those of the layer by weight, in
/// the character's frame. Over the ground, an override blends the steps of both characters by the
/// root's weight and integrates them from the base's first frame, and an additive layer keeps the
/// base's trajectory. Local translations of joints are blended in the same way.
///
/// # Errors
/// [`LayerError`] when the clips have different skeletons, the layer does not have a given frame,
/// or a number is out of range.
pub fn layer(base: &Motion, over: &Motion, options: &LayerOptions) -> Result<Clip, LayerError> {
    let base_clip = base.clip();
    let times: Vec<f64> = (0..base_clip.frames()).map(|frame| base_clip.time_of(frame)).collect();
    layer_timed(base, over, options, &times)
}

/// Lays one clip over another as [`layer`] does, with a time map: `times` has the layer's time for
/// every frame of the base, seconds, to which the options' start is added. Frames without a time
/// are the base's alone.
///
/// # Errors
/// The same as for [`layer`].
pub fn layer_timed(
    base: &Motion,
    over: &Motion,
    options: &LayerOptions,
    times: &[f64],
) -> Result<Clip, LayerError> {
    let (base_clip, over_clip) = (&**base.clip(), &**over.clip());
    check(base_clip, over_clip, options)?;
    let skeleton = base_clip.skeleton();
    let mask = mask(skeleton, base.roles(), &options.parts, options.feather);
    if options.weight == 0.0 || mask.iter().all(|&weight| weight == 0.0) || base_clip.frames() == 0
    {
        return Ok(base_clip.clone());
    }
    let joints = skeleton.joints().iter();
    let is_border = |(joint, parent): (usize, Option<usize>)| {
        mask[joint] > 0.0 && parent.is_some_and(|parent| mask[parent] < 1.0)
    };
    let turned = options.keep_orientation
        && options.mode == LayerMode::Override
        && joints.map(|joint| joint.parent).enumerate().any(is_border);
    // Ground frames are needed only for the root, and for orientations.
    let has_places = mask[0] > 0.0 || turned;
    let masked = (0..mask.len()).filter(|&joint| mask[joint] > 0.0);
    let mut wanted = vec![false; mask.len()];
    // Orientations are those of all joints on the way from the root.
    let needed = if turned { skeleton.with_ancestors(masked) } else { masked.collect() };
    for joint in needed {
        wanted[joint] = true;
    }
    let layering = LayerBlend {
        base_frames: places(base, has_places),
        over_frames: places(over, has_places),
        moving: moving_joints(base_clip, over_clip),
        base: base_clip,
        over: over_clip,
        mask,
        wanted,
        options,
        times,
        turned,
    };
    Ok(layering.clip()?)
}

/// Returns the ground frames of a motion, or as many at the origin.
fn places(motion: &Motion, are_needed: bool) -> Cow<'_, [Planar]> {
    if are_needed {
        motion.ground_frames().into()
    } else {
        vec![Planar::IDENTITY; motion.clip().frames()].into()
    }
}

fn check(base: &Clip, over: &Clip, options: &LayerOptions) -> Result<(), LayerError> {
    if base.skeleton() != over.skeleton() {
        let (base, over) = (base.name().to_owned(), over.name().to_owned());
        return Err(LayerError::Skeletons { base, over });
    }
    let number = |what, value: f64, range: std::ops::RangeInclusive<f64>| {
        let (least, most) = (*range.start(), *range.end());
        let fits = range.contains(&value);
        let error = LayerError::Number { what, value, least, most };
        if fits { Ok(()) } else { Err(error) }
    };
    number("weight", f64::from(options.weight), 0.0..=1.0)?;
    number("start (s)", options.start_secs, -MAX_START_SECS..=MAX_START_SECS)?;
    let frame = match options.mode {
        LayerMode::Additive(Reference::Frame(frame)) => frame,
        _ => 0,
    };
    if frame < over.frames() {
        Ok(())
    } else {
        Err(LayerError::NoFrame { frame, frames: over.frames() })
    }
}

struct LayerBlend<'a> {
    base: &'a Clip,
    over: &'a Clip,
    base_frames: Cow<'a, [Planar]>,
    over_frames: Cow<'a, [Planar]>,
    moving: Vec<usize>,
    mask: Vec<f32>,
    /// The joints whose rotations in the layer are needed.
    wanted: Vec<bool>,
    options: &'a LayerOptions,
    times: &'a [f64],
    turned: bool,
}

impl LayerBlend<'_> {
    fn clip(&self) -> Result<Clip, ClipError> {
        let mut made = Assembly::new(self.base, self.over, self.base.frames());
        let reference = self.reference();
        let mut here = self.base_frames[0];
        let (mut rotations, mut made_so_far, mut world) =
            (Vec::new(), Vec::new(), WorldPose::default());
        let mut over = Pose::default();
        let mut before = 0.0;
        for frame in 0..self.base.frames() {
            let time = self.times.get(frame).copied().unwrap_or_else(|| self.base.time_of(frame));
            let secs = self.options.start_secs + time;
            if !self.pose_into(secs, &mut over) {
                continue;
            }
            if frame > 0 {
                here = here.after(&self.step(frame, before, secs));
            }
            before = secs;
            let root = match self.options.mode {
                LayerMode::Override => {
                    let buffers = (&mut rotations, &mut made_so_far, &mut world);
                    self.replace(frame, &over, &here, buffers);
                    self.root(frame, &over, &here)
                }
                LayerMode::Additive(_) => {
                    self.add(frame, &over, &reference, &mut rotations);
                    let rise = over.root_translation.y - reference.root_translation.y;
                    self.base.root_translations()[frame] + Vec3::Y * rise * self.weight(0)
                }
            };
            let translations: Vec<Vec3> = self
                .moving
                .iter()
                .map(|&joint| self.translation(joint, frame, &over, &reference))
                .collect();
            made.push(root, &rotations, &translations);
        }
        made.finish(format!("{} + {}", self.base.name(), self.over.name()))
    }

    fn weight(&self, joint: usize) -> f32 {
        self.mask[joint] * self.options.weight
    }

    /// Returns the layer's own time, seconds.
    fn local(&self, secs: f64) -> f64 {
        let duration = self.over.duration_secs();
        match self.options.time {
            LayerTime::Loop if duration > 0.0 => secs.rem_euclid(duration),
            _ => secs.clamp(0.0, duration),
        }
    }

    /// Computes the layer's pose at a time, with its root in the character's frame.
    fn pose_into(&self, secs: f64, pose: &mut Pose) -> bool {
        let secs = self.local(secs);
        let is_there = self.over.sample_into(secs, Some(&self.wanted), pose);
        if is_there {
            into_character_frame(pose, &self.ground_frame_at(secs));
        }
        is_there
    }

    /// Returns the layer's ground frame at its own time.
    fn ground_frame_at(&self, secs: f64) -> Planar {
        let last = self.over_frames.len().saturating_sub(1);
        let at = (secs * self.over.fps()).clamp(0.0, last as f64);
        let frame = at.floor() as usize;
        let (from, to) = (&self.over_frames[frame], &self.over_frames[(frame + 1).min(last)]);
        Planar {
            yaw: wrap_angle(from.yaw + wrap_angle(to.yaw - from.yaw) * at.fract()),
            shift: from.shift.lerp(to.shift, at.fract()),
        }
    }

    /// Returns the step into a frame: the base's, and in an override the layer's, between two of
    /// its times, by the root's weight.
    fn step(&self, frame: usize, before: f64, secs: f64) -> Planar {
        let base = self.base_frames[frame - 1].inverse().after(&self.base_frames[frame]);
        let weight = f64::from(self.weight(0));
        if weight == 0.0 || self.options.mode != LayerMode::Override {
            return base;
        }
        let (from, to) = (self.local(before), self.local(secs));
        let between = |from: f64, to: f64| {
            self.ground_frame_at(from).inverse().after(&self.ground_frame_at(to))
        };
        let over = if to >= from {
            between(from, to)
        } else {
            // Across its end: the rest of the layer, then its beginning.
            between(from, self.over.duration_secs()).after(&between(0.0, to))
        };
        let yaw = wrap_angle(base.yaw) * (1.0 - weight) + wrap_angle(over.yaw) * weight;
        Planar { yaw, shift: base.shift.lerp(over.shift, weight) }
    }

    fn reference(&self) -> Pose {
        match self.options.mode {
            LayerMode::Additive(Reference::Frame(frame)) => {
                in_character_frame(self.over.pose(frame), &self.over_frames[frame])
            }
            LayerMode::Additive(Reference::Mean) => self.mean_pose(),
            _ => Pose {
                root_translation: self.over.skeleton().joints()[0].offset,
                rotations: vec![Quat::IDENTITY; self.mask.len()],
                translations: vec![],
            },
        }
    }

    /// Returns the mean of the layer's poses, each in its ground frame.
    fn mean_pose(&self) -> Pose {
        let poses = (0..self.over.frames())
            .map(|frame| in_character_frame(self.over.pose(frame), &self.over_frames[frame]));
        let share = (self.over.frames().max(1) as f32).recip();
        let sum = poses.reduce(|mut sum, pose| {
            sum.root_translation += pose.root_translation;
            for (sum, &rotation) in sum.rotations.iter_mut().zip(&pose.rotations) {
                *sum = *sum + quat::in_hemisphere_of(rotation, *sum);
            }
            for (sum, (_, translation)) in sum.translations.iter_mut().zip(pose.translations) {
                sum.1 += translation;
            }
            sum
        });
        let mut mean = sum.unwrap_or_default();
        mean.root_translation *= share;
        for rotation in &mut mean.rotations {
            *rotation = quat::renormalize(*rotation);
        }
        for (_, translation) in &mut mean.translations {
            *translation *= share;
        }
        mean
    }

    /// Computes rotations with the layer in the base's place. The buffers are for these rotations,
    /// the orientations that they make, and the layer's pose.
    fn replace(
        &self,
        frame: usize,
        over: &Pose,
        here: &Planar,
        (rotations, made, world): (&mut Vec<Quat>, &mut Vec<Quat>, &mut WorldPose),
    ) {
        let base = self.base.rotations(frame);
        let joints = self.base.skeleton().joints();
        let turn = here.rotation();
        if self.turned {
            // Orientations of the layer in the character's frame.
            world_pose_into(self.over.skeleton(), Vec3::ZERO, &over.rotations, [], world);
        }
        made.clear();
        rotations.clear();
        for (joint, (&base, &over)) in base.iter().zip(&over.rotations).enumerate() {
            let weight = self.weight(joint);
            let parent = joints[joint].parent;
            let target = match parent {
                None => turn * over,
                Some(parent) if self.turned && self.mask[parent] < 1.0 => {
                    made[parent].conjugate() * turn * world.rotations[joint]
                }
                Some(_) => over,
            };
            let base = match parent {
                // The base's lean, in the ground frame of the result.
                None if weight > 0.0 => turn * self.base_frames[frame].inverse().rotation() * base,
                _ => base,
            };
            let rotation = if weight == 0.0 {
                base
            } else if weight == 1.0 {
                target
            } else {
                quat::slerp(base, target, weight)
            };
            rotations.push(rotation);
            if self.turned {
                made.push(parent.map_or(rotation, |parent| made[parent] * rotation));
            }
        }
    }

    /// Computes rotations with the layer's difference to the reference added.
    fn add(&self, frame: usize, over: &Pose, reference: &Pose, rotations: &mut Vec<Quat>) {
        rotations.clear();
        let poses = over.rotations.iter().zip(&reference.rotations);
        rotations.extend(self.base.rotations(frame).iter().zip(poses).enumerate().map(
            |(joint, (&base, (over, reference)))| {
                let weight = self.weight(joint);
                if weight == 0.0 { base } else { added(base, *over, *reference, weight) }
            },
        ));
    }

    /// Returns the root's position in an override.
    fn root(&self, frame: usize, over: &Pose, here: &Planar) -> Vec3 {
        let (base, weight) = (self.base.root_translations()[frame], self.weight(0));
        if weight == 0.0 {
            return base;
        }
        let base = self.base_frames[frame].inverse().apply(base);
        here.apply(base.lerp(over.root_translation, weight))
    }

    fn translation(&self, joint: usize, frame: usize, over: &Pose, reference: &Pose) -> Vec3 {
        let base = translation_of(self.base, joint, frame);
        let of = |pose: &Pose| {
            let moved = pose.translations.iter().find(|(moved, _)| *moved == joint);
            moved.map_or(self.over.skeleton().joints()[joint].offset, |(_, value)| *value)
        };
        match self.options.mode {
            LayerMode::Override => base.lerp(of(over), self.weight(joint)),
            LayerMode::Additive(_) => base + (of(over) - of(reference)) * self.weight(joint),
        }
    }
}

/// Returns `base · exp(w log(reference⁻¹ · over))`.
fn added(base: Quat, over: Quat, reference: Quat, weight: f32) -> Quat {
    quat::renormalize(base * quat::exp(quat::log(reference.conjugate() * over) * weight))
}

/// Returns a pose with its root relative to a ground frame.
fn in_character_frame(mut pose: Pose, stands: &Planar) -> Pose {
    into_character_frame(&mut pose, stands);
    pose
}

/// Makes the root of a pose relative to a ground frame.
fn into_character_frame(pose: &mut Pose, stands: &Planar) {
    let here = stands.inverse();
    pose.root_translation = here.apply(pose.root_translation);
    if let Some(root) = pose.rotations.first_mut() {
        *root = quat::renormalize(here.rotation() * *root);
    }
}

#[cfg(test)]
mod tests;
