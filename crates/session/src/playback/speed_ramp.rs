//! Gaits that change their speed gradually.

use crate::labs::{CycleMade, Inputs, Outcome, SpeedInputs};
use segue_motion::gait::SpeedOptions;
use segue_motion::math::spring;
use std::mem::discriminant;
use std::sync::Arc;

/// A gait that approaches the requested speed. The speed is a critically damped spring, as that of
/// a [`SpeedPlayer`](segue_motion::gait::SpeedPlayer).
#[derive(Clone, Debug)]
pub(crate) struct SpeedRamp {
    speed_mps: f64,
    acceleration: f64,
    /// The gait at the present speed.
    pub(crate) outcome: Arc<Outcome>,
}

/// Differences of speed, metres per second, and accelerations, metres per second squared, below
/// which a speed change counts as finished.
const FINISHED_BELOW: [f64; 2] = [0.01, 0.05];

impl SpeedRamp {
    /// Returns a ramp that is at its end: a result at its own speed.
    pub(super) fn at_speed_of(outcome: &Arc<Outcome>) -> Self {
        Self { speed_mps: speed_of(outcome), acceleration: 0.0, outcome: Arc::clone(outcome) }
    }

    /// Advances the gait towards the speed of `target`, which was made from `inputs`. Returns
    /// `None` if it has that speed, or cannot be made.
    pub(super) fn advance(
        mut self,
        target: &Outcome,
        inputs: Option<&Inputs>,
        dt_secs: f64,
    ) -> Option<Self> {
        let target = speed_of(target);
        let half_life_secs = SpeedOptions::default().half_life_secs;
        let (speed, acceleration) =
            spring::towards(self.speed_mps, self.acceleration, target, half_life_secs, dt_secs);
        if (speed - target).abs() < FINISHED_BELOW[0] && acceleration.abs() < FINISHED_BELOW[1] {
            return None;
        }
        self.outcome = Arc::new(gait_inputs(inputs)?.run_at(speed).ok()?);
        (self.speed_mps, self.acceleration) = (speed, acceleration);
        Some(self)
    }
}

/// Returns the durations of two cycles, seconds, if one can continue where the other is: both are
/// cycles, and of the same kind.
pub(crate) fn cycle_durations(old: &Outcome, new: &Outcome) -> Option<[f64; 2]> {
    let (old, new) = (old.cycle?, new.cycle?);
    let kind = |made: &CycleMade| discriminant(made);
    (kind(&old.made) == kind(&new.made) && old.secs > 0.0).then_some([old.secs, new.secs])
}

/// Returns whether two results are gaits that differ in their speed alone.
pub(super) fn differ_in_speed_alone(old: Option<&Inputs>, new: Option<&Inputs>) -> bool {
    gait_inputs(old).zip(gait_inputs(new)).is_some_and(|(old, new)| old.differs_in_speed_alone(new))
}

/// Returns the inputs of a gait; `None` for those of other results.
fn gait_inputs(inputs: Option<&Inputs>) -> Option<&SpeedInputs> {
    inputs?.of_lab()
}

/// Returns the speed of a gait, metres per second; 0 for other results.
fn speed_of(outcome: &Outcome) -> f64 {
    match outcome.cycle.map(|cycle| cycle.made) {
        Some(CycleMade::Gait { facts, .. }) => facts.speed_mps,
        _ => 0.0,
    }
}
