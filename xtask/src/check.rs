//! `cargo xtask test`: all checks that must pass, part by part.

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use crate::shell::{self, Result, cargo, command, fail, root};
use crate::{compare, dist, lint, server, tools};

/// The parts, in an order that fails early and lets each reuse what the one before has built.
const PARTS: [(&str, Part); 7] = [
    ("lint", lint),
    ("core", core),
    ("oracles", oracles),
    ("python", python),
    ("app", app),
    ("web", web),
    ("browser", browser),
];

/// The crates below the app, and the programs beside it.
const LIBRARIES: [&str; 10] = [
    "segue-text",
    "segue-text-derive",
    "segue-motion",
    "segue-fbx",
    "segue-formats",
    "segue-session",
    "segue-scene",
    "segue-corpus",
    "segue-batch",
    "segue-cli",
];

/// The first part that uses what [`install_for_tests`] installs.
const FIRST_WITH_PACKAGES: &str = "oracles";

/// The options of cargo for the app as it is tested: without what only a user's desktop needs.
const UI_TESTS: &[&str] = &["--no-default-features", "--features=segue/ui-tests"];

type Part = fn(&mut Report);

pub fn run(names: &[&str]) -> Result<()> {
    if let Some(unknown) = names.iter().find(|name| PARTS.iter().all(|(part, _)| part != *name)) {
        let known = PARTS.map(|(part, _)| part).join(", ");
        return fail(format!("there is no part `{unknown}`, only {known}"));
    }
    let mut report = Report::default();
    if !names.is_empty() {
        for (_, part) in PARTS.iter().filter(|(name, _)| names.contains(name)) {
            part(&mut report);
        }
        return report.close();
    }
    // The page ends in long links on one core: the other core builds and runs the tests meanwhile.
    let mut web = Some(Beside::start("web")?);
    // Downloads take minutes and hardly any computing time: they go on beside the first parts.
    let mut installing = Some(std::thread::spawn(install_for_tests));
    for (name, part) in PARTS {
        if let Some(installing) = installing.take_if(|_| name == FIRST_WITH_PACKAGES) {
            report.step("packages for tests, installed beside the above", || {
                installing.join().unwrap_or_else(|_| fail("the installation panicked"))
            });
        }
        match web.take_if(|web| web.part == name) {
            Some(web) => report.step("web build as deployed, beside the above", || web.finish()),
            None => part(&mut report),
        }
    }
    report.close()
}

/// Installs what the tests use beside Rust: a Vulkan driver, Chromium, packages of npm and PyPI.
fn install_for_tests() -> Result<()> {
    tools::software_vulkan()?;
    tools::chromium()?;
    tools::browser_packages()?;
    python_with_packages()?;
    Ok(())
}

/// Returns a Python with what builds and tests `import segue`, and with what reads exported files.
fn python_with_packages() -> Result<PathBuf> {
    let listed = fs::read_to_string(python_package().join("tests/requirements.txt"))?;
    let is_package = |line: &&str| !line.is_empty() && !line.starts_with('#');
    let packages: Vec<&str> = listed.lines().map(str::trim).filter(is_package).collect();
    tools::python(&packages)
}

fn python_package() -> PathBuf {
    root().join("crates/python")
}

/// A part that runs in a process of its own, beside the others.
struct Beside {
    part: &'static str,
    child: Child,
    log: PathBuf,
}

impl Beside {
    /// Starts a part, after installing what both this and the other process would install.
    fn start(part: &'static str) -> Result<Self> {
        tools::ensure_wasm_target()?;
        tools::clang()?;
        fs::create_dir_all(shell::target())?;
        let log = shell::target().join(format!("{part}.log"));
        let output = File::create(&log)?;
        let mut test = command(std::env::current_exe()?, &["test", part]);
        let child = test.stdout(output.try_clone()?).stderr(output).spawn()?;
        Ok(Self { part, child, log })
    }

    /// Waits for its end, and prints what it has written.
    fn finish(mut self) -> Result<()> {
        let status = self.child.wait()?;
        print!("{}", String::from_utf8_lossy(&fs::read(&self.log)?));
        if status.success() { Ok(()) } else { fail(format!("{} ended with {status}", self.part)) }
    }
}

