//! The files that are read: names and limits, and the notices about files that are not.

use segue_formats::{ARCHIVE_ENDINGS, MOTION_ENDINGS};
use segue_text::{Message, msg};

/// The largest file that is read, bytes. A motion file of that size holds days; a larger one would
/// only fill the memory.
pub(super) const MAX_FILE_BYTES: u64 = 512 * 1024 * 1024;

/// Returns the endings of motion files and archives. Of a folder, only these are read; a file that
/// is dropped by itself is examined whatever its name.
pub(super) fn endings() -> Vec<&'static str> {
    [&MOTION_ENDINGS[..], &ARCHIVE_ENDINGS].concat()
}

/// Returns the refusal of a file with more than `max` bytes; `None` for a smaller one.
pub(super) fn too_large(name: &str, bytes: u64, max: u64) -> Option<Message> {
    (bytes > max).then(|| {
        let in_words = |bytes: u64| match bytes.div_ceil(1024) {
            size @ ..1024 => msg!("{size} KB", size),
            size => msg!("{size} MB", size = size.div_ceil(1024)),
        };
        let (size, most) = (in_words(bytes), in_words(max));
        msg!(
            "{name} has {size}; files of up to {most} are read.",
            name = name.to_owned(),
            size,
            most
        )
    })
}

/// Returns whether a file of a folder is read. Hidden files are not: those that macOS adds beside
/// others have the same endings.
pub(super) fn is_motion_file(name: &str) -> bool {
    let known = |own: &str| endings().iter().any(|ending| own.eq_ignore_ascii_case(ending));
    !name.starts_with('.') && name.rsplit_once('.').is_some_and(|(_, own)| known(own))
}

/// Returns the notice about a folder without motion files.
pub(super) fn no_motion_in(folder: &str) -> Message {
    let endings: Vec<String> = endings().iter().map(|ending| format!(".{ending}")).collect();
    msg!("{folder} has no motion files ({endings}).", folder = folder.to_owned(), endings)
}

/// Returns the first few of several names, and the number of the others:
/// `a.bvh, b.bvh, c.bvh and 12 more`.
#[cfg(any(test, target_arch = "wasm32"))]
pub(super) fn abbreviated(names: &[String]) -> Message {
    const MAX_NAMES: usize = 3;
    let first: Vec<String> = names.iter().take(MAX_NAMES).cloned().collect();
    match names.len().saturating_sub(MAX_NAMES) {
        0 => msg!("{names}", names = first),
        more => msg!("{names} and {more} more", names = first, more),
    }
}

/// Returns the name of a file without the folders before it.
pub(super) fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn abbreviated_names_beyond_three_are_counted() {
        let names: Vec<String> = ["a", "b", "c", "d", "e"].map(str::to_owned).into();
        assert_eq!(
            [abbreviated(&names[..3]), abbreviated(&names)].map(|text| text.to_string()),
            ["a, b, c", "a, b, c and 2 more"]
        );
    }

    #[test]
    fn motion_files_are_known_by_their_ending() {
        assert!(["a.bvh", "A.BVH", "x.tar.gz", "01.AMC"].into_iter().all(is_motion_file));
        assert!(
            ![".bvh", "._a.bvh", "bvh", "notes.txt", "a.bvh.bak", ""]
                .into_iter()
                .any(is_motion_file)
        );
    }
}
