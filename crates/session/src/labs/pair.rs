//! Two clips on one skeleton and at one frame rate.

use super::RetargetReport;
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::params::{Key, Params};
use segue_motion::clip::{Clip, Interpolation, Motion, resample};
use segue_motion::retarget::{MotionRetargeting, RetargetOptions, RetargetedMotion, TargetBody};
use segue_motion::skeleton::Retargeting;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Clips of up to this number of frames are retargeted at once.
const AT_ONCE: usize = 400;
/// The number of frames in one slice of work, in one of several passes: about a millisecond in a
/// browser.
pub(super) const FRAMES_PER_SLICE: usize = 250;

/// The frame rate of a clip on the skeleton of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rate {
    /// That of the other clip.
    OfA,
    /// Its own.
    Own,
}

/// The options by which B is put on A's skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FittingOptions {
    pub(super) rate: Rate,
    pub(super) retarget: RetargetOptions,
}

impl FittingOptions {
    /// Returns the options by which B gets the rate of A, too.
    pub(super) const fn at_rate_of_a(retarget: RetargetOptions) -> Self {
        Self { rate: Rate::OfA, retarget }
    }
}

/// Two clips on one skeleton and at one frame rate.
#[derive(Debug)]
pub(crate) struct Pair {
    pub(super) a: Arc<Motion>,
    pub(super) b: Arc<Motion>,
    /// B on the skeleton and at the frame rate of A.
    pub(super) incoming: Arc<Motion>,
    /// The retargeting of B; `None` if its skeleton is A's.
    pub(super) retargeted: Option<Arc<RetargetReport>>,
    options: FittingOptions,
}

impl Pair {
    /// Returns the height of the ground under both clips, metres: the lower one, so that no foot is
    /// lifted off the ground of its own clip.
    pub(super) fn ground_m(&self) -> f32 {
        self.a.ground_m().min(self.incoming.ground_m())
    }

    /// Returns both clips on the skeleton of A.
    pub(super) fn clips(&self) -> Vec<Arc<Clip>> {
        [&self.a, &self.incoming].map(|motion| Arc::clone(motion.clip())).into()
    }

    /// Returns whether it is the pair of these clips. Clips of one skeleton need no options.
    fn is_of(&self, a: &Arc<Motion>, b: &Arc<Motion>, options: FittingOptions) -> bool {
        Arc::ptr_eq(&self.a, a)
            && Arc::ptr_eq(&self.b, b)
            && self.options.rate == options.rate
            && (self.options == options || self.retargeted.is_none())
    }
}

/// Returns the options of retargeting that the parameters say.
pub(super) fn retarget_options(params: &Params) -> RetargetOptions {
    let both = |left: Key, right: Key| {
        let left = params.number(left);
        [left, params.optional(right).unwrap_or(left)].map(|weight| weight as f32)
    };
    RetargetOptions {
        feet: both(Key::RetargetFeet, Key::RetargetRightFoot),
        hands: both(Key::RetargetHands, Key::RetargetRightHand),
    }
}

/// B on the skeleton and at the frame rate of A, and the report on retargeting if it was needed.
pub(super) type FittedClip = (Arc<Motion>, Option<Arc<RetargetReport>>);

/// The fitting of B to the skeleton and the frame rate of A, in slices.
#[derive(Debug)]
pub(super) struct Fitting {
    a: Arc<Motion>,
    b: Arc<Motion>,
    options: FittingOptions,
    /// B at the frame rate of the result.
    source: Arc<Motion>,
    work: MotionRetargeting,
}

