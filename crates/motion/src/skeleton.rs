//! Skeletons: trees of joints, forward and two-bone inverse kinematics, the role of each joint,
//! retargeting and mirroring of poses.
//!
//! # The idea
//!
//! A joint is a pivot at a fixed offset from its parent. A [`Pose`] rotates every joint relative to
//! its parent; forward kinematics ([`world_pose`]) accumulates that from the root outwards. Since
//! parents stand before their children, one pass suffices:
//!
//! ```text
//! rotation(j) = rotation(parent) · local(j)                       world_from_joint
//! position(j) = position(parent) + rotation(parent) · offset(j)
//! ```
//!
//! A turn of the hip therefore carries the whole leg along, and no bone changes its length.
//!
//! The names of joints differ from file to file. [`Roles`] identify the left knee: by its name,
//! otherwise by the shape of the skeleton at rest, otherwise by hand. No other code looks at names.
//! With the roles of both skeletons a pose can be retargeted ([`Retargeting`]): a joint takes the
//! *world* rotation of its source joint, corrected by how the two bones differ at rest.
//!
//! ```text
//! world_target = world_source · C      C takes the target's bone at rest to the source's
//! ```
//!
//! [`Mirror`] swaps the sides in the same way, and [`two_bone_ik()`] bends a leg so that its ankle
//! reaches a given point (two-bone inverse kinematics).
//!
//! # Example
//!
//! ```
//! use glam::Quat;
//! use segue_motion::skeleton::{Mirror, Pose, Retargeting, Role, Roles, world_pose};
//! use segue_motion::synth::humanoid;
//!
//! let body = humanoid(1.75)?;
//! let roles = Roles::detect(&body);
//! let joint = |role| roles.get(role).ok_or("not found");
//! let (hip, knee) = (joint(Role::LeftThigh)?, joint(Role::LeftShin)?);
//! let ankle = joint(Role::LeftFoot)?;
//! let standing = Pose {
//!     root_translation: body.joints()[0].offset,
//!     rotations: vec![Quat::IDENTITY; body.len()],
//!     translations: vec![],
//! };
//! let mut kicking = standing.clone();
//! kicking.rotations[hip] = Quat::from_rotation_x(-0.5);
//!
//! let (before, after) = (world_pose(&body, &standing), world_pose(&body, &kicking));
//! assert!(after.positions[ankle].z > before.positions[ankle].z + 0.4);
//! assert!(after.point(knee, body.joints()[ankle].offset).distance(after.positions[ankle]) < 1e-6);
//!
//! // A child's body kicks in proportion; mirrored, the right foot kicks.
//! let child = humanoid(1.2)?;
//! let child_roles = Roles::detect(&child);
//! let smaller = Retargeting::new(&body, &roles, &child, &child_roles).ok_or("nothing in common")?;
//! let kicks = world_pose(&child, &smaller.pose(&kicking));
//! assert!((kicks.positions[ankle] * (1.75 / 1.2)).distance(after.positions[ankle]) < 1e-5);
//! let mirrored = world_pose(&body, &Mirror::of(&body, &roles)?.pose(&kicking));
//! let other = joint(Role::RightFoot)?;
//! assert!((mirrored.positions[other].z - after.positions[ankle].z).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Kinematics agree with 4 × 4 matrices to 2e-6 of a point's distance. Between any two of eleven
//! kinds of rig, limbs point in the directions of the source's, within the 2° below which rest
//! poses count as equal; mirroring twice gives the pose back to 1e-5. Kinematics and retargeting
//! are O(joints) for a pose.
//!
//! # What it does not do
//!
//! No joint limits, no scaled bones, no muscles. Inverse kinematics are limited to two bones. Feet
//! are not planted after retargeting ([`crate::transition::foot_lock`] does that), and hands do not
//! reach for the object that they held.
//!
//! # Sources
//!
//! Retargeting and mirroring cite theirs at [`Retargeting`] and [`Mirror`]. Roles follow the names
//! of the rigs that [`Roles::detect`] lists.

mod ancestry;
mod carrier;
mod corrections;
#[expect(
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    clippy::unwrap_used,
    reason = "made for tests"
)]
#[cfg(any(test, feature = "fixtures"))]
pub mod fixtures;
mod joint_map;
mod kinematics;
mod mirror;
mod pose;
mod retarget;
mod role;
mod roles;
mod stance;
mod tree;
mod two_bone_ik;

pub(crate) use carrier::{ChainChild, ChainJoint, ChainMotion};
pub use carrier::{FoldedChain, carrier};
pub use joint_map::JointMap;
pub(crate) use kinematics::world_pose_of;
pub use kinematics::{WorldPose, local_pose, world_pose, world_pose_into};
pub use mirror::{Mirror, NoCounterparts};
pub use pose::Pose;
pub use retarget::Retargeting;
pub use role::{BodyPlan, Foot, FootPair, Role, Side};
pub use roles::{RoleSource, Roles};
pub(crate) use roles::{is_below, is_control};
pub use stance::canonical_stance;
pub(crate) use stance::{rest_is_plausible, rests_on_two_legs, uprightness};
pub use tree::{Channel, Joint, Skeleton, SkeletonError};
pub use two_bone_ik::{TwoBoneIk, two_bone_ik};
