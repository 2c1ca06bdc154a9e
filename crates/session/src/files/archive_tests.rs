//! Tests of archives with several motions.

use super::fixtures::{BVH, stored, zip};
use super::messages::MAX_NAMED;
use crate::fixtures::*;
use segue_formats::archive::MAX_FILES;
use std::io::Write as _;

#[test]
fn archive_brings_all_its_motions() {
    // A zip archive with stored files, written by hand: the crate that reads archives writes none
    // in tests of the core.
    let names = [
        ("take/01.asf", ASF),
        ("take/01_01.amc", AMC),
        ("take/walk.bvh", BVH),
        ("notes.txt", "hello"),
    ];
    let mut session = Session::new();
    let loaded = session.load("takes.zip", Arc::from(zip(&names))).unwrap();
    assert_eq!(loaded.ids.len(), 2, "{loaded:?}");
    assert_eq!(files(&session), [("01_01".to_owned(), "amc", 2), ("walk".to_owned(), "bvh", 2)]);
    assert!(session.notices().list().last().unwrap().text.to_string().contains("2 files"));
    // Files from the archive are stored one by one.
    let mut restored = Session::new();
    restored.restore(&session.saved(), stored(&session), None);
    assert_eq!(files(&restored), files(&session));

    let packed = {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(BVH.as_bytes()).unwrap();
        encoder.finish().unwrap()
    };
    session.load("other.bvh.gz", Arc::from(packed)).unwrap();
    assert!(files(&session).iter().any(|(name, ..)| name == "other"));
    assert!(session.load("cut.zip", Arc::from(&zip(&names)[..200])).is_err());
}

#[test]
fn unreadable_files_of_an_archive_are_counted_in_one_notice() {
    let names: Vec<String> = (0..200).map(|n| format!("{n:03}.bvh")).collect();
    let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
    let mut session = Session::new();
    let loaded = session.load("many.zip", Arc::from(zip(&files))).unwrap();
    let errors: Vec<String> =
        session.notices().errors_since(0).iter().map(|notice| notice.text.to_string()).collect();
    assert_eq!(errors.len(), MAX_NAMED + 1, "{errors:#?}");
    assert_eq!(
        errors[MAX_NAMED],
        "197 more failed: many.zip/003.bvh, many.zip/004.bvh, many.zip/005.bvh, …."
    );
    assert_eq!(loaded.warnings.len(), 200, "the API returns each of them");
}

#[test]
fn limit_of_an_archive_is_reported_even_if_nothing_in_it_can_be_read() {
    let names: Vec<String> = (0..MAX_FILES + 50).map(|n| format!("{n:05}.bvh")).collect();
    let files: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "")).collect();
    let mut session = Session::new();
    session.load("many.zip", Arc::from(zip(&files))).unwrap();
    let told: Vec<String> =
        session.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    assert!(
        told.iter().any(|text| text == "50 motion files of the archive left out: the first 2000 are read."),
        "{told:#?}"
    );
}
