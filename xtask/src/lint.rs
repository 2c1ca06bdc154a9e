//! Clippy in the builds of CI: Segue's own packages are checked when they are compiled.
//!
//! `cargo clippy` first checks all packages below them, which the builds compile again. In CI,
//! xtask is cargo's `RUSTC_WORKSPACE_WRAPPER` instead: cargo calls it in place of the compiler, for
//! the packages of this workspace alone.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use crate::shell::{self, Result, fail};
use crate::tools::WASM_TARGET;

/// In CI, sets up a call of cargo so that Clippy checks what it compiles.
pub fn while_building(cargo: &mut Command) -> Result<()> {
    if shell::is_ci() {
        cargo.env("RUSTC_WORKSPACE_WRAPPER", std::env::current_exe()?);
        // `-D warnings`, in the form in which `cargo clippy` hands it on. Set for cargo: what
        // Clippy has compiled is out of date where this variable has another value.
        cargo.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__");
    }
    Ok(())
}

/// Returns whether cargo has called xtask in place of a compiler, which is the first argument then.
pub fn is_compiler(args: &[&str]) -> bool {
    args.first().is_some_and(|first| Path::new(first).file_stem().is_some_and(|it| it == "rustc"))
}

/// Compiles, and fails where Clippy finds a fault.
///
/// Clippy's driver is a compiler itself, but leaves out the optimisation of Rust's own
/// intermediate code. Tests are compiled by it. What is deployed is checked first, and then
/// compiled as it is without Clippy.
pub fn compile(args: &[&str]) -> Result<ExitCode> {
    let (compiler, args) = args.split_first().ok_or("there is no compiler")?;
    let clippy = |args: &[&str]| succeeds(Command::new("clippy-driver").arg(compiler).args(args));
    // Cargo also asks the compiler for its version and its targets.
    let is_code = args.iter().any(|arg| arg.ends_with(".rs"));
    let compiled = if is_code && !args.contains(&WASM_TARGET) {
        clippy(args)?
    } else {
        let checked = !is_code || {
            let args = check_args(args)?;
            clippy(&args.iter().map(String::as_str).collect::<Vec<_>>())?
        };
        checked && succeeds(Command::new(compiler).args(args))?
    };
    Ok(if compiled { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Runs a command, which writes its own faults.
fn succeeds(command: &mut Command) -> Result<bool> {
    match command.status() {
        Ok(status) => Ok(status.success()),
        Err(error) => fail(format!("{} did not start: {error}", command.get_program().display())),
    }
}

/// Returns the arguments of the check. What it writes goes into a folder of its own, and cargo must
/// not take it for a part of the build.
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
