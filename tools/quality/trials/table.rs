//! The outcomes of the trials, in Markdown and as JSON.

use super::folder::Motions;
use super::trial::{Draw, Numbers, Trial, TrialResult};
use segue_motion::math::stats::median;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The greatest number of rows in the list of faults.
const MAX_FAULTS: usize = 60;

/// Returns the tables in Markdown.
#[must_use]
pub fn markdown(motions: &Motions, trials: &[Trial]) -> String {
    let mut out = String::new();
    for draw in [Draw::SameRig, Draw::OtherRigs, Draw::Set] {
        let own: Vec<&Trial> = trials.iter().filter(|trial| trial.draw == draw).collect();
        if !own.is_empty() {
            write_methods(&mut out, draw, &own);
        }
    }
    write_refusals(&mut out, motions, trials);
    write_faults(&mut out, trials);
    out
}

/// Writes a line; writing to a string cannot fail.
macro_rules! line {
    ($out:expr, $($part:tt)*) => {
        writeln!($out, $($part)*).ok();
    };
}

fn write_methods(out: &mut String, draw: Draw, trials: &[&Trial]) {
    line!(out, "### {}\n", draw.title());
    line!(
        out,
        "Skating in cm/s and the median slide of a stance in cm are means over the results: free / feet planted / the sources. Flashes and root jumps: all, \
         and in brackets those faster than anything in the sources. Held: results that are held to the bounds, and how many of them break one.\n"
    );
    line!(
        out,
        "| lab, method | made | refused | panics | not finite | spins | flashes | root jumps | skating | stance | held | slowest |"
    );
    line!(out, "|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut methods: Vec<(&str, &str)> = Vec::new();
    for trial in trials {
        let name = (trial.lab, trial.method.as_str());
        if !methods.contains(&name) {
            methods.push(name);
        }
    }
    for (lab, method) in methods {
        let own: Vec<&&Trial> =
            (trials.iter()).filter(|trial| trial.lab == lab && trial.method == method).collect();
        let count =
            |is: fn(&TrialResult) -> bool| own.iter().filter(|trial| is(&trial.result)).count();
        let made: Vec<(bool, &Numbers)> =
            own.iter().filter_map(|trial| Some((trial.locked, numbers(trial)?))).collect();
        let sum =
            |of: fn(&Numbers) -> usize| made.iter().map(|(_, numbers)| of(numbers)).sum::<usize>();
        let mean = |locked: Option<bool>, of: fn(&Numbers) -> Option<f64>| {
            let values: Vec<f64> = (made.iter())
                .filter(|(is_locked, _)| locked.is_none_or(|locked| locked == *is_locked))
                .filter_map(|(_, numbers)| of(numbers))
                .collect();
            if values.is_empty() {
                "–".to_owned()
            } else {
                format!("{:.1}", values.iter().sum::<f64>() / values.len() as f64)
            }
        };
        let three = |own: fn(&Numbers) -> Option<f64>, source: fn(&Numbers) -> Option<f64>| {
            format!(
                "{} / {} / {}",
                mean(Some(false), own),
                mean(Some(true), own),
                mean(None, source)
            )
        };
        let (bound, broken) = own
            .iter()
            .filter(|trial| trial.bound && numbers(trial).is_some())
            .fold((0, 0), |(all, broken), trial| {
                (all + 1, broken + usize::from(!trial.faults().is_empty()))
            });
        let slowest = own.iter().map(|trial| trial.secs).fold(0.0, f64::max);
        line!(
            out,
            "| {lab}, {method} | {} | {} | {} | {} | {} | {} ({}) | {} ({}) | {} | {} | {bound}, {broken} | {} |",
            made.len(),
            count(|result| matches!(result, TrialResult::Refused(_) | TrialResult::Silent)),
            count(|result| matches!(result, TrialResult::Panicked(_))),
            sum(|numbers| usize::from(numbers.not_finite)),
            sum(|numbers| numbers.spins),
            sum(|numbers| numbers.flashes),
            sum(|numbers| numbers.new_flashes),
            sum(|numbers| numbers.root_jumps),
            sum(|numbers| numbers.new_root_jumps),
            three(|numbers| numbers.skating, |numbers| numbers.source_skating),
            three(|numbers| numbers.stance_cm, |numbers| numbers.source_stance_cm),
            if slowest < 1.0 {
                format!("{:.0} ms", slowest * 1e3)
            } else {
                format!("{slowest:.1} s")
            },
        );
    }
    line!(out, "");
}

fn numbers(trial: &Trial) -> Option<&Numbers> {
    match &trial.result {
        TrialResult::Made(numbers) => Some(numbers),
        _ => None,
    }
}

/// Returns a sentence without its variable parts: names of takes and numbers.
fn general(sentence: &str, names: &[String]) -> String {
    let mut general = sentence.to_owned();
    for name in names {
        let stem = name.rsplit('/').next().unwrap_or(name);
        let stem = stem.rsplit_once('.').map_or(stem, |(stem, _)| stem);
        if stem.len() > 1 {
            general = general.replace(name, "…").replace(stem, "…");
        }
    }
    let mut digits = false;
    general.retain(|c| {
        let repeats = digits && (c.is_ascii_digit() || c == '.');
        digits = c.is_ascii_digit() || repeats;
        !repeats
    });
    general.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).collect()
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\r', '\n'], " ")
}

