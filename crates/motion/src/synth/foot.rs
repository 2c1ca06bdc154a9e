//! The motion of one foot over time: planted and rolling from heel to ball, then swinging to the
//! next plant.

use super::body::Body;
use super::track::{Spline, State, cubic_start_acceleration, quintic, ramp};
use glam::{DVec2, DVec3, Quat, Vec3};

/// A plant of a foot: its times, its position, and the pitch with which the foot arrives and
/// leaves. Times are seconds, `-∞` for a plant without a beginning and `∞` for one without an end.
///
/// The foot rolls over two rockers (Perry and Burnfield 2010, chapter 3): about the heel from
/// `from` to `flat_from`, flat on the ground to `flat_to`, and about the ball, with the toes flat,
/// to `to`. A foot that arrives with its heel up lands on the ball instead.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plant {
    pub(super) from: f64,
    pub(super) flat_from: f64,
    pub(super) flat_to: f64,
    pub(super) to: f64,
    /// Position of the ankle while the foot is flat, world (x, z), metres.
    pub(super) ankle: DVec2,
    /// Direction of the toes about +Y, radians.
    pub(super) yaw: f64,
    /// Pitch at `from` and `to`, radians, positive with the heel up.
    pub(super) strike_pitch: f64,
    pub(super) release_pitch: f64,
    /// The ankle's distance from the middle of the body across its heading, metres; positive on
    /// either side.
    pub(super) half_width: f64,
    /// Durations of loading after `from` and of unloading before `to`, seconds.
    pub(super) load_secs: f64,
    /// Inverse of the duration of a stance, per second: the rate of its progress, also for a plant
    /// without a beginning or an end.
    pub(super) stances_per_sec: f64,
    /// The swing from here to the next plant.
    pub(super) swing: Swing,
}

/// The swing of a foot. Times are shares of the swing; heights are those of the ball above its
/// height at the release, metres.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swing {
    /// The highest point: (share, height).
    pub(super) peak: (f64, f64),
    /// The low point before the strike: (share, height).
    pub(super) low: (f64, f64),
    /// Pitch knots after the release: (share, radians).
    pub(super) pitch: [(f64, f64); 2],
    /// Pitch at the share 0.88, relative to that at the strike, radians; negative with the toes
    /// higher.
    pub(super) toes_up: f64,
    /// Horizontal acceleration at the start and the end of the swing, as multiples of those of the
    /// cubic between the same positions and velocities, which is the curve of least bending.
    pub(super) start_acceleration: f64,
    pub(super) end_acceleration: f64,
    /// Displacement of the trajectory in the middle of the swing, world (x, z), metres: around the
    /// other leg, through which the straight way would pass on a curve.
    pub(super) sideways: DVec2,
    /// Upward speed of the ball at the start of the swing, and downward speed at its end, m/s.
    /// Above 0 only in jumps, in which the foot leaves the ground with the whole body.
    pub(super) lift_off_mps: f64,
}

/// The state of a foot at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) ankle: Vec3,
    pub(super) rotation: Quat,
    pub(super) yaw: f64,
    /// Bend of the toes against the foot, radians, positive downwards.
    pub(super) toe_bend: f64,
    pub(super) heel_down: bool,
    pub(super) toe_down: bool,
    /// 0 in the air to 1 fully loaded.
    pub(super) load: f64,
    /// 0 at the strike to 1 at the release; the share of the swing while in the air.
    pub(super) progress: f64,
    /// Centre of pressure, world (x, z), metres; in the air that of the last plant.
    pub(super) pressure: DVec2,
}

impl Foot {
    pub(super) fn planted(&self) -> bool {
        self.heel_down || self.toe_down
    }
}

/// Returns a vector of the foot's side view after a pitch, as (along, up), and its derivative by
/// the pitch.
fn pitched(v: Vec3, pitch: f64) -> (DVec2, DVec2) {
    let (y, z) = (f64::from(v.y), f64::from(v.z));
    let (sin, cos) = libm::sincos(pitch);
    (
        DVec2::new(z * cos + y * sin, y * cos - z * sin),
        DVec2::new(y * cos - z * sin, -y * sin - z * cos),
    )
}

