//! The search for the two frames that are most alike as single poses.

use super::points::checked_sum;
use super::posed_clip::{PosedClip, PosedFrames};
use super::{Progress, REFERENCE_HEIGHT_M, RegistrationError, SearchOptions};
use crate::clip::Clip;
use crate::math::Planar;
use crate::math::sort::sort_by;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// The weights of a comparison of two frames, each 0 or more. Only their ratios matter.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PoseWeights {
    /// Positions of the joints in the character's frame, heights included.
    pub position: f64,
    /// Rotations of the joints relative to their parents; of the root in the character's frame.
    pub rotation: f64,
    /// Velocities of the joints, over the ground included, in the character's frame.
    pub velocity: f64,
}

impl Default for PoseWeights {
    fn default() -> Self {
        Self { position: 0.6, rotation: 0.4, velocity: 0.0 }
    }
}

impl PoseWeights {
    fn of(self) -> [f64; 3] {
        [self.position, self.rotation, self.velocity]
            .map(|weight| if weight > 0.0 { weight } else { 0.0 })
    }
}

/// A pair of frames with similar poses, and similar velocities if these have a weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseMatch {
    /// The frame at which the outgoing clip is left.
    pub leave: usize,
    /// The frame at which the incoming clip is entered.
    pub enter: usize,
    /// The weighted cost; 1 is that of an average pair of frames of the two clips.
    pub cost: f64,
    /// Root mean square over the joints of their distances, centimetres on the reference body.
    pub position_cm: f64,
    /// Root mean square over the joints of the angles between their rotations, degrees (by chords:
    /// accurate up to about 60°, smaller than the angle above).
    pub rotation_deg: f64,
    /// Root mean square over the joints of the differences of their velocities, metres per second
    /// on the reference body.
    pub velocity_mps: f64,
    /// Whether a clip was too short for the requested region, so that all of it was searched.
    pub grown: bool,
}

/// The number of lowest minima of the coarse grid that are refined.
const CANDIDATES: usize = 8;
/// The greatest number of frames of a clip in the coarse comparison.
const MAX_COARSE_FRAMES: usize = 1_000;
/// The greatest jolt ([`crate::clip::jolts`]) of a calm frame: a transition adds the motion of its
/// two frames, including any trembling, to its own.
const MAX_CALM_JOLT: f32 = 0.7;
/// Calm frames may cost this much more than the lowest cost, 1 being that of an average pair, and
/// at most twice the lowest cost: identical frames need no replacement.
const MAX_CALM_COST: f64 = 0.03;
/// The range around each candidate in which calm frames are searched, seconds.
const CALM_REACH_SECS: f64 = 0.05;

/// The search for the two frames that are most alike as single poses: by weighted positions,
/// rotations and velocities.
///
/// [`super::TransitionSearch`] compares windows of the whole body's points and finds their
/// alignment. This search compares one frame of each clip in the character's own frame. The three
/// terms are mean squares over joints (weighted, [`super::limb_weights`]); each is divided by its
/// mean over all pairs of frames, so that the weights do not depend on units:
/// `cost = Σ wₖ Dₖ / mean(Dₖ) / Σ wₖ`.
///
/// The terms are stored separately: new weights or regions cost a pass over the grid, not a new
/// comparison. Pairs are compared every `max(⌈fps / 60⌉, ⌈frames / 1000⌉)` frames, in slices; the
/// eight lowest minima are searched again at every frame, within one stride or 0.05 s.
///
/// The result is the first calm one of the pairs that are nearly as good as the best, within 3 % of
/// a mean pair's cost: none of its joints has a jolt that is rare in its clip, since a jolt at the
/// seam would be taken over as a velocity, and swing the joint out. The result's cost is within 5 %
/// of a mean pair's cost of the smallest over all pairs (tested against them), and is exact for the
/// pair returned.
///
/// Poses are computed for the pairs that are compared, not for all frames: a clip of an hour takes
/// hardly longer than one of a minute.
#[derive(Clone, Debug)]
pub struct PoseSearch {
    outgoing: PosedClip,
    incoming: PosedClip,
    weights: Vec<f32>,
    /// The factor from metres to those of the reference body.
    scale: f64,
    fps: f64,
    stride: usize,
    /// The incoming clip's samples; none before the first call of `advance`.
    columns: Option<PosedFrames>,
    done: usize,
    /// Per pair of samples, row-major: the three mean squares (m², rad², m²/s²).
    terms: Vec<[f32; 3]>,
    sums: [f64; 3],
}

