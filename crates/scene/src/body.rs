//! A body of tapered limbs, one per shape of [`segue_motion::skin::shapes`]: posed in microseconds,
//! whatever the skeleton.

#[cfg(test)]
mod tests;

use super::{Color, Limb};
use segue_motion::skeleton::{Roles, Skeleton, WorldPose, canonical_stance};
use segue_motion::skin::shapes::{PlacedShape, Shape, limb_shapes};
use segue_motion::skin::{Character, Drive, SkinnedMesh};
use std::borrow::Cow;
use std::sync::Arc;

/// Where two limbs meet in the same ball, the second one's becomes a little smaller, lest both
/// surfaces flicker through each other.
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

/// The shapes of one skeleton's body, made once and posed every frame.
///
/// With the roles of a human it becomes a mannequin of human proportions (segment lengths are the
/// skeleton's own; girths follow the body height). Any other tree gets one tapered limb per bone,
/// each as thick as what hangs on it asks for.
#[derive(Clone, Debug, Default)]
pub struct Body {
    shapes: Vec<Shape>,
    skin: Option<Arc<SkinnedMesh>>,
    led: Option<Led>,
    size: Option<f32>,
}

/// How a body is moved by poses of a skeleton that is not its own.
#[derive(Clone, Debug)]
struct Led {
    drive: Drive,
    /// The skeleton of the body itself, and what its joints are for.
    skeleton: Arc<Skeleton>,
    roles: Roles,
    /// The joint that each joint of the other skeleton drives, else the one that its parent does.
    joints_of: Vec<usize>,
    /// For each of its joints the joint of the other skeleton whose colour it wears.
    colors_of: Vec<usize>,
}

impl Body {
    /// Makes the body of a skeleton of which nothing is known but its rest pose. `roles` may be
    /// missing or belong to another skeleton: the body is then plainer.
    #[must_use]
    pub fn new(skeleton: &Skeleton, roles: Option<&Roles>) -> Self {
        Self::standing(skeleton, roles, &skeleton.rest_pose())
    }

    /// Makes the body of a skeleton on its [`canonical_stance`]; `reference` shows how the bones
    /// lie to each other ([`segue_motion::clip::reference_pose`]).
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
        // The renderer lets only the first few of a body shade the others: the big ones come first.
        shapes.sort_by(|x, y| y.weight(&rest).total_cmp(&x.weight(&rest)));
        let shapes = shapes.into_iter().map(|shape| shape.in_axes_of(&stance)).collect();
        Self { shapes, skin: None, led: None, size: None }
    }

    /// The body of a character that poses of another skeleton, with those roles, move through
    /// `drive`.
    #[must_use]
    pub fn led(character: &Character, drive: Drive, source: &Skeleton, roles: &Roles) -> Self {
        let skeleton = &character.skeleton;
        // Parents come first.
        let mut joints_of: Vec<usize> = Vec::with_capacity(source.len());
        for joint in 0..source.len() {
            let above = source.parent(joint).and_then(|parent| joints_of.get(parent).copied());
            joints_of.push(drive.joint_driven_by(joint).or(above).unwrap_or(0));
        }
        // Joints without a namesake go with the one that they hang on; parents come first.
        let mut colors_of = vec![0; skeleton.len()];
        for joint in 0..skeleton.len() {
            let namesake = character.roles.role_of(joint).and_then(|role| roles.get(role));
            let parents = skeleton.parent(joint).and_then(|parent| colors_of.get(parent).copied());
            if let Some(color) = colors_of.get_mut(joint) {
                *color = namesake.or(parents).unwrap_or(0);
            }
        }
        Self {
            led: Some(Led {
                drive,
                skeleton: Arc::clone(skeleton),
                roles: character.roles.clone(),
                joints_of,
                colors_of,
            }),
            ..Self::new(skeleton, Some(&character.roles)).with_skin(Arc::clone(&character.mesh))
        }
    }

    /// The pose of the body's own skeleton for a pose of the one that moves it, written to `out`;
    /// `None` where both are the same.
    pub(super) fn led_pose<'a>(
        &self,
        pose: &WorldPose,
        out: &'a mut WorldPose,
    ) -> Option<&'a WorldPose> {
        let led = self.led.as_ref()?;
        led.drive.pose(pose, out);
        Some(out)
    }

    /// The pose of the figure that is seen for a pose of the skeleton that moves the body.
    pub(super) fn seen_pose<'a>(&self, pose: &'a WorldPose) -> Cow<'a, WorldPose> {
        let mut led = WorldPose::default();
        if self.led_pose(pose, &mut led).is_some() {
            return Cow::Owned(led);
        }
        Cow::Borrowed(pose)
    }

    /// The body as one that is by itself so many times as large as it is drawn.
    #[must_use]
    pub fn of_size(mut self, size: f32) -> Self {
        self.size = Some(size);
        self
    }

    /// How many times as large the body is by itself as it is drawn.
    #[must_use]
    pub fn size(&self) -> f32 {
        self.size.unwrap_or(1.0)
    }

    /// The skeleton of the figure that is seen, and what its joints are for: its own where another
    /// skeleton moves the body.
    pub(super) fn seen<'a>(
        &'a self,
        moving: (&'a Skeleton, &'a Roles),
    ) -> (&'a Skeleton, &'a Roles) {
        self.led.as_ref().map_or(moving, |led| (&led.skeleton, &led.roles))
    }

    /// The joint of the figure that is seen for one of the skeleton that moves the body.
    pub(super) fn seen_joint(&self, joint: usize) -> usize {
        let led = self.led.as_ref().and_then(|led| led.joints_of.get(joint));
        led.copied().unwrap_or(joint)
    }

    /// The joint of the skeleton that moves the body whose colour one of its own joints wears.
    pub(super) fn color_joint(&self, joint: usize) -> usize {
        let led = self.led.as_ref().and_then(|led| led.colors_of.get(joint));
        led.copied().unwrap_or(joint)
    }

    /// The body with girths so many times as wide.
    #[must_use]
    pub fn with_girth(mut self, girth: f32) -> Self {
        for shape in &mut self.shapes {
            shape.radius_a *= girth;
            shape.radius_b *= girth;
        }
        self
    }

    /// The body in a skin: it is seen in place of the limbs, which go on to shade the ground. The
    /// mesh is one of the same skeleton.
    #[must_use]
    pub fn with_skin(self, mesh: Arc<SkinnedMesh>) -> Self {
        Self { skin: Some(mesh), ..self }
    }

    /// The mesh over the limbs.
    #[must_use]
    pub fn skin(&self) -> Option<&Arc<SkinnedMesh>> {
        self.skin.as_ref()
    }

    /// The number of limbs that [`Body::limbs`] adds at most.
    #[must_use]
    pub fn limb_count(&self) -> usize {
        self.shapes.len()
    }

    /// Appends the limbs of the body in a pose. Joints that the pose does not have are left out.
    pub fn limbs(&self, pose: &WorldPose, color: Color, out: &mut Vec<Limb>) {
        self.colored_limbs(pose, |_| color, out);
    }

    /// Likewise, each limb in the colour of the joint that moves it.
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
