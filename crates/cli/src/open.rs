//! `segue open`: the page with files loaded, in the browser.

use crate::server::PageServer;
use crate::status::{Failure, Status};
use clap::Args;
use percent_encoding::{NON_ALPHANUMERIC, utf8_percent_encode};
use segue_batch::{Inputs, query_of};
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The part of the help behind the options.
pub(crate) const EXAMPLES: &str = "\
Examples:
  segue open walk.bvh run.bvh                       the page with two clips
  segue open walk.bvh --query 'lab=clean'           in the Clean lab
  segue open walk.bvh --no-browser                  prints the address, and serves it until Ctrl-C

The page is built once, in Segue's folder: cargo xtask serve --dist";

/// The greatest number of files that the page loads from a link.
const MAX_FILES: usize = 16;

/// Arguments of `segue open`.
#[derive(Args, Debug)]
pub(crate) struct OpenArgs {
    /// Files, folders with all below them, zips, and patterns such as 'takes/*.bvh'
    #[arg(value_name = "FILE")]
    files: Vec<OsString>,
    /// The state of the page, as behind the question mark of a link
    #[arg(long, value_name = "QUERY", default_value = "lab=view")]
    query: String,
    /// The folder of the built page [default: dist in the folder that segue was built from]
    #[arg(long, value_name = "FOLDER")]
    page: Option<PathBuf>,
    /// The port on 127.0.0.1; 0 is any free one
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    port: u16,
    /// Opens no browser
    #[arg(long)]
    no_browser: bool,
}

/// Serves the page with files, and opens the browser.
///
/// # Errors
/// [`Failure`] if there is no page, no file, or no port.
pub(crate) fn run(args: &OpenArgs) -> Result<Status, Failure> {
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../dist");
    let page = args.page.clone().unwrap_or(built);
    if !page.join("index.html").is_file() {
        return Err(Failure::unreadable(format!(
            "the page is not built: there is no {}. Build it by `cargo xtask serve --dist` in Segue's folder, or name the folder of a built page by --page",
            page.join("index.html").display()
        )));
    }
    let inputs = if args.files.is_empty() { Inputs::default() } else { Inputs::of(&args.files)? };
    for problem in &inputs.problems {
        eprintln!("segue: {problem}");
    }
    if inputs.files.len() > MAX_FILES {
        return Err(Failure::usage(format!(
            "here are {} files; the page opens up to {MAX_FILES}: pack them into a zip",
            inputs.files.len()
        )));
    }
    let files = inputs.files.into_iter().map(|input| input.path).collect();
    let server = PageServer::bind(args.port, page, files)?;
    let sources = server.file_addresses().join(" ");
    let sources = if sources.is_empty() {
        String::new()
    } else {
        format!("&src={}", utf8_percent_encode(&sources, NON_ALPHANUMERIC))
    };
    let address = format!("{}?{}{sources}", server.address(), query_of(&args.query));
    writeln!(io::stdout(), "{address}")?;
    io::stdout().flush()?;
    if !args.no_browser
        && let Err(error) = open::that_detached(&address)
    {
        eprintln!("segue: no browser could be opened ({error}): open the address by hand");
    }
    eprintln!("serving until Ctrl-C");
    server.run();
    Ok(Status::Fine)
}
