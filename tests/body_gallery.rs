//! Pictures of generated bodies, written to the folder in the variable `SEGUE_GALLERY`.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use glam::{Quat, Vec3};
use segue_formats::{ImportOptions, acclaim, import};
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Joint, Pose, Roles, Skeleton, WorldPose};
use segue_motion::skin::{SkinnedMesh, dual_quaternion, linear_blend};
use segue_motion::synth::{Action, Params, synthesize};
use std::io::Write as _;
use std::path::PathBuf;

/// A grey picture with a depth buffer on white.
struct Canvas {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    pixels: Vec<u8>,
}

/// A view of a mesh: rotated by `yaw` about the vertical through `middle`, which is at the pixel
/// `center`; `scale` in pixels per metre.
struct View {
    yaw: f32,
    middle: Vec3,
    center: [f32; 2],
    scale: f32,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depth: vec![f32::INFINITY; width * height],
            pixels: vec![235; width * height * 3],
        }
    }

    /// Draws a mesh with vertices `positions` and `normals` from a view.
    fn draw(&mut self, positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]], view: &View) {
        let View { yaw, middle, center, scale } = *view;
        let turn = Quat::from_rotation_x(0.12) * Quat::from_rotation_y(yaw);
        let light = Vec3::new(-0.45, 0.7, 0.55).normalize_or_zero();
        for triangle in triangles {
            let corners = triangle.map(|corner| {
                let p = turn * (positions[corner as usize] - middle);
                (
                    Vec3::new(center[0] + p.x * scale, center[1] - p.y * scale, -p.z),
                    turn * normals[corner as usize],
                )
            });
            let [(a, na), (b, nb), (c, nc)] = corners;
            let area = (b - a).truncate().perp_dot((c - a).truncate());
            // Counter-clockwise from outside is clockwise where y points down.
            if area >= 0.0 {
                continue;
            }
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            for y in
                low.y.floor().max(0.0) as usize..(high.y.ceil().max(0.0) as usize).min(self.height)
            {
                for x in low.x.floor().max(0.0) as usize
                    ..(high.x.ceil().max(0.0) as usize).min(self.width)
                {
                    let p = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let u = (b.truncate() - p).perp_dot(c.truncate() - p) / area;
                    let v = (c.truncate() - p).perp_dot(a.truncate() - p) / area;
                    let w = 1.0 - u - v;
                    let z = a.z * u + b.z * v + c.z * w;
                    let at = y * self.width + x;
                    if u < 0.0 || v < 0.0 || w < 0.0 || z >= self.depth[at] {
                        continue;
                    }
                    self.depth[at] = z;
                    let normal = (na * u + nb * v + nc * w).normalize_or(Vec3::Z);
                    let lit = 0.62 * normal.dot(light).max(0.0)
                        + 0.18 * (normal.y * 0.5 + 0.5)
                        + 0.14 * normal.z.max(0.0);
                    let shine = (normal.dot((light + Vec3::Z).normalize_or_zero()).max(0.0))
                        .powi(24)
                        * 0.10;
                    for (channel, clay) in [0.98, 0.95, 0.92].into_iter().enumerate() {
                        self.pixels[at * 3 + channel] =
                            (255.0 * (lit * clay + shine).clamp(0.0, 1.0).powf(0.7)) as u8;
                    }
                }
            }
        }
    }

    fn png(&self) -> Vec<u8> {
        let mut rows = ZlibEncoder::new(Vec::new(), Compression::fast());
        for row in self.pixels.chunks(self.width * 3) {
            rows.write_all(&[0]).unwrap();
            rows.write_all(row).unwrap();
        }
        let size = [self.width as u32, self.height as u32].map(u32::to_be_bytes);
        let header = [&size[0][..], &size[1], &[8, 2, 0, 0, 0]].concat();
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        for (kind, data) in
            [(b"IHDR", header), (b"IDAT", rows.finish().unwrap()), (b"IEND", vec![])]
        {
            let mut crc = Crc::new();
            crc.update(kind);
            crc.update(&data);
            file.extend((data.len() as u32).to_be_bytes());
            file.extend(kind);
            file.extend(&data);
            file.extend(crc.sum().to_be_bytes());
        }
        file
    }
}

fn folder() -> Option<PathBuf> {
    std::env::var_os("SEGUE_GALLERY").map(PathBuf::from)
}

/// Writes a picture of the mesh in each of the poses, from the front, the side and three quarters.
fn picture(name: &str, mesh: &SkinnedMesh, poses: &[WorldPose]) {
    let Some(folder) = folder() else { return };
    let (cell, views) = ([420.0, 560.0], [0.0f32, -0.8, -std::f32::consts::FRAC_PI_2, 2.6]);
    let mut canvas = Canvas::new(cell[0] as usize * views.len(), cell[1] as usize * poses.len());
    for (row, pose) in poses.iter().enumerate() {
        let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
        mesh.joint_transforms(pose, &mut transforms);
        if row % 2 == 0 {
            linear_blend(mesh, &transforms, &mut positions, &mut normals);
        } else {
            dual_quaternion(mesh, &transforms, &mut positions, &mut normals);
        }
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let wide = (high - low).x.max((high - low).z);
        let scale = (cell[0] * 0.96 / wide).min(cell[1] * 0.92 / (high - low).y.max(1e-3));
        for (column, yaw) in views.into_iter().enumerate() {
            let center = [cell[0] * (column as f32 + 0.5), cell[1] * (row as f32 + 0.5)];
            let view = View { yaw, middle: (low + high) * 0.5, center, scale };
            canvas.draw(&positions, &normals, &mesh.triangles, &view);
        }
    }
    std::fs::write(folder.join(format!("{name}.png")), canvas.png()).unwrap();
}

