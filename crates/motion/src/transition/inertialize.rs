//! Inertialization and dead blending, frame by frame.

use super::MovingPose;
use super::moving::{travel, with_travel};
use crate::blend::{BlendError, MAX_SECS};
use crate::math::{Decay, Planar, quat, spring};
use glam::{Quat, Vec3};

/// The decay of the difference between the previous motion and the current one.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Inertialization {
    /// The offset decays into the new motion (Bollo 2018; springs: Holden 2021).
    Offset(Decay),
    /// The old pose is extrapolated with decaying velocity, and a smooth weight fades to the new
    /// motion (Holden, "Dead Blending", 2023). Safer for very different poses; damps more.
    DeadBlend {
        /// Duration of the fade, seconds.
        blend_secs: f64,
        /// Half-life of the old pose's velocity, seconds.
        extrapolation_half_life_secs: f64,
    },
}

impl Inertialization {
    /// Checks the durations.
    ///
    /// # Errors
    /// [`BlendError::Time`] with the first one that is not from 0 to 60 s.
    pub fn validate(self) -> Result<(), BlendError> {
        let times = match self {
            Self::Offset(Decay::Spring { half_life_secs }) => {
                [("half-life", half_life_secs), ("half-life", half_life_secs)]
            }
            Self::Offset(Decay::Cubic { blend_secs } | Decay::Quintic { blend_secs }) => {
                [("blend time", blend_secs), ("blend time", blend_secs)]
            }
            Self::DeadBlend { blend_secs, extrapolation_half_life_secs } => {
                [("blend time", blend_secs), ("half-life", extrapolation_half_life_secs)]
            }
        };
        match times.into_iter().find(|(_, secs)| !(0.0..=MAX_SECS).contains(secs)) {
            Some((what, secs)) => Err(BlendError::Time { what, secs }),
            None => Ok(()),
        }
    }

    /// Returns the share of an offset at rest that is left after `secs`.
    #[must_use]
    pub fn remaining(self, secs: f64) -> f64 {
        match self {
            Self::Offset(decay) => decay.response(0.0, secs).xx,
            Self::DeadBlend { blend_secs, .. } => fade(blend_secs, secs).0,
        }
    }

    /// Returns the same decay with its durations multiplied by `times`, except for the half-life of
    /// an extrapolated velocity.
    #[must_use]
    fn stretched(self, times: f64) -> Self {
        match self {
            Self::Offset(Decay::Spring { half_life_secs }) => {
                Self::Offset(Decay::Spring { half_life_secs: half_life_secs * times })
            }
            Self::Offset(Decay::Cubic { blend_secs }) => {
                Self::Offset(Decay::Cubic { blend_secs: blend_secs * times })
            }
            Self::Offset(Decay::Quintic { blend_secs }) => {
                Self::Offset(Decay::Quintic { blend_secs: blend_secs * times })
            }
            Self::DeadBlend { blend_secs, extrapolation_half_life_secs } => {
                Self::DeadBlend { blend_secs: blend_secs * times, extrapolation_half_life_secs }
            }
        }
    }

    /// Returns the greatest speed at which an offset of 1 at rest decays, per second: the extremum
    /// of the curve's derivative.
    fn max_rate(self) -> f64 {
        match self {
            Self::Offset(Decay::Spring { half_life_secs }) => {
                spring::rate(half_life_secs) / std::f64::consts::E
            }
            Self::Offset(Decay::Quintic { blend_secs }) => 1.875 / blend_secs,
            Self::Offset(Decay::Cubic { blend_secs }) | Self::DeadBlend { blend_secs, .. } => {
                1.5 / blend_secs
            }
        }
    }

    /// Returns the seconds until only `share` (above 0, below 1) is left.
    #[must_use]
    pub fn secs_until(self, share: f64) -> f64 {
        match self {
            Self::Offset(decay) => decay.secs_until(share),
            Self::DeadBlend { blend_secs, .. } => Decay::Cubic { blend_secs }.secs_until(share),
        }
    }

    /// Returns the seconds until nothing is left that could be seen or measured: the end of a curve
    /// of finite duration; a millionth for a spring.
    #[must_use]
    pub fn settling_secs(self) -> f64 {
        match self {
            Self::Offset(decay @ Decay::Spring { .. }) => decay.secs_until(1e-6),
            Self::Offset(Decay::Cubic { blend_secs } | Decay::Quintic { blend_secs })
            | Self::DeadBlend { blend_secs, .. } => blend_secs,
        }
    }
}

