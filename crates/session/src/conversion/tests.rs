//! Tests of conversions of many files.

use super::*;
use crate::convert::TargetRig;
use crate::export::{ExportFormat, ExportOptions, ExportRoot, export};
use crate::reading::{Parcel, ReadSetup, SkeletonFile, Unpacker, read, read_and_convert};
use segue_formats::archive::{ArchiveLimits, unpack};
use segue_formats::bvh::{WriteOptions, write};
use segue_formats::fbx::{FbxOptions, write_fbx};
use segue_formats::gltf::{GlbOptions, write_glb, write_vrma};
use segue_formats::numpy::write_npz;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, Interpolation, resample};
use segue_motion::skeleton::{Role, Roles};
use segue_motion::synth::{Action, Params, synthesize};

fn made(action: Action) -> Clip {
    synthesize(&Params::new(action)).unwrap().clip
}

fn options(format: ExportFormat) -> ConvertOptions {
    ConvertOptions { export: ExportOptions { format, ..ExportOptions::default() }, rig: None }
}

/// Returns twenty files of many formats in folders; three of them are broken.
fn mixed() -> Vec<(String, Vec<u8>)> {
    let (walk, run) = (made(Action::Walk), made(Action::Run));
    let roles = Roles::detect(walk.skeleton());
    let bvh = |clip: &Clip| write(clip, &WriteOptions::default()).into_bytes();
    let fbx = |clips: &[&Clip]| write_fbx(clips, &FbxOptions::default()).unwrap();
    let glb = |clip: &Clip| write_glb(clip, &GlbOptions::default()).unwrap();
    let mut files = vec![
        ("set/both.fbx".to_owned(), fbx(&[&walk, &run])),
        ("set/walk.fbx".into(), fbx(&[&walk])),
        ("set/walk.glb".into(), glb(&walk)),
        ("set/run.npz".into(), write_npz(&run)),
        ("set/walk.vrma".into(), write_vrma(&walk, &roles, None).unwrap()),
        ("../up/走路.bvh".into(), bvh(&walk)),
        ("a\\b\\run.bvh".into(), bvh(&run)),
        ("robot.csv".into(), ROBOT.to_vec()),
        ("points.c3d".into(), C3D.to_vec()),
        ("=sum(1).bvh".into(), bvh(&run)),
        ("one/same.bvh".into(), bvh(&walk)),
        ("one/same.npz".into(), write_npz(&walk)),
        // The broken ones.
        ("broken/cut.bvh".into(), bvh(&walk)[..400].to_vec()),
        ("broken/cut.fbx".into(), fbx(&[&walk])[..5000].to_vec()),
        ("broken/notes.txt".into(), b"nothing of a motion".to_vec()),
    ];
    for index in 0..5 {
        files.push((format!("more/{index}.bvh"), bvh(&run)));
    }
    files
}

const ROBOT: &[u8] = include_bytes!("../../../formats/tests/cases/robot_csv/scalar_last.csv");
const C3D: &[u8] = include_bytes!("../../../formats/tests/cases/c3d/ezc3d.c3d");

/// Converts files as the page does, through the worker's messages.
fn converted(files: &[(String, Vec<u8>)], options: &ConvertOptions) -> Conversion {
    let mut conversion = Conversion::new(options.clone());
    let options: ConvertOptions =
        serde_json::from_str(&serde_json::to_string(options).unwrap()).unwrap();
    let setup = ReadSetup::default();
    for (name, bytes) in files {
        let report = read_and_convert(name, bytes, &setup, &options, &mut |_| true).unwrap();
        let parcel = Parcel::new(report).unwrap();
        let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
        parcel.pieces(|piece| unpacker.push(piece));
        conversion.add_report(name, Ok(unpacker.finish().unwrap()));
    }
    conversion
}

fn files_of(conversion: Conversion) -> Vec<(String, Vec<u8>)> {
    let zip = conversion.finish();
    let limits = ArchiveLimits::default();
    let files = unpack("x.zip", &zip, &limits).unwrap().files;
    files.into_iter().map(|file| (file.path, file.bytes)).collect()
}

fn bytes_of<'a>(files: &'a [(String, Vec<u8>)], path: &str) -> &'a [u8] {
    &files.iter().find(|(own, _)| own == path).unwrap().1
}

fn text_of<'a>(files: &'a [(String, Vec<u8>)], path: &str) -> &'a str {
    std::str::from_utf8(bytes_of(files, path)).unwrap()
}

/// Returns the only clip of a file.
fn read_back(name: &str, bytes: &[u8]) -> Clip {
    import(name, bytes, &ImportOptions::default()).unwrap().clips.remove(0).clip
}

