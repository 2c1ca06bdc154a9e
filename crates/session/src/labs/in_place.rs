//! The In place lab: the root motion of a clip is removed, or rebuilt from its planted feet.

use super::feet::{Lock, slide, with_feet};
use super::lab::{Inputs, Lab, LabClips, LabInputs};
use super::{MeasuredMotion, Outcome};
use crate::choices::RootWay;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::clip::{Clip, Motion, root_motion_from_feet, take_in_place};
use segue_motion::math::Planar;
use segue_motion::metrics::worst_foot_slide;
use segue_text::{Message, msg};
use std::sync::Arc;

/// The In place lab: one clip without root motion, or with a rebuilt one.
pub(super) struct InPlaceLab;

impl<S> Lab<S> for InPlaceLab {
    fn result_name(&self, params: &Params, a: Message, _b: Message) -> Message {
        match params.choice() {
            RootWay::TakeOut => msg!("{a}, in place", a),
            RootWay::PutBack => msg!("{a}, root motion rebuilt", a),
        }
    }

    fn file_stem(&self, params: &Params) -> String {
        match params.choice() {
            RootWay::TakeOut => format!("{} in place", params.text(Key::A)),
            RootWay::PutBack => format!("{} with root motion", params.text(Key::A)),
        }
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk")
    }

    fn inputs(
        &self,
        _labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        Ok(Some(Inputs::new(InPlaceInputs {
            motion: Arc::clone(clips.first()?),
            way: params.choice(),
            turns: params.is_on(Key::RootWayTurn),
            foot_lock: Lock::of(params),
        })))
    }
}

/// The inputs of the result. Equal inputs give equal results.
#[derive(Clone, Debug)]
struct InPlaceInputs {
    motion: Arc<Motion>,
    way: RootWay,
    turns: bool,
    foot_lock: Option<Lock>,
}

impl PartialEq for InPlaceInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.motion, &other.motion)
            && self.way == other.way
            && self.turns == other.turns
            && self.foot_lock == other.foot_lock
    }
}

impl LabInputs for InPlaceInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let source = &self.motion;
        let (moves, contacts) = match self.way {
            RootWay::TakeOut => {
                (take_in_place(source.ground_frames(), self.turns), source.contacts().clone())
            }
            RootWay::PutBack => {
                let options = &source.feet().contacts;
                let found = root_motion_from_feet(
                    source.clip(),
                    source.roles(),
                    options,
                    source.contact_corrections(),
                    self.turns,
                )?;
                (found.world_from_clip, found.contacts)
            }
        };
        let ground_frames: Vec<Planar> =
            moves.iter().zip(source.ground_frames()).map(|(at, frame)| at.after(frame)).collect();
        let moved = |clip: &Clip| Arc::new(clip.transformed_by_frame(&moves));
        let lock =
            |clip| with_feet(clip, source.roles(), &contacts, source.ground_m(), self.foot_lock);
        // The feet are planted while the body travels: in the source, or in the result.
        let (going, standing, frames) = match self.way {
            RootWay::TakeOut => {
                let going = lock(source.clip())?;
                (Arc::clone(&going), moved(&going), source.ground_frames())
            }
            RootWay::PutBack => {
                (lock(&moved(source.clip()))?, Arc::clone(source.clip()), ground_frames.as_slice())
            }
        };
        let clip = Arc::clone(if self.way == RootWay::TakeOut { &standing } else { &going });
        let slid = |clip| worst_foot_slide(clip, source.roles(), &contacts);
        let fps = source.clip().fps();
        let mut metrics = travel_metrics(frames, fps).to_vec();
        metrics.push(slide(slid(&going), fps));
        metrics.push(Metric::extreme(MetricId::FootSlideInPlace, slid(&standing), fps));
        Ok(Outcome {
            metrics,
            beside: vec![Arc::clone(source.clip())],
            measured: MeasuredMotion::Clip(going),
            ..Outcome::plain(Arc::new(
                source.with_clip(clip, ground_frames).with_contacts(contacts),
            ))
        })
    }
}

/// Returns metrics of the travel of a body: distance, speed and turn.
fn travel_metrics(frames: &[Planar], fps: f64) -> [Metric; 3] {
    let steps = || frames.windows(2).map(|pair| pair[0].inverse().after(&pair[1]));
    let travel_m: f64 = steps().map(|step| step.shift.length()).sum();
    let secs = frames.len().saturating_sub(1).max(1) as f64 / fps;
    [
        Metric::new(MetricId::Distance, travel_m),
        Metric::new(MetricId::MeanSpeed, travel_m / secs),
        Metric::new(MetricId::TotalTurn, steps().map(|step| step.yaw).sum::<f64>().to_degrees()),
    ]
}

#[cfg(test)]
mod tests {
    use crate::fixtures::opened;
    use crate::metrics::MetricId;
    use crate::{Command, Session};

    fn number(session: &Session, id: MetricId) -> f64 {
        let outcome = session.main_outcome().expect("a result");
        outcome.metric(id).expect("a number").value.expect("a value")
    }

    /// Returns the distance between the first and the last position on the ground, metres.
    fn travel_m(session: &Session) -> f64 {
        let frames = session.main_outcome().expect("a result").motion.ground_frames();
        frames[0].shift.distance(frames[frames.len() - 1].shift)
    }

    #[test]
    fn root_motion_that_was_removed_is_rebuilt_from_the_feet() {
        let walk = opened("lab=view&a=walk");
        let mut session = opened("lab=in_place&a=walk");
        assert!(travel_m(&session) < 1e-3, "{} m", travel_m(&session));
        assert!((number(&session, MetricId::Distance) - travel_m(&walk)).abs() < 0.2);
        assert!(number(&session, MetricId::FootSlideInPlace) > 40.0);
        session.apply(Command::Keep(0)).expect("kept");

        let back = opened("lab=in_place&a=in_place(a:walk)&root_way=put_back");
        let (wanted, found) = (travel_m(&walk), travel_m(&back));
        assert!((found - wanted).abs() < 0.02 * wanted, "{found} m of {wanted} m");
        assert!(number(&back, MetricId::FootSlide) < 2.0, "{}", number(&back, MetricId::FootSlide));
        assert!(number(&back, MetricId::FootSlideInPlace) > 40.0);
    }

    #[test]
    fn turn_that_is_not_removed_stays() {
        let yaws = |link: &str| {
            let session = opened(link);
            let frames = session.main_outcome().expect("a result").motion.ground_frames();
            [frames[0].yaw, frames[frames.len() - 1].yaw]
        };
        let walk = yaws("lab=view&a=walk_left");
        let kept = yaws("lab=in_place&a=walk_left&root_way_turn=off");
        let taken = yaws("lab=in_place&a=walk_left");
        assert!((0..2).all(|end| (kept[end] - walk[end]).abs() < 1e-3), "{kept:?} {walk:?}");
        assert!(taken.iter().all(|yaw| yaw.abs() < 1e-3), "{taken:?}");
    }

    #[test]
    fn both_changes_of_root_motion_are_compared() {
        let session = opened("lab=in_place&a=walk&compare=root_way:take_out,put_back");
        assert!(session.panes().len() == 2 && session.panes().iter().all(|p| p.problem.is_none()));
    }
}