/// The speed that a decaying offset may add, as a share of the speed that a joint usually does not
/// exceed.
const ADDED_SPEED: f32 = 0.75;
/// The greatest factor by which the decay of a joint's offset is slowed down.
const MAX_STRETCH: f32 = 6.0;

/// Returns the fade's weight of the old motion, and its rate of change, per second:
/// [`crate::blend::WeightLaw::Smooth`], which is the cubic's response to an offset without
/// velocity.
fn fade(blend_secs: f64, secs: f64) -> (f64, f64) {
    let response = Decay::Cubic { blend_secs }.response(0.0, secs);
    (response.xx, response.vx)
}

/// The state of inertialization, which adds the decaying difference to the previous motion to the
/// current one, frame by frame.
///
/// Call [`trigger`](Self::trigger) at a jump; then, every frame, [`advance`](Self::advance) the
/// time and [`apply`](Self::apply) the offsets to the new pose. A jump while the offsets of another
/// one are still decaying adds to them: offsets are composed, not replaced, so that the motion
/// stays continuous.
///
/// The offset of a rotation is the rotation vector of `q_old · q_new⁻¹` by the shorter way, applied
/// on the left. Its rate is chosen so that the joint starts with the old angular velocity
/// *exactly*: `J⁻¹ (ω_old - R ω_new)` with J the left Jacobian ([`quat::vector_rate`]) and R the
/// offset. The usual `ω_old - ω_new` is accurate for small offsets only.
#[derive(Clone, Debug)]
pub struct Inertializer {
    how: Inertialization,
    elapsed_secs: f64,
    turns: Vec<Turn>,
    shifts: Vec<Shift>,
    travel: Option<Travel>,
}

#[derive(Clone, Copy, Debug)]
struct Turn {
    offset: Vec3,
    rate: Vec3,
    /// The old rotation and its angular velocity, for extrapolation.
    from: Quat,
    angular_velocity: Vec3,
    /// The difference that was applied last; the next one is taken in its hemisphere, so that it
    /// does not jump to the other way round.
    last: Quat,
    /// The factor by which its decay is slowed down, at least 1.
    stretch: f32,
}

#[derive(Clone, Copy, Debug)]
struct Shift {
    offset: Vec3,
    rate: Vec3,
    from: Vec3,
    velocity: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Travel {
    /// The difference of steady velocities: it decays, and the distance covered meanwhile remains.
    steady: Vec3,
    /// The rest of the difference, a sway: the velocity of an offset that starts at 0 and returns
    /// to it.
    sway: Vec3,
    from: Vec3,
}

impl Inertializer {
    /// Returns an inertializer at rest: it changes nothing until it is triggered.
    #[must_use]
    pub fn new(how: Inertialization) -> Self {
        Self { how, elapsed_secs: 0.0, turns: Vec::new(), shifts: Vec::new(), travel: None }
    }

    /// Returns the seconds since the last jump.
    #[must_use]
    pub fn elapsed_secs(&self) -> f64 {
        self.elapsed_secs
    }

    /// Starts a transition between two motions at a jump: `old` and `new` are their poses and
    /// velocities at this moment, both without inertialization. The rest of an earlier jump's
    /// offsets is included. Joints that one of the two does not have are left out.
    pub fn trigger(&mut self, old: &MovingPose, new: &MovingPose) {
        self.trigger_within(old, new, &[]);
    }

    /// Starts a transition as [`trigger`](Self::trigger) does, with the angular speed that each
    /// joint usually does not exceed, radians per second: the offset of a joint that would decay
    /// faster than three quarters of that takes longer, up to six times as long. An arm that hangs
    /// in one motion and is bent in the other therefore comes up slowly, while the legs are in step
    /// at once.
    pub fn trigger_within(&mut self, old: &MovingPose, new: &MovingPose, usual_radps: &[f32]) {
        let max_rate = self.how.max_rate() as f32;
        let stretch = |joint: usize, offset: Vec3| {
            let usual = usual_radps.get(joint).copied().unwrap_or(f32::INFINITY);
            let times = offset.length() * max_rate / (ADDED_SPEED * usual);
            // A decay without duration is a cut, and stays one.
            if times.is_finite() { times.clamp(1.0, MAX_STRETCH) } else { 1.0 }
        };
        let mut playing = old.clone();
        self.carry(&mut playing);
        let turns = playing.rotations.iter().zip(&playing.angular_velocities);
        let into = new.rotations.iter().zip(&new.angular_velocities);
        self.turns = turns
            .zip(into)
            .enumerate()
            .map(|(joint, ((&from, &angular_velocity), (&to, &new_velocity)))| {
                let difference = quat::with_positive_scalar(from * to.conjugate());
                let offset = quat::log(difference);
                Turn {
                    stretch: stretch(joint, offset),
                    offset,
                    rate: quat::vector_rate(offset, angular_velocity - difference * new_velocity),
                    from,
                    angular_velocity,
                    last: difference,
                }
            })
            .collect();
        let shifts = playing.translations.iter().zip(&playing.velocities);
        let into = new.translations.iter().zip(&new.velocities);
        self.shifts = shifts
            .zip(into)
            .map(|((&from, &velocity), (&to, &new_velocity))| Shift {
                offset: from - to,
                rate: velocity - new_velocity,
                from,
                velocity,
            })
            .collect();
        let steady = playing.steady_travel - new.steady_travel;
        self.travel = Some(Travel {
            steady,
            sway: playing.travel - new.travel - steady,
            from: playing.travel,
        });
        self.elapsed_secs = 0.0;
    }

