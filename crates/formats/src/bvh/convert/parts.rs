//! Conversion of the rows of several parts of a file at the same time, each to its place in the
//! motion.

use super::{Character, Source, position};
use crate::bvh::row_sink::{KeptPart, PartSink};
use crate::bvh::turns::Turns;
use crate::raw::{RawMotion, WildAngles};
use glam::{Quat, Vec3};
use std::slice::IterMut;

/// Buffers of one part, so that parts can be converted at the same time.
#[derive(Debug)]
pub(super) struct PartBuffers {
    turns: Turns,
    wild_angles: WildAngles,
}

/// A part of the rows of all characters.
pub(in crate::bvh) struct ConverterPart<'p> {
    pub(super) characters: Vec<CharacterPart<'p>>,
}

impl PartSink for ConverterPart<'_> {
    fn row(&mut self, values: &[f64]) -> bool {
        self.characters.iter_mut().all(|character| character.row(values))
    }
}

/// A part of the rows of a character.
pub(super) struct CharacterPart<'p> {
    joints: usize,
    places: &'p [[Source; 3]],
    buffers: &'p mut PartBuffers,
    /// The places of the rotations that follow.
    rotations: &'p mut [Quat],
    /// Those of the translations of the root, and of each track.
    translations: Vec<IterMut<'p, Vec3>>,
}

impl CharacterPart<'_> {
    fn row(&mut self, values: &[f64]) -> bool {
        let Some(mut own) = self.rotations.split_off_mut(..self.joints) else {
            return false;
        };
        let PartBuffers { turns, wild_angles } = self.buffers;
        if turns.rotations_into(values, &mut own) {
            wild_angles.add_row(turns.largest(values));
        }
        for (track, place) in self.translations.iter_mut().zip(self.places) {
            if let Some(own) = track.next() {
                *own = position(place, values);
            }
        }
        true
    }
}

impl Character {
    /// Sets a row for which there is memory.
    pub(super) fn put(&mut self, index: usize, values: &[f64]) {
        let joints = self.raw.joints.len();
        let own = self.raw.rotations.get_mut(index * joints..(index + 1) * joints);
        if self.turns.rotations_into(values, &mut own.unwrap_or_default()) {
            // A position may be as large: only the angles of the row count.
            self.raw.wild_angles.add_row(self.turns.largest(values));
        }
        for (track, place) in self.raw.translations_mut().zip(&self.places) {
            if let Some(own) = track.get_mut(index) {
                *own = position(place, values);
            }
        }
    }

    /// Returns parts for so many rows each, from a row on for which there is memory.
    pub(super) fn parts(&mut self, row: usize, most: &[usize]) -> Option<Vec<CharacterPart<'_>>> {
        let Self { turns, places, buffers, raw } = self;
        while buffers.len() < most.len() {
            buffers.push(PartBuffers { turns: turns.clone(), wild_angles: WildAngles::default() });
        }
        let RawMotion { joints, rotations, root_translations, tracks, .. } = raw;
        let joints = joints.len();
        let mut rotations = rotations.get_mut(row * joints..)?;
        let tracks = tracks.iter_mut().map(|(_, values)| values);
        let mut translations: Vec<&mut [Vec3]> = std::iter::once(root_translations)
            .chain(tracks)
            .map(|values| values.get_mut(row..).unwrap_or_default())
            .collect();
        let mut parts = Vec::with_capacity(most.len());
        for (&most, buffers) in most.iter().zip(buffers) {
            buffers.wild_angles = WildAngles::default();
            let rotations = rotations.split_off_mut(..most * joints)?;
            let translations = translations.iter_mut().map(|values| values.split_off_mut(..most));
            let translations: Option<Vec<_>> = translations.collect();
            let translations = translations?.into_iter().map(|values| values.iter_mut()).collect();
            parts.push(CharacterPart { joints, places, buffers, rotations, translations });
        }
        Some(parts)
    }

    /// Closes the gaps that parts have left that took fewer rows than there was place for.
    pub(super) fn keep(&mut self, row: usize, parts: &[KeptPart]) {
        let joints = self.raw.joints.len();
        let (mut from, mut to) = (row, row);
        for (part, buffers) in parts.iter().zip(&self.buffers) {
            self.raw.wild_angles.add(buffers.wild_angles);
            if from != to {
                let rotations = from * joints..(from + part.rows) * joints;
                self.raw.rotations.copy_within(rotations, to * joints);
                for track in self.raw.translations_mut() {
                    track.copy_within(from..from + part.rows, to);
                }
            }
            from += part.most;
            to += part.rows;
        }
    }
}
