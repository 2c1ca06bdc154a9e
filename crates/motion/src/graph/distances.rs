//! Distances between all windows of a set of clips.

use super::tiles::row_start;
use super::{DistanceTile, FrameSet, GraphError, Place};
use crate::registration::{
    Alignment, DistanceMatrix, MAX_PAIRS, PairTerms, PausedSelfSweep, PausedSweep, PointClouds,
    PointCloudsBuilder, Progress, ROWS_PER_SUM, RegistrationError, SelfSweep, SelfTerms, Sweep,
    SymmetricDistances,
};
use std::sync::Arc;

/// The cost of the kinematics of one frame, in pairs compared (for progress).
pub(super) const PAIRS_PER_FRAME: usize = 250;

/// The terms of all pairs of frames of a set, clip by clip, from which the distances of windows of
/// any length follow ([`PairTerms`]). Every pair is compared once: the distance of two windows is
/// symmetric.
///
/// It is computed in slices. 6,000 frames are 18 million pairs, 216 MB and about 0.2 s; for more
/// than 11,500 frames use [`CandidateStream`](super::CandidateStream), which does not store them.
#[derive(Clone, Debug)]
pub struct AllPairs {
    set: Arc<FrameSet>,
    level_m: f64,
    /// The points of the next clip.
    begun: Option<PointCloudsBuilder>,
    clouds: Vec<PointClouds>,
    /// (a, b) with a ≤ b, row by row, as far as they are begun.
    blocks: Vec<Block>,
    /// Number of pairs in all blocks but the last.
    done: usize,
}

#[derive(Clone, Debug)]
enum Block {
    Itself(SelfTerms, usize),
    Pair(PairTerms, usize),
}

impl Block {
    /// Returns the pairs done and the pairs in all.
    fn pairs(&self) -> (usize, usize) {
        match self {
            Self::Itself(terms, n) => {
                let left = |rows: usize| rows * (rows + 1) / 2;
                (left(*n) - left(n - terms.progress().done), left(*n))
            }
            Self::Pair(terms, columns) => {
                (terms.progress().done * columns, terms.progress().total * columns)
            }
        }
    }

    fn advance(&mut self, pairs: usize) {
        match self {
            Self::Itself(terms, n) => {
                let columns = (*n - terms.progress().done).max(1);
                terms.advance(pairs.div_ceil(columns));
            }
            Self::Pair(terms, columns) => {
                terms.advance(pairs.div_ceil(*columns));
            }
        }
    }
}

impl AllPairs {
    /// Prepares the comparison. Nothing is compared yet: call [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`GraphError::Registration`] when there are more than 67 million pairs (12 bytes each).
    pub fn new(set: Arc<FrameSet>) -> Result<Self, GraphError> {
        let frames = set.frames();
        let pairs = frames.saturating_mul(frames.saturating_add(1)) / 2;
        if pairs > MAX_PAIRS {
            let stride = (pairs as f64 / MAX_PAIRS as f64).sqrt().ceil() as usize;
            return Err(RegistrationError::TooManyPairs { pairs, most: MAX_PAIRS, stride }.into());
        }
        Ok(Self {
            level_m: level_m(&set)?,
            set,
            begun: None,
            clouds: Vec::new(),
            blocks: Vec::new(),
            done: 0,
        })
    }

    /// Returns the frames that are compared.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Compares about `pairs` more pairs of frames, and returns the progress. 100,000 take about a
    /// millisecond. The points of the frames are computed first, which counts as 250 pairs a frame.
    ///
    /// # Errors
    /// [`GraphError::Registration`] when a position is not finite.
    pub fn advance(&mut self, pairs: usize) -> Result<Progress, GraphError> {
        let until = self.progress().done.saturating_add(pairs.max(1));
        while self.clouds.len() < self.set.clips().len() && self.progress().done < until {
            self.find_points((until - self.progress().done).div_ceil(PAIRS_PER_FRAME))?;
        }
        while self.progress().done < until && self.has_block()? {
            let left = until - self.progress().done;
            if let Some(block) = self.blocks.last_mut() {
                block.advance(left);
            }
        }
        Ok(self.progress())
    }

