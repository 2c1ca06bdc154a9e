//! The parts of a picture: limbs, skins, lines and rings.

use crate::color::Color;
use glam::Vec3;
use segue_motion::skin::SkinnedMesh;
use std::ops::Range;
use std::sync::Arc;

/// A rounded cone: two balls and their common hull. With `a == b` a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Centre of the first ball, metres.
    pub a: Vec3,
    /// Centre of the second ball, metres.
    pub b: Vec3,
    /// Radius about `a`, metres.
    pub radius_a: f32,
    /// Radius about `b`, metres.
    pub radius_b: f32,
    /// Unit direction in which the cross-section is scaled; the part of it across the axis counts.
    pub flat: Vec3,
    /// The scale in that direction: 1 is round, 0.5 half as thick.
    pub flatness: f32,
    /// Colour; for a ghost the alpha says how much of it is seen.
    pub color: Color,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its limbs, a range of [`Pane::limbs`].
    pub limbs: Range<usize>,
    /// The skin that is seen in their place: then they only shade the ground.
    pub skin: Option<Skin>,
    /// Translucent: only its front is seen, and bodies behind it shine through.
    pub ghost: bool,
    /// How strongly it darkens the ground near it, 0 (not at all) to 1: what is that strong also
    /// keeps off the main light.
    pub shadow: f32,
}

/// A skinned mesh in a pose.
#[derive(Clone, Debug)]
pub struct Skin {
    /// The mesh; many figures may share one.
    pub mesh: Arc<SkinnedMesh>,
    /// Its joints' `world_from_bind`, a range of [`Pane::joints`].
    pub joints: Range<usize>,
    /// Colour; for a ghost the alpha says how much of it is seen. Where the mesh has colours of its
    /// own, a solid body shows those.
    pub color: Color,
    /// Whether every joint has a colour of its own instead, in [`Pane::joint_colors`].
    pub colored: bool,
}

/// Meshes are large: one is itself and no other.
impl PartialEq for Skin {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.joints == other.joints
            && self.color == other.color
            && self.colored == other.colored
    }
}

/// How a skin follows its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Skinning {
    /// The mean of the joints' motions, as dual quaternions: a twisted limb keeps its girth.
    #[default]
    Dual,
    /// The mean of where each joint would take the point: a twisted limb collapses.
    Linear,
}

/// Where a line is in the depth of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// Painted on the ground: behind every body.
    #[default]
    Ground,
    /// In space: hidden by the bodies before it.
    Space,
    /// On top of everything.
    Over,
}

/// One straight piece of a line, of even width on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Where the piece before it starts; `from` itself where none is. It shapes the joint.
    pub before: Vec3,
    /// Start, metres.
    pub from: Vec3,
    /// End, metres.
    pub to: Vec3,
    /// Where the piece after it ends; `to` itself where none is.
    pub after: Vec3,
    /// Colour at the start.
    pub color_from: Color,
    /// Colour at the end.
    pub color_to: Color,
    /// Width in points (see [`Stage::pixels_per_point`]).
    pub width: f32,
    /// On the ground, in space, or over everything.
    pub layer: Layer,
}

/// A ring on the ground: a planted foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Its middle; the height is ignored.
    pub center: Vec3,
    /// Radius of the middle of its line, metres.
    pub radius: f32,
    /// Width of its line, metres; at least one and a half points are drawn.
    pub width: f32,
    /// Colour of the line.
    pub color: Color,
    /// How much of the colour fills the inside, 0–1.
    pub fill: f32,
}
