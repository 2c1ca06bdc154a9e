//! `cargo xtask quality`, `clean-quality`, `match-quality` and `match-speed`: measurements of every
//! lab on any motion, of faults found and mended, of characters driven by recorded input, and of
//! searches. `make-corpus` writes the files of a large library,
//! `make-large-corpus` a corpus of them.

use std::path::PathBuf;
use std::process::Command;

use crate::shell::{Result, cargo, fail, root, run};

/// The options of `quality` that name a file or a folder.
const PATHS: [&str; 2] = ["--data", "--json"];

pub fn try_labs(args: &[&str]) -> Result<()> {
    let mut tool = tool("quality", "quality");
    tool.arg("--");
    let mut words = args.iter();
    while let Some(word) = words.next() {
        match words.next() {
            // The program runs in the repository's root, but the path is relative to the current
            // folder.
            Some(path) if PATHS.contains(word) => tool.arg(word).arg(std::path::absolute(path)?),
            Some(value) => tool.arg(word).arg(value),
            None => return fail(format!("{word} is followed by a value")),
        };
    }
    if !args.contains(&"--data") && !args.contains(&"--synth") {
        tool.arg("--data").arg(usual_folder()?);
    }
    run(&mut tool)
}

pub fn try_cleaning(args: &[&str]) -> Result<()> {
    let mut tool = tool("clean_quality", "release");
    tool.arg("--");
    let mut words = args.iter();
    let mut has_folder = false;
    while let Some(word) = words.next() {
        has_folder |= *word == "--data";
        match words.next() {
            Some(path) if PATHS.contains(word) => tool.arg(word).arg(std::path::absolute(path)?),
            Some(value) => tool.arg(word).arg(value),
            None => return fail(format!("{word} is followed by a value")),
        };
    }
    if !has_folder && let Ok(folder) = usual_folder() {
        // All captured motion, of which subject 16 is a part.
        if let Some(all) = folder.parent().and_then(std::path::Path::parent) {
            tool.arg("--data").arg(all);
        }
    }
    run(&mut tool)
}

pub fn run_drives(args: &[&str]) -> Result<()> {
    run_made("match_quality", args)
}

pub fn time_searches(args: &[&str]) -> Result<()> {
    run_made("match_speed", args)
}

pub fn make_corpus(args: &[&str]) -> Result<()> {
    let &[count, folder] = args else {
        return fail("make-corpus is followed by a number of files and a folder");
    };
    let mut tool = tool("make_corpus", "release");
    run(tool.arg("--").arg(count).arg(std::path::absolute(folder)?))
}

pub fn make_large_corpus(args: &[&str]) -> Result<()> {
    let &[count, folder] = args else {
        return fail("make-large-corpus is followed by a number of clips and a folder");
    };
    let mut tool = tool("make_large_corpus", "quality");
    run(tool.arg("--").arg(count).arg(std::path::absolute(folder)?))
}

/// Writes the corpus of the browser tests.
pub fn make_test_corpus() -> Result<()> {
    let mut tool = tool("make_test_corpus", "dev");
    run(tool.arg("--").arg(root().join("tests/browser/corpus")))
}

fn run_made(name: &str, args: &[&str]) -> Result<()> {
    if !args.is_empty() {
        return fail("this command takes no arguments: it drives with the synthesiser's motions");
    }
    run(&mut tool(name, "release"))
}

/// Returns the command that runs a program of `tools/`, built with a profile.
fn tool(name: &str, profile: &str) -> Command {
    cargo(&[
        "run",
        "--quiet",
        "--locked",
        "--profile",
        profile,
        "--package",
        "segue-tools",
        "--bin",
        name,
    ])
}

/// Returns the folder where the tests also look for captured motion.
fn usual_folder() -> Result<PathBuf> {
    let places = [
        std::env::var_os("SEGUE_SHARED").map(PathBuf::from),
        Some(root().join("../shared/data")),
        Some(root().join("../../shared/data")),
    ];
    let mut folders = places.into_iter().flatten().map(|place| place.join("cmu/16"));
    match folders.find(|folder| folder.is_dir()) {
        Some(folder) => Ok(folder),
        None => fail(
            "the takes of CMU's subject 16 are not in ../shared/data/cmu/16: name a folder of motion files by --data",
        ),
    }
}
