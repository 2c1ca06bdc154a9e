//! Tests of bodies in skins.

use super::{colors, gpu, options, staged};
use crate::render::coarse_mesh::Clusters;
use crate::render::image::read_texture;
use crate::render::{Quality, Refinement, frame::Frame, render_to_image};
use glam::{Quat, Vec3};
use segue_motion::skeleton::Roles;
use segue_motion::skin::{RigidTransform, SkinnedMesh, dual_quaternion, linear_blend};
use segue_motion::synth::{Action, Params, synthesize};
use segue_scene::{Camera, Director, Figure, Lens, Look, Pane, Skin, Skinning, Stage, Viewport};
use segue_session::{Command, Session};
use std::sync::Arc;

/// Returns a rod along x from -0.5 m to 0.5 m at a height of 1 m, with a joint at each end.
fn rod() -> SkinnedMesh {
    const SIDES: u32 = 24;
    const RINGS: u32 = 40;
    let mut mesh =
        SkinnedMesh { bind: vec![RigidTransform::IDENTITY; 2], ..SkinnedMesh::default() };
    for ring in 0..=RINGS {
        let along = ring as f32 / RINGS as f32;
        for side in 0..SIDES {
            let (sin, cos) = (std::f32::consts::TAU * side as f32 / SIDES as f32).sin_cos();
            mesh.normals.push(Vec3::new(0.0, cos, sin));
            mesh.positions.push(Vec3::new(along - 0.5, 1.0 + 0.15 * cos, 0.15 * sin));
            let second = u16::from(along > 0.5);
            mesh.joints.push([second, 1 - second, 0, 0]);
            mesh.weights.push([along.max(1.0 - along), along.min(1.0 - along), 0.0, 0.0]);
        }
    }
    for ring in 0..RINGS {
        for side in 0..SIDES {
            let at = |ring: u32, side: u32| ring * SIDES + side % SIDES;
            mesh.triangles.push([at(ring, side), at(ring, side + 1), at(ring + 1, side + 1)]);
            mesh.triangles.push([at(ring, side), at(ring + 1, side + 1), at(ring + 1, side)]);
        }
    }
    mesh
}

fn coarse_triangles(mesh: &SkinnedMesh) -> Vec<[u32; 3]> {
    Clusters::of(mesh).coarse(&mesh.triangles)
}

pub(super) fn stage_of(
    mesh: &Arc<SkinnedMesh>,
    joints: &[RigidTransform],
    skinning: Skinning,
) -> Stage {
    let viewport = Viewport { width: SIZE, height: SIZE, ..Viewport::default() };
    let camera = Camera {
        target: Vec3::Y,
        yaw: 0.4,
        pitch: 0.3,
        distance: 2.2,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    let skin = Skin {
        mesh: Arc::clone(mesh),
        joints: 0..joints.len(),
        color: [0.8, 0.8, 0.8, 1.0],
        colored: false,
    };
    Stage {
        panes: vec![Pane {
            viewport,
            camera,
            figures: vec![Figure { limbs: 0..0, skin: Some(skin), ghost: false, shadow: 0.0 }],
            joints: joints.to_vec(),
            joint_colors: vec![[1.0, 0.0, 0.0, 1.0]; joints.len()],
            skinning,
            ..Pane::default()
        }],
        ..Stage::default()
    }
}

pub(super) const SIZE: u32 = 240;

#[test]
fn gpu_skinning_agrees_with_the_cpu() {
    let Some(mut gpu) = gpu() else { return };
    let mesh = Arc::new(rod());
    let twist = RigidTransform {
        rotation: Quat::from_rotation_z(0.6) * Quat::from_rotation_x(2.8),
        translation: Vec3::new(0.3, 0.1, -0.2),
    };
    // The same rotation as the negated quaternion.
    let first = RigidTransform {
        rotation: -Quat::from_rotation_y(0.3),
        translation: Vec3::new(-0.1, 0.0, 0.05),
    };
    let mut pictures = Vec::new();
    for (name, skinning) in [("dual", Skinning::Dual), ("linear", Skinning::Linear)] {
        let image = gpu.draw(
            &format!("rod-{name}"),
            &stage_of(&mesh, &[first, twist], skinning),
            [SIZE, SIZE],
        );
        let mut still = rod();
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        if skinning == Skinning::Dual {
            dual_quaternion(&mesh, &[first, twist], &mut positions, &mut normals);
        } else {
            linear_blend(&mesh, &[first, twist], &mut positions, &mut normals);
        }
        (still.positions, still.normals) = (positions, normals);
        let stage = stage_of(&Arc::new(still), &[RigidTransform::IDENTITY; 2], skinning);
        let expected =
            render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [SIZE, SIZE])
                .unwrap();
        let differ = |a: &[u8], b: &[u8]| a.iter().zip(b).any(|(&a, &b)| a.abs_diff(b) > 6);
        let pixels = || image.rgba.chunks_exact(4).zip(expected.rgba.chunks_exact(4));
        let wrong = pixels().filter(|(a, b)| differ(a, b)).count();
        assert!(wrong < 40, "{name}: {wrong} pixels differ");
        pictures.push(image);
    }
    let differ = pictures[0]
        .rgba
        .iter()
        .zip(&pictures[1].rgba)
        .filter(|(a, b)| a.abs_diff(**b) > 30)
        .count();
    assert!(differ > 1_000, "a candy wrapper is to be seen");
}

