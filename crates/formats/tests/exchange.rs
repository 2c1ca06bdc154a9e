//! Exported files, read by other programs: `bvh_anim` here, and `three`
//! (`tests/browser/read_back.mjs`), `bvhio` (`tests/oracles/read_back.py`), `NumPy`
//! (`tests/oracles/read_back_npz.py`) and Blender (`tests/oracles/read_back_fbx.py`) from files
//! that these tests leave in the target folder. `cargo xtask test oracles` runs all but Blender.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

mod common;

use bvh_anim::{Axis, Bvh};
use common::shared_data;
use glam::{DMat4, DVec3};
use segue_formats::bvh::{RotationOrder, WriteOptions, write};
use segue_formats::csv::{CsvInputs, CsvOptions, write_csv};
use segue_formats::fbx::{FbxOptions, write_fbx};
use segue_formats::gltf::{
    GlbOptions, write_character_glb, write_clips_glb, write_glb, write_vrma,
};
use segue_formats::numpy::write_npz;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, Motion, UpAxis};
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::Roles;
use segue_motion::skin::{AlphaMode, Character, Sampler, SkinnedMesh, Texture, TexturedPart, Wrap};
use segue_motion::synth::{Action, Params, humanoid, synthesize};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

/// Tolerance for positions: a thousandth of a centimetre, metres.
const TOLERANCE: f64 = 1e-5;

