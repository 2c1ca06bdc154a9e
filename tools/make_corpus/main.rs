//! Writes many BVH files of synthesised motion, in twelve rigs and ways of writing, to try Segue
//! with a large library. `cargo xtask make-corpus N DIR` runs it. The same number gives the same
//! files.

#![expect(clippy::print_stdout, reason = "it says what it has written")]

mod rigs;

use rigs::{RIGS, Rig};
use segue_motion::synth::{Action, Params, synthesize};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The sizes of the files, bytes: they are spread evenly by their ratios, with a mean of 180 KB.
const SIZES: [f64; 2] = [34_000.0, 520_000.0];
/// The mean number of bytes of a channel's value.
const BYTES_PER_VALUE: f64 = 9.0;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [count, folder] = args.as_slice() else {
        return Err("expected a number of files and a folder".into());
    };
    let count: usize = count.parse().map_err(|_| format!("{count} is no number of files"))?;
    let bytes = write_corpus(count, Path::new(folder))?;
    println!("{count} files, {:.1} MB, in {folder}", bytes as f64 / 1e6);
    Ok(())
}

/// Writes files into a folder, on all processors. Returns the number of their bytes.
fn write_corpus(count: usize, folder: &Path) -> Result<u64, Box<dyn Error>> {
    for rig in &RIGS {
        fs::create_dir_all(folder.join(rig.folder))?;
    }
    let next = AtomicUsize::new(0);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let write_some = || -> Result<u64, String> {
        let mut bytes = 0;
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            if index >= count {
                return Ok(bytes);
            }
            let (path, text) = file(index).map_err(|error| format!("file {index}: {error}"))?;
            bytes += text.len() as u64;
            fs::write(folder.join(&path), text)
                .map_err(|error| format!("{}: {error}", path.display()))?;
        }
    };
    let parts: Vec<Result<u64, String>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(write_some)).collect();
        let stopped = |_| Err("a thread has stopped".to_owned());
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(stopped)).collect()
    });
    let mut bytes = 0;
    for part in parts {
        bytes += part?;
    }
    Ok(bytes)
}

/// Returns a file by its number: its path in the folder, and its text.
fn file(index: usize) -> Result<(PathBuf, String), Box<dyn Error>> {
    let rig = RIGS.get(index % RIGS.len()).ok_or("there are no rigs")?;
    let params = params(index, rig);
    let made = synthesize(&params)?;
    let name = format!("{:?} {index:05}.bvh", params.action).to_lowercase();
    Ok((Path::new(rig.folder).join(name), rig.file(&made.clip)?))
}

/// Returns the parameters of a file's motion.
fn params(index: usize, rig: &Rig) -> Params {
    let mut random = random(index as u64);
    let actions = [
        Action::Walk,
        Action::Walk,
        Action::Walk,
        Action::Run,
        Action::Run,
        Action::Idle,
        Action::Start,
        Action::Stop,
    ];
    let chosen = (random() * actions.len() as f64) as usize;
    let action = actions.get(chosen).copied().unwrap_or_default();
    let bytes = SIZES[0] * (SIZES[1] / SIZES[0]).powf(random());
    let frames = bytes / (rig.channels() as f64 * BYTES_PER_VALUE);
    let usual = Params::new(action);
    let pace = 0.85 + 0.3 * random();
    let least_secs = match action {
        Action::Start | Action::Stop => 2.5,
        _ => 1.0,
    };
    Params {
        speed_mps: usual.speed_mps * pace as f32,
        turn_rate_dps: (60.0 * (random() - 0.5)) as f32,
        height_m: rig.height_m,
        seed: index as u32 + 1,
        duration_secs: ((frames / f64::from(rig.fps)) as f32).clamp(least_secs, 60.0),
        fps: rig.fps,
        ..usual
    }
}

/// Returns a generator of numbers from 0 to 1 by a seed (`SplitMix64`).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_formats::{ImportOptions, import};
    use segue_motion::skeleton::{Role, Roles};
    use std::collections::BTreeSet;

    #[test]
    fn corpus_has_files_of_twelve_rigs_that_are_read_as_they_were_made() {
        let mut rigs = BTreeSet::new();
        for (index, rig) in RIGS.iter().enumerate() {
            let (path, text) = file(index).unwrap();
            let read = import(&path.to_string_lossy(), text.as_bytes(), &ImportOptions::default())
                .unwrap_or_else(|error| panic!("{}: {error}", rig.folder));
            let clip = &read.clips[0].clip;
            assert!((clip.fps() - f64::from(rig.fps)).abs() < 0.01, "{}", rig.folder);
            let roles = Roles::detect(clip.skeleton());
            let height = roles.body_height(clip.skeleton());
            assert!((height / rig.height_m - 1.0).abs() < 0.12, "{}: {height} m", rig.folder);
            assert!(roles.get(Role::LeftFoot).is_some(), "{}", rig.folder);
            let names: Vec<_> =
                clip.skeleton().joints().iter().map(|joint| joint.name.clone()).collect();
            rigs.insert(names);
        }
        assert_eq!(rigs.len(), RIGS.len());
    }

    #[test]
    fn same_number_gives_the_same_file_of_the_mean_size() {
        let sizes: Vec<usize> = (0..120).map(|index| file(index).unwrap().1.len()).collect();
        let mean = sizes.iter().sum::<usize>() as f64 / sizes.len() as f64;
        assert!((150_000.0..210_000.0).contains(&mean), "{mean}: 3,000 files are about 540 MB");
        let (short, long) = (sizes.iter().min().unwrap(), sizes.iter().max().unwrap());
        assert!(*long > 8 * short, "{short} to {long} bytes");
        assert_eq!(file(7).unwrap(), file(7).unwrap());
    }

    #[test]
    fn corpus_is_written_into_folders() {
        let folder = std::env::temp_dir().join(format!("segue-corpus-{}", std::process::id()));
        let bytes = write_corpus(14, &folder).unwrap();
        let mut found = 0;
        for rig in &RIGS {
            for entry in fs::read_dir(folder.join(rig.folder)).unwrap() {
                found += entry.unwrap().metadata().unwrap().len();
            }
        }
        fs::remove_dir_all(&folder).unwrap();
        assert_eq!(found, bytes);
    }
}
