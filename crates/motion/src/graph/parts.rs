use super::distances::level_m;
use super::{FrameSet, GraphError, Place};
use crate::registration::{DistanceMatrix, PairTerms, PointClouds};
use std::ops::Range;
use std::sync::Arc;

/// Frames of a part.
pub(super) const PART: usize = 256;

/// All windows of a set in parts of at most [`PART`], each with its points: a tile of the matrix of
/// all distances is made of two of them. Parts are cut at the ends of clips and at every
/// [`PART`]-th frame of the set, so that a picture of the matrix that is cut likewise is made of
/// whole tiles.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    set: Arc<FrameSet>,
    window: usize,
    level_m: f64,
    /// What is still to be made, the next one last.
    to_come: Vec<(usize, Range<usize>)>,
    made: Vec<Part>,
}

/// A part of a clip: the windows that start in `starts`, and one more to either side, so that a
/// minimum is seen to be one.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) clip: usize,
    pub(super) starts: Range<usize>,
    /// The number in the set of the first window's first frame.
    pub(super) number: usize,
    /// The first frame of the clouds.
    pub(super) from: usize,
    clouds: PointClouds,
}

impl Part {
    /// The numbers in the set of its windows' first frames.
    pub(super) fn numbers(&self) -> Range<usize> {
        self.number..self.number + self.starts.len()
    }

    /// The pairs of frames of this and another part, and the distances of all their windows, also
    /// of those to either side.
    pub(super) fn tile(
        &self,
        other: &Self,
        window: usize,
    ) -> Result<(PairTerms, DistanceMatrix), GraphError> {
        let mut terms = PairTerms::of_clouds(&self.clouds, &other.clouds)?;
        terms.finish();
        let everything = 0..usize::MAX;
        let distances = terms.distances(window, &everything, &everything)?;
        Ok((terms, distances))
    }
}

impl Parts {
    /// None is made yet.
    pub(super) fn new(set: &Arc<FrameSet>, window: usize) -> Result<Self, GraphError> {
        let mut to_come = Vec::new();
        for clip in 0..set.clips().len() {
            let windows = (set.frames_of(clip) + 1).saturating_sub(window);
            let first = set.number(Place { clip, frame: 0 }).unwrap_or(0);
            let mut start = 0;
            while start < windows {
                let end = ((first + start) / PART + 1) * PART - first;
                to_come.push((clip, start..end.min(windows)));
                start = end;
            }
        }
        to_come.reverse();
        Ok(Self {
            window,
            level_m: level_m(set)?,
            set: Arc::clone(set),
            made: Vec::with_capacity(to_come.len()),
            to_come,
        })
    }

    /// Makes the next one; false when there is none.
    pub(super) fn advance(&mut self) -> Result<bool, GraphError> {
        let Some((clip, starts)) = self.to_come.pop() else {
            return Ok(false);
        };
        if let (Some(source), Some(number)) =
            (self.set.clip(clip), self.set.number(Place { clip, frame: starts.start }))
        {
            let from = starts.start.saturating_sub(1);
            self.made.push(Part {
                clip,
                number,
                from,
                clouds: PointClouds::new(
                    source.clip(),
                    from..starts.end + self.window,
                    self.set.weights(),
                    1,
                    self.level_m,
                )?,
                starts,
            });
        }
        Ok(true)
    }

    /// The clips.
    pub(super) fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Frames of each window.
    pub(super) fn window(&self) -> usize {
        self.window
    }

    /// How many there are to be.
    pub(super) fn count(&self) -> usize {
        self.made.len() + self.to_come.len()
    }

    /// Those that are made.
    pub(super) fn made(&self) -> &[Part] {
        &self.made
    }

    /// The indices of those with windows that start in these frames of the set.
    pub(super) fn between(&self, numbers: &Range<usize>) -> Range<usize> {
        let first = self.made.partition_point(|part| part.numbers().end <= numbers.start);
        let end = self.made.partition_point(|part| part.number < numbers.end);
        first..end.max(first)
    }
}
