//! The facts of a clip that stay known without its motion, for lists, for storage, and while the
//! motion is not in memory.

use crate::bone_map::rig_of;
use glam::{Quat, Vec3};
use segue_motion::clip::{Motion, ground_speed};
use serde::{Deserialize, Serialize};

/// The facts of a clip that are known without its motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipFacts {
    /// The name in its file.
    pub name: String,
    /// The number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// The number of joints.
    pub joints: usize,
    /// The number of joints that move in their parent, besides the root.
    #[serde(default)]
    pub moving: usize,
    /// Standing height, metres.
    pub height_m: f32,
    /// The mean speed over the ground, m/s.
    pub speed_mps: f32,
    /// The rig ([`rig_of`]).
    pub rig: String,
    /// Whether its file has a mesh on its skeleton.
    #[serde(default)]
    pub has_mesh: bool,
}

impl ClipFacts {
    /// Returns the facts of a motion.
    pub(crate) fn of(motion: &Motion, has_mesh: bool) -> Self {
        let clip = motion.clip();
        let skeleton = clip.skeleton();
        Self {
            name: clip.name().to_owned(),
            frames: clip.frames(),
            fps: clip.fps(),
            joints: skeleton.len(),
            moving: clip.translations().len(),
            height_m: sayable(motion.roles().body_height(skeleton)),
            speed_mps: sayable(ground_speed(motion.ground_frames(), clip.fps())),
            rig: rig_of(skeleton),
            has_mesh,
        }
    }

    /// Returns the duration, seconds.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        if self.fps > 0.0 { self.frames.saturating_sub(1) as f64 / self.fps } else { 0.0 }
    }

    /// Returns whether it is more than a single pose.
    pub(crate) fn moves(&self) -> bool {
        self.frames > 1
    }

    /// Returns the memory of the motion, bytes.
    pub(crate) fn motion_bytes(&self) -> u64 {
        motion_bytes(self.frames, self.joints, self.moving)
    }
}

/// Returns a number, or 0 in place of one that JSON does not have.
fn sayable(number: f32) -> f32 {
    if number.is_finite() { number } else { 0.0 }
}

/// Returns the memory of a motion, bytes: a rotation for each joint, a position for the root and
/// for each other joint that moves, the character's ground frame and the contacts of two feet.
pub(crate) fn motion_bytes(frames: usize, joints: usize, moving: usize) -> u64 {
    let per_frame =
        size_of::<Quat>() * joints + size_of::<Vec3>() * (moving + 1) + 3 * size_of::<f64>() + 2;
    (frames as u64).saturating_mul(per_frame as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::synth::{Action, Params, synthesize};

    #[test]
    fn facts_are_those_of_the_motion() {
        let made = synthesize(&Params::new(Action::Walk)).unwrap();
        let facts = ClipFacts::of(&Motion::analyze(made.clip.clone()), true);
        let clip = &made.clip;
        assert_eq!((facts.frames, facts.fps), (clip.frames(), clip.fps()));
        assert_eq!(facts.duration_secs(), clip.duration_secs());
        assert!((1.0..2.0).contains(&facts.speed_mps), "{facts:?}");
        assert!((1.4..2.0).contains(&facts.height_m) && facts.has_mesh && facts.moves());
        let json = serde_json::to_string(&facts).unwrap();
        assert_eq!(serde_json::from_str::<ClipFacts>(&json).unwrap(), facts);
    }
}
