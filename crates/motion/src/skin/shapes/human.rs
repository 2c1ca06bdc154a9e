//! The mannequin: girths and landmarks of an adult, scaled to the skeleton.
//!
//! Lengths along the body are the skeleton's. Girths and the positions of landmarks off the bones
//! (heel, chin, calf) are those of an adult of 1.75 m, rounded from the tables in Winter,
//! "Biomechanics and Motor Control of Human Movement", and scaled with the body height.

mod limbs;

use super::{Anchor, PlacedShape, Shape};
use crate::skeleton::{Role, Roles, Side, Skeleton, is_control};
use crate::skin::field::Cone;
use glam::Vec3;

/// How far a raised arm draws the flanks and the breast, in their radii: the motion of the shoulder
/// reaches over the top of it, and ends in the armpit.
const CHEST_SPREAD: f32 = 0.25;
/// The body axes at rest, where all joint frames agree: left and up span the trunk, forward points
/// out of the chest.
struct Axes {
    left: Vec3,
    up: Vec3,
    forward: Vec3,
}

struct Human<'a> {
    skeleton: &'a Skeleton,
    rest: &'a [Vec3],
    roles: &'a Roles,
    axes: Axes,
    /// Body height relative to the adult for whom the numbers below apply.
    scale: f32,
    /// Whether the shapes of the mannequin represent each joint.
    covered: Vec<bool>,
    shapes: Vec<Shape>,
}

/// The distance between hips and shoulders as a share of an adult's height (Winter, figure 4.1).
const TRUNK_SHARE: f32 = 0.288;
/// How much longer than an adult's a trunk is, on legs of one length, before the girths follow it.
const LONG_TRUNK: f32 = 1.15;
/// The greatest size of a head, relative to one that is as large as the rest of the body.
const MAX_HEAD: f32 = 2.0;
/// How far the end of a bone that is no part of a person must stand out of the body to be shown, on
/// an adult, metres: twist and helper joints lie in it.
const MIN_PROTRUSION: f32 = 0.045;

/// The least cosine of the angle between the trunk and either leg of a person, downwards: less is
/// an animal on four legs, or a body that lies folded.
const MIN_UPRIGHT: f32 = 0.55;

/// Returns whether a skeleton that rests at `rest` is that of a person: two legs that point down
/// from the trunk, two arms and a head.
pub(in crate::skin) fn is_person(rest: &[Vec3], roles: &Roles) -> bool {
    let at = |role| roles.get_within(role, rest.len()).map(|joint| rest[joint]);
    let direction = |from, to| Some((at(to)? - at(from)?).normalize_or_zero());
    let has_arms = Side::BOTH
        .into_iter()
        .all(|side| Role::arm(side).into_iter().all(|role| at(role).is_some()));
    let is_upright = || {
        let (left, right) = (at(Role::LeftThigh)?, at(Role::RightThigh)?);
        let up = (at(Role::Head)? - (left + right) * 0.5).try_normalize()?;
        let legs = Side::BOTH.map(|side| direction(Role::thigh(side), Role::foot(side)));
        let [left, right] = legs.map(|leg| leg.map_or(0.0, |leg| -leg.dot(up)));
        Some(left.min(right) >= MIN_UPRIGHT)
    };
    has_arms && !roles.is_quadruped() && is_upright().unwrap_or(false)
}

/// Returns the shapes, or `None` where the roles are not those of a person.
pub(super) fn shapes(skeleton: &Skeleton, rest: &[Vec3], roles: &Roles) -> Option<Vec<Shape>> {
    if !is_person(rest, roles) {
        return None;
    }
    let joint = |role| roles.get_within(role, rest.len());
    let at = |role| Some(rest[joint(role)?]);
    let (hip_left, hip_right) = (at(Role::LeftThigh)?, at(Role::RightThigh)?);
    let (shoulder_left, shoulder_right) = (at(Role::LeftUpperArm)?, at(Role::RightUpperArm)?);
    joint(Role::Hips)?;
    let up = (at(Role::Head)? - (hip_left + hip_right) * 0.5).try_normalize()?;
    let across = (hip_left - hip_right) + (shoulder_left - shoulder_right);
    let left = (across - up * across.dot(up)).try_normalize()?;
    let scale = scale(skeleton, rest, roles)?;
    if !(scale.is_finite() && scale > 0.0) {
        return None;
    }
    let axes = Axes { left, up, forward: left.cross(up) };
    let mut human = Human {
        skeleton,
        rest,
        roles,
        axes,
        scale,
        covered: vec![false; rest.len()],
        shapes: Vec::with_capacity(64),
    };
    human.trunk()?;
    human.head()?;
    for side in Side::BOTH {
        human.arm(side)?;
        human.leg(side)?;
    }
    human.add_other_bones();
    Some(human.shapes)
}

