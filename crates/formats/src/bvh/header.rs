//! The head of the MOTION section: number of rows and frame time.

use super::hierarchy::starts_motion_header;
use super::lexer::{Lexer, Stop};
use super::number::{Scan, scan, token_end};
use crate::text::{is_space, short};
use crate::warning::WarningKind;

/// Frame rate if the file has none, frames per second.
pub(super) const DEFAULT_FPS: f64 = 30.0;

/// Frame times are snapped to 1/N within this relative distance, which includes the rounding of
/// `.03333`.
const SNAP: f64 = 1.0001e-4;

/// The content of the header.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Header {
    /// Whether there is a MOTION section.
    pub(super) present: bool,
    /// `Frames:`, as written, and its place.
    pub(super) frames: Option<(String, usize)>,
    /// `Frame Time:`, as written and as a number, and its place.
    pub(super) frame_time: Option<(String, Option<f64>, usize)>,
}

impl Header {
    /// Returns the declared number of frames. Never used for allocation.
    pub(super) fn declared_frames(&self) -> Option<f64> {
        self.frames.as_ref().and_then(|(text, _)| fast_float2::parse(text).ok())
    }

    /// Returns the frame rate, always above 0; oddities are added to the tally.
    pub(super) fn fps(&self, lexer: &mut Lexer<'_>) -> f64 {
        match &self.frame_time {
            Some((_, Some(secs), at))
                if *secs > 0.0 && secs.is_finite() && secs.recip().is_finite() =>
            {
                if !(1e-4..=1.0).contains(secs) {
                    lexer.tally.add(WarningKind::UnlikelyFrameTime { secs: *secs }, Some(*at));
                }
                snapped(*secs)
            }
            Some((text, _, at)) => {
                lexer.tally.add(WarningKind::FrameTime { found: Some(text.clone()) }, Some(*at));
                DEFAULT_FPS
            }
            None => {
                lexer.tally.add(WarningKind::FrameTime { found: None }, None);
                DEFAULT_FPS
            }
        }
    }
}

/// Returns 1/`secs`, or the nearest integer where the difference is the rounding of the file.
/// 23.976 and 119.88 stay.
fn snapped(secs: f64) -> f64 {
    let whole = secs.recip().round();
    if (whole * secs - 1.0).abs() <= SNAP { whole } else { secs.recip() }
}

/// Reads `MOTION`, `Frames` and `Frame Time` with or without colons and spaces, in any order; each
/// may be missing.
pub(super) fn header(lexer: &mut Lexer<'_>) -> Result<Header, Stop> {
    let mut header = Header::default();
    loop {
        let token = lexer.peek();
        let at = lexer.at;
        if token.eq_ignore_ascii_case(b"MOTION") {
            lexer.at += token.len();
        } else if !starts_motion_header(token) {
            header.present |= !token.is_empty();
            return Ok(header);
        } else if let Some(after) = keyword(lexer.text, at, b"frames") {
            lexer.at = after;
            let value = value(lexer);
            header.frames = Some((short(value), at));
        } else if let Some(after) = keyword(lexer.text, at, b"frame")
            .and_then(|after| keyword(lexer.text, past_blanks(lexer.text, after), b"time"))
        {
            lexer.at = after;
            header.frame_time = frame_time(lexer, at)?;
        } else {
            return Err(lexer.unexpected("`Frames:` or `Frame Time:`").into());
        }
        header.present = true;
    }
}

/// Returns the offset after a keyword, in any case.
fn keyword(text: &[u8], at: usize, word: &[u8]) -> Option<usize> {
    let end = at.checked_add(word.len())?;
    text.get(at..end).filter(|found| found.eq_ignore_ascii_case(word)).map(|_| end)
}

fn past_blanks(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(|&b| is_space(b) && b != b'\n' && b != b'\r') {
        at += 1;
    }
    at
}

/// Skips the colon; stays on the line, since the next line is data.
fn to_value(lexer: &mut Lexer<'_>) {
    lexer.at = past_blanks(lexer.text, lexer.at);
    if lexer.text.get(lexer.at) == Some(&b':') {
        lexer.at = past_blanks(lexer.text, lexer.at + 1);
    }
}

