//! The limbs of both bodies, frame by frame.

use super::Task;
use crate::clip::Clip;
use crate::skeleton::{Foot, FootPair, Roles, Side, Skeleton, WorldPose, canonical_stance};
use crate::transition::{Limb, LimbPose};
use glam::Vec3;
use std::ops::Range;

/// The mean sine of the flexion over a clip above which the motion determines the axis of a knee,
/// even against the rest pose: the hind legs of animals bend the other way.
const OWN_AXIS_SINE: f32 = 0.2;
/// The weight of the rest pose's axis relative to that of the motion.
const REST_AXIS_SINE: f32 = 0.02;

/// A leg or an arm of both bodies.
#[derive(Debug)]
pub(super) struct LimbTrack {
    pub(super) limb: Limb,
    /// The target's limb with the directions of the source's, frame by frame.
    pub(super) posed: Vec<LimbPose>,
    /// The axis of its knee or elbow, in the frame of the upper bone.
    pub(super) axis: Vec3,
    /// The source's limb: its start, its end, and the total length of its bones, metres.
    pub(super) source: Vec<(Vec3, Vec3, f32)>,
    /// The start of the target's limb.
    pub(super) starts: Vec<Vec3>,
}

/// The feet of both bodies: ankle, ball and tip in each frame.
#[derive(Debug)]
pub(super) struct FootTrack {
    /// The kinds of points that the source has, and the target.
    pub(super) has: [[bool; 3]; 2],
    pub(super) source: Vec<[Vec3; 3]>,
    pub(super) target: Vec<[Vec3; 3]>,
}

/// The tracks of both clips.
#[derive(Debug)]
pub(super) struct Tracks {
    /// Legs with their feet, and arms; left, then right.
    pub(super) legs: [Option<(LimbTrack, FootTrack)>; 2],
    pub(super) arms: [Option<LimbTrack>; 2],
    /// The forefeet of the arms, where both bodies stand on four legs.
    pub(super) forefeet: [Option<FootTrack>; 2],
    /// The limbs of the source, and of the target.
    theirs: Limbs,
    ours: Limbs,
}

/// The limbs of one body.
#[derive(Debug)]
struct Limbs {
    legs: [Option<Limb>; 2],
    arms: [Option<Limb>; 2],
    feet: [FootPoints; 2],
    forefeet: [FootPoints; 2],
}

/// Ankle, ball and tip of a foot, each as a joint and a point in its frame.
type FootPoints = [Option<(usize, Vec3)>; 3];

impl Limbs {
    fn of(skeleton: &Skeleton, roles: &Roles) -> Self {
        let points =
            |pair| Side::BOTH.map(|side| roles.points_of_foot(skeleton, Foot { pair, side }));
        Self {
            legs: Side::BOTH.map(|side| Limb::leg(skeleton, roles, side)),
            arms: Side::BOTH.map(|side| Limb::arm(skeleton, roles, side)),
            feet: points(FootPair::Hind),
            forefeet: Side::BOTH
                .map(|side| roles.points_of_foot(skeleton, Foot { pair: FootPair::Fore, side })),
        }
    }

    fn joints(&self) -> impl Iterator<Item = usize> {
        let limbs = self.legs.iter().chain(&self.arms).flatten().flat_map(Limb::joints);
        let feet = self.feet.iter().chain(&self.forefeet).flatten().flatten();
        limbs.chain(feet.map(|(joint, _)| *joint))
    }
}

impl Tracks {
    /// Returns empty tracks of the limbs that both bodies have.
    pub(super) fn new(task: &Task) -> Self {
        let (clip, target) = (task.source.clip(), &task.target);
        let mut ours = Limbs::of(&target.skeleton, &target.roles);
        let mut theirs = Limbs::of(clip.skeleton(), task.source.roles());
        for side in 0..2 {
            if ours.legs[side].is_none() || theirs.legs[side].is_none() {
                (ours.legs[side], theirs.legs[side]) = (None, None);
            }
            if ours.arms[side].is_none() || theirs.arms[side].is_none() {
                (ours.arms[side], theirs.arms[side]) = (None, None);
            }
        }
        let frames = clip.frames();
        let track = |limb: &Option<Limb>| {
            limb.clone().map(|limb| LimbTrack {
                limb,
                posed: Vec::with_capacity(frames),
                axis: Vec3::X,
                source: Vec::with_capacity(frames),
                starts: Vec::with_capacity(frames),
            })
        };
        let foot = |theirs: &FootPoints, ours: &FootPoints| FootTrack {
            has: [theirs.map(|point| point.is_some()), ours.map(|point| point.is_some())],
            source: Vec::with_capacity(frames),
            target: Vec::with_capacity(frames),
        };
        let on_four = task.source.roles().is_quadruped() && target.roles.is_quadruped();
        let forefoot = |side: usize| {
            let (theirs, arm) = (&theirs.forefeet[side], &ours.arms[side]);
            let ours = &ours.forefeet[side];
            (on_four && arm.is_some() && theirs[0].is_some() && ours[0].is_some())
                .then(|| foot(theirs, ours))
        };
        Self {
            legs: [0, 1].map(|side| {
                Some((track(&ours.legs[side])?, foot(&theirs.feet[side], &ours.feet[side])))
            }),
            arms: [0, 1].map(|side| track(&ours.arms[side])),
            forefeet: [0, 1].map(forefoot),
            theirs,
            ours,
        }
    }

