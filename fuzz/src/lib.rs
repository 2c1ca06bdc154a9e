//! The invariants of every motion file that was read, whatever its bytes.

use segue_formats::ImportedClip;
use segue_motion::skin::SkinnedMesh;

/// Panics unless there are clips, of at most `most` bytes of rotations in all, with numbers of a
/// motion, and with consistent meshes.
pub fn assert_valid(clips: &[ImportedClip], most: usize) {
    assert!(!clips.is_empty());
    let numbers = |found: &ImportedClip| found.clip.frames() * found.clip.skeleton().len();
    let numbers: usize = clips.iter().map(numbers).sum();
    assert!(numbers * 16 <= most, "{numbers} rotations");
    for found in clips {
        let clip = &found.clip;
        assert!(
            (0..clip.frames()).all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
        );
        assert!(clip.root_translations().iter().all(|place| place.is_finite()));
        if let Some(mesh) = &found.mesh {
            assert_consistent(mesh, clip.skeleton().len());
        }
    }
}

/// Panics unless the textures of a mesh lie on its triangles.
pub fn assert_textured(mesh: &SkinnedMesh) {
    let places = &mesh.coordinates;
    assert!(places.is_empty() || places.len() == mesh.positions.len());
    assert!(places.iter().flatten().all(|value| value.is_finite()));
    assert!(mesh.textured.is_empty() || !places.is_empty());
    let mut end = 0;
    for part in &mesh.textured {
        assert!(part.triangles.start >= end && !part.triangles.is_empty());
        end = part.triangles.end;
    }
    assert!(end <= mesh.triangles.len());
}

fn assert_consistent(mesh: &SkinnedMesh, joints: usize) {
    let vertices = mesh.positions.len();
    assert_eq!([mesh.normals.len(), mesh.joints.len(), mesh.weights.len()], [vertices; 3]);
    assert!(mesh.colors.is_empty() || mesh.colors.len() == vertices);
    assert_textured(mesh);
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
    assert!(mesh.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices));
    assert_eq!(mesh.bind.len(), joints);
    assert!(mesh.joints.iter().flatten().all(|&joint| usize::from(joint) < joints));
}

/// The most bytes of rotations that a reader may make of a file whose size alone bounds them.
#[must_use]
pub const fn most_bytes(file: &[u8]) -> usize {
    (64 << 20) + 16 * file.len()
}
