//! The Blend lab, and the transitions of the Transition lab: from one clip to another.

use super::feet::{Lock, slide, slide_before, with_feet};
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::pair::{Pair, Pairs};
use super::sliced::{JobKind, Sliced};
use super::{MatchSearch, Outcome, PlacedClip, Slot, Transition};
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, MAX_PANES, Params};
use crate::{LabId, choices};
use segue_motion::blend::{AlignBy, RootBlend, WeightLaw};
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::math::{Decay, Planar};
use segue_motion::metrics::{TransitionMetrics, worst_foot_slide};
use segue_motion::registration::{
    PoseSearch, PoseWeights, SearchOptions, TransitionSearch, limb_weights,
};
use segue_motion::transition::{
    Inertialization, Method, Mistake, TransitionOptions, concatenate, concatenate_mistaken,
};
use segue_text::{Message, msg};
use std::collections::VecDeque;
use std::sync::Arc;

/// The Blend lab: A fades into B over a window.
pub(super) struct BlendLab;

impl<S: HasPart<Pairs> + HasPart<BlendCache>> Lab<S> for BlendLab {
    fn result_name(&self, _params: &Params, a: Message, b: Message) -> Message {
        msg!("{a} to {b}", a, b)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} to {}", params.text(Key::A), params.text(Key::B))
    }

    fn found(&self, outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        let found = |transition: &Transition| {
            vec![(Key::LeaveA, transition.leave_a_secs), (Key::EnterB, transition.enter_b_secs)]
        };
        outcome.transition.as_ref().map(found).unwrap_or_default()
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let Some(pair) = HasPart::<Pairs>::part(labs).of_slots(&clips.slots, params)? else {
            return Ok(None);
        };
        Ok(Some(Inputs::new(HasPart::<BlendCache>::part(labs).inputs(
            &pair,
            params,
            match_window,
        )?)))
    }
}

/// The inputs of a blend. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct BlendInputs {
    pair: Arc<Pair>,
    place: Place,
    options: TransitionOptions,
    mistake: Option<Mistake>,
    foot_lock: Option<Lock>,
}

impl PartialEq for BlendInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pair, &other.pair)
            && self.place == other.place
            && self.options == other.options
            && self.mistake == other.mistake
            && self.foot_lock == other.foot_lock
    }
}

/// The frames at which A is left and B is entered.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    leave: usize,
    enter: usize,
    distance_cm: f32,
    search: Option<MatchSearch>,
    /// Whether one of the frames stands in for the best match, which is being searched for.
    is_guess: bool,
}

/// A request for a match, besides the two clips.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MatchRequest {
    window: usize,
    /// The number of frames that a clip must have from a frame set by hand on, that frame included.
    behind: usize,
    leave: Option<usize>,
    enter: Option<usize>,
    /// Weights by which single poses are compared; `None` compares windows.
    weights: Option<PoseWeights>,
}

/// Returns the mistake that the Transition lab is to make.
fn mistake_of(params: &Params) -> Option<Mistake> {
    match params.choice::<choices::Mistake>() {
        choices::Mistake::Hemisphere => Some(Mistake::NoHemisphereCheck),
        choices::Mistake::Euler => Some(Mistake::EulerLerp),
        choices::Mistake::Degrees => Some(Mistake::DegreesForRadians),
        choices::Mistake::Atan => Some(Mistake::AtanForAtan2),
        choices::Mistake::TransformDegrees => Some(Mistake::DegreesInTransform),
        choices::Mistake::Facing => Some(Mistake::WrongFacingAxis),
        choices::Mistake::Alignment => Some(Mistake::NoAlignment),
        choices::Mistake::Velocity => Some(Mistake::VelocityDividedTwice),
        choices::Mistake::WorldRoot => Some(Mistake::WorldRoot),
        choices::Mistake::None => None,
    }
}

/// Returns whether the chosen method shows the chosen mistake; `true` without a mistake.
#[must_use]
pub fn mistake_shows(params: &Params) -> bool {
    mistake_of(params).is_none_or(|mistake| {
        mistake.concerns(&method_of(params, params.number(Key::BlendWindow) as usize))
    })
}

/// Returns the law by which the weight moves from A to B.
pub(super) fn weight_law(params: &Params) -> WeightLaw {
    match params.choice::<choices::WeightLaw>() {
        choices::WeightLaw::Linear => WeightLaw::Linear,
        choices::WeightLaw::Smoother => WeightLaw::Smoother,
        choices::WeightLaw::Smooth => WeightLaw::Smooth,
    }
}

