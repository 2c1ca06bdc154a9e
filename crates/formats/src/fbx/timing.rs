//! The frames of a take: their rate, and the times of the first and the last.

use crate::gltf::rate::{Rate, rate};
use segue_fbx::Take;
use std::ops::Range;

/// The span that old exporters give every take, seconds.
const DEFAULT_SPAN: Range<f64> = 0.0..1.0;

/// Returns the rate, the start and the number of frames of a take, and the seconds of its keys that
/// lie outside of its span and are left out.
///
/// The rate is that of the file if every key is on one of its frames, or else that of the keys; a
/// file at 24 frames per second with keys at 120 is motion capture in a scene that nobody set up.
/// The frames are those with keys, as far as they lie in the span of the take.
pub(super) fn frames(take: &Take, file_fps: f64, given: Option<f64>) -> (Rate, f64) {
    let keys = &take.key_secs;
    let (Some(&first), Some(&last)) = (keys.first(), keys.last()) else {
        let start = take.span_secs.as_ref().map_or(0.0, |span| span.start);
        let fps = given.unwrap_or(file_fps);
        return (Rate { fps, start_secs: start, frames: 1.0, holds_keys: true }, 0.0);
    };
    let stated = (file_fps.is_finite() && file_fps > 0.0).then_some(file_fps);
    let of_file = stated.map(|fps| rate(keys.clone(), Some(fps))).filter(|rate| rate.holds_keys);
    let found = match given {
        Some(fps) => rate(keys.clone(), Some(fps)),
        None => of_file.unwrap_or_else(|| {
            let of_keys = rate(keys.clone(), None);
            // A few keys between the frames of the file say nothing about a rate.
            let is_dense = keys.len() as f64 > 0.5 * of_keys.frames;
            match stated {
                Some(fps) if !is_dense => rate(keys.clone(), Some(fps)),
                _ => of_keys,
            }
        }),
    };
    let frame = 1.0 / found.fps;
    let span = take.span_secs.clone().filter(|span| *span != DEFAULT_SPAN);
    let cut = span.map(|span| span.start.max(first)..span.end.min(last));
    let cut = cut.filter(|cut| cut.end - cut.start > 1.5 * frame);
    let Some(cut) = cut else { return (found, 0.0) };
    let outside = (cut.start - first).max(0.0) + (last - cut.end).max(0.0);
    if outside < 0.5 * frame {
        return (found, 0.0);
    }
    let frames = ((cut.end - cut.start) * found.fps).round() + 1.0;
    (Rate { start_secs: cut.start, frames, ..found }, outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(keys: impl IntoIterator<Item = f64>, span: Option<Range<f64>>) -> Take {
        Take {
            name: String::new(),
            span_secs: span,
            key_secs: keys.into_iter().collect(),
            movements: Vec::new(),
        }
    }

    #[test]
    fn frames_of_sparse_keys_have_the_rate_of_the_file() {
        let (rate, outside) = frames(&take([0.0, 0.5, 2.0], None), 24.0, None);
        assert_eq!((rate.fps, rate.frames, outside), (24.0, 49.0, 0.0));
        assert_eq!(frames(&take([0.0, 0.5, 2.0], None), 24.0, Some(60.0)).0.frames, 121.0);
        assert_eq!(frames(&take([0.0, 0.3304, 0.9914], None), 25.0, None).0.fps, 25.0);
    }

    #[test]
    fn frames_of_dense_keys_have_the_rate_of_the_keys() {
        let keys = || (0..=240).map(|key| f64::from(key) / 120.0);
        let (rate, _) = frames(&take(keys(), Some(0.0..2.0)), 24.0, None);
        assert_eq!((rate.fps, rate.frames), (120.0, 241.0));
    }

    #[test]
    fn frames_outside_of_the_span_are_left_out() {
        let keys = || (0..=100).map(|key| f64::from(key) / 25.0);
        let (rate, outside) = frames(&take(keys(), Some(1.0..3.0)), 25.0, None);
        assert_eq!((rate.start_secs, rate.frames, outside), (1.0, 51.0, 2.0));
        // A span that is longer than the motion, that every file has, or that has none of the keys.
        for span in [-1.0..9.0, DEFAULT_SPAN, 7.0..8.0] {
            let (rate, outside) = frames(&take(keys(), Some(span)), 25.0, None);
            assert_eq!((rate.start_secs, rate.frames, outside), (0.0, 101.0, 0.0));
        }
    }
}
