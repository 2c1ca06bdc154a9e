//! The data from which the contents of a pane are drawn.

use crate::body_cache::BodyCache;
use crate::{Body, Color, Colors, Highlights, Look, Pane, pose_at, with_alpha};
use segue_motion::clip::{Interpolation, Motion};
use segue_motion::math::Planar;
use segue_motion::skeleton::{WorldPose, world_pose};
use segue_session::{Outcome, Params, Session};
use std::sync::Arc;

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
    /// The body of its figure.
    pub(crate) body: Arc<Body>,
    /// The pose of its figure in the world.
    pub(crate) world: WorldPose,
}

impl<'a> PosedResult<'a> {
    /// Poses a result; `None` where its motion has no pose.
    pub(crate) fn new(
        shown: segue_session::PaneContent<'a>,
        context: &mut DrawContext<'_>,
    ) -> Option<Self> {
        let segue_session::PaneContent { outcome, secs: now, place } = shown;
        let body = context.bodies.body(&outcome.motion);
        let world = figure_pose(context.session, &body, &outcome.motion, now, &place)?;
        Some(Self { outcome, now, place, body, world })
    }

    /// Returns the pose of its figure at another time.
    pub(crate) fn world_at(&self, secs: f64, session: &Session) -> Option<WorldPose> {
        figure_pose(session, &self.body, &self.outcome.motion, secs, &self.place)
    }

    /// Returns the current ground frame of the character.
    pub(crate) fn standing(&self) -> Planar {
        self.place.after(&self.outcome.motion.standing_at(self.now))
    }
}

/// Returns the pose of a motion's figure at a time, in the world; the motion is placed by
/// `world_from_clip`. A character has its feet and hands where the motion has them as soon as the
/// session has computed that, and the directions of its bones until then.
pub(crate) fn figure_pose(
    session: &Session,
    body: &Body,
    motion: &Motion,
    secs: f64,
    world_from_clip: &Planar,
) -> Option<WorldPose> {
    if let Some(own) = session.on_character(motion)
        && body.is_character_of(own.clip().skeleton())
    {
        let pose = own.clip().sample(secs, Interpolation::Linear)?;
        let mut world = world_pose(own.clip().skeleton(), &pose);
        // The character is drawn in the size of the motion.
        for position in &mut world.positions {
            *position /= body.size();
        }
        world.apply(world_from_clip);
        return Some(world);
    }
    Some(body.drawn_pose(pose_at(motion, secs, world_from_clip)?))
}

impl DrawContext<'_> {
    /// Returns the body of a motion's figure and its pose at a time, in the world.
    pub(crate) fn figure(
        &mut self,
        motion: &Motion,
        secs: f64,
        world_from_clip: &Planar,
    ) -> Option<(Arc<Body>, WorldPose)> {
        let body = self.bodies.body(motion);
        let world = figure_pose(self.session, &body, motion, secs, world_from_clip)?;
        Some((body, world))
    }

    /// Adds the ghost of a motion at a time; the motion is placed by `world_from_clip`.
    pub(crate) fn add_ghost(
        &mut self,
        motion: &Motion,
        secs: f64,
        world_from_clip: &Planar,
        color: Color,
        pane: &mut Pane,
    ) {
        if let Some((body, world)) = self.figure(motion, secs, world_from_clip) {
            pane.add_ghost(&body, &world, color);
        }
    }

    /// Returns the colour of a ghost without a result beside it, which is more opaque.
    pub(crate) fn lone_ghost(&self, color: Color, clear: f32) -> Color {
        /// The factor on the opacity of a ghost beside a result.
        const ALPHA: f32 = 1.8;
        with_alpha(color, (ALPHA * clear * self.colors.ghost_alpha).min(0.9))
    }
}
