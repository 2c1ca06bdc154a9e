//! From rows of channels to rotations and translations, one row at a time.

use super::hierarchy::{Column, Hierarchy};
use super::motion::RowSink;
use crate::formats::error::Fault;
use crate::formats::raw::RawMotion;
use crate::skeleton::{Channel, Joint};
use glam::{Quat, Vec3};

/// Bytes of motion in memory per byte of file, at most. A joint with a single channel of single digits takes 8; only files in which most joints
/// have no channel at all, and those made to fill the memory, come near.
pub(in crate::formats) const MEMORY_PER_BYTE: u64 = 16;

/// Motions below this are always taken.
pub(in crate::formats) const MEMORY_FLOOR: u64 = 64 << 20;

/// Whether a channel turns, and about or along which axis (0 to 2).
pub(super) fn kind(channel: Channel) -> (bool, usize) {
    match channel {
        Channel::XPosition => (false, 0),
        Channel::YPosition => (false, 1),
        Channel::ZPosition => (false, 2),
        Channel::XRotation => (true, 0),
        Channel::YRotation => (true, 1),
        Channel::ZRotation => (true, 2),
    }
}

/// Where a coordinate comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Column(usize),
    Offset(f64),
}

/// What a joint takes from a row.
struct Plan {
    /// Its turns, in order, as a range of [`Converter::turns`].
    turns: std::ops::Range<usize>,
    position: [Source; 3],
    /// Where translations go: a track of the character, or its way through the world.
    target: Target,
}

#[derive(Clone, Copy, PartialEq)]
enum Target {
    Root,
    Track(usize),
    Nowhere,
}

/// One character of the file, in file units and file axes.
struct Character {
    /// Its joints, as a range of the file's.
    joints: std::ops::Range<usize>,
    raw: RawMotion,
}

/// Collects rows as rotations.
pub(super) struct Converter {
    plans: Vec<Plan>,
    turns: Vec<(usize, usize)>,
    characters: Vec<Character>,
    /// Sine and cosine of half of every value of the row, were it degrees.
    half_angles: Vec<(f64, f64)>,
    bytes_per_row: u64,
    bytes: u64,
    limit: u64,
}

impl Converter {
    /// `bytes` is the length of the file and bounds what is allocated.
    pub(super) fn new(tree: &Hierarchy, bytes: usize) -> Self {
        let mut positions: Vec<[Source; 3]> = tree.joints.iter().map(|joint| joint.offset.map(Source::Offset)).collect();
        let mut moves = vec![false; tree.joints.len()];
        // Sorting by joint keeps the order of each joint's channels.
        let mut turning: Vec<(usize, usize, usize)> = Vec::new();
        let mut channels: Vec<Vec<Channel>> = vec![Vec::new(); tree.joints.len()];
        for (index, &Column { joint, channel }) in tree.columns.iter().enumerate() {
            let Some(channel) = channel else { continue };
            channels[joint].push(channel);
            match kind(channel) {
                (true, axis) => turning.push((joint, axis, index)),
                (false, axis) => {
                    positions[joint][axis] = Source::Column(index);
                    moves[joint] = true;
                }
            }
        }
        turning.sort_by_key(|&(joint, ..)| joint);

        let starts: Vec<usize> = (0..tree.joints.len())
            .filter(|&joint| tree.joints[joint].parent.is_none())
            .collect();
        let ends = starts.iter().skip(1).copied().chain([tree.joints.len()]);
        let mut characters = Vec::new();
        let mut plans = Vec::with_capacity(tree.joints.len());
        for (start, end) in starts.iter().copied().zip(ends) {
            let mut raw = RawMotion::default();
            for index in start..end {
                let joint = &tree.joints[index];
                let target = if index == start {
                    Target::Root
                } else if moves[index] {
                    raw.tracks.push((index - start, Vec::new()));
                    Target::Track(raw.tracks.len() - 1)
                } else {
                    Target::Nowhere
                };
                let first = turning.partition_point(|turn| turn.0 < index);
                let turns = first..turning.partition_point(|turn| turn.0 <= index);
                plans.push(Plan {
                    turns,
                    position: positions[index],
                    target,
                });
                raw.joints.push(Joint {
                    name: joint.name.clone(),
                    parent: joint.parent.map(|parent| parent - start),
                    offset: vec3(joint.offset),
                    end_site: joint.end_site.map(vec3),
                    channels: std::mem::take(&mut channels[index]),
                });
            }
            characters.push(Character { joints: start..end, raw });
        }
        let tracks: usize = characters.iter().map(|c| c.raw.tracks.len() + 1).sum();
        let bytes_per_row = (tree.joints.len() * size_of::<Quat>() + tracks * size_of::<Vec3>()) as u64;
        Self {
            plans,
            turns: turning.into_iter().map(|(_, axis, column)| (axis, column)).collect(),
            characters,
            half_angles: Vec::new(),
            bytes_per_row,
            bytes: 0,
            limit: MEMORY_FLOOR.saturating_add(MEMORY_PER_BYTE.saturating_mul(bytes as u64)),
        }
    }

