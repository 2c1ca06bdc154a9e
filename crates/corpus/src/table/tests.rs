//! Rows that are chosen, sorted, counted and found.

use super::*;
use crate::{ClipRow, CorpusRow, RowTexts, write_columns};
use proptest::prelude::*;

/// Key, path, own name, labels, skating, and the row of which it is a copy.
type Row =
    (&'static str, &'static str, &'static str, &'static [&'static str], Option<f64>, Option<usize>);

const ROWS: [Row; 6] = [
    ("0000000011", "walks/Slow walk.bvh", "", &["walk", "slow"], Some(3.0), None),
    ("0000000012", "walks/fast.fbx", "Take 1", &["walk"], Some(0.5), None),
    ("10aaaaaaaa", "runs/run.bvh", "", &["run"], Some(20.0), None),
    ("20bbbbbbbb", "runs/again.glb", "", &[], Some(20.0), Some(2)),
    ("30cccccccc", "broken.bvh", "", &[], None, None),
    ("f0dddddddd", "über/Spin.bvh", "", &["run", "spin"], Some(0.0), Some(2)),
];

/// Returns a row without poses, and without a place on the map.
fn row_of(id: String, key: String, row: ClipRow) -> CorpusRow {
    CorpusRow {
        id,
        key,
        clip: 0,
        row,
        poses: None,
        thumbnail: None,
        moments: 0,
        map: None,
        copy_of: None,
        is_mirrored: false,
    }
}

fn table() -> Table {
    let ids: Vec<String> = ROWS.iter().map(|row| format!("{}-0", row.0)).collect();
    let rows: Vec<CorpusRow> = (ROWS.iter().enumerate())
        .map(|(at, (key, path, _, _, skating, copy))| {
            let row = ClipRow {
                format: path.rsplit('.').next().unwrap().to_owned(),
                frames: skating.map(|_| 31 + 30 * at),
                fps: skating.map(|_| 30.0),
                rig: skating.map(|_| ["r1", "r2"][at % 2].to_owned()),
                message: skating.map_or(Some("no clip".to_owned()), |_| None),
                metrics: [("skating_cmps".to_owned(), *skating)].into(),
                ..ClipRow::of_file(skating.map_or(Status::Unreadable, |_| Status::Ok))
            };
            CorpusRow {
                map: skating.map(|_| [0.5, -0.5]),
                copy_of: copy.map(|of| ids[of].clone()),
                is_mirrored: at == 5,
                ..row_of(ids[at].clone(), (*key).to_owned(), row)
            }
        })
        .collect();
    let texts: Vec<RowTexts> = ROWS
        .iter()
        .map(|(_, path, name, labels, ..)| RowTexts {
            path: (*path).to_owned(),
            name: if name.is_empty() { stem(path) } else { name }.to_owned(),
            labels: labels.iter().map(|label| (*label).to_owned()).collect(),
        })
        .collect();
    Table::read(&write_columns(&rows, &texts).unwrap()).unwrap()
}

fn select(filter: &str) -> Vec<u32> {
    table().select(&serde_json::from_str(filter).unwrap()).unwrap()
}

#[test]
fn rows_without_an_order_are_in_that_of_paths() {
    assert_eq!(select("{}"), [4, 3, 2, 0, 1, 5]);
    assert_eq!(select(r#"{"near": [5, 1, 4, 99]}"#), [5, 1, 4]);
    assert_eq!(select(r#"{"near": [5, 1, 4], "sort": {"by": "path"}}"#), [4, 1, 5]);
}

#[test]
fn text_is_searched_in_path_name_and_labels() {
    assert_eq!(select(r#"{"text": "WALK"}"#), [0, 1]);
    assert_eq!(select(r#"{"text": "walk -slow"}"#), [1]);
    assert_eq!(select(r#"{"text": "\"take 1\""}"#), [1]);
    assert_eq!(select(r#"{"text": "Über"}"#), [5]);
    assert_eq!(select(r#"{"text": "-bvh"}"#), [3, 1]);
    assert_eq!(select(r#"{"text": "fbx take"}"#), [1]);
    assert!(select(r#"{"text": "nothing"}"#).is_empty());
}

#[test]
fn range_has_both_ends_and_no_row_without_a_value() {
    assert_eq!(select(r#"{"ranges": {"seconds": [1, 2]}}"#), [0, 1]);
    assert_eq!(select(r#"{"ranges": {"frames": [61, null]}}"#), [3, 2, 1, 5]);
    assert_eq!(select(r#"{"ranges": {"skating_cmps": [null, 0]}}"#), [5]);
    assert_eq!(select(r#"{"ranges": {"skating_cmps": [null, null]}}"#).len(), 6);
    let shown = table().cells(0).unwrap().values["skating_cmps"].unwrap();
    assert!((shown - 3.0).abs() < 0.1, "{shown}");
    assert_eq!(select(&format!(r#"{{"ranges": {{"skating_cmps": [{shown}, {shown}]}}}}"#)), [0]);
}

#[test]
fn choice_is_one_of_its_values() {
    assert_eq!(select(r#"{"choices": {"format": ["bvh"]}}"#), [4, 2, 0, 5]);
    assert_eq!(select(r#"{"choices": {"labels": ["spin", "slow"]}}"#), [0, 5]);
    assert_eq!(select(r#"{"choices": {"labels": []}}"#).len(), 6);
    assert_eq!(select(r#"{"choices": {"status": ["unreadable"]}}"#), [4]);
    let both = r#"{"choices": {"format": ["bvh"], "rig": ["r1"]}, "text": "run"}"#;
    assert_eq!(select(both), [2]);
}

#[test]
fn copies_are_hidden_or_shown_with_their_originals() {
    assert_eq!(select(r#"{"copies": "hide"}"#), [4, 2, 0, 1]);
    assert_eq!(select(r#"{"copies": "only"}"#), [3, 2, 5]);
    let table = table();
    assert_eq!(table.copies_of(2), [3, 5]);
    assert_eq!(table.copies_of(5), [3, 2]);
    assert!(table.copies_of(0).is_empty() && table.copies_of(99).is_empty());
    let cells = [3, 5].map(|row| table.cells(row).unwrap());
    assert_eq!(
        cells.map(|own| (own.copy_of, own.is_mirrored)),
        [(Some(2), Some(false)), (Some(2), Some(true)),]
    );
}

#[test]
fn rows_without_a_value_are_last_in_both_directions() {
    let sorted =
        |by: &str, down: bool| select(&format!(r#"{{"sort": {{"by": "{by}", "down": {down}}}}}"#));
    assert_eq!(sorted("skating_cmps", false), [5, 1, 0, 3, 2, 4]);
    assert_eq!(sorted("skating_cmps", true), [3, 2, 0, 1, 5, 4]);
    assert_eq!(sorted("seconds", true), [5, 3, 2, 1, 0, 4]);
    // again, broken, run, Slow walk, Spin, Take 1
    assert_eq!(sorted("name", false), [3, 4, 2, 0, 5, 1]);
    assert_eq!(sorted("name", true), [1, 5, 0, 2, 4, 3]);
    assert_eq!(sorted("format", false), [4, 2, 0, 5, 1, 3]);
    assert_eq!(sorted("rig", false), [2, 0, 3, 1, 5, 4]);
    assert_eq!(sorted("status", true)[0], 4);
    assert_eq!(sorted("id", false), [0, 1, 2, 3, 4, 5]);
    let labels = sorted("labels", false);
    assert_eq!(&labels[4..], [4, 3]);
}

#[test]
fn column_that_is_none_is_refused() {
    let refused = |filter: &str| {
        let error = table().select(&serde_json::from_str(filter).unwrap()).unwrap_err();
        assert!(matches!(error, CorpusError::NoColumn(_)), "{error}");
    };
    refused(r#"{"ranges": {"format": [0, 1]}}"#);
    refused(r#"{"ranges": {"spin_deg": [0, null]}}"#);
    refused(r#"{"choices": {"seconds": ["1"]}}"#);
    refused(r#"{"sort": {"by": "colour"}}"#);
    assert!(table().histogram("path", &Filter::default(), 3).is_err());
    assert!(serde_json::from_str::<Filter>(r#"{"txet": ""}"#).is_err());
}

#[test]
fn histogram_counts_what_the_other_columns_leave() {
    let table = table();
    let filter = |text: &str| serde_json::from_str::<Filter>(text).unwrap();
    let counts = table
        .histogram("seconds", &filter(r#"{"ranges": {"seconds": [1, 1]}, "copies": "hide"}"#), 2)
        .unwrap();
    assert_eq!(counts.iter().sum::<u32>(), 3);
    let formats = table.columns().into_iter().find(|own| own.name == "format").unwrap();
    assert_eq!(formats.values.unwrap(), ["bvh", "fbx", "glb"]);
    let only = filter(r#"{"choices": {"format": ["fbx"], "rig": ["r1", "r2"]}}"#);
    assert_eq!(table.histogram("format", &only, 0).unwrap(), [3, 1, 1]);
    let labels = table.columns().into_iter().find(|own| own.name == "labels").unwrap();
    assert_eq!(labels.values.unwrap(), ["run", "walk", "slow", "spin"]);
    assert_eq!(table.histogram("labels", &Filter::default(), 1).unwrap(), [2, 2, 1, 1]);
}

#[test]
fn histogram_of_levels_has_no_empty_bins_between_full_ones() {
    let row = |at: usize| {
        let row = ClipRow {
            metrics: [("skating_cmps".to_owned(), Some(at as f64 * 0.01))].into(),
            ..ClipRow::of_file(Status::Ok)
        };
        row_of(format!("{at:08x}-0"), format!("{at:08x}"), row)
    };
    let rows: Vec<CorpusRow> = (0..4000).map(row).collect();
    let texts = vec![RowTexts::default(); 4000];
    let table = Table::read(&write_columns(&rows, &texts).unwrap()).unwrap();
    let counts = table.histogram("skating_cmps", &Filter::default(), 80).unwrap();
    assert_eq!(counts.iter().sum::<u32>(), 4000);
    // 1 % beyond either end are counted there.
    assert!(counts[1..79].iter().all(|count| (35..65).contains(count)), "{counts:?}");
}

#[test]
fn columns_are_described() {
    let columns = table().columns();
    let names: Vec<&str> = columns.iter().map(|own| own.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "name",
            "path",
            "labels",
            "format",
            "rig",
            "status",
            "seconds",
            "frames",
            "fps",
            "skating_cmps"
        ]
    );
    let skating = serde_json::to_value(columns.last().unwrap()).unwrap();
    assert_eq!(skating["label"], "Foot skating");
    assert_eq!((&skating["unit"], &skating["kind"]), (&"cm/s".into(), &"number".into()));
    assert!(
        skating["min"] == 0.0
            && skating["max"].as_f64().unwrap() > 19.0
            && skating.get("values").is_none()
    );
    assert_eq!(serde_json::to_value(&columns[2]).unwrap()["kind"], "choice");
}

#[test]
fn cells_are_those_of_the_row() {
    let table = table();
    let cells = serde_json::to_value(table.cells(1).unwrap()).unwrap();
    assert_eq!(
        (&cells["id"], &cells["name"], &cells["path"], &cells["frames"], &cells["seconds"]),
        (
            &"0000000012-0".into(),
            &"Take 1".into(),
            &"walks/fast.fbx".into(),
            &61.into(),
            &2.0.into()
        )
    );
    assert!(cells.get("message").is_none() && cells.get("copyOf").is_none());
    let broken = serde_json::to_value(table.cells(4).unwrap()).unwrap();
    assert_eq!((&broken["status"], &broken["message"]), (&"unreadable".into(), &"no clip".into()));
    assert_eq!(broken["id"], "30cccccc-0");
    assert!(broken["seconds"].is_null() && broken["values"]["skating_cmps"].is_null());
    assert!(table.cells(6).is_none());
    let map = table.map();
    assert!(map.len() == 12 && (map[0] - 0.5).abs() < 0.005 && map[8].is_nan());
}

#[test]
fn clip_is_found_by_a_beginning_that_is_its_own() {
    let table = table();
    for (id, row) in [
        ("10aaaaaa-0", Some(2)),
        ("10AAAAAA", Some(2)),
        ("1", Some(2)),
        ("10aaaaaaaa1234-0", Some(2)),
        ("10aaaaaa-1", None),
        // Two clips begin with these digits.
        ("00000000", None),
        ("0000000011", Some(0)),
        ("0000000012-0", Some(1)),
        ("", None),
        ("xyz", None),
        ("4", None),
        ("10aaaaaa-", None),
        ("über", None),
        ("f", Some(5)),
    ] {
        assert_eq!(table.find(id), row, "{id}");
    }
    for row in 0..6 {
        assert_eq!(table.find(&table.id(row)), Some(row));
    }
}

proptest! {
    #[test]
    fn histogram_counts_each_selected_row_with_a_value_once(
        bins in 0usize..9, least in prop::option::of(0.0f64..9.0), words in "[-a-z ]{0,4}"
    ) {
        let table = table();
        let ranges = [("skating_cmps".to_owned(), (least, None))].into();
        let filter = Filter { text: words, ranges, ..Filter::default() };
        let rows = table.select(&filter).unwrap();
        let counts = table.histogram("seconds", &filter, bins).unwrap();
        prop_assert_eq!(counts.len(), bins.max(1));
        let known = rows.iter().filter(|row| table.cells(**row).unwrap().seconds.is_some());
        prop_assert_eq!(counts.iter().sum::<u32>() as usize, known.count());
    }
}

proptest! {
    #[test]
    fn values_of_levels_are_those_of_all_rows_in_order(
        values in prop::collection::vec(prop::option::of(-9.0..9.0), 1..8),
        codes in prop::collection::vec(0..10_u8, 0..40),
    ) {
        let coded = Coded {
            name: String::new(),
            label: String::new(),
            unit: String::new(),
            help: String::new(),
            values,
            codes,
        };
        let value = |code: &u8| coded.values.get(usize::from(*code)).copied().flatten();
        let mut expected: Vec<f64> = coded.codes.iter().filter_map(value).collect();
        expected.sort_by(f64::total_cmp);
        let levels = coded.levels();
        let found: Vec<f64> = (0..expected.len()).map(|at| nth_value(&levels, at)).collect();
        prop_assert_eq!(found, expected);
        prop_assert_eq!(levels.iter().map(|level| level.1).sum::<usize>(), coded.codes.iter().filter_map(value).count());
    }
}

#[test]
fn equal_names_keep_the_order_of_paths() {
    let mut rows = vec![];
    let mut texts = vec![];
    for (at, (path, name)) in
        [("c.bvh", "Ärm"), ("b.bvh", "walk"), ("a.bvh", "Walk"), ("d.bvh", "WALK")]
            .into_iter()
            .enumerate()
    {
        let row = ClipRow { format: "bvh".to_owned(), ..ClipRow::of_file(Status::Ok) };
        rows.push(row_of(format!("{at:010}-0"), format!("{at:010}"), row));
        texts.push(RowTexts { path: path.to_owned(), name: name.to_owned(), labels: vec![] });
    }
    let table = Table::read(&write_columns(&rows, &texts).unwrap()).unwrap();
    let sorted = |down: bool| {
        let sort = Some(Sort { by: "name".to_owned(), down });
        table.select(&Filter { sort, ..Filter::default() }).unwrap()
    };
    assert_eq!((sorted(false), sorted(true)), (vec![2, 1, 3, 0], vec![0, 2, 1, 3]));
}
