//! Animation curves: the keys of one property of one node over time, and the three interpolations
//! between them.

use super::document::Document;
use crate::ImportError;
use glam::{Quat, Vec4};
use gltf::json::accessor::Type;
use gltf::json::animation::{Interpolation, Sampler};
use gltf::json::validation::Checked;
use segue_motion::math::quat;
use segue_text::msg;
use std::sync::Arc;

/// Tolerance in frames within which a time is that of a key: keys are stored in single precision.
pub(super) const SAME_FRAME: f64 = 0.01;

/// A curve of vectors or of quaternions.
pub(super) struct Curve {
    /// Seconds, not decreasing; not empty.
    pub(super) times: Arc<[f32]>,
    /// One value for each key; for a cubic spline three: the in-tangent, the value and the
    /// out-tangent, tangents per second.
    values: Vec<Vec4>,
    interpolation: Interpolation,
    is_rotation: bool,
}

/// The property that a curve animates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vector,
    Rotation,
}

impl Curve {
    /// Reads a sampler. `held` counts the values that are not finite: each repeats the one before
    /// it. Returns `None` for a curve without keys.
    pub(super) fn read(
        document: &Document<'_>,
        sampler: &Sampler,
        times: Arc<[f32]>,
        kind: Kind,
        held: &mut usize,
    ) -> Result<Option<Self>, ImportError> {
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(document.error("an unknown interpolation", "LINEAR, STEP or CUBICSPLINE"));
        };
        let (width, element) = match kind {
            Kind::Vector => (3, Type::Vec3),
            Kind::Rotation => (4, Type::Vec4),
        };
        let floats = document.floats(sampler.output, element)?;
        document.spend(floats.len(), size_of::<Vec4>())?;
        let mut values: Vec<Vec4> = Vec::with_capacity(floats.len() / width);
        let mut good = if kind == Kind::Rotation { Vec4::W } else { Vec4::ZERO };
        for parts in floats.chunks_exact(width) {
            let value = match *parts {
                [x, y, z] => Vec4::new(x, y, z, 0.0),
                [x, y, z, w] => Vec4::new(x, y, z, w),
                _ => good,
            };
            if value.is_finite() {
                good = value;
            } else {
                *held += 1;
            }
            values.push(good);
        }
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if values.len() != times.len() * per_key {
            let found =
                msg!("{values} values for {keys} keys", values = values.len(), keys = times.len());
            return Err(document.error(found, msg!("{per_key} for each key")));
        }
        Ok((!times.is_empty()).then_some(Self {
            times,
            values,
            interpolation,
            is_rotation: kind == Kind::Rotation,
        }))
    }

    /// Returns the value at a time, seconds; before the first key and after the last one it is
    /// constant. Times within `same_secs` of a key are that key's. `key` is the position of the
    /// last search, for times that increase.
    pub(super) fn at(&self, secs: f64, same_secs: f64, key: &mut usize) -> Vec4 {
        let time = |key: usize| f64::from(self.times[key]);
        let last = self.times.len() - 1;
        *key = (*key).min(last);
        while *key < last && time(*key + 1) <= secs + same_secs {
            *key += 1;
        }
        let (key, since) = (*key, secs - time(*key));
        if key == last || since <= same_secs || self.interpolation == Interpolation::Step {
            return self.key(key);
        }
        let span = time(key + 1) - time(key);
        let t = (since / span) as f32;
        match self.interpolation {
            Interpolation::CubicSpline => {
                // Section C.5: tangents are per second.
                let (t2, t3, span) = (t * t, t * t * t, span as f32);
                let [.., from, leaving] = self.triple(key);
                let [arriving, to, ..] = self.triple(key + 1);
                from * (2.0 * t3 - 3.0 * t2 + 1.0)
                    + leaving * (span * (t3 - 2.0 * t2 + t))
                    + to * (3.0 * t2 - 2.0 * t3)
                    + arriving * (span * (t3 - t2))
            }
            _ if self.is_rotation => {
                Vec4::from(quat::slerp(rotation(self.key(key)), rotation(self.key(key + 1)), t))
            }
            _ => self.key(key).lerp(self.key(key + 1), t),
        }
    }

    fn key(&self, key: usize) -> Vec4 {
        match self.interpolation {
            Interpolation::CubicSpline => self.triple(key)[1],
            _ => self.values[key],
        }
    }

    fn triple(&self, key: usize) -> [Vec4; 3] {
        [self.values[3 * key], self.values[3 * key + 1], self.values[3 * key + 2]]
    }

    /// Returns whether any value differs from `rest` by more than a thousandth.
    pub(super) fn differs_from(&self, rest: Vec4) -> bool {
        (0..self.times.len())
            .any(|key| (self.key(key) - rest).abs().max_element() > 1e-3 * rest.abs().max_element())
    }
}

/// Returns the unit quaternion of a value.
pub(super) fn rotation(value: Vec4) -> Quat {
    quat::renormalize(Quat::from_vec4(value))
}
