//! The search for the ends of a cycle in a clip.

use super::LoopError;
use crate::clip::{Contacts, Motion, phase_between};
use crate::math::sort::sort_by;
use crate::registration::{DistanceMatrix, PairTerms, REFERENCE_HEIGHT_M, limb_weights};
use crate::skeleton::Foot;
use std::ops::{ControlFlow, Range};

/// Options of the search for a cycle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CycleSearch {
    /// Number of frames that are compared from both ends on; fewer where the clip is too short for
    /// the shortest cycle and a whole window; 0 counts as 1.
    pub window: usize,
    /// The shortest cycle, seconds.
    pub min_secs: f64,
    /// The longest cycle, seconds.
    pub max_secs: f64,
    /// The first frame of the cycle; `None` to search for it.
    pub start: Option<usize>,
    /// The frame that corresponds to the first one; `None` to search for it.
    pub end: Option<usize>,
}

impl CycleSearch {
    /// Returns options for cycles of 0.5 to 3 s, compared over a tenth of a second at `fps`.
    #[must_use]
    pub fn new(fps: f64) -> Self {
        Self {
            window: (0.1 * fps).ceil().max(1.0) as usize,
            min_secs: 0.5,
            max_secs: 3.0,
            start: None,
            end: None,
        }
    }
}

/// The ends of a cycle, and how well they match.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CutPoints {
    /// The frames that play; `cycle.end` is the frame that corresponds to `cycle.start`. The
    /// argument of [`super::close_loop`].
    pub cycle: Range<usize>,
    /// Root mean square distance of the windows from both ends after the best alignment,
    /// centimetres on the reference body.
    pub rms_cm: f64,
    /// The difference of the feet's phases, in cycles, 0 to 0.5; `None` when no foot has two
    /// touchdowns.
    pub phase_gap: Option<f32>,
}

/// The distance to which a difference of one cycle between the feet's phases is equivalent,
/// centimetres.
const CM_PER_CYCLE: f64 = 20.0;
/// Cycles whose distances differ by at most this, as a share of the least and in centimetres, are
/// chosen by the feet's phases.
const EQUIVALENT_SHARE: f64 = 0.05;
const EQUIVALENT_CM: f64 = 0.02;
/// The least travel of the body over a cycle during which a foot that stands throughout must slide,
/// centimetres on the reference body.
const MIN_DRAG_CM: f64 = 5.0;
/// The number of minima of the coarse grid that are refined.
const CANDIDATES: usize = 16;
/// The time between the rows of the coarse grid, seconds.
const COARSE_SECS: f64 = 1.0 / 30.0;
/// Grids of up to this number of rows are compared at once.
const MAX_ROWS: usize = 400;
/// The number of rows of larger grids that are compared in one slice: about a millisecond for 31
/// joints.
const ROWS_PER_SLICE: usize = 128;

/// Finds where a clip repeats itself: the pair of frames with the smallest distance between the
/// windows that begin there, among all cycles of the requested durations. Of nearly equal distances
/// the one is taken at which the feet's phases ([`Contacts::phase`]) agree best.
///
/// If a foot touches down anywhere in the clip, it must do so in the cycle: a character that stands
/// for a moment matches itself best, and is not a gait. Nor may a foot stand throughout a cycle
/// that travels, as in the last step of a run that stops: repeated, it would be dragged along. The
/// search goes from coarse to fine: every minimum of a grid of about 1/30 s is refined frame by
/// frame. A clip that is exactly one cycle has no window after its last frame: its first and last
/// frame are compared alone, and taken if nothing matches better. A clip that was declared a cycle
/// ([`Motion::is_cycle`]) is taken whole, of any duration, unless an end is given. Cost: O(frames ×
/// longest cycle × joints).
///
/// # Errors
/// [`LoopError::TooShort`] when no cycle of the shortest duration fits, into the clip or to a given
/// end; [`LoopError::Registration`] when positions are not finite.
pub fn find_cycle(source: &Motion, search: &CycleSearch) -> Result<CutPoints, LoopError> {
    let mut finder = CycleFinder::new(source, search)?;
    loop {
        if let ControlFlow::Break(found) = finder.advance(source)? {
            return Ok(found);
        }
    }
}

