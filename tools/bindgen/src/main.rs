//! Generates the JavaScript for a compiled WebAssembly module, as `wasm-bindgen --target web
//! --no-typescript` does: `segue-bindgen MODULE.wasm FOLDER`.
//!
//! `cargo xtask serve` runs it. The library behind `wasm-bindgen-cli` builds in a tenth of the time
//! of the program with its test runner and command line.

use std::process::ExitCode;

use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [module, folder] = args.as_slice() else {
        eprintln!("usage: segue-bindgen MODULE.wasm FOLDER");
        return ExitCode::FAILURE;
    };
    let mut bindgen = Bindgen::new();
    let written = bindgen.web(true).and_then(|bindgen| {
        bindgen
            .input_path(module)
            .typescript(false)
            // The reader finds its module beside its script.
            .omit_default_module_path(false)
            .generate(folder)
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {module}: {error:#}");
            ExitCode::FAILURE
        }
    }
}