#[test]
fn conversion_of_mixed_files_survives_the_broken_ones() {
    let files = mixed();
    assert_eq!(files.len(), 20);
    for format in [ExportFormat::Fbx, ExportFormat::Bvh, ExportFormat::Npz, ExportFormat::Glb] {
        let conversion = converted(&files, &options(format));
        let failed: Vec<&str> = (conversion.rows().iter())
            .filter(|row| row.output.is_err())
            .map(|row| row.source.as_str())
            .collect();
        assert_eq!(failed, ["broken/cut.bvh", "broken/cut.fbx", "broken/notes.txt"]);
        // One file has two clips.
        assert_eq!(conversion.rows().len(), 21);
        let rows = conversion.rows().to_vec();
        let outputs = files_of(conversion);
        for row in rows {
            let Ok(path) = &row.output else { continue };
            let (_, frames, ..) = row.clip.as_ref().unwrap();
            let back = read_back(path, bytes_of(&outputs, path));
            assert_eq!(back.frames(), *frames, "{path}");
        }
    }
}

#[test]
fn files_of_a_conversion_keep_their_folders_and_have_names_of_their_own() {
    let conversion = converted(&mixed(), &options(ExportFormat::Fbx));
    let paths: Vec<&str> =
        conversion.rows().iter().filter_map(|row| row.output.as_deref().ok()).collect();
    for path in [
        "set/both.fbx",
        "set/both Run.fbx",
        "motion/up/走路.fbx",
        "a/b/run.fbx",
        "one/same.fbx",
        "more/4.fbx",
    ] {
        assert!(paths.contains(&path), "{path} is not among {paths:?}");
    }
    let mut sorted = paths.clone();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), paths.len());
    assert!(paths.iter().all(|path| !path.contains("..") && !path.starts_with('/')));
    let table = conversion.table();
    assert_eq!(table.lines().count(), 1 + 21);
    assert!(table.contains("\r\n'=sum(1).bvh,"), "a formula would run in a spreadsheet: {table}");
    let files = files_of(conversion);
    assert!(text_of(&files, TABLE) == table);
}

#[test]
fn conversion_follows_rate_and_rig() {
    let run = made(Action::Run);
    let target = segue_motion::skeleton::fixtures::mixamo();
    let standing = Clip::new(
        "t",
        target.clone(),
        30.0,
        vec![glam::Quat::IDENTITY; target.len()],
        vec![target.joints()[0].offset],
    );
    let target = Motion::with_roles(standing.unwrap(), &Roles::detect(&target));
    let how = ConvertOptions {
        export: ExportOptions { fps: Some(30.0), ..options(ExportFormat::Npz).export },
        rig: Some(TargetRig::of(&target)),
    };
    let files = [("run.bvh".to_owned(), write(&run, &WriteOptions::default()).into_bytes())];
    let conversion = converted(&files, &how);
    assert_eq!(conversion.rows()[0].output.as_deref(), Ok("run.npz"));
    let outputs = files_of(conversion);
    let back = read_back("run.npz", bytes_of(&outputs, "run.npz"));
    let names = |clip: &Clip| -> Vec<String> {
        clip.skeleton().joints().iter().map(|joint| joint.name.clone()).collect()
    };
    assert_eq!(names(&back), names(target.clip()));
    let frames = resample(&run, 30.0, Interpolation::default()).unwrap().frames();
    assert_eq!((back.fps(), back.frames()), (30.0, frames));
    let roles = Roles::detect(back.skeleton());
    let far = |clip: &Clip, roles: &Roles| {
        let hips = roles.get(Role::Hips).unwrap();
        let at = |frame: usize| clip.world_pose(frame).positions[hips];
        at(0).distance(at(clip.frames() - 1))
    };
    assert!(far(&back, &roles) > 0.3 * far(&run, &Roles::detect(run.skeleton())));
    // A table has the rate, too.
    let table = ConvertOptions {
        export: ExportOptions { format: ExportFormat::Csv, ..how.export },
        rig: None,
    };
    let outputs = files_of(converted(&files, &table));
    assert_eq!(text_of(&outputs, "run.csv").lines().count(), 1 + frames);
}

