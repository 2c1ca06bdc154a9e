//! Files of the tests, and what storage and the notices have of them.

use crate::fixtures::*;
use crate::saved::Saved;

/// Returns the bytes of a session's files by their SHA-256, as storage has them.
pub(super) fn stored(session: &Session) -> impl Fn(&str) -> Option<Content> + Copy + '_ {
    |sha256| {
        session.library().entries().iter().find_map(|entry| match &entry.origin {
            Origin::File(file) if file.sha256 == sha256 => Some(file.content.clone()),
            _ => None,
        })
    }
}

/// Returns stored work as earlier versions have stored it: without the facts of clips.
pub(super) fn older(saved: &Saved) -> Saved {
    let mut json = serde_json::to_value(saved).unwrap();
    for entry in json["entries"].as_array_mut().unwrap() {
        entry.as_object_mut().unwrap().remove("known");
    }
    serde_json::from_value(json).unwrap()
}

/// Returns the number of notices of a level.
pub(super) fn count_notices(session: &Session, level: Level) -> usize {
    session.notices().list().iter().filter(|notice| notice.level == level).count()
}

pub(super) const BVH: &str = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n2";

/// Returns a zip archive of uncompressed files (PKWARE's application note, 4.3).
pub(super) fn zip(files: &[(&str, &str)]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, text) in files {
        let mut crc = flate2::Crc::new();
        crc.update(text.as_bytes());
        let mut about = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        about.extend(crc.sum().to_le_bytes());
        about.extend((text.len() as u32).to_le_bytes());
        about.extend((text.len() as u32).to_le_bytes());
        about.extend((name.len() as u16).to_le_bytes());
        about.extend([0, 0]);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(&about);
        directory.extend([0; 10]);
        directory.extend((out.len() as u32).to_le_bytes());
        directory.extend(name.as_bytes());
        out.extend(b"PK\x03\x04");
        out.extend(&about);
        out.extend(name.as_bytes());
        out.extend(text.as_bytes());
    }
    let at = out.len() as u32;
    out.extend(&directory);
    out.extend(b"PK\x05\x06\0\0\0\0");
    out.extend((files.len() as u16).to_le_bytes());
    out.extend((files.len() as u16).to_le_bytes());
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(at.to_le_bytes());
    out.extend([0, 0]);
    out
}

/// Returns a person in a file of another program: a mesh with a skin, and `frames` frames of a
/// walk.
pub(super) fn person(frames: usize) -> Arc<[u8]> {
    let walk = segue_motion::synth::synthesize(&segue_motion::synth::Params::new(
        segue_motion::synth::Action::Walk,
    ))
    .unwrap()
    .clip;
    figure(&walk.crop(0..frames).unwrap())
}

/// Returns a clip in a file of another program, with a mesh around its bones.
pub(super) fn figure(clip: &segue_motion::clip::Clip) -> Arc<[u8]> {
    use segue_formats::gltf::{GlbOptions, write_glb};
    let mut bytes = write_glb(clip, &GlbOptions { smooth: true, ..GlbOptions::default() }).unwrap();
    let at = bytes.windows(6).position(|w| w == b"Segue ").unwrap();
    bytes[at..at + 5].copy_from_slice(b"Other");
    bytes.into()
}
