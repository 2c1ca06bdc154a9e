//! Retargeting of whole motions by inverse kinematics: any motion on any body.
//!
//! [`crate::clip::retarget`] gives every bone of a body the direction that it has in another one.
//! Where the proportions differ, feet then slide and sink in, and hands miss. [`retarget_motion`]
//! begins with these directions and moves feet and hands to where the source has them, at the scale
//! of the new body.
//!
//! # The picture
//!
//! 1. *Directions.* As in [`crate::clip::retarget`]: roles level the rest poses, hips travel at the
//!    scale of the legs.
//! 2. *Feet.* An ankle goes over the ground where the source's goes, times the ratio of the legs'
//!    lengths. Its height is such that the lowest point of the foot is as far above the level that
//!    it has on a flat sole as in the source, in proportion.
//! 3. *Hands.* A wrist goes where the source's is relative to its shoulder, times the ratio of the
//!    arms' lengths, so that an arm is stretched as far as the source's. Hands that are near each
//!    other in the source keep their distance instead.
//!    A forefoot of a body on four legs goes over the ground like a wrist, at the height that a
//!    foot has in 2.
//! 4. *Stances.* In the source's contacts the point of the foot that stands is held, as in the
//!    [foot lock](crate::transition::foot_lock()). A foot that slides on purpose, by more than
//!    [`SLIDE_ON_PURPOSE_M`], slides as far as the source's. Feet that sink in are lifted smoothly.
//! 5. *Hips.* They are raised or lowered, smoothly, to where the knees change least and both feet
//!    are in reach.
//! 6. *Limbs.* Each is solved in closed form ([`crate::skeleton::two_bone_ik`]) in the plane that
//!    its knee or elbow has, never bent backwards, with a smooth limit near full stretch.
//! 7. *Twist.* The twist of hands, feet, upper arms and thighs is spread over the joints that a rig
//!    has for it.
//!
//! A motion that is a cycle stays one: the middle of three repetitions is kept.
//!
//! ```
//! use segue_motion::clip::Motion;
//! use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
//! use segue_motion::skeleton::Roles;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let child = Arc::new(walk.clip().skeleton().scaled(0.6));
//! let roles = Roles::detect(&child);
//! let body = TargetBody::at_rest(&child, &roles);
//! let made = retarget_motion(&walk, &body, &RetargetOptions::default())?;
//! assert!(made.report.skating.result.worst_cm < made.report.source_skating.worst_cm + 0.3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What it does not do
//!
//! The ground is one plane. Hands are held by shoulders and by each other, not by the ground, by
//! the body or by props; so are the forefeet of a body on four legs where the other one stands on
//! two. A limb that one of the bodies lacks gets the directions of its bones alone. A trunk is not
//! pitched: forelegs that are too short for the height of their shoulders end above the ground.
//!
//! # Sources
//!
//! Gleicher, "Retargetting Motion to New Characters", SIGGRAPH 1998 (the motion is kept where the
//! constraints allow it; foot plants are constraints). Choi and Ko, "Online Motion Retargetting",
//! The Journal of Visualization and Computer Animation 10, 1999 (end effectors at the scale of the
//! limbs, joint angles as the second goal). Kovar, Schreiner and Gleicher, "Footskate Cleanup for
//! Motion Capture Editing", SCA 2002 (plants, ramps at their edges, the root follows). Tolani,
//! Goswami and Badler, "Real-Time Inverse Kinematics Techniques for Anthropomorphic Limbs",
//! Graphical Models 62, 2000 (the limb in closed form, with the plane of its elbow as a parameter).

mod feet;
mod hands;
mod report;
mod retargeting;
mod solve;
#[cfg(test)]
mod tests;
mod tracks;
mod twist;

pub use report::{Compared, LimbReach, RetargetErrors, SkatingValues};
pub use retargeting::MotionRetargeting;

use crate::clip::{Clip, Motion, RetargetError, reference_pose, stance_for_rest};
use crate::skeleton::{Roles, Skeleton, WorldPose};
use std::sync::Arc;

/// A foot of a body 1.75 m tall that slides farther than this in one stance does so on purpose, and
/// does so on the other body, too, metres. By the points of a foot, which is round at its heel,
/// captured walks slide by up to 8 cm.
pub const SLIDE_ON_PURPOSE_M: f32 = 0.15;

