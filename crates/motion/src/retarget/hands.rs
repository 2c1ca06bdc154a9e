//! The places of hands.

use super::tracks::{LimbTrack, Tracks};
use crate::math::curve;
use glam::Vec3;

/// Hands keep their distance from each other, in proportion, up to this distance, as a share of the
/// arms' length; from [`APART`] on each follows its own shoulder.
const TOGETHER: f32 = 0.15;
const APART: f32 = 0.6;

/// Returns the shifts of both hands from their positions by rotations only, metres; empty for an
/// arm that one of the bodies lacks.
pub(super) fn shifts(tracks: &Tracks) -> [Vec<Vec3>; 2] {
    let own = |track: &LimbTrack, frame: usize| {
        let (start, end, _) = track.source[frame];
        (end - start) * ratio(track, frame) - track.posed[frame].line()
    };
    let [mut lefts, mut rights] = [0, 1].map(|side| {
        let frames = |track: &LimbTrack| (0..track.posed.len()).map(|f| own(track, f)).collect();
        tracks.arms[side].as_ref().map_or(Vec::new(), frames)
    });
    if let [Some(left), Some(right)] = &tracks.arms {
        for (frame, (of_left, of_right)) in lefts.iter_mut().zip(&mut rights).enumerate() {
            let ratio = (ratio(left, frame) + ratio(right, frame)) * 0.5;
            let wanted = left.source[frame].1 - right.source[frame].1;
            let arm = (left.source[frame].2 + right.source[frame].2).max(1e-6) * 0.5;
            let share = (wanted.length() / arm - TOGETHER) / (APART - TOGETHER);
            let together = 1.0 - curve::smoothstep(share);
            let hand = |track: &LimbTrack, shift: Vec3| {
                track.starts[frame] + track.posed[frame].line() + shift
            };
            let found = hand(left, *of_left) - hand(right, *of_right);
            let half = (wanted * ratio - found) * (0.5 * together);
            *of_left += half;
            *of_right -= half;
        }
    }
    [lefts, rights]
}

/// Returns the ratio of the arms' lengths.
fn ratio(track: &LimbTrack, frame: usize) -> f32 {
    let pose = &track.posed[frame];
    (pose.thigh.length() + pose.shin.length()) / track.source[frame].2.max(1e-6)
}