fn write_refusals(out: &mut String, motions: &Motions, trials: &[Trial]) {
    let mut sentences: BTreeMap<(String, String), usize> = BTreeMap::new();
    for (path, sentence) in &motions.refused {
        let of = ("reading".to_owned(), general(sentence, std::slice::from_ref(path)));
        *sentences.entry(of).or_default() += 1;
    }
    for (path, place) in &motions.panics {
        *sentences.entry(("reading".to_owned(), format!("PANIC {place}: {path}"))).or_default() +=
            1;
    }
    for trial in trials {
        let sentence = match &trial.result {
            TrialResult::Made(_) => continue,
            TrialResult::Refused(sentence) => general(sentence, &trial.takes),
            TrialResult::Silent => "NO WORD".to_owned(),
            TrialResult::Panicked(place) => format!("PANIC {place}"),
        };
        *sentences.entry((trial.lab.to_owned(), sentence)).or_default() += 1;
    }
    if sentences.is_empty() {
        return;
    }
    line!(out, "### Refusals\n\n| times | lab | sentence |\n|---|---|---|");
    let mut rows: Vec<_> = sentences.into_iter().collect();
    rows.sort_by_key(|(_, times)| std::cmp::Reverse(*times));
    for ((lab, sentence), times) in rows {
        line!(out, "| {times} | {lab} | {} |", cell(&sentence));
    }
    line!(out, "");
}

fn write_faults(out: &mut String, trials: &[Trial]) {
    let faulty: Vec<(&Trial, Vec<&str>)> = (trials.iter())
        .map(|trial| (trial, trial.faults()))
        .filter(|(_, faults)| !faults.is_empty())
        .collect();
    line!(out, "### Worse than their sources: {} of {} results\n", faulty.len(), trials.len());
    if faulty.is_empty() {
        return;
    }
    line!(out, "| what | takes | where | link |\n|---|---|---|---|");
    for (trial, faults) in faulty.iter().take(MAX_FAULTS) {
        let mut place = String::new();
        if let Some(numbers) = numbers(trial) {
            if let Some((frame, joint, times)) = &numbers.first_flash {
                write!(place, "frame {frame}, {joint}, {times:.1} times; ").ok();
            }
            if let (Some(own), Some(source)) = (numbers.skating, numbers.source_skating) {
                write!(place, "skating {own:.1} of {source:.1} cm/s").ok();
            }
        }
        let takes = cell(&trial.takes.join(", "));
        line!(
            out,
            "| {} | {takes} | {} | `?{}` |",
            faults.join(", "),
            cell(&place),
            cell(&trial.link)
        );
    }
    if faulty.len() > MAX_FAULTS {
        line!(out, "| and {} more | | | |", faulty.len() - MAX_FAULTS);
    }
}

/// Returns all results as JSON.
#[must_use]
pub fn json(motions: &Motions, trials: &[Trial]) -> serde_json::Value {
    let faults: Vec<Vec<&str>> = trials.iter().map(Trial::faults).collect();
    let skating: Vec<f64> = trials
        .iter()
        .filter(|trial| trial.locked)
        .filter_map(|trial| numbers(trial)?.skating)
        .collect();
    serde_json::json!({
        "takes": motions.takes.iter().map(|take| &take.name).collect::<Vec<_>>(),
        "refused_files": motions.refused,
        "panicked_files": motions.panics,
        "median_skating_locked": median(&skating),
        "faults": faults,
        "trials": trials,
    })
}
