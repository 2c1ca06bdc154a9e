//! The deployable folder `dist/`: one way to build it, for serving, for tests and for a release.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::progress::{self, Build};
use crate::shell::{Result, cargo, command, fail, on_path, root, run, step, target};
use crate::{lint, page, seal, tools};

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    Dev,
    Release,
}

pub fn folder() -> PathBuf {
    root().join("dist")
}

/// The modules of the app in a page.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Modules {
    /// One that draws with WebGPU or WebGL 2.
    One,
    /// That one and a smaller one that draws with WebGPU alone, both divided, as deployed. It takes
    /// a second long link.
    Two,
}

/// Builds the page into `dist/`, after installing what that needs.
pub fn build(profile: Profile, modules: Modules) -> Result<()> {
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
                Build { name: "Segue for the web", cargo: app(profile, &WORKERS)? },
                Build { name: "its JavaScript's writer", cargo: bindgen()? },
            ])
        },
    )?;
    if modules == Modules::Two {
        step("building the module for WebGPU alone (about 3 minutes the first time)", || {
            // Both are called segue-app.wasm, and the other is built again in no time.
            let webgpu = app(profile, &["--no-default-features", "--features=app"])?;
            progress::run(vec![Build { name: "Segue for WebGPU", cargo: webgpu }])?;
            let folder = compiled(profile);
            fs::copy(folder.join("segue-app.wasm"), folder.join(format!("{}.wasm", page::WEBGPU)))?;
            progress::run(vec![Build { name: "Segue for the web", cargo: app(profile, &[])? }])
        })?;
    }
    step("putting the page together (seconds)", || assemble(profile, modules))
}

/// The options of cargo for the programs of the page's workers.
pub const WORKERS: [&str; 4] = ["--bin=reader", "--bin=converter", "--bin=compute", "--bin=corpus"];

/// Returns the folder of compiled modules.
fn compiled(profile: Profile) -> PathBuf {
    target().join("wasm32-unknown-unknown").join(match profile {
        Profile::Release => "release",
        Profile::Dev => "debug",
    })
}

fn app(profile: Profile, others: &[&str]) -> Result<Command> {
    let mut build = cargo(&[
        "build",
        "--locked",
        "--target=wasm32-unknown-unknown",
        "--package=segue",
        "--bin=segue-app",
    ]);
    build.args(others);
    if profile == Profile::Release {
        build.arg("--release");
    }
    lint::while_building(&mut build)?;
    Ok(build)
}

fn bindgen() -> Result<Command> {
    let mut build = cargo(&["build", "--locked", "--profile=tool", "--package=segue-bindgen"]);
    lint::while_building(&mut build)?;
    Ok(build)
}

/// Writes `dist/` from what has been compiled.
fn assemble(profile: Profile, modules: Modules) -> Result<()> {
    let compiled = compiled(profile);
    let tool = target().join("tool").join(format!("segue-bindgen{}", std::env::consts::EXE_SUFFIX));
    // Built beside it, so that a failed build leaves the old page.
    let made = root().join("dist.part");
    let _ = fs::remove_dir_all(&made);
    page::make(
        &root().join("web/index.html"),
        &fs::read_to_string(root().join("Trunk.toml"))?,
        &made,
        modules == Modules::Two,
        &mut |bin, place| {
            let mut write = Command::new(&tool);
            write.arg(compiled.join(format!("{bin}.wasm"))).arg(place);
            // Without the names of functions, a tenth of what travels. Trunk's page has them.
            if modules == Modules::Two {
                write.arg(root().join("web/rest.txt"));
            }
            run(&mut write)
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