#[test]
fn skins_with_invalid_joints_and_lists_are_drawn() {
    let Some(mut gpu) = gpu() else { return };
    let mut odd = rod();
    odd.joints[3] = [900, 2, 65_535, 7];
    odd.positions[5] = Vec3::NAN;
    odd.triangles.push([0, 1, u32::MAX]);
    odd.normals.truncate(10);
    let odd = Arc::new(odd);
    let nowhere = RigidTransform {
        rotation: Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
        translation: Vec3::INFINITY,
    };
    let mut stage = stage_of(&odd, &[RigidTransform::IDENTITY, nowhere], Skinning::Dual);
    render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [SIZE, SIZE]).unwrap();
    stage.panes[0].joints.clear();
    render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [SIZE, SIZE]).unwrap();
    stage.panes[0].figures[0].ghost = true;
    let again = stage.panes[0].figures[0].clone();
    stage.panes[0].figures.push(again);
    render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [SIZE, SIZE]).unwrap();
}

fn session(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    session
}

#[test]
fn twisted_forearm_is_drawn_with_both_kinds_of_skinning() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1200, 700];
    let session = session(
        "lab=view&a=idle&t=0.4&compare=skinning:dual,linear&twist=170&camera_distance=1.3&follow_joint=left%20hand&trail=off",
    );
    let panes = session.panes().len();
    assert_eq!(panes, 2);
    let shown: Vec<(usize, Viewport)> =
        Viewport::columns(size[0], size[1], 2, 1).enumerate().collect();
    let stage =
        staged(&mut Director::default(), &session, &options(&shown, Look::DARK, &colors(0)), 0.0);
    assert_eq!(
        stage.panes.iter().map(|pane| pane.skinning).collect::<Vec<_>>(),
        [Skinning::Dual, Skinning::Linear]
    );
    gpu.draw("twist", &stage, size);
}

#[test]
fn figures_of_other_heights_are_drawn() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1400, 560];
    let viewports: Vec<Viewport> = Viewport::columns(size[0], size[1], 4, 1).collect();
    let mut all = Stage::default();
    for (viewport, stature) in viewports.into_iter().zip([
        "figure_height=1",
        "figure_height=0.6",
        "figure_build=0.7",
        "figure_build=1.5",
    ]) {
        let session = session(&format!("lab=view&a=walk&t=1.2&{stature}"));
        let stage = staged(
            &mut Director::default(),
            &session,
            &options(&[(0, viewport)], Look::LIGHT, &colors(1)),
            0.0,
        );
        // The world around a figure of 60 % height appears smaller by as much: the camera is
        // farther away, and the cells of the grid are wider.
        let height = if stature == "figure_height=0.6" { 0.6 } else { 1.0 };
        assert!(
            (stage.panes[0].camera.distance * height - 4.8).abs() < 1e-4
                && (stage.grid_metres * height - 1.0).abs() < 1e-6
        );
        all.panes.push(stage.panes[0].clone());
        (all.look, all.grid_metres) = (stage.look, 1.0);
    }
    gpu.draw("statures", &all, size);
}

#[test]
fn hundred_characters_are_drawn_at_once() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1440, 900];
    let mut session = session("lab=match&crowd=100&camera_distance=16&camera_pitch=22");
    for _ in 0..120 {
        session.tick(1.0 / 60.0);
    }
    let shown = [(0, Viewport { width: size[0], height: size[1], ..Viewport::default() })];
    let mut director = Director::default();
    let stage = staged(&mut director, &session, &options(&shown, Look::DARK, &colors(0)), 0.0);
    let mut frame = Frame::default();
    frame.build(&stage, size, size, Quality::Full);
    // All of them are one draw.
    assert_eq!(
        (stage.panes[0].figures.len(), frame.solid_skins.len(), frame.meshes.len()),
        (100, 1, 1)
    );
    gpu.draw("crowd", &stage, size);
}

