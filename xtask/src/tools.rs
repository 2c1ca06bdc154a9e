//! The tools beyond Rust itself: found, or installed.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::shell::{Result, cargo, command, fail, on_path, output, root, run, step, target};

/// What Trunk this page was made with; it is asked for exactly, for its start scripts differ
/// between versions.
const TRUNK: &str = "0.21.14";
const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// The web build's tools, found in the versions that the project needs.
pub struct WebTools {
    /// A folder that goes before the others on the path, if it exists.
    own: PathBuf,
}

impl WebTools {
    /// The command of one of these tools, with all of them on its path.
    pub fn command(&self, program: &str, args: &[&str]) -> Command {
        let rest = std::env::var_os("PATH").unwrap_or_default();
        let path = std::env::join_paths(
            std::iter::once(self.own.clone()).chain(std::env::split_paths(&rest)),
        );
        let own = self.own.join(program);
        let mut command = if own.is_file() { command(own, args) } else { command(program, args) };
        if let Ok(path) = path {
            command.env("PATH", path);
        }
        command
    }
}

/// A program that `cargo install` brings.
struct Crate {
    name: &'static str,
    program: &'static str,
    version: String,
    /// Trunk needs the versions in its own lock file to build at all; wasm-bindgen-cli comes
    /// without a lock file.
    locked: bool,
    /// Level 0 suffices for Trunk, which only starts others; wasm-bindgen itself works on
    /// megabytes.
    opt_level: &'static str,
    minutes: u32,
}

impl Crate {
    fn found(&self, program: impl AsRef<std::ffi::OsStr>) -> Option<bool> {
        output(program, &["--version"])
            .map(|text| text.split_whitespace().nth(1) == Some(&self.version))
    }
}

/// Whether [`web`] would have to install something.
pub fn web_is_missing() -> Result<bool> {
    Ok(!missing_crates()?.is_empty() || !has_wasm_target())
}

/// Finds or installs what building for the web needs.
pub fn web() -> Result<WebTools> {
    ensure_wasm_target()?;
    for missing in missing_crates()? {
        install(&missing)?;
    }
    Ok(WebTools { own: own_folder().join("bin") })
}

/// Finds or installs Rust's standard library for the web.
pub fn ensure_wasm_target() -> Result<()> {
    if has_wasm_target() {
        return Ok(());
    }
    step(format!("installing Rust's {WASM_TARGET} target (seconds)"), || {
        run(&mut command("rustup", &["target", "add", WASM_TARGET]))
    })
}

/// Finds or installs what the pictures of the UI need: a Vulkan that draws without a graphics card.
pub fn software_vulkan() -> Result<()> {
    let any = |folder: &str| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    if !cfg!(target_os = "linux") || any("/usr/share/vulkan/icd.d") || any("/etc/vulkan/icd.d") {
        return Ok(());
    }
    apt(&["mesa-vulkan-drivers", "libvulkan1"])
}

/// Finds or installs a browser, and gives its path.
pub fn chromium() -> Result<String> {
    const NAMES: [&str; 4] =
        ["chromium", "chromium-browser", "google-chrome-stable", "google-chrome"];
    if let Ok(own) = std::env::var("CHROMIUM") {
        return Ok(own);
    }
    if !NAMES.iter().any(|name| on_path(name)) {
        apt(&["chromium"])?;
    }
    match NAMES.iter().find(|name| on_path(name)) {
        Some(name) => Ok((*name).to_owned()),
        None => {
            fail("no Chromium was found: install one, or name its path in the variable CHROMIUM")
        }
    }
}

/// Finds or installs what the browser tests import.
pub fn browser_packages() -> Result<()> {
    let folder = root().join("tests/browser");
    let written =
        |path: &str| fs::metadata(folder.join(path)).and_then(|meta| meta.modified()).ok();
    if written("node_modules/.package-lock.json") >= written("package-lock.json") {
        return Ok(());
    }
    step("installing the browser tests' packages (seconds)", || {
        run(command("npm", &["ci"]).current_dir(&folder))
    })
}