/// Returns the token after the colon, if there is one on the line.
fn value<'a>(lexer: &mut Lexer<'a>) -> &'a [u8] {
    to_value(lexer);
    let end = token_end(lexer.text, lexer.at);
    let value = lexer.text.get(lexer.at..end).unwrap_or_default();
    lexer.at = end;
    value
}

fn frame_time(
    lexer: &mut Lexer<'_>,
    at: usize,
) -> Result<Option<(String, Option<f64>, usize)>, Stop> {
    to_value(lexer);
    let start = lexer.at;
    let secs = match scan(lexer.text, start, lexer.commas) {
        Scan::Value { value, .. } => Some(value),
        // `Frame Time: 0` has no digits after the comma to show which sign it is; it is not a time
        // either way.
        Scan::OtherDecimalSign
            if !matches!(
                lexer.text.get(start..token_end(lexer.text, start)),
                Some(b"0" | b"1")
            ) =>
        {
            return Err(lexer.other_decimal_sign());
        }
        _ => None,
    };
    let text = value(lexer);
    Ok((!text.is_empty()).then(|| (short(text), secs, at)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Header, usize) {
        let mut lexer = Lexer::new(text.as_bytes(), false);
        let header = header(&mut lexer).unwrap();
        (header, lexer.at)
    }

    #[test]
    fn header_in_any_layout_is_read() {
        let spellings = [
            "MOTION\nFrames: 4\nFrame Time: .5\n",
            "motion Frames:4 FrameTime:.5 ",
            "MOTION\nFRAMES : 4\nFrame  \tTime : .5\n",
            "MOTION\nframe time .5\nframes 4\n",
            "Frames 4\nFrame Time:.5\n",
        ];
        for text in spellings {
            let (header, at) = read(&format!("{text}9 9"));
            assert_eq!(header.declared_frames(), Some(4.0), "{text}");
            assert_eq!(header.frame_time.and_then(|(_, secs, _)| secs), Some(0.5), "{text}");
            assert_eq!(&format!("{text}9 9")[at..], "9 9");
        }
    }

    #[test]
    fn header_without_a_value_leaves_the_next_line() {
        let (header, at) = read("MOTION\nFrames:\nFrame Time:\n1 2 3");
        assert_eq!((header.declared_frames(), header.frame_time, at), (None, None, 27));
        assert!(!read("").0.present);
        assert!(read("MOTION").0.present);
    }

    #[test]
    fn fps_of_a_rounded_frame_time_is_an_integer() {
        for (secs, fps) in [
            (0.008_333_3, 120.0),
            (0.03333, 30.0),
            (0.041_666_7, 24.0),
            (0.016_667, 60.0),
            (0.01, 100.0),
            (0.033_333_3, 30.0),
        ] {
            assert_eq!(snapped(secs), fps, "{secs}");
        }
        for fps in [23.976, 24_000.0 / 1001.0, 119.88, 29.97, 59.94, 12.5] {
            assert!((snapped(1.0 / fps) - fps).abs() < 1e-9, "{fps}");
        }
    }

    #[test]
    fn fps_without_a_frame_time_is_the_default() {
        for text in ["0", "-0.03", "nan", "abc", "1e400", "1e-320"] {
            let text = format!("MOTION\nFrame Time: {text}\n");
            let mut lexer = Lexer::new(text.as_bytes(), false);
            let header = header(&mut lexer).unwrap();
            assert_eq!(header.fps(&mut lexer), 30.0, "{text}");
            assert_eq!(lexer.tally.into_warnings(b"").len(), 1, "{text}");
        }
        let mut lexer = Lexer::new(b"MOTION\nFrame Time: 33.3\n", false);
        let header = header(&mut lexer).unwrap();
        assert!((header.fps(&mut lexer) - 0.03003).abs() < 1e-5);
        assert!(lexer.tally.into_warnings(b"")[0].to_string().contains("unlikely"));
    }
}
