//! The elements of a picture: limbs, skins, lines and rings.

use crate::color::Color;
use glam::Vec3;
use segue_motion::skin::SkinnedMesh;
use std::ops::Range;
use std::sync::Arc;

/// A rounded cone: two balls and their convex hull. With `a == b` it is a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Centre of the first ball, metres.
    pub a: Vec3,
    /// Centre of the second ball, metres.
    pub b: Vec3,
    /// Radius of the first ball, metres.
    pub radius_a: f32,
    /// Radius of the second ball, metres.
    pub radius_b: f32,
    /// Unit direction in which the cross-section is scaled; only its part perpendicular to the axis
    /// has an effect.
    pub flat: Vec3,
    /// The scale in that direction: 1 is round, 0.5 is half as thick.
    pub flatness: f32,
    /// Colour. The alpha of a ghost is its opacity.
    pub color: Color,
}

/// A body.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its limbs, a range of [`Pane::limbs`](crate::Pane::limbs).
    pub limbs: Range<usize>,
    /// The skin that is drawn in place of the limbs, which then only shade the ground.
    pub skin: Option<Skin>,
    /// Whether it is translucent: only its front is drawn, and bodies behind it are visible through
    /// it.
    pub ghost: bool,
    /// Strength of its shadow on the ground, from 0 (none) to 1. A body of strength 1 also blocks
    /// the main light.
    pub shadow: f32,
}

/// A skinned mesh in a pose.
#[derive(Clone, Debug)]
pub struct Skin {
    /// The mesh, which figures may share.
    pub mesh: Arc<SkinnedMesh>,
    /// Its joints' `world_from_bind`, a range of [`Pane::joints`](crate::Pane::joints).
    pub joints: Range<usize>,
    /// Colour. The alpha of a ghost is its opacity. A mesh with colours of its own shows those on a
    /// solid body.
    pub color: Color,
    /// Whether every joint has its own colour, in
    /// [`Pane::joint_colors`](crate::Pane::joint_colors).
    pub colored: bool,
}

/// Meshes are large, so they are compared by identity.
impl PartialEq for Skin {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.joints == other.joints
            && self.color == other.color
            && self.colored == other.colored
    }
}

/// The method by which a skin follows its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Skinning {
    /// Dual quaternion skinning: the mean of the joints' motions. A twisted limb keeps its girth.
    #[default]
    Dual,
    /// Linear blend skinning: the mean of the points moved by each joint. A twisted limb collapses.
    Linear,
}

/// The depth of a line in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// On the ground, behind every body.
    #[default]
    Ground,
    /// In space, hidden by the bodies in front of it.
    Space,
    /// On top of everything.
    Over,
}

/// A straight segment of a line, of constant width on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The start of the previous segment, which determines the joint; `from` if there is none.
    pub before: Vec3,
    /// Start, metres.
    pub from: Vec3,
    /// End, metres.
    pub to: Vec3,
    /// The end of the next segment; `to` if there is none.
    pub after: Vec3,
    /// Colour at the start.
    pub color_from: Color,
    /// Colour at the end.
    pub color_to: Color,
    /// Width, points (see [`Stage::pixels_per_point`](crate::Stage::pixels_per_point)).
    pub width: f32,
    /// Depth in the picture.
    pub layer: Layer,
}

/// A ring on the ground: a planted foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Its centre; the height is ignored.
    pub center: Vec3,
    /// Radius of the middle of its line, metres.
    pub radius: f32,
    /// Width of its line, metres; it is drawn at least one and a half points wide.
    pub width: f32,
    /// Colour of the line.
    pub color: Color,
    /// Opacity of the inside, 0–1.
    pub fill: f32,
}
