//! The bundled takes of one actor: the content of their files, compared with the database's own
//! files if this machine has them.

mod bundled;
#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::captured;
use segue_formats::{ImportOptions, import, unpack_gzip};
use segue_motion::clip::{Clip, ContactOptions, Contacts, character_frames, ground_speed};
use segue_motion::skeleton::{Roles, Side, WorldPose};
use segue_session::{Sample, Session};
use sha2::{Digest as _, Sha256};

/// The greatest size of all takes of the set together, bytes.
const MAX_BYTES: usize = 1_500_000;
/// The tolerance for positions of joints, metres.
const CLOSE_M: f32 = 0.001;
/// The number of original frames from one that was kept to the next.
const STRIDE: usize = 2;

fn set() -> &'static [Sample] {
    Session::sample_sets()[0].samples
}

fn unpacked(sample: &Sample) -> (usize, Vec<u8>) {
    let packed = std::fs::read(bundled::folder().join(sample.file)).expect("a file of the set");
    let text = unpack_gzip(sample.file, &packed, 16 << 20).expect("a gzip file");
    (packed.len(), text)
}

fn clip_of(sample: &Sample) -> Clip {
    let mut read =
        import(sample.file.trim_end_matches(".gz"), &unpacked(sample).1, &ImportOptions::default())
            .expect("a BVH file");
    assert_eq!(read.clips.len(), 1, "{}", sample.id);
    let warnings: Vec<String> = read.warnings.iter().map(ToString::to_string).collect();
    assert!(warnings.is_empty(), "{}: {warnings:?}", sample.id);
    read.clips.remove(0).clip
}

#[test]
fn takes_are_small_and_share_a_skeleton() {
    let clips: Vec<Clip> = set().iter().map(clip_of).collect();
    let bytes: usize = set().iter().map(|sample| unpacked(sample).0).sum();
    println!("{} takes, {bytes} bytes", clips.len());
    assert!(bytes <= MAX_BYTES, "{bytes} bytes");
    for (clip, sample) in clips.iter().zip(set()) {
        assert_eq!(clip.skeleton(), clips[0].skeleton(), "{}: another skeleton", sample.id);
        assert!((clip.fps() - 60.0).abs() < 1e-9 && clip.duration_secs() > 1.0, "{}", sample.id);
        let roles = Roles::detect(clip.skeleton());
        assert_eq!(roles.missing().collect::<Vec<_>>(), [], "{}", sample.id);
    }
}

/// The line of a take in `assets/samples/README.md`: frames, frames per second, SHA-256 of the
/// unpacked file.
#[test]
fn takes_are_documented_correctly() {
    let readme =
        std::fs::read_to_string(bundled::folder().join("README.md")).expect("the samples' README");
    let files = std::fs::read_dir(bundled::folder()).expect("the samples");
    let mut packed = 0;
    for entry in files {
        let name = entry.expect("a file").file_name().to_string_lossy().into_owned();
        if name.rsplit('.').next() != Some("gz") {
            continue;
        }
        packed += 1;
        let line = readme.lines().find(|line| line.starts_with(&format!("| `{name}` |")));
        let cells: Vec<&str> = line
            .unwrap_or_else(|| panic!("{name} is not in the README"))
            .split('|')
            .map(str::trim)
            .collect();
        let bytes = std::fs::read(bundled::folder().join(&name)).expect("a file");
        let text = unpack_gzip(&name, &bytes, 64 << 20).expect("a gzip file");
        let sha256: String = Sha256::digest(&text)
            .iter()
            .fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"));
        assert!(cells.contains(&format!("`{sha256}`").as_str()), "{name}: {sha256}");
        let head = String::from_utf8_lossy(&text);
        let after = |what: &str| {
            head.lines()
                .find_map(|line| line.trim().strip_prefix(what))
                .map(str::trim)
                .map(str::to_owned)
        };
        let frames = after("Frames:").expect("a BVH file tells its frames");
        let fps = after("Frame Time:")
            .and_then(|secs| secs.parse::<f64>().ok())
            .expect("and its rate")
            .recip()
            .round();
        assert!(
            cells.contains(&frames.as_str()) && cells.contains(&fps.to_string().as_str()),
            "{name}: {cells:?}"
        );
    }
    assert_eq!(packed, Session::samples().len() + set().len(), "a file that no take names");
}

/// Returns the frame of the original at which a take begins: the one with its first pose.
fn first_frame(take: &Clip, original: &Clip) -> usize {
    let wanted = take.world_pose(0);
    let apart = |frame: &usize| farthest(&original.world_pose(*frame), &wanted);
    (0..4).min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap_or_default()
}

fn farthest(a: &WorldPose, b: &WorldPose) -> f32 {
    let apart = a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b));
    apart.fold(0.0, f32::max)
}

/// Returns the contacts of the feet, and the speed over the ground in metres per second.
fn gait(clip: &Clip) -> (Contacts, f64) {
    let roles = Roles::detect(clip.skeleton());
    let contacts = Contacts::detect(clip, &roles, &ContactOptions::default());
    let frames = character_frames(clip, &roles);
    (contacts, f64::from(ground_speed(&frames, clip.fps())))
}

#[test]
fn takes_equal_the_files_of_the_database() {
    for sample in set() {
        let number: &'static str =
            sample.file.trim_start_matches("16_").trim_end_matches(".bvh.gz");
        for (name, original) in captured(&[number]) {
            let take = clip_of(sample);
            let names = |clip: &Clip| {
                clip.skeleton().joints().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>()
            };
            assert_eq!(names(&take), names(&original), "{name}");
            let first = first_frame(&take, &original);
            let kept: Vec<usize> = (first..original.frames()).step_by(STRIDE).collect();
            assert_eq!(kept.len(), take.frames(), "{name}: begins with frame {first}");
            let apart = kept.iter().enumerate().map(|(frame, &kept)| {
                farthest(&take.world_pose(frame), &original.world_pose(kept))
            });
            let worst = apart.fold(0.0, f32::max);
            let [(stands, speed), (stood, speed_then)] = [gait(&take), gait(&original)];
            let agree = |side: Side| {
                let alike = kept.iter().enumerate().filter(|(frame, kept)| {
                    stands.planted(side, *frame) == stood.planted(side, **kept)
                });
                alike.count() as f64 / kept.len() as f64
            };
            let agreed = Side::BOTH.map(agree);
            println!(
                "{name} from frame {first}: {:.2} mm; feet stand alike in {agreed:.3?} of all frames; {speed:.3} m/s, was {speed_then:.3} m/s",
                1e3 * worst
            );
            assert!(worst < CLOSE_M, "{name}: {worst} m apart");
            assert!(
                (speed - speed_then).abs() < 0.01 * speed_then,
                "{name}: {speed} m/s, {speed_then} m/s"
            );
            // The beginning and end of a stance are known to about a frame.
            assert!(agreed.iter().all(|share| *share > 0.93), "{name}: {agreed:?}");
        }
    }
}
