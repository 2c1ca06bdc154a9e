//! The state of a foot in a clip, as planting needs it.

use crate::math::Planar;
use glam::Vec3;

/// The state of a foot in the clip, in the frame that plays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FootState {
    /// Whether it is planted.
    pub planted: bool,
    /// The number of frames for which it stays planted, including this one; shortly before it
    /// lands, the length of the next stance. 0 otherwise.
    pub stance_frames: usize,
    /// The height of its lowest point above the usual height of a planted foot, metres.
    pub above_m: f32,
    /// The amount by which its lowest point comes down in the next frames, metres.
    pub descent_m: f32,
    /// The index of the point that moves least over the ground in the clip; while the foot is
    /// pulled along, another point may seem to stand.
    pub stillest: usize,
    /// The velocity of that point in the frame of the character, metres per second.
    pub velocity_mps: Vec3,
}

impl FootState {
    /// Returns the state with its velocity in the world.
    pub(super) fn turned(self, world_from_character: &Planar) -> Self {
        Self { velocity_mps: world_from_character.apply_vector(self.velocity_mps), ..self }
    }
}
