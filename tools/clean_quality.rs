//! Measures how well faults are found and mended: puts faults into takes of a folder, or into
//! synthesised ones, and compares what is found with what was put in, and the mended takes with the
//! originals. Prints tables in Markdown. `cargo xtask clean-quality` runs it.

#![expect(clippy::print_stdout, reason = "the tables are what it is for")]

use segue_formats::acclaim::{read_motion, read_skeleton};
use segue_formats::{ImportOptions, import};
use segue_motion::clean::{
    Damage, Fault, FaultKind, MendOptions, damage, false_alarms, find_faults, mend,
};
use segue_motion::clip::{Clip, Motion};
use segue_motion::metrics::{MotionTrace, ResultMetrics};
use segue_motion::synth::{Action, Params, synthesize};
use std::error::Error;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

/// The shortest take that is used, seconds.
const MIN_SECS: f64 = 1.5;
/// The bars: the share of faults that is found, false alarms per minute, and the artefacts of the
/// mended takes in terms of the originals'.
const MIN_FOUND: f64 = 0.95;
const MAX_FALSE_PER_MIN: f64 = 2.0;
const MAX_RATIO: f64 = 1.5;

struct Arguments {
    folder: Option<PathBuf>,
    takes: usize,
    faults: usize,
    seed: u64,
    tells: bool,
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut found = Arguments { folder: None, takes: 20, faults: 100, seed: 1, tells: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} is followed by a value"));
        match word.as_str() {
            "--data" => found.folder = Some(value()?.into()),
            "--takes" => found.takes = value()?.parse()?,
            "--faults" => found.faults = value()?.parse()?,
            "--seed" => found.seed = value()?.parse()?,
            "--each" => found.tells = value()? == "on",
            _ => {
                let known = "--data, --takes, --faults, --seed and --each";
                return Err(format!("there is no argument {word}, only {known}").into());
            }
        }
    }
    Ok(found)
}

/// Returns the files below a folder, sorted by path.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let (mut folders, mut files) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder)? {
            let entry = entry?;
            let list = if entry.file_type()?.is_dir() { &mut folders } else { &mut files };
            list.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}

/// Returns the takes of a folder that can be read and last long enough, with their names.
fn takes_of(folder: &Path) -> Result<Vec<(String, Clip)>, Box<dyn Error>> {
    let files = files_below(folder)?;
    let options = ImportOptions::default();
    let mut takes = Vec::new();
    for path in &files {
        let name = path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned();
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let read = match ending.as_str() {
            "bvh" | "glb" | "fbx" => import(&name, &std::fs::read(path)?, &options),
            "amc" => {
                let beside = |other: &&PathBuf| {
                    other.parent() == path.parent() && other.extension().is_some_and(|e| e == "asf")
                };
                let own = path.with_extension("asf");
                let Some(asf) = files.iter().find(|p| **p == own).or(files.iter().find(beside))
                else {
                    continue;
                };
                let bytes = std::fs::read(asf)?;
                let skeleton = read_skeleton(&asf.to_string_lossy(), &bytes, &options)?;
                read_motion(&name, &std::fs::read(path)?, &skeleton, &options)
            }
            _ => continue,
        };
        // Files that are refused are tested elsewhere.
        let clips = read.map(|file| file.clips).unwrap_or_default();
        takes.extend(clips.into_iter().map(|read| (name.clone(), read.clip)));
    }
    takes.retain(|(_, clip)| clip.duration_secs() >= MIN_SECS);
    Ok(takes)
}

/// Returns synthesised takes: all actions in turn, each time another person.
fn synthesised(count: usize) -> Result<Vec<(String, Clip)>, Box<dyn Error>> {
    (0..count)
        .map(|number| {
            let action = Action::ALL[number % Action::ALL.len()];
            let params = Params {
                seed: number as u32 + 1,
                duration_secs: 6.0,
                fps: [30.0, 60.0, 120.0][number % 3],
                ..Params::new(action)
            };
            Ok((format!("{action:?} {number}"), synthesize(&params)?.clip))
        })
        .collect()
}

/// The artefacts of a clip in the frames around its faults.
#[derive(Clone, Copy, Default)]
struct Artefacts {
    /// The largest turn of a joint in a step beyond the usual, degrees.
    pose_jump: f64,
    /// The largest change of angular velocity beyond the usual, degrees per second.
    velocity_jump: f64,
    skating: f64,
    /// Root mean square of the second differences of all joints' positions in the damaged frames,
    /// millimetres.
    roughness: f64,
}

