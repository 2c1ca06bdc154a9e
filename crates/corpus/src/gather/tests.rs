//! Corpora of synthesised files.

use super::*;
use crate::{decode_poses, process_file, work_key};
use segue_formats::bvh::{self, WriteOptions};
use segue_formats::numpy::write_npz;
use segue_motion::clip::{Clip, Motion, mirror};
use segue_motion::synth::{Action, Params, synthesize};

fn made(change: impl FnOnce(&mut Params)) -> Clip {
    let mut params = Params::new(Action::Walk);
    change(&mut params);
    synthesize(&params).unwrap().clip
}

fn as_bvh(clip: &Clip) -> Vec<u8> {
    bvh::write(clip, &WriteOptions::default()).into_bytes()
}

/// A name, and the content of its file.
type File = (&'static str, Vec<u8>);

fn files() -> Vec<File> {
    let walk = made(|_| ());
    let motion = Motion::analyze(walk.clone());
    let mirrored = mirror(&walk, motion.roles()).unwrap();
    let broken = String::from_utf8(as_bvh(&walk)).unwrap().replacen("OFFSET", "OFSET", 1);
    vec![
        ("walk.bvh", as_bvh(&walk)),
        ("fast.bvh", as_bvh(&made(|params| params.speed_mps = 1.8))),
        ("small.npz", write_npz(&walk.scaled(0.8))),
        ("mirrored.bvh", as_bvh(&mirrored)),
        ("short.bvh", as_bvh(&walk.crop(0..20).unwrap())),
        ("broken.bvh", broken.into_bytes()),
        ("none.txt", b"not a motion".to_vec()),
    ]
}

fn records(options: &Options) -> Vec<(String, FileRecord)> {
    let of_file = |(name, bytes): File| {
        let key = work_key(name, &bytes, &[], options);
        (key, process_file(name, &bytes, &[], options))
    };
    files().into_iter().map(of_file).collect()
}

fn gathered(records: &[(String, FileRecord)]) -> Gathered {
    let mut gatherer = Gatherer::new(Options::default()).unwrap();
    for (key, record) in records {
        gatherer.add(key, record).unwrap();
    }
    gatherer.finish().unwrap()
}

fn row<'a>(corpus: &'a Gathered, records: &[(String, FileRecord)], file: usize) -> &'a CorpusRow {
    corpus.rows.iter().find(|row| row.key == records[file].0).unwrap()
}

#[test]
fn corpus_does_not_depend_on_the_order_of_records() {
    let mut records = records(&Options::default());
    let forward = format!("{:?}", gathered(&records));
    records.reverse();
    assert_eq!(format!("{:?}", gathered(&records)), forward);
    records.extend(records.clone());
    assert_eq!(format!("{:?}", gathered(&records)), forward, "the same records twice");
}

#[test]
fn files_that_cannot_be_used_are_rows_that_say_why() {
    let records = records(&Options::default());
    let corpus = gathered(&records);
    let broken = &row(&corpus, &records, 5).row;
    assert_eq!((broken.status, broken.line, broken.column), (Status::Unreadable, Some(4), Some(2)));
    assert!(broken.message.as_ref().unwrap().starts_with("found `OFSET`"), "{broken:?}");
    assert_eq!(row(&corpus, &records, 6).row.status, Status::Unreadable);
    assert!(row(&corpus, &records, 6).poses.is_none());
    let counts = &corpus.manifest["counts"];
    let count = |name: &str| counts[name].as_u64().unwrap();
    assert_eq!((count("rows"), count("clips"), count("unreadable")), (7, 5, 2));
}

#[test]
fn rows_have_the_numbers_of_their_clips() {
    let records = records(&Options::default());
    let corpus = gathered(&records);
    let walk = row(&corpus, &records, 0);
    assert_eq!((walk.row.format.as_str(), walk.row.joints), ("bvh", Some(22)));
    assert_eq!((walk.row.name.as_deref(), walk.row.status), (None, Status::Ok));
    assert!((walk.row.height_m.unwrap() - 1.75).abs() < 0.1, "{:?}", walk.row.height_m);
    assert!(walk.row.metrics["skating_cmps"].unwrap() < 5.0, "{:?}", walk.row.metrics);
    // A row every tenth of a second, until a second before the end.
    let expected = (walk.row.seconds.unwrap() - 1.0) * 10.0;
    assert!((walk.moments as f64 - expected).abs() <= 1.0, "{} {expected}", walk.moments);
    let short = row(&corpus, &records, 4);
    assert!(short.poses.is_some() && short.moments == 0);
}

#[test]
fn copies_are_found_in_other_formats_sizes_and_mirrors() {
    let records = records(&Options::default());
    let corpus = gathered(&records);
    let group: Vec<&CorpusRow> = [0, 2, 3].map(|file| row(&corpus, &records, file)).into();
    let first = group.iter().find(|row| row.copy_of.is_none()).expect("one is no copy");
    assert_eq!(group.iter().filter(|row| row.copy_of.as_ref() == Some(&first.id)).count(), 2);
    let is_mirrored = |file: usize| {
        row(&corpus, &records, file).key == first.key || row(&corpus, &records, file).is_mirrored
    };
    // Mirrored against the first of them, whichever that is.
    assert_ne!(is_mirrored(0), group[0].copy_of.is_some() && !group[0].is_mirrored);
    let others = [1, 4, 5, 6].map(|file| row(&corpus, &records, file).copy_of.clone());
    assert!(others.iter().all(Option::is_none), "{others:?}");
}

