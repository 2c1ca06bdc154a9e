//! The arms and legs of the mannequin, with hands and feet.

use super::Human;
use crate::skeleton::{Role, Side};
use crate::skin::shapes::Anchor;
use glam::Vec3;

/// [`Shape::held`] of the upper arm, as far as the biceps: without it the underside of a raised arm
/// swells beside the chest.
const SHOULDER_HELD: f32 = 0.25;

/// The least distance of a thigh's axis from the middle, on an adult: less would melt the thighs
/// into one. Above the greatest one, which is outside of the pelvis, half of the rest is kept.
const MIN_HALF_HIPS: f32 = 0.090;
const MAX_HALF_HIPS: f32 = 0.115;

impl Human<'_> {
    pub(super) fn arm(&mut self, side: Side) -> Option<()> {
        let (shoulder, elbow, wrist) = (
            self.joint(Role::upper_arm(side))?,
            self.joint(Role::forearm(side))?,
            self.joint(Role::hand(side))?,
        );
        let middle = |this: &Self, a: usize, b: usize, t: f32| {
            this.anchor(a, this.rest[a].lerp(this.rest[b], t))
        };
        let zero = |joint| Anchor { joint, point: Vec3::ZERO };
        let biceps = middle(self, shoulder, elbow, 0.42);
        self.add(zero(shoulder), 0.058, biceps, 0.048);
        if let Some(shape) = self.shapes.last_mut() {
            shape.held = SHOULDER_HELD;
        }
        self.add(biceps, 0.048, zero(elbow), 0.038);
        let bulge = middle(self, elbow, wrist, 0.24);
        self.add(zero(elbow), 0.038, bulge, 0.042);
        self.add(bulge, 0.042, zero(wrist), 0.026);

        // The palm faces down when the arm is stretched out to the side, inwards when it hangs;
        // `palm` points out of the back of the hand.
        let along = (self.rest[wrist] - self.rest[elbow]).normalize_or(self.axes.left);
        let sign = if side == Side::Left { 1.0 } else { -1.0 };
        let palm = (self.axes.forward.cross(along) * sign).normalize_or(self.axes.up);
        let across = along.cross(palm) * sign;
        let knuckles = self.on(wrist, along * 0.078);
        self.add(zero(wrist), 0.027, knuckles, 0.040);
        self.flatten_last(palm, 0.52);
        let below: Vec<usize> = (wrist + 1..self.rest.len())
            .filter(|&j| self.ancestors(j).any(|a| a == wrist))
            .collect();
        let has_fingers = below.len() >= 10;
        if !has_fingers {
            let tips = self.on(wrist, along * 0.158 - palm * 0.012);
            self.add(knuckles, 0.038, tips, 0.022);
            self.flatten_last(palm, 0.42);
            let (root, tip) = (
                self.on(wrist, along * 0.03 + across * 0.02),
                self.on(wrist, along * 0.088 + across * 0.052 - palm * 0.012),
            );
            self.add(root, 0.018, tip, 0.011);
        }
        for joint in below {
            self.covered[joint] = true;
            if has_fingers && let Some(parent) = self.skeleton.parent(joint) {
                let before = self.shapes.len();
                let (from, radius) =
                    if parent == wrist { (zero(wrist), 0.014) } else { (zero(parent), 0.0098) };
                self.add(from, radius, zero(joint), 0.0092);
                if let Some(end) = self.skeleton.joints()[joint].end_site {
                    self.add(zero(joint), 0.0092, Anchor { joint, point: end }, 0.007);
                }
                // Each finger is a shell of its own; everything between wrist and finger is the
                // palm.
                let finger =
                    self.ancestors(joint).take_while(|&j| j != wrist).last().unwrap_or(joint);
                for shape in self.shapes.iter_mut().skip(before + usize::from(parent == wrist)) {
                    shape.shell = finger;
                }
            }
        }
        self.cover(wrist);
        Some(())
    }

    pub(super) fn leg(&mut self, side: Side) -> Option<()> {
        let s = self.scale;
        let (hip, knee, ankle) = (
            self.joint(Role::thigh(side))?,
            self.joint(Role::shin(side))?,
            self.joint(Role::foot(side))?,
        );
        let zero = |joint| Anchor { joint, point: Vec3::ZERO };
        let down = (self.rest[ankle] - self.rest[hip]).normalize_or(-self.axes.up);
        // Forward from the knee, in the frames of the leg. In some files the legs point up at rest.
        let ahead = down.cross(self.axes.left).normalize_or(self.axes.forward);
        let aside = self.thigh_offset(side)?;
        let root = self.on(hip, aside);
        let thigh = self.anchor(
            hip,
            self.rest[hip].lerp(self.rest[knee], 0.36) + (ahead * 0.010 + aside * 0.7) * s,
        );
        self.add(root, 0.086, thigh, 0.079);
        self.add(thigh, 0.079, self.on(knee, ahead * 0.004), 0.054);
        let calf =
            self.anchor(knee, self.rest[knee].lerp(self.rest[ankle], 0.30) - ahead * (0.014 * s));
        self.add(self.on(knee, ahead * 0.004), 0.054, calf, 0.055);
        self.add(calf, 0.055, zero(ankle), 0.035);
        // The muscle of the calf, and the knee cap.
        let on_shin = |this: &Self, share: f32, forwards: f32| {
            this.anchor(
                knee,
                this.rest[knee].lerp(this.rest[ankle], share) + ahead * (forwards * s),
            )
        };
        let (upper, lower) = (on_shin(self, 0.14, -0.024), on_shin(self, 0.42, -0.022));
        self.add_soft(upper, 0.040, lower, 0.036);
        let (cap, shin) = (on_shin(self, 0.0, 0.020), on_shin(self, 0.16, 0.014));
        self.add_soft(cap, 0.037, shin, 0.034);
        self.cover(ankle);

        let toe = self.joint(Role::toe(side));
        let bone = match toe {
            Some(toe) => self.rest[toe] - self.rest[ankle],
            None => self.skeleton.joints()[ankle]
                .end_site
                .filter(|e| e.length() > 0.05 * s)
                .unwrap_or((ahead * 0.13 + down * 0.06) * s),
        };
        let along = bone.normalize_or(ahead);
        // The sole is level where the resting leg stands on it, and otherwise as under an adult's
        // foot: 27° from the bone above it.
        let rise = along.cross(self.axes.left).normalize_or(-down);
        let slope = along.dot(down);
        let (sin, cos) = if (0.05..0.9).contains(&slope) {
            (slope, (1.0 - slope * slope).sqrt())
        } else {
            libm::sincosf(27f32.to_radians())
        };
        let forward = along * cos + rise * sin;
        let up = rise * cos - along * sin;
        // The centre of the ball of the foot is 2.2 cm above the sole.
        let ball_over_ankle = bone.dot(up) / s;
        let ball = forward * (bone.dot(forward) / s) + up * ball_over_ankle;
        let heel = -forward * 0.030 + up * (ball_over_ankle + 0.012);
        let (heel, ball_on_foot) = (self.on(ankle, heel), self.on(ankle, ball));
        self.add(zero(ankle), 0.037, heel, 0.033);
        self.add(
            self.on(ankle, -forward * 0.024 + up * (ball_over_ankle + 0.002)),
            0.034,
            ball_on_foot,
            0.043,
        );
        self.flatten_last(up, 0.52);
        // The instep descends from the ankle to the ball.
        let (instep, ball_top) = (
            self.on(ankle, forward * 0.010 - up * 0.002),
            self.on(ankle, ball - forward * 0.008 + up * 0.007),
        );
        self.add(instep, 0.038, ball_top, 0.030);
        self.flatten_last(self.axes.left, 1.12);
        let (toe_joint, toe_root) = toe.map_or((ankle, ball), |toe| (toe, Vec3::ZERO));
        self.add(
            self.on(toe_joint, toe_root),
            0.043,
            self.on(toe_joint, toe_root + forward * 0.052 - up * 0.005),
            0.033,
        );
        self.flatten_last(up, 0.50);
        self.cover(toe_joint);
        for joint in ankle + 1..self.rest.len() {
            if self.ancestors(joint).any(|a| a == ankle) {
                self.covered[joint] = true;
            }
        }
        Some(())
    }

    /// Returns the vector from the hip joint to the axis of the thigh, in units of the adult: some
    /// rigs have their hip joints near the middle, and some outside of the body.
    pub(super) fn thigh_offset(&self, side: Side) -> Option<Vec3> {
        let at = |side| Some(self.rest[self.joint(Role::thigh(side))?]);
        let across = at(side)? - at(side.other())?;
        let half = 0.5 * across.length() / self.scale;
        let wanted =
            half.clamp(MIN_HALF_HIPS, MAX_HALF_HIPS + 0.5 * (half - MAX_HALF_HIPS).max(0.0));
        Some(across.normalize_or_zero() * (wanted - half))
    }
}
