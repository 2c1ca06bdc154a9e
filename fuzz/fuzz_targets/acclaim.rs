//! ASF and AMC: any two texts, separated by a NUL byte, are read or refused in bounded memory, and
//! an AMC that was read is a valid motion.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::ImportOptions;
use segue_formats::acclaim::{
    best_skeleton, bone_names, read_motion, read_skeleton, skeleton_clip,
};

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions::default();
    let (asf, amc) = match bytes.iter().position(|b| *b == 0) {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None => (bytes, bytes),
    };
    let names = bone_names(amc);
    assert!(names.len() <= amc.len());
    let Ok(skeleton) = read_skeleton("fuzz.asf", asf, &options) else {
        return;
    };
    if let Ok(found) = skeleton_clip(&skeleton, &options) {
        assert_eq!(found.clips.len(), 1);
    }
    let best = best_skeleton("fuzz.amc", amc, &[("fuzz.asf", &skeleton)]);
    assert!(best.is_none_or(|index| index == 0));
    if let Ok(found) = read_motion("fuzz.amc", amc, &skeleton, &options) {
        for imported in &found.clips {
            let clip = &imported.clip;
            let (frames, joints) = (clip.frames(), clip.skeleton().len());
            assert!(
                frames * joints * 16 <= (64 << 20) + 16 * bytes.len(),
                "{frames} frames × {joints} joints"
            );
            assert!(
                (0..frames).all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
            );
        }
    }
});