/// Returns the pose in which the mesh was generated.
fn bind_pose(mesh: &SkinnedMesh) -> WorldPose {
    let bind: Vec<_> = mesh.bind.iter().map(|joint_from_bind| joint_from_bind.inverse()).collect();
    WorldPose {
        positions: bind.iter().map(|bind| bind.translation).collect(),
        rotations: bind.iter().map(|bind| bind.rotation).collect(),
    }
}

fn rest_pose(skeleton: &Skeleton) -> WorldPose {
    WorldPose {
        positions: skeleton.rest_positions(),
        rotations: vec![Quat::IDENTITY; skeleton.len()],
    }
}

#[test]
fn gallery_of_the_humanoid_is_drawn() {
    let mut poses = Vec::new();
    let mut skeleton = None;
    for (action, secs) in [(Action::Walk, 1.0), (Action::Run, 1.1)] {
        let made = synthesize(&Params::new(action)).unwrap();
        let frame = (secs * made.clip.fps()) as usize;
        poses.push(made.clip.world_pose(frame));
        skeleton = Some(std::sync::Arc::clone(made.clip.skeleton()));
    }
    let skeleton = skeleton.unwrap();
    let start = std::time::Instant::now();
    let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
    let took = start.elapsed();
    if folder().is_some() {
        eprintln!(
            "humanoid: {} vertices, {} triangles, {took:?}",
            mesh.positions.len(),
            mesh.triangles.len()
        );
    }
    poses.insert(0, bind_pose(&mesh));
    poses.insert(1, rest_pose(&skeleton));
    picture("humanoid", &mesh, &poses);
}

/// Returns a four-legged skeleton standing still, with joint axes rotated by constants, so that its
/// rest pose is meaningless.
fn dog() -> Clip {
    let bones: [(&str, Option<usize>, [f32; 3]); 16] = [
        ("Pelvis", None, [0.0, 0.6, -0.3]),
        ("Spine", Some(0), [0.0, 0.03, 0.25]),
        ("Chest", Some(1), [0.0, 0.0, 0.3]),
        ("Neck", Some(2), [0.0, 0.08, 0.12]),
        ("Head", Some(3), [0.0, 0.15, 0.12]),
        ("Snout", Some(4), [0.0, -0.02, 0.18]),
        ("Tail", Some(0), [0.0, 0.05, -0.2]),
        ("Tip", Some(6), [0.0, 0.1, -0.2]),
        ("HindLeftA", Some(0), [0.1, -0.05, 0.0]),
        ("HindLeftB", Some(8), [0.0, -0.27, 0.05]),
        ("HindLeftC", Some(9), [0.0, -0.25, -0.08]),
        ("HindRightA", Some(0), [-0.1, -0.05, 0.0]),
        ("HindRightB", Some(11), [0.0, -0.27, 0.05]),
        ("ForeLeftA", Some(2), [0.1, -0.1, 0.0]),
        ("ForeLeftB", Some(13), [0.0, -0.45, 0.0]),
        ("ForeRightA", Some(2), [-0.1, -0.1, 0.0]),
    ];
    let turn = |joint: usize| Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.3 * joint as f32);
    let joints = bones.iter().map(|&(name, parent, offset)| Joint {
        name: name.into(),
        parent,
        offset: parent.map_or(Quat::IDENTITY, turn).conjugate() * Vec3::from(offset),
        end_site: None,
        channels: vec![],
    });
    let skeleton = Skeleton::new(joints.collect()).unwrap();
    let pose = |sway: f32| Pose {
        root_translation: Vec3::new(0.0, 0.6, 0.0),
        rotations: (0..skeleton.len())
            .map(|joint| {
                skeleton.parent(joint).map_or(Quat::from_rotation_y(sway), turn).conjugate()
                    * turn(joint)
            })
            .collect(),
        translations: vec![],
    };
    let poses = vec![pose(0.0), pose(0.1), pose(0.0)];
    Clip::from_poses("dog", std::sync::Arc::new(skeleton.clone()), 30.0, poses).unwrap()
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
        ("pirouette", bvh("cmu/pirouette.bvh")),
        ("games105", bvh("games105/run_forward.bvh")),
        ("bandai_walk", bvh("bandai-namco/dataset-2_walk_normal_001.bvh")),
        ("bandai_kick", bvh("bandai-namco/dataset-1_kick_normal_001.bvh")),
        ("dog", dog()),
    ];
    for (name, clip) in takes {
        let skeleton = clip.skeleton();
        let start = std::time::Instant::now();
        let mesh = SkinnedMesh::around_clip(&clip, &Roles::detect(skeleton), 1.0);
        eprintln!(
            "{name}: {} joints, {} vertices, {:?}",
            skeleton.len(),
            mesh.positions.len(),
            start.elapsed()
        );
        let at = |share: f32| clip.world_pose((clip.frames() as f32 * share) as usize);
        picture(name, &mesh, &[bind_pose(&mesh), at(0.3), at(0.6)]);
    }
}
