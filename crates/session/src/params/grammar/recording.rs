//! Recorded input: stretches of ticks and velocities.

use super::Misread;
use segue_motion::matching::Recording;

pub(super) fn read(text: &str) -> Result<Option<Recording>, Misread> {
    if text.is_empty() {
        return Ok(None);
    }
    let recording = Recording::from_text(text)?;
    if recording.ticks() == 0 {
        return Err(Misread::Text {
            found: text.to_owned(),
            expected: "input of one tick or more",
        });
    }
    Ok(Some(recording))
}

#[expect(clippy::ref_option, reason = "writers of all lists take a reference to their value")]
pub(super) fn write(recording: &Option<Recording>) -> String {
    recording.as_ref().map_or_else(String::new, Recording::to_text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recording_without_ticks_is_refused() {
        assert_eq!(read(""), Ok(None));
        assert_eq!(write(&read("2.0.3_1.0.0").unwrap()), "2.0.3_1.0.0");
        for bad in ["0.0.0", "2.0.3_x", "!"] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