/// Returns clips with the options by which they are written.
fn cases() -> Vec<(String, Clip, WriteOptions)> {
    let made = |action| synthesize(&Params::new(action)).unwrap().clip;
    let own = WriteOptions::default();
    let chosen = WriteOptions {
        rotation_order: Some(RotationOrder::Xyz),
        metres_per_unit: Some(1.0),
        fps: Some(24.0),
        ..own
    };
    let mut cases = vec![
        ("walk".to_owned(), made(Action::Walk), own),
        ("run_chosen".to_owned(), made(Action::Run), chosen),
    ];
    for path in ["cmu/run.bvh", "cmu/pirouette.bvh", "games105/walkF.bvh"] {
        let Some(bytes) = shared_data().and_then(|data| fs::read(data.join(path)).ok()) else {
            continue;
        };
        let clip = import(path, &bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip;
        let name = clip.name().to_owned();
        let millimetres = WriteOptions {
            metres_per_unit: Some(0.001),
            rotation_order: Some(RotationOrder::Yzx),
            ..own
        };
        cases.push((format!("{name}_millimetres"), clip.clone(), millimetres));
        cases.push((name, clip, own));
    }
    cases
}

/// Returns the clip that a file with these options holds.
fn written(clip: &Clip, options: &WriteOptions) -> Clip {
    match options.fps {
        Some(fps) => {
            segue_motion::clip::resample(clip, fps, segue_motion::clip::Interpolation::default())
                .unwrap()
        }
        None => clip.clone(),
    }
}

fn unit(clip: &Clip, options: &WriteOptions) -> f64 {
    options.metres_per_unit.unwrap_or(clip.provenance().metres_per_unit)
}

/// Returns world positions in metres, frame by frame, with the names of the joints, by multiplying
/// matrices from the root on. Positions replace the OFFSET.
fn positions(bvh: &Bvh, metres_per_unit: f64) -> Vec<Vec<(String, DVec3)>> {
    let frame = |frame: &bvh_anim::Frame| {
        let mut world: Vec<DMat4> = Vec::new();
        let mut found = Vec::new();
        for joint in bvh.joints() {
            let data = joint.data();
            let offset = data.offset();
            let mut place =
                DVec3::new(f64::from(offset.x), f64::from(offset.y), f64::from(offset.z));
            let mut turn = DMat4::IDENTITY;
            for channel in data.channels() {
                let value = f64::from(*frame.get(channel).unwrap());
                let kind = channel.channel_type();
                let axis = match kind.axis() {
                    Axis::X => DVec3::X,
                    Axis::Y => DVec3::Y,
                    Axis::Z => DVec3::Z,
                };
                if kind.is_position() {
                    place = place - axis * place.dot(axis) + axis * value;
                } else {
                    turn *= DMat4::from_axis_angle(axis, value.to_radians());
                }
            }
            let parent = data.parent_index().map_or(DMat4::IDENTITY, |parent| world[parent]);
            world.push(parent * DMat4::from_translation(place) * turn);
            let at = world[world.len() - 1].transform_point3(DVec3::ZERO) * metres_per_unit;
            found.push((data.name().to_string(), at));
        }
        found
    };
    bvh.frames().map(frame).collect()
}

#[test]
fn exported_bvh_in_another_reader_is_the_same_motion() {
    for (name, clip, options) in cases() {
        for up in [UpAxis::Y, UpAxis::Z] {
            let text = write(&clip, &WriteOptions { up: Some(up), ..options });
            let bvh = bvh_anim::from_bytes(text.as_bytes())
                .unwrap_or_else(|error| panic!("{name}: {error}"));
            let expected = written(&clip, &options);
            let found = positions(&bvh, unit(&clip, &options));
            assert_eq!(found.len(), expected.frames(), "{name}");
            assert!(
                (bvh.frame_time().as_secs_f64() - expected.fps().recip()).abs() < 1e-8,
                "{name}"
            );
            let mut farthest = 0.0_f64;
            for (frame, joints) in found.iter().enumerate() {
                let world = expected.world_pose(frame);
                assert_eq!(joints.len(), expected.skeleton().len());
                for (joint, at) in joints {
                    let at = match up {
                        UpAxis::Y => *at,
                        UpAxis::Z => DVec3::new(at.x, at.z, -at.y),
                    };
                    let own = expected.skeleton().find(joint).unwrap();
                    farthest = farthest.max(at.distance(world.positions[own].as_dvec3()));
                }
            }
            println!("{name}, {up:?} up: {:.6} cm apart", 100.0 * farthest);
            assert!(farthest < TOLERANCE, "{name}: {farthest} m");
        }
    }
}

/// Returns the options of an FBX file for those of a BVH file: every unit of the cases, and both up
/// axes.
fn fbx_options(options: &WriteOptions) -> FbxOptions {
    let up = Some(if options.fps.is_some() { UpAxis::Z } else { UpAxis::Y });
    FbxOptions { metres_per_unit: options.metres_per_unit, up, fps: options.fps }
}

/// Returns a PNG of two by two pixels.
fn image() -> Arc<[u8]> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[200, 30, 30, 30, 200, 30, 30, 30, 200, 90, 90, 90]).unwrap();
    drop(writer);
    bytes.into()
}

/// Returns a child of two colours, with a texture on some triangles, that walks as an adult does:
/// its motion, and its mesh.
fn character() -> (Clip, SkinnedMesh) {
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let skeleton = humanoid(1.5).unwrap();
    let roles = Roles::detect(&skeleton);
    let mut mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
    let colors = [[0.1, 0.2, 0.8, 1.0], [0.8, 0.3, 0.2, 1.0]];
    mesh.colors = mesh.positions.iter().map(|at| colors[usize::from(at.y > 0.0)]).collect();
    mesh.coordinates = mesh.positions.iter().map(|at| [4.0 * at.x, 1.0 - at.y]).collect();
    let texture = Texture {
        image: image(),
        sampler: Sampler { wraps: [Wrap::Mirror, Wrap::Clamp], is_nearest: true },
        alpha: AlphaMode::Mask(0.25),
    };
    let triangles = 0..mesh.triangles.len() / 3;
    mesh.textured = vec![TexturedPart { triangles, texture }];
    let child = Character { skeleton, roles, mesh: Arc::new(mesh.clone()) };
    let body = TargetBody::at_rest(&child.skeleton, &child.roles);
    let options = RetargetOptions::default();
    let moved = retarget_motion(&Motion::analyze(walk.clone()), &body, &options).unwrap();
    let roles = Roles::detect(walk.skeleton());
    (child.standing_as(moved.clip, &walk, &roles), mesh)
}

