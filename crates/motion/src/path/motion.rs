//! The motion of an edited path.

use super::{
    ArcLengthPath, CarryOptions, FittedPath, HardTurn, PathEditError, Waypoint, carry, hard_turns,
};
use crate::clip::{Clip, Contacts};
use crate::math::Planar;
use crate::metrics::foot_slide_cm;
use crate::skeleton::Roles;
use crate::transition::{FootLockOptions, FootLocking};
use std::sync::Arc;

/// Options of the motion of an edited path.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MotionOptions {
    /// Options of carrying it to the path.
    pub carry: CarryOptions,
    /// Options of the foot lock afterwards; `None` for none.
    pub foot_lock: Option<FootLockOptions>,
}

/// A motion on an edited path, with its measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedMotion {
    /// The motion.
    pub clip: Clip,
    /// For every frame, the frame of the original.
    pub frames: Vec<f64>,
    /// For every frame, the frame of the edited path to which it belongs.
    pub places: Vec<Waypoint>,
    /// For every frame, the ground frame of the character before the foot lock.
    pub characters: Vec<Planar>,
    /// For every frame, the yaw by which the path turned the whole body, radians.
    pub turns: Vec<f64>,
    /// The contacts of the feet.
    pub contacts: Contacts,
    /// The slide of a planted foot in the worst stance, centimetres; `None` without feet or
    /// stances.
    pub slide_cm: Slide,
    /// Turns that are faster than those of the original.
    pub hard_turns: Vec<HardTurn>,
}

/// Foot slide of a motion in its three states, each as [`foot_slide_cm`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slide {
    /// The original, centimetres.
    pub original: Option<f64>,
    /// On the edited path, centimetres.
    pub carried: Option<f64>,
    /// With foot lock, centimetres; equal to `carried` without.
    pub locked: Option<f64>,
}

/// The motion of a path that is edited interactively: everything that does not depend on the edit
/// is measured once.
#[derive(Clone, Debug)]
pub struct PathEditor {
    path: FittedPath,
    roles: Roles,
    contacts: Contacts,
    slide_cm: Option<f64>,
}

impl PathEditor {
    /// Returns the editor of a fitted motion; `contacts` are those of the original.
    #[must_use]
    pub fn new(path: FittedPath, roles: &Roles, contacts: Contacts) -> Self {
        let slide_cm = foot_slide_cm(path.source().clip(), roles, &contacts);
        Self { path, roles: roles.clone(), contacts, slide_cm }
    }

    /// Returns the fitted motion.
    #[must_use]
    pub fn path(&self) -> &FittedPath {
        &self.path
    }

    /// Returns the motion on an edited path: carried, with foot lock, and measured. O(frames ×
    /// joints).
    ///
    /// # Errors
    /// [`PathEditError`] when a foot lock is requested and there are no legs or its options are out
    /// of range, or the result is not a valid clip.
    pub fn motion(
        &self,
        edited: &ArcLengthPath,
        options: &MotionOptions,
    ) -> Result<EditedMotion, PathEditError> {
        let carried = carry(&self.path, edited, &options.carry)?;
        let contacts = carried.contacts(&self.contacts);
        let hard_turns = hard_turns(&self.path, &carried);
        let slid = |clip: &Clip| foot_slide_cm(clip, &self.roles, &contacts);
        let mut slide_cm =
            Slide { original: self.slide_cm, carried: slid(&carried.clip), locked: None };
        let clip = if let Some(lock) = &options.foot_lock {
            let locking = FootLocking::new(Arc::new(carried.clip), &self.roles, &contacts, lock)?;
            let locked = locking.with_body_yaws(&carried.turns).finish()?;
            slide_cm.locked = slid(&locked);
            locked
        } else {
            slide_cm.locked = slide_cm.carried;
            carried.clip
        };
        Ok(EditedMotion {
            clip,
            frames: carried.frames,
            places: carried.places,
            characters: carried.characters,
            turns: carried.turns,
            contacts,
            slide_cm,
            hard_turns,
        })
    }
}