impl Artefacts {
    fn of(motion: &Motion, damages: &[Damage]) -> Self {
        let trace = MotionTrace::new(motion.clip(), motion.roles());
        let numbers = ResultMetrics::measure(&trace, &[]);
        let joints = motion.clip().skeleton().len();
        let (mut sum, mut count) = (0.0, 0.0);
        for damage in damages {
            let frames = around(&damage.frames, motion.clip(), 2);
            let places = motion.clip().world_positions(frames);
            for at in 0..places.len().saturating_sub(2 * joints) {
                let bend = places[at] - places[at + joints] * 2.0 + places[at + 2 * joints];
                sum += f64::from(bend.length_squared());
                count += 1.0;
            }
        }
        Self {
            pose_jump: numbers.pose_jump_deg.unwrap_or(0.0),
            velocity_jump: numbers.velocity_jump_dps.unwrap_or(0.0),
            skating: numbers.skating_cm_per_sec.unwrap_or(0.0),
            roughness: (sum / f64::max(count, 1.0)).sqrt() * 1e3,
        }
    }

    fn all(self) -> [f64; 4] {
        [self.pose_jump, self.velocity_jump, self.skating, self.roughness]
    }
}

/// Values below these are not seen: degrees, degrees per second, centimetres per second,
/// millimetres.
const UNSEEN: [f64; 4] = [1.0, 60.0, 0.3, 0.3];

fn around(frames: &Range<usize>, clip: &Clip, more: usize) -> Range<usize> {
    frames.start.saturating_sub(more)..(frames.end + more).min(clip.frames())
}

/// Returns the root mean square distance of all joints in the damaged frames, centimetres.
fn distance_cm(a: &Clip, b: &Clip, damages: &[Damage]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for damage in damages {
        let [a, b] = [a, b].map(|clip| clip.world_positions(damage.frames.clone()));
        sum += a.iter().zip(&b).map(|(a, b)| f64::from(a.distance_squared(*b))).sum::<f64>();
        count += a.len() as f64;
    }
    (sum / f64::max(count, 1.0)).sqrt() * 100.0
}

