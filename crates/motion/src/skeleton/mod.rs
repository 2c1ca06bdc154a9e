//! Skeletons: trees of joints, where a pose puts them, what each joint is for, and how a pose comes
//! onto another body or into a mirror.
//!
//! # The idea
//!
//! A joint is a pivot that hangs on its parent by an offset. A [`Pose`] turns every joint against
//! its parent; forward kinematics ([`world_pose`]) adds that up from the root outwards. Since
//! parents stand before their children, one pass does it:
//!
//! ```text
//! rotation(j) = rotation(parent) · local(j)                       world_from_joint
//! position(j) = position(parent) + rotation(parent) · offset(j)
//! ```
//!
//! So a turn of the hip carries the whole leg along, and no bone changes its length.
//!
//! Files name joints as they like. [`Roles`] say which joint is the left knee, by its name, else by
//! the shape at rest, else by hand; from there on nobody asks for names. With roles known on both
//! sides a pose moves to another body ([`Retargeting`]): a joint takes the *world* rotation of the
//! joint that drives it, corrected by how the two bones differ at rest.
//!
//! ```text
//! world_target = world_source · C      C takes the target's bone at rest to the source's
//! ```
//!
//! [`Mirror`] swaps the sides in the same way, and [`two_bones`] bends a leg so that its ankle lies
//! at a given place.
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
//! let (hip, knee, ankle) = (joint(Role::LeftThigh)?, joint(Role::LeftShin)?, joint(Role::LeftFoot)?);
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
//! // A child kicks as far in proportion, and in a mirror the right foot kicks.
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
//! kinds of rig, limbs point where the source's do, within the 2° below which rest poses count as
//! the same; mirroring twice gives the pose back to 1e-5. Kinematics and retargeting are O(joints)
//! for a pose.
//!
//! # What it does not do
//!
//! No limits of joints, no scaled bones, no muscles. Inverse kinematics are those of two bones.
//! Feet are not planted after retargeting ([`crate::transition::foot_lock`] does that), and hands
//! do not reach for what they held.
//!
//! # Sources
//!
//! Retargeting and mirror images are described where they are made ([`Retargeting`], [`Mirror`]).
//! Roles follow the names of the rigs that [`Roles::detect`] lists.

mod ancestry;
mod carrier;
mod corrections;
#[allow(
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
mod two_bones;

pub use carrier::{Above, carrier};
pub(crate) use carrier::{AboveJoint, Beside, Follows};
pub use joint_map::JointMap;
pub use kinematics::{WorldPose, local_pose, world_pose, world_pose_into, world_pose_of};
pub use mirror::{Mirror, NoSides};
pub use pose::Pose;
pub use retarget::Retargeting;
pub use role::{Role, Side};
pub use roles::{Found, Roles};
pub use stance::{canonical_stance, rest_is_plausible, uprightness};
pub use tree::{Channel, Joint, Skeleton, SkeletonError};
pub use two_bones::{TwoBones, two_bones};