#[test]
fn copies_are_those_of_the_slow_search() {
    let signature = |at: i32| Signature::from_numbers(vec![at; Signature::LEN]);
    let clips: Vec<(f64, Option<Signature>)> = (0..60)
        .map(|own: i32| {
            let secs = 2.0 + f64::from(own * 7 % 11) * 0.04;
            (secs, signature(own * 37 % 101 * 10).filter(|_| own % 9 != 0))
        })
        .collect();
    let mut slow: Vec<Option<(usize, bool)>> = vec![None; clips.len()];
    for own in 0..clips.len() {
        let mut best: Option<(f32, usize, bool)> = None;
        for of in 0..own {
            let (Some(a), Some(b)) = (&clips[own].1, &clips[of].1) else { continue };
            let is_near = (clips[own].0 - clips[of].0).abs() <= MAX_SECS_APART;
            for (a, is_mirrored) in [(a.clone(), false), (a.mirrored(), true)] {
                let apart = a.distance_cm(b, MAX_DISTANCE_CM);
                let Some(apart) = apart.filter(|_| slow[of].is_none() && is_near) else { continue };
                if best.is_none_or(|best| apart < best.0) {
                    best = Some((apart, of, is_mirrored));
                }
            }
        }
        slow[own] = best.map(|(_, of, is_mirrored)| (of, is_mirrored));
    }
    assert!(slow.iter().flatten().count() > 10);
    assert_eq!(copies(&clips), slow);
}

#[test]
fn poses_in_a_shard_are_those_of_the_clip() {
    let records = records(&Options::default());
    let corpus = gathered(&records);
    let body = StandardBody::new().unwrap();
    let shard: Vec<u8> = corpus.pose_shards[0]
        .iter()
        .flat_map(|piece| {
            let record = records.iter().find(|(key, _)| *key == piece.key).unwrap();
            record.1.clips[piece.clip].poses.clone()
        })
        .collect();
    let slot = row(&corpus, &records, 0).poses.unwrap();
    let bytes = &shard[slot.offset..slot.offset + slot.length];
    let read = decode_poses("walk", bytes, body.skeleton()).unwrap();
    let walk = Motion::analyze(made(|_| ()));
    let placed = body.place(&walk).unwrap();
    assert_eq!(read.contacts, placed.contacts);
    let all = 0..placed.clip.frames();
    let (own, back) = (placed.clip.world_positions(all.clone()), read.clip.world_positions(all));
    assert_eq!(own.len(), back.len());
    assert!(own.iter().zip(&back).all(|(a, b)| a.distance(*b) < 5e-4));
    // The walk is on the same kind of body, which moves it by little.
    let joint = body.skeleton().find("LeftHand").unwrap();
    let there =
        walk.clip().world_pose(60).positions[walk.clip().skeleton().find("LeftHand").unwrap()];
    assert!(there.distance(back[30 * body.skeleton().len() + joint]) < 0.02);
    for end in 0..bytes.len().min(300) {
        assert!(decode_poses("walk", &bytes[..end], body.skeleton()).is_err(), "{end}");
    }
}

#[test]
fn key_depends_on_content_and_options_alone() {
    let key = |name: &str, bytes: &[u8], clean| work_key(name, bytes, &[], &Options { clean });
    let own = key("a/walk.bvh", b"x", false);
    assert_eq!(own.len(), 32);
    assert_eq!(own, key("b/other.BVH", b"x", false));
    for other in [
        key("walk.bvh", b"y", false),
        key("walk.bvh", b"x", true),
        key("walk.fbx", b"x", false),
        key("walk.bvh.gz", b"x", false),
    ] {
        assert_ne!(own, other);
    }
    let record = |name| process_file(name, &as_bvh(&made(|_| ())), &[], &Options::default());
    assert_eq!(record("a/walk.bvh"), record("other.bvh"));
}

#[test]
fn cleaned_corpus_has_mended_clips() {
    use segue_motion::clean::damage;
    let walk = Motion::analyze(made(|_| ()));
    let spoilt = damage(walk.clip(), walk.roles(), 3, 1).unwrap().clip;
    let record = |clean| process_file("a.bvh", &as_bvh(&spoilt), &[], &Options { clean });
    let (own, mended) = (record(false), record(true));
    assert_eq!(own.clips[0].row.mended, 0);
    assert!(mended.clips[0].row.mended >= 3, "{:?}", mended.clips[0].row);
    assert_eq!(own.clips[0].row.metrics, mended.clips[0].row.metrics, "the clip as it was");
    assert_ne!(own.clips[0].poses, mended.clips[0].poses);
}
