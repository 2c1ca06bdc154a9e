//! Tests of archives, whole and damaged.

use super::*;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use proptest::prelude::*;
use rawzip::ZipArchiveWriter;
use std::io::Write as _;

/// An archive by another program: see `make.py` beside it.
const TAKES: &[u8] = include_bytes!("../../tests/cases/archive/takes.zip");

fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipArchiveWriter::new(Vec::new());
    for (path, content) in files {
        let file = archive.new_file(rawzip::path::EntryPath::verbatim(path.as_bytes()));
        let (mut entry, config) =
            file.compression_method(CompressionMethod::DEFLATE).start().unwrap();
        let mut writer = config.wrap(DeflateEncoder::new(&mut entry, Compression::best()));
        writer.write_all(content).unwrap();
        let (encoder, descriptor) = writer.finish().unwrap();
        encoder.finish().unwrap();
        entry.finish(descriptor).unwrap();
    }
    archive.finish().unwrap()
}

fn paths(unpacked: &UnpackedArchive) -> Vec<&str> {
    unpacked.files.iter().map(|file| file.path.as_str()).collect()
}

fn sentences(unpacked: &UnpackedArchive) -> Vec<String> {
    unpacked.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn unpack_sorts_motion_and_warns_of_the_rest() {
    let unpacked = unpack("takes.zip", TAKES, &ArchiveLimits::default()).unwrap();
    let expected = [
        "a.zip/inner/jump.amc",
        "back/slash.asf",
        "etc/out.bvh",
        "takes/höhe 目.bvh",
        "takes/packed.bvh",
        "takes/run.BVH",
        "takes/walk.bvh",
    ];
    assert_eq!(paths(&unpacked), expected);
    assert_eq!(unpacked.files[4].bytes, b"HIERARCHY packed");
    assert_eq!(unpacked.files[5].bytes, b"HIERARCHY run");
    assert_eq!(unpacked.files[6].bytes, "HIERARCHY walk ".repeat(20).as_bytes());
    assert_eq!(
        sentences(&unpacked),
        [
            "`a.zip/deeper.zip` in the archive left out: an archive inside an archive inside this one",
            "1 file of the archive without motion left out",
            "2 hidden files of the archive left out",
            "2 files of the archive with a path that leads out of it; the rest of the path was used",
        ]
    );
}

#[test]
fn unpack_of_a_damaged_file_reads_the_others() {
    let whole = zip(&[("good.bvh", b"HIERARCHY good"), ("torn.bvh", &[b'x'; 400])]);
    let at = |pattern: &[u8], from: usize| {
        from + whole[from..].windows(pattern.len()).position(|w| w == pattern).unwrap()
    };
    let directory = at(b"PK\x01\x02", 0);
    let torn = at(b"torn.bvh", directory) - 46;
    // The flags, the method, the check sum and the size of the second file, as the list of files
    // gives them.
    for (offset, value, why) in [
        (8, 0x01, "it is encrypted"),
        (10, 99, "it is packed with AES"),
        (16, 0x55, "it is damaged (Invalid checksum"),
        (24, 0x55, "it is damaged (Invalid size"),
        (20, 0x02, "it is damaged ("),
        (42, 0xff, "it is damaged ("),
    ] {
        let mut bytes = whole.clone();
        bytes[torn + offset] = value;
        let unpacked = unpack("a.zip", &bytes, &ArchiveLimits::default()).unwrap();
        assert_eq!(paths(&unpacked), ["good.bvh"], "{why}");
        assert!(
            sentences(&unpacked)[0]
                .starts_with(&format!("`torn.bvh` in the archive left out: {why}")),
            "{:?}",
            sentences(&unpacked)
        );
    }
}

#[test]
fn unpack_without_motion_is_refused() {
    let say =
        |bytes: &[u8]| unpack("a.zip", bytes, &ArchiveLimits::default()).unwrap_err().to_string();
    assert_eq!(say(b"HIERARCHY"), "a.zip:1:1: found no zip archive, expected a zip archive");
    assert!(
        say(&TAKES[..TAKES.len() / 2])
            .contains("found a zip archive without an end: it was cut off")
    );
    assert!(say(&zip(&[])).contains("found an archive without motion files"));
    assert!(say(&zip(&[("a.png", b"x")])).contains("expected motion files (.bvh"));
    let mut encrypted = zip(&[("a.bvh", b"x")]);
    let directory = encrypted.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
    encrypted[directory + 8] |= 1;
    assert!(say(&encrypted).contains("found `a.bvh` in the archive left out: it is encrypted"));
    assert!(is_zip(TAKES) && is_zip(&zip(&[])) && !is_zip(b"HIERARCHY"));
}

#[test]
fn unpack_of_a_bomb_is_refused() {
    let limits = ArchiveLimits { max_bytes: 3 << 20, ..ArchiveLimits::default() };
    let megabyte = vec![b' '; 1 << 20];
    let three = zip(&[
        ("1.bvh", &megabyte),
        ("2.bvh", &megabyte),
        ("3.bvh", &megabyte),
        ("4.txt", &megabyte),
    ]);
    assert!(three.len() < 1 << 14);
    assert_eq!(unpack("a.zip", &three, &limits).unwrap().files.len(), 3);
    let four =
        zip(&[("1.bvh", &megabyte), ("2.bvh", &megabyte), ("3.bvh", &megabyte), ("4.bvh", b" ")]);
    let error = unpack("a.zip", &four, &limits).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.zip:1:1: found more than 3 MB after unpacking, expected at most 3 MB"
    );
    let nested = zip(&[("in.zip", &four)]);
    assert!(unpack("a.zip", &nested, &limits).is_err());
}

