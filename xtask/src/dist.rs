//! The deployable folder `dist/`: one way to build it, for serving, for tests and for a release.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use crate::shell::{Result, cargo, command, fail, on_path, root, run, step, target};
use crate::tools;

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    Dev,
    Release,
}

pub fn folder() -> PathBuf {
    root().join("dist")
}

/// Builds the page into `dist/`, and installs first what that needs.
pub fn build(profile: Profile) -> Result<()> {
    if tools::web_is_missing()? {
        println!(
            "The first build installs tools and compiles everything: about 10 minutes on 2 cores. Later ones take seconds."
        );
        // The tools are many small crates and the app ends in one long link: side by side they fill
        // both cores.
        tools::ensure_wasm_target()?;
        std::thread::scope(|scope| {
            let ahead = scope.spawn(|| compile(profile));
            let tools = tools::web();
            // What the compiler has to say, Trunk's own call of it says again.
            let _ = ahead.join();
            tools.map(drop)
        })?;
    }
    let tools = tools::web()?;
    // Trunk builds offline (Trunk.toml), so that it brings no tools of its own; the packages must
    // be here by then.
    run(&mut cargo(&["fetch", "--quiet", "--locked", "--target=wasm32-unknown-unknown"]))?;
    let (name, args): (_, &[&str]) = match profile {
        Profile::Release => ("release", &["build", "--release"]),
        Profile::Dev => ("dev", &["build"]),
    };
    step(
        format!(
            "building the page in {name} mode (minutes when much has changed, seconds otherwise)"
        ),
        || run(tools.command("trunk", args).env_remove("NO_COLOR")),
    )
}

/// The compilation that Trunk will ask for, with the same words, so that Trunk finds it done.
fn compile(profile: Profile) -> Result<()> {
    let mut build = cargo(&[
        "build",
        "--quiet",
        "--locked",
        "--target=wasm32-unknown-unknown",
        "--bin=segue",
        "--bin=reader",
    ]);
    if profile == Profile::Release {
        build.arg("--release");
    }
    let start = Instant::now();
    run(&mut build)?;
    println!("  {:.1} s: compiling Segue for the web, meanwhile", start.elapsed().as_secs_f64());
    Ok(())
}

/// Writes `.br` and `.gz` beside every file in `dist/` that gets smaller by it.
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
