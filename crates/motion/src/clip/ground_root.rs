//! Root motion as game engines want it: on a bone of its own on the ground, or none at all.

use super::Clip;
use super::carrier::smoothed;
use super::root_motion::character_frames;
use crate::math::Planar;
use crate::skeleton::{ChainJoint, ChainMotion, FoldedChain, Joint, Roles, Skeleton, carrier};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The names of a root bone, of which a skeleton gets the first one that is free, and that is not
/// taken for its hips: some rigs call these the root.
const ROOT_NAMES: [&str; 3] = ["root", "ground", "ground_root"];

impl Clip {
    /// Returns the motion with a root bone on the ground: it has the place of the body over the
    /// ground and its heading, both without the sway of the steps, at height 0, and the hips have
    /// the rest. Every other joint keeps its place in the world.
    ///
    /// The bone stands above the joint that carries the body, as if a file had had it: files get it
    /// ([`Clip::unfolded`]), and no algorithm is disturbed by it. Of the joints that the clip's
    /// file has above that joint already, the topmost becomes the root bone and keeps its name and
    /// its orientation; those below it stay where they are relative to it. A root that moves over
    /// the ground in the file as it is stays as it is.
    #[must_use]
    pub fn with_ground_root(&self) -> Self {
        let skeleton = self.skeleton();
        let on_ground = |rotation: Quat| ChainMotion::OnGround {
            joint: 0,
            height: 0.0,
            rotation,
            shift: [0.0; 2],
            yaw: Some(0.0),
        };
        let above = match skeleton.folded_chain() {
            Some(FoldedChain { follows: ChainMotion::OnGround { .. }, .. }) => return self.clone(),
            Some(above) => {
                let top = above.chain.first().map_or(Quat::IDENTITY, |top| top.rotation);
                FoldedChain { follows: on_ground(top), ..above.clone() }
            }
            None => FoldedChain {
                chain: vec![ChainJoint {
                    joint: root_bone(skeleton),
                    file_index: 0,
                    rotation: Quat::IDENTITY,
                    translation: Vec3::ZERO,
                }],
                carrier_offset: skeleton.joints().first().map_or(Vec3::ZERO, |root| root.offset),
                beside: Vec::new(),
                file_index: (1..=skeleton.len()).collect(),
                follows: on_ground(Quat::IDENTITY),
            },
        };
        let skeleton = Skeleton::clone(skeleton).with_folded_chain(Some(above));
        self.clone().with_chain_of(&Arc::new(skeleton))
    }

    /// Returns the motion without its way over the ground: what is left of it when the root bone of
    /// [`with_ground_root`](Self::with_ground_root) stands still at the origin. The body faces +Z,
    /// and sways with its steps as before.
    #[must_use]
    pub fn without_ground_motion(&self, roles: &Roles) -> Self {
        let places = smoothed(&character_frames(self, roles), self.fps());
        let back: Vec<Planar> = places.iter().map(Planar::inverse).collect();
        self.transformed_by_frame(&back)
    }
}

