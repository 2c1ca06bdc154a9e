//! `segue corpus`: a corpus of many files, made by the Python package `segue`, which runs the same
//! core on threads or on Ray.

use crate::status::{Failure, Status};
use clap::Args;
use std::ffi::{OsStr, OsString};
use std::process::{Command, Stdio};

/// The part of the help behind the options.
pub(crate) const EXAMPLES: &str = "\
Examples:
  segue corpus build takes set.zip corpus            on all cores
  segue corpus build 's3://bucket/takes' corpus --ray
  segue corpus build takes corpus --ray=head:6379 --labels labels.csv

It needs Python with the package: pip install \"./crates/python[corpus]\" in Segue's folder";

/// The Python program, where none is named.
const PYTHON: &str = "python3";

/// Arguments of `segue corpus build`.
#[derive(Args, Debug)]
pub(crate) struct BuildArgs {
    /// Files, folders with all below them, zips, patterns, and addresses such as s3:// or hf://
    #[arg(value_name = "IN", required = true)]
    inputs: Vec<OsString>,
    /// The folder of the corpus; what it has already is not computed again
    #[arg(value_name = "OUT", required = true)]
    out: OsString,
    /// How many files are read at the same time [default: as many as there are cores]
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    /// Works on Ray: on this machine, or on the cluster at an address
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    ray: Option<String>,
    /// Mends the faults of takes
    #[arg(long)]
    clean: bool,
    /// A CSV file: a path, and the labels of its clips
    #[arg(long, value_name = "FILE")]
    labels: Option<OsString>,
    /// Computes all files again
    #[arg(long)]
    fresh: bool,
    /// The Python program that has the package
    #[arg(long, value_name = "PROGRAM", default_value = PYTHON)]
    python: OsString,
}

impl BuildArgs {
    /// Returns the words of the package's own command.
    fn words(&self) -> Vec<OsString> {
        let mut words: Vec<OsString> = ["-m", "segue.corpus", "build"].map(Into::into).into();
        if let Some(workers) = self.workers {
            words.push(format!("--workers={workers}").into());
        }
        match self.ray.as_deref() {
            None => {}
            // An empty address would be that of a cluster.
            Some("") => words.push("--ray".into()),
            Some(address) => words.push(format!("--ray={address}").into()),
        }
        if let Some(labels) = &self.labels {
            let mut word = OsString::from("--labels=");
            word.push(labels);
            words.push(word);
        }
        words.extend(self.clean.then(|| "--clean".into()));
        words.extend(self.fresh.then(|| "--fresh".into()));
        // Behind it, a name may begin with a dash.
        words.push("--".into());
        words.extend(self.inputs.iter().cloned());
        words.push(self.out.clone());
        words
    }
}

/// Makes a corpus. The package reports progress and errors itself.
///
/// # Errors
/// [`Failure`] if there is no such Python, or if it does not have the package.
pub(crate) fn build(args: &BuildArgs) -> Result<Status, Failure> {
    check(&args.python)?;
    let status = Command::new(&args.python).args(args.words()).status();
    match status.map_err(|error| no_python(&args.python, &error))?.code() {
        Some(0) => Ok(Status::Fine),
        Some(2) => Ok(Status::Usage),
        _ => Ok(Status::Unreadable),
    }
}

/// Checks that a Python has the package.
fn check(python: &OsStr) -> Result<(), Failure> {
    let mut import = Command::new(python);
    import.args(["-c", "import segue.corpus"]);
    let import = import.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if import.status().map_err(|error| no_python(python, &error))?.success() {
        return Ok(());
    }
    Err(Failure::unreadable(format!(
        "`{}` does not have the package `segue`, which makes corpora: `pip install \"./crates/python[corpus]\"` in Segue's folder, or name another Python by --python",
        python.display()
    )))
}

fn no_python(python: &OsStr, error: &std::io::Error) -> Failure {
    Failure::unreadable(format!(
        "`{}` cannot be run: {error}. Corpora need Python 3 with the package `segue`; name it by --python",
        python.display()
    ))
}
