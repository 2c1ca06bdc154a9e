//! Clips that are declared one cycle.

use super::{LoopError, LoopOptions, WholeCycle, close_loop};
use crate::clip::Motion;

/// Closes a whole clip into one cycle and declares it ([`Motion::is_cycle`]): its last frame
/// becomes its first one again, one cycle later.
///
/// The difference between both ends is spread over the cycle ([`close_loop`]). A clip that leads
/// into its beginning without reaching it gets the frames that it lacks ([`WholeCycle`]); of any
/// other clip the last frame is the one that becomes the first. Contacts stay as they are; those of
/// added frames are those of the nearer end. A clip that is a declared cycle already stays the
/// same.
///
/// ```
/// use segue_motion::clip::Motion;
/// use segue_motion::synth::{Action, Params, synthesize};
/// use segue_motion::transition::treat_as_cycle;
///
/// let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
/// let part = treat_as_cycle(&walk.cropped(20..81)?)?;
/// assert!(part.is_cycle() && part.clip().frames() >= 61);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`LoopError::Range`] for a clip of fewer than three frames.
pub fn treat_as_cycle(source: &Motion) -> Result<Motion, LoopError> {
    if source.is_cycle() {
        return Ok(source.clone());
    }
    let options = LoopOptions::default();
    let last = source.clip().frames().saturating_sub(1);
    let looped = match WholeCycle::of(source) {
        Some(whole) => whole.close(&options)?,
        None => close_loop(source, 0..last, &options)?,
    };
    let end = looped.clip.frames();
    let clip = looped.repeat(2)?.crop(0..end + 1)?;
    let mut ground_frames = looped.frames.clone();
    ground_frames.extend(looped.frames.first().map(|first| looped.cycle.after(first)));
    // An added frame is nearer to the clip's last frame or to the next beginning.
    let place = |frame: usize| match frame {
        frame if frame == end => 0,
        frame if frame <= last => frame,
        frame if frame - last <= end - frame => last,
        _ => 0,
    };
    let order: Vec<usize> = (0..=end).map(place).collect();
    Ok(Motion::with_ground_frames(clip, source.roles(), ground_frames)
        .with_feet(source.feet())
        .with_contacts(source.contacts().of_frames(&order))
        .with_ground_m(source.ground_m())
        .with_seams(source.seams().to_vec())
        .declared_cycle(true))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::fixtures::Walk;
    use crate::skeleton::Side;
    use crate::synth::{Action, Params, synthesize};
    use crate::transition::{CycleSearch, find_cycle};

    /// Returns frames of a walk whose stride takes 60 frames.
    fn walk(frames: usize) -> Motion {
        let walk = Walk { frames, cadence: 1.0, turning: 0.4, phase: 0.15, ..Walk::default() };
        Motion::analyze(walk.clip())
    }

    fn made(action: Action) -> Motion {
        Motion::analyze(synthesize(&Params::new(action)).unwrap().clip)
    }

    /// Returns the largest distance of a joint between the first and the last frame, each in the
    /// character's ground frame, metres.
    fn gap_m(motion: &Motion) -> f32 {
        let last = motion.clip().frames() - 1;
        let pose = |frame: usize| -> Vec<glam::Vec3> {
            let here = motion.ground_frames()[frame].inverse();
            let world = motion.clip().world_pose(frame);
            world.positions.iter().map(|&position| here.apply(position)).collect()
        };
        let apart = pose(0).into_iter().zip(pose(last)).map(|(a, b)| a.distance(b));
        apart.fold(0.0, f32::max)
    }

    #[test]
    fn declared_cycle_ends_in_its_first_pose() {
        for source in [walk(60), walk(47), made(Action::Stop), made(Action::Jump), walk(3)] {
            let name = source.clip().name().to_owned();
            let cycle = treat_as_cycle(&source).unwrap();
            assert!(cycle.is_cycle() && gap_m(&cycle) < 1e-4, "{name}: {} m", gap_m(&cycle));
            let frames = cycle.clip().frames();
            assert!(frames >= source.clip().frames(), "{name}: {frames}");
            assert_eq!(cycle.ground_frames().len(), frames);
            assert_eq!(cycle.contacts().frames(), frames);
            for side in Side::BOTH {
                let planted = |frame: usize| cycle.contacts().planted(side, frame);
                assert_eq!(planted(0), planted(frames - 1), "{name}");
                let kept = (0..source.clip().frames() - 1)
                    .all(|frame| planted(frame) == source.contacts().planted(side, frame));
                assert!(kept, "{name}: contacts stay");
            }
            assert_eq!(treat_as_cycle(&cycle).unwrap(), cycle);
        }
    }

    #[test]
    fn declared_cycle_of_fewer_than_three_frames_is_refused() {
        for frames in 0..3 {
            let source = walk(5).cropped(0..frames).unwrap();
            let refused = treat_as_cycle(&source);
            assert!(matches!(refused, Err(LoopError::Range { .. })), "{frames}: {refused:?}");
        }
    }

    #[test]
    fn declared_cycle_is_found_whole() {
        for source in [made(Action::Start), walk(41), walk(9)] {
            let cycle = treat_as_cycle(&source).unwrap();
            let last = cycle.clip().frames() - 1;
            let cut = find_cycle(&cycle, &CycleSearch::new(cycle.clip().fps())).unwrap();
            assert_eq!(cut.cycle, 0..last);
        }
        // A search with an end of its own is a search.
        let cycle = treat_as_cycle(&walk(121)).unwrap();
        let search = CycleSearch { start: Some(10), ..CycleSearch::new(60.0) };
        let cut = find_cycle(&cycle, &search).unwrap();
        assert_eq!((cut.cycle.start, cut.cycle.end), (10, 70));
    }
}
