//! `segue`: motion files on the command line, by the code of the page.
//!
//! `segue --help` lists the commands; the crate's README has the tour.

mod convert;
mod corpus;
mod info;
mod labs;
mod lint;
mod make;
mod numbers;
mod open;
mod progress;
mod read;
mod result;
mod server;
mod status;
mod table;
mod write;

use clap::{ArgMatches, Args as _, Command, FromArgMatches, ValueEnum};
use clap_complete::Shell;
use labs::LAB_COMMANDS;
use mimalloc::MiMalloc;
use status::{EXIT_CODES, Failure, Status};
use std::io::{self, Write as _};
use std::process::ExitCode;

/// Asks for huge pages: large files are read in a fifth less time.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The part of the main help behind the commands.
const EXAMPLES: &str = "\
Examples:
  segue info walk.bvh
  segue convert takes -o glb --to glb
  segue lint takes --fail-on 'spin,skating>3cm/s'
  segue blend walk.bvh run.bvh -o blend.bvh --print-link";

fn main() -> ExitCode {
    let matches = match parser().try_get_matches() {
        Ok(matches) => matches,
        Err(error) => {
            // Nothing can be said where standard error is closed.
            error.print().ok();
            let is_help = error.exit_code() == 0;
            return if is_help { Status::Fine } else { Status::Usage }.into();
        }
    };
    match run(&matches) {
        Ok(status) => status.into(),
        Err(failure) => {
            if let Some(text) = failure.text() {
                eprintln!("segue: {text}");
            }
            failure.status.into()
        }
    }
}

/// Returns the parser of the command line.
fn parser() -> Command {
    let command = Command::new;
    let mut parser = command("segue")
        .version(env!("CARGO_PKG_VERSION"))
        .about("Motion files: read, convert, check, clean and join them, by the code of the page")
        .after_help(format!("{EXAMPLES}\n\n{EXIT_CODES}"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(
            info::InfoArgs::augment_args(command("info"))
                .about("Tells what files contain: rig, frames, unit, up axis, artefacts")
                .after_help(info::EXAMPLES),
        )
        .subcommand(
            convert::ConvertArgs::augment_args(command("convert"))
                .about("Writes any motion file as another")
                .after_help(convert::EXAMPLES),
        )
        .subcommand(
            lint::LintArgs::augment_args(command("lint"))
                .about("Finds faults of motion files, for CI")
                .after_help(lint::examples()),
        );
    for own in LAB_COMMANDS {
        let lab = make::parser(own);
        parser = parser.subcommand(match own.name.split_once(' ') {
            // A group with one command, which others will join.
            Some((group, _)) => command(group)
                .about(own.about)
                .subcommand_required(true)
                .arg_required_else_help(true)
                .subcommand(lab),
            None => lab,
        });
    }
    let build = corpus::BuildArgs::augment_args(command("build"))
        .about("Makes a corpus of motion files, or adds to it what is new")
        .after_help(corpus::EXAMPLES);
    parser
        .subcommand(
            command("corpus")
                .about("Makes a corpus of thousands of files, to be searched and opened in the page")
                .subcommand_required(true)
                .arg_required_else_help(true)
                .subcommand(build),
        )
        .subcommand(
            open::OpenArgs::augment_args(command("open"))
                .about("Opens files in the page, served by this machine for itself")
                .after_help(open::EXAMPLES),
        )
        .subcommand(
            command("completions")
                .about("Prints the completions of a shell")
                .arg(clap::arg!(<SHELL> "The shell").value_parser(clap::value_parser!(Shell)))
                .after_help("Example:\n  segue completions bash > ~/.local/share/bash-completion/completions/segue"),
        )
}

/// Carries out the command.
fn run(matches: &ArgMatches) -> Result<Status, Failure> {
    let Some((name, matches)) = matches.subcommand() else {
        return Err(Failure::usage("no command: `segue --help` lists them"));
    };
    match name {
        "info" => info::run(&args(matches)?),
        "convert" => convert::run(&args(matches)?),
        "lint" => lint::run(&args(matches)?),
        "open" => open::run(&args(matches)?),
        "corpus" => {
            let build = matches.subcommand_matches("build");
            let unknown = || Failure::usage("`segue corpus` is followed by `build`");
            corpus::build(&args(build.ok_or_else(unknown)?)?)
        }
        "completions" => complete(matches),
        _ => {
            let (name, matches) = match matches.subcommand() {
                Some((inner, matches)) => (format!("{name} {inner}"), matches),
                None => (name.to_owned(), matches),
            };
            let command = LAB_COMMANDS.iter().find(|command| command.name == name);
            let unknown = || Failure::usage(format!("there is no command `{name}`"));
            make::run(command.ok_or_else(unknown)?, matches)
        }
    }
}

/// Returns the arguments of a command.
fn args<T: FromArgMatches>(matches: &ArgMatches) -> Result<T, Failure> {
    T::from_arg_matches(matches).map_err(|error| Failure::usage(error.to_string()))
}

/// Prints the completions of a shell.
fn complete(matches: &ArgMatches) -> Result<Status, Failure> {
    let shell = matches.get_one::<Shell>("SHELL").copied();
    let shell = shell.ok_or_else(|| {
        let known: Vec<_> = Shell::value_variants().iter().map(ToString::to_string).collect();
        Failure::usage(format!("expected a shell: {}", known.join(", ")))
    })?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut parser(), "segue", &mut script);
    io::stdout().write_all(&script)?;
    Ok(Status::Fine)
}

#[cfg(test)]
mod tests {
    #[test]
    fn parser_is_valid() {
        super::parser().debug_assert();
    }
}