/// Options of [`retarget_motion`]. Weights run from 0 (the bones' directions alone) to 1 (the limb
/// reaches its goal); other numbers count as the nearest of these, and NaN as 0.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RetargetOptions {
    /// The weights of the left and the right foot.
    pub feet: [f32; 2],
    /// The weights of the left and the right hand.
    pub hands: [f32; 2],
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self { feet: [1.0; 2], hands: [1.0; 2] }
    }
}

impl RetargetOptions {
    /// The options under which only directions are kept.
    pub const DIRECTIONS: Self = Self { feet: [0.0; 2], hands: [0.0; 2] };

    /// Returns options with one weight for both feet and one for both hands.
    #[must_use]
    pub const fn weights(feet: f32, hands: f32) -> Self {
        Self { feet: [feet; 2], hands: [hands; 2] }
    }

    /// Returns the same options with every weight from 0 to 1.
    fn clamped(self) -> Self {
        let share = |weight: f32| if weight > 0.0 { weight.min(1.0) } else { 0.0 };
        let clamp = |weights: [f32; 2]| weights.map(share);
        Self { feet: clamp(self.feet), hands: clamp(self.hands) }
    }
}

/// The body that a motion is moved to.
#[derive(Clone, Debug)]
pub struct TargetBody {
    skeleton: Arc<Skeleton>,
    roles: Roles,
    /// A pose in which the body stands, or its rest pose.
    reference: WorldPose,
    /// The stance in place of an implausible rest pose.
    stance: Option<WorldPose>,
}

impl TargetBody {
    /// Returns the body of a skeleton whose rest pose is plausible.
    #[must_use]
    pub fn at_rest(skeleton: &Arc<Skeleton>, roles: &Roles) -> Self {
        Self {
            skeleton: Arc::clone(skeleton),
            roles: roles.clone(),
            reference: skeleton.rest_pose(),
            stance: None,
        }
    }

    /// Returns the body of a clip, from which its stance is taken if its rest pose is implausible.
    #[must_use]
    pub fn of_clip(model: &Clip, roles: &Roles) -> Self {
        Self {
            skeleton: Arc::clone(model.skeleton()),
            roles: roles.clone(),
            reference: reference_pose(model, roles),
            stance: stance_for_rest(model, roles),
        }
    }

    /// Returns the body of a motion.
    #[must_use]
    pub fn of(motion: &Motion) -> Self {
        Self::of_clip(motion.clip(), motion.roles())
    }

    /// Returns its skeleton.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Returns the roles of its joints.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        &self.roles
    }
}

/// A motion on another body.
#[derive(Clone, Debug)]
pub struct RetargetedMotion {
    /// The motion.
    pub clip: Clip,
    /// The errors that remain; none where both bodies are one rig.
    pub report: RetargetErrors,
    /// Whether both bodies are one rig: every shared joint keeps its position.
    pub is_same_rig: bool,
}

/// Retargets a motion to another body: directions of bones first, then the places of feet and
/// hands; see the [module](self). [`MotionRetargeting`] does the same in slices.
///
/// On the same skeleton the clip is returned unchanged, on the same rig with its joints in another
/// order every shared joint keeps its position. Time: O(frames × joints), ten passes of forward
/// kinematics.
///
/// # Errors
/// [`RetargetError::NothingInCommon`] when no joint of the body corresponds to one of the motion's.
pub fn retarget_motion(
    source: &Motion,
    target: &TargetBody,
    options: &RetargetOptions,
) -> Result<RetargetedMotion, RetargetError> {
    MotionRetargeting::new(Arc::new(source.clone()), target.clone(), *options)?.finish()
}

/// The motion, the body and the options of one retargeting.
#[derive(Debug)]
struct Task {
    source: Arc<Motion>,
    target: TargetBody,
    options: RetargetOptions,
    /// The directions of the source's bones on the target.
    plain: Clip,
    /// The ratio of the legs' lengths.
    scale: f32,
}

impl Task {
    /// Returns the height of the ground under the result, metres.
    fn ground_m(&self) -> f32 {
        self.source.ground_m() * self.scale
    }

    /// Returns the height of the target's body as a share of 1.75 m, for lengths that are given for
    /// such a body.
    fn size(&self) -> f32 {
        self.target.roles.body_height(&self.target.skeleton)
            / crate::registration::REFERENCE_HEIGHT_M as f32
    }
}
