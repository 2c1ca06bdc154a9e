//! Built-in recordings.

use super::control::{Control, Recording};
use super::features::RATE;
use glam::DVec2;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Recorded input that demonstrates a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Scenario {
    /// Starts and stops walking, straight.
    WalkStraight,
    /// Turns left by 90° from a walk.
    TurnLeft,
    /// Turns right by 90° from a walk.
    TurnRight,
    /// Turns around by 180° from a walk.
    Spin,
    /// Starts and stops three times.
    StartStop,
    /// Changes from a walk to a run, and back.
    WalkToRun,
    /// Walks a figure eight.
    FigureEight,
}

/// The speeds of the scenarios, metres per second.
const WALK_MPS: f64 = 1.4;
const RUN_MPS: f64 = 3.2;

impl Scenario {
    /// All scenarios.
    pub const ALL: [Self; 7] = [
        Self::WalkStraight,
        Self::TurnLeft,
        Self::TurnRight,
        Self::Spin,
        Self::StartStop,
        Self::WalkToRun,
        Self::FigureEight,
    ];

    /// Returns the id, which is short, stable and fit for a link.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::WalkStraight => "straight",
            Self::TurnLeft => "left",
            Self::TurnRight => "right",
            Self::Spin => "spin",
            Self::StartStop => "start_stop",
            Self::WalkToRun => "run",
            Self::FigureEight => "eight",
        }
    }

    /// Returns the title on screen.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::WalkStraight => "walk straight",
            Self::TurnLeft => "90° to the left",
            Self::TurnRight => "90° to the right",
            Self::Spin => "180° spin",
            Self::StartStop => "start and stop",
            Self::WalkToRun => "walk to run",
            Self::FigureEight => "figure eight",
        }
    }

    /// Returns the scenario with this id.
    #[must_use]
    pub fn find(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scenario| scenario.id() == id)
    }

    /// Returns its input.
    #[must_use]
    pub fn recording(self) -> Recording {
        let mut recording = Recording::new();
        let mut hold = |secs: f64, speed: f64, yaw: f64| {
            let velocity = DVec2::new(libm::sin(yaw), libm::cos(yaw)) * speed;
            recording.hold(Control::new(velocity, None), (secs * RATE as f64).round() as u32);
        };
        match self {
            Self::WalkStraight => hold(12.0, WALK_MPS, 0.0),
            Self::TurnLeft => [0.0, FRAC_PI_2].into_iter().for_each(|yaw| hold(4.0, WALK_MPS, yaw)),
            Self::TurnRight => {
                for yaw in [0.0, -FRAC_PI_2] {
                    hold(4.0, WALK_MPS, yaw);
                }
            }
            Self::Spin => [0.0, PI, 0.0].into_iter().for_each(|yaw| hold(4.0, WALK_MPS, yaw)),
            Self::StartStop => {
                for _ in 0..3 {
                    hold(2.0, 0.0, 0.0);
                    hold(3.0, WALK_MPS, 0.0);
                }
                hold(2.0, 0.0, 0.0);
            }
            Self::WalkToRun => {
                for speed in [WALK_MPS, RUN_MPS, WALK_MPS] {
                    hold(4.0, speed, 0.0);
                }
            }
            Self::FigureEight => {
                // In steps of a tenth of a second: a whole turn to the left in 9 s, then one to the
                // right.
                for part in 0..180_u32 {
                    let share = f64::from(part % 90) / 90.0;
                    hold(0.1, WALK_MPS, if part < 90 { share * TAU } else { -share * TAU });
                }
            }
        }
        recording
    }
}
