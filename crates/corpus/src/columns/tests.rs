//! Columns that are written and read, and bytes that are none.

use super::*;
use crate::pack::Placer;
use crate::{ClipRow, CorpusRow};
use proptest::prelude::*;

/// A row before it has its place.
#[derive(Clone, Debug)]
struct Made {
    key: String,
    clips: usize,
    status: Status,
    path: String,
    name: Option<String>,
    labels: Vec<String>,
    frames: Option<usize>,
    fps: Option<f64>,
    skating: Option<f64>,
    lengths: (usize, usize),
    map: Option<[f32; 2]>,
    copy: Option<(usize, bool)>,
}

fn made() -> impl Strategy<Value = Made> {
    let texts = (
        "[0-9a-f]{12}",
        "[ab/]{0,3}[ab]{1,2}\\.(bvh|fbx)",
        prop::option::of("[A-Cü]{0,3}"),
        prop::collection::vec("(walk|run|idle)", 0..3),
    );
    let numbers = (
        prop::option::of(0usize..5000),
        prop::option::of((0usize..3).prop_map(|rate| [30.0, 59.94, 120.0][rate])),
        prop::option::of(-1e3f64..1e3),
        (0usize..70_000, 0usize..900),
        prop::option::of(prop::array::uniform2(-1.0f32..1.0)),
    );
    let others = (1usize..3, 0usize..3, prop::option::of((0usize..99, any::<bool>())));
    (texts, numbers, others).prop_map(|(texts, numbers, others)| {
        let (key, path, name, labels) = texts;
        let (frames, fps, skating, lengths, map) = numbers;
        let (clips, status, copy) = others;
        let status = STATES[status];
        // Keys that begin alike, and keys that differ late.
        let key = if clips > 1 { format!("00000000{}", &key[..4]) } else { key };
        Made { key, clips, status, path, name, labels, frames, fps, skating, lengths, map, copy }
    })
}

