//! The search for the ends of a cycle in a clip.

use super::LoopError;
use crate::clip::{Clip, Contacts, Motion};
use crate::math::sort::sort_by;
use crate::registration::{PairTerms, REFERENCE_HEIGHT_M, limb_weights};
use crate::skeleton::Foot;
use std::ops::Range;

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
#[derive(Clone, Debug, PartialEq)]
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
/// ([`Motion::is_cycle`]) is taken whole, of any duration, unless an end is given.
///
/// # Errors
/// [`LoopError::TooShort`] when no cycle of the shortest duration fits, into the clip or to a given
/// end; [`LoopError::Registration`] when positions are not finite.
pub fn find_cycle(source: &Motion, search: &CycleSearch) -> Result<CutPoints, LoopError> {
    let (clip, contacts) = (source.clip(), source.contacts());
    let body_height = f64::from(source.body_height());
    let (fps, frames) = (clip.fps(), clip.frames());
    if source.is_cycle() && search.start.is_none() && search.end.is_none() && frames > 2 {
        let last = frames - 1;
        let phase_gap = phase_gap(contacts, 0, last);
        return Ok(CutPoints { cycle: 0..last, rms_cm: 0.0, phase_gap });
    }
    let too_short = LoopError::TooShort { min_secs: search.min_secs, secs: clip.duration_secs() };
    // `as usize` maps NaN and negative numbers to 0.
    let shortest = ((search.min_secs * fps).ceil() as usize).max(2);
    let longest = ((search.max_secs * fps).floor() as usize).max(shortest);
    if shortest >= frames {
        return Err(too_short);
    }
    let finder = CycleFinder {
        clip,
        source,
        contacts,
        touchdowns: touchdowns(contacts),
        weights: limb_weights(clip.skeleton()),
        cm: 100.0 * if body_height > 0.0 { REFERENCE_HEIGHT_M / body_height } else { 1.0 },
        window: search.window.clamp(1, frames - shortest),
        lengths: shortest..longest.saturating_add(1),
    };
    if search.start.is_some() || search.end.is_some() {
        let best = finder.pinned(search, frames)?.ok_or(too_short)?;
        return Ok(best.cut(contacts));
    }
    let stride = ((fps / 30.0).ceil() as usize).max(frames.div_ceil(400)).max(1);
    let mut places = Vec::new();
    for place in finder.pairs(&(0..frames), &(0..frames), stride, finder.window, true)? {
        let around = |at: usize| at.saturating_sub(stride)..(at + stride + 1).min(frames);
        places.extend(finder.pairs(
            &around(place.start),
            &around(place.end),
            1,
            finder.window,
            false,
        )?);
    }
    places.extend(finder.pairs(&(0..1), &(frames - 1..frames), 1, 1, false)?);
    let best = finder.choose(&places).ok_or(too_short)?;
    Ok(best.cut(contacts))
}

/// Returns the frames in which a foot touches down, in order. A foot that is planted in the first
/// frame touched down before.
fn touchdowns(contacts: &Contacts) -> Vec<usize> {
    let starts = |&foot: &Foot| contacts.intervals(foot).into_iter().map(|stance| stance.start);
    let mut all: Vec<usize> =
        contacts.feet().iter().flat_map(starts).filter(|&at| at > 0).collect();
    all.sort_unstable();
    all
}

#[derive(Clone, Copy, Debug)]
struct Candidate {
    start: usize,
    end: usize,
    rms_cm: f64,
    score: f64,
}

impl Candidate {
    fn cut(&self, contacts: &Contacts) -> CutPoints {
        CutPoints {
            cycle: self.start..self.end,
            rms_cm: self.rms_cm,
            phase_gap: phase_gap(contacts, self.start, self.end),
        }
    }
}

struct CycleFinder<'a> {
    clip: &'a Clip,
    source: &'a Motion,
    contacts: &'a Contacts,
    /// The frames in which a foot touches down, in order.
    touchdowns: Vec<usize>,
    weights: Vec<f64>,
    /// The factor from metres to centimetres on the reference body.
    cm: f64,
    window: usize,
    /// Range of the number of frames of a cycle.
    lengths: Range<usize>,
}