fn root_bone(skeleton: &Skeleton) -> Joint {
    let bone = |name: String| {
        let (parent, offset, end_site, channels) = (None, Vec3::ZERO, None, Vec::new());
        Joint { name, parent, offset, end_site, channels }
    };
    let is_above_hips = |root: &Joint| {
        let below = skeleton.joints().iter().cloned().map(|joint| {
            let parent = Some(joint.parent.map_or(0, |parent| parent + 1));
            Joint { parent, ..joint }
        });
        let file = Skeleton::new(std::iter::once(root.clone()).chain(below).collect());
        file.is_ok_and(|file| carrier(&file, &Roles::detect(&file)) != 0)
    };
    let is_free = |root: &Joint| skeleton.find(&root.name).is_none();
    let usual = || ROOT_NAMES.into_iter().map(|name| bone(name.to_owned()));
    let numbered = || (2..=skeleton.len() + 2).map(|number| bone(format!("ground_{number}")));
    let mut both = usual().chain(numbered()).filter(is_free);
    let found = both.find(is_above_hips);
    // A tree without a body may have no joint that carries it.
    found.or_else(|| usual().chain(numbered()).find(is_free)).unwrap_or_else(|| bone("root".into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::fixtures::wander;
    use crate::math::quat;
    use crate::skeleton::fixtures;
    use crate::synth::{Action, Params, synthesize};
    use proptest::prelude::*;

    fn rigs() -> Vec<(&'static str, Arc<Skeleton>)> {
        fixtures::all().into_iter().map(|(name, skeleton, _)| (name, skeleton)).collect()
    }

    /// Returns the largest distance of a joint's places in two clips, which have it under one name.
    fn apart(body: &Clip, file: &Clip) -> f32 {
        let mut farthest = 0.0f32;
        for frame in 0..body.frames() {
            let (own, there) = (body.world_pose(frame), file.world_pose(frame));
            for (joint, at) in body.skeleton().joints().iter().zip(&own.positions) {
                let joint = file.skeleton().find(&joint.name).expect("the same joint");
                farthest = farthest.max(at.distance(there.positions[joint]));
            }
        }
        farthest
    }

    #[test]
    fn ground_root_of_a_walk_goes_ahead_evenly_on_the_ground() {
        let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let file = walk.with_ground_root().unfolded().unwrap();
        assert_eq!(file.skeleton().joints()[0].name, "root");
        assert_eq!(file.skeleton().len(), walk.skeleton().len() + 1);
        assert!(apart(&walk, &file) < 1e-5);
        let steps: Vec<Vec3> =
            file.root_translations().windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(file.root_translations().iter().all(|root| root.y == 0.0));
        // Away from the ends nothing of the steps is in it: hips gain and lose speed with each.
        let inner = &steps[40..steps.len() - 40];
        let mean = inner.iter().sum::<Vec3>() / inner.len() as f32;
        let sway = inner.iter().map(|step| step.distance(mean)).fold(0.0, f32::max);
        assert!(mean.z > 0.015 && sway < 0.1 * mean.length(), "{mean} m a frame, {sway} m off");
        for frame in 0..file.frames() {
            let turn = file.rotations(frame)[0];
            assert!(quat::angle_between(turn, Quat::IDENTITY) < 0.1, "it walks straight ahead");
        }
    }

    #[test]
    fn clip_without_ground_motion_is_the_rest_of_its_ground_root() {
        let turn = Params { turn_rate_dps: 25.0, ..Params::new(Action::Walk) };
        let walk = synthesize(&turn).unwrap().clip;
        let roles = Roles::detect(walk.skeleton());
        let still = walk.without_ground_motion(&roles);
        let file = walk.with_ground_root().unfolded().unwrap();
        for frame in 0..walk.frames() {
            let (at, turned) = (file.root_translations()[frame], file.rotations(frame)[0]);
            let (own, there) = (still.world_pose(frame), walk.world_pose(frame));
            for (own, there) in own.positions.iter().zip(&there.positions) {
                assert!((at + turned * *own).distance(*there) < 1e-4);
            }
            assert!(own.positions[0].x.hypot(own.positions[0].z) < 0.1);
        }
    }

    #[test]
    fn ground_root_takes_a_name_that_is_free() {
        let mut joints = fixtures::mixamo().joints().to_vec();
        for (joint, name) in joints.iter_mut().zip(ROOT_NAMES) {
            joint.name = name.into();
        }
        let skeleton = Arc::new(Skeleton::new(joints).unwrap());
        let clip = wander(&skeleton, 2, 1).with_ground_root();
        assert_eq!(clip.unfolded().unwrap().skeleton().joints()[0].name, "ground_2");
        // A rig whose hips are named the root keeps them.
        let clip = wander(&fixtures::games105(), 2, 1).with_ground_root();
        assert_eq!(clip.unfolded().unwrap().skeleton().joints()[0].name, "ground");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        /// On any rig, also with joints above the hips: no joint moves, and reading the file again
        /// and writing it gives the same root.
        #[test]
        fn ground_root_keeps_all_other_joints_where_they_are(
            rig in 0..rigs().len(),
            seed in 0u64..1000,
        ) {
            let (name, skeleton) = &rigs()[rig];
            let raw = wander(skeleton, 24, seed);
            let body = raw.folded().unwrap();
            let file = body.with_ground_root().unfolded().unwrap();
            prop_assert!(apart(&body, &file) < 1e-5, "{name}: {} m", apart(&body, &file));
            let again = file.clone().folded().unwrap().unfolded();
            prop_assert!(again.is_some(), "{name} has lost its root bone");
            let again = again.unwrap_or_else(|| file.clone());
            prop_assert_eq!(again.skeleton(), file.skeleton());
            prop_assert!(apart(&file, &again) < 1e-4, "{name}: {} m", apart(&file, &again));
        }
    }
}
