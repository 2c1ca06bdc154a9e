//! Playback of a gait at a variable speed.

use super::{GaitClip, GaitError, GaitFacts, SpeedBlend};
use crate::math::{Planar, spring};
use crate::skeleton::Pose;

/// A gait that plays while its speed changes.
///
/// The phase is continuous at any change of speed, and the speed follows the requested one as a
/// critically damped spring, so that a walk becomes a run without a jump. The player holds no
/// clips: every call is given the blend, which may be replaced between calls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedPlayer {
    speed_mps: f64,
    acceleration: f64,
    phase: f64,
    here: Planar,
}

impl SpeedPlayer {
    /// Returns a player at the strike of the left foot, at the origin, facing +Z.
    #[must_use]
    pub fn new(blend: &SpeedBlend, speed_mps: f64) -> Self {
        Self {
            speed_mps: blend.facts(speed_mps).speed_mps,
            acceleration: 0.0,
            phase: 0.0,
            here: Planar::IDENTITY,
        }
    }

    /// Advances by `dt_secs` towards a speed and returns the pose. A step that is negative or not
    /// finite counts as 0.
    pub fn advance(&mut self, blend: &SpeedBlend, dt_secs: f64, speed_mps: f64) -> Pose {
        self.go(blend, dt_secs, speed_mps);
        self.pose(blend)
    }

    pub(super) fn go(&mut self, blend: &SpeedBlend, dt_secs: f64, speed_mps: f64) {
        // The comparison is also false for NaN.
        let dt_secs = if dt_secs > 0.0 { dt_secs.min(1.0) } else { 0.0 };
        let wanted = blend.facts(speed_mps).speed_mps;
        let half_life = blend.options().half_life_secs;
        (self.speed_mps, self.acceleration) =
            spring::towards(self.speed_mps, self.acceleration, wanted, half_life, dt_secs);
        let facts = self.facts(blend);
        let before = self.phase;
        self.phase += dt_secs / facts.cycle_secs;
        self.here = self.here.after(&blend.step(facts.weight, before, self.phase));
    }

    /// Returns the current pose.
    #[must_use]
    pub fn pose(&self, blend: &SpeedBlend) -> Pose {
        blend.pose(self.facts(blend).weight, self.phase, &self.here)
    }

    /// Returns the facts of the current speed.
    #[must_use]
    pub fn facts(&self, blend: &SpeedBlend) -> GaitFacts {
        blend.facts(self.speed_mps)
    }

    /// Returns the number of cycles since the beginning; whole numbers are strikes of the left
    /// foot.
    #[must_use]
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Returns the ground frame of the character (`world_from_character`).
    #[must_use]
    pub fn here(&self) -> &Planar {
        &self.here
    }

    /// Returns which feet are planted: left, right.
    #[must_use]
    pub fn planted(&self, blend: &SpeedBlend) -> [bool; 2] {
        blend.planted(self.facts(blend).weight, self.phase)
    }
}

impl SpeedBlend {
    /// Returns a motion of variable speed: `speed_mps` returns the requested speed at a time
    /// (seconds), and the motion follows it as a [`SpeedPlayer`] does.
    ///
    /// # Errors
    /// [`GaitError::Option`] when `secs` is not between 0 and 600.
    pub fn clip_along(
        &self,
        secs: f64,
        speed_mps: impl Fn(f64) -> f64,
    ) -> Result<GaitClip, GaitError> {
        let (steps, fps) = (self.steps_in(secs)?, self.fps());
        let mut player = SpeedPlayer::new(self, speed_mps(0.0));
        let mut phases = vec![(player.facts(self).weight, player.phase())];
        for step in 1..=steps {
            player.go(self, fps.recip(), speed_mps(step as f64 / fps));
            phases.push((player.facts(self).weight, player.phase()));
        }
        self.made(player.facts(self), phases.into_iter())
    }
}
