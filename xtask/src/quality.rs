//! `cargo xtask quality`, `graph-quality`, `match-quality` and `match-speed`: transitions between all clips of a folder, walks through their motion
//! graph, and characters driven by recorded input, measured.

use std::path::PathBuf;
use std::process::Command;

use crate::shell::{Result, cargo, fail, root, run};

pub fn run_pairs(args: &[&str]) -> Result<()> {
    run_example("transition_quality", args)
}

pub fn run_walks(args: &[&str]) -> Result<()> {
    run_example("graph_quality", args)
}

pub fn run_drives(args: &[&str]) -> Result<()> {
    run_made("match_quality", args)
}

pub fn time_searches(args: &[&str]) -> Result<()> {
    run_made("match_speed", args)
}

fn run_made(name: &str, args: &[&str]) -> Result<()> {
    if !args.is_empty() {
        return fail("this command takes no arguments: it drives with the synthesiser's motions");
    }
    run(&mut example(name))
}

fn run_example(name: &str, args: &[&str]) -> Result<()> {
    let folder = match args {
        [] => usual_folder()?,
        // The table is made in the repository's root, the folder was named from here.
        ["--data", folder] => std::path::absolute(folder)?,
        _ => return fail("these commands know --data, followed by one folder, and nothing else"),
    };
    if !folder.is_dir() {
        return fail(format!("there is no folder {}", folder.display()));
    }
    run(example(name).arg("--").arg(folder))
}

fn example(name: &str) -> Command {
    cargo(&[
        "run",
        "--quiet",
        "--release",
        "--locked",
        "--no-default-features",
        "--example",
        name,
    ])
}

/// Where the tests look for captured motion, too.
fn usual_folder() -> Result<PathBuf> {
    let places = [
        std::env::var_os("SEGUE_SHARED").map(PathBuf::from),
        Some(root().join("../shared/data")),
        Some(root().join("../../shared/data")),
    ];
    let mut folders = places.into_iter().flatten().map(|place| place.join("cmu/16"));
    match folders.find(|folder| folder.is_dir()) {
        Some(folder) => Ok(folder),
        None => fail("the takes of CMU's subject 16 are not in ../shared/data/cmu/16: name a folder of BVH, or of AMC and ASF, by --data"),
    }
}
