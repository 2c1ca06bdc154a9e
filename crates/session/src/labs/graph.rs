//! The Graph lab: a motion graph of several clips, and a walk through it that is extended while it
//! plays.

use super::lab::{Beside, HasPart, Inputs, Lab, LabClips, LabInputs};
use crate::labs::LabError;
use crate::params::{Key, Params, Value};
mod built_graph;
mod candidate_finder;
mod graph_clips;
mod plan;
mod requests;
mod scheduler;
mod streamed_search;
mod tiled_search;
mod walk;
mod walk_builder;

pub use built_graph::{BuiltGraph, DistanceField, Distances};
pub use graph_clips::GraphClips;
pub use requests::{check_graph_clips, graph_of};
pub(crate) use requests::{clips_of, visits_of};
pub(crate) use scheduler::GraphScheduler;
pub use walk::{FollowedPath, Walk, WalkGhost, WalkMoment, WalkStay};

use super::{LabFacts, MeasuredMotion, Outcome, PlacedClip, Slot, Transition};
use segue_text::{Message, msg};
use std::sync::Arc;

/// The Graph lab: a walk through a motion graph.
pub(super) struct GraphLab;

impl<S: HasPart<GraphScheduler>> Lab<S> for GraphLab {
    fn more_clips(&self, params: &Params) -> Result<Vec<String>, LabError> {
        clips_of(params.clip_ids(Key::Clips))
    }

    fn without_clip(&self, params: &Params, id: &str) -> Vec<(Key, Value)> {
        let ids = Lab::<S>::listed(self, params);
        let others: Vec<String> = ids.iter().filter(|known| *known != id).cloned().collect();
        if others.is_empty() || others.len() == ids.len() {
            return Vec::new();
        }
        graph_of(&others)
    }

    fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        Some(graph_of(ids))
    }

    fn result_name(&self, params: &Params, _a: Message, _b: Message) -> Message {
        msg!("walk, seed {seed}", seed = Key::Seed.param().format(params.get(Key::Seed)))
    }

    fn file_stem(&self, _params: &Params) -> String {
        "walk".to_owned()
    }

    fn length_parameters(&self, outcome: &Outcome) -> Vec<(Key, Value)> {
        // In whole seconds, within the range of the parameter.
        let secs = outcome.duration_secs().round().clamp(10.0, 600.0);
        vec![(Key::WalkSeconds, Value::Number(secs))]
    }

    fn has(&self, beside: Beside) -> bool {
        beside == Beside::Graph
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let clips = clips.more.into_iter().map(|clip| (clip.name, clip.motion)).collect();
        Ok(HasPart::<GraphScheduler>::part(labs).inputs(clips, params)?.map(Inputs::new))
    }
}

/// The inputs of a walk's result. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct GraphInputs(pub(super) Arc<Walk>);

impl PartialEq for GraphInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl LabInputs for GraphInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let walk = &self.0;
        let (mut sources, mut transition) = (Vec::new(), None);
        if let (true, [left, entered]) = (walk.is_jump, walk.passed.as_slice())
            && let Some(seam) = entered.seam
        {
            let fps = walk.motion.clip().fps();
            let secs = |frame: usize| frame as f64 / fps;
            let clips = [(Slot::A, left), (Slot::B, entered)];
            sources.extend(clips.into_iter().filter_map(|(slot, part)| {
                let motion = walk.built.clips.motions().get(part.stay.clip)?;
                let starts_at = secs(part.start) - secs(part.stay.from);
                Some(PlacedClip::new(slot, motion, starts_at, part.world_from_clip))
            }));
            transition = Some(Transition {
                start_secs: secs(entered.start),
                end_secs: secs(entered.start + seam.frames),
                leave_a_secs: secs(seam.leave.frame),
                enter_b_secs: secs(seam.enter.frame),
                window_frames: seam.frames,
                distance_cm: walk.jump_cm(entered).unwrap_or(f64::NAN) as f32,
                search: None,
            });
        }
        Ok(Outcome {
            sources,
            transition,
            facts: LabFacts::of(Arc::clone(walk)),
            metrics: walk.metrics.clone(),
            beside: walk
                .built
                .clips
                .motions()
                .iter()
                .map(|motion| Arc::clone(motion.clip()))
                .collect(),
            measured: walk.trace.clone().map_or(MeasuredMotion::Motion, MeasuredMotion::Trace),
            ..Outcome::plain(Arc::clone(&walk.motion))
        })
    }

    /// Returns whether the walk follows the best path found so far, while a better one is searched
    /// for.
    fn is_draft(&self) -> bool {
        self.0.followed.as_ref().is_some_and(|trace| trace.is_searching)
    }
}

#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod guide_tests;
#[cfg(test)]
mod scheduling_tests;
#[cfg(test)]
mod visit_tests;
#[cfg(test)]
mod walk_tests;
