//! Clippy in the build for the web in CI: Segue's own packages are checked when they are compiled.
//!
//! `cargo clippy` first checks all packages below them, which the build compiles again. In CI,
//! xtask is cargo's `RUSTC_WORKSPACE_WRAPPER` instead: cargo calls it in place of the compiler, for
//! the packages of this workspace alone.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use crate::shell::{self, Result, fail};

/// Has a command that calls cargo check by Clippy what it compiles.
pub fn while_building(command: &mut Command) {
    if let Ok(xtask) = std::env::current_exe() {
        command.env("RUSTC_WORKSPACE_WRAPPER", xtask);
    }
}

/// Returns whether cargo has called xtask in place of a compiler, which is the first argument then.
pub fn is_compiler(args: &[&str]) -> bool {
    args.first().is_some_and(|first| Path::new(first).file_stem().is_some_and(|it| it == "rustc"))
}

/// Checks by Clippy what is to be compiled, and compiles it if there is no fault.
pub fn compile(args: &[&str]) -> Result<ExitCode> {
    let (compiler, args) = args.split_first().ok_or("there is no compiler")?;
    // Cargo also asks for facts of the compiler.
    if args.iter().any(|arg| arg.ends_with(".rs")) {
        // `-D warnings`, as cargo hands it to Clippy.
        let mut clippy = Command::new("clippy-driver");
        clippy.arg(compiler).args(check_args(args)?);
        let denied = "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__";
        if !clippy.env("CLIPPY_ARGS", denied).status()?.success() {
            return Ok(ExitCode::FAILURE);
        }
    }
    let compiled = Command::new(compiler).args(args).status()?;
    Ok(if compiled.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Returns the arguments that check instead of compiling. What the check writes lies beside the
/// build, and cargo is not told of it.
fn check_args(args: &[&str]) -> Result<Vec<String>> {
    let checked = shell::target().join("checked");
    fs::create_dir_all(&checked)?;
    let Some(checked) = checked.to_str() else {
        return fail("the path of the target folder is no text");
    };
    let mut follows_folder = false;
    let args = args.iter().map(|&arg| {
        if std::mem::replace(&mut follows_folder, arg == "--out-dir") {
            checked.to_owned()
        } else if arg.starts_with("--emit=") {
            "--emit=metadata".to_owned()
        } else if arg.starts_with("--json=") {
            arg.replace(",artifacts", "")
        } else {
            arg.to_owned()
        }
    });
    Ok(args.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_writes_nothing_of_the_build() {
        let build = [
            "--crate-name",
            "segue_text",
            "crates/text/src/lib.rs",
            "--json=diagnostic-rendered-ansi,artifacts,future-incompat",
            "--emit=dep-info,metadata,link",
            "--out-dir",
            "target/debug/deps",
            "-Copt-level=1",
        ];
        let check = check_args(&build).expect("the target folder can be written");
        assert_eq!(check.len(), build.len());
        assert!(!check.iter().any(|arg| arg.contains("artifacts") || arg.contains("link")));
        assert_eq!(check[4], "--emit=metadata");
        assert!(Path::new(&check[6]).ends_with("checked"));
    }
}
