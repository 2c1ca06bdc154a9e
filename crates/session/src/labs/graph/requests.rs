//! Requests for graphs and walks, from the parameters.

use crate::choices;
use crate::labs::blend::{align_by, root_blend, weight_law};
use crate::labs::error::{LabError, MAX_CLIPS};
use crate::labs::feet::Lock;
use crate::params::{Key, List, Params, Value};
use glam::DVec2;
use segue_motion::graph::{
    Construction, Continuity, DistanceLaw, GraphOptions, Place, StitchOptions, WalkMistake,
    WeightOptions,
};
use segue_motion::math::Decay;
use segue_motion::math::sort::sort_by;
use segue_motion::transition::{Inertialization, Method, Mistake};

/// A request for a walk, besides the clips.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WalkRequest {
    pub(super) graph: GraphKey,
    pub(super) weights: WeightOptions,
    pub(super) seed: u64,
    pub(super) discount: f64,
    pub(super) stitch: StitchOptions,
    /// The foot lock options, if feet are locked.
    pub(super) foot_lock: Option<Lock>,
    /// The duration that is measured, seconds.
    pub(super) measured_secs: f64,
    /// Visits: the time to leave, seconds, and the index of the clip.
    pub(super) visits: Vec<(f64, usize)>,
    /// A path over the ground to follow; empty for none.
    pub(super) path: Vec<DVec2>,
    /// A single transition instead of a walk.
    pub(super) jump: Option<[Place; 2]>,
    /// The walk through another graph that this one follows where it can.
    pub(super) guide: Option<Box<Self>>,
}

/// A request for a graph, besides the clips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GraphKey {
    pub(super) options: GraphOptions,
    pub(super) pruned: bool,
}

impl WalkRequest {
    pub(super) fn of(params: &Params, clips: usize) -> Result<Self, LabError> {
        let window = params.number(Key::BlendWindow) as usize;
        let of_transform = match params.choice::<choices::Transform>() {
            choices::Transform::First => Some(WalkMistake::FirstFrameOnly),
            choices::Transform::Teleport => Some(WalkMistake::FirstFrameThenRecorded),
            choices::Transform::Whole => None,
        };
        let of_angle = match params.choice::<choices::Atan>() {
            choices::Atan::Atan => Some(Mistake::AtanForAtan2),
            choices::Atan::Degrees => Some(Mistake::DegreesInTransform),
            choices::Atan::Facing => Some(Mistake::WrongFacingAxis),
            choices::Atan::Atan2 => None,
        };
        if of_transform.is_some() && of_angle.is_some() {
            return Err(LabError::TwoMistakes);
        }
        let method = match params.choice::<choices::WalkMethod>() {
            choices::WalkMethod::Inertialize => {
                Method::Inertialize(Inertialization::Offset(Decay::Spring {
                    half_life_secs: params.number(Key::HalfLife),
                }))
            }
            choices::WalkMethod::Dissolve => Method::Dissolve { window, law: weight_law(params) },
        };
        let visits = visits_of(params);
        if let Some((_, clip)) = visits.iter().find(|(_, clip)| *clip >= clips) {
            return Err(LabError::NoVisit { clip: *clip, last: clips.saturating_sub(1) });
        }
        Ok(Self {
            graph: GraphKey {
                options: GraphOptions {
                    construction: match params.choice::<choices::Construction>() {
                        choices::Construction::Segments => Construction::Segments {
                            segment_size: params.number(Key::SegmentSize) as usize,
                        },
                        choices::Construction::Minima => Construction::Minima,
                    },
                    blend_window: window,
                    edge_threshold_cm: params.number(Key::EdgeThreshold),
                    min_jump_secs: params.number(Key::MinJump),
                    most_ways_out: params.number(Key::MostWaysOut) as usize,
                },
                pruned: params.is_on(Key::Prune),
            },
            weights: WeightOptions {
                continuity: match params.choice::<choices::GoingOn>() {
                    choices::GoingOn::Constant => {
                        Continuity::Weight(params.number(Key::ContinuityWeight))
                    }
                    choices::GoingOn::Share => Continuity::Share(params.number(Key::Continuity)),
                },
                law: match params.choice::<choices::EdgeWeight>() {
                    choices::EdgeWeight::Exponential => {
                        DistanceLaw::Exponential { sigma_cm: params.number(Key::EdgeSigma) }
                    }
                    choices::EdgeWeight::Uniform => DistanceLaw::Uniform,
                    choices::EdgeWeight::Proportional => DistanceLaw::Proportional,
                    choices::EdgeWeight::Inverse => DistanceLaw::Inverse,
                },
            },
            seed: params.number(Key::Seed) as u64,
            discount: params.number(Key::VisitedDiscount),
            stitch: StitchOptions {
                align_by: align_by(params),
                root: root_blend(params),
                mistake: of_transform.or(of_angle.map(WalkMistake::Transition)),
                ..StitchOptions::new(method)
            },
            foot_lock: Lock::of(params),
            measured_secs: params.number(Key::WalkSeconds),
            visits,
            path: params.ground_path().to_vec(),
            jump: params.jump().copied(),
            guide: None,
        })
    }

