//! Pictures of generated bodies, written to the folder in the variable `SEGUE_GALLERY`.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

#[path = "body_gallery/canvas.rs"]
mod canvas;
#[path = "body_gallery/poses.rs"]
mod poses;
#[path = "body_gallery/rigs.rs"]
mod rigs;

use canvas::{Canvas, View};
use glam::Vec3;
use poses::{bind_pose, curled, strained};
use segue_formats::{ImportOptions, acclaim, import};
use segue_motion::skeleton::{Roles, WorldPose};
use segue_motion::skin::{SkinnedMesh, dual_quaternion};
use segue_motion::synth::{Action, Params, synthesize};
use std::path::PathBuf;
use std::time::Instant;

/// Pixels of one view of a pose.
const CELL: [f32; 2] = [330.0, 440.0];

fn folder() -> Option<PathBuf> {
    std::env::var_os("SEGUE_GALLERY").map(PathBuf::from)
}

/// Writes a picture with a column for each pose: from the front, at three quarters, from the side
/// and from behind. All poses have the same scale.
fn picture(name: &str, mesh: &SkinnedMesh, poses: &[WorldPose]) {
    let Some(folder) = folder() else { return };
    let views = [0.0f32, -0.8, -std::f32::consts::FRAC_PI_2, 2.6];
    let mut canvas = Canvas::new(CELL[0] as usize * poses.len(), CELL[1] as usize * views.len());
    let posed: Vec<(Vec<Vec3>, Vec<Vec3>)> = (poses.iter())
        .map(|pose| {
            let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
            mesh.joint_transforms(pose, &mut transforms);
            dual_quaternion(mesh, &transforms, &mut positions, &mut normals);
            (positions, normals)
        })
        .collect();
    let bounds = |positions: &[Vec3]| {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        (low, high)
    };
    let fitting = |(positions, _): &(Vec<Vec3>, Vec<Vec3>)| {
        let (low, high) = bounds(positions);
        let wide = (high - low).x.max((high - low).z).max(1e-3);
        (CELL[0] * 0.96 / wide).min(CELL[1] * 0.92 / (high - low).y.max(1e-3))
    };
    let scale = posed.iter().map(fitting).fold(f32::INFINITY, f32::min);
    for (column, (positions, normals)) in posed.iter().enumerate() {
        let (low, high) = bounds(positions);
        for (row, yaw) in views.into_iter().enumerate() {
            let center = [CELL[0] * (column as f32 + 0.5), CELL[1] * (row as f32 + 0.5)];
            let view = View { yaw, middle: (low + high) * 0.5, center, scale };
            canvas.draw(positions, normals, &mesh.triangles, &view);
        }
    }
    std::fs::write(folder.join(format!("{name}.png")), canvas.png()).unwrap();
}

/// Says how long the construction of a body took, where pictures are wanted.
fn report(name: &str, mesh: &SkinnedMesh, start: Instant) {
    if folder().is_some() {
        let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
        eprintln!("{name}: {vertices} vertices, {triangles} triangles, {:?}", start.elapsed());
    }
}

#[test]
fn gallery_of_the_humanoid_is_drawn() {
    let clips = [(Action::Walk, 1.0), (Action::Run, 1.1)]
        .map(|(action, secs)| (synthesize(&Params::new(action)).unwrap().clip, secs));
    let skeleton = clips[0].0.skeleton();
    let roles = Roles::detect(skeleton);
    let start = Instant::now();
    let mesh = SkinnedMesh::around(skeleton, &roles, 1.0);
    report("humanoid", &mesh, start);
    let moving =
        clips.iter().map(|(clip, secs)| clip.world_pose((secs * clip.fps()) as usize)).collect();
    picture("humanoid", &mesh, &[strained(&mesh, skeleton, &roles), moving].concat());
}

#[test]
fn gallery_of_rigs_is_drawn() {
    for (name, skeleton) in rigs::persons() {
        let roles = Roles::detect(&skeleton);
        let start = Instant::now();
        let mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
        report(&name, &mesh, start);
        picture(&format!("rig_{name}"), &mesh, &strained(&mesh, &skeleton, &roles));
    }
    for (name, skeleton) in rigs::creatures() {
        let roles = Roles::detect(&skeleton);
        let start = Instant::now();
        let mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
        report(name, &mesh, start);
        picture(&format!("creature_{name}"), &mesh, &curled(&mesh, &skeleton, 0.35));
    }
}

#[test]
fn gallery_of_captured_skeletons_is_drawn() {
    let Some(data) =
        std::env::var_os("SEGUE_SHARED").map(PathBuf::from).filter(|_| folder().is_some())
    else {
        return;
    };
    let options = ImportOptions::default();
    let read = |name: &str| std::fs::read(data.join(name)).unwrap();
    let bvh = |name: &str| import(name, &read(name), &options).unwrap().clips.remove(0).clip;
    let skeleton = acclaim::read_skeleton("16.asf", &read("cmu/16/16.asf"), &options).unwrap();
    let amc = |name: &str| {
        acclaim::read_motion(name, &read(name), &skeleton, &options).unwrap().clips.remove(0).clip
    };
    let takes = [
        ("cmu_asf", amc("cmu/16/16_35.amc")),
        ("cmu_bvh", bvh("cmu/01_01.bvh")),
        ("cmu_run", bvh("cmu/run.bvh")),
        ("pirouette", bvh("cmu/pirouette.bvh")),
        ("games105", bvh("games105/run_forward.bvh")),
        ("bandai_walk", bvh("bandai-namco/dataset-2_walk_normal_001.bvh")),
        ("bandai_kick", bvh("bandai-namco/dataset-1_kick_normal_001.bvh")),
        ("dog", rigs::dog()),
    ];
    for (name, clip) in takes {
        let skeleton = clip.skeleton();
        let roles = Roles::detect(skeleton);
        let start = Instant::now();
        let mesh = SkinnedMesh::around_clip(&clip, &roles, 1.0);
        report(name, &mesh, start);
        let at = |share: f32| clip.world_pose((clip.frames() as f32 * share) as usize);
        let moving = vec![at(0.3), at(0.6)];
        let still =
            if name == "dog" { vec![bind_pose(&mesh)] } else { strained(&mesh, skeleton, &roles) };
        picture(name, &mesh, &[still, moving].concat());
    }
}
