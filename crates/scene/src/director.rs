//! Conversion of a session to a stage, frame by frame.

mod cameras;

use crate::body_cache::BodyCache;
use crate::context::{DrawContext, PosedResult};
use crate::framing::{farther, figure_height, height_in_view, resting_place, resting_point};
use crate::{
    Camera, CameraRig, Colors, Highlights, Look, Pane, Skinning, Stage, Viewport, annotations,
    extra_characters, labs, result, sources,
};
use glam::Vec3;
use segue_session::choices;
use segue_session::{Key, Session};
use std::sync::Arc;

/// Options of the stage: the placement of panes, colours, and highlights.
#[derive(Clone, Debug)]
pub struct StageOptions<'a> {
    /// The visible panes: index in the session, and rectangle in physical pixels.
    pub panes: &'a [(usize, Viewport)],
    /// Physical pixels per point. Line widths are in points.
    pub pixels_per_point: f32,
    /// Colours and light of the empty stage.
    pub look: Look,
    /// Colours of the motions.
    pub colors: Colors,
    /// The elements that are highlighted.
    pub highlights: Highlights,
}

impl Default for StageOptions<'_> {
    fn default() -> Self {
        Self {
            panes: &[],
            pixels_per_point: 1.0,
            look: Look::DARK,
            colors: Colors::default(),
            highlights: Highlights::default(),
        }
    }
}

/// Makes the stage from the session, and holds its state between frames: moving cameras, and the
/// bodies of skeletons.
#[derive(Debug, Default)]
pub struct Director {
    stage: Arc<Stage>,
    rigs: Vec<CameraRig>,
    /// The joints of the results, pane by pane, in the world; empty for a pane without a result.
    figures: Vec<Vec<Vec3>>,
    bodies: BodyCache,
}

impl Director {
    /// Returns the stage for the current state of the session. `dt_secs` advances the cameras.
    pub fn stage(
        &mut self,
        session: &Session,
        options: &StageOptions<'_>,
        dt_secs: f32,
    ) -> Arc<Stage> {
        let now = session.now_secs();
        // Panes are reused, so that their memory is kept.
        let mut panes = std::mem::take(&mut Arc::make_mut(&mut self.stage).panes);
        panes.resize_with(options.panes.len(), Pane::default);
        self.rigs.resize_with(session.panes().len(), CameraRig::default);
        self.figures.resize_with(session.panes().len(), Vec::new);
        self.figures.iter_mut().for_each(Vec::clear);
        self.bodies.update(session);
        let mut context = DrawContext {
            session,
            params: session.params(),
            look: &options.look,
            colors: &options.colors,
            highlights: &options.highlights,
            bodies: &mut self.bodies,
        };
        let first =
            options.panes.iter().find_map(|&(index, _)| session.panes().get(index)?.shown_at(now));
        let (size, height) = first.map_or((1.0, 0.0), |shown| {
            let motion = &shown.outcome.motion;
            let body = context.bodies.body(motion);
            (body.size(), height_in_view(motion, body.reach()) * body.size())
        });
        let shown_size = size * figure_height(context.params);
        let farther = farther(height);
        for (pane, &(index, viewport)) in panes.iter_mut().zip(options.panes) {
            pane.clear();
            pane.viewport = viewport;
            pane.skinning = skinning_of(session, index);
            let Some(source) = session.panes().get(index) else {
                continue;
            };
            let shown = source.shown_at(now);
            let (shown, followed, rest) = if let Some(shown) = shown {
                let Some(shown) = PosedResult::new(shown, &mut context) else {
                    continue;
                };
                add_contents(index, &shown, &mut context, pane);
                if let Some(figure) = self.figures.get_mut(index) {
                    place_joints(&shown, figure);
                }
                let followed = cameras::followed_point(&shown, &mut context);
                let rest = resting_point(shown.outcome, &shown.place);
                (Some(shown), followed, rest)
            } else {
                sources::add_stand_ins(source, now, &mut context, pane);
                let Some(first) = source.sources.first() else {
                    continue;
                };
                (None, None, resting_place(&first.motion, &first.world_from_clip))
            };
            if let Some(rig) = self.rigs.get_mut(index) {
                let aim = cameras::Aim { followed, rest, scale: farther / shown_size };
                cameras::aim(rig, &aim, &context, dt_secs, pane);
            }
            if let Some(shown) = shown.filter(|_| options.highlights.joint) {
                annotations::add_joint_mark(&shown, &context, pane);
            }
        }
        let stage = Arc::make_mut(&mut self.stage);
        stage.panes = panes;
        stage.look = options.look;
        stage.pixels_per_point = options.pixels_per_point;
        // Of a mouse the cells are 10 cm, so that there is a ground beneath it.
        stage.grid_metres = 10.0_f32.powf(farther.log10().round()) / shown_size;
        Arc::clone(&self.stage)
    }

