//! ASF and AMC files: oddities of real files, one test for each kind; the mathematics against a
//! plain implementation; and captured motion, compared with the BVH of the same take.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]

#[path = "../common/mod.rs"]
mod common;
mod hostile;
mod maths;
mod real;
mod table;

use segue_formats::acclaim::{AcclaimSkeleton, read_motion, read_skeleton};
use segue_formats::{ImportError, ImportOptions, ImportedFile};
use segue_motion::clip::Clip;

/// The warning of every motion.
const NO_RATE: &str =
    "the format has no frame rate; 120 frames per second are assumed, the rate can be set by hand";

/// A body 1.6 m tall in centimetres.
const ASF: &str = "# by hand
:version 1.10
:name toy
:units
  mass 1.0
  length 1.0
  angle deg
:documentation
  whatever :root says # here
  not a section
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name thigh
    direction 0.1 -0.9 0
    length 40
    axis 10 20 30 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-inf inf)
  end
  begin
    id 2
    name shin
    direction 0 -1 0.1
    length 42
    axis 0 0 20 XYZ
    dof rx
    limits (-10.0 170.0)
  end
  begin
    name spine
    direction 0 1 0
    length 60
    axis 0 0 0 XYZ
    dof rz rx
    bodymass 1.5
    cofmass 0.5
  end
  begin
    name skull
    direction 0 2 0
    length 20
    axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root thigh spine
    thigh shin
    spine skull
  end
";

fn frame(number: usize) -> String {
    let f = number as f64;
    format!(
        "{number}\nroot {:.1} 90.5 {:.1} 10.5 20.5 {:.1}\nspine 5.5 6.5\nthigh 7.5 8.5 {:.1}\nshin 11.5\n",
        f + 0.5,
        2.0 * f + 0.5,
        3.0 + f,
        9.5 - f
    )
}

fn amc(frames: usize) -> String {
    let frames: String = (1..=frames).map(frame).collect();
    format!("#!OML:ASF toy\n:FULLY-SPECIFIED\n:DEGREES\n{frames}")
}

fn skeleton_of(text: impl AsRef<[u8]>) -> Result<AcclaimSkeleton, ImportError> {
    read_skeleton("toy.asf", text.as_ref(), &ImportOptions::default())
}

fn read_with(
    asf: impl AsRef<[u8]>,
    amc: impl AsRef<[u8]>,
    options: &ImportOptions,
) -> Result<ImportedFile, ImportError> {
    read_motion("take.amc", amc.as_ref(), &skeleton_of(asf)?, options)
}

/// Returns the clip of two files that must be readable, and its warnings except the missing frame
/// rate.
fn clip_of(asf: impl AsRef<[u8]>, amc: impl AsRef<[u8]>) -> (Clip, Vec<String>) {
    let mut imported =
        read_with(asf, amc, &ImportOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let warnings = imported.warnings.iter().map(ToString::to_string).filter(|text| text != NO_RATE);
    (imported.clips.remove(0).clip, warnings.collect())
}