fn lint(report: &mut Report) {
    report.run("rustfmt", cargo(&["fmt", "--all", "--check"]));
    if shell::is_ci() {
        return; // everything is checked by Clippy while it is compiled (lint.rs)
    }
    report.run("clippy", clippy(&[&["--workspace", "--all-targets"], UI_TESTS].concat()));
    report.step("clippy, web", || {
        tools::ensure_wasm_target()?;
        tools::clang()?;
        let modules = ["--target=wasm32-unknown-unknown", "--bin=segue-app"];
        shell::run(&mut clippy(&[&modules[..], &dist::WORKERS].concat()))
    });
}

fn clippy(what: &[&str]) -> Command {
    cargo(&[&["clippy", "--quiet", "--locked"], what, &["--", "-D", "warnings"]].concat())
}

fn core(report: &mut Report) {
    // Crate by crate: each must have all dependencies and features that it needs.
    report.step("each library by itself", || {
        LIBRARIES.iter().try_for_each(|library| {
            shell::run(&mut cargo(&["check", "--quiet", "--locked", "--package", library]))
        })
    });
    report.step("tests without the UI", || shell::run(&mut tests_without_ui()?));
    if shell::is_ci() {
        // For Clippy, which outside CI has checked them already.
        report.step("programs and benchmarks", || {
            shell::run(&mut without_ui(&["build", "--profile=test", "--bins", "--benches"])?)
        });
    }
}

/// Returns the command that runs the tests of the libraries and tools, and those across them.
fn tests_without_ui() -> Result<Command> {
    without_ui(&["test"])
}

/// Returns a call of cargo for the libraries and tools. It takes all at once: a library would
/// otherwise be built again for each set of features that the others ask of the packages below it.
fn without_ui(call: &[&str]) -> Result<Command> {
    let mut all = cargo(&[call, &["--quiet", "--locked", "--no-default-features"]].concat());
    let packages = ["segue", "segue-tools"];
    all.args(packages.iter().chain(&LIBRARIES).flat_map(|name| ["--package", name]));
    lint::while_building(&mut all)?;
    Ok(all)
}

fn oracles(report: &mut Report) {
    report.step("exported files in three.js, bvhio and NumPy", || {
        tools::browser_packages()?;
        let python = python_with_packages()?;
        shell::run(tests_without_ui()?.arg("--test=exchange"))?;
        let files = shell::target().join("tmp/exchange");
        shell::run(command("node", &["tests/browser/read_back.mjs"]).arg(&files))?;
        ["read_back.py", "read_back_npz.py"].iter().try_for_each(|script| {
            let script = root().join("crates/formats/tests/oracles").join(script);
            shell::run(command(&python, &[]).arg(script).arg(&files))
        })
    });
}

fn python(report: &mut Report) {
    report.step("import segue", || {
        let package = python_package();
        let python = python_with_packages()?;
        // By the profile of the tests: what lies below the libraries is built already, and the
        // wheel that users get takes minutes to optimise.
        let wheels = shell::target().join("wheels");
        fs::create_dir_all(&wheels)?;
        for old in fs::read_dir(&wheels)? {
            fs::remove_file(old?.path())?;
        }
        let build = ["-m", "maturin", "build", "--quiet", "--locked", "--profile=dev"];
        let mut maturin = command(&python, &build);
        shell::build_as_in_ci(&mut maturin);
        lint::while_building(&mut maturin)?;
        maturin.arg("--features=unified").arg("--out").arg(&wheels);
        shell::run(maturin.current_dir(&package))?;
        let wheel = fs::read_dir(&wheels)?.next().ok_or("maturin has made no wheel")??.path();
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        shell::run(command(&python, &install).args(["--no-deps", "--force-reinstall"]).arg(wheel))?;
        // The tests compare files of the package with those of the command line.
        let program = command_line()?;
        let mut tests = command(&python, &["-m", "pytest", "--quiet", "-p", "no:cacheprovider"]);
        tests.arg("tests").current_dir(&package);
        shell::run(tests.env("SEGUE_PROGRAM", program))
    });
}

