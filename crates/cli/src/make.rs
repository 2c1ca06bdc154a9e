//! The commands that make results by a lab: their options, and what they print and write.

use crate::labs::LabCommand;
use crate::progress;
use crate::read::ReadArgs;
use crate::result::{Made, collect, tell};
use crate::status::{Failure, Status};
use crate::write::{Outputs, WriteArgs};
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use clap::{Arg, ArgMatches, Args, FromArgMatches as _};
use rayon::prelude::*;
use segue_batch::{
    BatchError, Clip, ClipFile, Clips, Driven, Ingredients, Input, Inputs, PAGE, known_clip,
    value_of,
};
use segue_session::export::ExportOptions;
use segue_session::{Key, Kind, LabId, ListKind, PARAMS, Param, Session, Value};
use std::cell::LazyCell;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The number of clips whose results are made before they are written, for each core.
const CLIPS_PER_CORE: usize = 8;

/// The help of clips.
const CLIPS: &str = "Files, folders, patterns; or ids of built-in clips such as walk, and recipes such as 'run(turn_rate:20)'. Without any, those of the page";

/// The help of `--set`.
const SET: &str = "Sets any parameter by its key in links: --set compare=blend_window:30,15";

/// The arguments that all labs have.
#[derive(Args, Debug)]
pub(crate) struct MakeArgs {
    #[arg(value_name = "CLIP", help = CLIPS)]
    clips: Vec<OsString>,
    /// File, or folder for several results
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Makes the result of a Segue link; its files are named on the command line, in any order.
    /// Options replace values of the link
    #[arg(long, value_name = "URL")]
    link: Option<String>,
    #[arg(long, value_name = "KEY=VALUE", help = SET)]
    set: Vec<String>,
    /// Prints the link of the result
    #[arg(long)]
    print_link: bool,
    /// The address of the page in printed links
    #[arg(long, value_name = "URL", default_value = PAGE)]
    page: String,
    /// Prints JSON: a list with an object for each result
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    write: WriteArgs,
    #[command(flatten)]
    read: ReadArgs,
}

/// The id of the option for the file with the body.
const BODY: &str = "body";

/// Returns the parser of a command's arguments.
pub(crate) fn parser(command: &'static LabCommand) -> clap::Command {
    let name = command.name.rsplit(' ').next().unwrap_or(command.name);
    let mut parser = MakeArgs::augment_args(clap::Command::new(name))
        .about(command.about)
        .after_help(command.examples_help());
    if command.clips() == Clips::None {
        parser = parser.mut_arg("clips", |arg| arg.hide(true));
    }
    if command.takes_body {
        let body = Arg::new(BODY).long(BODY).value_name("FILE").required_unless_present("link");
        let body = body.value_parser(clap::value_parser!(PathBuf));
        parser = parser.arg(body.help("The file with the body: its first clip"));
    }
    parser.next_help_heading("Parameters").args(parameters(command).map(option))
}

/// Returns the parameters that a command's result is made from, without its clips.
fn parameters(command: &LabCommand) -> impl Iterator<Item = &'static Param> {
    let lab = command.lab_id();
    PARAMS.iter().filter(move |param| {
        lab.is_some_and(|lab| param.is_ingredient_of(lab))
            && !matches!(param.kind, Kind::Clip | Kind::List(ListKind::ClipIds))
    })
}

/// The value of an option.
type Assigned = (Key, Value);

/// Returns the option of a parameter.
fn option(param: &'static Param) -> Arg {
    let default = param.format(&param.default_value());
    let default = if default.is_empty() { String::new() } else { format!("; default {default}") };
    let parse = |text: &str| -> Result<Assigned, String> {
        let value = param.parse(text).map_err(|error| error.to_string())?;
        Ok((param.key, value))
    };
    let arg = Arg::new(param.name).long(param.name.replace('_', "-"));
    let help = |values: &str| format!("{} [{values}{default}]", param.help);
    let words = |words: Vec<&'static str>| {
        PossibleValuesParser::new(words).try_map(move |word| parse(&word))
    };
    match param.kind {
        Kind::Number { min, max, auto, .. } => arg
            .value_name("NUMBER")
            .allow_negative_numbers(true)
            .help(help(&format!(
                "{min} to {max}{}{}{}",
                if param.unit.is_empty() { "" } else { " " },
                param.unit,
                if auto { ", or auto" } else { "" }
            )))
            .value_parser(parse),
        Kind::Switch => {
            arg.value_name("ON|OFF").help(help("on, off")).value_parser(words(vec!["on", "off"]))
        }
        Kind::Choice(choices) => {
            let known: Vec<&str> = choices.iter().map(|choice| choice.key).collect();
            let text = help(&known.join(", "));
            arg.value_name("WORD").help(text).value_parser(words(known))
        }
        _ => arg.value_name("TEXT").allow_hyphen_values(true).help(param.help).value_parser(parse),
    }
    .hide_possible_values(true)
}

