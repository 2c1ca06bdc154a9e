//! Parameters of synthesised motions.

use crate::clip::ClipError;
use crate::skeleton::SkeletonError;

/// The action of a synthesised motion.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Action {
    /// Walks at a steady speed, straight or along a circle. Loops.
    #[default]
    Walk,
    /// Runs at a steady speed, straight or along a circle. Loops.
    Run,
    /// Stands, breathes, and shifts its weight a little. Loops.
    Idle,
    /// Stands, shifts its weight, and walks off.
    Start,
    /// Walks, slows down, and stands with its feet side by side.
    Stop,
    /// Turns on the spot in a few steps by [`Params::spin_degrees`].
    Spin,
    /// Crouches, jumps, lands, and stands up; forward at [`Params::speed_mps`].
    Jump,
}

impl Action {
    /// All actions, in the order in which a menu lists them.
    pub const ALL: [Self; 7] =
        [Self::Walk, Self::Run, Self::Idle, Self::Start, Self::Stop, Self::Spin, Self::Jump];
}

/// Parameters of style, each from 0 to 2; 1 is natural.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Style {
    /// Factor on the rise and fall of the body.
    pub bounce: f32,
    /// Factor on the swing of the arms.
    pub arm_swing: f32,
    /// Factor on the distance between the feet.
    pub stance_width: f32,
    /// Factor on the rotation of hips and shoulders, and on the lift of the feet.
    pub energy: f32,
    /// Factor on the forward lean of the trunk, and on the lean into curves.
    pub lean: f32,
}

impl Default for Style {
    fn default() -> Self {
        Self { bounce: 1.0, arm_swing: 1.0, stance_width: 1.0, energy: 1.0, lean: 1.0 }
    }
}

/// The parameters of a synthesised motion: the same parameters give the same clip, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Params {
    /// The action.
    pub action: Action,
    /// Speed over the ground, metres per second. Ignored by [`Action::Idle`] and [`Action::Spin`].
    pub speed_mps: f32,
    /// Turn rate of the path, degrees per second, positive to the left. Ignored by
    /// [`Action::Idle`], [`Action::Spin`] and [`Action::Jump`].
    pub turn_rate_dps: f32,
    /// Angle of [`Action::Spin`], degrees, positive to the left.
    pub spin_degrees: f32,
    /// Body height, metres.
    pub height_m: f32,
    /// Style.
    pub style: Style,
    /// Number of the person: 0 is perfectly regular and symmetric, any other number differs
    /// slightly in posture and between left and right.
    pub seed: u32,
    /// Requested duration, seconds. Walks and runs have the nearest number of whole cycles, at
    /// least one.
    pub duration_secs: f32,
    /// Frames per second.
    pub fps: f32,
}

impl Default for Params {
    fn default() -> Self {
        Self::new(Action::Walk)
    }
}

impl Params {
    /// Returns natural parameters of an action.
    #[must_use]
    pub fn new(action: Action) -> Self {
        let (speed_mps, duration_secs) = match action {
            Action::Walk => (1.4, 3.2),
            Action::Run => (3.5, 2.9),
            Action::Idle => (0.0, 6.0),
            Action::Start => (1.4, 3.6),
            Action::Stop => (1.4, 4.0),
            Action::Spin => (0.0, 3.4),
            Action::Jump => (0.6, 3.0),
        };
        Self {
            action,
            speed_mps,
            turn_rate_dps: 0.0,
            spin_degrees: 180.0,
            height_m: 1.75,
            style: Style::default(),
            seed: 0,
            duration_secs,
            fps: 60.0,
        }
    }

    /// Returns the range of speeds of an action, metres per second; `None` where it has none.
    #[must_use]
    pub const fn speed_range(action: Action) -> Option<(f32, f32)> {
        match action {
            Action::Walk | Action::Start | Action::Stop => Some((0.4, 2.2)),
            Action::Run => Some((1.8, 6.5)),
            Action::Jump => Some((0.0, 2.5)),
            Action::Idle | Action::Spin => None,
        }
    }