impl Fitting {
    /// Begins to fit B to A. Returns the result at once if both have one skeleton.
    ///
    /// Feet that are planted at the rate of A stay so: a clip is resampled before it is retargeted.
    pub(super) fn new(
        a: &Arc<Motion>,
        b: &Arc<Motion>,
        options: FittingOptions,
    ) -> Result<ControlFlow<FittedClip, Self>, LabError> {
        let same_skeleton = Arc::ptr_eq(a.clip().skeleton(), b.clip().skeleton())
            || a.clip().skeleton() == b.clip().skeleton();
        let rate_b = b.clip().fps();
        let rate = match options.rate {
            Rate::OfA => a.clip().fps(),
            Rate::Own => rate_b,
        };
        let same_rate = (rate - rate_b).abs() <= 1e-4 * rate;
        if same_skeleton {
            if same_rate {
                return Ok(ControlFlow::Break((Arc::clone(b), None)));
            }
            let clip = Arc::new(resample(b.clip(), rate, Interpolation::Cubic)?);
            let motion = Motion::with_roles(clip, b.roles())
                .with_feet(b.feet())
                .with_contact_corrections(b.contact_corrections().at_rate(rate / rate_b));
            return Ok(ControlFlow::Break((Arc::new(like(b, rate, motion)), None)));
        }
        let mut source = Arc::clone(b);
        if !same_rate {
            let ground_m = b.ground_m();
            source = Arc::new(b.resampled(rate, Interpolation::Cubic)?.with_ground_m(ground_m));
        }
        let body = TargetBody::of(a);
        let work = MotionRetargeting::new(Arc::clone(&source), body, options.retarget)?;
        let (a, b) = (Arc::clone(a), Arc::clone(b));
        Ok(ControlFlow::Continue(Self { a, b, options, source, work }))
    }

    /// Does one slice of up to `frames` frames.
    pub(super) fn advance(self, frames: usize) -> Result<ControlFlow<FittedClip, Self>, LabError> {
        let Self { a, b, options, source, work } = self;
        let RetargetedMotion { clip, report, is_same_rig } = match work.advance(frames)? {
            ControlFlow::Continue(work) => {
                return Ok(ControlFlow::Continue(Self { a, b, options, source, work }));
            }
            ControlFlow::Break(made) => made,
        };
        // A foot of the result is held where the source's is planted.
        let motion = Motion::with_roles(clip, a.roles())
            .with_feet(b.feet())
            .with_contacts(source.contacts().clone());
        let motion = like(&b, source.clip().fps(), motion);
        let (unmatched, options) = (unmatched(&a, &b), options.retarget);
        let errors = Some(report).filter(|_| !is_same_rig);
        let report = RetargetReport { unmatched, errors, options };
        Ok(ControlFlow::Break((Arc::new(motion), Some(Arc::new(report)))))
    }

    /// Returns the progress, 0 to 1.
    pub(super) fn progress(&self) -> f32 {
        self.work.progress()
    }
}

/// Returns a motion that is B at another rate, with B's seams.
fn like(b: &Motion, rate: f64, motion: Motion) -> Motion {
    let rate_b = b.clip().fps();
    let seams = b.seams_at(|frame| (frame as f64 * rate / rate_b).round() as usize);
    motion.with_seams(seams).declared_cycle(b.is_cycle())
}

/// Returns the names of the joints of A's skeleton that B does not move.
fn unmatched(a: &Motion, b: &Motion) -> Vec<String> {
    let skeleton = a.clip().skeleton();
    let way = Retargeting::new(b.clip().skeleton(), b.roles(), skeleton, a.roles());
    let joints = skeleton.joints().iter().enumerate();
    let unmoved = joints.filter(|(joint, _)| way.as_ref().is_none_or(|way| !way.moves(*joint)));
    unmoved.map(|(_, joint)| joint.name.clone()).collect()
}

/// A cache of pairs, which labs and panes share. Those that no pane asks for any more are dropped.
#[derive(Debug, Default)]
pub(crate) struct Pairs {
    cache: RequestCache<PairOf, Fitting, Result<Arc<Pair>, LabError>>,
}

/// The parts of a pair: A, B and how B is fitted to A.
type PairOf = (Arc<Motion>, Arc<Motion>, FittingOptions);

impl Pairs {
    /// Returns the pair of a lab's slots, as [`of`](Self::of) does.
    pub(crate) fn of_slots(
        &mut self,
        slots: &[Arc<Motion>],
        params: &Params,
    ) -> Result<Option<Arc<Pair>>, LabError> {
        match slots {
            [a, b] => self.of(a, b, params),
            _ => Err(LabError::NoPair),
        }
    }

    /// Returns B on the skeleton and at the rate of A; `None` if that takes longer than a frame:
    /// call [`work`](Self::work), then ask again.
    pub(crate) fn of(
        &mut self,
        a: &Arc<Motion>,
        b: &Arc<Motion>,
        params: &Params,
    ) -> Result<Option<Arc<Pair>>, LabError> {
        self.fitted(a, b, FittingOptions::at_rate_of_a(retarget_options(params)))
    }