/// Returns the values that the options and `--set` name.
fn values(
    command: &LabCommand,
    args: &MakeArgs,
    matches: &ArgMatches,
) -> Result<Vec<Assigned>, Failure> {
    let named = parameters(command).filter_map(|param| matches.get_one::<Assigned>(param.name));
    let mut values: Vec<Assigned> = named.cloned().collect();
    for pair in &args.set {
        let (name, text) = pair
            .split_once('=')
            .ok_or_else(|| Failure::usage(format!("--set: found `{pair}`, expected key=value")))?;
        let value = value_of(name, text).map_err(|error| match error {
            BatchError::NoParameter(_) => Failure::usage(format!("--set: {error}")),
            other => other.into(),
        });
        values.push(value?);
    }
    Ok(values)
}

/// One run of a session: its clips, and the place of its results.
struct Job {
    clips: Vec<Source>,
    /// The path of its results in the folder, without an ending; `None` to name them by the lab.
    relative: Option<PathBuf>,
}

impl Job {
    /// Returns the name of its only clip; the empty text where it has several.
    fn source(&self) -> &str {
        match self.clips.as_slice() {
            [Source::File(file)] => &file.name,
            [Source::Known(id)] => id,
            _ => "",
        }
    }
}

/// A clip before it is read.
#[derive(Clone)]
enum Source {
    File(Input),
    Known(String),
}

/// Makes the results of a command.
///
/// # Errors
/// [`Failure`] if the command line is wrong, or nothing could be made.
pub(crate) fn run(command: &'static LabCommand, matches: &ArgMatches) -> Result<Status, Failure> {
    let args =
        MakeArgs::from_arg_matches(matches).map_err(|error| Failure::usage(error.to_string()))?;
    let values = values(command, &args, matches)?;
    let (sources, problems) = sources(&args.clips)?;
    let files: Vec<Input> = sources
        .iter()
        .filter_map(|source| match source {
            Source::File(file) => Some(file.clone()),
            Source::Known(_) => None,
        })
        .collect();
    let out = args.output.as_deref();
    let is_file = out.is_some_and(|out| args.write.is_file(out));
    let export = out.map(|out| args.write.options(is_file.then_some(out))).transpose()?;
    let mut outputs = out.map(|out| Outputs::new(out, is_file, &files));
    let lab = command.lab_id().ok_or_else(|| Failure::usage("it has no lab"))?;
    let load = |path: &PathBuf| ClipFile::load(path, args.read.options().max_bytes);
    let skeletons = args.read.skeletons().iter().map(load).collect::<Result<Vec<_>, _>>()?;
    let body = command.takes_body.then(|| matches.get_one::<PathBuf>(BODY)).flatten();
    let body = body.map(|path| load(path).map(Clip::File)).transpose()?;
    let jobs = jobs(command, args.link.is_some(), sources);
    let context = Context {
        command,
        lab,
        link: args.link.as_deref(),
        skeletons: &skeletons,
        body: body.as_ref(),
        values: &values,
        read: &args.read,
        export: export.as_ref(),
        page: &args.page,
    };
    let bar = progress::bar(jobs.len(), "making");
    let mut rows = Vec::new();
    for part in jobs.chunks(CLIPS_PER_CORE * rayon::current_num_threads().max(1)) {
        let made: Vec<Result<Vec<Made>, Failure>> = part
            .par_iter()
            .map(|job| {
                let made = context.run(job);
                bar.inc(1);
                made
            })
            .collect();
        for (job, made) in part.iter().zip(made) {
            match made {
                // A single run says by itself why it failed.
                Err(failure) if jobs.len() == 1 => return Err(failure),
                Err(failure) => rows.push(Made::failed(job.source(), &failure)),
                Ok(made) => rows.extend(made),
            }
        }
        if let Some(outputs) = &mut outputs {
            for row in &mut rows {
                row.write(outputs);
            }
        }
    }
    bar.finish_and_clear();
    let mut status = rows.iter().map(Made::status).max().unwrap_or(Status::Fine);
    if !problems.is_empty() {
        status = Status::Unreadable;
    }
    tell(&rows, args.json, args.print_link)?;
    for problem in &problems {
        eprintln!("segue: {problem}");
    }
    Ok(status)
}

/// Returns the clips that some words name, and the words that name none.
fn sources(words: &[OsString]) -> Result<(Vec<Source>, Vec<String>), Failure> {
    let mut all = Vec::new();
    let mut inputs = Inputs::default();
    let session = LazyCell::new(Session::new);
    for word in words {
        let name = word.to_str().filter(|_| !Path::new(word).exists());
        if let Some(id) = name.and_then(|name| known_clip(&session, name)) {
            all.push(Source::Known(id));
            continue;
        }
        let before = inputs.files.len();
        inputs.add(word);
        all.extend(inputs.files.iter().skip(before).cloned().map(Source::File));
    }
    if all.is_empty() && !inputs.problems.is_empty() {
        return Err(Failure::unreadable(inputs.problems.join("\n")));
    }
    Ok((all, inputs.problems))
}

