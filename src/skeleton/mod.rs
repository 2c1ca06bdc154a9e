//! Skeletons, poses, forward kinematics, and what a joint is for.

mod ancestry;
mod corrections;
#[cfg(test)]
pub(crate) mod fixtures;
mod joint_map;
mod kinematics;
mod mirror;
mod pose;
mod retarget;
mod role;
mod roles;
mod tree;
mod two_bones;

pub use joint_map::JointMap;
pub use kinematics::{WorldPose, local_pose, world_pose, world_pose_into, world_pose_of};
pub use mirror::{Mirror, NoSides};
pub use pose::Pose;
pub use retarget::Retargeting;
pub use role::{Role, Side};
pub use roles::{Found, Roles};
pub use tree::{Channel, Joint, Skeleton, SkeletonError};
pub use two_bones::{TwoBones, two_bones};