impl PoseSearch {
    /// Prepares a search. `outgoing` and `incoming` come with their
    /// [`crate::clip::character_frames`]; `weights` has one weight per joint, `body_height` is in
    /// metres ([`crate::skeleton::Roles::body_height`]). Nothing is compared yet: call
    /// [`advance`](Self::advance).
    ///
    /// # Errors
    /// [`RegistrationError`] when a clip is empty or has values that are not finite, the skeletons
    /// or frame rates differ, or the number of weights differs from that of the joints.
    pub fn new(
        outgoing: (&Arc<Clip>, &[Planar]),
        incoming: (&Arc<Clip>, &[Planar]),
        weights: &[f64],
        body_height: f64,
    ) -> Result<Self, RegistrationError> {
        let (source_fps, target_fps) = (outgoing.0.fps(), incoming.0.fps());
        if (source_fps - target_fps).abs() > 1e-4 * source_fps {
            return Err(RegistrationError::FrameRates { source_fps, target_fps });
        }
        let (source_joints, target_joints) =
            (outgoing.0.skeleton().len(), incoming.0.skeleton().len());
        if source_joints != target_joints {
            return Err(RegistrationError::Skeletons { source_joints, target_joints });
        }
        let sum = checked_sum(weights, source_joints)?;
        for (which, (clip, frames)) in [("outgoing", outgoing), ("incoming", incoming)] {
            if clip.frames().min(frames.len()) == 0 {
                return Err(RegistrationError::Empty { which });
            }
        }
        let (outgoing, incoming) = (PosedClip::new(outgoing), PosedClip::new(incoming));
        if !(outgoing.is_finite() && incoming.is_finite()) {
            return Err(RegistrationError::NotFinite);
        }
        let longest = outgoing.frames().max(incoming.frames());
        let stride =
            ((source_fps / 60.0).ceil() as usize).max(longest.div_ceil(MAX_COARSE_FRAMES)).max(1);
        let pairs = outgoing.frames().div_ceil(stride) * incoming.frames().div_ceil(stride);
        Ok(Self {
            outgoing,
            incoming,
            weights: weights.iter().map(|weight| (weight / sum) as f32).collect(),
            scale: if body_height > 0.0 { REFERENCE_HEIGHT_M / body_height } else { 1.0 },
            fps: source_fps,
            stride,
            columns: None,
            done: 0,
            terms: Vec::with_capacity(pairs),
            sums: [0.0; 3],
        })
    }

    /// Compares up to `rows` more frames of the outgoing clip with all of the incoming one, and
    /// returns the progress.
    pub fn advance(&mut self, rows: usize) -> Progress {
        let total = self.outgoing.frames().div_ceil(self.stride);
        let end = self.done.saturating_add(rows).min(total);
        let columns = self.columns.take().unwrap_or_else(|| {
            self.incoming.posed((0..self.incoming.frames()).step_by(self.stride))
        });
        let compared = self.outgoing.posed((self.done..end).map(|row| row * self.stride));
        for row in 0..compared.rows() {
            for column in 0..columns.rows() {
                let terms = compared.row(row).mean_squares(&columns.row(column), &self.weights);
                self.terms.push(terms);
                for (sum, term) in self.sums.iter_mut().zip(terms) {
                    *sum += f64::from(term);
                }
            }
        }
        self.columns = Some(columns);
        self.done = end;
        Progress { done: self.done, total }
    }