/// The search of [`find_cycle`] in slices, for long clips. Every call must be given the same clip.
#[derive(Debug)]
pub struct CycleFinder {
    search: CycleSearch,
    /// For each foot, the frames in which it touches down, in order.
    touchdowns: Vec<Vec<usize>>,
    /// Those of all feet, in order.
    steps: Vec<usize>,
    /// For each foot and frame, the first frame from there on in which the foot is not planted.
    lifts: Vec<Vec<usize>>,
    weights: Vec<f64>,
    /// The factor from metres to centimetres on the reference body.
    cm: f64,
    window: usize,
    /// Range of the number of frames of a cycle.
    lengths: Range<usize>,
    /// The number of frames between rows of the coarse grid.
    stride: usize,
    /// The first start of a cycle that was not compared yet.
    next: usize,
    /// The minima of the coarse grid so far, of those with the fewest flaws.
    minima: Vec<Candidate>,
    fewest: Option<Flaws>,
}

/// Whether a cycle has no step, and whether it drags a foot: the worst first.
type Flaws = [bool; 2];

#[derive(Clone, Copy, Debug)]
struct Candidate {
    start: usize,
    end: usize,
    rms_cm: f64,
}

impl CycleFinder {
    /// Prepares the search. Nothing is compared yet: call [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`LoopError::TooShort`] when no cycle of the shortest duration fits into the clip.
    pub fn new(source: &Motion, search: &CycleSearch) -> Result<Self, LoopError> {
        let (clip, contacts) = (source.clip(), source.contacts());
        let body_height = f64::from(source.body_height());
        let (fps, frames) = (clip.fps(), clip.frames());
        // `as usize` maps NaN and negative numbers to 0.
        let shortest = ((search.min_secs * fps).ceil() as usize).max(2);
        let longest = ((search.max_secs * fps).floor() as usize).max(shortest);
        if shortest >= frames && !is_taken_whole(source, search) {
            return Err(too_short(source, search));
        }
        let touchdowns: Vec<_> =
            contacts.feet().iter().map(|&foot| contacts.touchdowns(foot)).collect();
        let mut steps = touchdowns.concat();
        steps.sort_unstable();
        Ok(Self {
            search: *search,
            touchdowns,
            steps,
            lifts: contacts.feet().iter().map(|&foot| lifts(contacts, foot)).collect(),
            weights: limb_weights(clip.skeleton()),
            cm: 100.0 * if body_height > 0.0 { REFERENCE_HEIGHT_M / body_height } else { 1.0 },
            window: search.window.clamp(1, frames.saturating_sub(shortest).max(1)),
            lengths: shortest..longest.saturating_add(1),
            stride: ((fps * COARSE_SECS).ceil() as usize).max(1),
            next: 0,
            minima: Vec::new(),
            fewest: None,
        })
    }

    /// Does one slice of the search: a few milliseconds for 31 joints. Returns the cycle at its
    /// end.
    ///
    /// # Errors
    /// Those of [`find_cycle`].
    pub fn advance(&mut self, source: &Motion) -> Result<ControlFlow<CutPoints>, LoopError> {
        let frames = source.clip().frames();
        if is_taken_whole(source, &self.search) {
            let whole = Candidate { start: 0, end: frames - 1, rms_cm: 0.0 };
            return Ok(ControlFlow::Break(self.cut(&whole)));
        }
        let is_pinned = self.search.start.is_some() || self.search.end.is_some();
        if !is_pinned && self.next < frames {
            self.compare_next(source)?;
            return Ok(ControlFlow::Continue(()));
        }
        let places = if is_pinned { self.pinned(source)? } else { self.refined(source)? };
        let best = self.choose(source, &places).ok_or_else(|| too_short(source, &self.search))?;
        Ok(ControlFlow::Break(self.cut(&best)))
    }

    /// Returns the progress, 0 to 1.
    #[must_use]
    pub fn progress(&self, source: &Motion) -> f32 {
        self.next as f32 / source.clip().frames().max(1) as f32
    }

    /// Compares some more rows of the coarse grid.
    fn compare_next(&mut self, source: &Motion) -> Result<(), LoopError> {
        let (frames, stride) = (source.clip().frames(), self.stride);
        let is_small = frames.div_ceil(stride) <= MAX_ROWS;
        let rows = if is_small { MAX_ROWS } else { ROWS_PER_SLICE };
        let starts = self.next..self.next.saturating_add(rows * stride).min(frames);
        // With the rows before and behind, to which minima are compared.
        let first = starts.start.saturating_sub(stride);
        let last = starts.end.saturating_add(stride).min(frames);
        let ends = first..last.saturating_add(self.lengths.end).min(frames);
        let grid = self.grid(source, &(first..last), &ends, stride, self.window)?;
        let is_new = |place: &Candidate| starts.contains(&place.start);
        let minima: Vec<_> = grid.minima().filter(is_new).collect();
        self.next = starts.end;
        for place in minima {
            let flaws = self.flaws(source, &place);
            if self.fewest.is_none_or(|fewest| flaws < fewest) {
                self.fewest = Some(flaws);
                self.minima.clear();
            }
            if self.fewest == Some(flaws) {
                self.minima.push(place);
            }
        }
        sort_by(&mut self.minima, |a, b| a.rms_cm.total_cmp(&b.rms_cm));
        self.minima.truncate(CANDIDATES);
        Ok(())
    }