/// Finds or installs one Python package, with its exact version, and gives the path of the Python
/// that has it.
pub fn python(package: &str) -> Result<PathBuf> {
    let folder = target().join("python").join(package);
    let bin = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = bin.join("python");
    // Written last, so that half an installation is made again.
    let done = folder.join("installed");
    if !done.exists() {
        // Debian has the module apart from Python, and without it half of `venv` still seems to
        // work.
        if output("python3", &["-c", "import ensurepip, venv"]).is_none() {
            apt(&["python3", "python3-venv"])?;
        }
        step(format!("installing {package} for Python (seconds)"), || {
            run(command("python3", &["-m", "venv", "--clear"]).arg(&folder))?;
            run(&mut command(
                &python,
                &["-m", "pip", "install", "--quiet", "--disable-pip-version-check", package],
            ))?;
            Ok(fs::write(&done, "")?)
        })?;
    }
    Ok(python)
}

fn has_wasm_target() -> bool {
    // Asked of rustc and not of rustup, so that a standard library that came another way counts
    // too.
    output("rustc", &["--print", "target-libdir", "--target", WASM_TARGET])
        .is_some_and(|folder| PathBuf::from(folder).is_dir())
}

fn missing_crates() -> Result<Vec<Crate>> {
    let wasm_bindgen = Crate {
        name: "wasm-bindgen-cli",
        program: "wasm-bindgen",
        version: locked_version("wasm-bindgen")?,
        locked: false,
        opt_level: "1",
        minutes: 4,
    };
    let trunk = Crate {
        name: "trunk",
        program: "trunk",
        version: TRUNK.to_owned(),
        locked: true,
        opt_level: "0",
        minutes: 4,
    };
    let is_missing = |wanted: &Crate| {
        let own = own_folder().join("bin").join(wanted.program);
        wanted.found(own) != Some(true) && wanted.found(wanted.program) != Some(true)
    };
    Ok([wasm_bindgen, trunk].into_iter().filter(is_missing).collect())
}

/// Where a tool goes when another version of it is installed already, which is left alone.
fn own_folder() -> PathBuf {
    root().join(".tools")
}

fn install(wanted: &Crate) -> Result<()> {
    let Crate { name, program, version, minutes, .. } = wanted;
    let has_other = wanted.found(program).is_some();
    let place =
        if has_other { "into .tools/, beside your other version" } else { "with `cargo install`" };
    step(
        format!("installing {name} {version} {place} (about {minutes} minutes on 2 cores)"),
        || {
            let own = own_folder();
            let build = target().join("tools");
            // Neither needs TLS, which their default features bring for downloads that the project
            // does not let them make.
            let package = format!("{name}@{version}");
            let mut install = cargo(&[
                "install",
                "--quiet",
                "--force",
                "--debug",
                "--no-default-features",
                &package,
            ]);
            if wanted.locked {
                install.arg("--locked");
            }
            if has_other {
                install.arg("--root").arg(own);
            }
            install
                .env("CARGO_TARGET_DIR", &build)
                .env("CARGO_PROFILE_DEV_DEBUG", "0")
                .env("CARGO_PROFILE_DEV_OPT_LEVEL", wanted.opt_level)
                .env("CARGO_INCREMENTAL", "0");
            run(&mut install)?;
            // Half a gigabyte that nobody needs again. A failed install keeps it, and goes on where
            // it stopped.
            let _ = fs::remove_dir_all(build);
            Ok(())
        },
    )
}

/// The version of a package in Cargo.lock.
fn locked_version(package: &str) -> Result<String> {
    let lock = fs::read_to_string(root().join("Cargo.lock"))?;
    let entry = format!("name = \"{package}\"");
    let mut lines = lock.lines().skip_while(|line| *line != entry);
    let version =
        lines.nth(1).and_then(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
    version.map_or_else(
        || fail(format!("Cargo.lock holds no {package}")),
        |version| Ok(version.to_owned()),
    )
}

fn apt(packages: &[&str]) -> Result<()> {
    let names = packages.join(" ");
    if !on_path("apt-get") {
        return fail(format!("missing, and there is no apt-get to install it: {names}"));
    }
    step(format!("installing {names} (about half a minute)"), || {
        let args = [&["install", "--yes", "--no-install-recommends"], packages].concat();
        let install = || {
            run(command("apt-get", &args)
                .env("DEBIAN_FRONTEND", "noninteractive")
                .stdout(std::process::Stdio::null()))
        };
        // Without lists of packages, or with old ones, the first try fails.
        install().or_else(|_| {
            run(command("apt-get", &["update"]).stdout(std::process::Stdio::null()))?;
            install()
        })
    })
}
