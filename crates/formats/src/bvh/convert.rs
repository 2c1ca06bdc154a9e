//! Conversion of rows of channels to rotations and translations, one row at a time.

#[cfg(feature = "parallel")]
mod parts;

use super::hierarchy::{Column, Hierarchy};
use super::row_sink::RowSink;
use super::turns::Turns;
use crate::error::Fault;
use crate::raw::RawMotion;
use glam::{Quat, Vec3};
use segue_motion::skeleton::{Channel, Joint};
use segue_text::msg;
use std::ops::Range;
#[cfg(feature = "parallel")]
use {super::row_sink::KeptPart, parts::ConverterPart, parts::PartBuffers};

/// The greatest ratio of memory of a motion to bytes of the file. A joint with a single channel of
/// single digits takes 8; only files in which most joints have no channel at all, and malicious
/// ones, come near.
pub(crate) const MEMORY_PER_BYTE: u64 = 16;

/// The number of rows for which memory is reserved before their length is known.
pub(crate) const FIRST_ROWS: usize = 64;

/// Motions below this size are always accepted, bytes.
pub(crate) const MEMORY_FLOOR: u64 = 64 << 20;

/// Returns whether a channel is a rotation, and its axis (0 to 2).
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

/// The source of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Column(usize),
    Offset(f64),
}

/// One character of the file, in file units and file axes.
struct Character {
    turns: Turns,
    /// The position of the root, then that of each joint that has a track, in the order of the
    /// tracks.
    places: Vec<[Source; 3]>,
    /// With the feature `parallel`, it is as long as the memory that is reserved.
    raw: RawMotion,
    /// The buffers of parts that are read at the same time.
    #[cfg(feature = "parallel")]
    buffers: Vec<PartBuffers>,
}

#[cfg(not(feature = "parallel"))]
impl Character {
    /// Appends a row.
    fn put(&mut self, _index: usize, values: &[f64]) {
        let raw = &mut self.raw;
        if self.turns.rotations_into(values, &mut raw.rotations) {
            // A position may be as large: only the angles of the row count.
            raw.wild_angles.add_row(self.turns.largest(values));
        }
        for (track, place) in raw.translations_mut().zip(&self.places) {
            track.push(position(place, values));
        }
    }
}

/// The collection of rows as rotations.
pub(super) struct Converter {
    characters: Vec<Character>,
    /// The number of rows according to the header.
    declared: f64,
    /// Start of the first row and end of the last one.
    bytes: Range<usize>,
    rows: usize,
    /// The number of rows for which memory is reserved.
    room: usize,
    bytes_per_row: u64,
    limit: u64,
}

impl Converter {
    /// Returns a converter. `declared` is the number of rows according to the header, `bytes` the
    /// range of the rows in the file; both bound the allocation.
    pub(super) fn new(tree: &Hierarchy, declared: f64, bytes: Range<usize>) -> Self {
        let mut positions: Vec<[Source; 3]> =
            tree.joints.iter().map(|joint| joint.offset.map(Source::Offset)).collect();
        let mut moves = vec![false; tree.joints.len()];
        let mut turns: Vec<Vec<(usize, usize)>> = vec![Vec::new(); tree.joints.len()];
        let mut channels: Vec<Vec<Channel>> = vec![Vec::new(); tree.joints.len()];
        for (index, &Column { joint, channel }) in tree.columns.iter().enumerate() {
            let Some(channel) = channel else { continue };
            channels[joint].push(channel);
            match kind(channel) {
                (true, axis) => turns[joint].push((axis, index)),
                (false, axis) => {
                    positions[joint][axis] = Source::Column(index);
                    moves[joint] = true;
                }
            }
        }

        let starts: Vec<usize> =
            (0..tree.joints.len()).filter(|&joint| tree.joints[joint].parent.is_none()).collect();
        let ends = starts.iter().skip(1).copied().chain([tree.joints.len()]);
        let mut characters = Vec::new();
        for (start, end) in starts.iter().copied().zip(ends) {
            let mut character = Character {
                turns: Turns::new(&turns[start..end]),
                places: Vec::new(),
                raw: RawMotion::default(),
                #[cfg(feature = "parallel")]
                buffers: Vec::new(),
            };
            for index in start..end {
                let joint = &tree.joints[index];
                if index == start {
                    character.places.push(positions[index]);
                } else if moves[index] {
                    character.places.push(positions[index]);
                    character.raw.tracks.push((index - start, Vec::new()));
                }
                character.raw.joints.push(Joint {
                    name: joint.name.clone(),
                    parent: joint.parent.map(|parent| parent - start),
                    offset: vec3(joint.offset),
                    end_site: joint.end_site.map(vec3),
                    channels: std::mem::take(&mut channels[index]),
                });
            }
            characters.push(character);
        }
        let tracks: usize = characters.iter().map(|c| c.places.len()).sum();
        let bytes_per_row =
            (tree.joints.len() * size_of::<Quat>() + tracks * size_of::<Vec3>()) as u64;
        Self {
            characters,
            declared,
            rows: 0,
            room: 0,
            bytes_per_row,
            limit: MEMORY_FLOOR.saturating_add(MEMORY_PER_BYTE.saturating_mul(bytes.len() as u64)),
            bytes,
        }
    }

