//! The options of writing files, and the places where they are written.

use crate::status::Failure;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use segue_batch::{Input, parse_rate, parse_root, parse_unit, parse_up, shown};
use segue_motion::clip::UpAxis;
use segue_session::export::{ExportBody, ExportFormat, ExportOptions, ExportRoot, file_name};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// How a motion is written.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Writing")]
pub(crate) struct WriteArgs {
    /// Format; without it, the ending of OUT decides (g1 is the table of a Unitree G1's hinges)
    #[arg(long, value_name = "FORMAT", value_parser = format_parser())]
    pub(crate) to: Option<ExportFormat>,
    /// Unit of length in BVH and FBX: mm, cm, m, in, ft, or metres per unit [default: that of the
    /// file, cm in FBX]
    #[arg(long, value_name = "UNIT", value_parser = parse_unit)]
    unit: Option<f64>,
    /// Up axis in BVH and FBX: y or z [default: that of the file, y in FBX]
    #[arg(long, value_name = "AXIS", value_parser = parse_up)]
    up: Option<UpAxis>,
    /// Frames per second; the motion is interpolated [default: those of the clip]
    #[arg(long, value_name = "FPS", value_parser = parse_rate)]
    rate: Option<f64>,
    /// Joint that has the motion over the ground: as-is, ground (a root bone on the ground, in BVH,
    /// FBX, GLB and NPZ) or in-place (none) [default: as-is]
    #[arg(long, value_name = "ROOT", value_parser = parse_root)]
    root: Option<ExportRoot>,
    /// Writes a GLB with a plain body, not with the mesh of the file
    #[arg(long)]
    plain_body: bool,
}

/// Returns the parser of a format's name.
fn format_parser() -> impl clap::builder::TypedValueParser<Value = ExportFormat> {
    PossibleValuesParser::new(ExportFormat::ALL.map(ExportFormat::name))
        .map(|name| ExportFormat::from_name(&name).unwrap_or_default())
}

impl WriteArgs {
    /// Returns the options of an export to a path.
    ///
    /// # Errors
    /// [`Failure`] if neither the options nor the ending say the format.
    pub(crate) fn options(&self, out: Option<&Path>) -> Result<ExportOptions, Failure> {
        let ending = || ExportFormat::from_ending(out?.extension()?.to_str()?);
        let names = ExportFormat::ALL.map(ExportFormat::name).join(", ");
        let format = self.to.or_else(ending).ok_or_else(|| {
            Failure::usage(format!(
                "the format is not known: end OUT in it, as in out.glb, or name it by --to ({names})"
            ))
        })?;
        Ok(ExportOptions {
            format,
            metres_per_unit: self.unit,
            up: self.up,
            rotation_order: None,
            fps: self.rate,
            body: if self.plain_body { ExportBody::Plain } else { ExportBody::Character },
            root: self.root.unwrap_or_default(),
        })
    }

    /// Returns whether a path names a single file: it ends in a format, or in the one asked for.
    pub(crate) fn is_file(&self, out: &Path) -> bool {
        let name = out.to_string_lossy();
        !out.is_dir()
            && !name.ends_with(['/', std::path::MAIN_SEPARATOR])
            && out.extension().is_some()
            && self.options(Some(out)).is_ok()
    }
}

/// The files of a run: one that is named, or those in a folder. No input is overwritten, nor a file
/// twice.
#[derive(Debug)]
pub(crate) struct Outputs {
    folder: Option<PathBuf>,
    file: Option<PathBuf>,
    inputs: BTreeSet<PathBuf>,
    /// The paths that were written, in lower case, which some systems do not tell apart.
    taken: BTreeSet<String>,
}

impl Outputs {
    /// Returns the outputs of a path.
    pub(crate) fn new(out: &Path, is_file: bool, inputs: &[Input]) -> Self {
        let whole = |input: &Input| fs::canonicalize(&input.path).ok();
        Self {
            folder: (!is_file).then(|| out.to_owned()),
            file: is_file.then(|| out.to_owned()),
            inputs: inputs.iter().filter_map(whole).collect(),
            taken: BTreeSet::new(),
        }
    }