    /// Computes the points of at least `frames` more frames of a clip.
    fn find_points(&mut self, frames: usize) -> Result<(), GraphError> {
        let Some(source) = self.set.clip(self.clouds.len()) else {
            return Ok(());
        };
        let clip = source.clip();
        let mut begun = match self.begun.take() {
            Some(begun) => begun,
            None => PointCloudsBuilder::new(
                clip,
                0..clip.frames(),
                self.set.weights(),
                1,
                self.level_m,
            )?,
        };
        if begun.advance(clip, frames)?.is_complete() {
            self.clouds.push(begun.finish(clip)?);
        } else {
            self.begun = Some(begun);
        }
        Ok(())
    }

    /// Returns whether a block is in progress, after beginning the next one if possible.
    fn has_block(&mut self) -> Result<bool, GraphError> {
        let last = self.blocks.last().map(Block::pairs);
        if last.is_some_and(|(done, total)| done < total) {
            return Ok(true);
        }
        let clips = self.clouds.len();
        let mut next =
            (0..clips).flat_map(|a| (a..clips).map(move |b| (a, b))).skip(self.blocks.len());
        let Some((a, b)) = next.next() else {
            return Ok(false);
        };
        let (source, target) = (&self.clouds[a], &self.clouds[b]);
        self.blocks.push(if a == b {
            Block::Itself(SelfTerms::new(source)?, source.samples())
        } else {
            Block::Pair(PairTerms::of_clouds(source, target)?, target.samples())
        });
        self.done += last.map_or(0, |(_, total)| total);
        Ok(true)
    }

    /// Compares all remaining pairs.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn finish(&mut self) -> Result<(), GraphError> {
        self.advance(usize::MAX).map(|_| ())
    }

    /// Returns the progress, in pairs of frames.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let frames = self.set.frames();
        let known: usize = self.clouds.iter().map(PointClouds::samples).sum();
        let known = known + self.begun.as_ref().map_or(0, PointCloudsBuilder::done);
        let pairs = self.done + self.blocks.last().map_or(0, |block| block.pairs().0);
        Progress {
            done: PAIRS_PER_FRAME * known + pairs,
            total: PAIRS_PER_FRAME * frames + frames * (frames + 1) / 2,
        }
    }

    /// Returns the computation of the distances of all windows of `window` frames (0 counts as 1),
    /// in slices.
    ///
    /// # Errors
    /// [`GraphError::Registration`] before all pairs are compared.
    pub fn sweep(&self, window: usize) -> Result<AllSweep<'_>, GraphError> {
        let Progress { done, total } = self.progress();
        if done < total {
            return Err(RegistrationError::Unfinished { done, total }.into());
        }
        Ok(AllSweep { all: self, window: window.max(1), blocks: Vec::new(), now: None })
    }

    /// Computes [`Self::sweep`] in one call.
    ///
    /// # Errors
    /// [`GraphError::Registration`] before all pairs are compared.
    pub fn distances(&self, window: usize) -> Result<FrameDistances, GraphError> {
        self.sweep(window)?.finish()
    }

    /// Returns the alignment of the window of `window` frames from frame `b` with that from frame
    /// `a`: `a_world_from_b_world`. O(window).
    ///
    /// # Errors
    /// [`GraphError::Registration`] before all pairs are compared, or when a window crosses the end
    /// of its clip.
    pub fn alignment(&self, a: Place, b: Place, window: usize) -> Result<Alignment, GraphError> {
        let (first, second) = (a.min(b), a.max(b));
        let facing = |place: Place| {
            let source = self.set.clip(place.clip);
            source
                .and_then(|source| source.ground_frames().get(place.frame))
                .map_or(0.0, |frame| frame.yaw)
        };
        let fallback = facing(first) - facing(second);
        let found = match self.blocks.get(block_of(self.set.clips().len(), first.clip, second.clip))
        {
            Some(Block::Itself(terms, _)) => {
                terms.alignment(first.frame, second.frame, window, fallback)?
            }
            Some(Block::Pair(terms, _)) => {
                terms.alignment(first.frame, second.frame, window, fallback)?
            }
            None => return Err(GraphError::NoClips),
        };
        let transform = if a <= b { found.transform } else { found.transform.inverse() };
        Ok(Alignment { transform, ..found })
    }
}

/// Returns the origin of heights: the middle of the body in the first frame.
pub(super) fn level_m(set: &FrameSet) -> Result<f64, GraphError> {
    let first = set.clip(0).ok_or(GraphError::NoClips)?;
    Ok(PointClouds::level_m(first.clip(), set.weights())?)
}

/// Returns the index of the block of clips a ≤ b.
fn block_of(clips: usize, a: usize, b: usize) -> usize {
    (a * clips + b).saturating_sub(a * (a + 1) / 2)
}