    /// Returns B on the skeleton of A and at its own rate; `None` as for [`of`](Self::of).
    pub(crate) fn on_body(
        &mut self,
        a: &Arc<Motion>,
        b: &Arc<Motion>,
        params: &Params,
    ) -> Result<Option<Arc<Pair>>, LabError> {
        let retarget = retarget_options(params);
        self.fitted(a, b, FittingOptions { rate: Rate::Own, retarget })
    }

    fn fitted(
        &mut self,
        a: &Arc<Motion>,
        b: &Arc<Motion>,
        options: FittingOptions,
    ) -> Result<Option<Arc<Pair>>, LabError> {
        let is_it = |(known_a, known_b, by): &PairOf| {
            Arc::ptr_eq(known_a, a) && Arc::ptr_eq(known_b, b) && *by == options
        };
        let alike =
            self.cache.request(|_, pair| pair.as_ref().is_ok_and(|pair| pair.is_of(a, b, options)));
        if let Some(pair) = alike {
            return pair.clone().map(Some);
        }
        self.cache.request_or_begin((Arc::clone(a), Arc::clone(b), options), is_it, |of| {
            let mut next = Fitting::new(a, b, options)?;
            loop {
                next = match next {
                    ControlFlow::Continue(fitting) if fitting.source.clip().frames() <= AT_ONCE => {
                        fitting.advance(AT_ONCE)?
                    }
                    done_or_long => return Ok(done_or_long.map_break(|made| pair_of(of, made))),
                };
            }
        })
    }
}

fn pair_of((a, b, options): &PairOf, (incoming, retargeted): FittedClip) -> Arc<Pair> {
    let (a, b, options) = (Arc::clone(a), Arc::clone(b), *options);
    Arc::new(Pair { a, b, incoming, retargeted, options })
}

impl Sliced for Pairs {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, _jobs: &mut JobBoard) -> bool {
        self.cache.work(|of, fitting| match fitting.advance(FRAMES_PER_SLICE) {
            Ok(ControlFlow::Continue(fitting)) => ControlFlow::Continue(fitting),
            Ok(ControlFlow::Break(fitted)) => ControlFlow::Break(Ok(pair_of(of, fitted))),
            // It is told when a pane asks for the pair.
            Err(error) => ControlFlow::Break(Err(error)),
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        Some((JobKind::Retargeting, f64::from(self.cache.under_way().next()?.1.progress())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::clip::Clip;
    use segue_motion::math::quat;
    use segue_motion::synth::{Action, Params, synthesize};

    /// The largest change of a joint's angular velocity from one frame to the next, radians per
    /// second.
    fn largest_velocity_change(clip: &Clip) -> f32 {
        let step = |frame: usize, joint: usize| {
            let (from, to) = (clip.rotations(frame)[joint], clip.rotations(frame + 1)[joint]);
            quat::angular_velocity(from, to, clip.fps().recip() as f32)
        };
        let inner = 8..clip.frames() - 10;
        let changes = inner.flat_map(|frame| {
            (0..clip.skeleton().len())
                .map(move |joint| (step(frame + 1, joint) - step(frame, joint)).length())
        });
        changes.fold(0.0, f32::max)
    }

    /// Checks that the velocity changes evenly between the frames of a slower clip, not in a step
    /// at each of them.
    #[test]
    fn slower_incoming_clip_is_resampled_without_velocity_steps() {
        let at = |fps: f32| {
            let params = Params { fps, ..Params::new(Action::Walk) };
            Arc::new(Motion::analyze(synthesize(&params).unwrap().clip))
        };
        let (a, b) = (at(120.0), at(30.0));
        let options = FittingOptions::at_rate_of_a(RetargetOptions::default());
        let fitted = Fitting::new(&a, &b, options).unwrap();
        let (incoming, _) = fitted.break_value().unwrap();
        assert_eq!(incoming.clip().fps(), 120.0);
        let (made, true_one) =
            (largest_velocity_change(incoming.clip()), largest_velocity_change(a.clip()));
        let linear =
            largest_velocity_change(&resample(b.clip(), 120.0, Interpolation::Linear).unwrap());
        assert!(made < 0.6 * linear, "{made} rad/s per frame, linearly {linear}, truly {true_one}");
    }
}
