//! A body of tapered limbs, one per shape of [`segue_motion::skin::shapes`]: posed in microseconds,
//! whatever the skeleton.

#[cfg(test)]
mod tests;

use crate::framing::reach_of;
use crate::{Color, Limb};
use segue_motion::skeleton::{Roles, Skeleton, WorldPose, canonical_stance};
use segue_motion::skin::shapes::{PlacedShape, Shape, ball_shapes, limb_shapes};
use segue_motion::skin::{Character, Drive, SkinnedMesh};
use std::sync::Arc;

/// Makes the second ball a little smaller where two limbs meet in the same ball, so that their
/// surfaces do not flicker through each other.
fn set_balls_apart(shapes: &mut [Shape]) {
    for index in 1..shapes.len() {
        let (before, rest) = shapes.split_at_mut(index);
        let Some(shape) = rest.first_mut() else {
            continue;
        };
        if before.iter().any(|other| other.b == shape.a && other.radius_b == shape.radius_a) {
            shape.radius_a *= 0.985;
        }
    }
}

/// The shapes of one skeleton's body, generated once and posed every frame.
///
/// With the roles of a person on two legs it becomes a mannequin of human proportions (segment
/// lengths are the skeleton's own; girths follow the body height). Any other tree gets one tapered
/// limb per bone, whose girth grows with the length of all bones below it.
#[derive(Clone, Debug, Default)]
pub struct Body {
    shapes: Vec<Shape>,
    skin: Option<Arc<SkinnedMesh>>,
    retargeting: Option<Retargeting>,
    size: Option<f32>,
    reach: f32,
}

/// The mapping by which poses of another skeleton move a body.
#[derive(Clone, Debug)]
struct Retargeting {
    drive: Drive,
    /// The body's own skeleton and the roles of its joints.
    skeleton: Arc<Skeleton>,
    roles: Roles,
    /// For each joint of the other skeleton, the joint of the body that it drives; where it drives
    /// none, the one that its parent drives.
    joints_of: Vec<usize>,
    /// For each joint of the body, the joint of the other skeleton that gives it its colour.
    colors_of: Vec<usize>,
}

impl Body {
    /// Makes the body of a skeleton from its rest pose alone. Without `roles`, or with those of
    /// another skeleton, the body consists of one limb per bone.
    #[must_use]
    pub fn new(skeleton: &Skeleton, roles: Option<&Roles>) -> Self {
        Self::standing(skeleton, roles, &skeleton.rest_pose())
    }

    /// Makes the body of a skeleton on its [`canonical_stance`]. `reference` is a pose that shows
    /// the directions of the bones ([`segue_motion::clip::reference_pose`]).
    #[must_use]
    pub fn standing(skeleton: &Skeleton, roles: Option<&Roles>, reference: &WorldPose) -> Self {
        let stance = roles.map_or_else(
            || skeleton.rest_pose(),
            |roles| canonical_stance(skeleton, roles, reference),
        );
        let skeleton = &skeleton.resting_in(&stance);
        let rest = skeleton.rest_positions();
        let mut shapes = limb_shapes(skeleton, &rest, roles);
        shapes.retain(|shape| !shape.soft);
        set_balls_apart(&mut shapes);
        // The renderer computes the shade of the first few limbs only, so the largest come first.
        shapes.sort_by(|x, y| y.weight(&rest).total_cmp(&x.weight(&rest)));
        let shapes = shapes.into_iter().map(|shape| shape.in_axes_of(&stance)).collect();
        Self { shapes, skin: None, retargeting: None, size: None, reach: 0.0 }
    }

    /// Makes the body of a clip of points ([`segue_motion::clip::Clip::is_of_points`]): a ball at
    /// each of them, and nothing between them. Markers of a person are 14 mm wide.
    #[must_use]
    pub fn of_points(skeleton: &Skeleton) -> Self {
        /// The radius as a share of the distance from the middle to the farthest point.
        const RADIUS_SHARE: f32 = 0.008;
        let offsets = skeleton.joints().iter().skip(1).map(|joint| joint.offset.length());
        let farthest = offsets.filter(|length| length.is_finite()).fold(0.0, f32::max);
        let shapes = ball_shapes(1..skeleton.len(), RADIUS_SHARE * farthest);
        Self { shapes, ..Self::default() }
    }

