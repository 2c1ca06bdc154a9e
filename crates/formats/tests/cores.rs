//! BVH files read on all cores, against the same files read on one.
#![cfg(feature = "parallel")]

use segue_formats::bvh::{WriteOptions, read_with_progress, write};
use segue_formats::{ImportOptions, ImportedFile, import};
use segue_motion::synth::{Action, Params, synthesize};
use std::fmt::Write as _;
use std::sync::Once;

/// Makes a pool of four threads, whatever the machine has.
fn four_threads() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        rayon::ThreadPoolBuilder::new().num_threads(4).build_global().expect("the first pool");
    });
}

/// Returns all bits of a file, or the error.
fn bits(text: &[u8]) -> Result<(Vec<u32>, String), String> {
    let file =
        import("a.bvh", text, &ImportOptions::default()).map_err(|error| format!("{error:?}"))?;
    let ImportedFile { clips, warnings } = &file;
    let mut bits = Vec::new();
    for clip in clips.iter().map(|own| &own.clip) {
        for frame in 0..clip.frames() {
            bits.extend(
                clip.rotations(frame).iter().flat_map(glam::Quat::to_array).map(f32::to_bits),
            );
        }
        let tracks = clip.translations().iter().flat_map(|track| &track.values);
        let places = clip.root_translations().iter().chain(tracks);
        bits.extend(places.flat_map(glam::Vec3::to_array).map(f32::to_bits));
    }
    let about =
        clips.iter().map(|own| (own.measure, own.mendable, own.t_pose_dropped, own.clip.fps()));
    Ok((bits, format!("{:?} {warnings:?}", about.collect::<Vec<_>>())))
}

/// Checks that a file is read alike on one thread and on four. Returns the number of values, or the
/// error.
fn check(name: &str, text: &[u8]) -> Result<usize, String> {
    four_threads();
    // On a thread of a pool, a file is left to that thread.
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let alone = one.install(|| bits(text));
    let together = bits(text);
    assert!(alone == together, "{name}: {:?} {:?}", alone.as_ref().err(), together.as_ref().err());
    together.map(|(bits, _)| bits.len())
}

/// Returns head and rows of a walk of some frames, turned by more and more.
fn walk(frames: usize) -> (String, Vec<String>) {
    let clip = synthesize(&Params::new(Action::Walk)).expect("natural parameters").clip;
    let text = write(&clip, &WriteOptions::default());
    let (head, motion) = text.split_once("Frames: ").expect("a header");
    let rows = motion.lines().skip(2).map(str::to_owned);
    let rows: Vec<String> = rows.collect();
    let rows = (0..frames).map(|frame| {
        let own = &rows[frame % rows.len()];
        // No two rows are equal.
        let (first, rest) = own.split_once(' ').expect("more than one channel");
        let first: f64 = first.parse().expect("a number");
        format!("{:.4} {rest}", first + frame as f64 * 0.001)
    });
    (head.to_owned(), rows.collect())
}

fn file(head: &str, frames: &str, rows: &[String], end: &str) -> Vec<u8> {
    let mut text = format!("{head}Frames: {frames}{end}Frame Time: 0.00833333{end}");
    for row in rows {
        write!(text, "{row}{end}").expect("memory");
    }
    text.into_bytes()
}

#[test]
fn files_of_all_sizes_are_read_alike() {
    for frames in [0, 1, 63, 64, 65, 300, 433, 700, 1500, 2500, 5000, 12_000] {
        let (head, rows) = walk(frames);
        for end in ["\n", "\r\n", "\r", "\n\n", "\r\r\n", " \t\n"] {
            let text = file(&head, &frames.to_string(), &rows, end);
            let found = check(&format!("{frames} {end:?}"), &text);
            assert!(found.is_ok(), "{frames} {end:?}: {found:?}");
        }
    }
}

