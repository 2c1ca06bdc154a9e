//! Conversion of labelled points to clips: a body if the labels identify one, otherwise points.

use super::assemble::assemble;
use super::error::Fault;
use super::raw::RawMotion;
use super::warning::{Tally, WarningKind};
use super::{ImportOptions, ImportedClip};
use glam::{Quat, Vec3};
use segue_motion::clip::UpAxis;
use segue_motion::math::stats;
use segue_motion::points::{
    Gaps, MarkerBody, PointFit, PointSet, body_from_markers, skeleton_from_points,
};
use segue_motion::skeleton::Joint;

/// Larger magnitudes come from damage, not from measurement.
const MAX_MAGNITUDE: f32 = 1e9;

/// The frame rate of files that state none, frames per second.
const DEFAULT_FPS: f64 = 100.0;

/// Labelled points over time, in the unit and axes of their file.
#[derive(Clone, Debug, Default)]
pub(super) struct LabelledPoints {
    pub(super) labels: Vec<String>,
    /// Frame by frame; a position that is not finite is a gap.
    pub(super) positions: Vec<Vec3>,
    /// The frame rate that the file states, frames per second.
    pub(super) fps: Option<f64>,
    /// The unit that the file states, metres.
    pub(super) unit: Option<f64>,
    /// The up axis that the file states.
    pub(super) up: Option<UpAxis>,
}

/// Names of units of length.
pub(super) struct UnitWord;

impl UnitWord {
    /// Returns the metres per unit of a name: `mm`, `cm`, `m`, `in`, `ft`, in any case.
    pub(super) fn metres(word: &str) -> Option<f64> {
        match word.trim().to_ascii_lowercase().as_str() {
            "m" | "meter" | "meters" | "metre" | "metres" => Some(1.0),
            "dm" => Some(0.1),
            "cm" | "centimeters" | "centimetres" => Some(0.01),
            "mm" | "millimeters" | "millimetres" | "millimeter" => Some(0.001),
            "in" | "inch" | "inches" => Some(0.0254),
            "ft" | "foot" | "feet" => Some(0.3048),
            _ => None,
        }
    }
}

impl LabelledPoints {
    /// Returns a clip of a body with joints if the labels identify one, otherwise of the points.
    pub(super) fn into_clips(
        mut self,
        name: &str,
        options: &ImportOptions,
        tally: &mut Tally,
    ) -> Result<Vec<ImportedClip>, Fault> {
        for at in &mut self.positions {
            if !at.is_finite() || at.abs().max_element() > MAX_MAGNITUDE {
                *at = Vec3::NAN;
            }
        }
        for (index, label) in self.labels.iter_mut().enumerate() {
            if label.is_empty() {
                *label = format!("P{}", index + 1);
            }
        }
        let given = options.fps.filter(|fps| fps.is_finite() && (0.1..=100_000.0).contains(fps));
        let fps = given.or(self.fps).unwrap_or_else(|| {
            tally.add(WarningKind::AssumedFrameRate { fps: DEFAULT_FPS }, None);
            DEFAULT_FPS
        });
        let set = options.metres_per_unit.filter(|unit| unit.is_finite() && *unit > 0.0);
        let unit = set.or(self.unit).unwrap_or_else(|| self.likely_unit());
        let body = body_from_markers(&self.labels, &self.positions, unit);
        let fit = body.and_then(|body| self.fit(&body, fps, options));
        let mut own = *options;
        let raw = if let Some((fit, up, used)) = fit {
            own.up = Some(up);
            tell_gaps(&fit.gaps, tally);
            let kind = WarningKind::SkeletonFromPoints {
                markers: used,
                of: self.labels.len(),
                error_mm: f64::from(fit.error.mean) * unit * 1000.0,
            };
            tally.add(kind, None);
            RawMotion::from_points(fit)
        } else {
            own.up = options.up.or(self.up);
            // The unit cannot be inferred from the height of points.
            own.metres_per_unit = set.or(self.unit);
            tally.add(WarningKind::PointsOnly { points: self.labels.len() }, None);
            self.as_joints(tally)
                .ok_or_else(|| Fault::new(0, "points that no frame shows", "points over time"))?
        };
        assemble(name, vec![raw], fps, &own, self.unit, tally, 0)
    }

    /// Returns the skeleton of a body, the axis that is up, and the number of its markers.
    fn fit(
        &self,
        body: &MarkerBody,
        fps: f64,
        options: &ImportOptions,
    ) -> Option<(PointFit, UpAxis, usize)> {
        let up = options.up.or_else(|| upright(body)).or(self.up).unwrap_or_default();
        let set = PointSet { points: &body.points, positions: &body.positions, fps, up };
        Some((skeleton_from_points(&set).ok()?, up, body.used))
    }

    /// Returns the unit by which the points span a body: metres, centimetres or millimetres.
    fn likely_unit(&self) -> f64 {
        let markers = self.labels.len().max(1);
        let spans: Vec<f32> = self
            .positions
            .chunks(markers)
            .filter_map(|frame| {
                let seen = || frame.iter().copied().filter(|at| at.is_finite());
                let low = seen().reduce(Vec3::min)?;
                Some((seen().reduce(Vec3::max)? - low).max_element())
            })
            .collect();
        match stats::percentile(&spans, 0.5) {
            Some(span) if span > 400.0 => 0.001,
            Some(span) if span > 5.0 => 0.01,
            _ => 1.0,
        }
    }

