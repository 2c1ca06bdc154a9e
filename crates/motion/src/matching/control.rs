//! The player's input, and recordings of it.

use super::tags::{TagFilter, TagSet};
use glam::DVec2;
use std::f64::consts::TAU;

/// Rounding steps of a velocity, metres per second, and of a facing, parts of a turn; an idle stick
/// varies by less.
const SPEED_STEP: f64 = 0.05;
const TURN_STEPS: f64 = 256.0;
/// The greatest velocity in x or z, metres per second.
const MAX_MPS: f64 = 12.0;

/// The player's input at one moment, in the world: already relative to the camera, and at the
/// gait's speed.
///
/// It is rounded to 5 cm/s and to 1/256 of a turn, so that a recording replays exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Control {
    /// (x, z) in steps of 5 cm/s.
    velocity: [i16; 2],
    /// In 1/256 of a turn; `None` to face the direction of travel.
    facing: Option<u8>,
    filter: TagFilter,
}

impl Control {
    /// Returns the input for a velocity over the ground ((x, z), metres per second) and, for
    /// strafing, a yaw to face (radians about +Y, 0 is +Z). Values that are not finite count as 0.
    #[must_use]
    pub fn new(velocity_mps: DVec2, facing_yaw: Option<f64>) -> Self {
        // A cast from NaN gives 0.
        let step = |speed: f64| (speed.clamp(-MAX_MPS, MAX_MPS) / SPEED_STEP).round() as i16;
        Self {
            velocity: [step(velocity_mps.x), step(velocity_mps.y)],
            facing: facing_yaw
                .map(|yaw| (yaw / TAU * TURN_STEPS).round().rem_euclid(TURN_STEPS) as u8),
            filter: TagFilter::default(),
        }
    }

    /// Returns the input with required and forbidden tags.
    #[must_use]
    pub fn with_filter(mut self, filter: TagFilter) -> Self {
        self.filter = filter;
        self
    }

    /// Returns the velocity, (x, z) in metres per second.
    #[must_use]
    pub fn velocity(&self) -> DVec2 {
        DVec2::new(f64::from(self.velocity[0]), f64::from(self.velocity[1])) * SPEED_STEP
    }

    /// Returns whether the input is to stand still.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.velocity == [0, 0]
    }

    /// Returns the yaw to face, radians from 0 to 2π; `None` to face the direction of travel.
    #[must_use]
    pub fn facing(&self) -> Option<f64> {
        self.facing.map(|steps| f64::from(steps) / TURN_STEPS * TAU)
    }

    /// Returns the filter of frames.
    #[must_use]
    pub fn filter(&self) -> TagFilter {
        self.filter
    }
}

/// Input over time: one [`Control`] for every tick of a controller. Replayed, it gives the same
/// motion, bit for bit.
///
/// Its text form uses only characters that a link need not escape: runs of equal input joined by
/// `_`, each `ticks.x.z`, then `.f` and the facing if there is one, `.a` and `.n` and the required
/// and forbidden tags; numbers in base 36.
///
/// ```
/// use segue_motion::matching::{Control, Recording};
/// use glam::DVec2;
///
/// let mut drive = Recording::new();
/// drive.hold(Control::new(DVec2::new(0.0, 1.4), None), 120);
/// drive.hold(Control::default(), 60);
/// assert_eq!(drive.to_text(), "3c.0.s_1o.0.0");
/// assert_eq!(Recording::from_text(&drive.to_text())?, drive);
/// # Ok::<(), segue_motion::matching::RecordingError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recording {
    runs: Vec<(Control, u32)>,
    ticks: u32,
}

/// Error reading a recording.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum RecordingError {
    /// A run that cannot be read.
    #[error("part {part} of the recorded input, `{found}`, is not of the form ticks.x.z")]
    Part {
        /// Its number, from 1.
        part: usize,
        /// Its text, at most 40 letters.
        found: String,
    },
    /// The recording is longer than [`Recording::MAX_TICKS`].
    #[error(
        "the recorded input is longer than {minutes} minutes",
        minutes = Recording::MAX_TICKS / 3_600
    )]
    TooLong,
}

impl Recording {
    /// The greatest length of a recording, ticks of 1/60 s: half an hour.
    pub const MAX_TICKS: u32 = 108_000;

    /// Returns an empty recording.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Appends one tick. Returns `false` when the recording is full.
    pub fn push(&mut self, control: Control) -> bool {
        self.hold(control, 1)
    }

    /// Appends the same input for some ticks. Returns `false`, and appends nothing, when the
    /// recording would exceed [`Self::MAX_TICKS`].
    pub fn hold(&mut self, control: Control, ticks: u32) -> bool {
        if ticks > Self::MAX_TICKS - self.ticks {
            return false;
        }
        self.ticks += ticks;
        match self.runs.last_mut() {
            _ if ticks == 0 => {}
            Some((last, count)) if *last == control => *count += ticks,
            _ => self.runs.push((control, ticks)),
        }
        true
    }

    /// Returns the number of ticks.
    #[must_use]
    pub fn ticks(&self) -> usize {
        self.ticks as usize
    }

