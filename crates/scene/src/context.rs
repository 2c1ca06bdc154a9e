//! What the contents of a pane are made from.

use crate::body_cache::BodyCache;
use crate::{Color, Colors, Highlights, Look, Pane, pose_at, with_alpha};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skeleton::WorldPose;
use segue_session::{Outcome, Params, Session};

/// A ghost fades in before the transition and out behind it, over this long.
pub(crate) const GHOST_FADE_SECS: f64 = 0.3;

/// Everything that the contents of a pane are made from.
pub(crate) struct DrawContext<'a> {
    pub(crate) session: &'a Session,
    pub(crate) params: &'a Params,
    pub(crate) look: &'a Look,
    pub(crate) colors: &'a Colors,
    pub(crate) highlights: &'a Highlights,
    pub(crate) bodies: &'a mut BodyCache,
}

/// A result as it is shown now.
pub(crate) struct Shown<'a> {
    pub(crate) outcome: &'a Outcome,
    /// The time in its motion, seconds.
    pub(crate) now: f64,
    /// Where the motion lies in the world.
    pub(crate) place: Planar,
    /// The pose.
    pub(crate) world: WorldPose,
}

impl<'a> Shown<'a> {
    /// Poses a result; `None` where its motion has no pose.
    pub(crate) fn new(shown: segue_session::Shown<'a>) -> Option<Self> {
        let segue_session::Shown { outcome, secs: now, place } = shown;
        Some(Self { outcome, now, place, world: pose_at(&outcome.motion, now, &place)? })
    }

    /// Returns where the result stands now.
    pub(crate) fn standing(&self) -> Planar {
        self.place.after(&self.outcome.motion.standing_at(self.now))
    }
}

impl DrawContext<'_> {
    /// Adds the ghost of a motion at a time, where the motion lies at `world_from_clip`.
    pub(crate) fn add_ghost(
        &mut self,
        motion: &Motion,
        secs: f64,
        world_from_clip: &Planar,
        color: Color,
        pane: &mut Pane,
    ) {
        if let Some(world) = pose_at(motion, secs, world_from_clip) {
            pane.add_ghost(&self.bodies.body(motion), &world, color);
        }
    }

    /// Returns the colour of a ghost that stands alone: clearer than beside a result.
    pub(crate) fn lone_ghost(&self, color: Color, clear: f32) -> Color {
        /// How many times as much as a ghost beside a result it covers.
        const ALPHA: f32 = 1.8;
        with_alpha(color, (ALPHA * clear * self.colors.ghost_alpha).min(0.9))
    }
}
