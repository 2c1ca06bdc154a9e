use super::tags::{TagFilter, TagSet};
use glam::DVec2;
use std::f64::consts::TAU;

/// Steps of a velocity, metres per second, and of a facing, parts of a turn. A stick trembles by
/// less.
const SPEED_STEP: f64 = 0.05;
const TURN_STEPS: f64 = 256.0;
/// The fastest that can be asked for in x or z, metres per second.
const MAX_MPS: f64 = 12.0;

/// What the player asks for at one moment, in the world: already relative to the camera, already at
/// the gait's speed.
///
/// Rounded to 5 cm/s and to 1/256 of a turn, so that what was recorded and written down is what was
/// played.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Control {
    /// (x, z) in steps of 5 cm/s.
    velocity: [i16; 2],
    /// In 1/256 of a turn; `None` faces where it goes.
    facing: Option<u8>,
    filter: TagFilter,
}

impl Control {
    /// Asks for a velocity over the ground ((x, z), metres per second) and, to strafe, a yaw to
    /// face (radians about +Y, 0 is +Z). What is no number is 0.
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

    /// The same with tags that are asked for and forbidden.
    #[must_use]
    pub fn with_filter(mut self, filter: TagFilter) -> Self {
        self.filter = filter;
        self
    }

    /// The velocity, (x, z) in metres per second.
    #[must_use]
    pub fn velocity(&self) -> DVec2 {
        DVec2::new(f64::from(self.velocity[0]), f64::from(self.velocity[1])) * SPEED_STEP
    }

    /// Whether it asks to stand still.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.velocity == [0, 0]
    }

    /// The yaw to face, radians from 0 to 2π; `None` faces where it goes.
    #[must_use]
    pub fn facing(&self) -> Option<f64> {
        self.facing.map(|steps| f64::from(steps) / TURN_STEPS * TAU)
    }

    /// Which frames may be found.
    #[must_use]
    pub fn filter(&self) -> TagFilter {
        self.filter
    }
}

/// Input over time: what was asked for in every tick of a controller. Playing it again gives the
/// same motion, bit for bit.
///
/// As text it is made of letters that a link needs not escape: stretches joined by `_`, each
/// `ticks.x.z`, then `.f` and the facing where there is one, `.a` and `.n` and the tags asked for
/// and forbidden; numbers in base 36.
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
    stretches: Vec<(Control, u32)>,
    ticks: u32,
}

/// Why a text is no recording.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordingError {
    /// A stretch that cannot be read.
    #[error("part {part} of the recorded input, `{found}`, is not of the form ticks.x.z")]
    Part {
        /// Its number, from 1.
        part: usize,
        /// Its text, at most 40 letters.
        found: String,
    },
    /// Longer than any recording.
    #[error("the recorded input is longer than {} minutes", Recording::MAX_TICKS / 3_600)]
    TooLong,
}

impl Recording {
    /// The longest recording, ticks of 1/60 s: half an hour.
    pub const MAX_TICKS: u32 = 108_000;

    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// One more tick. `false` when the recording is full.
    pub fn push(&mut self, control: Control) -> bool {
        self.hold(control, 1)
    }

    /// The same input for some ticks. `false`, and nothing is added, when that is longer than
    /// [`Self::MAX_TICKS`].
    pub fn hold(&mut self, control: Control, ticks: u32) -> bool {
        if ticks > Self::MAX_TICKS - self.ticks {
            return false;
        }
        self.ticks += ticks;
        match self.stretches.last_mut() {
            _ if ticks == 0 => {}
            Some((last, count)) if *last == control => *count += ticks,
            _ => self.stretches.push((control, ticks)),
        }
        true
    }

    /// Ticks.
    #[must_use]
    pub fn ticks(&self) -> usize {
        self.ticks as usize
    }

    /// The input of every tick.
    pub fn controls(&self) -> impl Iterator<Item = Control> + '_ {
        self.stretches
            .iter()
            .flat_map(|&(control, ticks)| std::iter::repeat_n(control, ticks as usize))
    }

    /// The input of one tick.
    #[must_use]
    pub fn control(&self, tick: usize) -> Option<Control> {
        let mut end = 0;
        let stretch = self.stretches.iter().find(|(_, ticks)| {
            end += *ticks as usize;
            tick < end
        });
        stretch.map(|(control, _)| *control)
    }

    /// As text for a link.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for (control, ticks) in &self.stretches {
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

    /// Reads what [`Self::to_text`] wrote.
    ///
    /// # Errors
    /// [`RecordingError`] when a part is not of that form, or the recording is too long.
    pub fn from_text(text: &str) -> Result<Self, RecordingError> {
        let mut recording = Self::new();
        for (index, part) in text.split('_').enumerate().filter(|_| !text.is_empty()) {
            let (control, ticks) = stretch(part).ok_or_else(|| RecordingError::Part {
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

fn stretch(text: &str) -> Option<(Control, u32)> {
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
    // Writing to a text does not fail.
    text.extend(digits.iter().rev());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::Tag;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_written_is_read(parts in prop::collection::vec((-240i16..=240, -240i16..=240, prop::option::of(0u8..), 0u32..99, 0u32..1 << 31), 0..9)) {
            let mut recording = Recording::new();
            for (x, z, facing, ticks, ask) in parts {
                let control = Control { velocity: [x, z], facing, filter: TagFilter { ask: TagSet(ask & 31), forbid: TagSet(ask >> 5) } };
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
        fn any_text_is_read_or_refused(text in "[-0-9a-z._]{0,40}") {
            if let Ok(recording) = Recording::from_text(&text) {
                prop_assert!(recording.ticks() <= Recording::MAX_TICKS as usize);
            }
        }
    }

    #[test]
    fn numbers_are_rounded_and_held_within_bounds() {
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