    /// Returns the best pair for these weights and regions. The window of `options` only limits the
    /// frames: it must fit after both.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before the comparison is complete,
    /// [`RegistrationError::TooShort`] when the window does not fit.
    pub fn best(
        &self,
        weights: PoseWeights,
        options: &SearchOptions,
    ) -> Result<PoseMatch, RegistrationError> {
        let total = self.outgoing.frames().div_ceil(self.stride);
        if self.done < total {
            return Err(RegistrationError::Unfinished { done: self.done, total });
        }
        let (leave, leave_grew) = options.leave_starts(self.outgoing.frames())?;
        let (enter, enter_grew) = options.enter_starts(self.incoming.frames())?;
        let factors = self.factors(weights);
        let mut candidates = self.candidates(&factors, &leave, &enter);
        if candidates.is_empty() {
            // The region lies between two samples.
            candidates.push((leave.start, enter.start));
        }
        let reach = self.stride.max((CALM_REACH_SECS * self.fps).round() as usize);
        let mut pairs = Vec::new();
        for (i, j) in candidates {
            let around = |at: usize, region: &Range<usize>| {
                at.saturating_sub(reach).max(region.start)..(at + reach + 1).min(region.end)
            };
            let (left, entered) = (around(i, &leave), around(j, &enter));
            let (a, b) = (self.outgoing.posed(left.clone()), self.incoming.posed(entered.clone()));
            for (row, i) in left.enumerate() {
                let row = a.row(row);
                pairs.extend(entered.clone().enumerate().map(|(column, j)| {
                    (cost(&factors, &row.mean_squares(&b.row(column), &self.weights)), i, j)
                }));
            }
        }
        let lowest = pairs.iter().map(|pair| pair.0).min_by(f64::total_cmp);
        let lowest = lowest.unwrap_or(f64::INFINITY);
        pairs.retain(|pair| pair.0 <= lowest + lowest.min(MAX_CALM_COST));
        // Equal pairs are sorted by their frames, independent of the order in which they were
        // found.
        sort_by(&mut pairs, |a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let (cost, leave, enter) =
            self.calmest(&pairs).unwrap_or((f64::INFINITY, leave.start, enter.start));
        let (a, b) = (self.outgoing.posed([leave]), self.incoming.posed([enter]));
        let [position, rotation, velocity] =
            a.row(0).mean_squares(&b.row(0), &self.weights).map(|term| f64::from(term).sqrt());
        Ok(PoseMatch {
            leave,
            enter,
            cost,
            position_cm: position * 100.0 * self.scale,
            rotation_deg: (2.0 * libm::asin((0.5 * rotation).min(1.0))).to_degrees(),
            velocity_mps: velocity * self.scale,
            grown: leave_grew || enter_grew,
        })
    }

    /// Returns the first calm pair, or the calmest one where none is.
    fn calmest(&self, pairs: &[(f64, usize, usize)]) -> Option<(f64, usize, usize)> {
        // Many pairs have the same frames.
        let mut known = BTreeMap::new();
        let mut best: Option<(f32, (f64, usize, usize))> = None;
        for &pair in pairs {
            let jolt = self.jolt(pair.1, pair.2, &mut known);
            if best.is_none_or(|(least, _)| jolt < least) {
                best = Some((jolt, pair));
            }
            if jolt <= MAX_CALM_JOLT {
                return Some(pair);
            }
        }
        best.map(|(_, pair)| pair)
    }

    /// Returns the greatest jolt at the seam: in the last frame of the outgoing clip, and in the
    /// first of the incoming one. `known` keeps those of each clip's frames.
    fn jolt(&self, leave: usize, enter: usize, known: &mut BTreeMap<(bool, usize), f32>) -> f32 {
        let mut of = |source: &PosedClip, is_incoming: bool, frame: usize| {
            *known.entry((is_incoming, frame)).or_insert_with(|| source.jolt(frame))
        };
        let entered = of(&self.incoming, true, enter);
        leave.checked_sub(1).map_or(0.0, |last| of(&self.outgoing, false, last)).max(entered)
    }

    /// Returns the factor of every term. A term that is 0 everywhere has the factor 0; if all
    /// weights are 0, positions count.
    fn factors(&self, weights: PoseWeights) -> [f64; 3] {
        let weights = weights.of();
        let sum: f64 = weights.iter().sum();
        let weights =
            if sum > 0.0 && sum.is_finite() { weights.map(|w| w / sum) } else { [1.0, 0.0, 0.0] };
        let pairs = self.terms.len().max(1) as f64;
        let mut factors = [0.0; 3];
        for ((factor, weight), sum) in factors.iter_mut().zip(weights).zip(self.sums) {
            let mean = sum / pairs;
            *factor = if mean > 1e-12 { weight / mean } else { 0.0 };
        }
        factors
    }

    /// Returns the lowest local minima of the grid in the regions, as frames.
    fn candidates(
        &self,
        factors: &[f64; 3],
        leave: &Range<usize>,
        enter: &Range<usize>,
    ) -> Vec<(usize, usize)> {
        let samples = |region: &Range<usize>| {
            region.start.div_ceil(self.stride)..region.end.div_ceil(self.stride)
        };
        let (rows, columns) = (samples(leave), samples(enter));
        let stored = self.columns.as_ref().map_or(0, PosedFrames::rows);
        let width = columns.len();
        let costs: Vec<f64> = rows
            .clone()
            .flat_map(|row| self.terms[row * stored..][columns.clone()].iter())
            .map(|terms| cost(factors, terms))
            .collect();
        let mut minima: Vec<(f64, usize, usize)> = Vec::new();
        for row in 0..rows.len() {
            for column in 0..width {
                let here = costs[row * width + column];
                // Skip costs above those of enough known minima.
                if minima.len() == CANDIDATES && minima.last().is_some_and(|last| here >= last.0) {
                    continue;
                }
                let around = (row.saturating_sub(1)..(row + 2).min(rows.len())).flat_map(|r| {
                    (column.saturating_sub(1)..(column + 2).min(width)).map(move |c| (r, c))
                });
                // Strictly smaller than previous cells, so that a plateau is counted once.
                let lowest = around
                    .map(|(r, c)| (costs[r * width + c], (r, c)))
                    .all(|(there, at)| there > here || (there == here && at >= (row, column)));
                if lowest {
                    minima.push((here, row, column));
                    sort_by(&mut minima, |a, b| a.0.total_cmp(&b.0));
                    minima.truncate(CANDIDATES);
                }
            }
        }
        minima
            .into_iter()
            .map(|(_, row, column)| {
                ((rows.start + row) * self.stride, (columns.start + column) * self.stride)
            })
            .collect()
    }
}

fn cost(factors: &[f64; 3], terms: &[f32; 3]) -> f64 {
    factors.iter().zip(terms).map(|(factor, &term)| factor * f64::from(term)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::character_frames;
    use crate::registration::fixtures::Walk;
    use crate::registration::{Region, limb_weights};
    use crate::skeleton::Roles;
    use glam::{Quat, Vec3};

    fn search(a: &Arc<Clip>, b: &Arc<Clip>) -> PoseSearch {
        let roles = Roles::detect(a.skeleton());
        let (fa, fb) = (character_frames(a, &roles), character_frames(b, &roles));
        let mut search =
            PoseSearch::new((a, &fa), (b, &fb), &limb_weights(a.skeleton()), 1.75).unwrap();
        while !search.advance(7).is_complete() {}
        search
    }

    fn clip(walk: Walk) -> Arc<Clip> {
        Arc::new(walk.clip())
    }

    #[test]
    fn pose_search_is_close_to_the_best_of_all_pairs() {
        for (frames, fps) in [(240, 60.0), (300, 120.0), (400, 240.0), (1_500, 120.0)] {
            let a = clip(Walk { frames, fps, ..Walk::default() });
            let b = clip(Walk {
                frames: frames * 3 / 4,
                fps,
                cadence: 1.25,
                swing: 0.6,
                speed: 1.9,
                heading: 2.5,
                start: (4.0, 1.0),
                ..Walk::default()
            });
            let search = search(&a, &b);
            let left = search.outgoing.posed(0..a.frames());
            let entered = search.incoming.posed(0..b.frames());
            for (position, rotation, velocity) in
                [(0.6, 0.4, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 2.0), (0.2, 0.3, 0.5)]
            {
                let weights = PoseWeights { position, rotation, velocity };
                let options = SearchOptions::new(9);
                let found = search.best(weights, &options).unwrap();
                let factors = search.factors(weights);
                let best = (frames / 2..frames - 8)
                    .flat_map(|i| (0..b.frames() / 2).map(move |j| (i, j)))
                    .map(|(i, j)| {
                        cost(&factors, &left.row(i).mean_squares(&entered.row(j), &search.weights))
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!(
                    found.cost >= best && found.cost <= best + 0.02 + MAX_CALM_COST,
                    "{frames} {fps} {weights:?} {found:?} {best}"
                );
                assert!(
                    found.leave >= frames / 2
                        && found.leave + 9 <= frames
                        && found.enter <= b.frames() / 2
                );
            }
        }
    }

    #[test]
    fn pose_search_in_a_moved_clip_finds_the_same_frame() {
        let whole = Walk { frames: 300, fps: 240.0, turning: 0.5, ..Walk::default() }.clip();
        let a = Arc::new(whole.crop(0..180).unwrap());
        let b = Arc::new(whole.crop(141..300).unwrap().transformed(&Planar::new(1.9, -3.0, 8.0)));
        let weights = PoseWeights { velocity: 0.3, ..PoseWeights::default() };
        let found = search(&a, &b).best(weights, &SearchOptions::new(1)).unwrap();
        assert_eq!(found.leave, found.enter + 141, "{found:?}");
        assert!(
            found.cost < 1e-3
                && found.position_cm < 0.01
                && found.rotation_deg < 0.1
                && found.velocity_mps < 0.01
        );
        assert!(!found.grown);
    }

    #[test]
    fn pose_search_avoids_frames_with_jolts() {
        let walk = Walk { frames: 300, fps: 120.0, ..Walk::default() };
        let (a, b) = (clip(walk), clip(Walk { cadence: 1.25, swing: 0.6, speed: 1.9, ..walk }));
        let (weights, options) = (PoseWeights::default(), SearchOptions::new(9));
        let smooth = search(&a, &b).best(weights, &options).unwrap();
        let joints = a.skeleton().len();
        let mut rotations: Vec<Quat> =
            (0..a.frames()).flat_map(|f| a.rotations(f).to_vec()).collect();
        rotations[(smooth.leave - 1) * joints + 4] *= Quat::from_rotation_x(0.3);
        let jerked = Clip::new(
            "jerked",
            Arc::clone(a.skeleton()),
            a.fps(),
            rotations,
            a.root_translations().to_vec(),
        )
        .unwrap();
        let search = search(&Arc::new(jerked), &b);
        let found = search.best(weights, &options).unwrap();
        let jolt = |found: PoseMatch| search.jolt(found.leave, found.enter, &mut BTreeMap::new());
        assert!(jolt(smooth) > 3.0 && jolt(found) < 1.1, "{} {}", jolt(smooth), jolt(found));
        assert!(found.cost <= smooth.cost + MAX_CALM_COST, "{found:?} {smooth:?}");
        // A frame that the user chose is used in spite of its jolt.
        let named = options.leaving_at(smooth.leave, a.frames());
        assert_eq!(search.best(weights, &named).unwrap().leave, smooth.leave);
    }

    #[test]
    fn pose_match_is_in_documented_units() {
        let still = Walk { frames: 30, speed: 0.0, cadence: 0.0, swing: 0.0, ..Walk::default() };
        let a = clip(still);
        let glide = clip(Walk { speed: 0.5, ..still });
        let roots = a.root_translations().iter().map(|p| *p + Vec3::Y * 0.1).collect();
        let rotations = (0..30).flat_map(|f| a.rotations(f).to_vec()).collect();
        let raised = Arc::new(
            Clip::new("raised", Arc::clone(a.skeleton()), a.fps(), rotations, roots).unwrap(),
        );
        let bent: Vec<Quat> = (0..30)
            .flat_map(|f| {
                a.rotations(f).iter().map(|q| -*q * Quat::from_rotation_x(0.3)).collect::<Vec<_>>()
            })
            .collect();
        let bent = Arc::new(
            Clip::new(
                "bent",
                Arc::clone(a.skeleton()),
                a.fps(),
                bent,
                a.root_translations().to_vec(),
            )
            .unwrap(),
        );
        let options = SearchOptions::new(1);
        let to = |b| search(&a, b).best(PoseWeights::default(), &options).unwrap();
        assert!((to(&raised).position_cm - 10.0).abs() < 1e-3, "{:?}", to(&raised));
        assert!((to(&glide).velocity_mps - 0.5).abs() < 1e-3);
        assert!((to(&bent).rotation_deg - 0.3_f64.to_degrees()).abs() < 0.02, "{:?}", to(&bent));
        // Equal frames cost 0, although the mean of each term is 0.
        assert_eq!(to(&a).cost, 0.0);
        assert!(to(&raised).cost > 0.0);
    }

    #[test]
    fn pose_search_respects_regions_weights_and_slices() {
        let (a, b) =
            (clip(Walk::default()), clip(Walk { phase: 0.4, frames: 50, ..Walk::default() }));
        let search = search(&a, &b);
        let options =
            SearchOptions { enter: Region::ALL, ..SearchOptions::new(1).leaving_at(77, 120) };
        let found = search.best(PoseWeights::default(), &options).unwrap();
        assert_eq!(found.leave, 77);
        let none = PoseWeights { position: f64::NAN, rotation: -1.0, velocity: 0.0 };
        assert!(search.best(none, &options).unwrap().cost.is_finite());
        assert!(matches!(
            search.best(none, &SearchOptions::new(51)),
            Err(RegistrationError::TooShort { which: "incoming", .. })
        ));
        let roles = Roles::detect(a.skeleton());
        let frames = character_frames(&a, &roles);
        let weights = limb_weights(a.skeleton());
        let mut begun = PoseSearch::new((&a, &frames), (&a, &frames), &weights, 1.75).unwrap();
        begun.advance(3);
        assert!(matches!(
            begun.best(none, &options),
            Err(RegistrationError::Unfinished { done: 3, total: 120 })
        ));
        assert!(matches!(
            PoseSearch::new((&a, &frames), (&a, &[]), &weights, 1.75),
            Err(RegistrationError::Empty { which: "incoming" })
        ));
    }
}