/// The running sums of all pairs of clips, in progress.
#[derive(Clone, Debug)]
pub struct AllSweep<'a> {
    all: &'a AllPairs,
    window: usize,
    blocks: Vec<BlockDistances>,
    now: Option<BlockSweep<'a>>,
}

#[derive(Clone, Debug)]
enum BlockSweep<'a> {
    Itself(SelfSweep<'a>),
    Pair(Sweep<'a>),
}

/// An [`AllSweep`] that does not borrow the terms until it is resumed.
#[derive(Clone, Debug)]
pub struct PausedAllSweep {
    window: usize,
    blocks: Vec<BlockDistances>,
    now: Option<PausedBlockSweep>,
}

#[derive(Clone, Debug)]
enum PausedBlockSweep {
    Itself(PausedSelfSweep),
    Pair(PausedSweep),
}

impl PausedAllSweep {
    /// Resumes the sweep. `all` is that from which it was made.
    #[must_use]
    pub fn resume(self, all: &AllPairs) -> AllSweep<'_> {
        let now = match (self.now, all.blocks.get(self.blocks.len())) {
            (Some(PausedBlockSweep::Itself(sweep)), Some(Block::Itself(terms, _))) => {
                Some(BlockSweep::Itself(sweep.resume(terms)))
            }
            (Some(PausedBlockSweep::Pair(sweep)), Some(Block::Pair(terms, _))) => {
                Some(BlockSweep::Pair(sweep.resume(terms)))
            }
            _ => None,
        };
        AllSweep { all, window: self.window, blocks: self.blocks, now }
    }

    /// Returns the number of frames of the windows.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }

    /// Returns the progress, in pairs of clips.
    #[must_use]
    pub fn progress(&self, all: &AllPairs) -> Progress {
        Progress { done: self.blocks.len(), total: all.blocks.len() }
    }
}

impl AllSweep<'_> {
    /// Stops borrowing the terms, so that the rest can be computed later.
    #[must_use]
    pub fn pause(self) -> PausedAllSweep {
        PausedAllSweep {
            window: self.window,
            blocks: self.blocks,
            now: self.now.map(|now| match now {
                BlockSweep::Itself(sweep) => PausedBlockSweep::Itself(sweep.pause()),
                BlockSweep::Pair(sweep) => PausedBlockSweep::Pair(sweep.pause()),
            }),
        }
    }

    /// Computes up to `rows` more rows of a pair of clips, and returns the progress in pairs of
    /// clips.
    ///
    /// # Errors
    /// [`GraphError::Registration`] when the terms are not complete.
    pub fn advance(&mut self, rows: usize) -> Result<Progress, GraphError> {
        let total = self.all.blocks.len();
        if let Some(block) = self.all.blocks.get(self.blocks.len()) {
            let everything = 0..usize::MAX;
            let mut now = match (self.now.take(), block) {
                (Some(now), _) => now,
                (None, Block::Itself(terms, _)) => BlockSweep::Itself(terms.sweep(self.window)?),
                (None, Block::Pair(terms, _)) => {
                    BlockSweep::Pair(terms.sweep(self.window, &everything, &everything)?)
                }
            };
            let complete = match &mut now {
                BlockSweep::Itself(sweep) => sweep.advance(rows).is_complete(),
                BlockSweep::Pair(sweep) => sweep.advance(rows).is_complete(),
            };
            if complete {
                self.blocks.push(match now {
                    BlockSweep::Itself(sweep) => BlockDistances::Itself(sweep.finish()),
                    BlockSweep::Pair(sweep) => BlockDistances::Pair(sweep.finish()),
                });
            } else {
                self.now = Some(now);
            }
        }
        Ok(Progress { done: self.blocks.len(), total })
    }

    /// Computes the remaining rows and returns the distances.
    ///
    /// # Errors
    /// [`GraphError::Registration`] when the terms are not complete.
    pub fn finish(mut self) -> Result<FrameDistances, GraphError> {
        while !self.advance(usize::MAX)?.is_complete() {}
        Ok(FrameDistances {
            set: Arc::clone(&self.all.set),
            window: self.window,
            blocks: self.blocks,
        })
    }
}

/// The distances between all windows of one length of a set.
#[derive(Clone, Debug)]
pub struct FrameDistances {
    set: Arc<FrameSet>,
    window: usize,
    blocks: Vec<BlockDistances>,
}

