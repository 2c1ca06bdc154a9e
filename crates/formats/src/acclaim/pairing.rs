//! Pairing of motion files with skeleton files.

use super::amc::{first_fault, first_frame};
use super::asf::is_section;
use super::lexer::{Lexer, is_digits};
use super::skeleton::AcclaimSkeleton;
use crate::error::ImportError;
use crate::text::decode;
use crate::{check_not_empty, stem};

/// The number of bytes at the beginning of a file that are read.
const HEAD: usize = 64 << 10;

/// Returns whether the first words are those of a skeleton file: a section such as `:version`.
pub(crate) fn starts_like_asf(text: &[u8]) -> bool {
    is_section(Lexer::new(text).peek())
}

/// Returns whether the first words are those of a motion file: `:FULLY-SPECIFIED` and the like, or
/// a number and the name of a bone.
pub(crate) fn starts_like_amc(text: &[u8]) -> bool {
    let mut lexer = Lexer::new(text);
    let first = lexer.take();
    let headers = [":FULLY-SPECIFIED", ":DEGREES", ":RADIANS"];
    if headers.iter().any(|header| first.eq_ignore_ascii_case(header.as_bytes())) {
        return true;
    }
    let second = lexer.take();
    is_digits(first)
        && second.first().is_some_and(u8::is_ascii_alphabetic)
        && !lexer.peek_in_line().is_empty()
        && lexer.number().is_ok()
}

/// Returns the bones of an AMC file with their numbers of values: those of the first frame, as far
/// as the first 64 KB contain it. Empty for anything else.
#[must_use]
pub fn bone_names(amc_bytes: &[u8]) -> Vec<(String, usize)> {
    first_frame(&decode(amc_bytes.get(..HEAD).unwrap_or(amc_bytes)))
}

/// Checks that an AMC file has a motion, whatever its skeleton: a first frame with the values of a
/// bone. Reads the first 64 KB.
///
/// # Errors
/// [`ImportError`] with the place where that frame should be.
pub fn check_motion(amc_name: &str, amc_bytes: &[u8]) -> Result<(), ImportError> {
    check_not_empty(amc_name, amc_bytes)?;
    let text = decode(amc_bytes.get(..HEAD).unwrap_or(amc_bytes));
    first_fault(&text).map_or(Ok(()), |fault| Err(fault.locate(amc_name, &text)))
}

/// Returns the number of a motion's bones that a skeleton has with as many values, and the number
/// of the motion's bones.
#[must_use]
pub fn matching_bones(amc_bytes: &[u8], skeleton: &AcclaimSkeleton) -> (usize, usize) {
    let bones = bone_names(amc_bytes);
    (fitting(&bones, skeleton), bones.len())
}

fn fitting(bones: &[(String, usize)], skeleton: &AcclaimSkeleton) -> usize {
    let fits = |(name, values): &&(String, usize)| {
        skeleton.find(name).is_some_and(|joint| skeleton.values(joint) == *values)
    };
    bones.iter().filter(fits).count()
}

/// Returns the index of the skeleton to which a motion belongs. `None` if none of them has more
/// than half of the motion's bones.
///
/// The criteria, most important first: the number of bones with the name and the number of values
/// of the skeleton; the file names (equal, or the motion's continues the skeleton's, as `01_01.amc`
/// and `01.asf` of the CMU database); the folder; the number of characters that the names share at
/// the beginning. Of equals the first one is taken.
#[must_use]
pub fn best_skeleton(
    amc_name: &str,
    amc_bytes: &[u8],
    skeletons: &[(&str, &AcclaimSkeleton)],
) -> Option<usize> {
    let bones = bone_names(amc_bytes);
    let ranked = skeletons.iter().enumerate().filter_map(|(index, (asf_name, skeleton))| {
        let fit = fitting(&bones, skeleton);
        let rank = (fit, name_match_score(amc_name, asf_name), std::cmp::Reverse(index));
        (2 * fit > bones.len()).then_some((rank, index))
    });
    ranked.max().map(|(_, index)| index)
}

/// Returns whether the name of a motion file belongs to a skeleton file: the names are equal, or
/// the motion's continues the skeleton's.
#[must_use]
pub fn goes_by_name(amc: &str, asf: &str) -> bool {
    name_match_score(amc, asf).0 > 0
}