    /// Makes room for the declared frames, as far as the bytes that are left can hold them.
    pub(super) fn reserve(&mut self, declared: f64, bytes_left: usize, columns: usize) {
        let hold = bytes_left / (2 * columns.max(1));
        let rows = hold.min(declared.max(0.0) as usize);
        let fits = (4 * bytes_left as u64 / self.bytes_per_row.max(1)) as usize;
        let rows = rows.min(fits);
        for character in &mut self.characters {
            character.raw.rotations.reserve(rows * character.joints.len());
            character.raw.root_translations.reserve(rows);
            character.raw.tracks.iter_mut().for_each(|(_, values)| values.reserve(rows));
        }
    }

    /// What channels are before any good value: positions stand at their OFFSET, rotations at 0.
    pub(super) fn first_row(tree: &Hierarchy) -> Vec<f64> {
        let value = |column: &Column| match column.channel.map(kind) {
            Some((false, axis)) => tree.joints.get(column.joint).map_or(0.0, |joint| joint.offset[axis]),
            _ => 0.0,
        };
        tree.columns.iter().map(value).collect()
    }

    /// One motion for each ROOT, in file units and file axes.
    pub(super) fn finish(self) -> Vec<RawMotion> {
        self.characters.into_iter().map(|character| character.raw).collect()
    }
}

impl RowSink for Converter {
    fn row(&mut self, values: &[f64]) -> Result<(), Fault> {
        self.bytes += self.bytes_per_row;
        if self.bytes > self.limit {
            let found = format!(
                "a motion of more than {} MB, most of it in joints without channels",
                self.limit >> 20
            );
            return Err(Fault::new(0, found, "a motion that fits into memory").with_hint("export fewer frames or fewer joints"));
        }
        self.half_angles.clear();
        self.half_angles.extend(values.iter().map(|&degrees| half_angle_sin_cos(degrees)));
        for character in &mut self.characters {
            let raw = &mut character.raw;
            for plan in &self.plans[character.joints.clone()] {
                let mut q = [0.0, 0.0, 0.0, 1.0];
                for &(axis, column) in &self.turns[plan.turns.clone()] {
                    let (sin, cos) = self.half_angles[column];
                    q = turned(q, axis, sin, cos);
                }
                raw.rotations
                    .push(Quat::from_xyzw(q[0] as f32, q[1] as f32, q[2] as f32, q[3] as f32));
                let translation = || {
                    vec3(plan.position.map(|source| match source {
                        Source::Column(column) => values[column],
                        Source::Offset(value) => value,
                    }))
                };
                match plan.target {
                    Target::Root => raw.root_translations.push(translation()),
                    Target::Track(track) => raw.tracks[track].1.push(translation()),
                    Target::Nowhere => {}
                }
            }
        }
        Ok(())
    }
}

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

/// `q` (x, y, z, w) times a turn about one axis, given sine and cosine of half the angle.
pub(in crate::formats) fn turned([x, y, z, w]: [f64; 4], axis: usize, s: f64, c: f64) -> [f64; 4] {
    match axis {
        0 => [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s],
        1 => [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s],
        _ => [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s],
    }
}

