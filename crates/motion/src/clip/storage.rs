//! The clip: rotations and translations, frame by frame.

use crate::math::Planar;
use crate::skeleton::{Pose, Skeleton, WorldPose, world_pose_into, world_pose_of};
use glam::{Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// The axis of a file that points up.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum UpAxis {
    /// +Y is up, as inside Segue.
    #[default]
    Y,
    /// +Z is up; rotated by -90° about X on import.
    Z,
}

/// Units and axes of the file that a clip was read from, which an exporter needs to write it back
/// in the same way.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Provenance {
    /// Metres per unit of length in the file.
    pub metres_per_unit: f64,
    /// The file's up axis.
    pub up: UpAxis,
}

impl Default for Provenance {
    /// Centimetres and Y up, as in most BVH files.
    fn default() -> Self {
        Self { metres_per_unit: 0.01, up: UpAxis::Y }
    }
}

/// Translations of one joint that moves relative to its parent: one per frame, metres, in the
/// parent's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct JointTranslations {
    /// The joint's index; not 0, the root has its own.
    pub joint: usize,
    /// One translation per frame.
    pub values: Vec<Vec3>,
}

/// Error building a [`Clip`].
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum ClipError {
    /// The frame rate is not finite and positive.
    #[error("a frame rate of {0} frames per second cannot be played: give a number above 0")]
    FrameRate(f64),
    /// An array has the wrong length.
    #[error("{what}: found {found} values, expected {expected}")]
    Length {
        /// Name of the array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Its required length, from frames × joints.
        expected: usize,
    },
    /// A range of frames that the clip does not have.
    #[error("frames {start} to {end} are not inside this clip of {frames} frames")]
    OutOfRange {
        /// First frame asked for.
        start: usize,
        /// One past the last frame asked for.
        end: usize,
        /// Number of frames of the clip.
        frames: usize,
    },
    /// Translations of a joint that the skeleton does not have, of the root, or not in the order of
    /// joints.
    #[error("translations of joint {0} do not fit this skeleton")]
    Translations(usize),
}

/// A motion: `frames × joints` local rotations at a constant frame rate, and the root's trajectory
/// in the world.
///
/// Rotations are unit quaternions (`parent_from_joint`), frame-major and contiguous. Lengths are
/// metres, Y is up.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    name: String,
    skeleton: Arc<Skeleton>,
    fps: f64,
    rotations: Vec<Quat>,
    root_translations: Vec<Vec3>,
    translations: Vec<JointTranslations>,
    provenance: Provenance,
}

impl Clip {
    /// Returns a clip of `rotations`, frame-major, frames × joints long, and `root_translations`,
    /// one per frame.
    ///
    /// # Errors
    /// [`ClipError`] when the frame rate is not a positive number or the lengths do not match.
    pub fn new(
        name: impl Into<String>,
        skeleton: Arc<Skeleton>,
        fps: f64,
        rotations: Vec<Quat>,
        root_translations: Vec<Vec3>,
    ) -> Result<Self, ClipError> {
        if !(fps.is_finite() && fps > 0.0) {
            return Err(ClipError::FrameRate(fps));
        }
        let expected = root_translations.len() * skeleton.len();
        if rotations.len() != expected {
            return Err(ClipError::Length { what: "rotations", found: rotations.len(), expected });
        }
        Ok(Self {
            name: name.into(),
            skeleton,
            fps,
            rotations,
            root_translations,
            translations: Vec::new(),
            provenance: Provenance::default(),
        })
    }

    /// Returns the clip with translations of joints other than the root, sorted by joint.
    ///
    /// # Errors
    /// [`ClipError`] when a joint does not exist, is the root or is out of order, or a length
    /// differs from the number of frames.
    pub fn with_translations(
        mut self,
        translations: Vec<JointTranslations>,
    ) -> Result<Self, ClipError> {
        let mut previous = 0;
        for track in &translations {
            if track.joint <= previous || track.joint >= self.skeleton.len() {
                return Err(ClipError::Translations(track.joint));
            }
            if track.values.len() != self.frames() {
                return Err(ClipError::Length {
                    what: "translations",
                    found: track.values.len(),
                    expected: self.frames(),
                });
            }
            previous = track.joint;
        }
        self.translations = translations;
        Ok(self)
    }

