//! The state of the panel in which many files are converted.

use segue_session::conversion::ConversionRow;
use segue_session::export::ExportOptions;
use std::sync::Arc;

/// The state of the panel in which many files are converted.
#[derive(Clone, Debug, Default)]
pub(crate) struct ConvertState {
    /// Whether it is open: files that are dropped are then for it.
    pub(crate) is_open: bool,
    /// The format and its options.
    pub(crate) export: ExportOptions,
    /// Whether motions are put on the body of A.
    pub(crate) onto_a: bool,
    /// Whether all are saved in one file, in formats that hold several clips.
    pub(crate) in_one_file: bool,
    /// The files and the conversion under way.
    pub(crate) shown: ConvertShown,
}

/// The files of a conversion as the panel shows them.
#[derive(Clone, Debug, Default)]
pub(crate) struct ConvertShown {
    /// The number of files that were added.
    pub(crate) waiting: usize,
    /// The share that is done, 0 to 1, and the numbers of files done and in all; `None` while
    /// nothing is converted.
    pub(crate) progress: Option<(f32, usize, usize)>,
    /// The table so far.
    pub(crate) rows: Arc<Vec<ConversionRow>>,
}
