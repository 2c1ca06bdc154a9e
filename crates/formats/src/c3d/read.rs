//! The frames of a file, and its clip.

use super::numbers::Processor;
use super::parameters::{Parameters, section_start};
use super::{BLOCK, is_c3d};
use crate::labelled::{LabelledPoints, UnitWord};
use crate::warning::{Tally, WarningKind};
use crate::{ImportError, ImportOptions, ImportedFile, check_size};
use glam::Vec3;
use segue_motion::clip::UpAxis;

/// The parameters that name points which are no places: results of models.
const RESULTS: [&str; 5] =
    ["POINT:ANGLES", "POINT:FORCES", "POINT:MOMENTS", "POINT:POWERS", "POINT:SCALARS"];
/// Ends of labels of such points in files without these parameters.
const RESULT_WORDS: [&str; 4] = ["angle", "moment", "power", "force"];

/// Reads the points of a C3D file: as a body where labels tell its joints, otherwise as they are.
///
/// # Errors
/// [`ImportError`] when the file is no C3D file, or holds no points.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    check_size(name, bytes, options)?;
    if !is_c3d(bytes) {
        return Err(ImportError::whole_file(
            name,
            "no header of a C3D file",
            "a C3D file of points (.c3d)",
        ));
    }
    let mut tally = Tally::default();
    let points = points(name, bytes, &mut tally)?;
    let clips =
        points.into_clips(name, options, &mut tally).map_err(|fault| fault.locate(name, b""))?;
    Ok(ImportedFile { clips, warnings: tally.into_warnings(b"") })
}

/// The layout of the frames.
struct Layout {
    processor: Processor,
    start: usize,
    points: usize,
    frame_bytes: usize,
    frames: usize,
    is_float: bool,
    scale: f32,
}

pub(super) fn points(
    name: &str,
    bytes: &[u8],
    tally: &mut Tally,
) -> Result<LabelledPoints, ImportError> {
    let section = section_start(bytes);
    let processor = bytes.get(section + 3).and_then(|byte| Processor::of(*byte));
    let processor = processor.unwrap_or(Processor::Intel);
    let parameters = Parameters::read(bytes, section, processor);
    let layout = Layout::of(bytes, processor, &parameters, tally);
    if layout.points == 0 || layout.frames == 0 {
        let found = if layout.points == 0 {
            "a C3D file without points"
        } else {
            "a C3D file without frames"
        };
        return Err(without_points(name, found));
    }
    let mut labels = parameters.texts("POINT:LABELS");
    labels.resize_with(layout.points, String::new);
    let results: Vec<String> = RESULTS.iter().flat_map(|group| parameters.texts(group)).collect();
    let is_place = |label: &str| {
        let lower = label.to_ascii_lowercase();
        !results.iter().any(|result| !result.is_empty() && result == label)
            && !RESULT_WORDS.iter().any(|word| lower.contains(word))
    };
    let kept: Vec<usize> = (0..layout.points).filter(|&point| is_place(&labels[point])).collect();
    if kept.is_empty() {
        return Err(without_points(name, "a C3D file without points"));
    }
    let rate = parameters
        .number("POINT:RATE")
        .or_else(|| processor.f32_at(bytes, 20).map(f64::from))
        .filter(|rate| rate.is_finite() && (0.1..=100_000.0).contains(rate));
    Ok(LabelledPoints {
        positions: layout.positions(bytes, &kept),
        labels: kept.iter().map(|&point| std::mem::take(&mut labels[point])).collect(),
        fps: rate,
        unit: parameters.text("POINT:UNITS").and_then(|unit| UnitWord::metres(&unit)),
        up: match parameters.text("POINT:Y_SCREEN").as_deref().map(|axis| axis.trim_matches('+')) {
            Some("Z" | "z") => Some(UpAxis::Z),
            Some("Y" | "y") => Some(UpAxis::Y),
            _ => None,
        },
    })
}

fn without_points(name: &str, found: &'static str) -> ImportError {
    ImportError::whole_file(name, found, "points over time")
        .with_hint("export the trajectories of the markers as well")
}

