//! The options of reading files, and progress over them.

use crate::progress;
use clap::Args;
use segue_batch::{
    BatchError, Input, Reader, for_each as batch_for_each, parse_rate, parse_unit, parse_up,
};
use segue_formats::ImportOptions;
use segue_motion::clip::UpAxis;
use std::path::PathBuf;

/// How files are read, where they do not say it or say it wrongly.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Reading")]
pub(crate) struct ReadArgs {
    /// Unit of length in the files: mm, cm, m, in, ft, or metres per unit [default: found]
    #[arg(long, value_name = "UNIT", value_parser = parse_unit)]
    from_unit: Option<f64>,
    /// Up axis in the files: y or z [default: found]
    #[arg(long, value_name = "AXIS", value_parser = parse_up)]
    from_up: Option<UpAxis>,
    /// Frames per second in the files [default: those of the file]
    #[arg(long, value_name = "FPS", value_parser = parse_rate)]
    from_rate: Option<f64>,
    /// Skeleton of AMC files (.asf), or your SMPL model for NPZ files; an ASF file in the folder of
    /// an AMC file is found by itself
    #[arg(long, value_name = "FILE")]
    skeleton: Vec<PathBuf>,
}

impl ReadArgs {
    /// Returns the options of the import.
    pub(crate) fn options(&self) -> ImportOptions {
        ImportOptions {
            metres_per_unit: self.from_unit,
            up: self.from_up,
            fps: self.from_rate,
            ..ImportOptions::default()
        }
    }

    /// Returns the skeletons that are named, with their bytes.
    pub(crate) fn skeletons(&self) -> &[PathBuf] {
        &self.skeleton
    }

    /// Returns a reader of some files, after reading the skeletons.
    ///
    /// # Errors
    /// [`BatchError`] if a skeleton that is named cannot be read.
    pub(crate) fn reader(&self, inputs: &[Input]) -> Result<Reader, BatchError> {
        Reader::new(inputs, self.options(), self.skeletons())
    }
}

/// Does something with every file on all cores, with a progress bar. The results are in the order
/// of the files, without those for which there is none.
pub(crate) fn for_each<T: Send>(
    files: &[Input],
    what: &'static str,
    work: impl Fn(&Input) -> Option<T> + Sync,
) -> Vec<T> {
    let bar = progress::bar(files.len(), what);
    let made = batch_for_each(files, work, || bar.inc(1));
    bar.finish_and_clear();
    made
}