    /// Returns the cycles around the minima of the coarse grid, and that of the whole clip.
    fn refined(&self, source: &Motion) -> Result<Vec<Candidate>, LoopError> {
        let (frames, stride) = (source.clip().frames(), self.stride);
        let around = |at: usize| at.saturating_sub(stride)..(at + stride + 1).min(frames);
        let mut places = Vec::new();
        for place in &self.minima {
            let (starts, ends) = (around(place.start), around(place.end));
            places.extend(self.grid(source, &starts, &ends, 1, self.window)?.cycles());
        }
        places.extend(self.grid(source, &(0..1), &(frames - 1..frames), 1, 1)?.cycles());
        Ok(places)
    }

    /// Returns the cycles with a given end. One row, or one column, of the grid is cheap: every
    /// frame is compared. With both ends given nothing is searched, and any length is accepted.
    fn pinned(&mut self, source: &Motion) -> Result<Vec<Candidate>, LoopError> {
        let frames = source.clip().frames();
        let (shortest, longest) = (self.lengths.start, self.lengths.end);
        let (starts, ends) = match (self.search.start, self.search.end) {
            (Some(start), Some(end)) => {
                (start..start.saturating_add(1), end..end.saturating_add(1))
            }
            (Some(start), None) => (
                start..start.saturating_add(1),
                start.saturating_add(shortest)..start.saturating_add(longest).min(frames),
            ),
            (None, Some(end)) => (
                end.saturating_sub(longest - 1)..end.saturating_sub(shortest).saturating_add(1),
                end..end.saturating_add(1),
            ),
            (None, None) => (0..frames, 0..frames),
        };
        if starts.is_empty() || ends.is_empty() || ends.end > frames || starts.end > ends.end {
            return Ok(Vec::new());
        }
        if self.search.start.is_some() && self.search.end.is_some() {
            self.lengths = 2..frames.saturating_add(1);
        }
        // A window that does not fit after the last frame is shortened.
        let window = self.window.min(frames - ends.end + 1).max(1);
        Ok(self.grid(source, &starts, &ends, 1, window)?.cycles().collect())
    }

    /// Compares the windows that start in `starts` with those that start in `ends`.
    fn grid(
        &self,
        source: &Motion,
        starts: &Range<usize>,
        ends: &Range<usize>,
        stride: usize,
        window: usize,
    ) -> Result<Grid<'_>, LoopError> {
        let with_window =
            |starts: &Range<usize>| starts.start..starts.end.saturating_add(window - 1);
        let clip = source.clip();
        let (starts_of, ends_of) = (with_window(starts), with_window(ends));
        let mut terms = PairTerms::new(clip, starts_of, clip, ends_of, &self.weights, stride)?;
        terms.finish();
        let distances = terms.distances(window, starts, ends)?;
        Ok(Grid { distances, finder: self, frames: clip.frames() })
    }

    /// Returns whether a foot touches down in a cycle.
    fn steps_in(&self, place: &Candidate) -> bool {
        let next = self.steps.partition_point(|&at| at <= place.start);
        self.steps.get(next).is_some_and(|&at| at <= place.end)
    }

    /// Returns whether a foot stands throughout a cycle that travels.
    fn drags_in(&self, source: &Motion, place: &Candidate) -> bool {
        let stays = |lifts: &Vec<usize>| lifts.get(place.start).is_some_and(|&at| at > place.end);
        let [from, to] = [place.start, place.end].map(|frame| source.ground_frames()[frame].shift);
        from.distance(to) * self.cm > MIN_DRAG_CM && self.lifts.iter().any(stays)
    }

    fn flaws(&self, source: &Motion, place: &Candidate) -> Flaws {
        [!self.steps_in(place), self.drags_in(source, place)]
    }

    /// Returns the best of these cycles: of those with the fewest flaws that are about as close as
    /// the closest, the one with the least sum of its distance and that of the feet's phases.
    fn choose(&self, source: &Motion, places: &[Candidate]) -> Option<Candidate> {
        let fewest = places.iter().map(|place| self.flaws(source, place)).min()?;
        let admitted = || places.iter().filter(|place| self.flaws(source, place) == fewest);
        let least = admitted().map(|place| place.rms_cm).min_by(f64::total_cmp)?;
        let alike = admitted()
            .filter(|place| place.rms_cm <= least * (1.0 + EQUIVALENT_SHARE) + EQUIVALENT_CM);
        let score = |place: &Candidate| {
            let gap = self.phase_gap(place).map_or(0.0, f64::from);
            place.rms_cm + CM_PER_CYCLE * gap
        };
        alike.min_by(|a, b| score(a).total_cmp(&score(b))).copied()
    }

    fn cut(&self, place: &Candidate) -> CutPoints {
        CutPoints {
            cycle: place.start..place.end,
            rms_cm: place.rms_cm,
            phase_gap: self.phase_gap(place),
        }
    }

    /// Returns the mean difference of the feet's phases at both ends, 0 to 0.5.
    fn phase_gap(&self, place: &Candidate) -> Option<f32> {
        let gap = |touchdowns: &Vec<usize>| {
            let phase = |frame| phase_between(touchdowns, frame);
            let gap = (phase(place.start)? - phase(place.end)?).abs();
            Some(gap.min(1.0 - gap))
        };
        let gaps: Vec<f32> = self.touchdowns.iter().filter_map(gap).collect();
        (!gaps.is_empty()).then(|| gaps.iter().sum::<f32>() / gaps.len() as f32)
    }
}