    /// Does a millisecond or two of the work that takes longer than a frame: building the skins of
    /// visible skeletons. Until a skin is complete, a body consists of limbs. Returns whether more
    /// is left.
    pub fn work(&mut self) -> bool {
        self.bodies.work()
    }

    /// Returns whether a skin is being built.
    #[must_use]
    pub fn is_at_work(&self) -> bool {
        self.bodies.is_at_work()
    }

    /// Returns whether a camera is moving, so that another frame is needed.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.rigs.iter().any(|rig| !rig.is_still())
    }

    /// Returns the positions in the world of the joints of a pane's result, in the order of its
    /// skeleton, on the figure that was drawn in the last frame; empty without a result.
    #[must_use]
    pub fn figure(&self, pane: usize) -> &[Vec3] {
        self.figures.get(pane).map_or(&[], Vec::as_slice)
    }

    /// Returns the camera of a pane in the last frame.
    #[must_use]
    pub fn camera(&self, pane: usize) -> Option<&Camera> {
        self.rigs.get(pane).map(CameraRig::camera)
    }
}

/// Adds the places of a result's joints on the drawn figure to `figure`.
fn place_joints(shown: &PosedResult<'_>, figure: &mut Vec<Vec3>) {
    let PosedResult { outcome, body, world, .. } = shown;
    let motion = &outcome.motion;
    let place = |joint: usize| world.positions.get(body.drawn_joint(joint)).copied();
    figure
        .extend((0..motion.clip().skeleton().len()).map(|joint| place(joint).unwrap_or_default()));
}

/// Adds everything that a pane shows of a result and around it.
fn add_contents(
    index: usize,
    shown: &PosedResult<'_>,
    context: &mut DrawContext<'_>,
    pane: &mut Pane,
) {
    let Highlights { pair, jump, .. } = *context.highlights;
    let pair = pair.zip(context.session.distance_map());
    let jump = jump.zip(context.session.graph_built());
    match (pair, jump) {
        (Some((frames, map)), _) => labs::register::add_pair(shown, frames, map, context, pane),
        (None, Some((ends, built))) => labs::graph::add_jump(shown, ends, built, context, pane),
        (None, None) => result::add_result(shown, context, pane),
    }
    extra_characters::add_extra_characters(context, pane);
    labs::graph::add_asked_path(context, pane);
    labs::path::add_drawn(&context.highlights.path, context.colors, pane);
    if index == 0 {
        labs::match_::add_crowd(shown, context, pane);
    }
}

/// Returns the skinning method of a pane: that of the pane where methods are compared, otherwise
/// that of the parameters.
fn skinning_of(session: &Session, pane: usize) -> Skinning {
    let compared = session.panes().get(pane).and_then(|pane| match &pane.variant {
        Some((Key::Skinning, value)) => value.choice(),
        _ => None,
    });
    match compared.unwrap_or(session.params().choice()) {
        choices::Skinning::Linear => Skinning::Linear,
        choices::Skinning::Dual => Skinning::Dual,
    }
}
