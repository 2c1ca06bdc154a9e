//! Tables of a robot: any text is read or refused in bounded memory, and what was read is a valid
//! motion.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::ImportOptions;
use segue_formats::robot_csv::read;

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions::default();
    if let Ok(found) = read("fuzz.csv", bytes, &options) {
        assert!(!found.clips.is_empty());
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
            assert!(clip.root_translations().iter().all(|place| place.is_finite()));
        }
    }
});
