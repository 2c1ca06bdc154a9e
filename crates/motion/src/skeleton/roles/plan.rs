//! The number of legs on which a body stands, by its shape.

use super::{Roles, is_below};
use crate::skeleton::{BodyPlan, Foot, FootPair, Role, Skeleton, WorldPose, rests_on_two_legs};
use glam::Vec3;

/// The least distance from hip joints to shoulder joints, as a share of the length of thigh and
/// shin. People have 0.6, cats, dogs and horses 1.1 to 1.8.
const MIN_TRUNK: f32 = 0.8;
/// The greatest sine of the slope of a level trunk (37°).
const MAX_SLOPE: f32 = 0.6;
/// The least cosine of the angle of a leg, from its first joint to its foot, to the vertical.
const MIN_DOWN: f32 = 0.6;
/// The greatest distance of the level of the forefeet from that of the hind feet, as a share of the
/// height of the trunk above them.
const MAX_STEP: f32 = 0.3;
/// The least share of the poses that have to stand on four legs.
const MIN_SHARE: f32 = 0.5;

/// Returns the body plan that the rest pose shows.
pub(super) fn at_rest(skeleton: &Skeleton, roles: &Roles) -> BodyPlan {
    if stands_at_rest(skeleton, roles) { BodyPlan::Quadruped } else { BodyPlan::Biped }
}

/// Returns whether the rest pose stands on four legs, those of these roles.
pub(super) fn stands_at_rest(skeleton: &Skeleton, roles: &Roles) -> bool {
    FourLegs::of(skeleton, roles).is_some_and(|legs| legs.stand_in(&skeleton.rest_positions()))
}

/// Returns the body plan that the rest pose shows, or, where that does not stand, the poses.
pub(super) fn of(
    skeleton: &Skeleton,
    roles: &Roles,
    poses: impl IntoIterator<Item = WorldPose>,
) -> BodyPlan {
    let Some(legs) = FourLegs::of(skeleton, roles) else { return BodyPlan::Biped };
    if legs.stand_in(&skeleton.rest_positions()) {
        return BodyPlan::Quadruped;
    }
    if rests_on_two_legs(skeleton, roles) {
        return BodyPlan::Biped;
    }
    let (mut stand, mut all) = (0_usize, 0_usize);
    for pose in poses {
        stand += usize::from(legs.stand_in(&pose.positions));
        all += 1;
    }
    let is_most = all > 0 && stand as f32 >= MIN_SHARE * all as f32;
    if is_most { BodyPlan::Quadruped } else { BodyPlan::Biped }
}

/// The legs that a body on four legs would have.
struct FourLegs {
    /// The joints at the beginning and the end of each leg, by [`Foot::index`].
    legs: [(usize, usize); 4],
    /// The joints of each foot: the end of the leg and everything below it.
    feet: [Vec<usize>; 4],
    /// The length of thigh and shin, metres.
    length_m: f32,
}

impl FourLegs {
    /// Returns the legs of a body whose trunk may be long enough; `None` where it is too short, or
    /// where roles are missing.
    fn of(skeleton: &Skeleton, roles: &Roles) -> Option<Self> {
        let joint = |role| roles.get_within(role, skeleton.len());
        let leg = |foot: Foot| {
            let [first, _, last] = foot.leg();
            Some((joint(first)?, joint(last)?))
        };
        let [Some(a), Some(b), Some(c), Some(d)] = Foot::ALL.map(leg) else { return None };
        let legs = [a, b, c, d];
        let length_m = roles.leg_length(skeleton)?;
        if longest_trunk_m(skeleton, a.0, c.0) < MIN_TRUNK * length_m {
            return None;
        }
        let feet = legs.map(|(_, end)| {
            let below =
                (end..skeleton.len()).filter(|&of| of == end || is_below(skeleton, of, end));
            below.collect()
        });
        Some(Self { legs, feet, length_m })
    }

