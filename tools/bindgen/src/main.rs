//! Generates the JavaScript for a compiled WebAssembly module, as `wasm-bindgen --target web
//! --no-typescript` does: `segue-bindgen MODULE.wasm FOLDER`.
//!
//! With a third argument, as for a page that is deployed, the module loses the names of its
//! functions, unless the variable `SEGUE_NAMES` is set, and one with an export
//! [`split::FETCH_REST`] is divided: what the list in this file names (`web/rest.txt`) goes into
//! `MODULE_rest.wasm`.
//!
//! `cargo xtask serve` runs it. The library behind `wasm-bindgen-cli` builds in a tenth of the time
//! of the program with its test runner and command line.

mod list;
mod split;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context as _, Result};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let (module, folder, list) = match args.as_slice() {
        [module, folder] => (module, folder, None),
        [module, folder, list] => (module, folder, Some(list.as_str())),
        _ => {
            eprintln!("usage: segue-bindgen MODULE.wasm FOLDER [REST.txt]");
            return ExitCode::FAILURE;
        }
    };
    match write(module, Path::new(folder), list) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {module}: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn write(module: &str, folder: &Path, list: Option<&str>) -> Result<()> {
    let mut bindgen = Bindgen::new();
    bindgen
        .web(true)?
        .input_path(module)
        .typescript(false)
        // The reader finds its module beside its script.
        .omit_default_module_path(false)
        .generate(folder)?;
    let Some(list) = list else { return Ok(()) };
    let list = fs::read_to_string(list).with_context(|| list.to_owned())?;
    let name = Path::new(module).file_stem().unwrap_or_default().to_string_lossy();
    let [whole, rest] = ["bg", "rest"].map(|part| folder.join(format!("{name}_{part}.wasm")));
    let has_names = std::env::var_os("SEGUE_NAMES").is_some();
    match split::split(&fs::read(&whole)?, &list.parse()?, has_names)? {
        split::Parts::Whole(module) => fs::write(whole, module)?,
        split::Parts::Two { first, rest: behind } => {
            fs::write(whole, first)?;
            fs::write(rest, behind)?;
        }
    }
    Ok(())
}