/// Sine and cosine of half an angle in degrees, to 1e-13. No branches on usual angles, so that it runs over a row as vectors.
pub(in crate::formats) fn half_angle_sin_cos(degrees: f64) -> (f64, f64) {
    use std::f64::consts::FRAC_PI_2;
    // Adding this rounds to a whole number and leaves it in the lowest bits, for magnitudes below 2⁵¹.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let degrees = if degrees.abs() < 1e9 { degrees } else { degrees % 720.0 };
    // The half angle in quarter turns: the nearest whole number of them, and a rest of at most π/4.
    let quarters = degrees * (1.0 / 180.0);
    let rounded = quarters + ROUND;
    let x = (quarters - (rounded - ROUND)) * FRAC_PI_2;
    let x2 = x * x;
    // The Taylor series; the first terms left out are below 1e-13 at π/4.
    let sin = x
        * (1.0
            + x2 * (-1.0 / 6.0
                + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0 + x2 * (-1.0 / 39_916_800.0 + x2 / 6_227_020_800.0))))));
    let cos = 1.0
        + x2 * (-0.5
            + x2 * (1.0 / 24.0
                + x2 * (-1.0 / 720.0
                    + x2 * (1.0 / 40_320.0 + x2 * (-1.0 / 3_628_800.0 + x2 * (1.0 / 479_001_600.0 - x2 / 87_178_291_200.0))))));
    match rounded.to_bits() & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::bvh::hierarchy::FileJoint;

    #[test]
    fn the_fast_sine_is_the_sine() {
        for step in -80_000..80_000 {
            let degrees = f64::from(step) * 0.037_1;
            let (sin, cos) = half_angle_sin_cos(degrees);
            let (expected_sin, expected_cos) = (degrees * std::f64::consts::PI / 360.0).sin_cos();
            assert!(
                (sin - expected_sin).abs() < 1e-12 && (cos - expected_cos).abs() < 1e-12,
                "{degrees}"
            );
        }
        for degrees in [1e9, -7.2e12 - 90.0, 1e30] {
            let (sin, cos) = half_angle_sin_cos(degrees);
            assert!((sin * sin + cos * cos - 1.0).abs() < 1e-12, "{degrees}");
        }
    }

    #[test]
    fn turns_multiply_in_the_order_of_the_channels() {
        let (a, b, c) = (0.7_f64, -1.1, 2.3);
        for (order, expected) in [
            (
                [2, 0, 1],
                Quat::from_rotation_z(a as f32) * Quat::from_rotation_x(b as f32) * Quat::from_rotation_y(c as f32),
            ),
            (
                [1, 2, 0],
                Quat::from_rotation_y(a as f32) * Quat::from_rotation_z(b as f32) * Quat::from_rotation_x(c as f32),
            ),
        ] {
            let mut q = [0.0, 0.0, 0.0, 1.0];
            for (axis, angle) in order.into_iter().zip([a, b, c]) {
                let (s, c) = (angle / 2.0).sin_cos();
                q = turned(q, axis, s, c);
            }
            let q = Quat::from_xyzw(q[0] as f32, q[1] as f32, q[2] as f32, q[3] as f32);
            assert!((q - expected).length() < 1e-6);
        }
    }

    fn bare(parent: Option<usize>) -> FileJoint {
        FileJoint {
            name: String::new(),
            parent,
            offset: [0.0; 3],
            end_site: None,
        }
    }

    #[test]
    fn joints_without_channels_cannot_fill_the_memory() {
        let mut joints = vec![bare(None)];
        joints.extend((0..100_000).map(|_| bare(Some(0))));
        let tree = Hierarchy {
            joints,
            columns: vec![Column {
                joint: 0,
                channel: Some(Channel::XRotation),
            }],
        };
        let mut converter = Converter::new(&tree, 2_000_000);
        converter.reserve(4e9, 2_000_000, 1);
        assert!(converter.characters[0].raw.rotations.capacity() < 1_000_000);
        let refused = (0..1000).find_map(|_| converter.row(&[0.0]).err());
        assert!(refused.is_some_and(|fault| fault.found.contains("without channels")));
    }
}