    /// Makes the body of a character that poses of the skeleton `source` with the roles
    /// `roles` move through `drive`.
    #[must_use]
    pub fn retargeted(
        character: &Character,
        drive: Drive,
        source: &Skeleton,
        roles: &Roles,
    ) -> Self {
        let skeleton = &character.skeleton;
        // Parents come first.
        let mut joints_of: Vec<usize> = Vec::with_capacity(source.len());
        for joint in 0..source.len() {
            let above = source.parent(joint).and_then(|parent| joints_of.get(parent).copied());
            joints_of.push(drive.joint_driven_by(joint).or(above).unwrap_or(0));
        }
        // Joints without a namesake take the colour of their parent; parents come first.
        let mut colors_of = vec![0; skeleton.len()];
        for joint in 0..skeleton.len() {
            let namesake = character.roles.role_of(joint).and_then(|role| roles.get(role));
            let parents = skeleton.parent(joint).and_then(|parent| colors_of.get(parent).copied());
            if let Some(color) = colors_of.get_mut(joint) {
                *color = namesake.or(parents).unwrap_or(0);
            }
        }
        Self {
            retargeting: Some(Retargeting {
                drive,
                skeleton: Arc::clone(skeleton),
                roles: character.roles.clone(),
                joints_of,
                colors_of,
            }),
            reach: reach_of(&character.mesh),
            ..Self::new(skeleton, Some(&character.roles)).with_skin(Arc::clone(&character.mesh))
        }
    }

    /// Returns the pose of the drawn figure for a pose of the skeleton that moves the body, by the
    /// directions of its bones.
    #[must_use]
    pub fn drawn_pose(&self, pose: WorldPose) -> WorldPose {
        let Some(Retargeting { drive, .. }) = &self.retargeting else {
            return pose;
        };
        let mut own = WorldPose::default();
        drive.pose(&pose, &mut own);
        own
    }

    /// Returns whether it is the body of a character with this skeleton, in any size.
    pub(crate) fn is_character_of(&self, skeleton: &Skeleton) -> bool {
        self.retargeting.as_ref().is_some_and(|own| own.skeleton.len() == skeleton.len())
    }

    /// Returns the body with another [`size`](Self::size).
    #[must_use]
    pub fn of_size(mut self, size: f32) -> Self {
        self.size = Some(size);
        self
    }

    /// Returns the ratio of the body's own size to the size in which it is drawn.
    #[must_use]
    pub fn size(&self) -> f32 {
        self.size.unwrap_or(1.0)
    }

    /// Returns the reach of a character's mesh, metres ([`reach_of`]); 0 for a procedural body.
    pub(crate) fn reach(&self) -> f32 {
        self.reach
    }

    /// Returns the skeleton of the drawn figure and the roles of its joints: the body's own where
    /// another skeleton moves it.
    pub(crate) fn drawn_rig<'a>(
        &'a self,
        moving: (&'a Skeleton, &'a Roles),
    ) -> (&'a Skeleton, &'a Roles) {
        self.retargeting.as_ref().map_or(moving, |own| (&own.skeleton, &own.roles))
    }

    /// Returns the joint of the drawn figure for a joint of the skeleton that moves the body.
    pub(crate) fn drawn_joint(&self, joint: usize) -> usize {
        let own = self.retargeting.as_ref().and_then(|own| own.joints_of.get(joint));
        own.copied().unwrap_or(joint)
    }

    /// Returns the joint of the skeleton that moves the body from which a joint of the body takes
    /// its colour.
    pub(crate) fn color_joint(&self, joint: usize) -> usize {
        let moving = self.retargeting.as_ref().and_then(|own| own.colors_of.get(joint));
        moving.copied().unwrap_or(joint)
    }

    /// Returns the body with all girths multiplied by `girth`.
    #[must_use]
    pub fn with_girth(mut self, girth: f32) -> Self {
        for shape in &mut self.shapes {
            shape.radius_a *= girth;
            shape.radius_b *= girth;
        }
        self
    }

    /// Returns the body with a skin, which is drawn in place of the limbs; the limbs still shade
    /// the ground. The mesh must be bound to the same skeleton.
    #[must_use]
    pub fn with_skin(self, mesh: Arc<SkinnedMesh>) -> Self {
        Self { skin: Some(mesh), ..self }
    }

    /// Returns the mesh that is drawn in place of the limbs.
    #[must_use]
    pub fn skin(&self) -> Option<&Arc<SkinnedMesh>> {
        self.skin.as_ref()
    }

    /// Returns the greatest number of limbs that [`Body::limbs`] adds.
    #[must_use]
    pub fn limb_count(&self) -> usize {
        self.shapes.len()
    }

    /// Appends the limbs of the body in a pose. Limbs whose joints the pose lacks are left out.
    pub fn limbs(&self, pose: &WorldPose, color: Color, out: &mut Vec<Limb>) {
        self.colored_limbs(pose, |_| color, out);
    }

    /// Appends the limbs of the body in a pose, each in the colour of the joint that moves it.
    pub fn colored_limbs(
        &self,
        pose: &WorldPose,
        color_of: impl Fn(usize) -> Color,
        out: &mut Vec<Limb>,
    ) {
        out.reserve(self.shapes.len());
        for shape in &self.shapes {
            let Some(PlacedShape { a, b, radius_a, radius_b, flat, flatness }) = shape.placed(pose)
            else {
                continue;
            };
            out.push(Limb {
                a,
                b,
                radius_a,
                radius_b,
                flat,
                flatness,
                color: color_of(shape.a.joint),
            });
        }
    }
}