/// Returns the points by which B is aligned with A.
pub(super) fn align_by(params: &Params) -> AlignBy {
    match params.choice::<choices::AlignBy>() {
        choices::AlignBy::First => AlignBy::FirstPose,
        choices::AlignBy::Window => AlignBy::Window,
    }
}

/// Returns the method of blending root motion.
pub(super) fn root_blend(params: &Params) -> RootBlend {
    if params.is_on(Key::RootBlend) { RootBlend::Velocity } else { RootBlend::World }
}

/// Returns the method of the Transition lab; `window` is that of its dissolves.
fn method_of(params: &Params, window: usize) -> Method {
    let blend_secs = params.number(Key::BlendTime);
    match params.choice::<choices::TransitionMethod>() {
        choices::TransitionMethod::Cut => Method::Cut,
        choices::TransitionMethod::Linear => Method::Dissolve { window, law: WeightLaw::Linear },
        choices::TransitionMethod::Smooth => Method::Dissolve { window, law: WeightLaw::Smooth },
        choices::TransitionMethod::Cubic => {
            Method::Inertialize(Inertialization::Offset(Decay::Cubic { blend_secs }))
        }
        choices::TransitionMethod::Quintic => {
            Method::Inertialize(Inertialization::Offset(Decay::Quintic { blend_secs }))
        }
        choices::TransitionMethod::Dead => Method::Inertialize(Inertialization::DeadBlend {
            blend_secs,
            extrapolation_half_life_secs: params.number(Key::ExtrapolationHalfLife),
        }),
        choices::TransitionMethod::Inertialize => {
            Method::Inertialize(Inertialization::Offset(Decay::Spring {
                half_life_secs: params.number(Key::HalfLife),
            }))
        }
    }
}

/// Returns the range of the automatic search: A is left in its second half, B entered in its first,
/// and all seams of kept clips are included. The window fits after the last one of A.
fn open_search(pair: &Pair, window: usize) -> SearchOptions {
    let mut options = SearchOptions::new(window);
    let share = |frame: f64, motion: &Motion| frame / motion.clip().frames().max(1) as f64;
    if !pair.a.seams().is_empty() {
        let (frames, behind) = (pair.a.clip().frames(), pair.a.behind_seams());
        let half = frames.div_ceil(2);
        let from = if half + window <= frames { behind.max(half) } else { behind };
        options.leave.from = share(from as f64 - 0.5, &pair.a);
    }
    if !pair.incoming.seams().is_empty() {
        options.enter.to =
            options.enter.to.min(share(pair.incoming.before_seams() as f64 + 0.5, &pair.incoming));
    }
    options
}

fn pose_search(pair: &Pair) -> Result<PoseSearch, LabError> {
    let skeleton = pair.a.clip().skeleton();
    let search = PoseSearch::new(
        (pair.a.clip(), pair.a.ground_frames()),
        (pair.incoming.clip(), pair.incoming.ground_frames()),
        &limb_weights(skeleton),
        pair.a.roles().body_height(skeleton).into(),
    );
    search.map_err(LabError::from)
}

/// A cache of what does not change between blends: the pair of clips and the distances between
/// their frames.
#[derive(Debug, Default)]
pub(crate) struct BlendCache {
    pair: Option<Arc<Pair>>,
    search: Option<TransitionSearch>,
    /// The search by pose, begun on request.
    poses: Option<PoseSearch>,
    /// The last matches with their requests: panes share one or have one each, and most changes
    /// leave them valid.
    found: VecDeque<(MatchRequest, Place)>,
    progress: f32,
    /// Whether all distances have been computed and not been fetched yet.
    is_ready: bool,
}

/// The number of rows of the distance grid in one slice: about 2 ms for 31 joints in a browser.
const ROWS_PER_SLICE: usize = 16;
/// The number of rows that are compared at once when the clips change: a few seconds of motion need
/// no second slice.
const ROWS_AT_ONCE: usize = 160;