    /// Continues with another method from this moment on. The rest of every offset is kept with its
    /// velocity, so that neither pose nor velocity jumps. `live` is the current motion without
    /// inertialization.
    pub fn change(&mut self, how: Inertialization, live: &MovingPose) {
        self.trigger(live, live);
        self.how = how;
    }

    /// Advances the time.
    pub fn advance(&mut self, dt_secs: f64) {
        self.elapsed_secs += dt_secs.max(0.0);
    }

    /// Applies the remaining offsets to a pose: rotations and translations as in [`MovingPose`].
    pub fn apply(&mut self, rotations: &mut [Quat], translations: &mut [Vec3]) {
        let (how, secs) = (self.how, self.elapsed_secs);
        let now = self.now();
        for (turn, rotation) in self.turns.iter_mut().zip(rotations) {
            let offset = now.of_turn(turn, how, secs).turned(turn, *rotation);
            *rotation = quat::renormalize(quat::exp(offset) * *rotation);
        }
        for (shift, translation) in self.shifts.iter().zip(translations) {
            *translation += now.shifted(shift, *translation);
        }
    }

    /// Returns the step over the ground of the new motion with the rest of the old travel added;
    /// `step` takes `dt_secs` and ends now. Steps are those of [`crate::clip::character_frames`]
    /// from one frame to the next, each in the character's frame at its start.
    ///
    /// The difference of steady velocities decays, without a rate of its own: from a walk into a
    /// run the speed rises and never overshoots. The rest, the sway of the moment, becomes the
    /// velocity of an offset that returns to 0: kept as a velocity, the quarter of a stride's turn
    /// or sway in progress would lead the character off its trajectory. Both are evaluated in the
    /// middle of the step.
    #[must_use]
    pub fn step(&self, step: &Planar, dt_secs: f64) -> Planar {
        let Some(old) = self.travel.filter(|_| dt_secs > 0.0) else {
            return *step;
        };
        let middle = DecayState::new(self.how, self.elapsed_secs - 0.5 * dt_secs);
        with_travel(step, middle.travelled(&old, travel(step, dt_secs.recip())), dt_secs)
    }

    fn now(&self) -> DecayState {
        DecayState::new(self.how, self.elapsed_secs)
    }

