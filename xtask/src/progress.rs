//! Parallel compilations with a progress line on the terminal.

use std::io::{IsTerminal as _, Read, Write as _};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use crate::shell::{Result, fail};

/// The interval of redrawing the line on a terminal.
const REDRAW: Duration = Duration::from_millis(500);
/// The interval of printing the line to a file or a log.
const REPRINT: Duration = Duration::from_secs(15);
/// The width for the names of the crates being compiled.
const MAX_COLUMNS: usize = 48;

/// A call of cargo, and a description of what it compiles.
pub struct Build {
    pub name: &'static str,
    pub cargo: Command,
}

/// Runs the compilations in parallel and waits for all of them. Messages of the compiler are passed
/// on; the error names the first failure.
pub fn run(builds: Vec<Build>) -> Result<()> {
    let screen = Screen { start: Instant::now(), is_terminal: std::io::stdout().is_terminal() };
    let mut running = Vec::new();
    for Build { name, mut cargo } in builds {
        cargo
            .env("CARGO_TERM_PROGRESS_WHEN", "always")
            .env("CARGO_TERM_PROGRESS_WIDTH", "120")
            .env("CARGO_TERM_COLOR", if screen.is_terminal { "always" } else { "never" })
            .stderr(Stdio::piped());
        match cargo.spawn() {
            Ok(child) => running.push((name, child)),
            Err(error) => return fail(format!("cargo did not start: {error}")),
        }
    }
    let states: Vec<Mutex<String>> =
        running.iter().map(|_| Mutex::new("starting".to_owned())).collect();
    let names: Vec<&str> = running.iter().map(|(name, _)| *name).collect();
    let mut ends = vec![None; running.len()];
    thread::scope(|scope| {
        for ((_, child), state) in running.iter_mut().zip(&states) {
            if let Some(output) = child.stderr.take() {
                scope.spawn(|| follow(output, state, &screen));
            }
        }
        let mut shown: Option<Instant> = None;
        while ends.iter().any(Option::is_none) {
            for (end, (_, child)) in ends.iter_mut().zip(&mut running) {
                *end = end.or_else(|| ended(child));
            }
            let period = if screen.is_terminal { REDRAW } else { REPRINT };
            if shown.is_none_or(|shown| shown.elapsed() >= period) {
                shown = Some(Instant::now());
                screen.show(&names, &states, &ends);
            }
            thread::sleep(Duration::from_millis(100));
        }
    });
    screen.clear();
    match names.iter().zip(ends).find(|(_, end)| *end != Some(true)) {
        Some((name, _)) => fail(format!("{name} does not compile")),
        None => Ok(()),
    }
}

/// Returns whether the process has succeeded; `None` while it runs.
fn ended(child: &mut Child) -> Option<bool> {
    match child.try_wait() {
        Ok(None) => None,
        Ok(Some(status)) => Some(status.success()),
        Err(_) => Some(false),
    }
}

/// Reads cargo's output until it ends: its progress bar goes into `state`, everything but its own
/// status lines to the terminal.
fn follow(mut output: impl Read, state: &Mutex<String>, screen: &Screen) {
    let mut line = Vec::new();
    let mut block = [0; 4096];
    while let Ok(count @ 1..) = output.read(&mut block) {
        for &byte in &block[..count] {
            if byte != b'\n' && byte != b'\r' {
                line.push(byte);
                continue;
            }
            let text = String::from_utf8_lossy(&line).into_owned();
            line.clear();
            match Line::of(&text) {
                Line::Progress(now) => {
                    if let Ok(mut state) = state.lock() {
                        *state = now;
                    }
                }
                Line::Status => {}
                Line::Message => screen.print(&text),
            }
        }
    }
}

/// The kind of a line of cargo's output.
#[derive(Debug, PartialEq)]
enum Line {
    /// The progress: "212/420 wgpu-core, naga".
    Progress(String),
    /// The start of one crate, or the end of all, which the progress includes.
    Status,
    /// A message of the compiler, or a failure.
    Message,
}

impl Line {
    fn of(line: &str) -> Self {
        let plain = without_colors(line);
        let mut words = plain.split_whitespace();
        match words.next() {
            Some("Building") => {
                let Some((_, rest)) = plain.split_once("] ") else { return Self::Status };
                let (count, crates) = rest.split_once(": ").unwrap_or((rest, ""));
                let names: String = crates.trim().chars().take(MAX_COLUMNS).collect();
                Self::Progress(format!("{} {names}", count.trim()).trim_end().to_owned())
            }
            Some("Downloading" | "Updating" | "Blocking") => {
                Self::Progress(plain.trim().to_owned())
            }
            None
            | Some("Compiling" | "Finished" | "Fresh" | "Downloaded" | "Locking" | "Adding") => {
                Self::Status
            }
            Some(_) => Self::Message,
        }
    }
}

/// Removes the escape sequences of colours and of erased lines.
fn without_colors(text: &str) -> String {
    let mut plain = String::new();
    let mut chars = text.chars();
    while let Some(char) = chars.next() {
        if char == '\u{1b}' {
            // `ESC [`, numbers, and a letter that ends it.
            chars.find(char::is_ascii_alphabetic);
        } else {
            plain.push(char);
        }
    }
    plain
}

struct Screen {
    start: Instant,
    is_terminal: bool,
}

impl Screen {
    fn show(&self, names: &[&str], states: &[Mutex<String>], ends: &[Option<bool>]) {
        let parts: Vec<String> = names
            .iter()
            .zip(states)
            .zip(ends)
            .filter(|(_, end)| end.is_none())
            .map(|((name, state), _)| {
                format!("{name} {}", state.lock().map_or_else(|_| String::new(), |now| now.clone()))
            })
            .collect();
        if parts.is_empty() {
            return;
        }
        let secs = self.start.elapsed().as_secs();
        let line = format!("  {}:{:02}  {}", secs / 60, secs % 60, parts.join(" · "));
        if self.is_terminal {
            print!("\r{}\u{1b}[K", line.chars().take(118).collect::<String>());
            // A line that could not be shown is no reason to stop compiling.
            drop(std::io::stdout().flush());
        } else {
            println!("{line}");
        }
    }

    fn print(&self, message: &str) {
        self.clear();
        eprintln!("{message}");
    }

    fn clear(&self) {
        if self.is_terminal {
            print!("\r\u{1b}[K");
            drop(std::io::stdout().flush());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_a_progress_bar_gives_count_and_names() {
        for line in [
            "    Building [====>   ] 57/67: wasmparser, itoa        ",
            "\u{1b}[1m\u{1b}[96m    Building\u{1b}[0m [====>   ] 57/67: wasmparser, itoa \u{1b}[K",
        ] {
            assert_eq!(Line::of(line), Line::Progress("57/67 wasmparser, itoa".to_owned()));
        }
    }

    #[test]
    fn line_of_the_compiler_is_a_message() {
        for line in
            ["error[E0308]: mismatched types", "  --> src/main.rs:3:4", "3 | let x: u8 = 1;"]
        {
            assert_eq!(Line::of(line), Line::Message, "{line}");
        }
        for line in ["   Compiling walrus v0.27.3", "    Finished `dev` profile", "", "\u{1b}[K"] {
            assert_eq!(Line::of(line), Line::Status, "{line}");
        }
    }
}
