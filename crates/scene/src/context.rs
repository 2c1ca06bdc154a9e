//! The data from which the contents of a pane are drawn.

use crate::body_cache::BodyCache;
use crate::{Color, Colors, Highlights, Look, Pane, pose_at, with_alpha};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skeleton::WorldPose;
use segue_session::{Outcome, Params, Session};

/// Duration of a ghost's fade-in before a transition and of its fade-out after it, seconds.
pub(crate) const GHOST_FADE_SECS: f64 = 0.3;

/// The data from which the contents of a pane are drawn.
pub(crate) struct DrawContext<'a> {
    pub(crate) session: &'a Session,
    pub(crate) params: &'a Params,
    pub(crate) look: &'a Look,
    pub(crate) colors: &'a Colors,
    pub(crate) highlights: &'a Highlights,
    pub(crate) bodies: &'a mut BodyCache,
}

/// A result in its current pose.
pub(crate) struct PosedResult<'a> {
    pub(crate) outcome: &'a Outcome,
    /// The current time in its motion, seconds.
    pub(crate) now: f64,
    /// The placement of the motion: `world_from_clip`.
    pub(crate) place: Planar,
    /// The pose in the world.
    pub(crate) world: WorldPose,
}

impl<'a> PosedResult<'a> {
    /// Poses a result; `None` where its motion has no pose.
    pub(crate) fn new(shown: segue_session::PaneContent<'a>) -> Option<Self> {
        let segue_session::PaneContent { outcome, secs: now, place } = shown;
        Some(Self { outcome, now, place, world: pose_at(&outcome.motion, now, &place)? })
    }

    /// Returns the current ground frame of the character.
    pub(crate) fn standing(&self) -> Planar {
        self.place.after(&self.outcome.motion.standing_at(self.now))
    }
}

impl DrawContext<'_> {
    /// Adds the ghost of a motion at a time; the motion is placed by `world_from_clip`.
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

    /// Returns the colour of a ghost without a result beside it, which is more opaque.
    pub(crate) fn lone_ghost(&self, color: Color, clear: f32) -> Color {
        /// The factor on the opacity of a ghost beside a result.
        const ALPHA: f32 = 1.8;
        with_alpha(color, (ALPHA * clear * self.colors.ghost_alpha).min(0.9))
    }
}