    /// Reserves memory for the remaining rows: as many as the bytes from `end` on hold if they are
    /// as long as the rows so far. Growing by doubling, as vectors do, would need memory for the
    /// motion twice at the end.
    fn make_room(&mut self, end: usize) -> Result<(), Fault> {
        let left = self.bytes.end.saturating_sub(end) as f64;
        let as_before =
            left * self.rows as f64 / end.saturating_sub(self.bytes.start).max(1) as f64;
        // The header is used only if it agrees with the bytes.
        let expected = (self.declared - self.rows as f64).clamp(0.9 * as_before, 1.1 * as_before);
        let fits = self.limit / self.bytes_per_row.max(1) / 4;
        let rows = (expected as u64).min(fits) as usize;
        let rows = rows.max(self.rows / 8).max(FIRST_ROWS.min(fits as usize)).max(1);
        self.room += rows;
        for character in &mut self.characters {
            #[cfg(not(feature = "parallel"))]
            character.raw.reserve(rows)?;
            #[cfg(feature = "parallel")]
            character.raw.lengthen(self.room)?;
        }
        Ok(())
    }

    /// Checks that so many more rows are within the limit.
    fn check_size(&self, rows: usize) -> Result<(), Fault> {
        if ((self.rows + rows) as u64).saturating_mul(self.bytes_per_row) <= self.limit {
            return Ok(());
        }
        let found = msg!(
            "a motion of more than {mb} MB, most of it in joints without channels",
            mb = self.limit >> 20
        );
        Err(Fault::new(0, found, "a motion that fits into memory")
            .with_hint("export fewer frames or fewer joints"))
    }

    /// Returns the initial values of channels: positions are the OFFSET, rotations 0.
    pub(super) fn first_row(tree: &Hierarchy) -> Vec<f64> {
        let value = |column: &Column| match column.channel.map(kind) {
            Some((false, axis)) => {
                tree.joints.get(column.joint).map_or(0.0, |joint| joint.offset[axis])
            }
            _ => 0.0,
        };
        tree.columns.iter().map(value).collect()
    }

    /// Returns one motion for each ROOT, in file units and file axes.
    pub(super) fn finish(mut self) -> Vec<RawMotion> {
        for character in &mut self.characters {
            let raw = &mut character.raw;
            raw.rotations.truncate(self.rows * raw.joints.len());
            raw.rotations.shrink_to_fit();
            raw.translations_mut().for_each(|track| {
                track.truncate(self.rows);
                track.shrink_to_fit();
            });
        }
        self.characters.into_iter().map(|character| character.raw).collect()
    }
}

impl RowSink for Converter {
    #[cfg(feature = "parallel")]
    type Part<'p> = ConverterPart<'p>;

    fn row(&mut self, values: &[f64], end: usize) -> Result<(), Fault> {
        self.check_size(1)?;
        if self.rows == self.room {
            self.make_room(end)?;
        }
        for character in &mut self.characters {
            character.put(self.rows, values);
        }
        self.rows += 1;
        Ok(())
    }

    #[cfg(feature = "parallel")]
    fn parts(&mut self, most: &[usize], end: usize) -> Option<Vec<ConverterPart<'_>>> {
        let rows = most.iter().sum();
        self.check_size(rows).ok()?;
        if self.rows == self.room {
            self.make_room(end).ok()?;
        }
        if self.rows + rows > self.room {
            return None;
        }
        let mut parts: Vec<ConverterPart<'_>> =
            most.iter().map(|_| ConverterPart { characters: Vec::new() }).collect();
        for character in &mut self.characters {
            let own = character.parts(self.rows, most)?;
            parts.iter_mut().zip(own).for_each(|(part, own)| part.characters.push(own));
        }
        Some(parts)
    }

    #[cfg(feature = "parallel")]
    fn keep(&mut self, parts: &[KeptPart]) {
        for character in &mut self.characters {
            character.keep(self.rows, parts);
        }
        self.rows += parts.iter().map(|part| part.rows).sum::<usize>();
    }
}

/// Returns a position of a row.
fn position(place: &[Source; 3], values: &[f64]) -> Vec3 {
    vec3(place.map(|source| match source {
        Source::Column(column) => values.get(column).copied().unwrap_or_default(),
        Source::Offset(value) => value,
    }))
}

fn vec3(v: [f64; 3]) -> Vec3 {
    Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::hierarchy::FileJoint;

    fn bare(parent: Option<usize>) -> FileJoint {
        FileJoint { name: String::new(), parent, offset: [0.0; 3], end_site: None }
    }

    #[test]
    fn rows_of_joints_without_channels_are_bounded_in_memory() {
        let mut joints = vec![bare(None)];
        joints.extend((0..100_000).map(|_| bare(Some(0))));
        let tree = Hierarchy {
            joints,
            columns: vec![Column { joint: 0, channel: Some(Channel::XRotation) }],
        };
        let mut converter = Converter::new(&tree, 4e9, 0..2_000_000);
        let refused = (0..1000).find_map(|row| converter.row(&[0.0], 2 * row).err());
        let held = converter.characters[0].raw.rotations.capacity() * size_of::<Quat>();
        assert!((held as u64) < converter.limit + converter.limit / 4, "{held}");
        assert!(refused.is_some_and(|fault| fault.found.to_string().contains("without channels")));
    }
}
