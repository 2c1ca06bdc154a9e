use crate::choices;
use crate::labs::LabError;
use crate::labs::blend::{align_by, root_blend, weight_law};
use crate::labs::feet::Lock;
use crate::labs::recipe::{read_ids, write_ids};
use crate::outside::short;
use crate::params::{Key, Params, Value};
use glam::DVec2;
use segue_motion::graph::{
    Construction, Continuity, DistanceLaw, GraphOptions, Place, StitchOptions, WalkMistake,
    WeightOptions,
};
use segue_motion::math::Decay;
use segue_motion::transition::{Inertialization, Method, Mistake};
use std::fmt::Write as _;

/// More clips make a picture that nobody can read.
pub(crate) const MOST_CLIPS: usize = 64;
/// Points of a ground path, visits of clips: more are an accident.
const MOST_POINTS: usize = 1_000;

/// What a walk depends on, besides the clips.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wanted {
    pub(super) graph: GraphKey,
    pub(super) weights: WeightOptions,
    pub(super) seed: u64,
    pub(super) discount: f64,
    pub(super) stitch: StitchOptions,
    /// How planted feet are held, where they are.
    pub(super) foot_lock: Option<Lock>,
    /// How much of the walk is measured, seconds.
    pub(super) measured_secs: f64,
    /// When to set off for which clip: seconds, and its index.
    pub(super) visits: Vec<(f64, usize)>,
    /// A line over the ground to follow; empty for none.
    pub(super) path: Vec<DVec2>,
    /// One transition in place of a walk.
    pub(super) jump: Option<[Place; 2]>,
    /// The walk through another graph that this one goes like, where it can.
    pub(super) guide: Option<Box<Self>>,
}

/// What a graph depends on, besides the clips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GraphKey {
    pub(super) options: GraphOptions,
    pub(super) pruned: bool,
}

impl Wanted {
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
        let visits = read_visits(params.text(Key::GoTo))?;
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
            path: read_path(params.text(Key::WalkPath))?,
            jump: read_jump(params.text(Key::Jump))?,
            guide: None,
        })
    }

    /// Likewise, like the walk of other parameters if only its transitions take longer or shorter.
    /// Where one may go over is another matter: a graph of shorter segments, or up to a higher
    /// threshold, has all places of the other one, and to go like that walk would show none of its
    /// own. One that follows a line has its own way to go.
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

/// The ids of a list of clips. An id may stand there several times, and counts once.
pub(crate) fn clips_of(text: &str) -> Result<Vec<String>, LabError> {
    let listed = read_ids(text).ok_or_else(|| LabError::GraphClips { found: short(text) })?;
    let mut ids: Vec<String> = Vec::new();
    for id in listed.iter().map(|id| id.trim()).filter(|id| !id.is_empty()) {
        if !ids.iter().any(|known| known == id) {
            ids.push(id.to_owned());
        }
    }
    match ids.len() {
        0 => Err(LabError::NoGraphClips),
        count if count > MOST_CLIPS => Err(LabError::TooManyGraphClips { count }),
        _ => Ok(ids),
    }
}

/// Says what is wrong with a list of clips for a graph, before anything is set.
///
/// # Errors
/// [`LabError`] would stand in place of the result.
pub fn check_graph_clips(text: &str) -> Result<(), LabError> {
    clips_of(text).map(drop)
}

/// What is to be set for other clips. What tells clips by their place in the list means nothing any
/// more.
#[must_use]
pub fn graph_of(ids: &[String]) -> Vec<(Key, Value)> {
    let none = || Value::Text(String::new());
    vec![(Key::Clips, Value::Text(write_ids(ids))), (Key::GoTo, none()), (Key::Jump, none())]
}

