//! Results on the skeleton of the character on the stage.

use super::pair::FRAMES_PER_SLICE;
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use crate::jobs::JobBoard;
use segue_motion::clip::{Clip, Motion};
use segue_motion::retarget::{
    MotionRetargeting, RetargetErrors, RetargetOptions, RetargetedMotion, TargetBody,
};
use segue_motion::skin::Character;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Motions of up to this number of frames are retargeted at once, so that a figure does not change
/// its pose shortly after each step of a slider.
const AT_ONCE: usize = 400;

/// A motion on the skeleton of a character, in the character's own size.
#[derive(Debug)]
pub struct CharacterMotion {
    clip: Clip,
    errors: Option<RetargetErrors>,
}

impl CharacterMotion {
    /// Retargets a motion by inverse kinematics; `None` where it does not move the character
    /// ([`Character::is_moved_by`]).
    #[must_use]
    pub fn new(motion: &Arc<Motion>, character: &Character) -> Option<Self> {
        let mut next = ControlFlow::Continue(Fitting::new(motion, character)?);
        loop {
            next = match next {
                ControlFlow::Continue(fitting) => fitting.advance(usize::MAX, character),
                ControlFlow::Break(made) => return made,
            };
        }
    }

    /// Returns the clip, frame by frame the poses of the motion. The soles of the character's mesh
    /// are on the motion's ground.
    #[must_use]
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    /// Returns the errors that remain; `None` where both skeletons are one rig.
    #[must_use]
    pub fn errors(&self) -> Option<&RetargetErrors> {
        self.errors.as_ref()
    }
}

/// The retargeting of one motion, in slices.
#[derive(Debug)]
struct Fitting {
    motion: Arc<Motion>,
    work: MotionRetargeting,
}

impl Fitting {
    fn new(motion: &Arc<Motion>, character: &Character) -> Option<Self> {
        if !character.is_moved_by(motion.clip().skeleton(), motion.roles()) {
            return None;
        }
        let body = TargetBody::at_rest(&character.skeleton, &character.roles);
        let options = RetargetOptions::default();
        let work = MotionRetargeting::new(Arc::clone(motion), body, options).ok()?;
        Some(Self { motion: Arc::clone(motion), work })
    }

    /// Does one slice of up to `frames` frames. The result is `None` where there can be none.
    fn advance(
        self,
        frames: usize,
        character: &Character,
    ) -> ControlFlow<Option<CharacterMotion>, Self> {
        let Self { motion, work } = self;
        let RetargetedMotion { clip, report, is_same_rig } = match work.advance(frames) {
            Ok(ControlFlow::Continue(work)) => {
                return ControlFlow::Continue(Self { motion, work });
            }
            Ok(ControlFlow::Break(made)) => made,
            Err(_) => return ControlFlow::Break(None),
        };
        let clip = character.standing_as(clip, motion.clip(), motion.roles());
        let errors = Some(report).filter(|_| !is_same_rig);
        ControlFlow::Break(Some(CharacterMotion { clip, errors }))
    }
}

/// A cache of the motions on the stage on the skeleton of the present character. Those that are no
/// longer shown are dropped.
#[derive(Debug, Default)]
pub(crate) struct CharacterMotions {
    character: Option<Character>,
    /// `None` for motions that cannot move the character.
    cache: RequestCache<Arc<Motion>, Fitting, Option<Arc<CharacterMotion>>>,
}

impl CharacterMotions {
    /// Sets the character; motions on another one are dropped.
    pub(crate) fn set_character(&mut self, character: Option<Character>) {
        let same = match (&character, &self.character) {
            (Some(new), Some(old)) => {
                Arc::ptr_eq(&new.skeleton, &old.skeleton)
                    && Arc::ptr_eq(&new.mesh, &old.mesh)
                    && new.roles == old.roles
            }
            (new, old) => new.is_none() && old.is_none(),
        };
        if !same {
            *self = Self { character, ..Self::default() };
        }
    }

    /// Keeps the motion on the character, if it is available. Otherwise it is computed: at once or
    /// in slices if `is_final`, and not at all while the motion itself will soon be another one.
    pub(crate) fn request(&mut self, motion: &Arc<Motion>, is_final: bool) {
        let Some(character) = &self.character else { return };
        let is_it = |of: &Arc<Motion>| Arc::ptr_eq(of, motion);
        if self.cache.request(|of, _| is_it(of)).is_some() || self.cache.is_under_way(is_it) {
            return;
        }
        if !is_final {
            return;
        }
        if motion.clip().frames() > AT_ONCE
            && let Some(fitting) = Fitting::new(motion, character)
        {
            self.cache.begin(Arc::clone(motion), fitting);
            return;
        }
        let made = CharacterMotion::new(motion, character).map(Arc::new);
        self.cache.keep(Arc::clone(motion), made);
    }

    /// Returns a motion on the character; `None` while it is computed, and where the motion cannot
    /// move it.
    pub(crate) fn of(&self, motion: &Motion) -> Option<&Arc<CharacterMotion>> {
        self.cache.known(|of| std::ptr::eq(&raw const **of, motion))?.as_ref()
    }
}

impl Sliced for CharacterMotions {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        let Some(character) = &self.character else { return false };
        self.cache.work(|_, fitting| match fitting.advance(FRAMES_PER_SLICE, character) {
            ControlFlow::Continue(fitting) => ControlFlow::Continue(fitting),
            ControlFlow::Break(made) => ControlFlow::Break(made.map(Arc::new)),
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        Some((JobKind::Retargeting, f64::from(self.cache.under_way().next()?.1.work.progress())))
    }
}