#[test]
fn files_with_odd_rows_are_read_alike() {
    let (head, plain) = walk(4000);
    let width = plain[0].split_whitespace().count();
    let with = |at: usize, word: &str| {
        let mut rows = plain.clone();
        let rest = rows[at].split_once(' ').expect("more than one channel").1.to_owned();
        rows[at] = format!("{word} {rest}");
        rows
    };
    let mut all = 0;
    for at in [0, 10, 64, 65, 66, 500, 1333, 2000, 2001, 3998, 3999] {
        for word in [
            "nan",
            "1e-3",
            "-1.5E+2",
            "1.#IND",
            "12345678.12345678",
            "-0",
            "-0.000000",
            "+7",
            ".5",
            "5.",
            "1e40",
            "40000.5",
            "1e12",
            "# no row\n1",
            "// no row\n1",
            "\n\n\n1",
            "1\t",
            "2-3",
            "x",
            "1,5",
            "1 2",
            "HIERARCHY",
            "1.5\r",
            "0.1234567890123456789",
        ] {
            let rows = with(at, word);
            let text = file(&head, "4000", &rows, "\n");
            all += usize::from(check(&format!("row {at}: {word:?}"), &text).is_ok());
        }
    }
    assert!(all > 100, "{all}");
    // A row that is too short or too long, in the middle and at the end.
    for at in [64, 2000, 3999] {
        for words in [1, width / 2, width - 1, width + 1, 2 * width] {
            let mut rows = plain.clone();
            let own: Vec<&str> = rows[at].split_whitespace().cycle().take(words).collect();
            rows[at] = own.join(" ");
            let found = check(&format!("{words} of {width}"), &file(&head, "4000", &rows, "\n"));
            assert_eq!(found.is_ok(), at == 3999 && words < width, "{at} {words}");
        }
    }
    // Odd rows all over.
    let mut rows = plain.clone();
    for at in (0..rows.len()).step_by(7) {
        rows[at].push_str(" # a comment");
    }
    check("comments", &file(&head, "4000", &rows, "\n")).expect("a clip");
    let turned: Vec<String> = plain.iter().map(|row| row.replace(" 0.0", " 36000.5")).collect();
    check("wild angles", &file(&head, "4000", &turned, "\n")).expect("a clip");
    let commas: Vec<String> = plain.iter().map(|row| row.replace('.', ",")).collect();
    let head = head.replace('.', ",");
    let text = String::from_utf8(file(&head, "4000", &commas, "\n")).expect("text");
    // Some of its numbers have no decimals: it is refused at the same place.
    check("commas", text.replace("0.00833333", "0,00833333").as_bytes()).ok();
}

#[test]
fn files_whose_header_is_wrong_are_read_alike() {
    let (head, rows) = walk(4000);
    for frames in ["0", "1", "64", "2000", "3999", "4001", "4400", "9000", "4000000000", "-5", "x"]
    {
        let found = check(frames, &file(&head, frames, &rows, "\n"));
        assert_eq!(found, check("4000", &file(&head, "4000", &rows, "\n")), "{frames}");
    }
    let blank = ["\n".repeat(300_000), " \n\n".repeat(100), "\0".repeat(9), "\n\n\u{1a}".into()];
    for end in blank {
        let text = [file(&head, "4000", &rows, "\n"), end.into_bytes()].concat();
        check("blank at the end", &text).expect("a clip");
    }
    // Short rows behind long ones, and the reverse: the first ones say how much memory is reserved.
    let short: Vec<String> =
        rows.iter().map(|row| row.replace("0.", ".").replace("00", "")).collect();
    for order in [[&rows, &short], [&short, &rows]] {
        let mixed: Vec<String> = order.into_iter().flatten().cloned().collect();
        let text = file(&head, "x", &mixed, "\n");
        check("mixed", &text).expect("a clip");
    }
}

#[test]
fn files_that_are_cut_are_read_alike() {
    let (head, rows) = walk(3000);
    let text = file(&head, "3000", &rows, "\n");
    for cut in (0..text.len()).step_by(text.len() / 37) {
        check(&format!("cut at {cut}"), &text[..cut]).ok();
    }
}

#[test]
fn files_with_two_characters_and_moving_joints_are_read_alike() {
    const CHANNELS: &str = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let one = |name: &str| {
        format!(
            "ROOT {name}\n{{\nOFFSET 0 90 0\n{CHANNELS}\n\
             JOINT {name}b\n{{\nOFFSET 0 40 0\n{CHANNELS}\nEnd Site\n{{\nOFFSET 0 40 0\n}}\n}}\n}}\n"
        )
    };
    let head = format!("HIERARCHY\n{}{}MOTION\n", one("a"), one("b"));
    let row = |row: usize| {
        let value = |column: usize| format!("{:.3}", ((row * 31 + column * 7) % 1789) as f64 * 0.1);
        (0..24).map(value).collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<String> = (0..9000).map(row).collect();
    for end in ["\n", "\n\n"] {
        let found = check("two characters", &file(&head, "9000", &rows, end)).expect("clips");
        assert_eq!(found, 9000 * 2 * (2 * 4 + 2 * 3));
    }
}

#[test]
fn progress_is_reported_and_stops() {
    four_threads();
    let (head, rows) = walk(5000);
    let text = file(&head, "5000", &rows, "\n");
    let mut seen = Vec::new();
    let read = read_with_progress("a.bvh", &text, &ImportOptions::default(), &mut |done| {
        seen.push(done);
        true
    });
    assert!(read.expect("a clip").is_some());
    assert!(seen.is_sorted() && seen.len() + 1 >= text.len() >> 18, "{seen:?}");
    for most in 0..seen.len() {
        let mut calls = 0;
        let read = read_with_progress("a.bvh", &text, &ImportOptions::default(), &mut |_| {
            calls += 1;
            calls <= most
        });
        assert_eq!(read, Ok(None));
    }
}
