//! Plans of actions on the spot: standing, turning around, jumping.

use super::body::Body;
use super::foot::{Plant, Swing};
use super::gait::gravity;
use super::params::{Action, Params};
use super::plan::{JumpTimes, Plan, STANDING_BEHIND, standing_half_width, toe_out};
use super::track::ramp;
use glam::DVec2;

fn stand(plan: &Plan, side: usize, params: &Params, body: &Body) -> Plant {
    let ever = f64::INFINITY;
    Plant {
        from: -ever,
        flat_from: -ever,
        flat_to: ever,
        to: ever,
        ankle: plan.standing_foothold(side, -ever, params, body),
        half_width: standing_half_width(params, body),
        yaw: plan.path.at(-ever).yaw + toe_out(side, false),
        strike_pitch: 0.0,
        release_pitch: 0.0,
        load_secs: 0.12,
        stances_per_sec: 1.6,
        swing: Swing::default(),
    }
}

/// Plans standing, and turning on the spot in steps of which none rotates a foot by more than about
/// 100°.
pub(super) fn on_the_spot(plan: &mut Plan, params: &Params, body: &Body) {
    plan.top_speed = 0.0;
    plan.moving = (0.0, 0.0);
    let angle = if params.action == Action::Spin {
        f64::from(params.spin_degrees).to_radians()
    } else {
        0.0
    };
    if angle.abs() < 1e-3 {
        plan.set_path(|_| (0.0, 0.0));
        plan.plants = [0, 1].map(|side| vec![stand(plan, side, params, body)]);
        return;
    }
    // Both feet take the same number of steps; the inner one steps first, the other one last.
    let degrees = angle.abs().to_degrees();
    let pairs = if degrees <= 60.0 { 1.0 } else { (degrees / 100.0).ceil().max(2.0) };
    let steps = 2 * pairs as usize;
    let (period, air) = (0.50 * f64::from(body.scale).sqrt(), 0.36 * f64::from(body.scale).sqrt());
    let lift = 0.55;
    let span = period * (steps - 1) as f64 + air;
    let (from, to) = (lift - 0.12, lift + span + 0.10);
    let h = 1e-4;
    plan.set_path(|t| (0.0, angle * (ramp(t + h, from, to) - ramp(t - h, from, to)) / (2.0 * h)));
    let inner = usize::from(angle < 0.0);
    let wide = standing_half_width(params, body);
    let mut plants = [0, 1].map(|side| vec![stand(plan, side, params, body)]);
    for step in 0..steps {
        let side = if step % 2 == 0 { inner } else { 1 - inner };
        let off = lift + period * step as f64;
        let on = off + air;
        // A foot is set down in the direction that the body will face when it lifts again; less for
        // the first and fully for the last steps.
        let share = if step + 2 >= steps {
            1.0
        } else {
            ((step as f64 + 1.35) / (steps as f64 - 0.3)).min(1.0)
        };
        let facing = super::path::Place { yaw: angle * share, ..plan.path.at(f64::NEG_INFINITY) };
        let outward = if side == 0 { wide } else { -wide };
        let swing = Swing {
            peak: (0.35, 0.055 * f64::from(body.scale)),
            low: (0.72, 0.040 * f64::from(body.scale)),
            pitch: [(0.2, 0.50), (0.6, 0.12)],
            toes_up: -0.05,
            start_acceleration: 0.3,
            end_acceleration: 0.3,
            sideways: DVec2::ZERO,
            lift_off_mps: 0.0,
        };
        // During the turn the feet are set wider, the leading one farther ahead and the trailing
        // one farther back, so that no toe is set on a heel.
        let passing = if step + 2 >= steps { 0.0 } else { f64::from(body.scale) };
        let outward = outward * (1.0 + 0.5 * passing);
        let behind = STANDING_BEHIND * f64::from(body.scale)
            + if side == inner { -0.03 } else { 0.06 } * passing;
        let ankle = facing.left() * outward - facing.forward() * behind;
        let resting = stand(plan, side, params, body);
        if let Some(before) = plants[side].last_mut() {
            (before.flat_to, before.to, before.release_pitch, before.swing) =
                (off - 0.17, off, 0.42, swing);
        }
        let strike_pitch = 0.10;
        plants[side].push(Plant {
            from: on,
            flat_from: on + 0.09,
            ankle,
            yaw: facing.yaw + toe_out(side, false),
            strike_pitch,
            ..resting
        });
    }
    plan.plants = plants;
}

/// Pitch of the feet when they leave and reach the ground in a jump.
const RELEASE_PITCH: f64 = 0.80;
const LAND_PITCH: f64 = 0.42;

/// Plans a jump from both feet, forward at the given speed.
pub(super) fn jump(plan: &mut Plan, params: &Params, body: &Body) {
    plan.top_speed = 0.0;
    plan.moving = (0.0, 0.0);
    let size = f64::from(body.scale).sqrt();
    // A countermovement jump of about 0.3 m: dip in 0.45 s, push in 0.3 s (Bobbert et al. 1996).
    let rise = 0.27
        * f64::from(body.scale)
        * (0.5 + 0.5 * f64::from(params.style.energy))
        * (0.6 + 0.4 * f64::from(params.style.bounce));
    let air = 2.0 * (2.0 * rise / gravity()).sqrt();
    let dip = 0.40;
    let bottom = dip + 0.48 * size;
    let off = bottom + 0.30 * size;
    let land = off + air;
    let times = JumpTimes {
        dip,
        bottom,
        off,
        land,
        absorbed: land + 0.24 * size,
        stood: land + 0.85 * size,
    };
    let speed = f64::from(params.speed_mps);
    plan.set_path(|t| {
        let go = ramp(t, bottom - 0.05, off + 0.02);
        (speed * go * (1.0 - ramp(t, land, times.stood - 0.15)), 0.0)
    });
    plan.jump = Some(times);
    // The feet land ahead of the body, which comes to rest above them.
    for side in 0..2 {
        let first = stand(plan, side, params, body);
        let ankle = plan.standing_foothold(side, f64::INFINITY, params, body);
        let swing = Swing {
            peak: (0.45, 1.25 * rise),
            low: (0.80, 0.62 * rise),
            pitch: [(0.15, 1.05), (0.5, 0.75)],
            toes_up: 0.12,
            start_acceleration: 0.8,
            end_acceleration: 0.6,
            sideways: DVec2::ZERO,
            lift_off_mps: 0.3 * gravity() * air * 0.5,
        };
        let away = Plant {
            flat_to: off - 0.2 * size,
            to: off,
            release_pitch: RELEASE_PITCH,
            swing,
            ..first
        };
        let back = Plant {
            from: land,
            flat_from: land + 0.10 * size,
            strike_pitch: LAND_PITCH,
            ankle,
            ..first
        };
        plan.plants[side] = vec![away, back];
    }
}
