//! The Match lab on the ground: where the character was asked to be, where it is asked to go, and
//! where the frame that plays would lead.

use super::{Color, Colors, Layer, Pane, Ring, with_alpha};
use segue_motion::math::Planar;
use segue_session::{DriveMoment, Driven};

/// Pieces of a trajectory.
const STEPS: usize = 20;
/// Points of the way that was asked for, at most.
const WAY_POINTS: usize = 600;
/// Heights above the ground in which lines lie over each other, metres.
const LOWEST: f32 = 0.003;
/// Likewise.
const MIDDLE: f32 = 0.006;
/// Likewise.
const HIGHEST: f32 = 0.009;
/// Length of the line that says what is faced, metres.
const FACING_M: f32 = 0.22;

/// What is asked for in A's colour, what the frame leads to in B's.
pub(super) fn add_drive(driven: &Driven, now_secs: f64, colors: &Colors, pane: &mut Pane) {
    let Some(moment) = driven.at(now_secs) else {
        return;
    };
    let stride = driven.moments.len().div_ceil(WAY_POINTS).max(1);
    let asked = driven.moments.iter().step_by(stride);
    pane.add_dashed_path(
        asked.map(|moment| moment.simulation.place().origin().with_y(LOWEST)),
        with_alpha(colors.a, 0.4),
        0.05,
        1.5,
        Layer::Ground,
    );
    let ways = [
        (driven.matched_way(moment, STEPS), colors.b, MIDDLE),
        (driven.asked_way(moment, STEPS), colors.a, HIGHEST),
    ];
    for (way, color, height) in ways {
        add_way(driven, &way, color, height, pane);
    }
    add_simulation(moment, colors, pane);
}

/// A trajectory, with what is faced at the times that are compared.
fn add_way(driven: &Driven, way: &[Planar], color: Color, height: f32, pane: &mut Pane) {
    pane.add_path(
        way.iter().map(|place| (place.origin().with_y(height), color)),
        2.5,
        Layer::Ground,
    );
    let layout = driven.database.features().layout();
    let horizon = layout.horizon().max(1);
    for ahead in layout.ahead() {
        if let Some(place) = way.get(ahead * (way.len().saturating_sub(1)) / horizon) {
            let from = place.origin().with_y(height);
            pane.add_line(from, from + place.forward() * FACING_M, color, 2.0, Layer::Ground);
            // A line so short that only its round ends are seen.
            pane.add_line(from, from + place.forward() * 1e-3, color, 7.0, Layer::Ground);
        }
    }
}

/// The simulation object: a ring that looks ahead.
fn add_simulation(moment: &DriveMoment, colors: &Colors, pane: &mut Pane) {
    let place = moment.simulation.place();
    let radius = 0.2;
    pane.rings.push(Ring {
        center: place.origin(),
        radius,
        width: 0.014,
        color: with_alpha(colors.a, 0.9),
        fill: 0.06,
    });
    let rim = place.origin().with_y(HIGHEST) + place.forward() * radius;
    pane.add_line(rim, rim + place.forward() * (0.5 * FACING_M), colors.a, 3.0, Layer::Ground);
}
