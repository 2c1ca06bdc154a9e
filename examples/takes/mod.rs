//! The clips of a folder, as the programs that measure read them.

use segue::session::{Command, Session};
use std::error::Error;
use std::fmt::Display;
use std::fs;
use std::path::Path;

fn at(path: &Path, error: &impl Display) -> String {
    format!("{}: {error}", path.display())
}

/// A session with the clips of a folder in its library, and their ids: BVH files, and AMC files with the ASF file beside them; those whose file names
/// `wanted` picks.
///
/// # Errors
/// When the folder or a file cannot be read.
pub fn session_of_folder(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<(Session, Vec<String>), Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| at(folder, &error))? {
        let path = entry?.path();
        let part = |part: Option<&std::ffi::OsStr>| part.unwrap_or_default().to_string_lossy().to_lowercase();
        let (kind, name) = (part(path.extension()), part(path.file_name()));
        if kind == "asf" || ["amc", "bvh"].contains(&kind.as_str()) && wanted(&name) {
            // Skeletons come before their motions.
            files.push((kind != "asf", name, path));
        }
    }
    files.sort();
    let (mut session, mut ids) = (Session::new(), Vec::new());
    session.apply(Command::OpenLink("lab=view".to_owned()))?;
    for (is_motion, name, path) in files {
        let bytes = fs::read(&path).map_err(|error| at(&path, &error))?;
        let loaded = session.load(&name, bytes.into())?;
        ids.extend(loaded.ids.into_iter().filter(|_| is_motion));
    }
    Ok((session, ids))
}