#[derive(Default)]
struct Totals {
    put: usize,
    found: usize,
    named: usize,
    alarms: usize,
    minutes: f64,
    own: usize,
    worst_ratio: f64,
    /// The artefacts of all originals, and of all mended takes.
    sums: [[f64; 4]; 2],
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = arguments()?;
    let mut takes = match &arguments.folder {
        Some(folder) => takes_of(folder)?,
        None => synthesised(arguments.takes)?,
    };
    // Evenly over the folder, in the order of names; then the shortest first, so that the longer
    // take the faults for which those have no room.
    let all = takes.len();
    let wanted = arguments.takes.min(all);
    let mut index = 0;
    takes.retain(|_| {
        let keep = index * wanted / all.max(1) != (index + 1) * wanted / all.max(1);
        index += 1;
        keep
    });
    takes.sort_by(|a, b| a.1.frames().cmp(&b.1.frames()).then(a.0.cmp(&b.0)));
    println!(
        "| take | s | fps | put in | found | by name | false | own | off before | after (cm) | pose jump | velocity jump | skating | roughness |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    let mut totals = Totals::default();
    let mut by_kind = [[0_usize; 3]; 4];
    let mut missed = Vec::new();
    for (number, (name, clip)) in takes.iter().enumerate() {
        let original = Arc::new(Motion::analyze(clip.clone()));
        let left = arguments.faults - totals.put;
        let count = left / (takes.len() - number);
        let spoilt = damage(clip, original.roles(), count, arguments.seed + number as u64)?;
        let damages = &spoilt.damages;
        let motion = Arc::new(Motion::with_roles(spoilt.clip, original.roles()));
        // Uncertain faults are listed, and only mended on request.
        let sure = |motion: &Arc<Motion>| -> Vec<Fault> {
            find_faults(motion).into_iter().filter(Fault::is_sure).collect()
        };
        let (own, faults) = (sure(&original), sure(&motion));
        let is_named = |damage: &Damage, fault: &Fault| {
            fault.kind == damage.kind && fault.overlaps(&damage.frames, &damage.joints)
        };
        let mut counts = [0; 2];
        for damage in damages {
            let found = damage.is_found_in(&faults);
            let named = faults.iter().any(|fault| is_named(damage, fault));
            counts[0] += usize::from(found);
            counts[1] += usize::from(named);
            let row = &mut by_kind[damage.kind as usize];
            row[0] += 1;
            row[1] += usize::from(found);
            row[2] += usize::from(named);
            if !found {
                missed.push(format!(
                    "{name}: {:?} {:?} joints {:?}",
                    damage.kind, damage.frames, damage.joints
                ));
            }
        }
        // The take's own faults are none of the search's.
        let is_new =
            |fault: &&Fault| !own.iter().any(|known| known.overlaps(&fault.frames, &fault.joints));
        let new: Vec<Fault> = faults.iter().filter(is_new).cloned().collect();
        let alarms = false_alarms(&new, damages);
        let in_own = false_alarms(&own, &[]);
        let cured: Vec<&Fault> = faults.iter().filter(|fault| fault.is_in_tracks()).collect();
        let mended = mend(&motion, &cured, &MendOptions::default())?;
        let [was, now] =
            [&original, &mended.motion].map(|motion| Artefacts::of(motion, damages).all());
        let ratio = |at: usize| now[at].max(UNSEEN[at]) / was[at].max(UNSEEN[at]);
        let ratios: Vec<String> = (0..4)
            .map(|at| format!("{:.2} → {:.2} ({:.2})", was[at], now[at], ratio(at)))
            .collect();
        for at in 0..4 {
            totals.sums[0][at] += was[at].max(UNSEEN[at]);
            totals.sums[1][at] += now[at].max(UNSEEN[at]);
        }
        totals.own += in_own;
        totals.worst_ratio = (0..4).map(ratio).fold(totals.worst_ratio, f64::max);
        println!(
            "| {name} | {:.1} | {:.0} | {} | {} | {} | {alarms} | {in_own} | {:.2} | {:.2} | {} |",
            clip.duration_secs(),
            clip.fps(),
            damages.len(),
            counts[0],
            counts[1],
            distance_cm(clip, motion.clip(), damages),
            distance_cm(clip, mended.motion.clip(), damages),
            ratios.join(" | "),
        );
        totals.put += damages.len();
        totals.found += counts[0];
        totals.named += counts[1];
        totals.alarms += alarms;
        totals.minutes += clip.duration_secs() / 60.0;
        if arguments.tells {
            for damage in damages {
                let one = std::slice::from_ref(damage);
                let [was, now] =
                    [&original, &mended.motion].map(|motion| Artefacts::of(motion, one).roughness);
                println!(
                    "  put in: {:?} {:?} {} joints, off {:.2} → {:.2} cm, roughness {was:.2} → {now:.2}",
                    damage.kind,
                    damage.frames,
                    damage.joints.len(),
                    distance_cm(clip, motion.clip(), one),
                    distance_cm(clip, mended.motion.clip(), one),
                );
            }
            let told = faults.iter().filter(|fault| fault.is_in_tracks());
            for fault in told.filter(|f| !damages.iter().any(|d| f.overlaps(&d.frames, &d.joints)))
            {
                println!(
                    "  false: {:?} {:?} {:.1} {:.2} joints {:?}",
                    fault.kind, fault.frames, fault.size, fault.confidence, fault.joints
                );
            }
            for fault in own.iter().filter(|fault| !fault.is_in_tracks()) {
                println!(
                    "  own: {:?} {:?} {:.1} {:?} {:.2}",
                    fault.kind, fault.frames, fault.size, fault.unit, fault.confidence
                );
            }
        }
    }
    println!();
    println!("| kind | put in | found | by name |");
    println!("|---|---|---|---|");
    for kind in [FaultKind::Spike, FaultKind::Gap, FaultKind::Swap, FaultKind::Jitter] {
        let [put, found, named] = by_kind[kind as usize];
        println!("| {kind:?} | {put} | {found} | {named} |");
    }
    println!();
    let per_min = totals.alarms as f64 / totals.minutes;
    println!(
        "{} takes, {:.1} s: {} faults put in, {} found, {} by name; {} false alarms, {per_min:.2} per minute; {} faults of the takes' own.",
        takes.len(),
        totals.minutes * 60.0,
        totals.put,
        totals.found,
        totals.named,
        totals.alarms,
        totals.own,
    );
    let mean = |at: usize| totals.sums[1][at] / totals.sums[0][at].max(1e-9);
    println!(
        "Artefacts of the mended takes in terms of the originals': pose jump {:.2}, velocity jump {:.2}, skating {:.2}, roughness {:.2}; worst of a take {:.2}.",
        mean(0),
        mean(1),
        mean(2),
        mean(3),
        totals.worst_ratio
    );
    for line in &missed {
        println!("missed: {line}");
    }
    let is_good = totals.found as f64 >= MIN_FOUND * totals.put as f64
        && per_min <= MAX_FALSE_PER_MIN
        && (0..4).all(|at| mean(at) <= MAX_RATIO);
    Ok(if is_good { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
