//! Reading of AMC files with their skeleton.

use super::amc::{Stop, frames};
use super::convert::Converter;
use super::skeleton::AcclaimSkeleton;
use crate::assemble::assemble;
use crate::error::{Fault, ImportError};
use crate::raw::RawMotion;
use crate::text::decode;
use crate::warning::{Tally, WarningKind};
use crate::{ImportOptions, ImportedFile, check_size};
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Role, Roles, WorldPose};

/// Frame rate of the CMU database, frames per second, assumed where none is given: AMC files have
/// none.
pub const DEFAULT_FPS: f64 = 120.0;

/// Reads an AMC file, the motion of a skeleton: one clip in metres and Y up, with the skeleton's
/// warnings before its own.
///
/// `name` is the file's name; it is used in errors and, without its ending, as the name of the
/// clip. The frame rate is that of the options, or [`DEFAULT_FPS`]. The unit is that of the
/// options; otherwise 0.0254 m divided by the `length` of the skeleton's `:units`, the convention
/// of the CMU database, if the character is then 0.9 to 2.5 m tall at rest; otherwise it is
/// inferred from the height.
///
/// # Errors
/// [`ImportError`] with the place that cannot be read, and when the skeleton has none of the bones.
pub fn read_motion(
    name: &str,
    bytes: &[u8],
    skeleton: &AcclaimSkeleton,
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    // `None` is returned only when cancelled, which never happens here.
    Ok(read_motion_with_progress(name, bytes, skeleton, options, &mut |_| true)?
        .unwrap_or_default())
}

/// Reads an AMC file as [`read_motion`] does, reports the bytes read so far about every 256 KB, and
/// stops with `None` when `progress` returns `false`.
///
/// # Errors
/// Those of [`read_motion`].
pub fn read_motion_with_progress(
    name: &str,
    bytes: &[u8],
    skeleton: &AcclaimSkeleton,
    options: &ImportOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<ImportedFile>, ImportError> {
    check_size(name, bytes, options)?;
    let text = decode(bytes);
    let mut tally = Tally::default();
    let mut converter = Converter::new(skeleton, text.len());
    let first_at = match frames(&text, skeleton, &mut converter, &mut tally, progress) {
        Ok(first_at) => first_at,
        Err(Stop::Cancelled) => return Ok(None),
        Err(Stop::Fault(fault)) => return Err(fault.locate(name, &text)),
    };
    if given_fps(options).is_none() {
        tally.add(WarningKind::AssumedFrameRate { fps: DEFAULT_FPS }, None);
    }
    finish(name, converter.finish(), skeleton, options, tally, first_at, &text)
        .map(Some)
        .map_err(|fault| fault.locate(name, &text))
}

/// Returns the skeleton alone, as a clip without frames.
///
/// # Errors
/// Only those of the reader of the skeleton.
pub fn skeleton_clip(
    skeleton: &AcclaimSkeleton,
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    let raw = Converter::new(skeleton, 0).finish();
    let mut tally = Tally::default();
    tally.add(WarningKind::NoFrames, None);
    finish(&skeleton.file, raw, skeleton, options, tally, 0, b"")
        .map_err(|fault| fault.locate(&skeleton.file, b""))
}

fn given_fps(options: &ImportOptions) -> Option<f64> {
    options.fps.filter(|fps| fps.is_finite() && *fps > 0.0)
}

fn finish(
    name: &str,
    raw: RawMotion,
    skeleton: &AcclaimSkeleton,
    options: &ImportOptions,
    mut tally: Tally,
    first_row_at: usize,
    text: &[u8],
) -> Result<ImportedFile, Fault> {
    let fps = given_fps(options).unwrap_or(DEFAULT_FPS);
    let clips =
        assemble(name, vec![raw], fps, options, skeleton.unit_of_file, &mut tally, first_row_at)?;
    if let Some(metres) = clips.first().and_then(|found| off_ground(&found.clip)) {
        tally.add(WarningKind::OffGround { metres }, None);
    }
    let mut warnings = skeleton.warnings.clone();
    warnings.extend(tally.into_warnings(text));
    Ok(ImportedFile { clips, warnings })
}

/// Returns the height of the lowest feet of a motion above the ground (y = 0), metres, if it is
/// implausible: on a body with longer or shorter legs than its own, a motion sinks into the ground
/// or floats. `None` otherwise, and for a body without feet.
fn off_ground(clip: &Clip) -> Option<f32> {
    /// The number of frames that are read, spread over the clip.
    const SAMPLES: usize = 240;
    /// Feet below or above these shares of a body's height are below the ground or in the air.
    /// Marker noise and soles stay within.
    const MIN_SHARE: f32 = -0.06;
    const MAX_SHARE: f32 = 0.1;
    let roles = Roles::detect(clip.skeleton());
    let feet = [Role::LeftFoot, Role::LeftToe, Role::RightFoot, Role::RightToe]
        .map(|role| roles.get(role));
    let [Some(_), _, Some(_), _] = feet else {
        return None;
    };
    let samples = clip.frames().min(SAMPLES);
    let mut world = WorldPose::default();
    let mut lows: Vec<f32> = Vec::with_capacity(samples);
    for sample in 0..samples {
        clip.world_pose_into(sample * clip.frames() / samples, &mut world);
        let heights =
            feet.iter().flatten().filter_map(|&joint| world.positions.get(joint).map(|p| p.y));
        lows.push(heights.fold(f32::MAX, f32::min));
    }
    lows.sort_by(f32::total_cmp);
    // One frame in twenty may be a capture fault.
    let low = *lows.get(lows.len() / 20)?;
    let share = low / roles.body_height(clip.skeleton());
    (!(MIN_SHARE..MAX_SHARE).contains(&share)).then_some(low)
}