/// Returns the volume inside triangles of a mesh, cubic metres.
fn volume(mesh: &SkinnedMesh, triangles: &[[u32; 3]]) -> f32 {
    let corner = |index: u32| mesh.positions[index as usize];
    triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
}

/// Returns the body of a walker.
fn walker() -> SkinnedMesh {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    SkinnedMesh::around_clip(&clip, &Roles::detect(clip.skeleton()), 1.0)
}

#[test]
fn body_in_motion_has_fewer_triangles_in_software_and_the_same_outline() {
    let Some(mut gpu) = gpu() else { return };
    gpu.renderer.set_quality(Quality::Plain);
    let mesh = Arc::new(walker());
    let joints = vec![RigidTransform::IDENTITY; mesh.bind.len()];
    let stage = stage_of(&mesh, &joints, Skinning::Linear);
    let size = [SIZE, SIZE];
    let [coarse, fine] = [Refinement::AtRest, Refinement::Now].map(|refinement| {
        let mut encoder =
            gpu.device.create_command_encoder(&eframe::wgpu::CommandEncoderDescriptor::default());
        gpu.renderer.begin_frame(0.0, refinement);
        gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 6, &stage, size);
        let shown = &gpu.renderer.view(6).unwrap().current().color;
        read_texture(&gpu.device, &gpu.queue, encoder, shown).unwrap().rgba
    });
    // A stage of this size has as many pixels in motion.
    assert_ne!(coarse, fine);
    let [few, many] = [coarse, fine].map(|rgba| rgba.chunks(4).filter(|p| p[0] > 0x50).count());
    assert!(many > 2000 && few.abs_diff(many) < many / 20, "{few} pixels, not {many}");
}

#[test]
fn coarse_triangles_are_few_and_keep_the_shape() {
    let mesh = walker();
    let coarse = Clusters::of(&mesh).coarse(&mesh.triangles);
    let (many, few) = (mesh.triangles.len(), coarse.len());
    assert!(few < many / 2 && few > many / 6, "{few} of {many}");
    let (fine, coarse) = (volume(&mesh, &mesh.triangles), volume(&mesh, &coarse));
    assert!((coarse / fine - 1.0).abs() < 0.05, "{coarse} m³ of {fine} m³");
}

#[test]
fn coarse_triangles_keep_thin_and_close_parts_apart() {
    let corners = |at: Vec3| [at, at + Vec3::X, at + Vec3::Y];
    // Two sheets at a hundredth of a cell: the sides of a leaf, or parts of two limbs.
    let sheets = |normals: [Vec3; 2], joints: [u16; 2]| SkinnedMesh {
        positions: [corners(Vec3::ZERO), corners(Vec3::Z * 2e-4)].concat(),
        normals: [[normals[0]; 3], [normals[1]; 3]].concat(),
        joints: [[[joints[0], 0, 0, 0]; 3], [[joints[1], 0, 0, 0]; 3]].concat(),
        triangles: vec![[0, 1, 2], [3, 4, 5]],
        ..SkinnedMesh::default()
    };
    let leaf = sheets([Vec3::Z, -Vec3::Z], [0, 0]);
    assert_eq!(coarse_triangles(&leaf), leaf.triangles);
    let limbs = sheets([Vec3::Z, Vec3::Z], [0, 1]);
    assert_eq!(coarse_triangles(&limbs), limbs.triangles);
    let same = sheets([Vec3::Z, Vec3::Z], [0, 0]);
    assert_eq!(coarse_triangles(&same), [[0, 1, 2], [0, 1, 2]]);
}

#[test]
fn coarse_triangles_of_a_broken_mesh_leave_out_what_is_broken() {
    assert_eq!(coarse_triangles(&SkinnedMesh::default()), [[0; 3]; 0]);
    let mesh = SkinnedMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN, Vec3::INFINITY],
        triangles: vec![[0, 1, 2], [0, 1, 9], [0, 1, 3], [1, 2, 4]],
        ..SkinnedMesh::default()
    };
    // The corners that are not finite are at the origin, like the first.
    assert_eq!(Clusters::of(&mesh).coarse(&mesh.triangles), [[0, 1, 2], [1, 2, 0]]);
}