    /// Applies the remaining offsets to a pose and its velocities.
    fn carry(&mut self, pose: &mut MovingPose) {
        let (how, secs) = (self.how, self.elapsed_secs);
        let now = self.now();
        let rotations = pose.rotations.iter_mut().zip(&mut pose.angular_velocities);
        for (turn, (rotation, velocity)) in self.turns.iter_mut().zip(rotations) {
            let now = now.of_turn(turn, how, secs);
            let offset = now.turned(turn, *rotation);
            let rate = now.turning(turn, *velocity);
            let turned = quat::exp(offset);
            *velocity = quat::rate_to_angular_velocity(offset, rate) + turned * *velocity;
            *rotation = quat::renormalize(turned * *rotation);
        }
        let translations = pose.translations.iter_mut().zip(&mut pose.velocities);
        for (shift, (translation, velocity)) in self.shifts.iter().zip(translations) {
            let (offset, rate) =
                (now.shifted(shift, *translation), now.shifting(shift, *translation, *velocity));
            *translation += offset;
            *velocity += rate;
        }
        if let Some(old) = &self.travel {
            pose.travel += now.travelled(old, pose.travel);
            pose.steady_travel += now.steadily(old, pose.steady_travel);
        }
    }
}

/// The part of the decay that is the same for all joints at one moment.
#[derive(Clone, Copy)]
enum DecayState {
    /// A decay whose response does not depend on the offset.
    Linear(crate::math::Response),
    /// A decay whose response depends on the offset.
    Quintic(Decay, f64),
    Dead {
        weight: f32,
        /// The rate of the weight, per second.
        falling: f32,
        /// The share of the old velocity that is left, and its integral so far, seconds.
        speed_left: f32,
        extrapolated_secs: f32,
    },
}

impl DecayState {
    fn new(how: Inertialization, secs: f64) -> Self {
        match how {
            Inertialization::Offset(decay @ Decay::Quintic { .. }) => Self::Quintic(decay, secs),
            Inertialization::Offset(decay) => Self::Linear(decay.response(0.0, secs)),
            Inertialization::DeadBlend { blend_secs, extrapolation_half_life_secs } => {
                let (weight, falling) = fade(blend_secs, secs);
                let (speed_left, extrapolated_secs) =
                    spring::velocity_decay(extrapolation_half_life_secs, secs);
                Self::Dead {
                    weight: weight as f32,
                    falling: falling as f32,
                    speed_left: speed_left as f32,
                    extrapolated_secs: extrapolated_secs as f32,
                }
            }
        }
    }

    /// Returns the decay of a joint that is slowed down.
    fn of_turn(self, turn: &Turn, how: Inertialization, secs: f64) -> Self {
        if turn.stretch > 1.0 {
            Self::new(how.stretched(f64::from(turn.stretch)), secs)
        } else {
            self
        }
    }

    fn of(self, offset: Vec3, rate: Vec3) -> (Vec3, Vec3) {
        match self {
            Self::Linear(response) => response.of_vec3(offset, rate),
            Self::Quintic(decay, secs) => decay.of_vec3(offset, rate, secs),
            Self::Dead { .. } => (Vec3::ZERO, Vec3::ZERO),
        }
    }

    /// Returns the rotation vector that is applied to `live`.
    fn turned(self, turn: &mut Turn, live: Quat) -> Vec3 {
        match self {
            Self::Dead { weight, extrapolated_secs, .. } => {
                let old = quat::exp(turn.angular_velocity * extrapolated_secs) * turn.from;
                turn.last = quat::in_hemisphere_of(old * live.conjugate(), turn.last);
                quat::log_as_given(turn.last) * weight
            }
            _ => self.of(turn.offset, turn.rate).0,
        }
    }

    /// Returns the rate of the vector that [`turned`](Self::turned) returned last, when `live`
    /// turns with `live_velocity`.
    fn turning(self, turn: &Turn, live_velocity: Vec3) -> Vec3 {
        match self {
            Self::Dead { weight, falling, speed_left, .. } => {
                let whole = quat::log_as_given(turn.last);
                let rate = quat::vector_rate(
                    whole,
                    turn.angular_velocity * speed_left - turn.last * live_velocity,
                );
                whole * falling + rate * weight
            }
            _ => self.of(turn.offset, turn.rate).1,
        }
    }

    fn shifted(self, shift: &Shift, live: Vec3) -> Vec3 {
        match self {
            Self::Dead { weight, extrapolated_secs, .. } => {
                (shift.from + shift.velocity * extrapolated_secs - live) * weight
            }
            _ => self.of(shift.offset, shift.rate).0,
        }
    }

    fn shifting(self, shift: &Shift, live: Vec3, live_velocity: Vec3) -> Vec3 {
        match self {
            Self::Dead { weight, falling, speed_left, extrapolated_secs } => {
                let off = shift.from + shift.velocity * extrapolated_secs - live;
                off * falling + (shift.velocity * speed_left - live_velocity) * weight
            }
            _ => self.of(shift.offset, shift.rate).1,
        }
    }

    fn travelled(self, travel: &Travel, live: Vec3) -> Vec3 {
        match self {
            Self::Dead { weight, speed_left, .. } => (travel.from * speed_left - live) * weight,
            _ => self.steadily(travel, live) + self.of(Vec3::ZERO, travel.sway).1,
        }
    }

    fn steadily(self, travel: &Travel, live: Vec3) -> Vec3 {
        match self {
            Self::Dead { .. } => self.travelled(travel, live),
            _ => self.of(travel.steady, Vec3::ZERO).0,
        }
    }
}

#[cfg(test)]
mod tests;