impl BlendCache {
    /// Prepares the inputs, with which the blend itself is a pure function: finds the place and
    /// fits the clips to each other.
    pub(crate) fn inputs(
        &mut self,
        pair: &Arc<Pair>,
        params: &Params,
        match_window: usize,
    ) -> Result<BlendInputs, LabError> {
        self.set_pair(pair)?;
        let (frames_a, frames_b) = (pair.a.clip().frames(), pair.incoming.clip().frames());
        let in_transition = params.lab() == LabId::Transition;
        let fps = pair.a.clip().fps();
        let given = if in_transition {
            [
                params.optional(Key::MixFrameA),
                params.optional(Key::MixFrameB).map(|frame| frame / pair.b.clip().fps() * fps),
            ]
        } else {
            [Key::LeaveA, Key::EnterB].map(|key| params.optional(key).map(|secs| secs * fps))
        };
        // If automatic, A is left after its last seam.
        let room_in_a = if given[0].is_none() {
            frames_a - pair.a.behind_seams().min(frames_a)
        } else {
            frames_a
        };
        let most = room_in_a.min(frames_b);
        let window = (params.number(Key::BlendWindow) as usize).min(most);
        let method = if in_transition {
            method_of(params, window)
        } else {
            let law = weight_law(params);
            Method::Dissolve { window, law }
        };
        let match_window = match_window.min(most);
        // A dissolve needs its window after both frames: the widest one where several panes are
        // compared, so that all show the same place. The other methods need one frame of B.
        let behind =
            if let Method::Dissolve { window, .. } = method { match_window.max(window) } else { 1 };
        let [leave, enter] = [(given[0], frames_a), (given[1], frames_b)].map(|(frame, frames)| {
            frame.map(|frame| (frame.round() as usize).min(frames.saturating_sub(behind)))
        });
        let weights = (in_transition
            && params.choice::<choices::MatchBy>() == choices::MatchBy::Pose)
            .then(|| PoseWeights {
                position: params.number(Key::MatchPosition),
                rotation: params.number(Key::MatchRotation),
                velocity: params.number(Key::MatchVelocity),
            });
        let wanted = MatchRequest { window: match_window, behind, leave, enter, weights };
        let place = self.place(pair, wanted)?;
        Ok(BlendInputs {
            pair: Arc::clone(pair),
            place,
            mistake: in_transition.then(|| mistake_of(params)).flatten(),
            foot_lock: Lock::of(params),
            options: TransitionOptions {
                method,
                align: params.is_on(Key::Align),
                align_by: align_by(params),
                root: root_blend(params),
            },
        })
    }

    /// Begins to compare the frames of two new clips.
    fn set_pair(&mut self, pair: &Arc<Pair>) -> Result<(), LabError> {
        if self.pair.as_ref().is_some_and(|known| Arc::ptr_eq(known, pair)) {
            return Ok(());
        }
        let weights = limb_weights(pair.a.clip().skeleton());
        let body_height = pair.a.roles().body_height(pair.a.clip().skeleton());
        let search = TransitionSearch::new(
            Arc::clone(pair.a.clip()),
            Arc::clone(pair.incoming.clip()),
            &weights,
            body_height.into(),
        );
        self.search = Some(search?);
        self.pair = Some(Arc::clone(pair));
        self.poses = None;
        self.found.clear();
        self.compare_rows(ROWS_AT_ONCE);
        Ok(())
    }

    fn compare_rows(&mut self, rows: usize) {
        // The windows first, then the poses if they are requested.
        let windows = self.search.as_mut().map(|search| search.advance(rows));
        let poses = match (&windows, &mut self.poses) {
            (Some(progress), Some(search)) if progress.is_complete() => Some(search.advance(rows)),
            _ => None,
        };
        let share = |done: usize, total: usize| done as f32 / total.max(1) as f32;
        self.progress = match (windows, poses) {
            (Some(progress), None) | (_, Some(progress)) if !progress.is_complete() => {
                share(progress.done, progress.total)
            }
            _ => 1.0,
        };
    }

    /// Returns the frames that the user set, and the best match for the others; the middle of the
    /// allowed range until the distances are known.
    fn place(&mut self, pair: &Pair, wanted: MatchRequest) -> Result<Place, LabError> {
        if wanted.weights.is_some() && self.poses.is_none() {
            self.poses = Some(pose_search(pair)?);
            self.compare_rows(ROWS_AT_ONCE);
        }
        let MatchRequest { window, leave, enter, .. } = wanted;
        let (frames_a, frames_b) = (pair.a.clip().frames(), pair.incoming.clip().frames());
        if self.is_searching() {
            return Ok(Place {
                leave: leave.unwrap_or(
                    (frames_a * 3 / 4)
                        .max(pair.a.behind_seams())
                        .min(frames_a.saturating_sub(window)),
                ),
                enter: enter.unwrap_or(0),
                distance_cm: f32::NAN,
                search: None,
                is_guess: leave.is_none() || enter.is_none(),
            });
        }
        if let Some((_, place)) = self.found.iter().find(|(asked, _)| *asked == wanted) {
            return Ok(*place);
        }
        let mut options = open_search(pair, window);
        if let Some(frame) = leave {
            options = options.leaving_at(frame, frames_a);
        }
        if let Some(frame) = enter {
            options = options.entering_at(frame, frames_b);
        }
        let (leave, enter, distance_cm, is_widened) =
            match (wanted.weights, &self.poses, &self.search) {
                (Some(weights), Some(search), _) => {
                    let best = search.best(weights, &options)?;
                    (best.leave, best.enter, best.position_cm, best.grown)
                }
                (_, _, Some(search)) => {
                    let best = search.best(&options)?;
                    (best.leave, best.enter, best.rms_cm, best.grown)
                }
                _ => return Err(LabError::NothingToMatch),
            };
        let latest =
            |frames: usize| frames.saturating_sub(wanted.behind) as f64 / pair.a.clip().fps();
        let place = Place {
            leave,
            enter,
            distance_cm: distance_cm as f32,
            search: Some(MatchSearch {
                by_pose: wanted.weights.is_some(),
                window_frames: options.window,
                is_shortened: options.window < window,
                is_widened,
                latest_secs: [latest(frames_a), latest(frames_b)],
            }),
            is_guess: false,
        };
        self.found.truncate(MAX_PANES - 1);
        self.found.push_front((wanted, place));
        Ok(place)
    }

