//! Detection and installation of tools beyond Rust itself.

use std::fs;
use std::path::PathBuf;

use crate::shell::{Result, command, fail, on_path, output, root, run, step, target};

/// The version of Trunk for which Trunk.toml was written; others write other start scripts.
const TRUNK: &str = "0.21.14";
/// The target of what runs in the page.
pub const WASM_TARGET: &str = "wasm32-unknown-unknown";

/// Checks that Trunk and wasm-bindgen are installed in the versions that build this page. Only
/// `trunk serve` needs them.
pub fn trunk() -> Result<()> {
    for (program, version) in [("trunk", TRUNK.to_owned()), ("wasm-bindgen", wasm_bindgen()?)] {
        match output(program, &["--version"]) {
            Some(text) if text.split_whitespace().nth(1) == Some(&version) => {}
            Some(text) => return fail(format!("{text} is installed, not {version}")),
            None => return fail(format!("{program} {version} is not installed")),
        }
    }
    Ok(())
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

/// Finds or installs the compiler of the C code that the page's reader contains.
pub fn clang() -> Result<()> {
    if on_path("clang") { Ok(()) } else { apt(&["clang"]) }
}

/// Finds or installs a software Vulkan driver, which the pictures of the UI and Chromium need.
pub fn software_vulkan() -> Result<()> {
    let any = |folder: &str| fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some());
    if !cfg!(target_os = "linux") || any("/usr/share/vulkan/icd.d") || any("/etc/vulkan/icd.d") {
        return Ok(());
    }
    apt(&["mesa-vulkan-drivers", "libvulkan1"])
}

/// Finds or installs a browser, and returns its path.
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

/// Finds or installs the packages of the browser tests.
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

/// Finds or installs Python packages of exact versions, and returns the path of the Python that has
/// them.
pub fn python(packages: &[&str]) -> Result<PathBuf> {
    let folder = target().join("python");
    let bin = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = bin.join("python");
    // Written last, so that an incomplete installation is repeated, and one of other packages too.
    let done = folder.join("installed");
    let list = packages.join("\n");
    if fs::read_to_string(&done).ok().as_deref() != Some(&list) {
        // Debian packages the module separately, and without it half of `venv` still seems to work.
        if output("python3", &["-c", "import ensurepip, venv"]).is_none() {
            apt(&["python3", "python3-venv"])?;
        }
        step(format!("installing {} for Python (seconds)", packages.join(", ")), || {
            run(command("python3", &["-m", "venv", "--clear"]).arg(&folder))?;
            // To compile all of it takes as long as to install it; Python compiles what it imports.
            let quietly = ["--quiet", "--disable-pip-version-check", "--no-compile"];
            let install = [&["-m", "pip", "install"], &quietly[..]].concat();
            run(command(&python, &install).args(packages))?;
            Ok(fs::write(&done, &list)?)
        })?;
    }
    Ok(python)
}

fn has_wasm_target() -> bool {
    // Asks rustc instead of rustup, so that a standard library from another source is found as
    // well.
    output("rustc", &["--print", "target-libdir", "--target", WASM_TARGET])
        .is_some_and(|folder| PathBuf::from(folder).is_dir())
}

/// Returns the version of wasm-bindgen in Cargo.lock.
fn wasm_bindgen() -> Result<String> {
    let lock = fs::read_to_string(root().join("Cargo.lock"))?;
    let entry = lock.split_once("name = \"wasm-bindgen\"\nversion = \"");
    let version = entry.and_then(|(_, rest)| rest.split('"').next());
    version
        .map_or_else(|| fail("Cargo.lock holds no wasm-bindgen"), |version| Ok(version.to_owned()))
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
        // Without package lists, or with old ones, the first attempt fails.
        install().or_else(|_| {
            run(command("apt-get", &["update"]).stdout(std::process::Stdio::null()))?;
            install()
        })
    })
}
