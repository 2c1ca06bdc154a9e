//! A plan: the path over the ground, and the plants of each foot.

use super::body::Body;
use super::foot::Plant;
use super::gait::{Gait, gravity, pendulum_height};
use super::params::{Action, Params};
use super::path::{Path, Place};
use glam::DVec2;

/// Distance of the ankles of a standing adult of 1.75 m behind the middle of the body, metres: the
/// body is over the middle of the feet.
pub(super) const STANDING_BEHIND: f64 = 0.05;

/// The times of a jump, seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct JumpTimes {
    pub(super) dip: f64,
    pub(super) bottom: f64,
    pub(super) off: f64,
    pub(super) land: f64,
    pub(super) absorbed: f64,
    pub(super) stood: f64,
}

/// A plan on a grid of time steps, of which every `substeps`th is a frame.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) action: Action,
    pub(super) gait: Gait,
    pub(super) path: Path,
    /// Left and right, in order of time.
    pub(super) plants: [Vec<Plant>; 2],
    pub(super) frames: usize,
    pub(super) substeps: usize,
    pub(super) dt_secs: f64,
    /// Number of grid steps before frame 0 and after the last frame.
    pub(super) margin: usize,
    /// Number of grid steps of one cycle, where the motion repeats exactly.
    pub(super) period: Option<usize>,
    /// The time of a left heel strike, and the interval in which the phase advances.
    pub(super) phase_zero: f64,
    pub(super) moving: (f64, f64),
    /// 0 standing to 1 going at full speed.
    pub(super) top_speed: f64,
    pub(super) jump: Option<JumpTimes>,
}

impl Plan {
    /// Returns the number of grid steps.
    pub(super) fn len(&self) -> usize {
        (self.frames - 1) * self.substeps + 1 + 2 * self.margin
    }

    /// Returns the time of a grid step; 0 at frame 0.
    pub(super) fn secs(&self, step: usize) -> f64 {
        (step as f64 - self.margin as f64) * self.dt_secs
    }

    /// Returns the grid step of a frame.
    pub(super) fn step_of(&self, frame: usize) -> usize {
        self.margin + frame * self.substeps
    }

    /// Returns the number of cycles since the left heel strike at `phase_zero`; constant while the
    /// feet stand.
    pub(super) fn cycles(&self, secs: f64) -> f64 {
        (secs.clamp(self.moving.0, self.moving.1) - self.phase_zero) / self.gait.cycle_secs
    }

    /// Returns the intensity of the gait, 0 to 1.
    pub(super) fn going(&self, secs: f64) -> f64 {
        if self.top_speed > 0.0 && self.jump.is_none() {
            (self.path.at(secs).speed / self.top_speed).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

impl Plan {
    /// Integrates the path over the whole grid.
    pub(super) fn set_path(&mut self, rates: impl Fn(f64) -> (f64, f64)) {
        self.path = Path::integrate(self.secs(0), self.dt_secs, self.len(), rates);
    }

    /// Returns the foothold of a body that stands at the place of `secs`: farther to the side, and
    /// under the body.
    pub(super) fn standing_foothold(
        &self,
        side: usize,
        secs: f64,
        params: &Params,
        body: &Body,
    ) -> DVec2 {
        let place = self.path.at(secs);
        let half_width = standing_half_width(params, body);
        let outward = if side == 0 { half_width } else { -half_width };
        place.position + place.left() * outward
            - place.forward() * (STANDING_BEHIND * f64::from(body.scale))
    }

    /// Returns the foothold of a side while the body passes the place of `secs`: to its side, and,
    /// since an inverted pendulum accelerates away from its foot by ω²(x - foot), opposite to the
    /// body's acceleration.
    pub(super) fn foothold(
        &self,
        side: usize,
        secs: f64,
        half_width: f64,
        params: &Params,
        body: &Body,
    ) -> DVec2 {
        foothold_at(&self.path.at(secs), side, half_width, self.gait, params, body)
    }
}

/// Returns the foothold of a side while the body passes `place`; see [`Plan::foothold`].
fn foothold_at(
    place: &Place,
    side: usize,
    half_width: f64,
    gait: Gait,
    params: &Params,
    body: &Body,
) -> DVec2 {
    let outward = if side == 0 { half_width } else { -half_width };
    // Ankles and the sway of the trunk contribute half of the acceleration.
    let eased = Place { thrust: 0.5 * place.thrust, ..*place };
    let support = eased.lean(gravity()) * -pendulum_height(params.height_m);
    let behind =
        f64::from(body.scale) * if gait.running { 0.20 - 0.03 * gait.quick_run() } else { 0.105 };
    place.position + support + place.left() * outward - place.forward() * behind
}

impl Plan {
    /// Bends the trajectory of every swing around the other leg: in the middle, the foot is as far
    /// to its side of the body as on the ground, and slightly farther when it turns on the spot.
    pub(super) fn keep_legs_apart(&mut self, params: &Params, body: &Body) {
        let spinning = self.action == Action::Spin;
        let room = if spinning { 0.06 * f64::from(body.scale) } else { 0.0 };
        for side in 0..2 {
            for index in 1..self.plants[side].len() {
                let (from, to) = (self.plants[side][index - 1], self.plants[side][index]);
                let middle = 0.5 * (from.to + to.from);
                let place = self.path.at(middle);
                let facing = if spinning {
                    Place { yaw: 0.5 * (from.yaw + to.yaw) - toe_out(side, false), ..place }
                } else {
                    place
                };
                let half_width = 0.5 * (from.half_width + to.half_width) + room;
                let wanted = foothold_at(&facing, side, half_width, self.gait, params, body);
                let left = facing.left();
                let missing = (wanted - 0.5 * (from.ankle + to.ankle)).dot(left);
                self.plants[side][index - 1].swing.sideways = left * missing;
            }
        }
    }
}

/// Returns half the distance of standing feet, metres.
pub(super) fn standing_half_width(params: &Params, body: &Body) -> f64 {
    f64::from(body.scale) * 0.085 * f64::from(0.4 + 0.6 * params.style.stance_width)
}

/// Returns the out-toeing, radians: about 7° per foot in walking (Murray 1967), less in running.
pub(super) fn toe_out(side: usize, running: bool) -> f64 {
    let angle = if running { 3.0_f64 } else { 6.5 };
    if side == 0 { angle.to_radians() } else { -angle.to_radians() }
}