#[test]
fn unpack_of_too_many_files_warns_once() {
    let files: Vec<(String, &[u8])> =
        (0..MAX_FILES + 50).map(|n| (format!("{n}.bvh"), &b""[..])).collect();
    let files: Vec<(&str, &[u8])> =
        files.iter().map(|(path, bytes)| (path.as_str(), *bytes)).collect();
    let unpacked = unpack("a.zip", &zip(&files), &ArchiveLimits::default()).unwrap();
    assert_eq!(unpacked.files.len(), MAX_FILES);
    let said: Vec<String> = unpacked.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(said, ["50 motion files of the archive left out: the first 2000 are read"]);
}

#[test]
fn unpack_keeps_paths_inside() {
    for (path, expected, leads_out) in [
        ("a/b.bvh", "a/b.bvh", false),
        ("./a//b.bvh", "a/b.bvh", false),
        ("a\\b.bvh", "a/b.bvh", false),
        ("/a.bvh", "a.bvh", true),
        ("\\\\host\\a.bvh", "host/a.bvh", true),
        ("a/../../b.bvh", "a/b.bvh", true),
        ("c:\\a.bvh", "a.bvh", true),
        ("..", "", true),
    ] {
        assert_eq!(sanitized_path(path), (expected.to_owned(), leads_out), "{path}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn unpack_of_damaged_bytes_reads_or_refuses(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = TAKES.to_vec();
        for (at, value) in &edits {
            let at = at.index(bytes.len());
            bytes[at] = *value;
        }
        bytes
            .truncate(bytes.len() - cut.index(bytes.len()) / 8 * usize::from(edits.len() % 3 == 0));
        let limits = ArchiveLimits { max_bytes: 1 << 20, ..ArchiveLimits::default() };
        if let Ok(unpacked) = unpack("spoilt.zip", &bytes, &limits) {
            prop_assert!(!unpacked.files.is_empty());
            prop_assert!(
                unpacked.files.iter().map(|file| file.bytes.len()).sum::<usize>()
                    <= limits.max_bytes
            );
            prop_assert!(unpacked.files.is_sorted_by(|a, b| a.path <= b.path));
            prop_assert!(
                unpacked
                    .files
                    .iter()
                    .all(|file| file.path.split('/').all(|part| !part.is_empty() && part != ".."))
            );
        }
    }
}

#[test]
fn unpack_without_memory_is_refused() {
    let mut unpacking = Unpacker {
        name: "all.zip",
        left: 1,
        limits: ArchiveLimits::default(),
        files: Vec::new(),
        motions: 0,
        images: 0,
        takes_images: false,
        tally: Tally::default(),
    };
    let damaged = io::Error::new(io::ErrorKind::InvalidData, "a bad block");
    assert_eq!(unpacking.handle_failure("a.bvh", damaged.into()), Ok(()));
    let refused = unpacking
        .handle_failure("b.bvh", io::Error::from(io::ErrorKind::OutOfMemory).into())
        .unwrap_err();
    assert_eq!(refused.file, "all.zip");
    assert!(refused.found.to_string().contains("memory"), "{refused}");
    let left_out = unpacking.tally.into_warnings(b"");
    assert_eq!(left_out.len(), 1, "{left_out:?}");
}

#[test]
fn images_are_unpacked_beside_scenes_alone() {
    let files: [(&str, &[u8]); 4] = [
        ("body/textures/skin.PNG", b"png"),
        ("body/walk.fbx", b"fbx"),
        ("notes.txt", b"txt"),
        ("inner.zip", &zip(&[("face.jpeg", b"jpeg"), ("b.bvh", b"bvh")])),
    ];
    let with_scene = unpack("a.zip", &zip(&files), &ArchiveLimits::default()).unwrap();
    assert_eq!(
        paths(&with_scene),
        ["body/textures/skin.PNG", "body/walk.fbx", "inner.zip/b.bvh", "inner.zip/face.jpeg"]
    );
    assert_eq!(sentences(&with_scene), ["1 file of the archive without motion left out"]);
    let without = unpack("a.zip", &zip(&files[3..]), &ArchiveLimits::default()).unwrap();
    assert_eq!(paths(&without), ["inner.zip/b.bvh"]);
    // Images do not count as motions.
    let limits = ArchiveLimits { max_files: 1, ..ArchiveLimits::default() };
    let limited = unpack("a.zip", &zip(&files[..2]), &limits).unwrap();
    assert_eq!(paths(&limited), ["body/textures/skin.PNG", "body/walk.fbx"]);
    let error = unpack("a.zip", &zip(&[("a.png", b"png")]), &ArchiveLimits::default());
    assert!(error.unwrap_err().to_string().contains("an archive without motion files"));
}
