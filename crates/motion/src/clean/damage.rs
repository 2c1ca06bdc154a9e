//! Faults that are put into a clip, to show and to measure how they are found.

use super::fault::{Fault, FaultKind};
use super::swaps;
use super::tracks::{Track, Tracks};
use crate::clip::{Clip, ClipError};
use crate::math::quat;
use crate::skeleton::{Role, Roles};
use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use std::ops::Range;

/// The stream of the random numbers.
const STREAM: u64 = 0x0c1e_a4ed;
/// The distance between two faults, and from the ends of the clip, seconds.
const APART_SECS: f64 = 0.2;
/// How often a place is drawn for a fault before it is left out.
const DRAWS: usize = 60;
/// The least way that a gap hides, radians, and the least difference of the sides in a swap.
const MIN_GAP: f32 = 0.12;
const MIN_SWAP: f32 = 0.3;

/// A fault that was put in.
#[derive(Clone, Debug, PartialEq)]
pub struct Damage {
    /// Swap, gap, spike or jitter.
    pub kind: FaultKind,
    /// The frames that were changed.
    pub frames: Range<usize>,
    /// The joints that were changed.
    pub joints: Vec<usize>,
}

/// A clip with faults.
#[derive(Clone, Debug)]
pub struct Damaged {
    /// The clip.
    pub clip: Clip,
    /// Its faults, in the order in which they were put in.
    pub damages: Vec<Damage>,
}

/// Puts up to `count` faults into a clip, by turns spikes, gaps, swaps and jitter, at places that
/// follow from the seed. Faults do not touch each other; those for which there is no place, as a
/// gap while nothing moves, are left out or replaced by a spike.
///
/// A spike turns one joint by 15° to 60°, or moves the root by 10 to 30 cm, for 1 to 3 frames. A
/// gap holds the body or a limb for 0.1 to 0.35 s. A swap exchanges legs or arms for 0.1 to 0.5 s.
/// Jitter of 1° to 2.5° lasts for 0.5 to 1 s.
///
/// # Errors
/// [`ClipError`] as of [`Clip::new`].
pub fn damage(clip: &Clip, roles: &Roles, count: usize, seed: u64) -> Result<Damaged, ClipError> {
    let mut drawn = Draw { rng: Pcg32::new(seed, STREAM) };
    let mut tracks = Tracks::of(clip);
    let limbs = Limbs::of(clip, roles);
    let mut damages: Vec<Damage> = Vec::new();
    let kinds = [FaultKind::Spike, FaultKind::Gap, FaultKind::Swap, FaultKind::Jitter];
    let apart = tracks.frames_of(APART_SECS, 4);
    for number in 0..count {
        let kind = kinds[number % kinds.len()];
        let found = [kind, FaultKind::Spike].into_iter().find_map(|kind| {
            (0..DRAWS).find_map(|_| {
                let length = length_of(kind, &tracks, &mut drawn);
                let room =
                    tracks.frames.checked_sub(length + 2 * apart).filter(|&room| room > 0)?;
                let start = apart + drawn.below(room);
                let frames = start..start + length;
                let near = frames.start.saturating_sub(apart)..frames.end + apart;
                let is_free = |other: &Damage| {
                    other.frames.end <= near.start || near.end <= other.frames.start
                };
                damages.iter().all(is_free).then_some(())?;
                put(kind, &frames, &mut tracks, &limbs, &mut drawn)
            })
        });
        damages.extend(found);
    }
    Ok(Damaged { clip: tracks.clip(clip)?, damages })
}

fn length_of(kind: FaultKind, tracks: &Tracks, drawn: &mut Draw) -> usize {
    let between = |drawn: &mut Draw, from: f64, to: f64| {
        let secs = from + (to - from) * f64::from(drawn.unit());
        tracks.frames_of(secs, 3)
    };
    match kind {
        FaultKind::Gap => between(drawn, 0.1, 0.35),
        FaultKind::Swap => between(drawn, 0.1, 0.5),
        FaultKind::Jitter => between(drawn, 0.5, 1.0),
        _ => 1 + drawn.below(3),
    }
}

/// The joints of a body by limbs.
struct Limbs {
    /// All joints, then those of each limb.
    groups: Vec<Vec<usize>>,
    /// Pairs of left and right.
    pairs: Vec<swaps::Limbs>,
    /// Joints whose turn is seen: those with bones below.
    seen: Vec<usize>,
}

impl Limbs {
    fn of(clip: &Clip, roles: &Roles) -> Self {
        let skeleton = clip.skeleton();
        let all: Vec<usize> = (0..skeleton.len()).collect();
        let below = |top: usize| -> Vec<usize> {
            let mut inside = vec![false; skeleton.len()];
            for joint in top..skeleton.len() {
                let above = skeleton.parent(joint).is_some_and(|parent| inside[parent]);
                inside[joint] = joint == top || above;
            }
            all.iter().copied().filter(|&joint| inside[joint]).collect()
        };
        let tops = [Role::LeftThigh, Role::RightThigh, Role::LeftUpperArm, Role::RightUpperArm];
        let tops = tops.iter().filter_map(|&role| roles.get_within(role, skeleton.len()));
        let mut groups = vec![all.clone()];
        groups.extend(tops.map(below));
        let seen = all.iter().copied().filter(|&joint| skeleton.children(joint).next().is_some());
        Self { seen: seen.collect(), pairs: swaps::limbs(skeleton, roles), groups }
    }
}

