//! Files of `NumPy`, compared with the places of joints that an independent script gives
//! (`tests/cases/numpy/make.py`).

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

use glam::Vec3;
use segue_formats::numpy::{SmplModel, read_model, read_with_models, write_npz};
use segue_formats::{FileKind, ImportOptions, ImportedFile, import, kind_of};
use segue_motion::clip::{Clip, JointTranslations, Provenance, UpAxis};
use segue_motion::synth::{Action, Params, synthesize};
use std::path::{Path, PathBuf};

fn case(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/numpy").join(name)
}

fn bytes_of(name: &str) -> Vec<u8> {
    std::fs::read(case(name)).unwrap()
}

fn read(name: &str) -> ImportedFile {
    import(name, &bytes_of(name), &ImportOptions::default()).unwrap()
}

fn warnings(file: &ImportedFile) -> Vec<String> {
    file.warnings.iter().map(ToString::to_string).collect()
}

/// Checks the places of the first joints in every frame; `joints` is their number.
fn assert_places(clip: &Clip, name: &str, joints: usize) {
    const TOLERANCE_M: f32 = 1e-4;
    let numbers: Vec<f32> = bytes_of(&format!("expected/{name}.f32"))
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    let expected: Vec<Vec3> = numbers.chunks_exact(3).map(Vec3::from_slice).collect();
    assert_eq!((clip.frames(), expected.len()), (8, 8 * joints), "{name}");
    for (frame, expected) in expected.chunks_exact(joints).enumerate() {
        let found = clip.world_pose(frame).positions;
        for (joint, (found, expected)) in found.iter().zip(expected).enumerate() {
            // The file with half precision has three digits.
            let tolerance = if name == "six" { 1e-3 } else { TOLERANCE_M };
            let off = found.distance(*expected);
            assert!(off < tolerance, "{name}, frame {frame}, joint {joint}: {off} m");
        }
    }
}

const GENERIC: &str = "the file has no body: the angles are true";

#[test]
fn places_of_every_file_equal_the_oracle() {
    for (name, fps, up) in [
        ("stageii.npz", 120.0, UpAxis::Z),
        ("smpl72.npz", 30.0, UpAxis::Z),
        ("soma30.npz", 30.0, UpAxis::Y),
        ("soma30_local.npz", 24.0, UpAxis::Y),
        ("humanml272.npy", 30.0, UpAxis::Y),
        ("wxyz.npy", 30.0, UpAxis::Y),
        ("xyzw.npy", 30.0, UpAxis::Y),
        ("matrices.npy", 30.0, UpAxis::Y),
        ("six.npy", 30.0, UpAxis::Y),
        ("vectors.npy", 30.0, UpAxis::Y),
        ("joints22.npy", 20.0, UpAxis::Y),
        ("joints22_z_up.npy", 20.0, UpAxis::Z),
        ("dictionary.npy", 30.0, UpAxis::Y),
        ("pickle0.pkl", 30.0, UpAxis::Y),
        ("pickle1.pkl", 30.0, UpAxis::Y),
        ("pickle2.pkl", 30.0, UpAxis::Y),
        ("pickle3.pkl", 30.0, UpAxis::Y),
        ("pickle4.pkl", 30.0, UpAxis::Y),
        ("pickle5.pkl", 30.0, UpAxis::Y),
    ] {
        assert_eq!(kind_of(name, &bytes_of(name)), FileKind::Numpy);
        let file = read(name);
        let (stem, _) = name.split_once('.').unwrap();
        assert_eq!(file.clips.len(), 1, "{name}");
        let clip = &file.clips[0].clip;
        assert_places(clip, stem, if stem.starts_with("soma") { 30 } else { 22 });
        assert_eq!((clip.name(), clip.fps()), (stem, fps));
        assert_eq!((clip.provenance().up, clip.provenance().metres_per_unit), (up, 1.0), "{name}");
        let has_body = ["soma", "humanml", "joints"].iter().any(|name| stem.starts_with(name));
        let told = warnings(&file);
        assert_eq!(told.iter().any(|text| text.starts_with(GENERIC)), !has_body, "{told:?}");
    }
}

#[test]
fn results_of_several_samples_are_clips_of_their_lengths() {
    let file = read("results.npy");
    let clips: Vec<(&str, usize)> =
        file.clips.iter().map(|own| (own.clip.name(), own.clip.frames())).collect();
    assert_eq!(clips, [("results 1", 8), ("results 2", 5)]);
    assert_places(&file.clips[0].clip, "joints22", 22);
    assert_eq!(file.clips[1].clip.fps(), 20.0);
}