impl PartialEq for FrameDistances {
    fn eq(&self, other: &Self) -> bool {
        let same = |(one, other): (&BlockDistances, &BlockDistances)| {
            let rows = 0..one.size().0;
            one.size() == other.size() && rows.into_iter().all(|row| one.row(row) == other.row(row))
        };
        (self.window, self.blocks.len()) == (other.window, other.blocks.len())
            && self.set == other.set
            && self.blocks.iter().zip(&other.blocks).all(same)
    }
}

/// The distances of one pair of clips.
#[derive(Clone, Debug)]
pub(super) enum BlockDistances {
    Itself(SymmetricDistances),
    Pair(DistanceMatrix),
    Tiled(TiledDistances),
}

/// Distances that were computed as tiles.
#[derive(Clone, Debug, Default)]
pub(super) struct TiledDistances {
    is_itself: bool,
    rows: usize,
    columns: usize,
    /// [`ROWS_PER_SUM`] rows each.
    tiles: Vec<Vec<f32>>,
}

impl TiledDistances {
    fn row(&self, row: usize) -> &[f32] {
        if row >= self.rows {
            return &[];
        }
        let first = row / ROWS_PER_SUM * ROWS_PER_SUM;
        let [own, next] =
            [row, row + 1].map(|row| row_start(self.is_itself, self.columns, first, row));
        let tile = self.tiles.get(row / ROWS_PER_SUM);
        tile.and_then(|tile| tile.get(own..next)).unwrap_or_default()
    }
}

impl BlockDistances {
    /// Returns (rows, columns).
    pub(super) fn size(&self) -> (usize, usize) {
        match self {
            Self::Itself(distances) => (distances.rows(), distances.rows()),
            Self::Pair(distances) => (distances.rows(), distances.columns()),
            Self::Tiled(distances) => (distances.rows, distances.columns),
        }
    }

    /// Returns whether a clip is compared with itself.
    fn is_itself(&self) -> bool {
        match self {
            Self::Itself(_) => true,
            Self::Pair(_) => false,
            Self::Tiled(distances) => distances.is_itself,
        }
    }

    pub(super) fn get(&self, row: usize, column: usize) -> Option<f32> {
        match self {
            Self::Itself(distances) => distances.get(row, column),
            Self::Pair(distances) => distances.get(row, column),
            Self::Tiled(distances) if distances.is_itself => {
                distances.row(row.min(column)).get(row.abs_diff(column)).copied()
            }
            Self::Tiled(distances) => distances.row(row).get(column).copied(),
        }
    }

    /// Returns the stored part of a row: its first column, and the distances.
    pub(super) fn row(&self, row: usize) -> (usize, &[f32]) {
        match self {
            Self::Itself(distances) => (row, distances.row(row)),
            Self::Pair(distances) => (0, distances.row(row)),
            Self::Tiled(distances) => {
                (if distances.is_itself { row } else { 0 }, distances.row(row))
            }
        }
    }
}

/// The position up to which a histogram is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CountedTo {
    block: usize,
    row: usize,
}

impl FrameDistances {
    /// Returns the distances that were computed as the tiles of [`DistanceTile::all`], which may
    /// come in any order; missing ones have no distances.
    #[must_use]
    pub fn of_tiles(
        set: &Arc<FrameSet>,
        window: usize,
        tiles: impl IntoIterator<Item = (DistanceTile, Vec<f32>)>,
    ) -> Self {
        let (window, clips) = (window.max(1), set.clips().len());
        let windows = |clip: usize| (set.frames_of(clip) + 1).saturating_sub(window);
        let mut blocks: Vec<TiledDistances> = (0..clips)
            .flat_map(|a| (a..clips).map(move |b| (a, b)))
            .map(|(a, b)| TiledDistances {
                is_itself: a == b,
                rows: windows(a),
                columns: windows(b),
                tiles: vec![Vec::new(); windows(a).div_ceil(ROWS_PER_SUM)],
            })
            .collect();
        for (DistanceTile { a, b, rows }, distances) in tiles {
            let block = if b < clips { blocks.get_mut(block_of(clips, a, b)) } else { None };
            let place = block.and_then(|block| block.tiles.get_mut(rows.start / ROWS_PER_SUM));
            if let Some(place) = place {
                *place = distances;
            }
        }
        let blocks = blocks.into_iter().map(BlockDistances::Tiled).collect();
        Self { set: Arc::clone(set), window, blocks }
    }

    /// Returns the frames that are compared.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }

