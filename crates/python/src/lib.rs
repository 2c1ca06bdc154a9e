//! `import segue`: motion files as `NumPy` arrays, and Segue's labs for scripts.
//!
//! The package is `python/segue/`; this crate is its module `_core`. Everything that computes lies
//! below: reading and driving in `segue-batch`, corpora in `segue-corpus`, labs in `segue-session`,
//! formats and motion in the core. Here are conversions between those and Python, without the
//! interpreter's lock wherever something takes time.

#![expect(clippy::needless_pass_by_value, reason = "arguments from Python come by value")]

mod arrays;
mod clip;
mod cores;
mod corpus;
mod errors;
mod graph;
mod labs;
mod load;
mod matching;
mod metrics;
mod origin;
mod save;
mod words;

use mimalloc::MiMalloc;
use pyo3::prelude::*;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The compiled part of `segue`.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::clip::Clip;
    #[pymodule_export]
    use super::corpus::{
        CorpusGatherer, CorpusIndex, corpus_clip, corpus_columns, corpus_endings, corpus_failure,
        corpus_format, corpus_key, corpus_parts, corpus_query, corpus_record,
    };
    #[pymodule_export]
    use super::graph::{Graph, distance_matrix, graph};
    #[pymodule_export]
    use super::labs::{LabResult, builtin, builtins, make, make_each, open_link, query};
    #[pymodule_export]
    use super::load::{find_files, load_each, read_bytes};
    #[pymodule_export]
    use super::matching::{Matches, match_database};
    #[pymodule_export]
    use super::metrics::{metric_rows, metrics_of, parameter_rows};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        super::cores::note_process();
        module.add("PAGE", segue_batch::PAGE)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
