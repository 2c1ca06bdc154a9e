//! Point clouds of frames, laid out for SIMD.

use super::RegistrationError;
use crate::clip::Clip;
use crate::skeleton::WorldPose;
use glam::{DVec2, Vec4};
use std::ops::Range;

/// Number of samples in one SIMD register.
pub(super) const LANES: usize = 4;

/// Four samples of one joint: x, z and height.
pub(super) type Lanes = [Vec4; 3];

/// Four samples of one joint, each broadcast to a whole register and weighted: the left factor of
/// the products with [`Lanes`].
pub(super) type Spread = [[Vec4; 3]; LANES];

/// The joints with a weight above 0, with their weights as shares of 1.
#[derive(Clone, Debug)]
pub(super) struct Shares(Vec<(usize, f32)>);

impl Shares {
    pub(super) fn new(weights: &[f64], sum: f64) -> Self {
        let shares = weights.iter().enumerate().filter(|&(_, &w)| w > 0.0);
        Self(shares.map(|(joint, &w)| (joint, (w / sum) as f32)).collect())
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the weighted mean height of a clip's frame, metres.
    pub(super) fn mean_height(&self, clip: &Clip, frame: usize) -> f64 {
        let world = clip.world_pose(frame);
        let heights =
            self.0.iter().map(|&(joint, w)| f64::from(w) * f64::from(world.positions[joint].y));
        heights.sum()
    }
}

/// Every `stride`-th frame of a part of a clip as a cloud of points relative to the cloud's own
/// centre of mass on the ground.
///
/// Relative to their own centre the points are never farther away than the length of the body, so
/// that their products keep their digits in `f32`; the centres, which may be far away, are stored
/// in `f64`.
#[derive(Clone, Debug)]
pub(super) struct Cloud {
    pub(super) start: usize,
    /// Number of frames of the part, sampled or not.
    pub(super) span: usize,
    pub(super) samples: usize,
    /// The origin of all centres, metres: (x, z) of the first.
    pub(super) origin: DVec2,
    /// The weighted centres on the ground, one per sample.
    pub(super) x: Vec<f64>,
    pub(super) z: Vec<f64>,
    /// Σw(x² + z²) + Σwy² of every sample, relative to its centre: rounded exactly as the products
    /// of a pair are, so that the distance of equal poses is 0.
    pub(super) square: Vec<f64>,
    /// Samples in groups of [`LANES`], each `shares.len()` long.
    points: Vec<Lanes>,
    joints: usize,
}

impl Cloud {
    /// Builds the cloud of `frames`, which lie inside the clip and are not empty. Heights are
    /// relative to `level`.
    pub(super) fn new(
        clip: &Clip,
        frames: Range<usize>,
        stride: usize,
        shares: &Shares,
        level: f64,
    ) -> Result<Self, RegistrationError> {
        let mut cloud = Self::reserved(frames, stride, shares);
        cloud.advance(clip, stride, shares, level, usize::MAX)?;
        Ok(cloud)
    }

    /// Returns a cloud with space reserved for its points, none of which is known yet.
    pub(super) fn reserved(frames: Range<usize>, stride: usize, shares: &Shares) -> Self {
        let samples = frames.len().div_ceil(stride);
        Self {
            start: frames.start,
            span: frames.len(),
            samples,
            origin: DVec2::ZERO,
            x: Vec::with_capacity(samples),
            z: Vec::with_capacity(samples),
            square: Vec::with_capacity(samples),
            points: Vec::with_capacity(samples.div_ceil(LANES) * shares.len()),
            joints: shares.len(),
        }
    }

    /// Returns the number of samples whose points are known.
    pub(super) fn done(&self) -> usize {
        self.square.len()
    }