    /// Returns the request that follows the walk of other parameters, if only the length of its
    /// transitions differs. With shorter segments or a higher threshold, a graph contains all
    /// places of the other one, and a walk that followed it would show none of its own. A walk
    /// along a path has its own way to go.
    pub(super) fn guided(
        params: &Params,
        guide: Option<&Params>,
        clips: usize,
    ) -> Result<Self, LabError> {
        let wanted = Self::of(params, clips)?;
        let guide = guide.and_then(|guide| Self::of(guide, clips).ok());
        let but_for_window = |graph: GraphKey| GraphKey {
            options: GraphOptions { blend_window: 1, ..graph.options },
            ..graph
        };
        let guide = guide
            .filter(|guide| {
                guide.graph != wanted.graph
                    && but_for_window(guide.graph) == but_for_window(wanted.graph)
            })
            .filter(|_| wanted.jump.is_none() && wanted.path.is_empty())
            .map(Box::new);
        Ok(Self { guide, ..wanted })
    }
}

/// Returns the clips of a list. An id that is listed several times counts once.
///
/// # Errors
/// The list is empty or too long.
pub(crate) fn clips_of(listed: &[String]) -> Result<Vec<String>, LabError> {
    let mut ids: Vec<String> = Vec::new();
    for id in listed {
        if !ids.contains(id) {
            ids.push(id.clone());
        }
    }
    match ids.len() {
        0 => Err(LabError::NoGraphClips),
        count if count > MAX_CLIPS => Err(LabError::TooManyGraphClips { count }),
        _ => Ok(ids),
    }
}

/// Checks a list of clips for a graph before it is set.
///
/// # Errors
/// The [`LabError`] that the graph would have.
pub fn check_graph_clips(listed: &[String]) -> Result<(), LabError> {
    clips_of(listed).map(drop)
}

/// Returns the parameters to set for other clips. Those that refer to clips by index are reset.
#[must_use]
pub fn graph_of(ids: &[String]) -> Vec<(Key, Value)> {
    vec![
        (Key::Clips, List::ClipIds(ids.to_vec()).into()),
        (Key::GoTo, List::Visits(Vec::new()).into()),
        (Key::Jump, List::Jump(None).into()),
    ]
}

/// Returns the visits in order of time: when to set off, seconds, and the index of the clip.
pub(crate) fn visits_of(params: &Params) -> Vec<(f64, usize)> {
    let mut visits = params.visits().to_vec();
    sort_by(&mut visits, |a, b| a.0.total_cmp(&b.0));
    visits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clip_listed_twice_counts_once() {
        let ids = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect::<Vec<_>>();
        assert_eq!(clips_of(&ids(&["walk", "run", "walk"])), Ok(ids(&["walk", "run"])));
        assert_eq!(clips_of(&[]), Err(LabError::NoGraphClips));
        let many: Vec<String> = (0..65).map(|index| index.to_string()).collect();
        assert_eq!(clips_of(&many), Err(LabError::TooManyGraphClips { count: 65 }));
    }

    #[test]
    fn visits_are_in_the_order_of_time() {
        let mut params = Params::default();
        params.set(Key::GoTo, List::Visits(vec![(40.0, 0), (12.5, 3)]).into()).unwrap();
        assert_eq!(visits_of(&params), [(12.5, 3), (40.0, 0)]);
    }
}
