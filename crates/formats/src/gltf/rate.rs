//! Inference of the frame rate of an animation from the times of its keys; the format has none.

/// The rate for keys that determine none, frames per second.
const DEFAULT_FPS: f64 = 30.0;
/// Lower rates are multiplied to come close to the default: one pose per second is not a frame
/// rate.
const MIN_FPS: f64 = 20.0;
/// Higher rates are caused by keys that happen to be close together.
const MAX_FPS: f64 = 1000.0;
/// Keys closer than this are one key, seconds.
const SAME_KEY_SECS: f64 = 1e-4;
/// Tolerance in frames within which a key is on a frame.
const ON_FRAME: f64 = 0.02;
/// The greatest number of frames between the two closest keys: keys at 0, 2 and 5 frames are still
/// recognised.
const MAX_BETWEEN: u32 = 4;

/// The time range and frame rate of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rate {
    /// Frames per second.
    pub(crate) fps: f64,
    /// The first key, seconds.
    pub(crate) start_secs: f64,
    /// The number of frames from the first key to the last; at least 1.
    pub(crate) frames: f64,
    /// Whether every key is on a frame.
    pub(crate) holds_keys: bool,
}

/// Returns the lowest rate at which every key is on a frame, an integer if possible. `keys` are the
/// times of all keys of all curves, seconds, in any order. `given` overrides the rate.
pub(crate) fn rate(mut keys: Vec<f64>, given: Option<f64>) -> Rate {
    keys.sort_by(f64::total_cmp);
    // The distance is measured from the first key of a group.
    keys.dedup_by(|key, kept| *key - *kept < SAME_KEY_SECS);
    let (start, end) = (keys.first().copied().unwrap_or(0.0), keys.last().copied().unwrap_or(0.0));
    let span = end - start;
    let holds = |fps: f64| {
        keys.iter().all(|&key| {
            let at = (key - start) * fps;
            // Late in a long animation, the rounding of seconds in single precision exceeds the
            // tolerance.
            (at - at.round()).abs() < ON_FRAME + fps * key.abs() * f64::from(f32::EPSILON)
        })
    };
    let found = given.or_else(|| {
        let nearest = keys.windows(2).map(|pair| pair[1] - pair[0]).min_by(f64::total_cmp)?;
        // If every frame has a key, their number gives the most accurate rate.
        let even = (keys.len() - 1) as f64 / span;
        let candidates = std::iter::once(even)
            .chain((1..=MAX_BETWEEN).map(|between| f64::from(between) / nearest));
        candidates
            .flat_map(|fps| [fps.round(), fps])
            .map(|fps| if fps < MIN_FPS { fps * (DEFAULT_FPS / fps).round() } else { fps })
            .find(|&fps| fps > 0.0 && fps <= MAX_FPS && holds(fps))
    });
    let fps = found.unwrap_or(DEFAULT_FPS);
    Rate { fps, start_secs: start, frames: (span * fps).round() + 1.0, holds_keys: holds(fps) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(keys: impl IntoIterator<Item = f64>) -> (f64, f64, bool) {
        let single = keys.into_iter().map(|key| f64::from(key as f32)).collect();
        let Rate { fps, frames, holds_keys, .. } = rate(single, None);
        (fps, frames, holds_keys)
    }

    #[test]
    fn rate_of_keys_on_every_frame_is_theirs() {
        for fps in [24.0, 25.0, 30.0, 60.0, 120.0, 240.0] {
            assert_eq!(found((0..5000).map(|i| f64::from(i) / fps)), (fps, 5000.0, true));
            assert_eq!(found((100..150).map(|i| f64::from(i) / fps)), (fps, 50.0, true));
        }
        let (fps, frames, holds) = found((0..5000).map(|i| f64::from(i) / 29.97));
        assert!((fps - 29.97).abs() < 1e-5 && frames == 5000.0 && holds, "{fps} {frames}");
    }

    #[test]
    fn rate_of_sparse_keys_is_the_lowest_that_holds_them() {
        assert_eq!(found([0.0, 2.0 / 24.0, 5.0 / 24.0, 12.0 / 24.0]), (24.0, 13.0, true));
        assert_eq!(found([0.0, 2.0]), (30.0, 61.0, true));
        assert_eq!(found([0.0, 0.1, 0.2]), (30.0, 7.0, true));
        assert_eq!(found([1.0, 1.0 + 1.0 / 60.0, 3.0]), (60.0, 121.0, true));
    }

    #[test]
    fn rate_of_irregular_keys_is_the_default() {
        assert_eq!(found([0.0, 0.0123, 0.5171, 0.9]), (30.0, 28.0, false));
        assert_eq!(found([]), (30.0, 1.0, true));
        assert_eq!(found([0.7]), (30.0, 1.0, true));
        assert_eq!(rate(vec![0.0, 0.5, 1.0], Some(24.0)).frames, 25.0);
    }
}
