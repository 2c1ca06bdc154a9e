//! Rows of the comparison of all windows of clips that are too long for storing the distances.

use super::candidates::{CandidatesHead, put_candidates};
use super::error::JobError;
use super::parcel::{put, take, take_floats};
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::Motion;
use segue_motion::graph::{
    DistanceOverview, FrameSet, GraphOptions, StreamComputer, StreamRow, TileCandidates,
};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// The comparison of some parts of a set with the parts behind them. The clips are those of the
/// set.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StreamTask {
    pub(crate) parts: Range<usize>,
    pub(crate) options: GraphOptions,
    /// The height of the body of the set, metres.
    pub(crate) body_height: f64,
}

/// The length of the arrays of one row.
#[derive(Serialize, Deserialize)]
struct RowHead {
    part: usize,
    blocks: usize,
    candidates: CandidatesHead,
}

impl Task for StreamTask {
    type Answer = Vec<StreamRow>;

    fn run(
        &self,
        clips: &[JobClip],
        memory: &mut WorkerMemory,
    ) -> Result<Vec<StreamRow>, JobError> {
        let numbers: Vec<u32> = clips.iter().map(|clip| clip.number).collect();
        let window = self.options.blend_window;
        let kept = memory.stream.take();
        let kept = kept.filter(|(kept, known)| *kept == numbers && known.window() == window);
        let computer = if let Some((_, computer)) = kept {
            computer
        } else {
            let motions: Vec<Arc<Motion>> =
                clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
            let set = Arc::new(FrameSet::new(motions, self.body_height)?);
            StreamComputer::new(&set, window)?
        };
        let rows: Result<Vec<StreamRow>, _> =
            self.parts.clone().map(|part| computer.row(part, &self.options)).collect();
        memory.stream = Some((numbers, computer));
        Ok(rows?)
    }

    fn pack(_clips: &[JobClip], answer: Vec<StreamRow>) -> Result<Parcel, ParcelError> {
        let head: Vec<RowHead> = (answer.iter())
            .map(|row| RowHead {
                part: row.part,
                blocks: row.nearest_m.len(),
                candidates: CandidatesHead::of(&row.candidates),
            })
            .collect();
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        for row in answer {
            put(&mut parcel.bytes, &row.counts);
            put_candidates(&mut parcel.bytes, &row.candidates);
            parcel.floats.extend_from_slice(&row.nearest_m);
        }
        Ok(parcel)
    }

    fn unpack(&self, _clips: &[JobClip], parcel: Parcel) -> Result<Vec<StreamRow>, ParcelError> {
        let heads: Vec<RowHead> = serde_json::from_str(&parcel.head)?;
        let (mut floats, mut bytes) = (&parcel.floats[..], &parcel.bytes[..]);
        let row = |RowHead { part, blocks, candidates }: RowHead| {
            let counts = take(&mut bytes, DistanceOverview::BINS)?;
            let candidates: TileCandidates = candidates.take(&mut bytes)?;
            let nearest_m = take_floats(&mut floats, blocks)?;
            Ok(StreamRow { part, nearest_m, counts, candidates })
        };
        heads.into_iter().map(row).collect()
    }

    fn affinity(&self) -> u64 {
        self.parts.start as u64
    }
}
