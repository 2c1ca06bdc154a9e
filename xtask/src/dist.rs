//! The deployable folder `dist/`: one way to build it, for serving, for tests and for a release.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::progress::{self, Build};
use crate::shell::{Result, cargo, command, fail, on_path, root, run, step, target};
use crate::{page, seal, tools};

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    Dev,
    Release,
}

pub fn folder() -> PathBuf {
    root().join("dist")
}

/// Builds the page into `dist/`, after installing what that needs.
pub fn build(profile: Profile) -> Result<()> {
    tools::ensure_wasm_target()?;
    tools::clang()?;
    let name = match profile {
        Profile::Release => "release",
        Profile::Dev => "dev",
    };
    step(
        format!(
            "building the page in {name} mode (about 6 minutes on 2 cores the first time, seconds when little has changed)"
        ),
        || {
            // The app ends in one long link on one core: the other core builds the tool meanwhile.
            progress::run(vec![
                Build { name: "Segue for the web", cargo: app(profile) },
                Build { name: "its JavaScript's writer", cargo: bindgen() },
            ])
        },
    )?;
    step("putting the page together (seconds)", || assemble(profile))
}

fn app(profile: Profile) -> Command {
    let mut build = cargo(&[
        "build",
        "--locked",
        "--target=wasm32-unknown-unknown",
        "--package=segue",
        "--bin=segue",
        "--bin=reader",
    ]);
    if profile == Profile::Release {
        build.arg("--release");
    }
    build
}

fn bindgen() -> Command {
    cargo(&["build", "--locked", "--package=segue-bindgen"])
}

/// Writes `dist/` from what has been compiled.
fn assemble(profile: Profile) -> Result<()> {
    let compiled = target().join("wasm32-unknown-unknown").join(match profile {
        Profile::Release => "release",
        Profile::Dev => "debug",
    });
    let tool =
        target().join("debug").join(format!("segue-bindgen{}", std::env::consts::EXE_SUFFIX));
    // Built beside it, so that a failed build leaves the old page.
    let made = root().join("dist.part");
    let _ = fs::remove_dir_all(&made);
    page::make(
        &root().join("web/index.html"),
        &fs::read_to_string(root().join("Trunk.toml"))?,
        &made,
        &mut |bin, place| {
            let module = compiled.join(format!("{bin}.wasm"));
            run(Command::new(&tool).arg(module).arg(place))
        },
    )?;
    seal::seal(&made, profile == Profile::Release)?;
    let _ = fs::remove_dir_all(folder());
    Ok(fs::rename(made, folder())?)
}

/// Writes `.br` and `.gz` beside every file in `dist/` that becomes smaller.
pub fn precompress() -> Result<()> {
    if !on_path("node") {
        return fail(
            "precompressing needs `node` on the path, whose zlib holds both brotli and gzip",
        );
    }
    step("precompressing dist/ (about 20 seconds when the app has changed)", || {
        let cache = target().join("precompressed");
        fs::create_dir_all(&cache)?;
        run(command("node", &["xtask/src/precompress.mjs"]).arg(folder()).arg(cache))
    })
}