#[test]
fn amass_with_a_model_has_its_bones() {
    let options = ImportOptions::default();
    let bytes = bytes_of("SMPLH_FEMALE.npz");
    assert_eq!(kind_of("a/SMPLH_FEMALE.npz", &bytes), FileKind::SmplModel);
    let model = read_model("SMPLH_FEMALE.npz", &bytes, &options).unwrap();
    let motion = bytes_of("amass.npz");
    // Without its mesh, the model says the same.
    let small = model.to_bytes();
    assert!(
        small.len() < bytes.len() && kind_of("SMPLH_FEMALE.npz", &small) == FileKind::SmplModel
    );
    let small = read_model("SMPLH_FEMALE.npz", &small, &options).unwrap();
    for model in [&model, &small] {
        let (file, used) = read_with_models("amass.npz", &motion, &[model], &options).unwrap();
        assert_eq!((used, warnings(&file)), (Some(0), vec![]));
        assert_eq!(file.clips[0].clip.fps(), 60.0);
        assert_places(&file.clips[0].clip, "amass", 52);
    }
    let file = read("amass.npz");
    assert_places(&file.clips[0].clip, "amass_generic", 22);
    assert_eq!(warnings(&file).len(), 1);
    // A model alone is a skeleton.
    let alone = read("SMPLH_FEMALE.npz");
    assert_eq!(alone.clips[0].clip.frames(), 0);
    assert_eq!(alone.clips[0].clip.skeleton().len(), 52);
}

#[test]
fn amass_takes_the_model_of_its_gender() {
    let options = ImportOptions::default();
    let named = |name: &str| read_model(name, &bytes_of("SMPLH_FEMALE.npz"), &options).unwrap();
    let models = ["male/model.npz", "neutral/model.npz", "female/model.npz"].map(named);
    let all: Vec<&SmplModel> = models.iter().collect();
    let used = |models: &[&SmplModel], file: &str| {
        read_with_models(file, &bytes_of(file), models, &options).unwrap().1
    };
    assert_eq!(used(&all, "amass.npz"), Some(2));
    assert_eq!(used(&all[..2], "amass.npz"), Some(1));
    // 55 joints need another model.
    assert_eq!(used(&all, "stageii.npz"), None);
}

#[test]
fn options_of_the_user_come_first() {
    let up = Some(UpAxis::Y);
    let options = ImportOptions { fps: Some(25.0), up, ..ImportOptions::default() };
    let file = import("amass.npz", &bytes_of("amass.npz"), &options).unwrap();
    let clip = &file.clips[0].clip;
    assert_eq!((clip.fps(), clip.provenance().up), (25.0, UpAxis::Y));
    // Not stood up: the body lies.
    let height = |clip: &Clip| {
        let world = clip.world_pose(0).positions;
        world[15].y - world[10].y
    };
    assert!(height(clip).abs() < 0.5 && height(&read("amass.npz").clips[0].clip) > 1.0);
}

#[test]
fn values_without_their_scale_are_refused() {
    let name = "normalised272.npy";
    let error = import(name, &bytes_of(name), &ImportOptions::default()).unwrap_err();
    assert!(error.found.to_string().contains("normalised"), "{error}");
    assert!(error.hint.unwrap().to_string().contains("standard deviation"));
}

#[test]
fn files_that_are_cut_off_or_changed_are_read_or_refused() {
    let options = ImportOptions::default();
    for name in ["smpl72.npz", "wxyz.npy", "dictionary.npy", "pickle0.pkl", "pickle5.pkl"] {
        let bytes = bytes_of(name);
        for end in (0..bytes.len()).step_by(7) {
            let error = import(name, &bytes[..end], &options).err();
            assert!(error.is_some() || name.ends_with("pkl"), "{name} cut off at {end}");
        }
        for at in 0..bytes.len().min(900) {
            let mut changed = bytes.clone();
            changed[at] ^= 0x55;
            if let Ok(file) = import(name, &changed, &options) {
                assert!(file.clips.iter().all(|own| own.clip.frames() <= bytes.len()));
            }
        }
    }
}

fn walk() -> Clip {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let values = (0..clip.frames()).map(|frame| Vec3::splat(0.01 * frame as f32)).collect();
    clip.with_translations(vec![JointTranslations { joint: 3, values }]).unwrap()
}

#[test]
fn write_npz_is_read_back_to_the_last_bit() {
    let provenance = Provenance { metres_per_unit: 0.01, up: UpAxis::Z };
    let clip = walk().with_provenance(provenance);
    let bytes = write_npz(&clip);
    assert_eq!(bytes, write_npz(&clip));
    assert_eq!(kind_of("walk.npz", &bytes), FileKind::Numpy);
    let file = import(&format!("{}.npz", clip.name()), &bytes, &ImportOptions::default()).unwrap();
    assert_eq!((file.clips.len(), warnings(&file)), (1, vec![]));
    let back = &file.clips[0].clip;
    let joints = |clip: &Clip| {
        let joints = clip.skeleton().joints().iter();
        joints.map(|j| (j.name.clone(), j.parent, j.offset, j.end_site)).collect::<Vec<_>>()
    };
    assert_eq!(joints(back), joints(&clip));
    assert_eq!(back.root_translations(), clip.root_translations());
    assert_eq!(back.translations(), clip.translations());
    assert_eq!((back.fps(), back.provenance()), (clip.fps(), provenance));
    for frame in 0..clip.frames() {
        assert_eq!(back.rotations(frame), clip.rotations(frame));
    }
}