    /// Appends these frames, which follow those already read.
    pub(super) fn read(&mut self, task: &Task, frames: Range<usize>) {
        self.read_source(task.source.clip(), frames.clone());
        self.read_target(&task.plain, frames);
    }

    fn read_source(&mut self, clip: &Clip, frames: Range<usize>) {
        let limbs = &self.theirs;
        let needed = clip.skeleton().with_ancestors(limbs.joints());
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_of(frame, &needed, &mut world);
            let read = |limb: &Limb| {
                let [start, middle, end] = limb.joints().map(|joint| world.positions[joint]);
                (start, end, start.distance(middle) + middle.distance(end))
            };
            for side in 0..2 {
                if let (Some((leg, foot)), Some(limb)) = (&mut self.legs[side], &limbs.legs[side]) {
                    leg.source.push(read(limb));
                    foot.source.push(points(&world, &limbs.feet[side]));
                }
                if let (Some(arm), Some(limb)) = (&mut self.arms[side], &limbs.arms[side]) {
                    arm.source.push(read(limb));
                }
                if let Some(foot) = &mut self.forefeet[side] {
                    foot.source.push(points(&world, &limbs.forefeet[side]));
                }
            }
        }
    }

    fn read_target(&mut self, clip: &Clip, frames: Range<usize>) {
        let limbs = &self.ours;
        let needed = clip.skeleton().with_ancestors(limbs.joints());
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_of(frame, &needed, &mut world);
            let push = |track: &mut LimbTrack| {
                track.posed.push(track.limb.pose(&world));
                track.starts.push(world.positions[track.limb.joints()[0]]);
            };
            for side in 0..2 {
                if let Some((leg, foot)) = &mut self.legs[side] {
                    push(leg);
                    foot.target.push(points(&world, &limbs.feet[side]));
                }
                if let Some(arm) = &mut self.arms[side] {
                    push(arm);
                }
                if let Some(foot) = &mut self.forefeet[side] {
                    foot.target.push(points(&world, &limbs.forefeet[side]));
                }
            }
        }
    }

    /// Finds the axes of knees and elbows after all frames are read: those about which the motion
    /// bends them, with the sign of the rest pose where the motion hardly bends them.
    pub(super) fn find_axes(&mut self, task: &Task) {
        let target = &task.target;
        let stance = canonical_stance(&target.skeleton, &target.roles, &target.reference);
        // A knee bends backwards, an elbow forwards.
        let legs = self.legs.iter_mut().flatten().map(|(leg, _)| (leg, Vec3::NEG_Z));
        let arms = self.arms.iter_mut().flatten().map(|arm| (arm, Vec3::Z));
        for (track, bends_to) in legs.chain(arms) {
            let at_rest = track.limb.pose(&stance);
            let hinge = at_rest.thigh.cross(bends_to).normalize_or(Vec3::X);
            let at_rest = at_rest.rotations[0].conjugate() * hinge;
            let bends = track.posed.iter().map(|p| p.rotations[0].conjugate() * p.bend());
            let moving = bends.sum::<Vec3>() / track.posed.len().max(1) as f32;
            let agrees = moving.dot(at_rest) > 0.0 || moving.length() > OWN_AXIS_SINE;
            let axis = if agrees { moving + at_rest * REST_AXIS_SINE } else { at_rest };
            track.axis = axis.normalize_or(at_rest);
        }
    }
}

fn points(world: &WorldPose, foot: &FootPoints) -> [Vec3; 3] {
    foot.map(|point| point.map_or(Vec3::ZERO, |(joint, point)| world.point(joint, point)))
}