    /// Returns the range of durations of an action, seconds.
    #[must_use]
    pub const fn duration_range(action: Action) -> (f32, f32) {
        match action {
            Action::Walk | Action::Run | Action::Idle => (0.5, 60.0),
            Action::Start | Action::Stop | Action::Spin | Action::Jump => (2.5, 60.0),
        }
    }

    /// Checks that every parameter lies in its range.
    ///
    /// # Errors
    /// [`SynthError::OutOfRange`] for the first one that does not, or is not a number.
    pub fn validate(&self) -> Result<(), SynthError> {
        let check = |what, value: f32, min, max, unit| {
            // NaN is in no range.
            if (min..=max).contains(&value) {
                Ok(())
            } else {
                Err(SynthError::OutOfRange { what, value, min, max, unit })
            }
        };
        if let Some((min, max)) = Self::speed_range(self.action) {
            check("speed", self.speed_mps, min, max, " m/s")?;
        }
        if matches!(self.action, Action::Walk | Action::Run | Action::Start | Action::Stop) {
            check("turn rate", self.turn_rate_dps, -120.0, 120.0, "°/s")?;
        }
        if self.action == Action::Spin {
            check("spin", self.spin_degrees, -360.0, 360.0, "°")?;
        }
        let (shortest, longest) = Self::duration_range(self.action);
        check("height", self.height_m, 1.0, 2.2, " m")?;
        check("duration", self.duration_secs, shortest, longest, " s")?;
        check("frame rate", self.fps, 10.0, 240.0, " frames per second")?;
        check("bounce", self.style.bounce, 0.0, 2.0, "")?;
        check("arm swing", self.style.arm_swing, 0.0, 2.0, "")?;
        check("stance width", self.style.stance_width, 0.0, 2.0, "")?;
        check("energy", self.style.energy, 0.0, 2.0, "")?;
        check("lean", self.style.lean, 0.0, 2.0, "")
    }
}

/// Error synthesising a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum SynthError {
    /// A parameter outside its range, or not a number.
    #[error("{what} {value}{unit} cannot be made: choose between {min} and {max}{unit}")]
    OutOfRange {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f32,
        /// The smallest valid value.
        min: f32,
        /// The greatest valid value.
        max: f32,
        /// Unit of the three numbers, with a space before it where needed.
        unit: &'static str,
    },
    /// The frames do not make a clip; a defect of this module.
    #[error("the made motion is not a clip: {0}")]
    Clip(#[from] ClipError),
    /// The joints do not make a skeleton; a defect of this module.
    #[error("the made body is not a skeleton: {0}")]
    Skeleton(#[from] SkeletonError),
}

/// A built-in motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// A short, stable id that is fit for a URL.
    pub id: &'static str,
    /// The title in menus.
    pub title: &'static str,
    /// The argument of [`super::synthesize`].
    pub params: Params,
}

/// Returns the built-in motions.
#[must_use]
pub fn presets() -> Vec<Preset> {
    let of = |id, title, action, speed_mps: Option<f32>, turn_rate_dps| {
        let natural = Params::new(action);
        let params =
            Params { speed_mps: speed_mps.unwrap_or(natural.speed_mps), turn_rate_dps, ..natural };
        Preset { id, title, params }
    };
    vec![
        of("walk", "Walk", Action::Walk, None, 0.0),
        of("run", "Run", Action::Run, None, 0.0),
        of("walk_left", "Walk, turn left", Action::Walk, Some(1.2), 30.0),
        of("walk_right", "Walk, turn right", Action::Walk, Some(1.2), -30.0),
        of("run_left", "Run, turn left", Action::Run, Some(3.2), 45.0),
        of("start", "Start walking", Action::Start, None, 0.0),
        of("stop", "Stop walking", Action::Stop, None, 0.0),
        of("idle", "Stand", Action::Idle, None, 0.0),
        of("spin", "Turn around", Action::Spin, None, 0.0),
        of("jump", "Jump", Action::Jump, None, 0.0),
        of("slow_walk", "Slow walk", Action::Walk, Some(0.8), 0.0),
        of("fast_walk", "Fast walk", Action::Walk, Some(1.9), 0.0),
    ]
}
