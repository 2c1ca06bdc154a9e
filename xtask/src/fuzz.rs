//! `cargo xtask fuzz`: runs random input through the readers and the page until one of them fails,
//! or time is up.

use std::fs;

use crate::server::Server;
use crate::shell::{Result, command, fail, on_path, output, root, run, step};
use crate::{dist, tools};

/// The target that fuzzes the whole page in a browser (tests/browser/fuzz.mjs).
const PAGE: &str = "page";
/// The default duration of each target.
const MINUTES: u32 = 20;

pub fn run_targets(args: &[&str]) -> Result<()> {
    let mut known = targets()?;
    known.push(PAGE.to_owned());
    let mut chosen = Vec::new();
    let (mut minutes, mut seed) = (MINUTES, 1_u32);
    let mut args = args.iter();
    while let Some(&arg) = args.next() {
        match arg {
            "--minutes" => match args.next().map(|number| number.parse()) {
                Some(Ok(number)) => minutes = number,
                _ => return fail("--minutes is followed by a whole number"),
            },
            "--seed" => match args.next().map(|number| number.parse()) {
                Some(Ok(number)) => seed = number,
                _ => return fail("--seed is followed by a whole number"),
            },
            name if known.iter().any(|target| target == name) => chosen.push(name.to_owned()),
            other => {
                return fail(format!("there is no target `{other}`, only {}", known.join(", ")));
            }
        }
    }
    if chosen.is_empty() {
        chosen = known;
    }
    if chosen.iter().any(|target| target != PAGE) {
        nightly()?;
    }
    for target in chosen {
        step(format!("{target}, {minutes} minutes"), || match target.as_str() {
            PAGE => fuzz_page(minutes, seed),
            reader => fuzz(reader, minutes),
        })?;
    }
    Ok(())
}

fn fuzz_page(minutes: u32, seed: u32) -> Result<()> {
    let chromium = tools::chromium()?;
    tools::browser_packages()?;
    let server = Server::bind(0, dist::folder())?;
    let address = server.address();
    std::thread::spawn(move || server.run());
    let (minutes, seed) = (minutes.to_string(), seed.to_string());
    let mut fuzz =
        command("node", &["tests/browser/fuzz.mjs", "--minutes", &minutes, "--seed", &seed]);
    run(fuzz.env("SEGUE_URL", address).env("CHROMIUM", chromium))
}

fn fuzz(target: &str, minutes: u32) -> Result<()> {
    // The fuzzer writes its findings to the first folder, and reads seeds from the second.
    let found = format!("fuzz/corpus/{target}");
    let seeds = format!("fuzz/corpus-seeds/{target}");
    fs::create_dir_all(root().join(&found))?;
    let mut fuzz = command(
        "rustup",
        &["run", "nightly", "cargo", "fuzz", "run", target, &found, &seeds, "--"],
    );
    // A link is short, and a file of a few rows is sufficient, but of FBX the head alone is long.
    // Ten seconds for any of them are a finding.
    let length = match target {
        "url" => 600,
        "fbx" => 16_384,
        _ => 8192,
    };
    fuzz.arg(format!("-max_total_time={}", minutes * 60)).arg(format!("-max_len={length}"));
    fuzz.args(["-timeout=10", "-rss_limit_mb=2048", "-print_final_stats=1"]);
    // The variables of this cargo and its pinned compiler must not reach the nightly one.
    fuzz.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO");
    run(&mut fuzz)
}

/// Returns the targets by name.
fn targets() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(root().join("fuzz/fuzz_targets"))? {
        if let Some(name) = entry?.path().file_stem() {
            names.push(name.to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}

/// Finds or installs the nightly compiler, which sanitizers need.
fn nightly() -> Result<()> {
    if output("rustup", &["run", "nightly", "rustc", "--version"]).is_none() {
        step("installing a nightly compiler (about a minute)", || {
            run(&mut command(
                "rustup",
                &["toolchain", "install", "nightly", "--profile", "minimal"],
            ))
        })?;
    }
    if !on_path("cargo-fuzz") {
        step("installing cargo-fuzz (about a minute)", || {
            run(&mut command("cargo", &["install", "--quiet", "--locked", "cargo-fuzz"]))
        })?;
    }
    Ok(())
}