    /// Writes a file. `relative` is its path in the folder without its ending, by which it is named
    /// if no file is. Returns its path.
    ///
    /// # Errors
    /// A sentence that says why it cannot be written.
    pub(crate) fn write(
        &mut self,
        relative: &Path,
        ending: &str,
        bytes: &[u8],
    ) -> Result<PathBuf, String> {
        let path = match (&self.file, &self.folder) {
            (Some(file), _) => file.clone(),
            (None, folder) => self.free_path(folder.as_deref(), relative, ending),
        };
        if !self.taken.insert(path.to_string_lossy().to_lowercase()) {
            return Err(format!("{} would be written twice: name a folder", shown(&path)));
        }
        if fs::canonicalize(&path).is_ok_and(|whole| self.inputs.contains(&whole)) {
            return Err(format!("{} is an input, and is left as it is", shown(&path)));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::write(&path, bytes))
            .map_err(|error| format!("{} cannot be written: {error}", shown(&path)))?;
        Ok(path)
    }

    /// Returns a path in the folder that has not been written yet.
    fn free_path(&self, folder: Option<&Path>, relative: &Path, ending: &str) -> PathBuf {
        let folder = folder.unwrap_or(Path::new(""));
        let parent = relative.parent().unwrap_or(Path::new(""));
        let stem = relative.file_name().unwrap_or_default().to_string_lossy();
        let named = |stem: String| folder.join(parent).join(file_name(&stem, ending));
        let is_free = |path: &PathBuf| !self.taken.contains(&path.to_string_lossy().to_lowercase());
        let first = named(stem.clone().into_owned());
        if is_free(&first) {
            return first;
        }
        let more = (2..).map(|number: u32| named(format!("{stem} {number}")));
        more.into_iter().find(is_free).unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn format_is_named_or_that_of_the_ending() {
        let args = WriteArgs::default();
        let format = |args: &WriteArgs, out: &str| {
            args.options(Some(Path::new(out))).map(|options| options.format).ok()
        };
        assert_eq!(format(&args, "x/out.GLB"), Some(ExportFormat::Glb));
        assert_eq!(format(&args, "out.csv"), Some(ExportFormat::Csv));
        // The name of a format that is no ending of files.
        assert_eq!((format(&args, "out.g1"), format(&args, "out")), (None, None));
        let robot = WriteArgs { to: Some(ExportFormat::G1Csv), ..WriteArgs::default() };
        assert_eq!(format(&robot, "out"), Some(ExportFormat::G1Csv));
        assert!(args.is_file(Path::new("out.bvh")) && !args.is_file(Path::new("out.bvh/")));
        assert!(!robot.is_file(Path::new("out")) && robot.is_file(Path::new("out.csv")));
    }

    #[test]
    fn outputs_of_one_name_are_numbered() {
        let folder = std::env::temp_dir().join(format!("segue-cli-{}-out", std::process::id()));
        let mut outputs = Outputs::new(&folder, false, &[]);
        let mut write = |stem: &str| {
            let path = outputs.write(Path::new(stem), "bvh", b"x").unwrap();
            shown(path.strip_prefix(&folder).unwrap())
        };
        let paths = ["a/Walk", "a/walk", "走路", "a/walk"].map(&mut write);
        assert_eq!(paths, ["a/Walk.bvh", "a/walk 2.bvh", "走路.bvh", "a/walk 3.bvh"]);
        let file = folder.join("one.bvh");
        let mut one = Outputs::new(&file, true, &[]);
        assert_eq!(one.write(Path::new("x"), "bvh", b"x"), Ok(file));
        assert!(one.write(Path::new("y"), "bvh", b"x").unwrap_err().contains("twice"));
        fs::remove_dir_all(folder).unwrap();
    }
}
