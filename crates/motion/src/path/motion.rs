//! The motion of an edited path.

use super::carry::Carrying;
use super::{
    ArcLengthPath, CarriedMotion, CarryOptions, FittedPath, HardTurn, PathEditError, Waypoint,
    hard_turns,
};
use crate::clip::{Clip, Contacts};
use crate::math::Planar;
use crate::metrics::{Extreme, SlideMeter, foot_slide_cm, worst_foot_slide};
use crate::skeleton::Roles;
use crate::transition::{FootLockOptions, FootLocking};
use std::ops::ControlFlow;
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
    pub clip: Arc<Clip>,
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
        Self::with_slide_cm(path, roles, contacts, slide_cm)
    }

    /// Returns the editor of a fitted motion whose slide is known: that of the original in its
    /// worst stance, centimetres ([`SlideMeter::worst_cm`]). `None` where there is no stance.
    #[must_use]
    pub fn with_slide_cm(
        path: FittedPath,
        roles: &Roles,
        contacts: Contacts,
        slide_cm: Option<f64>,
    ) -> Self {
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
        let mut carrying = MotionCarrying::new(options.carry);
        let mut made = loop {
            match carrying.advance(self, edited, usize::MAX)? {
                ControlFlow::Continue(rest) => carrying = rest,
                ControlFlow::Break(made) => break made,
            }
        };
        if let Some(lock) = &options.foot_lock {
            let locking = FootLocking::new(made.clip, &self.roles, &made.contacts, lock)?;
            made.clip = Arc::new(locking.with_body_yaws(&made.turns).finish()?);
            let worst = worst_foot_slide(&made.clip, &self.roles, &made.contacts);
            made.slide_cm.locked = worst.as_ref().map(|slide| slide.value);
            made.slide_cm.locked_at = worst.as_ref().and_then(Extreme::place);
        }
        Ok(made)
    }

    /// Returns a carried motion with its contacts and hard turns, before its slide is measured.
    fn without_slide(&self, carried: CarriedMotion) -> EditedMotion {
        EditedMotion {
            contacts: carried.contacts(&self.contacts),
            hard_turns: hard_turns(&self.path, &carried),
            slide_cm: Slide { original: self.slide_cm, ..Slide::default() },
            clip: Arc::new(carried.clip),
            frames: carried.frames,
            places: carried.places,
            characters: carried.characters,
            turns: carried.turns,
        }
    }
}

/// The computation of [`PathEditor::motion`] without foot lock in slices, for long motions.
#[derive(Clone, Debug)]
pub struct MotionCarrying(Stage);

#[derive(Clone, Debug)]
enum Stage {
    Carry(Box<Carrying>),
    Slide(Box<EditedMotion>, SlideMeter),
}

impl MotionCarrying {
    /// Prepares the computation. Nothing is computed yet: call [`advance`](Self::advance).
    #[must_use]
    pub fn new(options: CarryOptions) -> Self {
        Self(Stage::Carry(Box::new(Carrying::new(options))))
    }

    /// Processes up to `count` more frames, each of which is placed, then measured. Returns the
    /// rest of the computation, or the motion. Every call must be given the same editor and path.
    ///
    /// # Errors
    /// [`PathEditError`] when the result is not a valid clip.
    pub fn advance(
        self,
        editor: &PathEditor,
        edited: &ArcLengthPath,
        count: usize,
    ) -> Result<ControlFlow<EditedMotion, Self>, PathEditError> {
        let stage = match self.0 {
            Stage::Carry(mut carrying) => {
                if carrying.advance(&editor.path, edited, count) {
                    Stage::Carry(carrying)
                } else {
                    let made = editor.without_slide(carrying.finish(&editor.path)?);
                    let meter = SlideMeter::new(&made.clip, &editor.roles);
                    Stage::Slide(Box::new(made), meter)
                }
            }
            Stage::Slide(mut made, mut meter) => {
                if !meter.advance(&made.clip, &made.contacts, count) {
                    let worst = meter.worst();
                    let value = worst.as_ref().map(|slide| slide.value);
                    let at = worst.as_ref().and_then(Extreme::place);
                    (made.slide_cm.carried, made.slide_cm.locked) = (value, value);
                    (made.slide_cm.carried_at, made.slide_cm.locked_at) = (at, at);
                    return Ok(ControlFlow::Break(*made));
                }
                Stage::Slide(made, meter)
            }
        };
        Ok(ControlFlow::Continue(Self(stage)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Motion;
    use crate::path::{FitOptions, PathEdit, Pins, Timing};
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn motion_on_a_path_is_the_same_in_slices() {
        let walk = Arc::new(Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip));
        let path = FittedPath::new(Arc::clone(&walk), &FitOptions::default()).unwrap();
        let spline = path.curve().spline();
        let bent = spline.edited(&PathEdit::Scale { factor: 1.3 }, Pins::default()).unwrap();
        let edited = ArcLengthPath::new(bent).unwrap();
        let editor = PathEditor::new(path, walk.roles(), walk.contacts().clone());
        for timing in [Timing::Metres, Timing::Speed, Timing::Duration] {
            let carry = CarryOptions { timing, ..CarryOptions::default() };
            let options = MotionOptions { carry, foot_lock: None };
            let (mut carrying, mut slices) = (MotionCarrying::new(carry), 0);
            let made = loop {
                slices += 1;
                match carrying.advance(&editor, &edited, 7).unwrap() {
                    ControlFlow::Continue(rest) => carrying = rest,
                    ControlFlow::Break(made) => break made,
                }
            };
            assert!(slices > 2 * walk.clip().frames() / 7, "{slices}");
            assert!(made == editor.motion(&edited, &options).unwrap(), "{timing:?}");
            assert!(made.slide_cm.carried.is_some());
        }
    }
}