/// Returns the size of the body relative to an adult of 1.75 m: that of its legs, and more where
/// its trunk is much longer than an adult's on such legs (a child, a figure of a comic).
fn scale(skeleton: &Skeleton, rest: &[Vec3], roles: &Roles) -> Option<f32> {
    let at = |role| roles.get_within(role, rest.len()).map(|joint| rest[joint]);
    let middle =
        |role: fn(Side) -> Role| Some((at(role(Side::Left))? + at(role(Side::Right))?) * 0.5);
    let trunk = middle(Role::thigh)?.distance(middle(Role::upper_arm)?);
    let height = roles.body_height(skeleton);
    let longer = (trunk / TRUNK_SHARE / height / LONG_TRUNK).max(1.0);
    Some(libm::powf(longer, 0.75) * height / 1.75)
}

impl Human<'_> {
    fn joint(&self, role: Role) -> Option<usize> {
        self.roles.get_within(role, self.rest.len())
    }

    /// Returns an anchor that is at `rest` in the rest pose and moves with `joint`.
    fn anchor(&self, joint: usize, rest: Vec3) -> Anchor {
        Anchor { joint, point: rest - self.rest[joint] }
    }

    fn on(&self, joint: usize, offset: Vec3) -> Anchor {
        Anchor { joint, point: offset * self.scale }
    }

    /// Adds a shape with radii of the adult.
    fn add(&mut self, a: Anchor, radius_a: f32, b: Anchor, radius_b: f32) {
        self.shapes.push(Shape::round(a, radius_a * self.scale, b, radius_b * self.scale));
    }

    /// Adds a shape that is used only for surfaces that blend with their neighbours.
    fn add_soft(&mut self, a: Anchor, radius_a: f32, b: Anchor, radius_b: f32) {
        self.add(a, radius_a, b, radius_b);
        if let Some(shape) = self.shapes.last_mut() {
            shape.soft = true;
        }
    }

    /// Returns the joints from `joint` up to the root.
    fn ancestors(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(joint), |&j| self.skeleton.parent(j))
    }

    fn cover(&mut self, from: usize) {
        for joint in std::iter::successors(Some(from), |&j| self.skeleton.parent(j)) {
            self.covered[joint] = true;
        }
    }

    /// Returns the joint from which both arms hang.
    fn chest(&self) -> Option<usize> {
        let (left, right) = (self.joint(Role::LeftUpperArm)?, self.joint(Role::RightUpperArm)?);
        self.ancestors(left)
            .skip(1)
            .find(|&joint| self.ancestors(right).any(|other| other == joint))
    }

    fn trunk(&mut self) -> Option<()> {
        let Axes { left, up, forward } = self.axes;
        let s = self.scale;
        let (hips, chest) = (self.joint(Role::Hips)?, self.chest()?);
        let (hip_left, hip_right) = (self.joint(Role::LeftThigh)?, self.joint(Role::RightThigh)?);
        let (arm_left, arm_right) =
            (self.joint(Role::LeftUpperArm)?, self.joint(Role::RightUpperArm)?);
        let hip_middle = (self.rest[hip_left] + self.rest[hip_right]) * 0.5;
        let shoulder_middle = (self.rest[arm_left] + self.rest[arm_right]) * 0.5;
        let half_hips = self.rest[hip_left].distance(self.rest[hip_right]) * 0.5 / s;
        let half_shoulders = self.rest[arm_left].distance(self.rest[arm_right]) * 0.5 / s;
        // Half of the width is that of an adult, half the skeleton's own.
        let pelvis = (0.076 + (half_hips + 0.06) * 0.5).clamp(0.11, 0.19);
        let ribs = (0.074 + (half_shoulders - 0.03) * 0.5).clamp(0.11, 0.2);
        let waist = 0.5 * (pelvis + ribs) * 0.87;

        let mut spine: Vec<usize> = self.ancestors(chest).take_while(|&j| j != hips).collect();
        spine.push(hips);
        spine.reverse();
        let trunk = shoulder_middle - hip_middle;
        let height = trunk.dot(up);
        // Each landmark moves with the highest joint of the back that lies below it.
        let landmark = |this: &Self, part: f32, ahead: f32| {
            let point = hip_middle + trunk * part + forward * (ahead * s);
            let level = (point - hip_middle).dot(up);
            let below = spine
                .iter()
                .rev()
                .copied()
                .find(|&j| (this.rest[j] - hip_middle).dot(up) <= level + 1e-4 * height);
            this.anchor(below.unwrap_or(hips), point)
        };
        // The lowest point of the trunk is between the thighs, whatever its width.
        let low = Anchor {
            joint: hips,
            point: hip_middle + up * ((pelvis - 0.050) * s) - self.rest[hips],
        };
        let (belly, lower_ribs, upper_ribs) =
            (landmark(self, 0.40, 0.0), landmark(self, 0.60, 0.005), landmark(self, 0.80, 0.0));
        self.add(low, pelvis, belly, waist);
        self.flatten_last(forward, 0.70);
        self.add(belly, waist, lower_ribs, ribs * 0.90);
        self.flatten_last(forward, 0.70);
        self.add(lower_ribs, ribs * 0.90, upper_ribs, ribs);
        self.flatten_last(forward, 0.70);

        // The seat and the rib cage, from side to side.
        let seat = |this: &Self, hip: usize| {
            this.anchor(
                hips,
                this.rest[hip].lerp(hip_middle, 0.26) + up * (0.034 * s) - forward * (0.024 * s),
            )
        };
        let (seat_left, seat_right) = (seat(self, hip_left), seat(self, hip_right));
        self.add(seat_left, 0.079, seat_right, 0.079);
        for (side, hip) in [(Side::Left, hip_left), (Side::Right, hip_right)] {
            let aside = self.thigh_offset(side)?;
            // Half of the seat, and its transition to the thigh.
            let knee = self
                .skeleton
                .children(hip)
                .next()
                .map_or(-up, |knee| self.skeleton.joints()[knee].offset)
                .normalize_or(-up);
            let buttock = self.anchor(
                hips,
                self.rest[hip].lerp(hip_middle, 0.30) + aside * (0.5 * s)
                    - up * (0.004 * s)
                    - forward * (0.048 * s),
            );
            // In the frame of a leg that may rest upside down.
            let behind = left.cross(knee).normalize_or(-forward);
            let fold = self.on(hip, aside + knee * 0.110 + behind * 0.014);
            self.add_soft(buttock, 0.070, fold, 0.057);
        }
        let breast = |this: &Self, arm: usize| {
            this.anchor(
                chest,
                this.rest[arm].lerp(shoulder_middle, 0.56) - up * (0.078 * s)
                    + forward * (0.018 * s),
            )
        };
        let (breast_left, breast_right) = (breast(self, arm_left), breast(self, arm_right));
        self.add(breast_left, 0.077, breast_right, 0.077);
        self.spread_last(1, CHEST_SPREAD);
        for (side, arm) in [(1.0, arm_left), (-1.0, arm_right)] {
            let girdle =
                self.anchor(chest, shoulder_middle + left * (side * 0.05 * s) - up * (0.022 * s));
            self.add(girdle, 0.066, Anchor { joint: arm, point: Vec3::ZERO }, 0.056);
            // The hollow of the armpit is filled.
            let flank = self.anchor(
                chest,
                shoulder_middle + left * (side * 0.075 * s)
                    - up * (0.13 * s)
                    - forward * (0.012 * s),
            );
            let armpit =
                self.anchor(chest, self.rest[arm].lerp(shoulder_middle, 0.16) - up * (0.028 * s));
            self.add(flank, 0.060, armpit, 0.046);
            self.spread_last(1, CHEST_SPREAD);
            // The muscle of the chest, and that of the back, which narrows towards the waist.
            let at = |this: &Self, share: f32, down: f32, ahead: f32| {
                this.anchor(
                    chest,
                    this.rest[arm].lerp(shoulder_middle, share) - up * (down * s)
                        + forward * (ahead * s),
                )
            };
            let (breast, inner) = (at(self, 0.30, 0.060, 0.030), at(self, 0.66, 0.094, 0.044));
            self.add_soft(breast, 0.040, inner, 0.052);
            let (wing, low) = (at(self, 0.26, 0.085, -0.030), at(self, 0.62, 0.235, -0.012));
            self.add_soft(wing, 0.044, low, 0.042);
            self.spread_last(2, CHEST_SPREAD);
        }
        self.cover(chest);
        Some(())
    }

    fn head(&mut self) -> Option<()> {
        let Axes { up, forward, .. } = self.axes;
        let head = self.joint(Role::Head)?;
        let chest = self.chest()?;
        let neck = self.ancestors(head).skip(1).take_while(|&j| j != chest).last().unwrap_or(chest);
        let shoulders = (self.rest[self.joint(Role::LeftUpperArm)?]
            + self.rest[self.joint(Role::RightUpperArm)?])
            * 0.5;
        let throat = if neck == head { chest } else { neck };
        let base = self
            .anchor(throat, shoulders.lerp(self.rest[head], 0.10) - forward * (0.004 * self.scale));
        // The top of the head: from the file, or estimated for a joint at the base of the skull. A
        // large head is large all over.
        let ends = self.skeleton.children(head).filter(|&child| {
            self.skeleton.children(child).next().is_none()
                && (self.rest[child] - self.rest[head]).reject_from_normalized(up).length()
                    < 0.05 * self.scale
        });
        let ends = ends.map(|child| self.rest[child] - self.rest[head]);
        let above = ends.chain(self.skeleton.joints()[head].end_site).map(|end| end.dot(up));
        let from_file = above.fold(0.0, f32::max) / self.scale;
        let share = ((from_file - 0.22) / 0.10).clamp(0.0, 1.0);
        let size = (1.0 + share * (from_file / 0.20 - 1.0)).clamp(1.0, MAX_HEAD);
        let from_file = from_file / size;
        let crown = if (0.12..0.26).contains(&from_file) { from_file } else { 0.19 };
        let top = self.on(head, up * ((crown - 0.13) * size) - forward * 0.004);
        self.add(base, 0.055, top, 0.049);
        for side in Side::BOTH {
            // From the side of the neck down to the shoulder.
            let nape = self.anchor(
                throat,
                shoulders.lerp(self.rest[head], 0.40) - forward * (0.012 * self.scale),
            );
            let shoulder = Anchor {
                joint: self.joint(Role::upper_arm(side))?,
                point: -up * (0.004 * self.scale),
            };
            self.add(nape, 0.044, shoulder, 0.047);
        }
        let scale = self.scale;
        self.scale *= size;
        self.skull(head, crown);
        self.scale = scale;
        self.cover(head);
        Some(())
    }

    /// Adds everything above the neck; `crown` is the height of the top over the joint.
    fn skull(&mut self, head: usize, crown: f32) {
        let Axes { left, up, forward } = self.axes;
        let (cranium, chin) = (
            self.on(head, up * (crown - 0.094)),
            self.on(head, up * (crown - 0.168) + forward * 0.038),
        );
        let (brow, tip) = (
            self.on(head, up * (crown - 0.100) + forward * 0.083),
            self.on(head, up * (crown - 0.138) + forward * 0.098),
        );
        self.add(cranium, 0.092, chin, 0.056);
        self.flatten_last(left, 0.83);
        self.add(brow, 0.010, tip, 0.0125);
        // Chin and jaw, the ridge over the eyes, the back of the head, ears.
        let point = self.on(head, up * (crown - 0.196) + forward * 0.066);
        for side in [1.0, -1.0] {
            let jaw = self.on(head, up * (crown - 0.168) + forward * 0.006 + left * (side * 0.044));
            self.add_soft(point, 0.024, jaw, 0.026);
            let (temple, between) = (
                self.on(head, up * (crown - 0.098) + forward * 0.058 + left * (side * 0.040)),
                self.on(head, up * (crown - 0.096) + forward * 0.078 + left * (side * 0.010)),
            );
            self.add_soft(temple, 0.014, between, 0.012);
            let (ear, lobe) = (
                self.on(head, up * (crown - 0.108) - forward * 0.008 + left * (side * 0.078)),
                self.on(head, up * (crown - 0.134) - forward * 0.002 + left * (side * 0.072)),
            );
            self.add_soft(ear, 0.019, lobe, 0.012);
            self.flatten_last(left, 0.45);
        }
        let nape = self.on(head, up * (crown - 0.105) - forward * 0.026);
        self.add_soft(cranium, 0.080, nape, 0.074);
    }

    /// Sets [`Shape::spread`] of the last shapes.
    fn spread_last(&mut self, shapes: usize, spread: f32) {
        for shape in self.shapes.iter_mut().rev().take(shapes) {
            shape.spread = spread;
        }
    }

    fn flatten_last(&mut self, flat: Vec3, flatness: f32) {
        if let Some(shape) = self.shapes.last_mut() {
            *shape = shape.flattened(flat, flatness);
        }
    }

    /// Adds limbs for bones that are not part of a human body: tails, bags, swords. Bones inside
    /// the head or the rest of the body, controls, and bones beside the hips are left out.
    fn add_other_bones(&mut self) {
        let (head, hips) = (self.joint(Role::Head), self.joint(Role::Hips));
        let body: Vec<Cone> =
            self.shapes.iter().map(|shape| Cone::new(&self.at_rest(shape))).collect();
        for joint in 1..self.rest.len() {
            let Some(parent) = self.skeleton.parent(joint) else {
                continue;
            };
            let length = self.skeleton.joints()[joint].offset.length() / self.scale;
            let in_head =
                head.is_some_and(|head| self.ancestors(joint).any(|a| a == head)) && length < 0.25;
            let is_below_hips = self.ancestors(joint).any(|above| Some(above) == hips);
            if self.covered[joint]
                || in_head
                || length < 0.03
                || !is_below_hips
                || is_control(&self.skeleton.joints()[joint].name)
                || self.between_roles(joint)
            {
                continue;
            }
            let ends = self.skeleton.joints()[joint].end_site.map(|end| self.rest[joint] + end);
            let stands_out = |point: Vec3| {
                let distances = body.iter().map(|cone| cone.measure(point).distance);
                distances.fold(f32::INFINITY, f32::min) > MIN_PROTRUSION * self.scale
            };
            if !ends.into_iter().chain([self.rest[joint]]).any(stands_out) {
                continue;
            }
            let radius = (length * 0.16).min(0.028);
            let zero = |joint| Anchor { joint, point: Vec3::ZERO };
            self.add(zero(parent), radius, zero(joint), radius * 0.75);
            if let Some(end) = self.skeleton.joints()[joint].end_site {
                self.add(zero(joint), radius * 0.75, Anchor { joint, point: end }, radius * 0.5);
            }
        }
    }

    /// Returns a shape as it lies in the rest pose.
    fn at_rest(&self, shape: &Shape) -> PlacedShape {
        PlacedShape {
            a: self.rest[shape.a.joint] + shape.a.point,
            b: self.rest[shape.b.joint] + shape.b.point,
            radius_a: shape.radius_a,
            radius_b: shape.radius_b,
            flat: shape.flat,
            flatness: shape.flatness,
        }
    }

    /// Returns whether a joint with a role is below; the joint then belongs to a chain that the
    /// mannequin has already.
    fn between_roles(&self, joint: usize) -> bool {
        Role::ALL
            .into_iter()
            .filter_map(|role| self.joint(role))
            .any(|end| self.ancestors(end).any(|a| a == joint))
    }
}