/// The distances between some windows of a clip.
struct Grid<'a> {
    distances: DistanceMatrix,
    finder: &'a CycleFinder,
    frames: usize,
}

impl Grid<'_> {
    /// Returns the cells that are cycles of the requested durations, row by row.
    fn cells(&self) -> impl Iterator<Item = (usize, usize)> {
        let columns = self.distances.columns();
        let all =
            (0..self.distances.rows()).flat_map(move |row| (0..columns).map(move |c| (row, c)));
        all.filter(|&cell| self.is_cycle(cell))
    }

    fn is_cycle(&self, (row, column): (usize, usize)) -> bool {
        let (start, end) = self.distances.frames(row, column);
        end.checked_sub(start).is_some_and(|length| self.finder.lengths.contains(&length))
            && end < self.frames
    }

    fn distance(&self, (row, column): (usize, usize)) -> f32 {
        self.distances.get(row, column).unwrap_or(f32::INFINITY)
    }

    /// Returns whether a distance is no greater than those of its eight neighbours, as far as these
    /// are cycles.
    fn is_minimum(&self, (row, column): (usize, usize)) -> bool {
        let here = self.distance((row, column));
        let rows = row.saturating_sub(1)..(row + 2).min(self.distances.rows());
        let columns = column.saturating_sub(1)..(column + 2).min(self.distances.columns());
        rows.flat_map(|r| columns.clone().map(move |c| (r, c)))
            .filter(|&there| self.is_cycle(there))
            .all(|there| self.distance(there) >= here)
    }

    fn candidate(&self, (row, column): (usize, usize)) -> Option<Candidate> {
        let (start, end) = self.distances.frames(row, column);
        let rms_cm = f64::from(self.distances.get(row, column)?) * self.finder.cm;
        Some(Candidate { start, end, rms_cm })
    }

    fn cycles(&self) -> impl Iterator<Item = Candidate> {
        self.cells().filter_map(|cell| self.candidate(cell))
    }

    fn minima(&self) -> impl Iterator<Item = Candidate> {
        self.cells().filter(|cell| self.is_minimum(*cell)).filter_map(|cell| self.candidate(cell))
    }
}

/// Returns whether a clip is taken whole: it was declared a cycle, and no end is given.
fn is_taken_whole(source: &Motion, search: &CycleSearch) -> bool {
    source.is_cycle()
        && search.start.is_none()
        && search.end.is_none()
        && source.clip().frames() > 2
}

fn too_short(source: &Motion, search: &CycleSearch) -> LoopError {
    LoopError::TooShort { min_secs: search.min_secs, secs: source.clip().duration_secs() }
}