impl CycleFinder<'_> {
    /// Returns the best cycle with a given end. One row, or one column, of the grid is cheap: every
    /// frame is compared. With both ends given nothing is searched, and any length is accepted.
    fn pinned(&self, search: &CycleSearch, frames: usize) -> Result<Option<Candidate>, LoopError> {
        let (shortest, longest) = (self.lengths.start, self.lengths.end);
        let (starts, ends) = match (search.start, search.end) {
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
        let both = search.start.is_some() && search.end.is_some();
        if starts.is_empty() || ends.is_empty() || ends.end > frames || starts.end > ends.end {
            return Ok(None);
        }
        let lengths = if both { 2..frames.saturating_add(1) } else { self.lengths.clone() };
        // A window that does not fit after the last frame is shortened.
        let window = self.window.min(frames - ends.end + 1).max(1);
        let finder = CycleFinder {
            lengths,
            weights: self.weights.clone(),
            touchdowns: self.touchdowns.clone(),
            ..*self
        };
        Ok(finder.choose(&finder.pairs(&starts, &ends, 1, window, false)?))
    }

    /// Returns whether a foot touches down in a cycle.
    fn steps_in(&self, place: &Candidate) -> bool {
        let next = self.touchdowns.partition_point(|&at| at <= place.start);
        self.touchdowns.get(next).is_some_and(|&at| at <= place.end)
    }

    /// Returns whether a foot stands throughout a cycle that travels.
    fn drags_in(&self, place: &Candidate) -> bool {
        let stays =
            |&foot: &Foot| (place.start..=place.end).all(|at| self.contacts.planted(foot, at));
        let [from, to] =
            [place.start, place.end].map(|frame| self.source.ground_frames()[frame].shift);
        from.distance(to) * self.cm > MIN_DRAG_CM && self.contacts.feet().iter().any(stays)
    }

    /// Returns the flaws of a cycle, the worst first: it has no step, or drags a foot.
    fn flaws(&self, place: &Candidate) -> [bool; 2] {
        [!self.steps_in(place), self.drags_in(place)]
    }

    /// Returns the best of these cycles: of those with the fewest flaws that are about as close as
    /// the closest, the one with the least score.
    fn choose(&self, places: &[Candidate]) -> Option<Candidate> {
        let fewest = places.iter().map(|place| self.flaws(place)).min()?;
        let admitted = || places.iter().filter(|place| self.flaws(place) == fewest);
        let least = admitted().map(|place| place.rms_cm).min_by(f64::total_cmp)?;
        let alike = admitted()
            .filter(|place| place.rms_cm <= least * (1.0 + EQUIVALENT_SHARE) + EQUIVALENT_CM);
        alike.min_by(|a, b| a.score.total_cmp(&b.score)).copied()
    }

    /// Returns the cycles that start in `starts` and end in `ends`; of a whole grid (`minima`) only
    /// its lowest minima, and those of cycles with the fewest flaws.
    fn pairs(
        &self,
        starts: &Range<usize>,
        ends: &Range<usize>,
        stride: usize,
        window: usize,
        minima: bool,
    ) -> Result<Vec<Candidate>, LoopError> {
        let with_window =
            |starts: &Range<usize>| starts.start..starts.end.saturating_add(window - 1);
        let mut terms = PairTerms::new(
            self.clip,
            with_window(starts),
            self.clip,
            with_window(ends),
            &self.weights,
            stride,
        )?;
        terms.finish();
        let grid = terms.distances(window, starts, ends)?;
        let allowed = |&(row, column): &(usize, usize)| {
            let (start, end) = grid.frames(row, column);
            end.checked_sub(start).is_some_and(|length| self.lengths.contains(&length))
                && end < self.clip.frames()
        };
        let distance =
            |(row, column): (usize, usize)| grid.get(row, column).unwrap_or(f32::INFINITY);
        // No greater than its eight neighbours, as far as these are cycles.
        let is_minimum = |&(row, column): &(usize, usize)| {
            let here = distance((row, column));
            (row.saturating_sub(1)..(row + 2).min(grid.rows()))
                .flat_map(|r| {
                    (column.saturating_sub(1)..(column + 2).min(grid.columns()))
                        .map(move |c| (r, c))
                })
                .filter(allowed)
                .all(|there| distance(there) >= here)
        };
        let all =
            (0..grid.rows()).flat_map(|row| (0..grid.columns()).map(move |column| (row, column)));
        let cells = all.filter(allowed).filter(|cell| !minima || is_minimum(cell));
        let mut places: Vec<Candidate> = cells
            .filter_map(|(row, column)| {
                let (start, end) = grid.frames(row, column);
                let rms_cm = f64::from(grid.get(row, column)?) * self.cm;
                let gap = phase_gap(self.contacts, start, end).map_or(0.0, f64::from);
                let score = rms_cm + CM_PER_CYCLE * gap;
                Some(Candidate { start, end, rms_cm, score })
            })
            .collect();
        if minima {
            let fewest = places.iter().map(|place| self.flaws(place)).min();
            places.retain(|place| Some(self.flaws(place)) == fewest);
            sort_by(&mut places, |a, b| a.rms_cm.total_cmp(&b.rms_cm));
            places.truncate(CANDIDATES);
        }
        Ok(places)
    }
}

/// Returns the mean difference of the feet's phases in two frames, 0 to 0.5.
fn phase_gap(contacts: &Contacts, a: usize, b: usize) -> Option<f32> {
    let gaps: Vec<f32> = contacts
        .feet()
        .iter()
        .filter_map(|&foot| {
            let gap = (contacts.phase(foot, a)? - contacts.phase(foot, b)?).abs();
            Some(gap.min(1.0 - gap))
        })
        .collect();
    (!gaps.is_empty()).then(|| gaps.iter().sum::<f32>() / gaps.len() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::registration::fixtures::Walk;
    use crate::skeleton::Side;
    use crate::synth::{Action, Params, synthesize};
    use crate::transition::{LoopOptions, close_loop};
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
