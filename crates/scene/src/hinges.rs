//! The hinges of a robot: those at a limit in the colour of warnings, those beyond it in that of
//! errors.

use crate::color::{CLAY_SHARE, mixed};
use crate::{Color, Colors, Look};
use segue_formats::robot_csv::{HingeLimits, HingeState};
use segue_motion::clip::{Interpolation, Motion};

/// Returns the state of each joint's hinge at a time of a motion, seconds; empty if no hinge is at
/// a limit, or the hinges of the skeleton are not known.
pub(crate) fn hinge_states(motion: &Motion, secs: f64) -> Vec<HingeState> {
    let Some(limits) = HingeLimits::of(motion.clip().skeleton()) else {
        return Vec::new();
    };
    let pose = motion.clip().sample(secs, Interpolation::Linear).unwrap_or_default();
    let states = pose.rotations.iter().enumerate();
    let states: Vec<_> = states.map(|(joint, turn)| limits.state(joint, *turn)).collect();
    if states.iter().all(|state| *state == HingeState::Free) { Vec::new() } else { states }
}

/// Returns the colour of a joint whose hinge is at a limit; `None` for any other.
pub(crate) fn hinge_color(states: &[HingeState], joint: usize, colors: &Colors) -> Option<Color> {
    match states.get(joint)? {
        HingeState::Free => None,
        HingeState::AtLimit => Some(colors.warning),
        HingeState::BeyondLimit => Some(colors.bad),
    }
}

/// Returns the colour of a limb of a body by the hinge of its joint.
pub(crate) fn limb_color(
    states: &[HingeState],
    joint: usize,
    look: &Look,
    colors: &Colors,
) -> Color {
    let own = hinge_color(states, joint, colors);
    own.map_or(look.clay, |color| mixed(color, look.clay, CLAY_SHARE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_formats::{ImportOptions, import};
    use std::fmt::Write as _;

    /// The column of the left knee, which bends from -5° to 165°.
    const LEFT_KNEE: usize = 7 + 3;

    /// Returns a robot that stands, with these angles of its left knee, degrees, one after the
    /// other.
    fn robot(degrees: &[f64]) -> Motion {
        let mut text = String::new();
        for angle in degrees {
            let cells = (0..36).map(|column| match column {
                2 => 0.8,
                6 => 1.0,
                LEFT_KNEE => angle.to_radians(),
                _ => 0.0,
            });
            let cells: Vec<String> = cells.map(|cell: f64| cell.to_string()).collect();
            writeln!(text, "{}", cells.join(",")).unwrap();
        }
        let file = import("robot.csv", text.as_bytes(), &ImportOptions::default()).unwrap();
        Motion::analyze(file.clips[0].clip.clone())
    }

    #[test]
    fn limb_behind_a_hinge_at_its_limit_has_the_colour_of_warnings() {
        let motion = robot(&[30.0, 164.8, 170.0]);
        let colors = Colors {
            warning: [1.0, 0.6, 0.0, 1.0],
            bad: [1.0, 0.0, 0.0, 1.0],
            ..Colors::default()
        };
        let knee = motion.clip().skeleton().find("left_knee").unwrap();
        let at = |frame: f64| hinge_states(&motion, frame / motion.clip().fps());
        assert_eq!(at(0.0), []);
        for (frame, expected) in [(1.0, colors.warning), (2.0, colors.bad)] {
            let states = at(frame);
            let found = (0..states.len())
                .filter_map(|joint| Some((joint, hinge_color(&states, joint, &colors)?)));
            assert_eq!(found.collect::<Vec<_>>(), [(knee, expected)]);
            let clay = Look::DARK.clay;
            assert_ne!(limb_color(&states, knee, &Look::DARK, &colors), clay);
            assert_eq!(limb_color(&states, knee + 1, &Look::DARK, &colors), clay);
        }
    }

    #[test]
    fn other_bodies_have_no_known_hinges() {
        let walk = segue_motion::synth::Params::new(segue_motion::synth::Action::Walk);
        let walk = Motion::analyze(segue_motion::synth::synthesize(&walk).unwrap().clip);
        assert_eq!(hinge_states(&walk, 0.5), []);
    }
}