impl Layout {
    fn of(
        bytes: &[u8],
        processor: Processor,
        parameters: &Parameters<'_>,
        tally: &mut Tally,
    ) -> Self {
        let header = |at: usize| processor.u16_at(bytes, at).map_or(0, usize::from);
        let whole = |value: Option<f64>| {
            value.filter(|value| value.is_finite() && *value >= 0.0).map(|value| value as usize)
        };
        let points = whole(parameters.count("POINT:USED")).unwrap_or_else(|| header(2));
        let valid = |scale: &f32| scale.is_finite() && *scale != 0.0;
        let by_parameter = parameters.number("POINT:SCALE").map(|scale| scale as f32).filter(valid);
        let in_header = processor.f32_at(bytes, 12).filter(valid);
        // Of two scales of integers, that of the header is the size of the bodies in a file of
        // Motion Analysis.
        let scale = match (by_parameter, in_header) {
            (Some(own), Some(header)) if own > 0.0 && header > 0.0 => header,
            (own, header) => own.or(header).unwrap_or(-1.0),
        };
        let is_float = scale < 0.0;
        let (point_bytes, value_bytes) = if is_float { (16, 4) } else { (8, 2) };
        let block = whole(parameters.count("POINT:DATA_START"))
            .filter(|block| *block > 1)
            .unwrap_or_else(|| header(16));
        let start = block.saturating_sub(1).saturating_mul(BLOCK);
        let room = bytes.len().saturating_sub(start);
        let declared = Self::declared(parameters, header(6), header(8));
        let size = |analog: usize| {
            points.saturating_mul(point_bytes).saturating_add(analog.saturating_mul(value_bytes))
        };
        let ratio = match (parameters.number("ANALOG:RATE"), parameters.number("POINT:RATE")) {
            (Some(analog), Some(point)) if point > 0.0 => (analog / point).round().max(1.0),
            _ => 1.0,
        };
        let used = whole(parameters.count("ANALOG:USED")).unwrap_or(0);
        // The header's number of analogue values, unless only that of the parameters fits the file.
        let by_header = size(header(4));
        let by_parameters = size(used.saturating_mul(ratio as usize));
        let fits = |size: usize| {
            declared.is_some_and(|frames| {
                let needed = size.saturating_mul(frames);
                needed <= room && room - needed < 2 * BLOCK
            })
        };
        let frame_bytes =
            if !fits(by_header) && fits(by_parameters) { by_parameters } else { by_header };
        let available = room.checked_div(frame_bytes).unwrap_or(0);
        let frames = match declared {
            Some(declared) if declared <= available => declared,
            Some(declared) => {
                let kind =
                    WarningKind::FrameCount { declared: declared.to_string(), found: available };
                tally.add(kind, None);
                available
            }
            None => available,
        };
        Self { processor, start, points, frame_bytes, frames, is_float, scale: scale.abs() }
    }

    /// Returns the number of frames that the file declares; `None` where it does not fit into the
    /// fields that say it.
    fn declared(parameters: &Parameters<'_>, first: usize, last: usize) -> Option<usize> {
        let span = |first: f64, last: f64| {
            let frames = last - first + 1.0;
            (frames.is_finite() && (1.0..1e9).contains(&frames)).then_some(frames as usize)
        };
        let actual = || {
            let first = parameters.frame("TRIAL:ACTUAL_START_FIELD")?;
            span(first, parameters.frame("TRIAL:ACTUAL_END_FIELD")?)
        };
        let by_parameter = || {
            let frames = parameters.count("POINT:FRAMES")?;
            // Some programs store a number that does not fit as a float, others as this.
            span(1.0, frames).filter(|frames| *frames != 65_535)
        };
        let by_header = || span(first as f64, last as f64).filter(|_| last != 65_535);
        actual().or_else(by_parameter).or_else(by_header)
    }

    /// Returns the positions of some of the points, frame by frame; NaN where a point is missing.
    fn positions(&self, bytes: &[u8], kept: &[usize]) -> Vec<Vec3> {
        let data = bytes.get(self.start..).unwrap_or_default();
        let frames = data.chunks_exact(self.frame_bytes.max(1)).take(self.frames);
        let mut positions = Vec::with_capacity(frames.len().saturating_mul(kept.len()));
        for frame in frames {
            positions.extend(kept.iter().map(|&point| self.position(frame, point)));
        }
        positions
    }

    fn position(&self, frame: &[u8], point: usize) -> Vec3 {
        let (place, residual) = if self.is_float {
            let at = |index: usize| self.processor.f32_at(frame, point * 16 + index * 4);
            let [x, y, z, residual] = [0, 1, 2, 3].map(|i| at(i).unwrap_or(f32::NAN));
            (Vec3::new(x, y, z), residual)
        } else {
            let at = |index: usize| {
                let value = self.processor.u16_at(frame, point * 8 + index * 2);
                value.map_or(f32::NAN, |value| f32::from(value as i16))
            };
            let [x, y, z, residual] = [0, 1, 2, 3].map(at);
            (Vec3::new(x, y, z) * self.scale, residual)
        };
        // Programs without residuals write zeros.
        if residual < 0.0 || !place.is_finite() || place == Vec3::ZERO { Vec3::NAN } else { place }
    }
}