/// Returns for each frame the first one from there on in which a foot is not planted.
fn lifts(contacts: &Contacts, foot: Foot) -> Vec<usize> {
    let mut lifts = vec![contacts.frames(); contacts.frames()];
    for frame in (0..contacts.frames()).rev() {
        lifts[frame] = match lifts.get(frame + 1) {
            _ if !contacts.planted(foot, frame) => frame,
            Some(&next) => next,
            None => contacts.frames(),
        };
    }
    lifts
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::clip::Clip;
    use crate::registration::fixtures::Walk;
    use crate::skeleton::Side;
    use crate::synth::{Action, Params, synthesize};
    use crate::transition::{LoopOptions, close_loop};
    use glam::Quat;
    use std::sync::Arc;

    fn find(clip: &Arc<Clip>, search: &CycleSearch) -> Result<CutPoints, LoopError> {
        find_cycle(&Motion::analyze(Arc::clone(clip)), search)
    }

    #[test]
    fn find_cycle_of_a_walk_is_whole_strides() {
        for (cadence, turning, fps) in [(0.9, 0.0, 60.0), (1.3, 0.4, 120.0), (1.1, -0.7, 30.0)] {
            let clip = Arc::new(
                Walk { frames: (5.0 * fps) as usize, fps, cadence, turning, ..Walk::default() }
                    .clip(),
            );
            let cut = find(&clip, &CycleSearch::new(fps)).unwrap();
            let strides = cut.cycle.len() as f64 / fps * f64::from(cadence);
            // Never a half stride, whose poses are mirrored. Frames can miss a stride by half a
            // frame.
            assert!(
                (strides - strides.round()).abs() <= 0.6 / fps * f64::from(cadence) + 1e-6
                    && strides > 0.9,
                "{strides} {cut:?}"
            );
            assert!(cut.rms_cm < 1.5, "{cut:?}");
        }
    }

    #[test]
    fn find_cycle_of_made_gaits_is_their_cycle() {
        for action in [Action::Walk, Action::Run] {
            let made = synthesize(&Params::new(action)).unwrap();
            let clip = Arc::new(made.clip);
            let cut = find(&clip, &CycleSearch::new(clip.fps())).unwrap();
            let phase = |frame: usize| made.truth.phase[frame];
            let gap = (phase(cut.cycle.start) - phase(cut.cycle.end)).abs();
            assert!(gap.min(1.0 - gap) < 0.02, "{action:?} {cut:?} {gap}");
            assert!(cut.phase_gap.unwrap() < 0.05 && cut.rms_cm < 1.0, "{cut:?}");
            let source = Motion::analyze(Arc::clone(&clip));
            let made = close_loop(&source, cut.cycle, &LoopOptions::default()).unwrap();
            assert!(
                made.seam.turn_deg < 1e-3 && made.before.turn_deg < 10.0,
                "{:?} {:?}",
                made.before,
                made.seam
            );
        }
    }

    /// A foot is dragged in the last step of a run that stops: it stands while the body still
    /// moves.
    #[test]
    fn find_cycle_avoids_dragged_feet() {
        let walk = Motion::analyze(Walk { frames: 400, cadence: 1.0, ..Walk::default() }.clip());
        // The left foot steps all the time, the right one stands in the first half.
        let left = (0..400).map(|frame| frame % 60 < 36).collect();
        let right = (0..400).map(|frame| frame < 200 || (frame + 30) % 60 < 36).collect();
        let contacts = Contacts::from_flags([left, right]);
        let search = CycleSearch::new(60.0);
        let finds = |contacts: &Contacts, search: &CycleSearch| {
            find_cycle(&walk.clone().with_contacts(contacts.clone()), search).unwrap().cycle
        };
        let cycle = finds(&contacts, &search);
        assert!(cycle.clone().any(|frame| !contacts.planted(Side::Right, frame)), "{cycle:?}");
        // A cycle is still found if every cycle drags a foot, or if the ends are given.
        let always = Contacts::from_flags([
            (0..400).map(|frame| frame % 60 < 36).collect(),
            vec![true; 400],
        ]);
        assert_eq!(finds(&always, &search).len() % 60, 0);
        let given = CycleSearch { start: Some(20), end: Some(80), ..search };
        assert_eq!(finds(&contacts, &given), 20..80);
    }

    /// A minute of which a few seconds repeat themselves; in all other frames the joints shiver.
    #[test]
    fn find_cycle_of_a_long_clip_is_that_of_its_best_part() {
        let walk = Walk { frames: 3600, cadence: 1.27, ..Walk::default() }.clip();
        let still = 2500..2740;
        let mut random = 7_u32;
        let mut shiver = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            Quat::from_rotation_x((random >> 8) as f32 / 2.0_f32.powi(24) - 0.5)
        };
        let mut rotations = Vec::new();
        for frame in 0..walk.frames() {
            let is_still = still.contains(&frame);
            let own = walk.rotations(frame).iter();
            rotations.extend(own.map(|&own| if is_still { own } else { own * shiver() }));
        }
        let (skeleton, roots) = (Arc::clone(walk.skeleton()), walk.root_translations().to_vec());
        let long = Clip::new("long", skeleton, walk.fps(), rotations, roots).unwrap();
        let part = Arc::new(long.crop(still.clone()).unwrap());
        let long = Motion::analyze(long);
        let search = CycleSearch::new(60.0);
        let found = find_cycle(&long, &search).unwrap();
        let expected = find(&part, &search).unwrap();
        let behind = |at: usize| at - still.start;
        assert_eq!(behind(found.cycle.start)..behind(found.cycle.end), expected.cycle);
        assert!((found.rms_cm - expected.rms_cm).abs() < 1e-3, "{found:?} {expected:?}");

        let mut finder = CycleFinder::new(&long, &search).unwrap();
        let mut slices = 0;
        let in_slices = loop {
            let before = finder.progress(&long);
            match finder.advance(&long).unwrap() {
                ControlFlow::Continue(()) => assert!(finder.progress(&long) > before),
                ControlFlow::Break(found) => break found,
            }
            slices += 1;
        };
        assert!(in_slices == found && slices > 10, "{slices} slices");
    }

    #[test]
    fn find_cycle_of_a_single_cycle_is_the_whole_clip() {
        let clip = Arc::new(Walk { frames: 61, cadence: 1.0, ..Walk::default() }.clip());
        assert_eq!(find(&clip, &CycleSearch::new(60.0)).unwrap().cycle, 0..60);
    }

    #[test]
    fn find_cycle_respects_durations_and_refuses_short_clips() {
        let clip = Arc::new(Walk { frames: 400, ..Walk::default() }.clip());
        let between = |min_secs, max_secs| CycleSearch {
            window: 6,
            min_secs,
            max_secs,
            ..CycleSearch::new(60.0)
        };
        for (min, max) in [(0.2, 0.4), (2.0, 2.5), (3.0, 0.0), (5.0, 6.0), (f64::NAN, 1.5)] {
            let cut = find(&clip, &between(min, max)).unwrap();
            let secs = cut.cycle.len() as f64 / 60.0;
            assert!(
                secs >= min.max(0.0) && secs <= max.max(min) + 1e-9 || min.is_nan(),
                "{min} {max} {secs}"
            );
        }
        assert!(matches!(find(&clip, &between(7.0, 9.0)), Err(LoopError::TooShort { .. })));
        let one = Arc::new(clip.crop(0..1).unwrap());
        assert!(find(&one, &between(0.0, 1.0)).is_err());
        assert!(find(&Arc::new(clip.crop(0..0).unwrap()), &between(0.0, 1.0)).is_err());
        assert_eq!(
            find(&Arc::new(clip.crop(0..3).unwrap()), &between(0.0, 1.0)).unwrap().cycle,
            0..2
        );
    }

    #[test]
    fn find_cycle_keeps_given_ends() {
        let clip = Arc::new(Walk { frames: 400, cadence: 1.0, ..Walk::default() }.clip());
        let with = |start, end| find(&clip, &CycleSearch { start, end, ..CycleSearch::new(60.0) });
        // One stride is 60 frames; several strides match equally well.
        let cut = with(Some(100), None).unwrap().cycle;
        assert!(cut.start == 100 && cut.len() % 60 == 0 && !cut.is_empty(), "{cut:?}");
        let cut = with(None, Some(399)).unwrap().cycle;
        assert!(cut.end == 399 && cut.len() % 60 == 0 && !cut.is_empty(), "{cut:?}");
        let cut = with(Some(30), Some(350)).unwrap();
        assert!(cut.cycle == (30..350) && cut.rms_cm > 1.0, "{cut:?}");
        for (start, end) in [
            (Some(390), None),
            (None, Some(10)),
            (Some(50), Some(50)),
            (Some(60), Some(50)),
            (Some(0), Some(400)),
            (Some(usize::MAX), None),
            (None, Some(usize::MAX)),
        ] {
            assert!(
                matches!(with(start, end), Err(LoopError::TooShort { .. })),
                "{start:?} {end:?}"
            );
        }
    }
}
