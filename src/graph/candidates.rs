use super::{AllPairs, Construction, FrameDistances, FrameSet, GraphError, GraphOptions, Place};
use crate::clip::jolts;
use crate::math::Planar;

/// More are not held: of these many the closest are kept.
const MOST_CANDIDATES: usize = 400_000;

/// A frame in which a joint's turning changes so many times as much as in all but one in a hundred frames is not left or entered.
const MOST_JOLT: f32 = 4.0;

/// A place where one may go from one stretch of motion into another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Where its clip is left.
    pub leave: Place,
    /// Where the other, or the same, is entered.
    pub enter: Place,
    /// The distance of the two windows, centimetres on the reference body, rounded to 0.001 cm.
    pub distance_cm: f64,
    /// How the entered clip lies best on the one that is left: `left_world_from_entered_world`.
    pub alignment: Planar,
}

/// All places below the threshold, closest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    pub(super) found: Vec<Candidate>,
    /// The smallest distance at a place where one could go, below the threshold or not.
    pub(super) nearest_cm: Option<f64>,
    /// How many were below the threshold and are not held.
    pub(super) left_out: usize,
}

impl Candidates {
    /// The places that the options ask for: starts and ends of segments, or local minima of the distance; no farther than the threshold.
    ///
    /// A place is left out where one could not go: the window would cross the end of its clip, nothing of the outgoing clip would play before
    /// it, or nothing of the incoming one behind it; where one would jump less than the shortest jump inside a clip; and, of
    /// minima, where a joint jolts.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips, or the distances are those of another window.
    pub fn find(all: &AllPairs, distances: &FrameDistances, options: &GraphOptions) -> Result<Self, GraphError> {
        let set = distances.set();
        options.check(set)?;
        if distances.window() != options.blend_window {
            return Err(GraphError::OtherWindow {
                found: distances.window(),
                expected: options.blend_window,
            });
        }
        let mut picker = Picker::new(set, options);
        for a in 0..set.clips().len() {
            for b in a..set.clips().len() {
                let Some(block) = distances.block(a, b) else { continue };
                let place = |clip, frame| Place { clip, frame };
                let at = |row: usize, column: usize| block.get(row, column);
                let align = |leave, enter| all.alignment(leave, enter, options.blend_window).map(|found| found.transform);
                if let Construction::Segments { .. } = options.construction {
                    for (row, column) in picker.cells(a, b) {
                        if let Some(distance) = at(row, column) {
                            picker.offer(place(a, row), place(b, column), distance, || true, align)?;
                        }
                    }
                    continue;
                }
                for row in 0..block.size().0 {
                    let (first, cells) = block.row(row);
                    for (column, &distance) in cells.iter().enumerate().map(|(at, cell)| (first + at, cell)) {
                        if picker.is_worth(distance) {
                            let minimum = || is_minimum(at, row, column);
                            picker.offer(place(a, row), place(b, column), distance, minimum, align)?;
                        }
                    }
                }
            }
        }
        Ok(picker.finish())
    }

    /// The places, closest first.
    #[must_use]
    pub fn found(&self) -> &[Candidate] {
        &self.found
    }

    /// The smallest distance of two windows between which one could go, centimetres, below the threshold or not.
    #[must_use]
    pub fn nearest_cm(&self) -> Option<f64> {
        self.nearest_cm
    }

    /// How many places below the threshold are left out because there are too many (400,000); those kept are the closest.
    #[must_use]
    pub fn left_out(&self) -> usize {
        self.left_out
    }
}

/// No larger than its eight neighbours; of a plateau the first.
pub(super) fn is_minimum(at: impl Fn(usize, usize) -> Option<f32>, row: usize, column: usize) -> bool {
    let Some(here) = at(row, column) else { return false };
    for r in row.saturating_sub(1)..=row + 1 {
        for c in column.saturating_sub(1)..=column + 1 {
            let Some(there) = at(r, c) else { continue };
            // Strictly smaller than what comes before it, so that a plateau is counted once.
            if there < here || (there == here && (r, c) < (row, column)) {
                return false;
            }
        }
    }
    true
}

/// Takes places in, in any order.
pub(super) struct Picker<'a> {
    set: &'a FrameSet,
    options: &'a GraphOptions,
    min_jump: usize,
    /// Per clip and frame, how much the joints jolt.
    jolts: Vec<Vec<f32>>,
    /// Metres of the clips' own body.
    threshold_m: f32,
    nearest_m: f32,
    found: Vec<Candidate>,
    left_out: usize,
}