    /// Returns the clip with the units and axes of its file.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = provenance;
        self
    }

    /// Returns the clip under another name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Returns the name on screen.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the skeleton, shared between clips of one rig.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Returns the frame rate, frames per second.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.fps
    }

    /// Returns the time between frames, seconds.
    #[must_use]
    pub fn dt_secs(&self) -> f32 {
        self.fps.recip() as f32
    }

    /// Returns the number of frames; may be 0 (a skeleton alone).
    #[must_use]
    pub fn frames(&self) -> usize {
        self.root_translations.len()
    }

    /// Returns the time from the first frame to the last, seconds: `(frames - 1) / fps`.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.frames().saturating_sub(1) as f64 / self.fps
    }

    /// Returns the time of a frame, seconds.
    #[must_use]
    pub fn time_of(&self, frame: usize) -> f64 {
        frame as f64 / self.fps
    }

    /// Returns the units and axes of the source file.
    #[must_use]
    pub fn provenance(&self) -> Provenance {
        self.provenance
    }

    /// Returns the local rotations of all joints in `frame`.
    ///
    /// # Panics
    /// When there is no such frame.
    #[must_use]
    pub fn rotations(&self, frame: usize) -> &[Quat] {
        let joints = self.skeleton.len();
        &self.rotations[frame * joints..(frame + 1) * joints]
    }

    /// Returns the local rotations of all joints in all frames: frame-major, frames × joints long.
    #[must_use]
    pub fn all_rotations(&self) -> &[Quat] {
        &self.rotations
    }

    /// Returns the world translations of the root joint, one per frame, metres.
    #[must_use]
    pub fn root_translations(&self) -> &[Vec3] {
        &self.root_translations
    }

    /// Returns the translations of the joints that move relative to their parent, sorted by joint.
    #[must_use]
    pub fn translations(&self) -> &[JointTranslations] {
        &self.translations
    }

    /// Returns one frame as a pose.
    ///
    /// # Panics
    /// When there is no such frame.
    #[must_use]
    pub fn pose(&self, frame: usize) -> Pose {
        Pose {
            root_translation: self.root_translations[frame],
            rotations: self.rotations(frame).to_vec(),
            translations: self
                .translations
                .iter()
                .map(|track| (track.joint, track.values[frame]))
                .collect(),
        }
    }

    /// Computes forward kinematics of one frame into a reusable buffer.
    ///
    /// # Panics
    /// When there is no such frame.
    pub fn world_pose_into(&self, frame: usize, world: &mut WorldPose) {
        let moved = self.translations.iter().map(|track| (track.joint, track.values[frame]));
        world_pose_into(
            &self.skeleton,
            self.root_translations[frame],
            self.rotations(frame),
            moved,
            world,
        );
    }

    /// Computes forward kinematics of some joints of one frame; see [`world_pose_of`].
    ///
    /// # Panics
    /// When there is no such frame.
    pub(crate) fn world_pose_of(&self, frame: usize, joints: &[usize], world: &mut WorldPose) {
        let moved = self.translations.iter().map(|track| (track.joint, track.values[frame]));
        let root = self.root_translations[frame];
        world_pose_of(&self.skeleton, root, self.rotations(frame), moved, joints, world);
    }

    /// Computes forward kinematics of one frame.
    ///
    /// # Panics
    /// When there is no such frame.
    #[must_use]
    pub fn world_pose(&self, frame: usize) -> WorldPose {
        let mut world = WorldPose::default();
        self.world_pose_into(frame, &mut world);
        world
    }

    /// Returns the world positions of all joints over a range of frames: frame-major,
    /// `range.len() × joints` long, metres. The range is clamped to the clip.
    #[must_use]
    pub fn world_positions(&self, range: Range<usize>) -> Vec<Vec3> {
        let end = range.end.min(self.frames());
        let start = range.start.min(end);
        let mut positions = Vec::with_capacity((end - start) * self.skeleton.len());
        let mut world = WorldPose::default();
        for frame in start..end {
            self.world_pose_into(frame, &mut world);
            positions.extend_from_slice(&world.positions);
        }
        positions
    }

    /// Returns the frames of `range` as a clip.
    ///
    /// # Errors
    /// [`ClipError::OutOfRange`] when the range is not inside the clip.
    pub fn crop(&self, range: Range<usize>) -> Result<Self, ClipError> {
        if range.start > range.end || range.end > self.frames() {
            return Err(ClipError::OutOfRange {
                start: range.start,
                end: range.end,
                frames: self.frames(),
            });
        }
        let joints = self.skeleton.len();
        Ok(Self {
            name: self.name.clone(),
            skeleton: Arc::clone(&self.skeleton),
            fps: self.fps,
            rotations: self.rotations[range.start * joints..range.end * joints].to_vec(),
            root_translations: self.root_translations[range.clone()].to_vec(),
            translations: (self.translations.iter())
                .map(|track| JointTranslations {
                    joint: track.joint,
                    values: track.values[range.clone()].to_vec(),
                })
                .collect(),
            provenance: self.provenance,
        })
    }

    /// Returns the clip moved rigidly over the ground: distances between joints of any two frames
    /// stay, and so do heights.
    #[must_use]
    pub fn transformed(&self, world_from_clip: &Planar) -> Self {
        let mut moved = self.clone();
        let turn = world_from_clip.rotation();
        for translation in &mut moved.root_translations {
            *translation = world_from_clip.apply(*translation);
        }
        for rotation in moved.rotations.iter_mut().step_by(self.skeleton.len()) {
            *rotation = crate::math::quat::renormalize(turn * *rotation);
        }
        moved
    }

    /// Returns the clip backwards: its last frame plays first.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let mut backwards = self.clone();
        let poses = self.rotations.chunks_exact(self.skeleton.len()).rev();
        backwards.rotations = poses.flatten().copied().collect();
        backwards.root_translations.reverse();
        for track in &mut backwards.translations {
            track.values.reverse();
        }
        backwards
    }

    /// Returns the clip with all lengths multiplied by `factor`, which is above 0: those of the
    /// body, and those of its path. Rotations stay.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        let mut scaled = self.clone();
        scaled.skeleton = Arc::new(self.skeleton.scaled(factor));
        let tracks = scaled.translations.iter_mut().flat_map(|track| &mut track.values);
        for translation in scaled.root_translations.iter_mut().chain(tracks) {
            *translation *= factor;
        }
        scaled
    }

    /// Returns whether it is one of points without bones, such as markers: every joint but the
    /// first hangs from the first, and moves there by itself.
    #[must_use]
    pub fn is_of_points(&self) -> bool {
        let joints = self.skeleton.joints().iter().skip(1);
        let mut moving = self.translations.iter().map(|track| track.joint);
        self.skeleton.len() > 1
            && joints.enumerate().all(|(index, joint)| {
                joint.parent == Some(0)
                    && joint.end_site.is_none()
                    && moving.next() == Some(index + 1)
            })
    }

    /// Returns the clip with the same frames at another frame rate: it plays faster or slower.
    ///
    /// # Errors
    /// [`ClipError::FrameRate`] when the rate is not a positive number.
    pub fn at_rate(mut self, fps: f64) -> Result<Self, ClipError> {
        if !(fps.is_finite() && fps > 0.0) {
            return Err(ClipError::FrameRate(fps));
        }
        self.fps = fps;
        Ok(self)
    }

    /// Returns the clip with the joints above the carrier that an equal skeleton has
    /// ([`Skeleton::folded_chain`]); a clip on another skeleton stays as it is.
    #[must_use]
    pub fn with_chain_of(mut self, skeleton: &Arc<Skeleton>) -> Self {
        if self.skeleton == *skeleton {
            self.skeleton = Arc::clone(skeleton);
        }
        self
    }

    /// Returns the clip with its root raised in every frame, metres.
    pub(crate) fn raised(mut self, by: f32) -> Self {
        for root in &mut self.root_translations {
            root.y += by;
        }
        self
    }

    /// Returns the clip with each frame moved over the ground by a transform of its own; a frame
    /// without one stays in place.
    #[must_use]
    pub fn transformed_by_frame(&self, world_from_clip: &[Planar]) -> Self {
        let mut moved = self.clone();
        let poses = moved.rotations.chunks_exact_mut(self.skeleton.len());
        for ((pose, translation), world_from_clip) in
            poses.zip(&mut moved.root_translations).zip(world_from_clip)
        {
            *translation = world_from_clip.apply(*translation);
            if let Some(root) = pose.first_mut() {
                *root = crate::math::quat::renormalize(world_from_clip.rotation() * *root);
            }
        }
        moved
    }
}
