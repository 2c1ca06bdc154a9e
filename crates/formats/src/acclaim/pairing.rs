use super::amc::{first_fault, first_frame};
use super::asf::is_section;
use super::lexer::{Lexer, is_digits};
use super::skeleton::AcclaimSkeleton;
use crate::error::ImportError;
use crate::text::decode;
use crate::{check_not_empty, stem};

/// Bytes at the beginning of a file that are looked at.
const HEAD: usize = 64 << 10;

/// Whether the first words are those of a skeleton file: a section such as `:version`.
pub(crate) fn starts_like_asf(text: &[u8]) -> bool {
    is_section(Lexer::new(text).peek())
}

/// Whether the first words are those of a motion file: `:FULLY-SPECIFIED` and the like, or a number
/// and the name of a bone.
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

/// The bones of an AMC file and how many values each has: those of the first frame, as far as the
/// first 64 KB hold it. Empty for anything else.
#[must_use]
pub fn bone_names(amc_bytes: &[u8]) -> Vec<(String, usize)> {
    first_frame(&decode(amc_bytes.get(..HEAD).unwrap_or(amc_bytes)))
}

/// Whether an AMC file has a motion at all, whatever its skeleton: a first frame with the values of
/// a bone. Looks at the first 64 KB.
///
/// # Errors
/// [`ImportError`] with the place where that frame should be.
pub fn check_motion(amc_name: &str, amc_bytes: &[u8]) -> Result<(), ImportError> {
    check_not_empty(amc_name, amc_bytes)?;
    let text = decode(amc_bytes.get(..HEAD).unwrap_or(amc_bytes));
    first_fault(&text).map_or(Ok(()), |fault| Err(fault.locate(amc_name, &text)))
}

/// How many bones of a motion a skeleton has with as many values, and how many bones the motion
/// has.
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

/// Which of several skeletons a motion belongs to, by index. `None` where it has half of the
/// motion's bones or fewer for none of them.
///
/// What counts, most important first: how many bones have the name and the number of values that
/// the skeleton says; the file names (equal, or the motion's goes on after the skeleton's, as
/// `01_01.amc` and `01.asf` of the CMU database); the folder; how many letters the names share at
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
        let rank = (fit, kinship(amc_name, asf_name), std::cmp::Reverse(index));
        (2 * fit > bones.len()).then_some((rank, index))
    });
    ranked.max().map(|(_, index)| index)
}

/// Whether the name of a motion file says that it belongs to a skeleton file: they are called the
/// same, or the motion's goes on after the skeleton's.
#[must_use]
pub fn goes_by_name(amc: &str, asf: &str) -> bool {
    kinship(amc, asf).0 > 0
}

/// How much the name of a motion file says that it belongs to a skeleton file; more is more.
fn kinship(amc: &str, asf: &str) -> (u8, usize, usize) {
    let (motion, skeleton) = (stem(amc).to_lowercase(), stem(asf).to_lowercase());
    let same = match motion.strip_prefix(&skeleton) {
        Some("") => 2,
        Some(rest) if !rest.starts_with(char::is_alphanumeric) => 1,
        _ => 0,
    };
    let shared = |a: &str, b: &str| a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count();
    (same, shared_folders(amc, asf), shared(&motion, &skeleton))
}

/// The number of folders that two paths have in common from the top; one more where they are all
/// folders of both.
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
    fn names_tell_in_this_order() {
        let ranks = [
            kinship("a/walk.amc", "b/WALK.asf"),
            kinship("01_01.amc", "x/01.asf"),
            kinship("a/b/walk.amc", "a/b/skeleton.asf"),
            kinship("a/b/walk.amc", "a/skeleton.asf"),
            kinship("a/walking.amc", "b/walk.asf"),
            kinship("a/walking.amc", "b/run.asf"),
        ];
        assert!(ranks.is_sorted_by(|a, b| a > b), "{ranks:?}");
        assert_eq!(kinship("011_01.amc", "01.asf").0, 0, "not subject 1");
    }

    #[test]
    fn the_first_words_tell_the_kind() {
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
    fn a_file_without_a_frame_is_no_motion() {
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
    fn the_first_frame_tells_the_bones() {
        let text = ":DEGREES\n1\nroot 1 2 nan # x\nhead (4, 5)\n\n2\nroot 1\n";
        assert_eq!(bone_names(text.as_bytes()), [("root".to_owned(), 3), ("head".to_owned(), 2)]);
        assert_eq!(bone_names(b"HIERARCHY ROOT a"), []);
        assert_eq!(bone_names(b""), []);
    }
}
