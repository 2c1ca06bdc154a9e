//! The motion of an edited path.

use super::{
    ArcLengthPath, CarryOptions, FittedPath, HardTurn, PathEditError, Waypoint, carry, hard_turns,
};
use crate::clip::{Clip, Contacts};
use crate::math::Planar;
use crate::metrics::{Extreme, foot_slide_cm, worst_foot_slide};
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
    /// The frame in which the foot slides fastest on the edited path; `None` where none slides.
    pub carried_at: Option<usize>,
    /// With foot lock, centimetres; equal to `carried` without.
    pub locked: Option<f64>,
    /// The frame in which the foot slides fastest with foot lock; `None` where none slides.
    pub locked_at: Option<usize>,
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
        let slid = |clip: &Clip| {
            let worst = worst_foot_slide(clip, &self.roles, &contacts);
            (worst.map(|slide| slide.value), worst.as_ref().and_then(Extreme::place))
        };
        let (of_carried, carried_at) = slid(&carried.clip);
        let mut slide_cm =
            Slide { original: self.slide_cm, carried: of_carried, carried_at, ..Slide::default() };
        let clip = if let Some(lock) = &options.foot_lock {
            let locking = FootLocking::new(Arc::new(carried.clip), &self.roles, &contacts, lock)?;
            let locked = locking.with_body_yaws(&carried.turns).finish()?;
            (slide_cm.locked, slide_cm.locked_at) = slid(&locked);
            locked
        } else {
            (slide_cm.locked, slide_cm.locked_at) = (slide_cm.carried, slide_cm.carried_at);
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
