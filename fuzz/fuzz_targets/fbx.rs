//! FBX: any bytes are read or refused in bounded memory; a file that was read is a valid motion
//! with a consistent mesh.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::fbx::read;
use segue_formats::{ImportOptions, ImportedClip};

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions { max_bytes: 16 << 20, ..ImportOptions::default() };
    if let Ok(found) = read("fuzz.fbx", bytes, &options) {
        assert!(!found.clips.is_empty());
        let numbers = |found: &ImportedClip| found.clip.frames() * found.clip.skeleton().len();
        let numbers: usize = found.clips.iter().map(numbers).sum();
        assert!(numbers * 16 <= options.max_bytes, "{numbers} rotations");
        found.clips.iter().for_each(is_whole);
    }
});

fn is_whole(found: &ImportedClip) {
    let clip = &found.clip;
    assert!(
        (0..clip.frames()).all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
    );
    assert!(clip.root_translations().iter().all(|place| place.is_finite()));
    let Some(mesh) = &found.mesh else { return };
    let vertices = mesh.positions.len();
    assert_eq!([mesh.normals.len(), mesh.joints.len(), mesh.weights.len()], [vertices; 3]);
    assert!(mesh.colors.is_empty() || mesh.colors.len() == vertices);
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    let joints = mesh.bind.len();
    assert_eq!(joints, clip.skeleton().len());
    assert!(mesh.joints.iter().flatten().all(|&joint| usize::from(joint) < joints));
}