impl<'a> Picker<'a> {
    pub(super) fn new(set: &'a FrameSet, options: &'a GraphOptions) -> Self {
        Self {
            set,
            options,
            jolts: set.clips().iter().map(|source| jolts(source.clip())).collect(),
            min_jump: (options.min_jump_secs * set.fps()).round().max(1.0) as usize,
            // A little more than the threshold; what is above it is told by the rounded distance.
            threshold_m: ((options.edge_threshold_cm + 0.001) / set.cm_per_m()) as f32,
            nearest_m: f32::INFINITY,
            found: Vec::new(),
            left_out: 0,
        }
    }

    /// Whether a distance could matter: one that is below the threshold, or nearer than all before it.
    pub(super) fn is_worth(&self, distance: f32) -> bool {
        distance <= self.threshold_m || distance < self.nearest_m
    }

    /// The cells of clips a ≤ b in which a segment is left and another entered, each once.
    pub(super) fn cells(&self, a: usize, b: usize) -> Vec<(usize, usize)> {
        let (of_a, of_b) = (self.ends(a), self.ends(b));
        let mut cells = Vec::new();
        for &row in &of_a {
            for &column in &of_b {
                if a < b || row < column {
                    cells.push((row, column));
                }
            }
        }
        cells
    }

    /// The frames of a clip at which its segments are entered or left.
    fn ends(&self, clip: usize) -> Vec<usize> {
        let mut frames: Vec<usize> = (self.options.stretches(self.set, clip).iter())
            .flat_map(|stretch| [stretch.start, stretch.end - self.options.blend_window])
            .collect();
        frames.sort_unstable();
        frames.dedup();
        frames
    }

    /// A pair of windows; a ≤ b. `alignment` is asked for what is taken.
    pub(super) fn offer(
        &mut self,
        a: Place,
        b: Place,
        distance: f32,
        is_minimum: impl Fn() -> bool,
        alignment: impl Fn(Place, Place) -> Result<Planar, GraphError>,
    ) -> Result<(), GraphError> {
        if a.clip == b.clip && a.frame.abs_diff(b.frame) < self.min_jump.max(2) {
            return Ok(());
        }
        let (there, back) = (self.can_go(a, b), self.can_go(b, a));
        if !there && !back {
            return Ok(());
        }
        let distance_cm = self.set.rounded_cm(distance);
        let is_near = distance_cm <= self.options.edge_threshold_cm;
        if !(is_near || distance < self.nearest_m) || !is_minimum() {
            return Ok(());
        }
        self.nearest_m = self.nearest_m.min(distance);
        if !is_near {
            return Ok(());
        }
        let (leave, enter) = (a, b);
        let alignment = alignment(leave, enter)?;
        let candidate = Candidate {
            leave,
            enter,
            distance_cm,
            alignment,
        };
        self.found.extend(there.then_some(candidate));
        self.found.extend(back.then(|| Candidate {
            leave: enter,
            enter: leave,
            alignment: alignment.inverse(),
            ..candidate
        }));
        if self.found.len() > 2 * MOST_CANDIDATES {
            self.thin_out();
        }
        Ok(())
    }

    /// Whether something plays before the transition, its windows fit, and something plays behind it.
    fn can_go(&self, leave: Place, enter: Place) -> bool {
        let window = self.options.blend_window;
        let fits = leave.frame >= 1
            && leave.frame + window <= self.set.frames_of(leave.clip)
            && enter.frame + window < self.set.frames_of(enter.clip);
        fits && match self.options.construction {
            Construction::Minima => self.is_calm(leave) && self.is_calm(enter),
            Construction::Segments { .. } => self.options.is_left_at(self.set, leave) && self.options.is_entered_at(self.set, enter),
        }
    }

    /// No joint jolts around a frame: a capture that trembles has velocities there that nobody had, and a transition would carry them on.
    fn is_calm(&self, place: Place) -> bool {
        let around = place.frame.saturating_sub(1)..=place.frame;
        let jolts = self.jolts.get(place.clip).and_then(|jolts| jolts.get(around));
        jolts.is_some_and(|jolts| jolts.iter().all(|&jolt| jolt <= MOST_JOLT))
    }

    fn thin_out(&mut self) {
        if self.found.len() > MOST_CANDIDATES {
            self.found.sort_by(closest_first);
            self.left_out += self.found.len() - MOST_CANDIDATES;
            self.found.truncate(MOST_CANDIDATES);
        }
    }

    pub(super) fn finish(mut self) -> Candidates {
        self.thin_out();
        self.found.sort_by(closest_first);
        Candidates {
            found: self.found,
            nearest_cm: self.nearest_m.is_finite().then(|| self.set.rounded_cm(self.nearest_m)),
            left_out: self.left_out,
        }
    }
}

fn closest_first(a: &Candidate, b: &Candidate) -> std::cmp::Ordering {
    let places = |of: &Candidate| (of.leave, of.enter);
    a.distance_cm.total_cmp(&b.distance_cm).then(places(a).cmp(&places(b)))
}
