//! Reading of BVH files.

use super::convert::Converter;
use super::header::{DEFAULT_FPS, header};
use super::hierarchy::hierarchy;
use super::lexer::{Lexer, Stop};
use super::motion::{Progress, rows};
use crate::assemble::assemble;
use crate::error::ImportError;
use crate::text::decode;
use crate::warning::WarningKind;
use crate::{ImportOptions, ImportedFile, check_size};

/// Reads a BVH file: one clip for each ROOT, in metres and Y up.
///
/// `name` is the file's name; it is used in errors and, without its ending, as the name of the
/// clip.
///
/// # Errors
/// [`ImportError`] with the place that cannot be read.
pub fn read(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    // `None` is returned only when cancelled, which never happens here.
    Ok(read_with_progress(name, bytes, options, &mut |_| true)?.unwrap_or_default())
}

/// Reads a BVH file as [`read`] does, reports the bytes read so far about every 256 KB, and stops
/// with `None` when `progress` returns `false`.
///
/// # Errors
/// The same as for [`read`].
pub fn read_with_progress(
    name: &str,
    bytes: &[u8],
    options: &ImportOptions,
    progress: &mut dyn FnMut(usize) -> bool,
) -> Result<Option<ImportedFile>, ImportError> {
    check_size(name, bytes, options)?;
    let text = decode(bytes);
    let result = match parse(name, &text, options, false, progress) {
        // The first number with a comma. If all numbers have one, the file is read that way;
        // otherwise the first error is returned.
        Err(Stop::OtherDecimalSign(complaint)) => match parse(name, &text, options, true, progress)
        {
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

fn parse(
    name: &str,
    text: &[u8],
    options: &ImportOptions,
    commas: bool,
    progress: Progress<'_>,
) -> Result<ImportedFile, Stop> {
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
            lexer
                .tally
                .add(WarningKind::FrameCount { declared: declared.clone(), found }, Some(*at));
        }
        _ => {}
    }
    if found == 0 {
        lexer.tally.add(WarningKind::NoFrames, None);
    }
    assemble(name, converter.finish(), fps, options, None, &mut lexer.tally, first_row_at)
        .map(|clips| ImportedFile {
            clips,
            warnings: std::mem::take(&mut lexer.tally).into_warnings(text),
        })
        .map_err(Stop::Fault)
}
