//! Candidates of clips that are too long for storing all pairs.

use super::candidates::{Picker, is_minimum};
use super::parts::Parts;
use super::{
    CandidateSort, Candidates, Construction, DistanceOverview, FrameSet, GraphError, GraphOptions,
    Place, TileCandidates,
};
use crate::registration::Progress;
use std::sync::Arc;

/// The search for [`Candidates`] in clips that are too long for storing all pairs: tile after tile
/// of 512 × 512 windows is compared, searched, and dropped. A [`DistanceOverview`] remains.
///
/// 30,000 frames of 31 joints are 1,800 tiles of 3 ms each. They take 1.5 MB at a time in addition
/// to the points (16 bytes per joint and frame), the overview (8 MB) and the candidates. A new
/// window or threshold needs a new search.
#[derive(Clone, Debug)]
pub struct CandidateStream {
    options: GraphOptions,
    picker: Picker,
    work: Work,
    /// Parts made and tiles done.
    done: usize,
    total: usize,
}

/// The two stages: first the parts are made, then their tiles.
#[derive(Clone, Debug)]
enum Work {
    Parts(Arc<Parts>),
    Tiles {
        parts: Arc<Parts>,
        overview: Box<DistanceOverview>,
        /// The next tile: parts a ≤ b.
        next: (usize, usize),
    },
}

impl Work {
    fn tiles(parts: Arc<Parts>) -> Self {
        Self::Tiles {
            overview: Box::new(DistanceOverview::new(Arc::clone(&parts))),
            parts,
            next: (0, 0),
        }
    }
}

impl CandidateStream {
    /// Prepares the search.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips.
    pub fn new(set: &Arc<FrameSet>, options: &GraphOptions) -> Result<Self, GraphError> {
        options.check(set)?;
        let parts = Parts::new(set, options.blend_window)?;
        let count = parts.count();
        Ok(Self {
            options: *options,
            picker: Picker::new(Arc::clone(set), *options),
            work: Work::Parts(Arc::new(parts)),
            done: 0,
            total: count + count * (count + 1) / 2,
        })
    }

    /// Returns the number of parts, into which the rows of the matrix are divided.
    #[must_use]
    pub fn parts(&self) -> usize {
        match &self.work {
            Work::Parts(parts) | Work::Tiles { parts, .. } => parts.count(),
        }
    }

    /// Returns whether all parts are prepared, so that rows can be included.
    #[must_use]
    pub fn is_prepared(&self) -> bool {
        matches!(self.work, Work::Tiles { .. })
    }

    /// Includes the comparison of a part with itself and all parts behind it, which was computed
    /// elsewhere ([`StreamComputer`]), in place of a step for each. All parts must be prepared, and
    /// each row included once, in any order.
    pub fn include(&mut self, row: StreamRow) {
        if let Work::Tiles { parts, overview, .. } = &mut self.work {
            self.done += parts.count().saturating_sub(row.part);
            overview.include(&row);
            self.picker.absorb(row.candidates);
        }
    }

    /// Processes up to `steps` more steps, and returns the progress: each step prepares one part,
    /// or compares two. A step takes about 3 ms, in a browser 4 ms.
    ///
    /// # Errors
    /// [`GraphError::Registration`] when a position is not finite.
    pub fn advance(&mut self, steps: usize) -> Result<Progress, GraphError> {
        for _ in 0..steps.min(self.total - self.done) {
            self.step()?;
            self.done += 1;
        }
        Ok(self.progress())
    }

    /// Returns the progress, in steps.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { done: self.done, total: self.total }
    }

    /// Processes the remaining steps and returns candidates and overview.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn finish(self) -> Result<(Candidates, DistanceOverview), GraphError> {
        let (sort, overview) = self.into_sort()?;
        Ok((sort.finish(), overview))
    }

    /// Processes the remaining steps and returns the sort of the candidates, and the overview.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn into_sort(mut self) -> Result<(CandidateSort, DistanceOverview), GraphError> {
        self.advance(usize::MAX)?;
        let overview = match self.work {
            Work::Tiles { overview, .. } => *overview,
            Work::Parts(parts) => DistanceOverview::new(parts),
        };
        Ok((self.picker.into_sort(), overview))
    }

    fn step(&mut self) -> Result<(), GraphError> {
        match &mut self.work {
            Work::Parts(parts) => {
                Arc::make_mut(parts).advance()?;
                if parts.made().len() == parts.count() {
                    self.work = Work::tiles(Arc::clone(parts));
                }
                Ok(())
            }
            Work::Tiles { parts, overview, next } => {
                let (a, b) = *next;
                *next = if b + 1 < parts.count() { (a, b + 1) } else { (a + 1, a + 1) };
                compare_parts(&self.options, &mut self.picker, parts, (a, b), overview)
            }
        }
    }
}

