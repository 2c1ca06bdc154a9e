//! Damaged files: no file makes the readers panic, or takes more than linear time.

use super::{ASF, amc, skeleton_of};
use proptest::prelude::*;
use segue_formats::acclaim::{self, AcclaimSkeleton, best_skeleton, read_motion};
use segue_formats::{ImportOptions, ImportWarning};

/// Inserts, removes, doubles and swaps bytes.
fn damage(bytes: &mut Vec<u8>, edits: &[(prop::sample::Index, u8, u8, prop::sample::Index)]) {
    const PIECES: [&[u8]; 16] = [
        b"begin\n",
        b"end\n",
        b"\n",
        b" nan ",
        b"-",
        b"1e999",
        b",",
        b"#",
        b"\0",
        b":root\n",
        b":hierarchy\n",
        b"dof rx tx l\n",
        b"4000000000\n",
        b"1.#IND",
        b"root ",
        b"thigh ",
    ];
    for (at, kind, byte, other) in edits {
        if bytes.is_empty() {
            return;
        }
        let (at, other) = (at.index(bytes.len()), other.index(bytes.len()));
        match kind {
            0 => bytes[at] = *byte,
            1 => bytes.truncate(at),
            2 => drop(bytes.drain(at.min(other)..at.max(other))),
            3 => drop(
                bytes.splice(at..at, PIECES[usize::from(*byte) % PIECES.len()].iter().copied()),
            ),
            4 => bytes.swap(at, other),
            _ => {
                let copy = bytes[at.min(other)..at.max(other)].to_vec();
                drop(bytes.splice(at..at, copy));
            }
        }
    }
}

fn edits() -> impl Strategy<Value = Vec<(prop::sample::Index, u8, u8, prop::sample::Index)>> {
    prop::collection::vec(
        (any::<prop::sample::Index>(), 0..6_u8, any::<u8>(), any::<prop::sample::Index>()),
        0..6,
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn damaged_files_are_read_or_refused(of_skeleton in edits(), of_motion in edits()) {
        let (mut asf, mut motion) = (ASF.as_bytes().to_vec(), amc(4).into_bytes());
        damage(&mut asf, &of_skeleton);
        damage(&mut motion, &of_motion);
        let plain = skeleton_of(ASF).unwrap();
        let spoilt = skeleton_of(&asf);
        let skeletons: Vec<(&str, &AcclaimSkeleton)> =
            [("a.asf", Some(&plain)), ("b.asf", spoilt.as_ref().ok())]
                .into_iter()
                .filter_map(|(name, skeleton)| Some((name, skeleton?)))
                .collect();
        prop_assert!(
            best_skeleton("c.amc", &motion, &skeletons).is_none_or(|best| best < skeletons.len())
        );
        let alone = spoilt
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|skeleton| acclaim::skeleton_clip(skeleton, &ImportOptions::default()));
        let read = skeletons.iter().map(|(_, skeleton)| {
            read_motion("c.amc", &motion, skeleton, &ImportOptions::default())
        });
        for result in read.chain([alone]) {
            match result {
                Ok(imported) => {
                    let clip = &imported.clips[0].clip;
                    prop_assert!(
                        (0..clip.frames())
                            .all(|frame| clip.rotations(frame).iter().all(|q| q.is_normalized()))
                    );
                    prop_assert!(clip.root_translations().iter().all(|p| p.is_finite()));
                    let is_one_line =
                        |warning: &ImportWarning| !warning.to_string().contains('\n');
                    prop_assert!(imported.warnings.iter().all(|warning| warning.count > 0));
                    prop_assert!(imported.warnings.iter().all(is_one_line));
                }
                Err(error) => prop_assert!(
                    error.line >= 1 && error.column >= 1 && !error.to_string().contains('\n'),
                    "{}",
                    error
                ),
            }
        }
    }
}

#[test]
fn long_runs_of_anything_are_read_in_linear_time() {
    let skeleton = skeleton_of(ASF).unwrap();
    let big = 500_000;
    let start = std::time::Instant::now();
    let names = (0..big / 10).map(|i| format!("n{i} 1\n")).collect::<Vec<_>>().concat();
    for piece in [
        "1\n",
        "1 ",
        "root ",
        "1\nroot 1 2 3 4 5 6 ",
        "nan ",
        "1-1",
        "(",
        "#",
        "#\n",
        ":",
        "x",
        "1\nx 1 2\n",
        "1,5 ",
    ] {
        for head in ["", "1\nroot 1 2 3 4 5 6\n", "1\nroot "] {
            let text = format!("{head}{}", piece.repeat(big / piece.len()));
            drop(read_motion("long.amc", text.as_bytes(), &skeleton, &ImportOptions::default()));
        }
    }
    drop(read_motion(
        "long.amc",
        format!("1\nroot 1 2 3 4 5 6\n{names}").as_bytes(),
        &skeleton,
        &ImportOptions::default(),
    ));
    for piece in [
        ":",
        ":root\n",
        ":units length ",
        "begin ",
        "end ",
        "begin name a end\n",
        "dof rx ",
        "a b\n",
        "root a\n",
        "1 ",
        "#",
        "(",
    ] {
        for head in
            ["", ":root\n", ":bonedata\n", ":bonedata\nbegin\n", ":hierarchy\n", ":documentation\n"]
        {
            assert!(skeleton_of(format!("{head}{}", piece.repeat(big / piece.len()))).is_err());
        }
    }
    // Many bones, and frames without values for them.
    let bones =
        (0..big / 20).map(|i| format!("begin name b{i} dof rx end\n")).collect::<Vec<_>>().concat();
    let list: Vec<String> = (0..big / 20).map(|i| format!("b{i}")).collect();
    let crowd =
        skeleton_of(format!(":root\n:bonedata\n{bones}:hierarchy\nroot {}\n", list.join(" ")))
            .unwrap();
    let text = format!("1\nroot 1 2 3 4 5 6\n{}", "1\n".repeat(big / 2));
    let error =
        read_motion("crowd.amc", text.as_bytes(), &crowd, &ImportOptions::default()).unwrap_err();
    assert!(error.found.to_string().contains("bones without values"), "{error}");
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}
