use super::Clip;
use crate::math::{quat, stats};

/// A joint whose turning changes by less than this from one step to the next is still, radians: what single precision makes of a joint at rest.
const STILL_RADIANS: f32 = 1e-4;
/// Frames that are looked at for what is usual: enough for a 99th percentile, and bounded for long clips.
const SAMPLES: usize = 1_000;

/// How much a joint's turn changes from the step into `frame` to the step out of it: the length of the difference of the two rotation
/// vectors, radians. `None` in the first and the last frame, and where there is no such frame or joint.
pub(crate) fn turn_change(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    let at = |frame: usize| (frame < clip.frames()).then(|| clip.rotations(frame).get(joint).copied()).flatten();
    let (before, here, after) = (at(frame.checked_sub(1)?)?, at(frame)?, at(frame.checked_add(1)?)?);
    Some((quat::log(after * here.conjugate()) - quat::log(here * before.conjugate())).length())
}

/// For every frame how much the joints jolt in it: the largest [`turn_change`] of a joint over what is usual for that joint, which is the 99th
/// percentile of the clip. Above 1 stands what one frame in a hundred does: a heel strikes, or the capture trembles. 0 in the first and the last frame.
pub(crate) fn jolts(clip: &Clip) -> Vec<f32> {
    let mut jolts = vec![0.0_f32; clip.frames()];
    let stride = clip.frames().div_ceil(SAMPLES).max(1);
    for joint in 0..clip.skeleton().len() {
        let changes: Vec<f32> = (0..clip.frames())
            .map(|frame| turn_change(clip, frame, joint).unwrap_or(0.0))
            .collect();
        let sampled: Vec<f32> = changes.iter().copied().step_by(stride).collect();
        let usual = stats::percentile(&sampled, 0.99).unwrap_or(0.0).max(STILL_RADIANS);
        for (jolt, change) in jolts.iter_mut().zip(changes) {
            *jolt = jolt.max(change / usual);
        }
    }
    jolts
}
