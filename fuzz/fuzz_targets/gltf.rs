//! glTF: any bytes are read or refused in bounded memory; a file that was read is a valid motion
//! with a consistent mesh, and can be written and read again. In a text, the bytes after the first
//! NUL are the file beside it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_formats::gltf::{GlbOptions, read, write_character_glb, write_glb};
use segue_formats::{ImportOptions, ImportedFile};
use segue_motion::clip::Clip;
use segue_motion::skin::SkinnedMesh;
use segue_fuzz::assert_textured;
use std::sync::Arc;

fuzz_target!(|bytes: &[u8]| {
    let options = ImportOptions { max_bytes: 16 << 20, ..ImportOptions::default() };
    let (file, beside) = match bytes.iter().position(|b| *b == 0) {
        Some(end) if !bytes.starts_with(b"glTF") => (&bytes[..end], &bytes[end + 1..]),
        _ => (bytes, &[][..]),
    };
    let beside: Arc<[u8]> = beside.into();
    if let Ok(found) = read("fuzz.gltf", file, &|_| Some(Arc::clone(&beside)), &options) {
        survives(&found, options.max_bytes);
    }
});

fn survives(found: &ImportedFile, most: usize) {
    assert!(!found.clips.is_empty());
    let numbers: usize = found
        .clips
        .iter()
        .map(|imported| imported.clip.frames() * imported.clip.skeleton().len())
        .sum();
    assert!(numbers * 16 <= most, "{numbers} rotations");
    for imported in &found.clips {
        let clip = &imported.clip;
        assert!(
            (0..clip.frames()).all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
        );
        assert!(clip.root_translations().iter().all(|place| place.is_finite()));
        if let Some(mesh) = &imported.mesh {
            is_whole(mesh, clip);
        }
        if numbers <= 100_000 {
            comes_back(clip, imported.mesh.as_deref());
        }
    }
}

fn is_whole(mesh: &SkinnedMesh, clip: &Clip) {
    let vertices = mesh.positions.len();
    assert_eq!([mesh.normals.len(), mesh.joints.len(), mesh.weights.len()], [vertices; 3]);
    assert!(mesh.colors.is_empty() || mesh.colors.len() == vertices);
    assert_textured(mesh);
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    let joints = mesh.bind.len();
    assert_eq!(joints, clip.skeleton().len());
    assert!(mesh.joints.iter().flatten().all(|&joint| usize::from(joint) < joints));
    let is_one = |weights: &[f32; 4]| {
        weights.iter().all(|w| *w >= 0.0) && (weights.iter().sum::<f32>() - 1.0).abs() < 1e-3
    };
    assert!(mesh.weights.iter().all(is_one));
}

/// Checks that a clip is refused by the writer, or read again as one clip of as many frames.
fn comes_back(clip: &Clip, mesh: Option<&SkinnedMesh>) {
    let options = GlbOptions::default();
    let written = match mesh {
        Some(mesh) => write_character_glb(clip, mesh, &options),
        None => write_glb(clip, &options),
    };
    let Ok(written) = written else { return };
    let reading = ImportOptions {
        metres_per_unit: Some(1.0),
        fps: Some(clip.fps()),
        drop_t_pose: false,
        ..ImportOptions::default()
    };
    let back =
        read("fuzz.glb", &written, &|_| None, &reading).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((back.clips.len(), back.clips[0].clip.frames()), (1, clip.frames().max(1)));
}