#[test]
fn motion_without_its_skeleton_tells_what_it_needs() {
    let (asf, amc) = (crate::fixtures::ASF.as_bytes(), crate::fixtures::AMC.as_bytes());
    let files = [("small.amc".to_owned(), amc.to_vec())];
    let alone = converted(&files, &options(ExportFormat::Bvh));
    let reason = alone.rows()[0].output.as_ref().unwrap_err().to_string();
    assert!(reason.contains("ASF"), "{reason}");
    let setup = ReadSetup {
        skeleton_files: vec![SkeletonFile::new("small.asf", asf)],
        ..ReadSetup::default()
    };
    let options = options(ExportFormat::Bvh);
    let report = read_and_convert("small.amc", amc, &setup, &options, &mut |_| true);
    let mut both = Conversion::new(options);
    both.add_report("small.amc", Ok(report.unwrap()));
    assert_eq!(both.rows()[0].output.as_deref(), Ok("small.bvh"));
}

#[test]
fn conversion_of_an_archive_has_its_files() {
    let mut zip = ZipWriter::default();
    for (name, bytes) in mixed().iter().filter(|(name, _)| name.starts_with("more/")) {
        zip.store(name, bytes).unwrap();
    }
    let files = [("all.zip".to_owned(), zip.finish())];
    let conversion = converted(&files, &options(ExportFormat::Npz));
    let paths: Vec<&str> =
        conversion.rows().iter().filter_map(|row| row.output.as_deref().ok()).collect();
    assert_eq!(paths.len(), 5);
    assert_eq!(paths[0], "all.zip/more/0.npz");
}

#[test]
fn clips_of_the_library_are_converted_beside_files() {
    let walk =
        Motion::with_roles(made(Action::Walk), &Roles::detect(made(Action::Walk).skeleton()));
    let mut conversion = Conversion::new(options(ExportFormat::G1Csv));
    conversion.add_clip("Walk", &walk, None);
    assert!(conversion.rows()[0].output.as_ref().unwrap_err().to_string().contains("Unitree G1"));
    let mut conversion = Conversion::new(options(ExportFormat::Vrma));
    conversion.add_clip("Walk", &walk, None);
    conversion.add_clip("Walk", &walk, None);
    let paths: Vec<&str> =
        conversion.rows().iter().filter_map(|row| row.output.as_deref().ok()).collect();
    assert_eq!(paths[0], "Walk.vrma");
    assert_ne!(paths[1], "Walk.vrma");
}

#[test]
fn files_of_long_or_equal_names_are_numbered() {
    let walk = Motion::with_roles(made(Action::Walk), &Roles::default());
    let mut conversion = Conversion::new(options(ExportFormat::Npz));
    let long = "x".repeat(300);
    for name in [long.as_str(), &long, &long, "a/Walk.bvh", "a/walk.bvh", "conversion.bvh"] {
        conversion.add_clip(name, &walk, None);
    }
    let mut paths: Vec<String> =
        (conversion.rows().iter()).map(|row| row.output.clone().unwrap().to_lowercase()).collect();
    assert!(paths.iter().all(|path| path.len() < 120));
    paths.sort();
    paths.dedup();
    assert_eq!(paths.len(), 6);
}

#[test]
fn files_of_many_rigs_become_animations_of_one_file() {
    for format in [ExportFormat::Glb, ExportFormat::Fbx] {
        let mut conversion = Conversion::in_one_file(options(format), None);
        for (name, bytes) in mixed() {
            let report = read(&name, &bytes, &ReadSetup::default(), &mut |_| true).unwrap();
            conversion.add_report(&name, Ok(report));
        }
        let walk = Motion::analyze(made(Action::Walk));
        conversion.add_clip("Walk", &walk, None);
        conversion.write_one_file();
        let rows = conversion.rows().to_vec();
        assert_eq!(rows.len(), 22);
        let good: Vec<&ConversionRow> = rows.iter().filter(|row| row.output.is_ok()).collect();
        assert!(good.iter().all(|row| row.output == Ok(format!("clips.{}", format.ending()))));
        // Points without a body cannot be put on one.
        let failed: Vec<&str> = (rows.iter().filter(|row| row.output.is_err()))
            .map(|row| row.source.as_str())
            .collect();
        assert_eq!(failed, ["points.c3d", "broken/cut.bvh", "broken/cut.fbx", "broken/notes.txt"]);
        let robot = rows.iter().find(|row| row.source == "robot.csv").unwrap();
        assert!(robot.odd.iter().any(|note| note.to_string().contains("body of the file")));
        let made = conversion.into_file();
        assert_eq!(made.name, format!("clips.{}", format.ending()));
        let back = import(&made.name, &made.bytes, &ImportOptions::default()).unwrap().clips;
        assert_eq!(back.len(), good.len());
        let mut names: Vec<&str> = back.iter().map(|own| own.clip.name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), good.len(), "each animation has a name of its own");
        for (own, row) in back.iter().zip(&good) {
            // A file of FBX has one frame rate.
            let (_, frames, fps, _) = row.clip.as_ref().unwrap();
            let secs = (*frames - 1) as f64 / fps;
            assert!((own.clip.duration_secs() - secs).abs() < 1e-3, "{}", row.source);
            assert_eq!(own.clip.skeleton().len(), walk.clip().skeleton().len());
        }
        // A clip that has this body already is unchanged.
        let (own, back) = (walk.clip(), &back.last().unwrap().clip);
        for frame in (0..own.frames()).step_by(9) {
            let [own, back] = [own, back].map(|clip| clip.world_pose(frame).positions);
            assert!(own.iter().zip(&back).all(|(own, back)| own.distance(*back) < 1e-4));
        }
    }
}

