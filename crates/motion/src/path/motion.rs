use super::{CarryOptions, FittedPath, HardTurn, PathEditError, Road, Waypoint, carry, hard_turns};
use crate::clip::{Clip, Contacts};
use crate::math::Planar;
use crate::metrics::foot_slide_cm;
use crate::skeleton::Roles;
use crate::transition::{FootLockOptions, FootLocking};
use std::sync::Arc;

/// How the motion of an edited path is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MotionOptions {
    /// How it is laid on the path.
    pub carry: CarryOptions,
    /// How its feet are planted afterwards; `None` leaves them sliding.
    pub foot_lock: Option<FootLockOptions>,
}

/// A motion on an edited path, with what can be said against it.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedMotion {
    /// The motion.
    pub clip: Clip,
    /// For every frame of it the frame of the original that it shows.
    pub frames: Vec<f64>,
    /// For every frame of it the frame of the edited path that it rides in.
    pub places: Vec<Waypoint>,
    /// For every frame of it where the character stands and what it faces, before its feet are
    /// planted.
    pub characters: Vec<Planar>,
    /// For every frame of it by how much the path turned the whole body, radians.
    pub turns: Vec<f64>,
    /// When which foot is on the ground.
    pub contacts: Contacts,
    /// How far a planted foot slides in the worst stance, centimetres; `None` without feet or
    /// stances.
    pub slide_cm: Slide,
    /// Where the path turns faster than the original does.
    pub hard_turns: Vec<HardTurn>,
}

/// Foot skate of a motion in its three states, each as [`foot_slide_cm`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slide {
    /// The original, centimetres.
    pub original: Option<f64>,
    /// On the edited path, centimetres.
    pub carried: Option<f64>,
    /// With its feet planted, centimetres; as before where they were not.
    pub locked: Option<f64>,
}

/// The motion of a path that is edited live: what does not change under the hand is measured once.
#[derive(Clone, Debug)]
pub struct PathEditor {
    path: FittedPath,
    roles: Roles,
    contacts: Contacts,
    slide_cm: Option<f64>,
}

impl PathEditor {
    /// Takes a fitted motion; `contacts` are those of the original.
    #[must_use]
    pub fn new(path: FittedPath, roles: &Roles, contacts: Contacts) -> Self {
        let slide_cm = foot_slide_cm(path.source().clip(), roles, &contacts);
        Self { path, roles: roles.clone(), contacts, slide_cm }
    }

    /// The fitted motion.
    #[must_use]
    pub fn path(&self) -> &FittedPath {
        &self.path
    }

    /// The motion on an edited path: laid on it, its feet planted, and measured. O(frames ×
    /// joints).
    ///
    /// # Errors
    /// [`PathEditError`] when feet are to be planted and there are no legs or the options are out
    /// of range, or the result is no clip.
    pub fn motion(
        &self,
        edited: &Road,
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
