//! BVH: any bytes are read or refused in bounded memory, the fast reader of a row agrees with the
//! slow one, and a file that was read can be written and read again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::bvh::{WriteOptions, read, write};
use segue_formats::{ImportOptions, ImportedFile};

fuzz_target!(|bytes: &[u8]| {
    let found = read("fuzz.bvh", bytes, &ImportOptions::default());
    if let Some(slow) = slowed(bytes) {
        let slow = read("fuzz.bvh", &slow, &ImportOptions::default());
        match (&found, &slow) {
            (Ok(found), Ok(slow)) => assert_eq!(format!("{found:?}"), format!("{slow:?}")),
            (Err(found), Err(slow)) => {
                assert_eq!((found.line, &found.expected), (slow.line, &slow.expected))
            }
            _ => panic!("fast and slow disagree: {found:?} {slow:?}"),
        }
    }
    if let Ok(found) = found {
        survives(&found, bytes.len());
    }
});

/// Returns the same file with a vertical tab before each line end: white space as well, but no row
/// takes the fast path.
fn slowed(bytes: &[u8]) -> Option<Vec<u8>> {
    // UTF-16 has two bytes for each.
    let is_utf16 = bytes.iter().take(4).any(|b| matches!(b, 0 | 0xfe | 0xff));
    (!is_utf16).then(|| {
        let mut slow = Vec::with_capacity(2 * bytes.len());
        for (index, &b) in bytes.iter().enumerate() {
            // Between CR and LF it would make two line ends of one.
            let is_end =
                b == b'\r' || (b == b'\n' && bytes.get(index.wrapping_sub(1)) != Some(&b'\r'));
            slow.extend(is_end.then_some(0x0b));
            slow.push(b);
        }
        slow
    })
}

fn survives(found: &ImportedFile, bytes: usize) {
    for imported in &found.clips {
        let clip = &imported.clip;
        let (frames, joints) = (clip.frames(), clip.skeleton().len());
        assert!(
            frames * joints * 16 <= (64 << 20) + 16 * bytes,
            "{frames} frames × {joints} joints of {bytes} bytes"
        );
        let lengths = clip
            .root_translations()
            .iter()
            .chain(clip.translations().iter().flat_map(|track| &track.values));
        let offsets =
            clip.skeleton().joints().iter().flat_map(|joint| [Some(joint.offset), joint.end_site]);
        let sane = |v: glam::Vec3| v.abs().max_element() < 1e20;
        if frames * joints > 100_000 || !lengths.copied().chain(offsets.flatten()).all(sane) {
            continue;
        }
        let provenance = clip.provenance();
        let options = ImportOptions {
            metres_per_unit: Some(provenance.metres_per_unit),
            up: Some(provenance.up),
            drop_t_pose: false,
            ..ImportOptions::default()
        };
        let text = write(clip, &WriteOptions::default());
        let back = read("fuzz.bvh", text.as_bytes(), &options)
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(back.clips.len(), 1);
        assert_eq!(
            (back.clips[0].clip.frames(), back.clips[0].clip.skeleton().len()),
            (frames, joints)
        );
    }
}
