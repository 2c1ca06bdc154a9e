//! Parts of clips, of which the matrix of all distances is tiled.

use super::all_pairs::level_m;
use super::{FrameSet, GraphError, Place};
use crate::registration::{PointClouds, RowSweep, check_pairs};
use std::ops::Range;
use std::sync::Arc;

/// The greatest number of windows of a part.
///
/// Small parts compare the frames of the window behind each part too often; large ones waste more
/// on parts with themselves, where every pair is compared twice. 512 was the fastest measured.
pub(super) const PART: usize = 512;

/// All windows of a set in parts of at most [`PART`], each with its points: two of them make a tile
/// of the matrix of all distances. Parts are cut at the ends of clips and at every [`PART`]-th
/// frame of the set, where pictures of the matrix are cut, too.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    set: Arc<FrameSet>,
    window: usize,
    level_m: f64,
    /// The parts that are not made yet, the next one last.
    remaining: Vec<(usize, Range<usize>)>,
    made: Vec<Part>,
}

/// A part of a clip: the windows that start in `starts`, and one more to either side, by which
/// minima are recognised.
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
    /// Returns the numbers in the set of its windows' first frames.
    pub(super) fn numbers(&self) -> Range<usize> {
        self.number..self.number + self.starts.len()
    }

    /// Returns the frames of its clip with these numbers in the set, which are among its own.
    pub(super) fn frames(&self, numbers: &Range<usize>) -> Range<usize> {
        let frame = |number: usize| self.starts.start + number.saturating_sub(self.number);
        frame(numbers.start)..frame(numbers.end)
    }

    /// Returns the computation of the distances of the windows of this and another part that start
    /// in these frames of their clips; they may start one frame to either side of the parts.
    pub(super) fn sweep(
        &self,
        other: &Self,
        window: usize,
        frames: [&Range<usize>; 2],
    ) -> RowSweep {
        RowSweep::new([&self.clouds, &other.clouds], window, frames)
    }
}

impl Parts {
    /// Returns the parts, none of which is made yet.
    ///
    /// # Errors
    /// [`GraphError`] without clips, or when a window has too many frames for comparing two parts.
    pub(super) fn new(set: &Arc<FrameSet>, window: usize) -> Result<Self, GraphError> {
        let frames = window.saturating_add(PART);
        check_pairs(frames.saturating_mul(frames), || 2)?;
        let mut remaining = Vec::new();
        for clip in 0..set.clips().len() {
            let windows = (set.frames_of(clip) + 1).saturating_sub(window);
            let first = set.number(Place { clip, frame: 0 }).unwrap_or(0);
            let mut start = 0;
            while start < windows {
                let end = ((first + start) / PART + 1) * PART - first;
                remaining.push((clip, start..end.min(windows)));
                start = end;
            }
        }
        remaining.reverse();
        Ok(Self {
            window,
            level_m: level_m(set)?,
            set: Arc::clone(set),
            made: Vec::with_capacity(remaining.len()),
            remaining,
        })
    }

    /// Makes the next part; returns `false` when there is none.
    pub(super) fn advance(&mut self) -> Result<bool, GraphError> {
        let Some((clip, starts)) = self.remaining.pop() else {
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

    /// Returns the clips.
    pub(super) fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Returns the number of frames of each window.
    pub(super) fn window(&self) -> usize {
        self.window
    }

    /// Returns the number of parts.
    pub(super) fn count(&self) -> usize {
        self.made.len() + self.remaining.len()
    }

    /// Returns the parts that are made.
    pub(super) fn made(&self) -> &[Part] {
        &self.made
    }

    /// Returns the indices of the parts with windows that start in these frames of the set.
    pub(super) fn between(&self, numbers: &Range<usize>) -> Range<usize> {
        let first = self.made.partition_point(|part| part.numbers().end <= numbers.start);
        let end = self.made.partition_point(|part| part.number < numbers.end);
        first..end.max(first)
    }
}