/// Returns the direction of a yaw over the ground, (x, z).
fn along(yaw: f64) -> DVec2 {
    DVec2::new(libm::sin(yaw), libm::cos(yaw))
}

/// Returns the world position of the ball of a planted foot at a pitch, and its derivative by the
/// pitch. With the heel up the foot turns about the ball, which stays; with the toes up it turns
/// about the heel.
fn planted_ball(plant: &Plant, body: &Body, pitch: f64) -> (DVec3, DVec3) {
    let flat_ball = f64::from(body.ball_in_foot.z);
    let ball_height = f64::from(body.ankle_height() + body.ball_in_foot.y);
    let forward = along(plant.yaw);
    let place = |along: f64, up: f64| {
        let ground = plant.ankle + forward * along;
        DVec3::new(ground.x, up, ground.y)
    };
    if pitch >= 0.0 {
        return (place(flat_ball, ball_height), DVec3::ZERO);
    }
    let heel = f64::from(body.heel_in_foot.z);
    let (arm, turn) = pitched(body.ball_in_foot - body.heel_in_foot, pitch);
    (place(heel + arm.x, arm.y), DVec3::new(forward.x * turn.x, turn.y, forward.y * turn.x))
}

impl Plant {
    /// Returns the rate of the pitch at the strike, radians per second: 1.1 times its mean until
    /// the foot is flat.
    fn strike_rate(&self) -> f64 {
        let span = self.flat_from - self.from;
        if span.is_finite() && span > 0.0 { -1.1 * self.strike_pitch / span } else { 0.0 }
    }

    /// Returns the rate of the pitch at the release, radians per second: 1.9 times its mean since
    /// the foot was flat.
    fn release_rate(&self) -> f64 {
        let span = self.to - self.flat_to;
        if span.is_finite() && span > 0.0 { 1.9 * self.release_pitch / span } else { 0.0 }
    }

    fn pitch(&self, secs: f64) -> f64 {
        if secs < self.flat_from {
            let strike =
                State { value: self.strike_pitch, rate: self.strike_rate(), acceleration: 0.0 };
            quintic(strike, State::rest(0.0), self.flat_from - self.from, secs - self.from)
        } else if secs > self.flat_to {
            let release =
                State { value: self.release_pitch, rate: self.release_rate(), acceleration: 0.0 };
            quintic(State::rest(0.0), release, self.to - self.flat_to, secs - self.flat_to)
        } else {
            0.0
        }
    }

    /// Returns the progress through the stance. Without an end it stops at the middle, and without
    /// a beginning it starts there.
    fn progress(&self, secs: f64) -> f64 {
        let since = (secs - self.from) * self.stances_per_sec;
        let left = (self.to - secs) * self.stances_per_sec;
        match (self.from.is_finite(), self.to.is_finite()) {
            (true, true) => since / (since + left),
            (true, false) => since.min(0.5),
            (false, true) => (1.0 - left).max(0.5),
            (false, false) => 0.5,
        }
    }
}

/// Returns the state at `secs` of the foot that follows `plants` (in order of time, at least one).
pub(super) fn foot_at(plants: &[Plant], body: &Body, secs: f64) -> Option<Foot> {
    let index = plants.partition_point(|plant| plant.from <= secs).saturating_sub(1);
    let plant = plants.get(index)?;
    let next = plants.get(index + 1).filter(|_| secs > plant.to);
    let (ball, yaw, pitch, toe_pitch, progress) = match next {
        None => {
            let pitch = plant.pitch(secs.clamp(plant.from, plant.to));
            (
                planted_ball(plant, body, pitch).0,
                plant.yaw,
                pitch,
                pitch.min(0.0),
                plant.progress(secs),
            )
        }
        Some(next) => swing_at(plant, next, body, secs),
    };
    let down = next.is_none();
    let rotation = Quat::from_rotation_y(yaw as f32) * Quat::from_rotation_x(pitch as f32);
    let ankle = ball.as_vec3() - rotation * body.ball_in_foot;
    // The centre of pressure moves from the heel to the ball: for an adult from 2 cm behind the
    // ankle at the strike over 5 cm in front of it to 12 cm at the release.
    let scale = f64::from(body.scale);
    let roll = 0.05 - 0.07 * (1.0 - ramp(secs, plant.from, plant.from + 2.0 * plant.load_secs))
        + 0.07 * ramp(secs, plant.to - 3.0 * plant.load_secs, plant.to);
    Some(Foot {
        ankle,
        rotation,
        yaw,
        toe_bend: toe_pitch - pitch,
        heel_down: down && pitch <= 0.0,
        toe_down: down && pitch >= 0.0,
        load: if down {
            ramp(secs, plant.from, plant.from + plant.load_secs)
                * (1.0 - ramp(secs, plant.to - plant.load_secs, plant.to))
        } else {
            0.0
        },
        progress,
        pressure: plant.ankle + along(plant.yaw) * (roll * scale),
    })
}