/// Scores how well the name of a motion file matches that of a skeleton file; higher is better.
fn name_match_score(amc: &str, asf: &str) -> (u8, usize, usize) {
    let (motion, skeleton) = (stem(amc).to_lowercase(), stem(asf).to_lowercase());
    let same = match motion.strip_prefix(&skeleton) {
        Some("") => 2,
        Some(rest) if !rest.starts_with(char::is_alphanumeric) => 1,
        _ => 0,
    };
    let shared = |a: &str, b: &str| a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count();
    (same, shared_folders(amc, asf), shared(&motion, &skeleton))
}

/// Returns the number of folders that two paths have in common from the top; one more where they
/// are all folders of both.
fn shared_folders(a: &str, b: &str) -> usize {
    let folders = |path: &str| -> Vec<String> {
        let mut parts: Vec<String> = path.split(['/', '\\']).map(str::to_lowercase).collect();
        parts.pop();
        parts
    };
    let (a, b) = (folders(a), folders(b));
    let shared = a.iter().zip(&b).take_while(|(a, b)| a == b).count();
    shared + usize::from(a == b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn best_skeleton_prefers_bones_then_names_then_folders() {
        let ranks = [
            name_match_score("a/walk.amc", "b/WALK.asf"),
            name_match_score("01_01.amc", "x/01.asf"),
            name_match_score("a/b/walk.amc", "a/b/skeleton.asf"),
            name_match_score("a/b/walk.amc", "a/skeleton.asf"),
            name_match_score("a/walking.amc", "b/walk.asf"),
            name_match_score("a/walking.amc", "b/run.asf"),
        ];
        assert!(ranks.is_sorted_by(|a, b| a > b), "{ranks:?}");
        assert_eq!(name_match_score("011_01.amc", "01.asf").0, 0, "not subject 1");
    }

    #[test]
    fn first_words_determine_the_kind() {
        assert!(starts_like_asf(b"# AST/ASF file\r\n:Version 1.10"));
        assert!(!starts_like_asf(b":fully-specified"));
        for text in ["#!OML:ASF x\n:FULLY-SPECIFIED\n", ":degrees", "7\nroot 1 2", "1\nroot (1,"] {
            assert!(starts_like_amc(text.as_bytes()), "{text}");
        }
        for text in ["", "1", "1 2 3", "HIERARCHY", "1\nroot\n2"] {
            assert!(!starts_like_amc(text.as_bytes()), "{text}");
        }
    }

    #[test]
    fn check_motion_without_a_frame_is_refused() {
        for text in [":DEGREES\n1\nroot 1 2 3\n", "# by hand\n:FULLY-SPECIFIED\n7\nroot (1,\n2)\n"]
        {
            assert_eq!(check_motion("a.amc", text.as_bytes()), Ok(()), "{text}");
        }
        for (text, error) in [
            ("", "a.amc:1:1: found an empty file, expected a motion file"),
            (" \n\n", "a.amc:1:1: found an empty file, expected a motion file"),
            (":DEGREES\n", "a.amc:2:1: found the end of the file, expected the number of a frame"),
            ("<html>\n", "a.amc:1:1: found `<html>`, expected the number of a frame"),
            (
                ":DEGREES\n1\n",
                "a.amc:3:1: found the end of the file, expected a bone and its values",
            ),
            ("1\nroot x\n", "a.amc:2:1: found `root`, expected a bone and its values"),
        ] {
            assert_eq!(
                check_motion("a.amc", text.as_bytes()).unwrap_err().to_string(),
                error,
                "{text}"
            );
        }
    }

    #[test]
    fn bone_names_are_those_of_the_first_frame() {
        let text = ":DEGREES\n1\nroot 1 2 nan # x\nhead (4, 5)\n\n2\nroot 1\n";
        assert_eq!(bone_names(text.as_bytes()), [("root".to_owned(), 3), ("head".to_owned(), 2)]);
        assert_eq!(bone_names(b"HIERARCHY ROOT a"), []);
        assert_eq!(bone_names(b""), []);
    }
}
