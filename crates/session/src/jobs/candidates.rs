//! Candidates for transitions in an answer.

use super::ParcelError;
use super::parcel::{put, take};
use glam::DVec2;
use segue_motion::graph::{Candidate, Place, TileCandidates};
use segue_motion::math::Planar;
use serde::{Deserialize, Serialize};

/// The candidates without their array.
#[derive(Serialize, Deserialize)]
pub(super) struct CandidatesHead {
    found: usize,
    left_out: usize,
    /// The bits of the number: it is exact, and may be missing.
    nearest_m: Option<u32>,
}

impl CandidatesHead {
    pub(super) fn of(candidates: &TileCandidates) -> Self {
        Self {
            found: candidates.found.len(),
            left_out: candidates.left_out,
            nearest_m: candidates.nearest_m.map(f32::to_bits),
        }
    }

    /// Moves the candidates from the front of `bytes`.
    pub(super) fn take(&self, bytes: &mut &[u8]) -> Result<TileCandidates, ParcelError> {
        let mut found = Vec::new();
        for _ in 0..self.found {
            let places = take::<[u32; 2]>(bytes, 2)?;
            let place = |at: usize| {
                let [clip, frame] = places.get(at).copied().unwrap_or_default();
                Place { clip: clip as usize, frame: frame as usize }
            };
            for [distance_cm, yaw, x, z] in take::<[f64; 4]>(bytes, 1)? {
                found.push(Candidate {
                    leave: place(0),
                    enter: place(1),
                    distance_cm,
                    alignment: Planar { yaw, shift: DVec2::new(x, z) },
                });
            }
        }
        let nearest_m = self.nearest_m.map(f32::from_bits);
        Ok(TileCandidates { found, nearest_m, left_out: self.left_out })
    }
}

/// Appends the array of candidates.
pub(super) fn put_candidates(bytes: &mut Vec<u8>, candidates: &TileCandidates) {
    for found in &candidates.found {
        let places = [found.leave, found.enter].map(|of| [of.clip as u32, of.frame as u32]);
        put(bytes, &places);
        let Planar { yaw, shift } = found.alignment;
        put(bytes, &[found.distance_cm, yaw, shift.x, shift.y]);
    }
}
