//! Measures the quality of every lab's results on any motion: pairs and sets of takes drawn from a
//! folder or from the synthesiser, every lab and every method, compared with the sources. Prints
//! tables in Markdown. `cargo xtask quality` runs it.

#![expect(clippy::print_stdout, reason = "the tables are what it is for")]

mod trials;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use trials::folder::Motions;
use trials::{guard, session, table};

struct Arguments {
    folder: Option<PathBuf>,
    synthesised: usize,
    pairs: usize,
    seed: u64,
    json: Option<PathBuf>,
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut found = Arguments { folder: None, synthesised: 0, pairs: 8, seed: 1, json: None };
    let mut words = std::env::args_os().skip(1);
    while let Some(word) = words.next() {
        let word = word.to_string_lossy().into_owned();
        let value = words.next().ok_or_else(|| format!("{word} is followed by a value"))?;
        let number =
            value.to_string_lossy().parse::<usize>().map_err(|error| format!("{word}: {error}"));
        match word.as_str() {
            "--data" => found.folder = Some(value.into()),
            "--synth" => found.synthesised = number?,
            "--pairs" => found.pairs = number?,
            "--seed" => found.seed = number? as u64,
            "--json" => found.json = Some(value.into()),
            _ => {
                return Err(format!(
                    "there is no argument {word}, only --data, --synth, --pairs, --seed and --json"
                )
                .into());
            }
        }
    }
    Ok(found)
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = arguments()?;
    guard::keep_panics();
    let motions = match &arguments.folder {
        Some(folder) => Motions::of_folder(folder)?,
        None if arguments.synthesised > 0 => {
            Motions::synthesised(arguments.synthesised, arguments.seed)
        }
        None => return Err(
            "name a folder of motion files by --data, or a number of synthesised clips by --synth"
                .into(),
        ),
    };
    if motions.takes.is_empty() {
        return Err("there is no motion: no BVH, no GLB, and no AMC beside its ASF".into());
    }
    let rigs = motions.takes.iter().map(|take| take.rig).max().map_or(0, |rig| rig + 1);
    println!(
        "{} takes on {rigs} rigs; {} files refused, {} panics in reading.\n",
        motions.takes.len(),
        motions.refused.len(),
        motions.panics.len()
    );
    let trials = session::try_all(&motions, arguments.pairs, arguments.seed);
    println!("{}", table::markdown(&motions, &trials));
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_vec_pretty(&table::json(&motions, &trials))?)?;
    }
    let is_good = motions.panics.is_empty() && trials.iter().all(|trial| trial.faults().is_empty());
    Ok(if is_good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
