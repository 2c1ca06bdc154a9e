//! A cycle that is played several times: what the Speed and the Loop lab show.

use super::feet::{slide, slide_before, with_feet};
use crate::clip::{Clip, Contacts, character_frames};
use crate::metrics::Metric;
use crate::session::motion::Motion;
use crate::skeleton::{Roles, Side};
use std::sync::Arc;

/// Cycles follow each other until they fill this, seconds.
const SHOWN_SECS: f64 = 6.0;

/// Several rounds of a cycle, and what their feet do.
pub(super) struct Rounds {
    /// Whole cycles and the frame behind them, which has the pose of the first.
    pub(super) motion: Motion,
    /// How far planted feet slide, and how far they would without the foot lock.
    pub(super) slides: Vec<Metric>,
}

/// Plays a cycle of `cycle_frames` several times.
///
/// `played` gives so many cycles and the frame behind them, with the contacts of the feet. Feet are locked in two cycles more, of which the first and
/// the last are cut off again: a stance that the end of a clip cuts in two would be planted elsewhere than the same stance in the middle.
pub(super) fn rounds(
    roles: &Roles,
    cycle_frames: usize,
    fps: f64,
    lock: bool,
    played: impl Fn(usize) -> Result<(Clip, Contacts), String>,
) -> Result<Rounds, String> {
    let cycle_secs = cycle_frames as f64 / fps;
    let count = (SHOWN_SECS / cycle_secs).ceil().clamp(2.0, 12.0) as usize;
    let (clip, contacts) = played(count)?;
    let ground_frames = character_frames(&clip, roles);
    let mut slides = vec![slide(&clip, roles, &contacts)];
    let mut clip = Arc::new(clip);
    if lock {
        let frames = clip.frames();
        let (longer, longer_contacts) = played(count + 2)?;
        let locked = with_feet(&Arc::new(longer), roles, &longer_contacts, true)?;
        let middle = locked
            .crop(cycle_frames..cycle_frames + frames)
            .map_err(|error| error.to_string())?;
        let back = match (ground_frames.first(), ground_frames.get(cycle_frames)) {
            (Some(first), Some(second)) => first.after(&second.inverse()),
            _ => return Err("the cycle has no frames".to_owned()),
        };
        clip = Arc::new(middle.transformed(&back));
        let before = slides[0].value;
        slides = vec![slide(&clip, roles, &contacts), slide_before(before)];
    }
    Ok(Rounds {
        motion: Motion {
            clip,
            roles: roles.clone(),
            contacts,
            ground_frames,
        },
        slides,
    })
}

/// The contacts of `frames` frames that go round in those of a part of a clip.
pub(super) fn repeated(contacts: &Contacts, cycle: &std::ops::Range<usize>, frames: usize) -> Contacts {
    let flags = |side: Side| {
        (0..frames)
            .map(|frame| contacts.planted(side, cycle.start + frame % cycle.len().max(1)))
            .collect()
    };
    Contacts::from_flags(Side::BOTH.map(flags))
}
