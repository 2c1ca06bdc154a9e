//! Two clips on one skeleton and at one frame rate.

use super::RetargetReport;
use crate::labs::LabError;
use segue_motion::clip::{Clip, Interpolation, Motion, resample, retarget_onto};
use segue_motion::skeleton::Retargeting;
use std::sync::Arc;

/// Two clips on one skeleton and at one frame rate.
#[derive(Debug)]
pub(crate) struct Pair {
    pub(super) a: Arc<Motion>,
    pub(super) b: Arc<Motion>,
    /// B on the skeleton and at the frame rate of A.
    pub(super) incoming: Arc<Motion>,
    /// The retargeting of B; `None` if its skeleton is A's.
    pub(super) retargeted: Option<Arc<RetargetReport>>,
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

    fn new(a: &Arc<Motion>, b: &Arc<Motion>) -> Result<Self, LabError> {
        let (incoming, retargeted) = fitted(a, b)?;
        Ok(Self { a: Arc::clone(a), b: Arc::clone(b), incoming, retargeted })
    }
}

/// Returns B on the skeleton and at the frame rate of A, and the report on retargeting if it was
/// needed.
pub(super) fn fitted(
    a: &Arc<Motion>,
    b: &Arc<Motion>,
) -> Result<(Arc<Motion>, Option<Arc<RetargetReport>>), LabError> {
    let same_skeleton = Arc::ptr_eq(a.clip().skeleton(), b.clip().skeleton())
        || a.clip().skeleton() == b.clip().skeleton();
    let same_rate = (a.clip().fps() - b.clip().fps()).abs() <= 1e-4 * a.clip().fps();
    if same_skeleton && same_rate {
        return Ok((Arc::clone(b), None));
    }
    let mut clip = Arc::clone(b.clip());
    if !same_skeleton {
        clip = Arc::new(retarget_onto(&clip, b.roles(), a.clip(), a.roles())?);
    }
    if !same_rate {
        clip = Arc::new(resample(&clip, a.clip().fps(), Interpolation::Cubic)?);
    }
    let roles = if same_skeleton { b.roles().clone() } else { a.roles().clone() };
    let retargeted = (!same_skeleton).then(|| Arc::new(RetargetReport::between(a, b)));
    let (rate, rate_b) = (a.clip().fps(), b.clip().fps());
    let seams = b.seams_at(|frame| (frame as f64 * rate / rate_b).round() as usize);
    let motion = Motion::with_roles(clip, &roles)
        .with_feet(b.feet())
        .with_contact_corrections(b.contact_corrections().at_rate(rate / rate_b))
        .with_seams(seams)
        .declared_cycle(b.is_cycle());
    Ok((Arc::new(motion), retargeted))
}

impl RetargetReport {
    /// Compares the skeletons of `a` and `b`.
    fn between(a: &Motion, b: &Motion) -> Self {
        let skeleton = a.clip().skeleton();
        let way = Retargeting::new(b.clip().skeleton(), b.roles(), skeleton, a.roles());
        let joints = skeleton.joints().iter().enumerate();
        let unmoved = joints.filter(|(joint, _)| way.as_ref().is_none_or(|way| !way.moves(*joint)));
        Self { unmatched: unmoved.map(|(_, joint)| joint.name.clone()).collect() }
    }
}

/// A cache of the last pair, which labs and panes share.
#[derive(Debug, Default)]
pub(crate) struct Pairs(Option<Arc<Pair>>);

impl Pairs {
    /// Returns the pair of a lab's slots, as [`of`](Self::of) does.
    pub(crate) fn of_slots(&mut self, slots: &[Arc<Motion>]) -> Result<Arc<Pair>, LabError> {
        match slots {
            [a, b] => self.of(a, b),
            _ => Err(LabError::NoPair),
        }
    }

    /// Returns B on the skeleton and at the rate of A.
    pub(crate) fn of(&mut self, a: &Arc<Motion>, b: &Arc<Motion>) -> Result<Arc<Pair>, LabError> {
        if let Some(pair) = &self.0
            && Arc::ptr_eq(&pair.a, a)
            && Arc::ptr_eq(&pair.b, b)
        {
            return Ok(Arc::clone(pair));
        }
        let pair = Arc::new(Pair::new(a, b)?);
        self.0 = Some(Arc::clone(&pair));
        Ok(pair)
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
        let (incoming, _) = fitted(&a, &b).unwrap();
        assert_eq!(incoming.clip().fps(), 120.0);
        let (made, true_one) =
            (largest_velocity_change(incoming.clip()), largest_velocity_change(a.clip()));
        let linear =
            largest_velocity_change(&resample(b.clip(), 120.0, Interpolation::Linear).unwrap());
        assert!(made < 0.6 * linear, "{made} rad/s per frame, linearly {linear}, truly {true_one}");
    }
}