    /// Computes the points of at least `samples` more samples of the clip for which it was begun,
    /// in whole groups.
    pub(super) fn advance(
        &mut self,
        clip: &Clip,
        stride: usize,
        shares: &Shares,
        level: f64,
        samples: usize,
    ) -> Result<(), RegistrationError> {
        let (mut world, mut spread) = (WorldPose::default(), Vec::new());
        let end = self.done().saturating_add(samples).min(self.samples).div_ceil(LANES);
        for group in self.done().div_ceil(LANES)..end {
            self.points.resize((group + 1) * self.joints, [Vec4::ZERO; 3]);
            let samples = group * LANES..((group + 1) * LANES).min(self.samples);
            for sample in samples.clone() {
                clip.world_pose_into(self.start + sample * stride, &mut world);
                if !world.positions.iter().all(|p| p.is_finite()) {
                    return Err(RegistrationError::NotFinite);
                }
                self.push_sample(sample, &world, shares, level);
            }
            spread.clear();
            self.spread(group, shares, &mut spread);
            let [flat, _, height] = tile(&spread, self.group(group));
            let own =
                (0..LANES).map(|lane| f64::from(flat[lane][lane]) + f64::from(height[lane][lane]));
            self.square.extend(own.take(samples.len()));
        }
        Ok(())
    }

    fn push_sample(&mut self, sample: usize, world: &WorldPose, shares: &Shares, level: f64) {
        let at = |joint: usize| world.positions[joint].as_dvec3();
        let weighed = shares.0.iter().map(|&(joint, w)| at(joint) * f64::from(w));
        let (sum, weight) = (
            weighed.sum::<glam::DVec3>(),
            shares.0.iter().map(|&(_, w)| f64::from(w)).sum::<f64>(),
        );
        let centre = sum / weight;
        if sample == 0 {
            self.origin = DVec2::new(centre.x, centre.z);
        }
        self.x.push(centre.x - self.origin.x);
        self.z.push(centre.z - self.origin.y);
        let (group, lane) = (sample / LANES, sample % LANES);
        for (lanes, &(joint, _)) in self.points[group * self.joints..].iter_mut().zip(&shares.0) {
            let p = at(joint);
            let of = [p.x - centre.x, p.z - centre.z, p.y - level];
            for (lanes, of) in lanes.iter_mut().zip(of) {
                lanes[lane] = of as f32;
            }
        }
    }

    /// Returns the number of groups of [`LANES`] samples; the last group is padded with points at
    /// its centre.
    pub(super) fn groups(&self) -> usize {
        self.samples.div_ceil(LANES)
    }

    pub(super) fn group(&self, group: usize) -> &[Lanes] {
        &self.points[group * self.joints..(group + 1) * self.joints]
    }

    /// Appends a group to `out` in the form of the left factor.
    pub(super) fn spread(&self, group: usize, shares: &Shares, out: &mut Vec<Spread>) {
        let spread = self.group(group).iter().zip(&shares.0);
        out.extend(spread.map(|(lanes, &(_, w))| {
            std::array::from_fn(|lane| lanes.map(|of| Vec4::splat(of[lane] * w)))
        }));
    }

    /// Returns the centre of a sample.
    pub(super) fn centre(&self, sample: usize) -> DVec2 {
        DVec2::new(self.x[sample], self.z[sample])
    }

    /// Returns the samples whose window of `window` frames starts in `starts` (clip frames) and
    /// does not cross the end of the part.
    pub(super) fn starts(
        &self,
        starts: &Range<usize>,
        window: usize,
        stride: usize,
    ) -> Range<usize> {
        let end = starts.end.min((self.start + self.span + 1).saturating_sub(window));
        let first = starts.start.saturating_sub(self.start).div_ceil(stride);
        let last = end.saturating_sub(self.start).div_ceil(stride).min(self.samples);
        first.min(last)..last
    }
}

/// Returns the products of 4 × 4 pairs of samples, summed over the joints: Σw(x x' + z z'), Σw(x z'
/// - z x') and Σw y y', each by row.
///
/// Twelve sums stay in registers during the loop over joints. The order of all operations is fixed,
/// and none is fused, so that every machine gets the same bits.
pub(super) fn tile(rows: &[Spread], columns: &[Lanes]) -> [[Vec4; LANES]; 3] {
    let mut dot = [Vec4::ZERO; LANES];
    let mut cross = [Vec4::ZERO; LANES];
    let mut height = [Vec4::ZERO; LANES];
    for (rows, &[x, z, y]) in rows.iter().zip(columns) {
        for lane in 0..LANES {
            let [sx, sz, sy] = rows[lane];
            dot[lane] += sx * x + sz * z;
            cross[lane] += sx * z - sz * x;
            height[lane] += sy * y;
        }
    }
    [dot, cross, height]
}
