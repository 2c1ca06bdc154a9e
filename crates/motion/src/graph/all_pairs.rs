//! The comparison of all pairs of frames of a set of clips, in slices.

use super::distances::{BlockDistances, FrameDistances, block_of};
use super::{FrameSet, GraphError, Place};
use crate::registration::{
    Alignment, MAX_PAIRS, PairTerms, PausedSelfSweep, PausedSweep, PointClouds, PointCloudsBuilder,
    Progress, RegistrationError, SelfSweep, SelfTerms, Sweep,
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
    /// [`GraphError::Registration`] before the pairs of the windows are compared, or when a window
    /// crosses the end of its clip.
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
