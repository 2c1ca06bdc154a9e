//! Files that are converted as soon as they are read, so that their motions need no memory.

use super::ReadFile;
use crate::convert::{ConvertOptions, convert_motion};
use segue_text::{Message, msg};

/// Replaces the clips of a file that was read by converted ones: a file for each clip.
pub(super) fn convert_file(mut file: ReadFile, options: &ConvertOptions) -> Vec<ReadFile> {
    file.unpacked = None;
    let Ok(read) = &mut file.result else {
        return vec![file];
    };
    let clips = std::mem::take(&mut read.clips);
    if clips.is_empty() {
        file.converted = Some(Err(without_motion(read.awaits_skeleton)));
        return vec![file];
    }
    let mut files = Vec::new();
    for own in clips {
        let mut converted = convert_motion(&own.motion, own.mesh.as_ref(), options);
        let mut made = file.clone();
        if let Ok(converted) = &mut converted {
            made.unpacked = Some(std::mem::take(&mut converted.file.deflated));
        }
        made.converted = Some(converted);
        files.push(made);
        // Each warning is told once.
        if let Ok(read) = &mut file.result {
            read.warnings.clear();
        }
    }
    files
}

/// Returns the reason why a file that was read has no clips.
pub(crate) fn without_motion(awaits_skeleton: bool) -> Message {
    if awaits_skeleton {
        msg!("it needs its skeleton, an ASF file: convert both together")
    } else {
        "it has no motion".into()
    }
}