/// Random numbers from a seed.
struct Draw {
    rng: Pcg32,
}

impl Draw {
    fn below(&mut self, count: usize) -> usize {
        ((u64::from(self.rng.next_u32()) * count as u64) >> 32) as usize
    }

    fn unit(&mut self) -> f32 {
        self.rng.next_u32() as f32 / u32::MAX as f32
    }

    /// Returns a vector whose components are normal with deviation 1 (sum of twelve: Irwin, Hall).
    fn noise(&mut self) -> Vec3 {
        let mut one = || (0..12).map(|_| self.unit()).sum::<f32>() - 6.0;
        Vec3::new(one(), one(), one())
    }

    fn direction(&mut self) -> Vec3 {
        self.noise().normalize_or(Vec3::X)
    }
}

/// Puts one fault in; `None` where it would not be seen.
fn put(
    kind: FaultKind,
    frames: &Range<usize>,
    tracks: &mut Tracks,
    limbs: &Limbs,
    drawn: &mut Draw,
) -> Option<Damage> {
    let joints = match kind {
        FaultKind::Gap => {
            let joints = limbs.groups[drawn.below(limbs.groups.len())].clone();
            let way = |&joint: &usize| tracks.all[joint].way(frames.start - 1, frames.end).length();
            if joints.iter().map(way).fold(0.0, f32::max) < MIN_GAP {
                return None;
            }
            let held = joints.iter().copied();
            // The whole body stands where it is.
            let root = joints.contains(&0).then_some(tracks.joints);
            for track in held.chain(root) {
                hold(&mut tracks.all[track], frames);
            }
            joints
        }
        FaultKind::Swap => {
            let pairs = limbs.pairs.get(drawn.below(limbs.pairs.len().max(1)))?.clone();
            let apart = |frame: usize| {
                let of =
                    |&(l, r): &(usize, usize)| tracks.all[l].distance(frame, &tracks.all[r], frame);
                pairs.iter().map(of).fold(0.0, f32::max)
            };
            if apart(frames.start).min(apart(frames.end - 1)) < MIN_SWAP {
                return None;
            }
            for &(left, right) in &pairs {
                if let Ok([Track::Turn(a), Track::Turn(b)]) =
                    tracks.all.get_disjoint_mut([left, right])
                {
                    a[frames.clone()].swap_with_slice(&mut b[frames.clone()]);
                }
            }
            pairs.iter().flat_map(|&(left, right)| [left, right]).collect()
        }
        FaultKind::Jitter => {
            let joints = limbs.groups[drawn.below(limbs.groups.len())].clone();
            let deviation = (1.0 + 1.5 * drawn.unit()).to_radians();
            for &joint in &joints {
                for frame in frames.clone() {
                    turn(&mut tracks.all[joint], frame, drawn.noise() * deviation);
                }
            }
            joints
        }
        _ => {
            let on_root = drawn.below(6) == 0;
            let (way, share) = (drawn.direction(), drawn.unit());
            let joint = if on_root || limbs.seen.is_empty() {
                0
            } else {
                limbs.seen[drawn.below(limbs.seen.len())]
            };
            let track = if on_root { tracks.joints } else { joint };
            let size = if on_root { 0.1 + 0.2 * share } else { (15.0 + 45.0 * share).to_radians() };
            for frame in frames.clone() {
                let size = size * (0.8 + 0.4 * drawn.unit());
                turn(&mut tracks.all[track], frame, way * size);
            }
            vec![joint]
        }
    };
    Some(Damage { kind, frames: frames.clone(), joints })
}

fn hold(track: &mut Track, frames: &Range<usize>) {
    match track {
        Track::Turn(values) => {
            let held = values[frames.start - 1];
            values[frames.clone()].fill(held);
        }
        Track::Place(values) => {
            let held = values[frames.start - 1];
            values[frames.clone()].fill(held);
        }
    }
}

fn turn(track: &mut Track, frame: usize, by: Vec3) {
    match track {
        Track::Turn(values) => {
            values[frame] = quat::renormalize(quat::exp(by) * values[frame]);
        }
        Track::Place(values) => values[frame] += by,
    }
}

impl Damage {
    /// Returns whether a fault of one of the kinds that are put in lies on it: it shares frames and
    /// a joint, whatever it was taken for.
    #[must_use]
    pub fn is_found_in(&self, faults: &[Fault]) -> bool {
        faults
            .iter()
            .any(|fault| fault.is_in_tracks() && fault.overlaps(&self.frames, &self.joints))
    }
}

/// Returns the number of faults of single tracks that lie on no damage: false alarms, if the clip
/// was sound before.
#[must_use]
pub fn false_alarms(faults: &[Fault], damages: &[Damage]) -> usize {
    let lies_on = |fault: &Fault, damage: &Damage| fault.overlaps(&damage.frames, &damage.joints);
    faults
        .iter()
        .filter(|fault| fault.is_in_tracks())
        .filter(|fault| !damages.iter().any(|damage| lies_on(fault, damage)))
        .count()
}
