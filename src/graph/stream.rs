use super::candidates::{Picker, is_minimum};
use super::distances::level_m;
use super::{Candidates, Construction, FrameSet, GraphError, GraphOptions, Place};
use crate::registration::{PairTerms, PointClouds, Progress};
use std::ops::Range;
use std::sync::Arc;

/// Windows of a tile, to a side.
const TILE: usize = 512;

/// [`Candidates`] of clips that are too long for all pairs to be held: tile after tile is compared, searched, and dropped.
///
/// 30,000 frames of 31 joints are 1,770 tiles of about 5 ms each, and 5 MB at a time beside the points (12 bytes per joint and frame) and what
/// is found. A new window or threshold means to begin again.
#[derive(Clone, Debug)]
pub struct CandidateStream {
    set: Arc<FrameSet>,
    options: GraphOptions,
    picker: Picker,
    parts: Vec<Part>,
    /// The next tile: parts a ≤ b.
    next: (usize, usize),
    done: usize,
}

/// A part of a clip: the windows that start in `starts`, and one more to either side, so that a minimum is seen to be one.
#[derive(Clone, Debug)]
struct Part {
    clip: usize,
    starts: Range<usize>,
    /// The first frame of the clouds.
    from: usize,
    clouds: PointClouds,
}

impl CandidateStream {
    /// Prepares the search.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips, or a position is not finite.
    pub fn new(set: &Arc<FrameSet>, options: &GraphOptions) -> Result<Self, GraphError> {
        options.check(set)?;
        let (level, window) = (level_m(set)?, options.blend_window);
        let mut parts = Vec::new();
        for (clip, source) in set.clips().iter().enumerate() {
            let frames = source.clip().frames();
            let windows = (frames + 1).saturating_sub(window);
            for start in (0..windows).step_by(TILE) {
                let starts = start..(start + TILE).min(windows);
                let from = start.saturating_sub(1);
                let clouds = PointClouds::new(source.clip(), from..starts.end + window, set.weights(), 1, level)?;
                parts.push(Part {
                    clip,
                    starts,
                    from,
                    clouds,
                });
            }
        }
        Ok(Self {
            set: Arc::clone(set),
            options: *options,
            picker: Picker::new(Arc::clone(set), *options),
            parts,
            next: (0, 0),
            done: 0,
        })
    }

    /// Does up to `tiles` more tiles, and says how many are done.
    ///
    /// # Errors
    /// [`GraphError::Registration`]; not for clips that [`new`](Self::new) took.
    pub fn advance(&mut self, tiles: usize) -> Result<Progress, GraphError> {
        let total = self.parts.len() * (self.parts.len() + 1) / 2;
        for _ in 0..tiles.min(total - self.done) {
            self.tile()?;
            self.done += 1;
            self.next = match self.next {
                (a, b) if b + 1 < self.parts.len() => (a, b + 1),
                (a, _) => (a + 1, a + 1),
            };
        }
        Ok(Progress { done: self.done, total })
    }

    /// How many tiles are done.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            done: self.done,
            total: self.parts.len() * (self.parts.len() + 1) / 2,
        }
    }

    /// The rest, and what is found.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    pub fn finish(mut self) -> Result<Candidates, GraphError> {
        self.advance(usize::MAX)?;
        Ok(self.picker.finish())
    }

    fn tile(&mut self) -> Result<(), GraphError> {
        let (Some(a), Some(b)) = (self.parts.get(self.next.0), self.parts.get(self.next.1)) else {
            return Ok(());
        };
        let window = self.options.blend_window;
        let mut terms = PairTerms::of_clouds(&a.clouds, &b.clouds)?;
        terms.finish();
        let everything = 0..usize::MAX;
        let distances = terms.distances(window, &everything, &everything)?;
        let align = |leave: Place, enter: Place| {
            let [p, q] = [leave, enter].map(|place| self.set.clip(place.clip).and_then(|source| source.frames().get(place.frame)));
            let fallback = p.zip(q).map_or(0.0, |(p, q)| p.yaw - q.yaw);
            Ok(terms.alignment(leave.frame, enter.frame, window, fallback)?.transform)
        };
        let at = |row: usize, column: usize| distances.get(row, column);
        let only_minima = self.options.construction == Construction::Minima;
        for i in a.starts.clone() {
            if !only_minima && !self.options.is_end(&self.set, Place { clip: a.clip, frame: i }) {
                continue;
            }
            let row = i - a.from;
            let cells = distances.row(row);
            for j in b.starts.clone() {
                let column = j - b.from;
                let Some(&distance) = cells.get(column) else { continue };
                let (leave, enter) = (Place { clip: a.clip, frame: i }, Place { clip: b.clip, frame: j });
                // Of a clip with itself only one half counts.
                if leave < enter && self.picker.is_worth(distance) && (only_minima || self.options.is_end(&self.set, enter)) {
                    let minimum = || !only_minima || is_minimum(at, row, column);
                    self.picker.offer(leave, enter, distance, minimum, align)?;
                }
            }
        }
        Ok(())
    }
}