/// The comparison of one part of a set with itself and all parts behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamRow {
    /// The number of the part.
    pub part: usize,
    /// The smallest distances in the blocks of the overview, metres: row by row from the first row
    /// that the part belongs to, each row from the diagonal on; infinity where no window starts.
    pub nearest_m: Vec<f32>,
    /// The number of pairs of windows in each range of the overview's histogram.
    pub counts: Vec<u32>,
    /// The candidates for transitions.
    pub candidates: TileCandidates,
}

/// The computation of the rows of a [`CandidateStream`], in any order. All rows together give its
/// result, to the last bit.
#[derive(Debug)]
pub struct StreamComputer {
    parts: Arc<Parts>,
}

impl StreamComputer {
    /// Prepares the parts of a set for windows of `window` frames.
    ///
    /// # Errors
    /// [`GraphError`] without clips, or when a position is not finite.
    pub fn new(set: &Arc<FrameSet>, window: usize) -> Result<Self, GraphError> {
        let mut parts = Parts::new(set, window)?;
        while parts.advance()? {}
        Ok(Self { parts: Arc::new(parts) })
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        self.parts.window()
    }

    /// Compares a part with itself and all parts behind it.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips.
    pub fn row(&self, part: usize, options: &GraphOptions) -> Result<StreamRow, GraphError> {
        options.check(self.parts.set())?;
        let options = GraphOptions { blend_window: self.window(), ..*options };
        let mut picker = Picker::new(Arc::clone(self.parts.set()), options);
        let mut overview = DistanceOverview::new(Arc::clone(&self.parts));
        for other in part..self.parts.count() {
            compare_parts(&options, &mut picker, &self.parts, (part, other), &mut overview)?;
        }
        let (nearest_m, counts) = overview.into_row(part);
        Ok(StreamRow { part, nearest_m, counts, candidates: picker.into_tile() })
    }
}

/// Compares two parts a ≤ b: offers their windows to the picker, and includes their distances in
/// the overview. A separate function, because browsers optimise a function between two of its
/// calls.
#[inline(never)]
fn compare_parts(
    options: &GraphOptions,
    picker: &mut Picker,
    parts: &Parts,
    (a, b): (usize, usize),
    overview: &mut DistanceOverview,
) -> Result<(), GraphError> {
    let (Some(a), Some(b)) = (parts.made().get(a), parts.made().get(b)) else {
        return Ok(());
    };
    let (set, window) = (parts.set(), options.blend_window);
    let everything = 0..usize::MAX;
    let mut sweep = a.sweep(b, window, [&everything; 2]);
    let only_minima = options.construction == Construction::Minima;
    for i in a.starts.clone() {
        let leave = Place { clip: a.clip, frame: i };
        let row = i - a.from;
        // Minima are recognised by the rows to either side.
        sweep.advance(row + 2);
        let align = |leave: Place, enter: Place| {
            let [p, q] = [leave, enter].map(|place| {
                set.clip(place.clip).and_then(|source| source.ground_frames().get(place.frame))
            });
            let fallback = p.zip(q).map_or(0.0, |(p, q)| p.yaw - q.yaw);
            Ok(sweep.alignment(leave.frame, enter.frame, fallback)?.transform)
        };
        let cells = sweep.row(row);
        // Distances within one clip are symmetric: each pair is offered once.
        let first = if a.clip == b.clip { b.starts.start.max(i + 1) } else { b.starts.start };
        if only_minima {
            let cell = |row, column| sweep.row(row).get(column).copied();
            let minimum = |column| is_minimum(cell, row, column);
            let places = [leave, Place { clip: b.clip, frame: b.from }];
            let within = first - b.from..b.starts.end - b.from;
            picker.offer_minima(places, cells, within, minimum, align)?;
        } else if options.is_end(set, leave) {
            for j in first..b.starts.end {
                let enter = Place { clip: b.clip, frame: j };
                if let Some(&distance) = cells.get(j - b.from)
                    && picker.is_worth(distance)
                    && options.is_end(set, enter)
                {
                    picker.offer(leave, enter, distance, || true, align)?;
                }
            }
        }
    }
    overview.take(a, b, &sweep.finish());
    Ok(())
}