    /// Returns the distance of the windows that start at two frames, centimetres; `None` where a
    /// window crosses the end of its clip.
    #[must_use]
    pub fn cm(&self, a: Place, b: Place) -> Option<f64> {
        let (a, b) = (a.min(b), a.max(b));
        let block = self.block(a.clip, b.clip)?;
        Some(self.set.rounded_cm(block.get(a.frame, b.frame)?))
    }

    /// Returns the distances of clips a ≤ b.
    pub(super) fn block(&self, a: usize, b: usize) -> Option<&BlockDistances> {
        let clips = self.set.clips().len();
        if b >= clips {
            return None;
        }
        self.blocks.get(block_of(clips, a, b))
    }

    /// Returns a picture of a part of the matrix: `rows` and `columns` are frames of the set, every
    /// value is the mean distance (centimetres) of a square of `factor` × `factor` of them, of
    /// which at most 4 × 4 are sampled, row-major; NaN where no window starts.
    #[must_use]
    pub fn picture(
        &self,
        rows: std::ops::Range<usize>,
        columns: std::ops::Range<usize>,
        factor: usize,
    ) -> Vec<f32> {
        let factor = factor.max(1);
        let places = |range: std::ops::Range<usize>| -> Vec<Option<Place>> {
            let range = range.start.min(self.set.frames())..range.end.min(self.set.frames());
            range.map(|frame| self.set.place(frame)).collect()
        };
        let (rows, columns) = (places(rows), places(columns));
        let scale = self.set.cm_per_m() as f32;
        let every = factor.div_ceil(4);
        let mut picture = Vec::new();
        for rows in rows.chunks(factor) {
            for columns in columns.chunks(factor) {
                let (mut sum, mut count) = (0.0, 0);
                for &a in rows.iter().step_by(every).flatten() {
                    for &b in columns.iter().step_by(every).flatten() {
                        let (a, b) = (a.min(b), a.max(b));
                        if let Some(found) =
                            self.block(a.clip, b.clip).and_then(|block| block.get(a.frame, b.frame))
                        {
                            sum += found;
                            count += 1;
                        }
                    }
                }
                picture.push(sum / count as f32 * scale);
            }
        }
        picture
    }

    /// Returns the number of pairs of windows in each of `bins` ranges of `bin_cm` centimetres; the
    /// last range is open. Every pair counts once, a window with itself does not.
    #[must_use]
    pub fn histogram(&self, bin_cm: f64, bins: usize) -> Vec<u32> {
        let mut counts = vec![0_u32; bins.max(1)];
        self.count(&mut CountedTo::default(), usize::MAX, bin_cm, &mut counts);
        counts
    }

    /// Adds about `cells` more pairs of windows, at least one row, from position `at` on, to the
    /// counts of [`Self::histogram`]; returns `true` after the last.
    pub fn count(&self, at: &mut CountedTo, cells: usize, bin_cm: f64, counts: &mut [u32]) -> bool {
        let mut left = cells.max(1);
        while left > 0 && at.block < self.blocks.len() {
            let Some(block) = self.blocks.get(at.block) else {
                break;
            };
            let (rows, columns) = block.size();
            let end = (at.row + left.div_ceil(columns.max(1))).min(rows);
            self.count_rows(block, at.row..end, bin_cm, counts);
            left = left.saturating_sub((end - at.row) * columns);
            *at = if end < rows {
                CountedTo { row: end, ..*at }
            } else {
                CountedTo { block: at.block + 1, row: 0 }
            };
        }
        at.block >= self.blocks.len()
    }

    fn count_rows(
        &self,
        block: &BlockDistances,
        rows: std::ops::Range<usize>,
        bin_cm: f64,
        counts: &mut [u32],
    ) {
        for row in rows {
            let (_, distances) = block.row(row);
            let itself = usize::from(block.is_itself());
            let cells = distances.get(itself..).unwrap_or_default();
            count_cells(cells, self.set.cm_per_m(), bin_cm, counts);
        }
    }
}

/// Adds distances, metres, to the counts of a histogram whose last range is open.
pub(super) fn count_cells(cells: &[f32], cm_per_m: f64, bin_cm: f64, counts: &mut [u32]) {
    let Some(last) = counts.len().checked_sub(1) else {
        return;
    };
    let scale = if bin_cm > 0.0 { (cm_per_m / bin_cm) as f32 } else { f32::MAX };
    for &distance in cells {
        counts[((distance * scale) as usize).min(last)] += 1;
    }
}
