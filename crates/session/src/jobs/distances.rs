//! Tiles of the distances between all windows of a set of clips, with the candidates for
//! transitions.

use super::candidates::{CandidatesHead, put_candidates};
use super::error::JobError;
use super::parcel::{put, take, take_floats};
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::Motion;
use segue_motion::graph::{
    DistanceOverview, DistanceTile, FrameSet, GraphOptions, TileComputer, TileDistances,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The distances and candidates of some tiles. The clips are those of the set.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DistanceTask {
    pub(crate) tiles: Vec<DistanceTile>,
    pub(crate) options: GraphOptions,
    /// The height of the body of the set, metres.
    pub(crate) body_height: f64,
    /// Whether the distances themselves are asked for.
    pub(crate) wants_distances: bool,
}

/// The result of each tile, in order; without distances where they were not asked for.
pub(crate) type DistanceAnswer = Vec<TileDistances>;

/// The length of the arrays of one tile.
#[derive(Serialize, Deserialize)]
struct TileHead {
    cells: usize,
    candidates: CandidatesHead,
}

impl Task for DistanceTask {
    type Answer = DistanceAnswer;

    fn run(
        &self,
        clips: &[JobClip],
        memory: &mut WorkerMemory,
    ) -> Result<DistanceAnswer, JobError> {
        let numbers: Vec<u32> = clips.iter().map(|clip| clip.number).collect();
        let kept = memory.tiles.take().filter(|(kept, _)| *kept == numbers);
        let mut computer = if let Some((_, computer)) = kept {
            computer
        } else {
            let motions: Vec<Arc<Motion>> =
                clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
            let set = FrameSet::new(motions, self.body_height)?;
            TileComputer::new(Arc::new(set), memory.max_bytes)?
        };
        let mut answer = Vec::with_capacity(self.tiles.len());
        for tile in &self.tiles {
            let mut made = computer.compute(tile, &self.options)?;
            if !self.wants_distances {
                made.rms_m = Vec::new();
            }
            answer.push(made);
        }
        memory.tiles = Some((numbers, computer));
        Ok(answer)
    }

    fn pack(_clips: &[JobClip], answer: DistanceAnswer) -> Result<Parcel, ParcelError> {
        let head: Vec<TileHead> = (answer.iter())
            .map(|tile| TileHead {
                cells: tile.rms_m.len(),
                candidates: CandidatesHead::of(&tile.candidates),
            })
            .collect();
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        for tile in answer {
            put(&mut parcel.bytes, &tile.counts);
            put_candidates(&mut parcel.bytes, &tile.candidates);
            if parcel.floats.is_empty() {
                parcel.floats = tile.rms_m;
            } else {
                parcel.floats.extend_from_slice(&tile.rms_m);
            }
        }
        Ok(parcel)
    }

    fn unpack(&self, _clips: &[JobClip], parcel: Parcel) -> Result<DistanceAnswer, ParcelError> {
        let heads: Vec<TileHead> = serde_json::from_str(&parcel.head)?;
        let (is_single, all) = (heads.len() == 1, parcel.floats);
        let (mut floats, mut bytes) = (&all[..], &parcel.bytes[..]);
        let mut answer = Vec::with_capacity(heads.len());
        for head in heads {
            let counts = take(&mut bytes, DistanceOverview::BINS)?;
            let candidates = head.candidates.take(&mut bytes)?;
            let rms_m = if is_single { Vec::new() } else { take_floats(&mut floats, head.cells)? };
            answer.push(TileDistances { rms_m, counts, candidates });
        }
        if let ([tile], true) = (&mut answer[..], is_single) {
            tile.rms_m = all;
        }
        Ok(answer)
    }

    fn affinity(&self) -> u64 {
        let first = self.tiles.first();
        first.map_or(0, |tile| {
            ((tile.a as u64) << 40) ^ ((tile.b as u64) << 20) ^ tile.rows.start as u64
        })
    }
}
