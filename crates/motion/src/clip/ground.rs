//! The height of the ground under a clip, estimated from its feet.

use super::contacts::{FootTracks, GROUND_PERCENTILE, REFERENCE_HEIGHT_M};
use super::{Clip, Contacts};
use crate::math::stats;
use crate::skeleton::Roles;
use glam::Vec3;

/// Usual heights of ankle, toe joint and toe tip above the sole of a character 1.75 m tall, metres.
const ABOVE_SOLE_M: [f32; 3] = [0.09, 0.03, 0.02];
/// The greatest heights of the end of a leg, the next joint and the tip of its foot above the sole
/// of a body on four legs 1.75 m tall, metres: rigs end anywhere between hock and hoof.
const MOST_ABOVE_SOLE_M: [f32; 3] = [0.3, 0.12, 0.03];
/// The ground is y = 0, as usual in files, unless the feet contradict it by more than this, metres
/// for a character 1.75 m tall.
const TOLERANCE_M: f32 = 0.03;

/// Returns the height of the ground under a clip, metres, estimated from its planted feet.
///
/// It is 0 unless planted feet contradict that: if the 5th percentile of their lowest points lies
/// more than 3 cm below 0, it is the ground; if the soles, by the usual heights of ankle, toe joint
/// and toe tip above them, float more than 3 cm above 0, the 5th percentile of the soles' heights
/// is. These lengths are those of a character 1.75 m tall. Of a body on four legs the soles are
/// taken as low below these points as they can be. 0 for a clip in which no foot is planted.
#[must_use]
pub fn estimate_ground(clip: &Clip, roles: &Roles, contacts: &Contacts) -> f32 {
    let tracks = FootTracks::of(clip, roles);
    let scale = roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M;
    let (mut lowest, mut soles) = (Vec::new(), Vec::new());
    let above_sole = if roles.is_quadruped() { MOST_ABOVE_SOLE_M } else { ABOVE_SOLE_M };
    for &foot in contacts.feet() {
        let points: Vec<(&[Vec3], f32)> = (tracks.feet.iter().zip(above_sole))
            .flat_map(|(kind, above)| {
                kind.iter().map(move |(of, track)| (*of, track, above * scale))
            })
            .filter(|(of, _, _)| *of == foot)
            .map(|(_, track, above)| (track.as_slice(), above))
            .collect();
        for frame in (0..clip.frames()).filter(|&frame| contacts.planted(foot, frame)) {
            let heights =
                || points.iter().map(|(track, above)| (track[frame].y, track[frame].y - above));
            lowest.extend(heights().map(|(point, _)| point).min_by(f32::total_cmp));
            soles.extend(heights().map(|(_, sole)| sole).min_by(f32::total_cmp));
        }
    }
    let level = |heights: &[f32]| stats::percentile(heights, GROUND_PERCENTILE).unwrap_or(0.0);
    let (below, above) = (level(&lowest), level(&soles));
    if below < -TOLERANCE_M * scale {
        below
    } else if above > TOLERANCE_M * scale {
        above
    } else {
        0.0
    }
}

/// Returns the amount by which a clip with the feet `moved`, which was retargeted to a body `scale`
/// times as large, has to be raised so that they are as high as those of `source` in proportion.
/// Only kinds of foot points (ankles, toe joints, toe tips) that both bodies have are compared: an
/// ankle stands higher than a toe. `None` where they have none in common.
pub(super) fn rise_between(source: &FootTracks, moved: &FootTracks, scale: f32) -> Option<f32> {
    let has = |tracks: &FootTracks, kind: usize| !tracks.feet[kind].is_empty();
    let shared = [0, 1, 2].map(|kind| has(source, kind) && has(moved, kind));
    Some(level_of(source, shared)? * scale - level_of(moved, shared)?)
}

/// Returns the 5th percentile of the heights of the lowest points of these kinds; `None` where
/// there are none.
fn level_of(tracks: &FootTracks, kinds: [bool; 3]) -> Option<f32> {
    let points =
        || tracks.feet.iter().zip(kinds).filter(|(_, wanted)| *wanted).flat_map(|(kind, _)| kind);
    let lowest = |frame: usize| {
        points().filter_map(|(_, track)| Some(track.get(frame)?.y)).min_by(f32::total_cmp)
    };
    let frames = points().map(|(_, track)| track.len()).max().unwrap_or(0);
    let heights: Vec<f32> = (0..frames).filter_map(lowest).collect();
    stats::percentile(&heights, GROUND_PERCENTILE)
}

/// Returns the level of a clip's feet, metres: the 5th percentile of the heights of their lowest
/// points. 0 for a clip without feet.
#[cfg(test)]
pub(super) fn foot_level(clip: &Clip, roles: &Roles) -> f32 {
    level_of(&FootTracks::of(clip, roles), [true; 3]).unwrap_or(0.0)
}
