//! How good transitions are: every clip of a folder into every one, as the Transition lab makes them with its default parameters, measured. Prints
//! a table in Markdown. `cargo xtask quality` runs it.

#![expect(clippy::print_stdout, reason = "the table is what it is for")]

mod measure;

use measure::{Lab, Numbers};
use segue::math::stats;
use std::error::Error;
use std::path::Path;
use std::thread;

/// Pairs are shared out to so many threads.
const THREADS: usize = 2;
/// Above this a character turns for no reason, degrees.
const LEAST_SPIN_DEG: f64 = 10.0;
/// Below this a foot that slides is not seen, centimetres.
const VISIBLE_CM: f64 = 0.5;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = std::env::args_os().nth(1) else {
        return Err("name a folder of motion files: BVH, or AMC beside their ASF".into());
    };
    let pairs = all_pairs(folder.as_ref()).map_err(|error| -> Box<dyn Error> { error.into() })?;
    if pairs.is_empty() {
        return Err(format!(
            "there is no motion in {}: no BVH, and no AMC beside its ASF",
            folder.to_string_lossy()
        )
        .into());
    }
    print_totals(&pairs);
    print_takes(&pairs);
    print_worst(&pairs);
    Ok(())
}

/// All ordered pairs, a clip into itself among them, by outgoing clip, then by incoming one.
fn all_pairs(folder: &Path) -> Result<Vec<Numbers>, String> {
    let share = |thread: usize| {
        let mut lab = Lab::of_folder(folder, |_| true).map_err(|error| error.to_string())?;
        let count = lab.len();
        let made = (thread..count * count).step_by(THREADS).map(|index| {
            let numbers = lab.pair(index / count, index % count).map_err(|error| error.to_string())?;
            Ok((index, numbers))
        });
        made.collect::<Result<Vec<_>, String>>()
    };
    let shares: Result<Vec<_>, String> = thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|thread| scope.spawn(move || share(thread))).collect();
        let ended = threads
            .into_iter()
            .map(|thread| thread.join().map_err(|_| "a thread broke off".to_owned())?);
        ended.collect()
    });
    let mut pairs: Vec<_> = shares?.into_iter().flatten().collect();
    pairs.sort_by_key(|(index, _)| *index);
    Ok(pairs.into_iter().map(|(_, numbers)| numbers).collect())
}

fn median(values: impl Iterator<Item = f32>) -> f32 {
    stats::percentile(&values.collect::<Vec<_>>(), 0.5).unwrap_or(0.0)
}

fn largest(pairs: &[Numbers], value: impl Fn(&Numbers) -> f64) -> (f64, String) {
    let worst = pairs.iter().max_by(|a, b| value(a).total_cmp(&value(b)));
    worst.map_or((0.0, String::new()), |worst| (value(worst), worst.names.join(" → ")))
}

fn print_totals(pairs: &[Numbers]) {
    let count = |holds: fn(&Numbers) -> bool| pairs.iter().filter(|pair| holds(pair)).count();
    let of = pairs.len();
    println!("| Over all {of} ordered pairs | limit | held by | largest |");
    println!("|---|---|---|---|");
    let (seam, at) = largest(pairs, |pair| pair.seam.into());
    let held = count(|pair| pair.seam <= 1.0);
    println!(
        "| jump of a joint's angular velocity at the seam, over its clips' own 99th percentile | 1 | {held} of {of} | {seam:.2}, {at} |"
    );
    let known = count(|pair| pair.untouched.is_some());
    let held = count(|pair| pair.untouched.is_some_and(|ratio| ratio <= 1.0));
    let (own, at) = largest(pairs, |pair| pair.untouched.unwrap_or(0.0).into());
    println!("| for comparison: the same frames of A, had it gone on | | {held} of {known} | {own:.2}, {at} |");
    let (spin, at) = largest(pairs, |pair| pair.spin_deg);
    let held = count(|pair| pair.spin_deg <= LEAST_SPIN_DEG);
    println!("| spin | {LEAST_SPIN_DEG}° | {held} of {of} | {spin:.1}°, {at} |");
    let (knee, at) = largest(pairs, |pair| pair.knee.into());
    let held = count(|pair| pair.knee <= 1.5);
    println!("| fastest knee with foot lock, over the clips' own fastest | 1.5 | {held} of {of} | {knee:.2}, {at} |");
    let sliding = count(|pair| pair.worst_cm[0] > VISIBLE_CM);
    let held = count(|pair| pair.worst_cm[0] > VISIBLE_CM && pair.worst_cm[1] <= 0.1 * pair.worst_cm[0]);
    println!("| nine tenths of the slide taken away by foot lock, where it is above {VISIBLE_CM} cm | | {held} of {sliding} | |");
    println!();
    println!("| Slide of a foot in a stance | limit | median | 9 of 10 below | largest |");
    println!("|---|---|---|---|---|");
    for (lock, limit, what) in [(0, "", "without foot lock"), (1, "median 1 cm", "with foot lock")] {
        let all: Vec<f32> = pairs.iter().flat_map(|pair| pair.slides_cm[lock].iter().copied()).collect();
        let at = |share| stats::percentile(&all, share).unwrap_or(0.0);
        println!(
            "| {what}, {} stances | {limit} | {:.2} cm | {:.2} cm | {:.1} cm |",
            all.len(),
            at(0.5),
            at(0.9),
            at(1.0)
        );
    }
    println!();
}

fn print_takes(pairs: &[Numbers]) {
    println!(
        "| Out of | seam, largest | spin, largest | slide, median | locked | into | seam, largest | spin, largest | slide, median | locked |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let mut names: Vec<&String> = pairs.iter().map(|pair| &pair.names[0]).collect();
    names.dedup();
    for name in names {
        let cells = [0, 1].map(|slot| {
            let its = || pairs.iter().filter(move |pair| pair.names[slot] == *name);
            let slide = |lock: usize| median(its().flat_map(|pair| pair.slides_cm[lock].iter().copied()));
            let seam = its().map(|pair| pair.seam).fold(0.0, f32::max);
            let spin = its().map(|pair| pair.spin_deg).fold(0.0, f64::max);
            format!("{name} | {seam:.2} | {spin:.1}° | {:.1} cm | {:.2} cm", slide(0), slide(1))
        });
        println!("| {} |", cells.join(" | "));
    }
    println!();
}

fn print_worst(pairs: &[Numbers]) {
    println!("| The ten worst stances with foot lock | seam | joint | spin | without lock | with lock | knee |");
    println!("|---|---|---|---|---|---|---|");
    let mut pairs: Vec<&Numbers> = pairs.iter().collect();
    pairs.sort_by(|a, b| b.worst_cm[1].total_cmp(&a.worst_cm[1]));
    for pair in pairs.into_iter().take(10) {
        println!(
            "| {} → {} | {:.2} | {} | {:.1}° | {:.1} cm | {:.1} cm | {:.2} |",
            pair.names[0], pair.names[1], pair.seam, pair.seam_joint, pair.spin_deg, pair.worst_cm[0], pair.worst_cm[1], pair.knee
        );
    }
}
