use super::convert::Converter;
use super::header::{DEFAULT_FPS, header};
use super::hierarchy::hierarchy;
use super::lexer::{Lexer, Stop};
use super::motion::{Progress, rows};
use crate::formats::error::{Fault, ImportError};
use crate::formats::measure::measure;
use crate::formats::raw::RawMotion;
use crate::formats::t_pose::first_frame_is_t_pose;
use crate::formats::text::decode;
use crate::formats::warning::{Tally, WarningKind};
use crate::formats::{ImportOptions, Imported, ImportedClip, check_size, stem};

/// Reads a BVH file: one clip for each ROOT, in metres and Y up.
///
/// `name` is the file's name; it is used in errors and, without its ending, as the name of the clip.
///
/// # Errors
/// [`ImportError`] with the place of what cannot be read.
pub fn read(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Imported, ImportError> {
    // Never cancelled, so never `None`.
    Ok(read_with_progress(name, bytes, options, &mut |_| true)?.unwrap_or_default())
}

/// [`read`] that reports the bytes read so far now and then, and stops with `None` when `progress` returns `false`.
///
/// # Errors
/// As [`read`].
pub fn read_with_progress(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<Imported>, ImportError> {
    check_size(name, bytes, options)?;
    let text = decode(bytes);
    let result = match parse(name, &text, options, false, progress) {
        // The first number with a comma. If all have one it is read that way; if not, the first complaint was right.
        Err(Stop::OtherDecimalSign(complaint)) => match parse(name, &text, options, true, progress) {
            Err(Stop::OtherDecimalSign(_)) => Err(Stop::Fault(complaint)),
            other => other,
        },
        other => other,
    };
    match result {
        Ok(imported) => Ok(Some(imported)),
        Err(Stop::Cancelled) => Ok(None),
        Err(Stop::Fault(fault) | Stop::OtherDecimalSign(fault)) => Err(fault.locate(name, &text)),
    }
}

fn parse(name: &str, text: &[u8], options: &ImportOptions, commas: bool, progress: Progress<'_>) -> Result<Imported, Stop> {
    let mut lexer = Lexer::new(text, commas);
    if commas {
        lexer.tally.add(WarningKind::DecimalCommas, None);
    }
    let tree = hierarchy(&mut lexer)?;
    let header = header(&mut lexer)?;
    let given_fps = options.fps.filter(|fps| fps.is_finite() && *fps > 0.0);
    let fps = match given_fps {
        Some(fps) => fps,
        None if header.present => header.fps(&mut lexer),
        None => DEFAULT_FPS,
    };
    let declared = header.declared_frames().unwrap_or(f64::INFINITY);
    lexer.skip_blank();
    let first_row_at = lexer.at;
    let mut converter = Converter::new(&tree, declared, first_row_at..text.len());
    let found = rows(&mut lexer, Converter::first_row(&tree), &mut converter, progress)?;
    match &header.frames {
        Some((declared, at)) if header.declared_frames() != Some(found as f64) => {
            lexer.tally.add(
                WarningKind::FrameCount {
                    declared: declared.clone(),
                    found,
                },
                Some(*at),
            );
        }
        _ => {}
    }
    if found == 0 {
        lexer.tally.add(WarningKind::NoFrames, None);
    }
    assemble(name, converter.finish(), fps, options, &mut lexer.tally, first_row_at)
        .map(|clips| Imported {
            clips,
            warnings: std::mem::take(&mut lexer.tally).into_warnings(text),
        })
        .map_err(Stop::Fault)
}

fn assemble(
    name: &str,
    mut motions: Vec<RawMotion>,
    fps: f64,
    options: &ImportOptions,
    tally: &mut Tally,
    first_row_at: usize,
) -> Result<Vec<ImportedClip>, Fault> {
    let mut rest_from_first_row = false;
    for motion in &mut motions {
        rest_from_first_row |= motion.rest_from_first_frame();
    }
    if rest_from_first_row {
        tally.add(WarningKind::RestFromFirstRow, None);
    }
    let t_poses: Vec<bool> = motions.iter().map(first_frame_is_t_pose).collect();
    // Characters of one file stay in step: the row goes only where it is a T-pose for all of them.
    let dropped = options.drop_t_pose && t_poses.iter().all(|&is_t_pose| is_t_pose);
    if t_poses.contains(&true) {
        tally.add(WarningKind::TPose { dropped }, Some(first_row_at));
    }
    let several = motions.len() > 1;
    let mut clips = Vec::with_capacity(motions.len());
    for (mut raw, t_pose_first_row) in motions.into_iter().zip(t_poses) {
        if dropped {
            raw.drop_first_frame();
        }
        let measure = measure(&raw, options.metres_per_unit, options.up);
        if measure.unit_unknown {
            tally.add(WarningKind::UnknownUnit, None);
        }
        let clip_name = match raw.joints.first() {
            Some(root) if several => format!("{} ({})", stem(name), root.name),
            _ => stem(name).to_owned(),
        };
        let clip = raw
            .into_clip(clip_name, fps, &measure)
            .map_err(|error| Fault::new(0, error.to_string(), "a skeleton with a motion"))?;
        clips.push(ImportedClip {
            clip,
            t_pose_first_row,
            t_pose_dropped: dropped,
            measure,
        });
    }
    Ok(clips)
}