/// Returns ball, yaw, pitch, pitch of the toes, and share of the swing.
fn swing_at(plant: &Plant, next: &Plant, body: &Body, secs: f64) -> (DVec3, f64, f64, f64, f64) {
    let swing = &plant.swing;
    let span = next.from - plant.to;
    let now = secs - plant.to;
    let share = now / span;
    let (start, _) = planted_ball(plant, body, plant.release_pitch);
    let (end, end_turn) = planted_ball(next, body, next.strike_pitch);
    let end_rate = end_turn * next.strike_rate();
    // Over the ground the ball moves from rest to the velocity of the heel rocker. Accelerations at
    // both ends make it faster there than the curve of least jerk, which has none.
    let mut from = State { value: start.with_y(0.0), rate: DVec3::ZERO, acceleration: DVec3::ZERO };
    let mut to =
        State { value: end.with_y(0.0), rate: end_rate.with_y(0.0), acceleration: DVec3::ZERO };
    let reversed = (State { rate: -to.rate, ..to }, State { rate: -from.rate, ..from });
    let (a0, a1) = (
        cubic_start_acceleration(from, to, span),
        cubic_start_acceleration(reversed.0, reversed.1, span),
    );
    from.acceleration = a0 * swing.start_acceleration;
    to.acceleration = a1 * swing.end_acceleration;
    let bulge = 16.0 * (share * (1.0 - share)).powi(2);
    let ground =
        quintic(from, to, span, now) + DVec3::new(swing.sideways.x, 0.0, swing.sideways.y) * bulge;
    let timed = |(share, value): (f64, f64)| (share * span, value);
    let height = Spline::clamped(
        &[
            (0.0, start.y),
            timed((swing.peak.0, start.y + swing.peak.1)),
            timed((swing.low.0, start.y + swing.low.1)),
            (span, end.y),
        ],
        swing.lift_off_mps,
        if swing.lift_off_mps > 0.0 { -swing.lift_off_mps } else { end_rate.y },
    );
    let [a, b] = swing.pitch;
    let pitch = Spline::clamped(
        &[
            (0.0, plant.release_pitch),
            timed(a),
            timed(b),
            timed((0.88, next.strike_pitch + swing.toes_up)),
            (span, next.strike_pitch),
        ],
        plant.release_rate(),
        next.strike_rate(),
    )
    .at(now);
    // The toes leave the ground flat, come into line with the foot, and are flat again at the
    // strike if the ball lands first.
    let landing = if next.strike_pitch > 0.0 { ramp(share, 0.55, 1.0) } else { 0.0 };
    let in_line = ramp(share, 0.0, 0.5) * (1.0 - landing);
    let toe_pitch = pitch * in_line + pitch.min(0.0) * (1.0 - in_line);
    let yaw = plant.yaw + (next.yaw - plant.yaw) * ramp(share, 0.05, 0.92);
    // Heel and toes clear the ground for any knots: the ball is raised by most of the missing
    // height, smoothly from 0 on.
    let ball = height.at(now);
    let heel = ball + pitched(body.heel_in_foot - body.ball_in_foot, pitch).0.y;
    let tip = ball + pitched(body.tip_in_toes, toe_pitch).0.y;
    let clearance =
        0.02 * f64::from(body.scale) * ramp(share, 0.0, 0.3) * (1.0 - ramp(share, 0.7, 1.0));
    let missing = (clearance - heel.min(tip)).max(0.0);
    let lift = missing * missing / (missing + 0.006);
    (ground.with_y(ball + lift), yaw, pitch, toe_pitch, share)
}