    /// Returns whether the distances between the clips' frames are being computed.
    fn is_searching(&self) -> bool {
        self.search.is_some() && self.progress < 1.0
    }
}

impl Sliced for BlendCache {
    fn clear_requests(&mut self) {
        self.is_ready = false;
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        let searching = self.is_searching();
        if searching {
            self.compare_rows(ROWS_PER_SLICE);
            self.is_ready = !self.is_searching();
        }
        searching
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        self.is_searching().then_some((JobKind::Matching, f64::from(self.progress)))
    }
}

impl LabInputs for BlendInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let Self { pair, place, options, mistake, foot_lock } = self;
        let (from, to) = (&*pair.a, &*pair.incoming);
        let made = match *mistake {
            Some(mistake) => {
                concatenate_mistaken(from, place.leave, to, place.enter, options, mistake)
            }
            None => concatenate(from, place.leave, to, place.enter, options),
        };
        let mut made = made?;
        let fps = made.clip.fps();
        let secs = |frame: usize| frame as f64 / fps;
        let window = made.transition.clone();
        let transition = Transition {
            start_secs: secs(window.start),
            end_secs: secs(window.end.max(window.start)),
            leave_a_secs: secs(place.leave),
            enter_b_secs: secs(place.enter),
            window_frames: window.len(),
            distance_cm: place.distance_cm,
            search: place.search,
        };
        let contacts = Contacts::joined(
            pair.a.contacts(),
            pair.incoming.contacts(),
            place.leave,
            place.enter,
            made.handover,
        );
        let name = format!("{} to {}", pair.a.clip().name(), pair.b.clip().name());
        let roles = pair.a.roles().clone();
        let free = Arc::new(Arc::unwrap_or_clone(made.clip).with_name(name));
        made.clip = with_feet(&free, &roles, &contacts, pair.ground_m(), *foot_lock)?;
        let motion =
            Motion::with_ground_frames(Arc::clone(&made.clip), &roles, made.frames.clone())
                .with_feet(pair.a.feet())
                .with_contacts(contacts)
                .with_ground_m(pair.ground_m())
                .with_seams(pair.a.seams_joined(&window, &pair.incoming, place.enter));
        let slid = |clip: &Clip| worst_foot_slide(clip, motion.roles(), motion.contacts());
        let fps = motion.clip().fps();
        let mut metrics = vec![slide(slid(motion.clip()), fps)];
        if foot_lock.is_some() {
            metrics.push(slide_before(slid(&free)));
        }
        let at_seam = TransitionMetrics::measure(from, to, &made);
        let at = |id, value: Option<f64>, frame| Metric::at_frame(id, value, frame, fps);
        // The frame in which the velocity is that of B.
        let arrival = at_seam.lag_s.map(|lag_s| window.start + (lag_s * fps).round() as usize);
        metrics.extend([
            at(MetricId::PositionJump, at_seam.jump_cm, at_seam.jump_at),
            at(MetricId::Penetration, at_seam.penetration_cm, at_seam.penetration_at),
            at(MetricId::Lag, at_seam.lag_s, arrival),
        ]);
        let sources = vec![
            PlacedClip::new(Slot::A, &pair.a, 0.0, Planar::IDENTITY),
            PlacedClip::new(
                Slot::B,
                &pair.incoming,
                secs(place.leave) - secs(place.enter),
                made.world_from_b,
            ),
        ];
        Ok(Outcome {
            sources,
            transition: Some(transition),
            retargeted: pair.retargeted.clone(),
            metrics,
            beside: pair.clips(),
            ..Outcome::plain(Arc::new(motion))
        })
    }

    /// Returns whether the best match is being searched for.
    fn is_draft(&self) -> bool {
        self.place.is_guess
    }
}

#[cfg(test)]
mod tests;