/// Returns the rows of a table, and their texts.
fn table_of(mut all: Vec<Made>) -> (Vec<CorpusRow>, Vec<RowTexts>) {
    all.sort_by(|a, b| a.key.cmp(&b.key));
    all.dedup_by(|a, b| a.key == b.key);
    let (mut poses, mut thumbnails) = (Placer::default(), Placer::default());
    let (mut rows, mut texts) = (Vec::new(), Vec::new());
    for made in all {
        for clip in 0..made.clips {
            let message = (made.status != Status::Ok).then(|| format!("{} is odd", made.path));
            rows.push(CorpusRow {
                id: format!("{}-{clip}", made.key),
                key: made.key.clone(),
                clip,
                row: ClipRow {
                    message,
                    format: made.path.rsplit('.').next().unwrap().to_owned(),
                    frames: made.frames,
                    fps: made.fps,
                    rig: made.skating.map(|_| made.key[..1].to_owned()),
                    metrics: [("skating_cmps".to_owned(), made.skating)].into(),
                    ..ClipRow::of_file(made.status)
                },
                poses: poses.add(made.lengths.0),
                thumbnail: thumbnails.add(made.lengths.1),
                moments: 0,
                map: made.map,
                copy_of: None,
                is_mirrored: false,
            });
            let name = made.name.clone().unwrap_or_else(|| stem(&made.path).to_owned());
            texts.push(RowTexts { path: made.path.clone(), name, labels: made.labels.clone() });
            if let Some((of, is_mirrored)) = made.copy {
                let of = of % rows.len();
                let id = rows[of].id.clone();
                let last = rows.last_mut().unwrap();
                (last.copy_of, last.is_mirrored) = (Some(id), is_mirrored);
            }
        }
    }
    (rows, texts)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn columns_are_read_back(all in prop::collection::vec(made(), 0..12)) {
        let (rows, texts) = table_of(all);
        let bytes = write_columns(&rows, &texts).unwrap();
        let read = read(&bytes).unwrap();
        prop_assert_eq!(read.row_of.len(), rows.len());
        for (at, (row, texts)) in rows.iter().zip(&texts).enumerate() {
            let (digits, number) = read.ids.parts(at as u32);
            prop_assert!(row.key.starts_with(&digits) && digits.len() >= 8, "{}", digits);
            let alike = rows.iter().filter(|own| own.key.starts_with(&digits));
            prop_assert!(alike.into_iter().all(|own| own.key == row.key));
            prop_assert_eq!(number as usize, row.clip);
            let place = read.place_of[at] as usize;
            prop_assert_eq!(read.row_of[place] as usize, at);
            prop_assert_eq!(read.paths.get(place), &texts.path);
            let name = match read.named[at] {
                NOT_NAMED => stem(&texts.path),
                name => read.names.get(name as usize),
            };
            prop_assert_eq!(name, &texts.name);
            prop_assert_eq!(read.states[at], row.row.status);
            let lists = &read.lists;
            let set = &lists.label_sets[read.label_sets[at] as usize];
            let labels: Vec<&str> =
                set.iter().map(|label| lists.labels.get(*label as usize)).collect();
            prop_assert_eq!(labels, texts.labels.iter().map(String::as_str).collect::<Vec<_>>());
            prop_assert_eq!(&lists.formats[read.formats[at] as usize], &row.row.format);
            let rig = (read.rigs[at] as usize).checked_sub(1).map(|own| lists.rigs[own].clone());
            prop_assert_eq!(rig, row.row.rig.clone());
            let message =
                (read.messages[at] as usize).checked_sub(1).map(|own| lists.messages[own].clone());
            prop_assert_eq!(message, row.row.message.clone());
            prop_assert_eq!(lists.rate(read.rates[at]), row.row.fps);
            let frames = read.frames[at].checked_sub(1).map(|frames| frames as usize);
            prop_assert_eq!(frames, row.row.frames);
            prop_assert_eq!((read.poses[at], read.thumbnails[at]), (row.poses, row.thumbnail));
            let original = read.originals[at];
            prop_assert_eq!(
                original.map(|own| (rows[own.row as usize].id.clone(), own.is_mirrored)),
                row.copy_of.clone().map(|id| (id, row.is_mirrored))
            );
            for axis in 0..2 {
                let (place, own) = (read.map[at][axis], row.map.map(|own| own[axis]));
                prop_assert!(own.map_or(place.is_nan(), |own| (own - place).abs() < 0.005));
            }
            let skating = read.coded.iter().find(|own| own.name == "skating_cmps");
            let value =
                skating.and_then(|own| own.values[usize::from(own.codes[at])]);
            let own = row.row.metrics["skating_cmps"];
            prop_assert_eq!(value.is_some(), own.is_some());
            let apart = value.zip(own).map_or(0.0, |(value, own)| (value - own).abs());
            prop_assert!(apart <= 0.04 * own.unwrap_or(0.0).abs() + 5.0, "{:?} {:?}", value, own);
        }
    }

    #[test]
    fn damaged_columns_are_read_or_refused(
        all in prop::collection::vec(made(), 1..6),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        end in any::<prop::sample::Index>()
    ) {
        let (rows, texts) = table_of(all);
        let bytes = write_columns(&rows, &texts).unwrap();
        prop_assert!(read(&bytes[..end.index(bytes.len())]).is_err());
        let mut damaged = bytes;
        for (at, byte) in changes {
            let at = at.index(damaged.len());
            damaged[at] = byte;
        }
        if let Ok(table) = crate::Table::read(&damaged) {
            let rows = table.select(&crate::Filter::default()).unwrap();
            for row in rows {
                table.cells(row).unwrap();
                prop_assert!(table.copies_of(row).len() < table.rows());
            }
            prop_assert!(table.columns().len() >= 9);
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let head = [&MARK[..], &VERSION.to_le_bytes(), &3u32.to_le_bytes()].concat();
        read(&bytes).ok();
        read(&[head, bytes].concat()).ok();
    }
}

#[test]
fn columns_with_more_rows_than_bytes_are_refused() {
    let bytes = write_columns(&[], &[]).unwrap();
    assert_eq!(read(&bytes).unwrap().row_of.len(), 0);
    for count in [1, 1 << 20, u32::MAX] {
        let mut bytes = bytes.clone();
        bytes[8..12].copy_from_slice(&count.to_le_bytes());
        assert!(read(&bytes).is_err(), "{count}");
    }
    let mut newer = bytes;
    newer[4] = 9;
    assert!(matches!(read(&newer), Err(CorpusError::Version { found: 9, .. })));
}

#[test]
fn texts_of_other_rows_are_refused() {
    let error = write_columns(&[], &[RowTexts::default()]).unwrap_err();
    assert!(matches!(error, CorpusError::Mismatch { found: 1, expected: 0, .. }));
}

#[test]
fn stem_is_that_of_the_table() {
    for (path, expected) in [
        ("a/b.c/walk.bvh", "walk"),
        ("walk.fbx.gz", "walk"),
        ("walk.GZ", "walk"),
        (".bvh", ".bvh"),
        ("noending", "noending"),
        ("a.b.bvh", "a.b"),
        ("ü.bvh", "ü"),
        ("", ""),
    ] {
        assert_eq!(stem(path), expected, "{path}");
    }
}

/// 100,000 clips have at most 3 MB with all that a search reads: 20 bytes a clip are left for this.
#[test]
fn columns_have_few_bytes_a_clip() {
    let mut state = 1u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let (mut poses, mut thumbnails) = (Placer::default(), Placer::default());
    let mut keys: Vec<String> =
        (0..3000).map(|_| format!("{:08x}{:08x}", random() * 2 % (1 << 32), random())).collect();
    keys.sort();
    let (mut rows, mut texts) = (Vec::new(), Vec::new());
    for key in keys {
        let serial = random() % 100_000;
        let frames = 30 + random() % 400;
        let metrics = ["pose_jump_deg", "velocity_jump_dps", "skating_cmps", "spin_deg"]
            .map(|name| (name.to_owned(), Some(((random() % 1000) as f64).powi(2) * 1e-4)));
        rows.push(CorpusRow {
            id: format!("{key}-0"),
            key,
            clip: 0,
            row: ClipRow {
                format: "bvh".to_owned(),
                frames: Some(frames),
                fps: Some(30.0),
                metrics: metrics.into(),
                ..ClipRow::of_file(Status::Ok)
            },
            poses: poses.add(usual_poses_bytes(duration_secs(frames as u32, 30.0))),
            thumbnail: thumbnails.add(400 + random() % 300),
            moments: 10,
            map: Some([0; 2].map(|_| (random() % 1000) as f32 / 500.0 - 1.0)),
            copy_of: None,
            is_mirrored: false,
        });
        let path = format!("subject{:03}/walk_fast_{serial:06}.bvh", serial % 100);
        texts.push(RowTexts { name: stem(&path).to_owned(), path, labels: vec!["walk".into()] });
    }
    let bytes = write_columns(&rows, &texts).unwrap();
    let share = bytes.len() as f64 / rows.len() as f64;
    assert!(share < 20.0, "{share} bytes a clip");
}