/// Builds the command line, and returns its path. It is built as for its own tests: alone, it
/// would ask for other features of the packages below it.
fn command_line() -> Result<PathBuf> {
    shell::run(tests_without_ui()?.args(["--no-run", "--test=results"]))?;
    Ok(shell::target().join(format!("debug/segue{}", std::env::consts::EXE_SUFFIX)))
}

fn app(report: &mut Report) {
    report.step("tests, whole app", || {
        tools::software_vulkan()?;
        let mut app = cargo(&["test", "--locked", "--package=segue", "--bin=segue-app"]);
        lint::while_building(&mut app)?;
        shell::run(app.args(UI_TESTS))?;
        let mut xtask = cargo(&["test", "--locked", "--package=xtask"]);
        lint::while_building(&mut xtask)?;
        shell::run(&mut xtask)
    });
    if shell::is_ci() {
        // For Clippy, as above. The small test is built, too, because the libraries have other
        // features without any.
        report.step("the window and xtask, as they run", || {
            let window = ["--package=segue", "--bin=segue-app", "--test=language"];
            let mut app = cargo(&["build", "--quiet", "--locked", "--profile=test"]);
            lint::while_building(&mut app)?;
            shell::run(app.args(window).args(UI_TESTS))?;
            let mut xtask = cargo(&["check", "--quiet", "--locked", "--package=xtask"]);
            lint::while_building(&mut xtask)?;
            shell::run(&mut xtask)
        });
    }
}

fn web(report: &mut Report) {
    let build = |modules| move || dist::build(dist::Profile::Release, modules);
    report.step("web build", build(dist::Modules::One));
    report.step("the same page by Trunk", compare::with_trunk);
    report.step("web build as deployed", build(dist::Modules::Two));
}

fn browser(report: &mut Report) {
    report.step("browser tests", || {
        let chromium = tools::chromium()?;
        // Chromium, too: without one its WebGPU devices are lost with the first frame.
        tools::software_vulkan()?;
        tools::browser_packages()?;
        let program = command_line()?;
        let server = server::Server::bind(0, dist::folder())?;
        let address = server.address();
        std::thread::spawn(move || server.run());
        // Three files at a time: alone, a file leaves a quarter of two cores idle, and two leave a
        // twentieth. The tests wait for what they test and measure by their threads' own clocks, so
        // company does not matter to them.
        let mut node = command("node", &["--test", "--test-reporter=spec", "--test-concurrency=3"]);
        node.current_dir(root().join("tests/browser"))
            .env("SEGUE_URL", address)
            .env("SEGUE_PROGRAM", program)
            .env("CHROMIUM", chromium);
        shell::run(&mut node)
    });
}

/// A record of the steps: their results and durations.
#[derive(Default)]
struct Report {
    rows: Vec<(&'static str, Result<()>, Duration)>,
}

impl Report {
    fn run(&mut self, name: &'static str, mut command: Command) {
        self.step(name, || shell::run(&mut command));
    }

    /// Does one step. A failure is reported at the end, so that one run lists all of them.
    fn step(&mut self, name: &'static str, work: impl FnOnce() -> Result<()>) {
        println!("\n══ {name}");
        let start = Instant::now();
        let outcome = work();
        let time = start.elapsed();
        match &outcome {
            Ok(()) => println!("── {name}: {:.1} s", time.as_secs_f64()),
            Err(error) => println!("── {name}: FAILED after {:.1} s: {error}", time.as_secs_f64()),
        }
        self.rows.push((name, outcome, time));
    }

    fn close(self) -> Result<()> {
        println!("\n══ summary");
        for (name, outcome, time) in &self.rows {
            println!(
                "{:<8}{:>8.1} s  {name}",
                if outcome.is_ok() { "ok" } else { "FAILED" },
                time.as_secs_f64()
            );
        }
        let failed: Vec<_> = self
            .rows
            .iter()
            .filter(|(_, outcome, _)| outcome.is_err())
            .map(|(name, ..)| *name)
            .collect();
        if failed.is_empty() { Ok(()) } else { fail(format!("failed: {}", failed.join(", "))) }
    }
}
