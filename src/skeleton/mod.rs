//! Skeletons, poses, forward kinematics, and what a joint is for.

mod kinematics;
mod pose;
mod role;
mod roles;
mod tree;

pub use kinematics::{WorldPose, world_pose, world_pose_into};
pub use pose::Pose;
pub use role::{Role, Side};
pub use roles::{Found, Roles};
pub use tree::{Channel, Joint, Skeleton, SkeletonError};
