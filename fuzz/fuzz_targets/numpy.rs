//! NumPy: any bytes are read or refused in bounded memory, as `.npy`, `.npz`, pickle and body
//! model; a motion that was read is valid, and can be written and read again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::numpy::{read, read_model, read_with_models, write_npz};
use segue_formats::{ImportOptions, ImportedFile};

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions { max_bytes: 8 << 20, ..ImportOptions::default() };
    if let Ok(model) = read_model("fuzz.npz", bytes, &options) {
        let again = read_model("fuzz.npz", &model.to_bytes(), &options)
            .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again.joints(), model.joints());
        if let Ok((found, _)) = read_with_models("fuzz.npz", bytes, &[&model], &options) {
            survives(&found, options.max_bytes);
        }
    }
    if let Ok(found) = read("fuzz.npz", bytes, &options) {
        survives(&found, options.max_bytes);
    }
});

fn survives(found: &ImportedFile, most: usize) {
    assert!(!found.clips.is_empty());
    for imported in &found.clips {
        let clip = &imported.clip;
        let numbers = clip.frames() * clip.skeleton().len();
        assert!(numbers <= most, "{numbers} rotations");
        assert!(
            (0..clip.frames()).all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
        );
        assert!(clip.root_translations().iter().all(|place| place.is_finite()));
        if numbers <= 100_000 {
            let options = ImportOptions { fps: Some(clip.fps()), ..ImportOptions::default() };
            let back = read("fuzz.npz", &write_npz(clip), &options)
                .unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((back.clips.len(), back.clips[0].clip.frames()), (1, clip.frames()));
        }
    }
}