    /// Returns whether the trunk is level and long, and all legs point down from it to one level.
    fn stand_in(&self, positions: &[Vec3]) -> bool {
        let at = |joint: usize| positions.get(joint).copied().unwrap_or_default();
        let middle = |pair: [usize; 2]| (at(self.legs[pair[0]].0) + at(self.legs[pair[1]].0)) * 0.5;
        let (hips, shoulders) = (middle([0, 1]), middle([2, 3]));
        let trunk = shoulders - hips;
        let is_level = trunk.length() >= MIN_TRUNK * self.length_m
            && trunk.y.abs() <= MAX_SLOPE * trunk.length();
        let all_down = self
            .legs
            .iter()
            .all(|&(start, end)| (at(start) - at(end)).normalize_or_zero().y >= MIN_DOWN);
        let level = |pair: [usize; 2]| {
            let lowest = |foot: usize| {
                self.feet[foot].iter().map(|&joint| at(joint).y).fold(f32::INFINITY, f32::min)
            };
            lowest(pair[0]).min(lowest(pair[1]))
        };
        let (hind, fore) = (level([0, 1]), level([2, 3]));
        let height = (hips.y + shoulders.y - hind - fore) * 0.5;
        is_level && all_down && height > 0.0 && (hind - fore).abs() <= MAX_STEP * height
    }
}

/// Returns a length that the trunk does not exceed in any pose, metres: that of the bones between
/// a hip joint and the shoulder joint of the same side.
fn longest_trunk_m(skeleton: &Skeleton, thigh: usize, arm: usize) -> f32 {
    let up = |from: usize| std::iter::successors(Some(from), |&at| skeleton.parent(at));
    let Some(meeting) = up(arm).find(|&joint| up(thigh).any(|other| other == joint)) else {
        return 0.0;
    };
    let bones = |from: usize| up(from).take_while(move |&joint| joint != meeting);
    bones(thigh).chain(bones(arm)).map(|joint| skeleton.joints()[joint].offset.length()).sum()
}

/// Returns the points of a foot that can touch the ground: of a hind foot ankle, ball and tip, of a
/// forefoot the end of the leg, the next joint and the tip; each as a joint and a point in its
/// frame (metres), `None` where the skeleton has no such point.
pub(super) fn points_of(
    skeleton: &Skeleton,
    roles: &Roles,
    foot: Foot,
) -> [Option<(usize, Vec3)>; 3] {
    let joint = |role| roles.get_within(role, skeleton.len());
    let [_, _, end] = foot.leg();
    let ankle = joint(end);
    let toe = match foot.pair {
        FootPair::Hind => joint(Role::toe(foot.side)),
        FootPair::Fore => None,
    };
    let origin = |joint: Option<usize>| joint.map(|joint| (joint, Vec3::ZERO));
    if !roles.is_quadruped() {
        // The tip of a foot without toes is its own end site.
        let tip = toe.or(ankle).and_then(|last| Some((last, skeleton.joints()[last].end_site?)));
        return [origin(ankle), origin(toe), tip];
    }
    let ball = toe.or_else(|| longest_child(skeleton, ankle?));
    let Some(mut last) = ball.or(ankle) else { return [None; 3] };
    while let Some(next) = longest_child(skeleton, last) {
        last = next;
    }
    let tip = match skeleton.joints()[last].end_site {
        Some(end) => Some((last, end)),
        None => origin(Some(last)).filter(|_| Some(last) != ball && Some(last) != ankle),
    };
    [origin(ankle), origin(ball), tip]
}

/// Returns the child with the longest chain of bones below it, the first of equal ones.
fn longest_child(skeleton: &Skeleton, joint: usize) -> Option<usize> {
    let mut best: Option<(f32, usize)> = None;
    for child in skeleton.children(joint) {
        let mut longest = 0.0_f32;
        let mut left = vec![(child, skeleton.joints()[child].offset.length())];
        while let Some((at, along)) = left.pop() {
            let end = skeleton.joints()[at].end_site.map_or(0.0, Vec3::length);
            longest = longest.max(along + end);
            let below = skeleton.children(at);
            left.extend(below.map(|next| (next, along + skeleton.joints()[next].offset.length())));
        }
        if best.is_none_or(|(known, _)| longest > known) {
            best = Some((longest, child));
        }
    }
    best.map(|(_, child)| child)
}
