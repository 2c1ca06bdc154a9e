//! `segue lint`: faults of motion files, for CI.

mod checks;
mod finding;
mod junit;
mod sarif;

pub(crate) use finding::size as fault_size;

use self::checks::{Rule, rules};
use self::finding::{Checked, Severity, check_file};
use crate::read::{ReadArgs, for_each};
use crate::status::{Failure, Status};
use crate::table;
use clap::Args;
use segue_batch::Inputs;
use serde_json::json;
use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Returns the part of the help behind the options.
pub(crate) fn examples() -> String {
    format!(
        "{}
Examples:
  segue lint takes                                  every file below a folder
  segue lint 'takes/*.bvh' --fail-on 'spin,skating>3cm/s'
  segue lint takes --fail-on all --sarif out.sarif  for the code host
  segue lint takes --junit out.xml --quiet          for the CI system

Frames are counted from 0.",
        checks::help()
    )
}

/// Arguments of `segue lint`.
#[derive(Args, Debug)]
pub(crate) struct LintArgs {
    /// Files, folders with all below them, zips, and patterns such as 'takes/*.bvh'
    #[arg(required = true, value_name = "FILE")]
    files: Vec<OsString>,
    /// Checks that fail, with their limits: spin,skating>3cm/s; all and none are lists, too. The
    /// others are told as warnings
    #[arg(long, value_name = "LIST")]
    fail_on: Option<String>,
    /// Prints JSON: a list with an object for each file
    #[arg(long)]
    json: bool,
    /// Writes the findings as SARIF 2.1.0
    #[arg(long, value_name = "FILE")]
    sarif: Option<PathBuf>,
    /// Writes the findings as JUnit's XML
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Prints only what fails
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    read: ReadArgs,
}

/// Checks files.
///
/// # Errors
/// [`Failure`] if there is no file, the command line is wrong, or a report cannot be written.
pub(crate) fn run(args: &LintArgs) -> Result<Status, Failure> {
    let rules = rules(args.fail_on.as_deref())
        .map_err(|reason| Failure::usage(format!("--fail-on: {reason}")))?;
    let inputs = Inputs::of(&args.files)?;
    let reader = args.read.reader(&inputs.files)?;
    let checked = for_each(&inputs.files, "checking", |input| {
        let bytes = match reader.bytes(input)? {
            Ok(bytes) => bytes,
            Err(reason) => return Some(vec![Checked::unreadable(&input.name, reason.to_string())]),
        };
        let report = reader.read_bytes(input, &bytes);
        let is_alone = report.is_one_file();
        let files = report.files.into_iter();
        Some(
            files
                .map(|file| check_file(file, Some(&*bytes).filter(|_| is_alone), &rules))
                .collect(),
        )
    });
    let mut checked: Vec<Checked> = checked.into_iter().flatten().collect();
    for problem in &inputs.problems {
        checked.push(Checked::unreadable("", problem.clone()));
    }
    if let Some(path) = &args.sarif {
        write_report(path, &format!("{:#}\n", sarif::log(&checked)))?;
    }
    if let Some(path) = &args.junit {
        write_report(path, &junit::report(&checked))?;
    }
    if args.json {
        writeln!(io::stdout().lock(), "{:#}", json!(checked))?;
    } else {
        tell(&checked, &rules, args.quiet)?;
    }
    Ok(status(&checked))
}

fn write_report(path: &Path, text: &str) -> Result<(), Failure> {
    fs::write(path, text).map_err(|error| {
        Failure::unreadable(format!("{} cannot be written: {error}", path.display()))
    })
}

fn status(checked: &[Checked]) -> Status {
    let of_file = |file: &Checked| match file {
        file if file.error.is_some() => Status::Unreadable,
        file if count(file, Severity::Error) > 0 => Status::Findings,
        _ => Status::Fine,
    };
    checked.iter().map(of_file).max().unwrap_or(Status::Fine)
}

fn count(file: &Checked, severity: Severity) -> usize {
    file.findings.iter().filter(|finding| finding.severity == severity).count()
}

/// Prints the findings as a table, and the sums below it.
fn tell(checked: &[Checked], rules: &[Rule], is_quiet: bool) -> Result<(), Failure> {
    let mut rows = Vec::new();
    for file in checked {
        if let Some(error) = &file.error {
            let file = file.file.clone();
            rows.push(vec![file, "unreadable".into(), String::new(), error.text.clone()]);
        }
        for finding in &file.findings {
            if is_quiet && finding.severity != Severity::Error {
                continue;
            }
            let place = match finding.line {
                Some(line) => format!("{}:{line}", file.file),
                None => file.file.clone(),
            };
            let clip = if file.clips.len() > 1 && !finding.clip.is_empty() {
                format!("{}: ", finding.clip)
            } else {
                String::new()
            };
            rows.push(vec![
                place,
                finding.severity.word().into(),
                finding.check.into(),
                format!("{clip}{}", finding.text),
            ]);
        }
    }
    let mut out = io::stdout().lock();
    table::write(&mut out, &rows)?;
    let sum = |severity| checked.iter().map(|file| count(file, severity)).sum::<usize>();
    let clips: usize = checked.iter().map(|file| file.clips.len()).sum();
    let unreadable = checked.iter().filter(|file| file.error.is_some()).count();
    let failing = rules.iter().filter(|rule| rule.fails).count();
    if !is_quiet {
        let counts = [
            counted(checked.len(), "file"),
            counted(clips, "clip"),
            format!("{} by {failing} checks", counted(sum(Severity::Error), "error")),
            counted(sum(Severity::Warning), "warning"),
            format!("{unreadable} unreadable"),
        ];
        writeln!(out, "{}", counts.join(", "))?;
    }
    Ok(())
}

fn counted(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}