    /// Returns the input of every tick.
    pub fn controls(&self) -> impl Iterator<Item = Control> + '_ {
        self.runs.iter().flat_map(|&(control, ticks)| std::iter::repeat_n(control, ticks as usize))
    }

    /// Returns the input of one tick.
    #[must_use]
    pub fn control(&self, tick: usize) -> Option<Control> {
        let mut end = 0;
        let run = self.runs.iter().find(|(_, ticks)| {
            end += *ticks as usize;
            tick < end
        });
        run.map(|(control, _)| *control)
    }

    /// Returns the text form, for links.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (control, ticks) in &self.runs {
            if !text.is_empty() {
                text.push('_');
            }
            base_36(&mut text, i64::from(*ticks));
            for part in control.velocity {
                text.push('.');
                base_36(&mut text, i64::from(part));
            }
            let tags = |set: TagSet| (set != TagSet::NONE).then_some(i64::from(set.0));
            let more = [
                ('f', control.facing.map(i64::from)),
                ('a', tags(control.filter.ask)),
                ('n', tags(control.filter.forbid)),
            ];
            for (key, value) in more {
                if let Some(value) = value {
                    text.push('.');
                    text.push(key);
                    base_36(&mut text, value);
                }
            }
        }
        text
    }

    /// Parses the text form of [`Self::to_text`].
    ///
    /// # Errors
    /// [`RecordingError`] when a part is not of that form, or the recording is too long.
    pub fn from_text(text: &str) -> Result<Self, RecordingError> {
        let mut recording = Self::new();
        for (index, part) in text.split('_').enumerate().filter(|_| !text.is_empty()) {
            let (control, ticks) = parse_run(part).ok_or_else(|| RecordingError::Part {
                part: index + 1,
                found: part.chars().take(40).collect(),
            })?;
            if !recording.hold(control, ticks) {
                return Err(RecordingError::TooLong);
            }
        }
        Ok(recording)
    }
}

fn parse_run(text: &str) -> Option<(Control, u32)> {
    let mut parts = text.split('.');
    let mut number = || i64::from_str_radix(parts.next()?, 36).ok();
    let ticks = u32::try_from(number()?).ok()?;
    let most = (MAX_MPS / SPEED_STEP) as i64;
    let mut velocity = || number().filter(|step| step.abs() <= most).map(|step| step as i16);
    let mut control = Control { velocity: [velocity()?, velocity()?], ..Control::default() };
    for part in parts {
        let value = i64::from_str_radix(part.get(1..)?, 36).ok()?;
        match part.get(..1)? {
            "f" => control.facing = Some(u8::try_from(value).ok()?),
            "a" => control.filter.ask = TagSet(u32::try_from(value).ok()?),
            "n" => control.filter.forbid = TagSet(u32::try_from(value).ok()?),
            _ => return None,
        }
    }
    Some((control, ticks))
}

fn base_36(text: &mut String, value: i64) {
    if value < 0 {
        text.push('-');
    }
    let mut digits = Vec::new();
    let mut left = value.unsigned_abs();
    loop {
        digits.push(char::from_digit((left % 36) as u32, 36).unwrap_or('0'));
        left /= 36;
        if left == 0 {
            break;
        }
    }
    // Writing to a string does not fail.
    text.extend(digits.iter().rev());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::Tag;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn recording_to_text_and_back_is_equal(
            parts in prop::collection::vec(
                (-240i16..=240, -240i16..=240, prop::option::of(0u8..), 0u32..99, 0u32..1 << 31),
                0..9,
            ),
        ) {
            let mut recording = Recording::new();
            for (x, z, facing, ticks, ask) in parts {
                let control = Control {
                    velocity: [x, z],
                    facing,
                    filter: TagFilter { ask: TagSet(ask & 31), forbid: TagSet(ask >> 5) },
                };
                recording.hold(control, ticks);
            }
            let again = Recording::from_text(&recording.to_text()).unwrap();
            prop_assert_eq!(&again, &recording);
            prop_assert_eq!(again.controls().count(), recording.ticks());
            for (tick, control) in again.controls().enumerate() {
                prop_assert_eq!(recording.control(tick), Some(control));
            }
            prop_assert_eq!(recording.control(recording.ticks()), None);
        }

        #[test]
        fn recording_from_any_text_does_not_panic(text in "[-0-9a-z._]{0,40}") {
            if let Ok(recording) = Recording::from_text(&text) {
                prop_assert!(recording.ticks() <= Recording::MAX_TICKS as usize);
            }
        }
    }

    #[test]
    fn control_is_rounded_and_clamped() {
        let control = Control::new(DVec2::new(1.42, f64::NAN), Some(-0.01));
        assert!((control.velocity() - DVec2::new(1.4, 0.0)).length() < 1e-12);
        assert_eq!(control.facing(), Some(0.0));
        assert_eq!(
            Control::new(DVec2::splat(f64::INFINITY), Some(f64::NAN)).velocity(),
            DVec2::splat(12.0)
        );
        let walk = Control::default()
            .with_filter(TagFilter { ask: TagSet::of(&[Tag::Walk]), forbid: TagSet::NONE });
        let mut recording = Recording::new();
        assert!(recording.push(walk) && recording.to_text() == "1.0.0.a1");
        assert!(!recording.hold(walk, Recording::MAX_TICKS));
        for wrong in ["x", "1.0", "1.0.99999", "1.0.0.q3", "-1.0.0", "1.0.0.f", "1.0.0.é"] {
            assert!(
                matches!(Recording::from_text(wrong), Err(RecordingError::Part { part: 1, .. })),
                "{wrong}"
            );
        }
        assert_eq!(Recording::from_text("zzzzz.0.0"), Err(RecordingError::TooLong));
        assert_eq!(Recording::from_text(""), Ok(Recording::new()));
    }
}