#[test]
fn one_file_of_all_clips_has_the_chosen_body() {
    let (walk, run) = (made(Action::Walk), made(Action::Run));
    let skeleton = segue_motion::skeleton::fixtures::mixamo();
    let roles = Roles::detect(&skeleton);
    let mesh = Arc::new(SkinnedMesh::around(&skeleton, &roles, 1.0));
    let vertices = mesh.positions.len();
    let character = Character { skeleton: skeleton.clone(), roles, mesh };
    let mut conversion = Conversion::in_one_file(options(ExportFormat::Glb), Some(&character));
    for clip in [&walk, &run] {
        conversion.add_clip(clip.name(), &Motion::analyze(clip.clone()), None);
    }
    let mut made = conversion.into_file();
    let author = made.bytes.windows(6).position(|w| w == b"Segue ").unwrap();
    made.bytes[author..author + 5].copy_from_slice(b"Other");
    let back = import(&made.name, &made.bytes, &ImportOptions::default()).unwrap().clips;
    assert_eq!(back.len(), 2);
    for own in &back {
        assert_eq!(own.clip.skeleton().joints()[0].name, skeleton.joints()[0].name);
        assert_eq!(own.mesh.as_ref().map(|mesh| mesh.positions.len()), Some(vertices));
    }
    // A format for one clip says so, in the line of each.
    let mut conversion = Conversion::in_one_file(options(ExportFormat::Bvh), None);
    conversion.add_clip("Walk", &Motion::analyze(walk), None);
    conversion.write_one_file();
    let reason = conversion.rows()[0].output.clone().unwrap_err().to_string();
    assert!(reason.contains("choose FBX or GLB"), "{reason}");
    assert_eq!(conversion.into_file().name, ARCHIVE);
}

#[test]
fn root_motion_is_where_the_options_want_it() {
    let walk = Motion::analyze(made(Action::Walk));
    let far = |clip: &Clip| {
        let at = |frame: usize| clip.root_translations()[frame];
        (at(0) - at(clip.frames() - 1)).length()
    };
    for format in [ExportFormat::Bvh, ExportFormat::Fbx, ExportFormat::Glb, ExportFormat::Npz] {
        let exported = |root: ExportRoot| {
            let how = ExportOptions { format, root, ..ExportOptions::default() };
            let bytes = export(&walk, None, &[], &how).unwrap();
            read_back(&format!("x.{}", format.ending()), &bytes)
        };
        let [as_it_is, rooted, still] =
            [ExportRoot::AsIs, ExportRoot::Ground, ExportRoot::InPlace].map(exported);
        assert!(as_it_is.unfolded().is_none());
        let file = rooted.unfolded().expect("joints above the hips");
        assert_eq!(file.skeleton().joints()[0].name, "root", "{format:?}");
        assert!(file.root_translations().iter().all(|root| root.y.abs() < 1e-4));
        assert!((far(&file) - far(walk.clip())).abs() < 0.1);
        // Reading folds the bone again, and the body is where it was.
        for frame in (0..walk.clip().frames()).step_by(11) {
            let own = walk.clip().world_pose(frame).positions;
            let back = rooted.world_pose(frame).positions;
            assert!(own.iter().zip(&back).all(|(own, back)| own.distance(*back) < 2e-4));
        }
        assert!(far(&still) < 0.2 && far(walk.clip()) > 1.0, "{format:?}");
    }
    // A table of a format without such a bone is as it is.
    let how = ExportOptions { format: ExportFormat::Csv, ..ExportOptions::default() };
    let ground = ExportOptions { root: ExportRoot::Ground, ..how };
    assert_eq!(export(&walk, None, &[], &how), export(&walk, None, &[], &ground));
    let in_place = ExportOptions { root: ExportRoot::InPlace, ..how };
    assert_ne!(export(&walk, None, &[], &how), export(&walk, None, &[], &in_place));
}
