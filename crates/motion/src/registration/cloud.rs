//! Point clouds of frames, laid out for SIMD.

use super::RegistrationError;
use crate::clip::Clip;
use crate::skeleton::WorldPose;
use glam::{DVec2, Vec4};
use std::ops::Range;

/// Number of samples in one SIMD register.
pub(super) const LANES: usize = 4;

/// The number of planes of a group: x, z, x + z and the height of every joint. The left factor has
/// x - z in place of x + z.
const PLANES: usize = 4;

/// Number of the target's groups that are multiplied with a group of the source at once: eight sums
/// and their factors fit into 16 registers.
pub(super) const COLUMN_GROUPS: usize = 2;

/// Four samples of a joint, each broadcast to a whole register and weighted: the left factor of the
/// products.
pub(super) type Spread = [Vec4; LANES];

/// The sums of products of [`LANES`] samples of the source with [`LANES`] of the target, by the
/// source's sample.
pub(super) type GroupSums = [Vec4; LANES];

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
    /// Samples in groups of [`LANES`], each of [`PLANES`] times `joints`, plane by plane.
    points: Vec<Vec4>,
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
            points: Vec::with_capacity(samples.div_ceil(LANES) * PLANES * shares.len()),
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
        let mut products = [Products::default()];
        let end = self.done().saturating_add(samples).min(self.samples).div_ceil(LANES);
        for group in self.done().div_ceil(LANES)..end {
            self.points.resize((group + 1) * PLANES * self.joints, Vec4::ZERO);
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
            multiply(&spread, [self.group(group); COLUMN_GROUPS], &mut products);
            let [flat, _, height] = products[0].terms(0);
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
        let first = group * PLANES * self.joints;
        for (index, &(joint, _)) in shares.0.iter().enumerate() {
            let p = at(joint);
            let [x, z, height] = [p.x - centre.x, p.z - centre.z, p.y - level].map(|of| of as f32);
            for (plane, of) in [x, z, x + z, height].into_iter().enumerate() {
                self.points[first + plane * self.joints + index][lane] = of;
            }
        }
    }

    /// Returns the number of groups of [`LANES`] samples; the last group is padded with points at
    /// its centre.
    pub(super) fn groups(&self) -> usize {
        self.samples.div_ceil(LANES)
    }

    /// Returns the points of a group, plane by plane.
    pub(super) fn group(&self, group: usize) -> &[Vec4] {
        let length = PLANES * self.joints;
        &self.points[group * length..(group + 1) * length]
    }

    /// Appends a group to `out` in the form of the left factor, plane by plane.
    pub(super) fn spread(&self, group: usize, shares: &Shares, out: &mut Vec<Spread>) {
        let points = self.group(group);
        let (x, rest) = points.split_at(self.joints);
        let (z, rest) = rest.split_at(self.joints);
        let (_, height) = rest.split_at(self.joints);
        let difference = x.iter().zip(z).map(|(&x, &z)| x - z);
        let planes = x.iter().chain(z).copied().chain(difference).chain(height.iter().copied());
        out.extend(
            planes
                .zip(shares.0.iter().cycle())
                .map(|(of, &(_, w))| std::array::from_fn(|lane| Vec4::splat(of[lane] * w))),
        );
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

/// The products of a group of source samples with [`COLUMN_GROUPS`] of target samples, summed over
/// the joints.
#[derive(Clone, Copy, Debug)]
pub(super) struct Products([[GroupSums; COLUMN_GROUPS]; PLANES]);

impl Default for Products {
    fn default() -> Self {
        Self([[[Vec4::ZERO; LANES]; COLUMN_GROUPS]; PLANES])
    }
}

impl Products {
    /// Returns Σw(x x' + z z'), Σw(x z' - z x') and Σw y y' of the source's group with a group of
    /// the target.
    ///
    /// The first two are the parts of a product of complex numbers. They need three products of
    /// real numbers in place of four, since Σw(x - z)(x' + z') = Σw(x z' - z x') + Σw x x' -
    /// Σw z z' (Higham, "Stability of a Method for Multiplying Complex Matrices with Three Real
    /// Matrix Multiplications", 1992). For equal poses Σw(x z' - z x') is not exactly 0 then. Their
    /// squared distance falls by about the square of this error, and is clamped to 0.
    pub(super) fn terms(&self, group: usize) -> [GroupSums; 3] {
        let [x, z, mixed, height] = self.0.each_ref().map(|plane| &plane[group]);
        [
            std::array::from_fn(|row| x[row] + z[row]),
            std::array::from_fn(|row| mixed[row] - x[row] + z[row]),
            *height,
        ]
    }
}

/// Multiplies groups of source samples (from [`Cloud::spread`]) with groups of target samples: one
/// entry of `products` for each of the source.
///
/// The sums stay in registers during the loop over joints. The order of all operations is fixed,
/// and none is fused, so that every machine gets the same bits. A separate function, because
/// browsers optimise a function between two of its calls, and because the sums would not all stay
/// in registers if the terms were computed in the same one.
#[inline(never)]
pub(super) fn multiply(
    rows: &[Spread],
    columns: [&[Vec4]; COLUMN_GROUPS],
    products: &mut [Products],
) {
    let joints = columns.first().map_or(0, |points| points.len() / PLANES);
    if joints == 0 {
        return;
    }
    for (rows, products) in rows.chunks_exact(PLANES * joints).zip(products) {
        for (plane, (rows, sums)) in rows.chunks_exact(joints).zip(&mut products.0).enumerate() {
            let columns = columns.map(|points| &points[plane * joints..(plane + 1) * joints]);
            *sums = plane_sums(rows, columns);
        }
    }
}

/// Returns the sums of one plane's products over the joints.
#[inline]
fn plane_sums(rows: &[Spread], [a, b]: [&[Vec4]; COLUMN_GROUPS]) -> [GroupSums; COLUMN_GROUPS] {
    let mut sums = [[Vec4::ZERO; LANES]; COLUMN_GROUPS];
    for ((spread, &a), &b) in rows.iter().zip(a).zip(b) {
        for lane in 0..LANES {
            sums[0][lane] += spread[lane] * a;
            sums[1][lane] += spread[lane] * b;
        }
    }
    sums
}