/// Returns the runs: one for each clip where each gives a result of its own, otherwise one.
fn jobs(command: &LabCommand, has_link: bool, sources: Vec<Source>) -> Vec<Job> {
    if command.clips() != Clips::Each || has_link || sources.is_empty() {
        return vec![Job { clips: sources, relative: None }];
    }
    let job = |source: Source| {
        let relative = match &source {
            Source::File(file) => file.relative.with_extension(""),
            Source::Known(id) => PathBuf::from(id),
        };
        Job { clips: vec![source], relative: Some(relative) }
    };
    sources.into_iter().map(job).collect()
}

/// All that the runs have in common.
struct Context<'a> {
    command: &'static LabCommand,
    lab: LabId,
    link: Option<&'a str>,
    skeletons: &'a [ClipFile],
    body: Option<&'a Clip>,
    values: &'a [Assigned],
    read: &'a ReadArgs,
    export: Option<&'a ExportOptions>,
    page: &'a str,
}

impl Context<'_> {
    fn run(&self, job: &Job) -> Result<Vec<Made>, Failure> {
        let max_bytes = self.read.options().max_bytes;
        let clips = job.clips.iter().map(|source| match source {
            Source::Known(id) => Ok(Clip::Known(id.clone())),
            Source::File(file) => Ok(Clip::File(ClipFile::load(&file.path, max_bytes)?)),
        });
        let clips = clips.collect::<Result<Vec<_>, Failure>>()?;
        let mut driven = Driven::new(&Ingredients {
            link: self.link,
            skeletons: self.skeletons,
            clips,
            body: self.body,
            values: self.values,
            options: self.read.options(),
            ..Ingredients::of(self.lab)
        })?;
        let mut all = Vec::new();
        for variant in self.variants(&driven) {
            if let Some(values) = variant.values {
                driven.set(values)?;
            }
            driven.settle();
            let relative = job.relative.clone().map(|relative| match &variant.clip {
                Some(clip) => {
                    let stem = relative.file_name().unwrap_or_default().to_string_lossy();
                    relative.with_file_name(format!("{stem} {clip}"))
                }
                None => relative,
            });
            let name = variant.name.or(variant.clip);
            all.extend(collect(
                &driven,
                job.source(),
                name.as_deref(),
                relative.as_deref(),
                self.export,
                self.page,
            ));
        }
        Ok(all)
    }

    /// Returns the states of one session that are asked for: each clip of a file, each scenario of
    /// recorded input; otherwise the one that is set.
    fn variants(&self, driven: &Driven) -> Vec<Variant> {
        if self.command.clips() == Clips::Each && self.link.is_none() && !driven.ids.is_empty() {
            let several = driven.ids.len() > 1;
            let name = |id: &String| {
                let entry = driven.session.library().get(id);
                entry.map_or_else(|| id.clone(), |entry| entry.name.clone())
            };
            let of_clip = |id: &String| Variant {
                name: None,
                clip: several.then(|| name(id)),
                values: Some(vec![(Key::A, Value::Text(id.clone()))]),
            };
            return driven.ids.iter().map(of_clip).collect();
        }
        let params = driven.session.params();
        let drives = Key::Scenario.param().is_ingredient_of(params.lab());
        let is_chosen =
            [Key::Scenario, Key::Drive, Key::Compare].iter().any(|key| params.is_changed(*key));
        let Kind::Choice(scenarios) = Key::Scenario.param().kind else {
            return vec![Variant::default()];
        };
        if !drives || is_chosen {
            return vec![Variant::default()];
        }
        // The first one is the user's own input.
        let of_scenario = |choice: &segue_session::Choice| Variant {
            name: Some(choice.label.to_owned()),
            clip: None,
            values: Some(vec![(Key::Scenario, Value::Choice(choice.key))]),
        };
        scenarios.iter().skip(1).map(of_scenario).collect()
    }
}

/// A state of a session.
#[derive(Default)]
struct Variant {
    /// Its name among the others.
    name: Option<String>,
    /// The name of its clip, where the file has several.
    clip: Option<String>,
    values: Option<Vec<Assigned>>,
}

#[cfg(test)]
mod tests {
    use crate::labs::LAB_COMMANDS;

    #[test]
    fn every_command_has_a_valid_parser() {
        for command in LAB_COMMANDS {
            super::parser(command).debug_assert();
            assert!(super::parameters(command).count() > 0, "{}", command.name);
        }
    }
}
