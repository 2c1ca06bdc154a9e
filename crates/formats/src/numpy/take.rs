//! A motion of a `NumPy` file on its way to a clip.

use super::array::View;
use super::body;
use super::bundle::Bundle;
use super::model::SmplModel;
use crate::assemble::assemble;
use crate::error::Fault;
use crate::measure::{UpSource, measure};
use crate::raw::{RawMotion, Y_UP_FROM_Z_UP};
use crate::warning::{Tally, WarningKind};
use crate::{ImportOptions, ImportedClip};
use glam::{Quat, Vec3};
use segue_motion::clip::UpAxis;
use segue_motion::skeleton::Joint;

/// The frame rate of files that have none, frames per second.
pub(super) const DEFAULT_FPS: f64 = 30.0;

/// The names under which files have their frame rate.
const RATES: [&str; 8] = [
    "mocap_framerate",
    "mocap_frame_rate",
    "fps",
    "framerate",
    "frame_rate",
    "mocap_fps",
    "rate",
    "frequency",
];

/// A motion whose rest pose has Y up, metres.
#[derive(Clone, Debug)]
pub(super) struct Take {
    /// The root in the world of the file, everything else with Y up.
    pub(super) raw: RawMotion,
    /// The frame rate, if the file has one.
    pub(super) fps: Option<f64>,
    /// The frame rate of the format.
    pub(super) default_fps: f64,
    /// The up axis of the world, if the format or the motion determines it.
    pub(super) up: Option<UpAxis>,
    /// The up axis of the world where the motion does not show it.
    pub(super) default_up: UpAxis,
}

impl Take {
    /// Returns a motion of joints by rotations (frame by frame) and the root's places.
    pub(super) fn new(joints: Vec<Joint>, rotations: Vec<Quat>, root: Vec<Vec3>) -> Self {
        let raw = RawMotion { joints, rotations, root_translations: root, ..RawMotion::default() };
        Self { raw, fps: None, default_fps: DEFAULT_FPS, up: None, default_up: UpAxis::Y }
    }

    /// Returns a motion of one of the bodies of the SMPL family by rotations (frame by frame) of
    /// `count` joints. `translation` moves the model; without it the body stands in its place.
    pub(super) fn of_smpl(
        count: usize,
        rotations: Vec<Quat>,
        translation: Option<Vec<Vec3>>,
        model: Option<(&SmplModel, &[f64])>,
        tally: &mut Tally,
    ) -> Self {
        let mut joints = body::joints(count);
        match model {
            Some((model, betas)) => model.shape(&mut joints, betas),
            None => tally.add(WarningKind::GenericBody, None),
        }
        let pelvis = joints.first().map_or(Vec3::ZERO, |joint| joint.offset);
        let frames = rotations.len() / count.max(1);
        let root = if let Some(places) = translation {
            places.into_iter().map(|place| place + pelvis).collect()
        } else {
            tally.add(WarningKind::NoPath, None);
            vec![standing(&joints); frames]
        };
        Self::new(joints, rotations, root)
    }

    /// Returns the motion with the frame rate of a file's numbers: a rate, or a length in seconds.
    pub(super) fn with_rate_of(mut self, bundle: &Bundle<'_>) -> Self {
        let is_rate = |rate: &f64| rate.is_finite() && (0.1..=10_000.0).contains(rate);
        let of_length = || {
            let secs = bundle.number(&["mocap_time_length"]).filter(|secs| *secs > 0.0)?;
            // To the last frame or to its end, whichever makes the rate a whole number.
            let frames = self.raw.frames() as f64;
            let rates = [frames / secs, (frames - 1.0) / secs];
            let off = |rate: &f64| (rate - rate.round()).abs();
            let rate = rates.into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
            Some(if off(&rate) < 0.02 { rate.round() } else { rate })
        };
        self.fps = bundle.number(&RATES).or_else(of_length).filter(is_rate).or(self.fps);
        self
    }

    /// Converts the motion to a clip. The frame rate is that of the options, the file or the
    /// format; a format's own is told.
    pub(super) fn into_clip(
        mut self,
        name: &str,
        options: &ImportOptions,
        tally: &mut Tally,
    ) -> Result<ImportedClip, Fault> {
        let is_finite = self.raw.joints.iter().all(|joint| joint.offset.is_finite())
            && self.raw.root_translations.iter().all(|place| place.is_finite());
        if !is_finite {
            let found = "numbers that are too large for a body";
            return Err(Fault::new(0, found, "a motion file"));
        }
        let given = options.fps.filter(|fps| fps.is_finite() && *fps > 0.0);
        let fps = given.or(self.fps).unwrap_or(self.default_fps);
        if given.is_none() && self.fps.is_none() {
            tally.add(WarningKind::AssumedFrameRate { fps }, None);
        }
        let found = measure(&self.raw, Some(1.0), None);
        let (up, up_source) = match (options.up, self.up) {
            (Some(up), _) => (up, UpSource::Given),
            (None, Some(up)) => (up, UpSource::Inferred),
            (None, None) if found.up_source == UpSource::Inferred => {
                (found.provenance.up, UpSource::Inferred)
            }
            (None, None) => (self.default_up, UpSource::Uncertain),
        };
        if up_source == UpSource::Uncertain {
            tally.add(WarningKind::UncertainUp { up }, None);
        }
        if up == UpAxis::Z {
            let joints = self.raw.joints.len().max(1);
            self.raw.root_translations.iter_mut().for_each(|v| *v = Y_UP_FROM_Z_UP * *v);
            let roots = self.raw.rotations.iter_mut().step_by(joints);
            roots.for_each(|q| *q = Y_UP_FROM_Z_UP * *q);
        }
        // The rest pose has Y up in any case.
        let upright = ImportOptions { up: Some(UpAxis::Y), ..*options };
        let clips = assemble(name, vec![self.raw], fps, &upright, Some(1.0), tally, 0)?;
        let mut imported =
            clips.into_iter().next().ok_or_else(|| Fault::new(0, "no arrays", "a motion file"))?;
        imported.measure.provenance.up = up;
        imported.measure.up_source = up_source;
        let provenance = imported.measure.provenance;
        imported.clip = imported.clip.with_provenance(provenance);
        Ok(imported)
    }
}

/// Returns the place of the root of a body that stands on the ground, Y up.
fn standing(joints: &[Joint]) -> Vec3 {
    let mut places: Vec<Vec3> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint.parent.and_then(|parent| places.get(parent));
        places.push(parent.map_or(Vec3::ZERO, |place| *place + joint.offset));
    }
    let lowest = places.iter().map(|place| place.y).fold(0.0, f32::min);
    Vec3::new(0.0, -lowest, 0.0)
}

/// Returns the vectors of an array of shape (frames, 3).
///
/// # Errors
/// [`Fault`] when there are not as many as `frames`, or the array has no numbers.
pub(super) fn vectors(
    view: &View<'_>,
    frames: usize,
    tally: &mut Tally,
) -> Result<Vec<Vec3>, Fault> {
    let numbers = view.numbers(tally)?;
    if numbers.len() != 3 * frames {
        return Err(super::wrong_shape(view.shape(), &format!("({frames},3)")));
    }
    Ok(numbers.chunks_exact(3).map(Vec3::from_slice).collect())
}