/// Writes the files for the readers in other languages: for each case BVH, GLB, NPZ and
/// FBX, and the positions as CSV.
#[test]
fn exported_files_are_left_for_other_readers() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("exchange");
    // From earlier runs with other cases.
    fs::remove_dir_all(&folder).unwrap_or_default();
    fs::create_dir_all(&folder).unwrap();
    let mut list = String::new();
    for (name, clip, options) in cases() {
        let expected = written(&clip, &options);
        let options = WriteOptions { up: Some(UpAxis::Y), ..options };
        let inputs = CsvInputs { clip: &expected, contacts: None, columns: &[] };
        let save = |ending: &str, bytes: &[u8]| {
            fs::write(folder.join(format!("{name}.{ending}")), bytes).unwrap();
        };
        save("bvh", write(&clip, &options).as_bytes());
        save("glb", &write_glb(&clip, &GlbOptions { fps: options.fps, smooth: true }).unwrap());
        save("npz", &write_npz(&expected));
        save("fbx", &write_fbx(&[&clip], &fbx_options(&options)).unwrap());
        save("csv", write_csv(&inputs, &CsvOptions::default()).as_bytes());
        writeln!(list, "{name} {}", unit(&clip, &options)).unwrap();
    }
    let (clip, mesh) = character();
    let inputs = CsvInputs { clip: &clip, contacts: None, columns: &[] };
    let save = |ending: &str, bytes: &[u8]| {
        fs::write(folder.join(format!("character.{ending}")), bytes).unwrap();
    };
    save("bvh", write(&clip, &WriteOptions::default()).as_bytes());
    save("glb", &write_character_glb(&clip, &mesh, &GlbOptions::default()).unwrap());
    save("npz", &write_npz(&clip));
    save("fbx", &write_fbx(&[&clip], &FbxOptions::default()).unwrap());
    save("csv", write_csv(&inputs, &CsvOptions::default()).as_bytes());
    writeln!(list, "character {}", unit(&clip, &WriteOptions::default())).unwrap();
    fs::write(folder.join("cases.txt"), list).unwrap();
    // A VRM animation has bones alone, all of them those of the synthesised body.
    let mut list = String::new();
    for action in [Action::Walk, Action::Run, Action::Spin] {
        let walk = synthesize(&Params::new(action)).unwrap().clip;
        let bytes = write_vrma(&walk, &Roles::detect(walk.skeleton()), None).unwrap();
        fs::write(folder.join(format!("bones {}.vrma", walk.name())), bytes).unwrap();
        let inputs = CsvInputs { clip: &walk, contacts: None, columns: &[] };
        let table = write_csv(&inputs, &CsvOptions::default());
        fs::write(folder.join(format!("bones {}.csv", walk.name())), table).unwrap();
        writeln!(list, "{}", walk.name()).unwrap();
    }
    fs::write(folder.join("bones.txt"), list).unwrap();
    // Two clips in one file, with a root bone on the ground.
    let clips = [Action::Walk, Action::Run]
        .map(|action| synthesize(&Params::new(action)).unwrap().clip.with_ground_root());
    let mut list = String::new();
    for clip in &clips {
        let inputs = CsvInputs { clip, contacts: None, columns: &[] };
        let table = write_csv(&inputs, &CsvOptions::default());
        fs::write(folder.join(format!("together {}.csv", clip.name())), table).unwrap();
        writeln!(list, "{}", clip.name()).unwrap();
    }
    let [walk, run] = &clips;
    let bytes = write_clips_glb(&[walk, run], None, &GlbOptions::default()).unwrap();
    fs::write(folder.join("together.glb"), bytes).unwrap();
    fs::write(folder.join("together.txt"), list).unwrap();
}