    /// Returns the points as joints without bones: children of a joint at their centre.
    fn as_joints(&self, tally: &mut Tally) -> Option<RawMotion> {
        let markers = self.labels.len();
        let frames = self.positions.len().checked_div(markers)?;
        let mut gaps = Gaps::default();
        let tracks: Vec<(usize, Vec<Vec3>)> = (0..markers)
            .filter_map(|marker| {
                let values = self.positions.iter().skip(marker).step_by(markers).copied();
                let filled = gaps.fill(values, self.fps.unwrap_or(DEFAULT_FPS));
                if filled.is_none() {
                    gaps.unseen.push(self.labels[marker].clone());
                }
                Some((marker, filled?))
            })
            .collect();
        if tracks.is_empty() || frames == 0 {
            return None;
        }
        tell_gaps(&gaps, tally);
        let centre = |frame: usize| {
            let sum: Vec3 = tracks.iter().map(|(_, track)| track[frame]).sum();
            sum / tracks.len() as f32
        };
        let root: Vec<Vec3> = (0..frames).map(centre).collect();
        let joint = |name: &str, parent: Option<usize>, offset: Vec3| Joint {
            name: name.to_owned(),
            parent,
            offset,
            end_site: None,
            channels: Vec::new(),
        };
        let mut raw = RawMotion {
            joints: vec![joint("Points", None, root[0])],
            rotations: vec![Quat::IDENTITY; frames * (tracks.len() + 1)],
            ..RawMotion::default()
        };
        for (marker, mut track) in tracks {
            track.iter_mut().zip(&root).for_each(|(at, root)| *at -= *root);
            raw.joints.push(joint(&self.labels[marker], Some(0), track[0]));
            raw.tracks.push((raw.joints.len() - 1, track));
        }
        raw.root_translations = root;
        Some(raw)
    }
}

impl RawMotion {
    /// Returns the motion of a skeleton that was made from points.
    pub(super) fn from_points(fit: PointFit) -> Self {
        Self {
            joints: fit.joints,
            rotations: fit.rotations,
            root_translations: fit.root_translations,
            ..Self::default()
        }
    }
}

fn tell_gaps(gaps: &Gaps, tally: &mut Tally) {
    let (filled, held) = (gaps.filled, gaps.held);
    if filled + held > 0 {
        let longest = gaps.longest;
        tally.add(WarningKind::FilledGaps { points: gaps.points, filled, held, longest }, None);
    }
    for name in &gaps.unseen {
        tally.add(WarningKind::UnseenPoints { name: name.clone() }, None);
    }
}

/// Returns the axis along which a body stands from its feet to its head, if that is clear.
fn upright(body: &MarkerBody) -> Option<UpAxis> {
    let count = body.points.len().max(1);
    let index = |names: &[&str]| {
        names.iter().find_map(|name| body.points.iter().position(|point| point.name == *name))
    };
    let top = index(&["Head", "Neck", "Hips"])?;
    let feet = index(&["LeftFoot"]).into_iter().chain(index(&["RightFoot"]));
    let feet: Vec<usize> = feet.collect();
    let mut sum = Vec3::ZERO;
    for frame in body.positions.chunks_exact(count) {
        for foot in &feet {
            let up = frame[top] - frame[*foot];
            if up.is_finite() {
                sum += up.normalize_or_zero();
            }
        }
    }
    let sum = sum.try_normalize()?.abs();
    match (sum.y > 0.7, sum.z > 0.7) {
        (true, false) => Some(UpAxis::Y),
        (false, true) => Some(UpAxis::Z),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_labels_stay_points_in_their_unit() {
        let at = |frame: usize, marker: usize| {
            if marker == 2 && (3..5).contains(&frame) {
                return Vec3::NAN;
            }
            Vec3::new(marker as f32 * 100.0, 200.0, frame as f32 * 10.0)
        };
        let points = LabelledPoints {
            labels: ["a", "b", "c", "never"].map(str::to_owned).to_vec(),
            positions: (0..10)
                .flat_map(|frame| {
                    (0..4).map(move |m| if m == 3 { Vec3::NAN } else { at(frame, m) })
                })
                .collect(),
            fps: Some(50.0),
            unit: Some(0.001),
            up: Some(UpAxis::Y),
        };
        let mut tally = Tally::default();
        let clips = points.into_clips("p.trc", &ImportOptions::default(), &mut tally).unwrap();
        let clip = &clips[0].clip;
        assert_eq!((clip.frames(), clip.skeleton().len(), clip.fps()), (10, 4, 50.0));
        for frame in [0, 4, 9] {
            let here = clip.world_positions(frame..frame + 1);
            let c = Vec3::new(0.2, 0.2, frame as f32 * 0.01);
            assert!(here[3].distance(c) < 1e-5, "{frame}: {here:?}");
        }
        let kinds: Vec<String> =
            tally.into_warnings(b"").iter().map(|warning| format!("{:?}", warning.kind)).collect();
        assert!(kinds.iter().any(|kind| kind.contains("PointsOnly")), "{kinds:?}");
        assert!(kinds.iter().any(|kind| kind.contains("never")), "{kinds:?}");
        assert!(kinds.iter().any(|kind| kind.contains("FilledGaps")), "{kinds:?}");
    }
}
