//! Segue's developer commands: `cargo xtask help` lists them.

mod check;
mod compare;
mod dist;
mod fuzz;
mod lint;
mod page;
mod progress;
mod quality;
mod seal;
mod server;
mod shell;
mod tools;

use std::process::ExitCode;

use shell::{Result, fail};

const HELP: &str = "\
cargo xtask serve [--port N] [--dev] [--no-build]
    Builds Segue in release mode (and adds Rust's web target where it is missing) and serves it on 127.0.0.1 (port 8080 by default; 0 picks a free one).
    --dev       builds without optimising (for a rebuild on every save use `trunk serve`)
    --no-build  serves dist/ as it is

cargo xtask serve --dist
    Only writes the deployable folder dist/, with a smaller module for browsers with WebGPU, each module in two parts, and each file precompressed
    beside itself (.br and .gz).

cargo xtask test [PART …]
    Everything that must pass. Parts: lint core oracles python app web browser; all of them unless some are named.
    lint        rustfmt, and Clippy for everything, natively and for the web (in CI, while the other parts compile it)
    core        the tests of the libraries, the command line and the tools, and documentation examples, built without any UI (in CI, for Clippy,
                the programs themselves and benchmarks are built, too)
    oracles     exported files, read back by npm's three and PyPI's bvhio: the same motion?
    python      `import segue`: a wheel, and its tests against NumPy, SciPy and other readers
    app         the tests of the app, pictures of the UI among them
    web         the release build that `serve` makes (where Trunk is installed, it must make the same page), and the one that is deployed
    browser     that build in Chromium, on WebGL2 and on WebGPU

cargo xtask fuzz [TARGET …] [--minutes N] [--seed S]
    Feeds the readers of outside bytes with random ones (20 minutes each by default), with a nightly compiler and cargo-fuzz.
    Targets are the files of fuzz/fuzz_targets and `page`; all of them unless some are named. What breaks one is left in fuzz/artifacts.
    page        feeds the built page in Chromium with links, calls, messages, lessons and parameters; the same seed makes the same input

cargo xtask quality [--data FOLDER | --synth N] [--pairs N] [--seed S] [--json FILE]
    Reads every motion file below a folder (BVH, AMC beside their ASF, GLB, zip), or synthesises N clips, and draws N pairs of the same rig, N of
    different rigs (8 by default) and half as many sets of four takes of one rig. Every lab and every method of it is tried on them as a user opens it,
    without and with planted feet. Prints tables in Markdown: results, refusals with their sentences, panics, spins, flashes, root jumps and skating beside
    the sources'. Fails where a result is worse than its sources beyond the bounds: pairs whose best windows are closer than 12 cm, and Match, have no
    spin, flash or root jump of their own, and with planted feet skate no more than the worse source; nothing panics, is not finite, or is refused without
    a sentence. Without a folder: subject 16 of the CMU database, where it lies in ../shared/data/cmu/16.

cargo xtask clean-quality [--data FOLDER] [--takes N] [--faults N] [--seed S] [--each on]
    Puts faults (spikes, gaps, swaps, jitter) into takes of a folder, 100 into 20 by default, and prints how many are found, by what name, how many
    alarms are false, and the artefacts of the mended takes beside the originals'. Without a folder: all motion in ../shared/data, or synthesised takes
    where there is none. Fails below 95 % found, above 2 false alarms a minute, or where mended takes have 1.5 times the artefacts of the originals.

cargo xtask match-quality
    Drives a character by recorded input (straight on, 90° turns, a spin, starts and stops, into a run, a figure eight) with the synthesiser's
    motions and the default options, and prints how well it follows.

cargo xtask match-speed
    Asks databases of 5,000, 50,000 and 500,000 frames for the best frame by four methods, and prints the median and the 99th percentile.

cargo xtask make-corpus N FOLDER
    Writes N BVH files of synthesised motion into a folder, in twelve rigs and ways of writing: 3,000 files have about 540 MB. The same N gives the same
    files. `node tests/browser/many.mjs FOLDER` measures the page with them.

cargo xtask make-large-corpus N FOLDER
    Writes a corpus of N clips that are made of 300 synthesised ones, without its table for Python, and measures what the page needs of it: bytes, time,
    and the share of the nearest moments that it finds. 100,000 clips take a few minutes and 4 GB.

cargo xtask make-test-corpus
    Writes the small corpus of tests/browser/corpus.test.mjs. It has to be made again when the format of corpora changes.

cargo xtask docs
    Writes the table of docs/parameters.md from the program's parameters.

cargo xtask seal
    Ends a build of Trunk, which calls it: names the page's scripts by their content, and writes the list of files into the service worker.

cargo xtask help
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    if lint::is_compiler(&args) {
        return lint::compile(&args).unwrap_or_else(failed);
    }
    let outcome = match args.split_first() {
        Some((&"serve", rest)) => serve(rest),
        Some((&"test", rest)) => check::run(rest),
        Some((&"fuzz", rest)) => fuzz::run_targets(rest),
        Some((&"quality", rest)) => quality::try_labs(rest),
        Some((&"clean-quality", rest)) => quality::try_cleaning(rest),
        Some((&"match-quality", rest)) => quality::run_drives(rest),
        Some((&"match-speed", rest)) => quality::time_searches(rest),
        Some((&"make-corpus", rest)) => quality::make_corpus(rest),
        Some((&"make-large-corpus", rest)) => quality::make_large_corpus(rest),
        Some((&"make-test-corpus", _)) => quality::make_test_corpus(),
        Some((&"docs", _)) => docs(),
        Some((&"seal", _)) => seal::run(),
        None | Some((&("help" | "--help" | "-h"), _)) => {
            print!("{HELP}");
            Ok(())
        }
        Some((other, _)) => fail(format!("there is no command `{other}`\n\n{HELP}")),
    };
    outcome.map_or_else(failed, |()| ExitCode::SUCCESS)
}

fn failed(error: shell::Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}

/// Writes the table of parameters by running the test that compares it with the program: xtask does
/// not depend on the library.
fn docs() -> Result<()> {
    let mut test = shell::cargo(&[
        "test",
        "--quiet",
        "--locked",
        "--package=segue",
        "--no-default-features",
        "--test=documents",
    ]);
    test.env("SEGUE_WRITE_DOCS", "1");
    shell::run(&mut test)
}

fn serve(args: &[&str]) -> Result<()> {
    let mut port = 8080;
    let mut profile = dist::Profile::Release;
    let (mut build, mut only_dist) = (true, false);
    let mut args = args.iter();
    while let Some(&arg) = args.next() {
        match arg {
            "--port" => {
                port = match args.next().map(|number| number.parse()) {
                    Some(Ok(number)) => number,
                    _ => return fail("--port is followed by a number from 0 to 65535"),
                }
            }
            "--dev" => profile = dist::Profile::Dev,
            "--no-build" => build = false,
            "--dist" => only_dist = true,
            "--help" | "-h" => {
                print!("{HELP}");
                return Ok(());
            }
            other => return fail(format!("`serve` does not know `{other}`\n\n{HELP}")),
        }
    }
    if build {
        let modules = if only_dist { dist::Modules::Two } else { dist::Modules::One };
        dist::build(profile, modules)?;
    }
    if only_dist {
        return dist::precompress();
    }
    let server = server::Server::bind(port, dist::folder())?;
    println!("Segue is served at {} (Ctrl-C ends it)", server.address());
    server.run()
}
