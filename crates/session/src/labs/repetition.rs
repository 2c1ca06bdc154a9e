//! Repetition of a cycle, as shown by the Speed and the Loop lab.

use super::feet::{Lock, slide, slide_before, with_feet};
use crate::labs::LabError;
use crate::metrics::Metric;
use segue_motion::clip::{Clip, Contacts, Motion, character_frames};
use segue_motion::metrics::{Extreme, worst_foot_slide};
use segue_motion::skeleton::Roles;
use segue_motion::transition::repeat_clip;
use std::sync::Arc;

/// The least duration of the repeated cycles, seconds.
const SHOWN_SECS: f64 = 6.0;

/// Several repetitions of a cycle, and the slide of their feet.
pub(super) struct Repetition {
    /// Whole cycles and one more frame, which has the pose of the first.
    pub(super) motion: Motion,
    /// The foot slide, with the foot lock and without it.
    pub(super) slides: Vec<Metric>,
}

/// Repeats a cycle of `cycle_frames` several times.
///
/// `three` are three cycles and one more frame, with the contacts of the feet. The middle cycle is
/// repeated: a stance that the end of a clip cuts in two would be locked at another position than
/// the same stance in full. `ground_m` is the height of the ground.
pub(super) fn repeat_cycle(
    roles: &Roles,
    cycle_frames: usize,
    three: Clip,
    contacts: &Contacts,
    ground_m: f32,
    lock: Option<Lock>,
) -> Result<Repetition, LabError> {
    let fps = three.fps();
    let count = (SHOWN_SECS * fps / cycle_frames as f64).ceil().clamp(2.0, 12.0) as usize;
    let stands = character_frames(&three, roles);
    let (Some(first), Some(second)) = (stands.first(), stands.get(cycle_frames)) else {
        return Err(LabError::EmptyCycle);
    };
    let cycle = second.after(&first.inverse());
    let three = Arc::new(three);
    // A frame of any of the three cycles is shown in the first one.
    let slid = |clip: &Clip| -> Option<Extreme> {
        let worst = worst_foot_slide(clip, roles, contacts)?;
        Some(Extreme { frame: worst.frame % cycle_frames.max(1), ..worst })
    };
    let free = slid(&three);
    let held = with_feet(&three, roles, contacts, ground_m, lock)?;
    let slides = if lock.is_some() {
        vec![slide(slid(&held), fps), slide_before(free)]
    } else {
        vec![slide(free, fps)]
    };
    let middle = held.crop(cycle_frames..2 * cycle_frames)?;
    let frames = count * cycle_frames + 1;
    let clip = repeat_clip(&middle.transformed(&cycle.inverse()), &cycle, count + 1)
        .and_then(|clip| clip.crop(0..frames))?;
    Ok(Repetition {
        motion: Motion::with_roles(clip, roles)
            .with_contacts(repeated(contacts, &(cycle_frames..2 * cycle_frames), frames))
            .with_ground_m(ground_m),
        slides,
    })
}

/// Returns the contacts of `frames` frames that repeat a part of a clip.
pub(super) fn repeated(
    contacts: &Contacts,
    cycle: &std::ops::Range<usize>,
    frames: usize,
) -> Contacts {
    Contacts::of_feet(contacts.feet(), |foot| {
        (0..frames)
            .map(|frame| contacts.planted(foot, cycle.start + frame % cycle.len().max(1)))
            .collect()
    })
}