/// Pairs of two numbers with a colon between them and commas between the pairs.
fn read_pairs(
    text: &str,
    what: &'static str,
    example: &'static str,
) -> Result<Vec<(f64, f64)>, LabError> {
    let refuse = |part: &str| LabError::Pairs { what, found: short(part), example };
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.abs() < 1e5);
    let pairs: Vec<(f64, f64)> = (text.split(','))
        .filter(|part| !part.trim().is_empty())
        .map(|part| {
            let (a, b) = part.split_once(':').ok_or_else(|| refuse(part))?;
            number(a).zip(number(b)).ok_or_else(|| refuse(part))
        })
        .collect::<Result<_, _>>()?;
    if pairs.len() > MOST_POINTS {
        return Err(LabError::TooManyPairs { what, count: pairs.len(), most: MOST_POINTS });
    }
    Ok(pairs)
}

/// When to set off for which clip.
pub(crate) fn read_visits(text: &str) -> Result<Vec<(f64, usize)>, LabError> {
    let pairs = read_pairs(text, "Go to", "12.5:3,40:0")?;
    let mut visits: Vec<(f64, usize)> =
        pairs.into_iter().map(|(secs, clip)| (secs.max(0.0), clip.max(0.0) as usize)).collect();
    visits.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(visits)
}

/// Visits as the parameter has them: seconds and a clip's index.
#[must_use]
pub fn write_visits(visits: &[(f64, usize)]) -> String {
    joined(visits.iter().map(|(secs, clip)| format!("{}:{clip}", rounded(*secs, 10.0))))
}

/// The points of a ground path, (x, z) in metres.
pub(crate) fn read_path(text: &str) -> Result<Vec<DVec2>, LabError> {
    let pairs = read_pairs(text, "Ground path", "0:0,1.5:4")?;
    Ok(pairs.into_iter().map(|(x, z)| DVec2::new(x, z)).collect())
}

/// A ground path as the parameter has it.
#[must_use]
pub fn write_path(points: &[DVec2]) -> String {
    joined(
        points
            .iter()
            .map(|point| format!("{}:{}", rounded(point.x, 100.0), rounded(point.y, 100.0))),
    )
}

fn read_jump(text: &str) -> Result<Option<[Place; 2]>, LabError> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let place = |text: &str| {
        let (clip, frame) = text.split_once(':')?;
        Some(Place { clip: clip.trim().parse().ok()?, frame: frame.trim().parse().ok()? })
    };
    let ends = text.split_once('-').and_then(|(leave, enter)| Some([place(leave)?, place(enter)?]));
    ends.map(Some).ok_or_else(|| LabError::Jump { found: short(text) })
}

/// A transition as the parameter has it.
#[must_use]
pub fn write_jump(leave: Place, enter: Place) -> String {
    format!("{}:{}-{}:{}", leave.clip, leave.frame, enter.clip, enter.frame)
}

fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit
}

fn joined(parts: impl Iterator<Item = String>) -> String {
    parts.enumerate().fold(String::new(), |mut text, (index, part)| {
        let comma = if index > 0 { "," } else { "" };
        let written = write!(text, "{comma}{part}");
        debug_assert!(written.is_ok(), "a string takes all");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_written_is_read() {
        let visits = [(0.0, 3), (12.5, 0)];
        assert_eq!(read_visits(&write_visits(&visits)).unwrap(), visits);
        let path = [DVec2::new(0.0, -1.25), DVec2::new(3.5, 4.0)];
        assert_eq!(read_path(&write_path(&path)).unwrap(), path);
        let [leave, enter] = [Place { clip: 0, frame: 52 }, Place { clip: 3, frame: 14 }];
        assert_eq!(read_jump(&write_jump(leave, enter)).unwrap(), Some([leave, enter]));
        assert_eq!(
            clips_of("walk,run(turn_rate:20,lean:2),walk").unwrap(),
            ["walk", "run(turn_rate:20,lean:2)"]
        );
        let ids = [
            "walk",
            "slow, then fast.bvh",
            "turn (left",
            "100 %",
            "walk(turn_rate:20,make_seconds:2)",
        ]
        .map(str::to_owned);
        let Some((Key::Clips, Value::Text(text))) = graph_of(&ids).into_iter().next() else {
            panic!("the clips come first");
        };
        assert_eq!(clips_of(&text).unwrap(), ids);
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[0-9:,.\\-a-z() ]{0,40}") {
            let _read = (clips_of(&text), read_visits(&text), read_path(&text), read_jump(&text));
        }
    }
}
