//! Every lab with motions that nobody made: skeletons of any shape, names, channels and size, from
//! one frame on, still, wild or torn. There is a finite result, or a sentence.
//!
//! To search further: `PROPTEST_RNG_SEED=7 PROPTEST_CASES=500 cargo test --no-default-features -p
//! segue --test any_rig`.

use proptest::prelude::*;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::Clip;
use segue_motion::skeleton::fixtures;
use segue_session::export::{ExportFormat, ExportOptions, export};
use segue_session::{Command, Key, Kind, PARAMS, Param, Session, Value};
use std::fmt::Write as _;

/// Names by which parts of a body are recognised, and some by which none is.
const NAMES: [&str; 26] = [
    "Hips",
    "Spine",
    "Spine1",
    "Neck",
    "Head",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightShoulder",
    "RightArm",
    "RightForeArm",
    "RightHand",
    "Tail",
    "Root",
    "prop",
    "關節",
    "x",
];

/// The shape of a curve over time.
#[derive(Clone, Copy, Debug)]
enum Curve {
    Still,
    Sine,
    Line,
    Noise,
    Steps,
}

/// A joint of a file.
#[derive(Clone, Debug)]
struct AnyJoint {
    /// The place of its parent among the joints before it: 0 for the first, 1 for the last.
    parent: f64,
    /// An index of [`NAMES`].
    name: usize,
    /// In fifths of the skeleton's size.
    offset: [f64; 3],
    /// A kind of [`AnyFile::channels`].
    channels: usize,
    /// The curve of its angles.
    curve: Curve,
    /// The greatest angle, degrees.
    amplitude: f64,
}

/// A motion file.
#[derive(Clone, Debug)]
struct AnyFile {
    joints: Vec<AnyJoint>,
    /// The size of the skeleton, units of the file.
    size: f64,
    frames: usize,
    fps: f64,
    /// The curve of the root's place.
    way: Curve,
    /// How far the root moves, as a multiple of the size.
    length: f64,
    seed: u64,
}

fn curve() -> impl Strategy<Value = Curve> {
    prop_oneof![
        2 => Just(Curve::Still),
        4 => Just(Curve::Sine),
        2 => Just(Curve::Line),
        1 => Just(Curve::Noise),
        1 => Just(Curve::Steps),
    ]
}

fn joint() -> impl Strategy<Value = AnyJoint> {
    let offset = prop_oneof![
        4 => prop::array::uniform3(-1.0..1.0),
        2 => Just([0.0, 1.0, 0.0]),
        1 => Just([0.0; 3]),
        1 => Just([1.0, 0.0, 0.0]),
    ];
    let parent = prop_oneof![2 => Just(1.0), 1 => 0.0..=1.0];
    let amplitude = prop_oneof![4 => 0.0..40.0, 1 => 0.0..800.0];
    (parent, 0..NAMES.len(), offset, 0..5_usize, curve(), amplitude).prop_map(
        |(parent, name, offset, channels, curve, amplitude)| AnyJoint {
            parent,
            name,
            offset,
            channels,
            curve,
            amplitude,
        },
    )
}

fn file() -> impl Strategy<Value = AnyFile> {
    let frames = prop_oneof![1 => 1..4_usize, 3 => 4..120_usize];
    let fps = prop_oneof![Just(30.0), Just(60.0), Just(120.0), Just(1.0), Just(240.0), 5.0..90.0];
    let joints = prop::collection::vec(joint(), 1..24);
    (joints, -2.0..3.0, frames, fps, curve(), 0.0..8.0, any::<u64>()).prop_map(
        |(joints, size, frames, fps, way, length, seed)| AnyFile {
            joints,
            size: 10_f64.powf(size),
            frames,
            fps,
            way,
            length,
            seed,
        },
    )
}

/// Returns a number from -1 to 1.
fn noise(seed: u64) -> f64 {
    f64::from(fixtures::noise(seed)())
}

impl AnyFile {
    fn at(&self, curve: Curve, channel: u64, frame: usize) -> f64 {
        let time = frame as f64 / self.fps;
        let own = self.seed.wrapping_add(channel.wrapping_mul(7919));
        match curve {
            Curve::Still => noise(own),
            Curve::Sine => {
                (time * 6.0 * (1.0 + noise(own).abs()) + noise(own.wrapping_add(1)) * 3.0).sin()
            }
            Curve::Line => noise(own) * time,
            Curve::Noise => noise(own.wrapping_add(frame as u64 * 104_729)),
            Curve::Steps => noise(own.wrapping_add((time * 3.0) as u64)).round(),
        }
    }

    /// Returns the names of a joint's channels.
    fn channels(&self, index: usize) -> &'static [&'static str] {
        match (index, self.joints[index].channels) {
            (0, _) => {
                &["Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"]
            }
            (_, 0) => &["Xrotation", "Yrotation", "Zrotation"],
            (_, 1) => &["Zrotation", "Yrotation", "Xrotation"],
            (_, 2) => {
                &["Xposition", "Yposition", "Zposition", "Yrotation", "Zrotation", "Xrotation"]
            }
            (_, 3) => &["Xrotation"],
            _ => &[],
        }
    }

    /// Writes a joint and the joints below it, and returns their indices in the order of the file.
    fn joint_text(
        &self,
        index: usize,
        children: &[Vec<usize>],
        depth: usize,
        text: &mut String,
    ) -> Vec<usize> {
        let joint = &self.joints[index];
        let pad = "\t".repeat(depth);
        let kind = if depth == 0 { "ROOT" } else { "JOINT" };
        let [x, y, z] = joint.offset.map(|v| v * self.size / 5.0);
        let channels = self.channels(index);
        writeln!(text, "{pad}{kind} {}_{index}\n{pad}{{", NAMES[joint.name])
            .expect("a text takes all");
        writeln!(text, "{pad}\tOFFSET {x:.6} {y:.6} {z:.6}").expect("a text takes all");
        writeln!(text, "{pad}\tCHANNELS {} {}", channels.len(), channels.join(" "))
            .expect("a text takes all");
        let mut order = vec![index];
        for &child in &children[index] {
            order.extend(self.joint_text(child, children, depth + 1, text));
        }
        if children[index].is_empty() && joint.amplitude < 30.0 {
            writeln!(
                text,
                "{pad}\tEnd Site\n{pad}\t{{\n{pad}\t\tOFFSET {y:.6} {z:.6} {x:.6}\n{pad}\t}}"
            )
            .expect("a text takes all");
        }
        writeln!(text, "{pad}}}").expect("a text takes all");
        order
    }

    /// Returns the file's text.
    fn bvh(&self) -> String {
        let mut children = vec![Vec::new(); self.joints.len()];
        for (index, joint) in self.joints.iter().enumerate().skip(1) {
            children[((index - 1) as f64 * joint.parent) as usize].push(index);
        }
        let mut text = "HIERARCHY\n".to_owned();
        let order = self.joint_text(0, &children, 0, &mut text);
        writeln!(text, "MOTION\nFrames: {}\nFrame Time: {:.7}", self.frames, 1.0 / self.fps)
            .expect("a text takes all");
        for frame in 0..self.frames {
            let mut row = Vec::new();
            for &index in &order {
                let joint = &self.joints[index];
                for (channel, name) in self.channels(index).iter().enumerate() {
                    let id = (index * 8 + channel) as u64;
                    row.push(if name.ends_with("position") {
                        let (curve, length) =
                            if index == 0 { (self.way, self.length) } else { (joint.curve, 0.05) };
                        self.at(curve, id, frame) * self.size * length
                    } else {
                        self.at(joint.curve, id, frame) * joint.amplitude
                    });
                }
            }
            let row: Vec<String> = row.iter().map(|value| format!("{value:.6}")).collect();
            writeln!(text, "{}", row.join(" ")).expect("a text takes all");
        }
        text
    }
}

/// Returns the time from the first frame to the last: slow rates are multiplied by some formats.
fn secs(clip: &Clip) -> f64 {
    clip.frames().saturating_sub(1) as f64 / clip.fps()
}

/// Checks what a lab shows.
fn check(session: &Session, link: &str) -> Result<(), TestCaseError> {
    for pane in session.panes() {
        let Some(outcome) = &pane.outcome else {
            let problem = pane.problem.as_ref();
            prop_assert!(
                problem.is_some_and(|problem| !problem.to_string().is_empty()),
                "{link}: neither result nor reason"
            );
            continue;
        };
        let clip = outcome.motion.clip();
        for frame in 0..clip.frames() {
            let world = clip.world_pose(frame);
            prop_assert!(
                world.positions.iter().all(|p| p.is_finite())
                    && world.rotations.iter().all(|q| q.is_finite()),
                "{link}: frame {frame} of {} is not finite",
                clip.frames()
            );
        }
        for metric in &outcome.metrics {
            prop_assert!(
                metric.value.is_none_or(f64::is_finite),
                "{link}: {:?} is {:?}",
                metric.id,
                metric.value
            );
        }
    }
    Ok(())
}

/// Returns the number of cases: few, because each takes a second, unless more are asked for.
fn cases() -> u32 {
    let asked = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok());
    asked.unwrap_or(3)
}

/// Returns any values for half of the parameters of a lab.
fn settings(lab: &str, seed: u64) -> Vec<(Key, Value)> {
    let mut next = fixtures::noise(seed);
    let mut share = || f64::from(next().abs()).min(0.999_999);
    let own = PARAMS.iter().filter(|param| param.group.name() == lab);
    let choose = |param: &Param| {
        let is_set = share() < 0.5;
        let value = match param.kind {
            // More often near the least value than near the greatest.
            Kind::Number { min, max, .. } => Value::Number(min + (max - min) * share() * share()),
            Kind::Switch => Value::Switch(share() < 0.5),
            Kind::Choice(choices) => {
                Value::Choice(choices[(share() * choices.len() as f64) as usize].key)
            }
            _ => return None,
        };
        let value = param.check(value).ok()?;
        is_set.then_some((param.key, value))
    };
    own.filter_map(choose).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { max_shrink_iters: 60, ..ProptestConfig::with_cases(cases()) })]
    #[test]
    fn every_lab_has_a_finite_result_or_a_reason_for_any_rig(one in file(), other in file(), same_rig: bool) {
        let mut other = other;
        if same_rig {
            other.joints.clone_from(&one.joints);
            other.size = one.size;
        }
        let mut session = Session::new();
        let mut ids = Vec::new();
        for (name, file) in [("one.bvh", &one), ("other.bvh", &other)] {
            match session.load(name, file.bvh().into_bytes().into()) {
                Ok(mut loaded) => ids.push(loaded.ids.remove(0)),
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
        prop_assume!(!ids.is_empty());
        let (a, b) = (ids[0].clone(), ids[ids.len() - 1].clone());
        let Kind::Choice(labs) = Key::Lab.param().kind else { unreachable!("labs are a choice") };
        for lab in labs {
            for (a, b) in [(a.as_str(), b.as_str()), ("walk", a.as_str()), (b.as_str(), "run")] {
                let lab = lab.key;
                let link = format!("lab={lab}&a={a}&b={b}&clips={a},{b}&match_clips={a},{b}");
                session.apply(Command::OpenLink(link.clone())).expect("a link");
                while session.work() {}
                check(&session, &link)?;
                let values = settings(lab, one.seed ^ other.seed);
                let set = format!("{link} with {values:?}");
                session.apply(Command::Set(values)).expect("valid values");
                for _ in 0..3 {
                    session.tick(0.3);
                    while session.work() {}
                }
                check(&session, &set)?;
            }
        }
        // Each file that an export writes has the duration of its motion.
        for id in &ids {
            let Some(motion) = session.library().get(id).and_then(|entry| entry.motion.clone()) else {
                continue;
            };
            for format in ExportFormat::ALL {
                let options = ExportOptions { format, ..ExportOptions::default() };
                let file = match export(&motion, None, &[], &options) {
                    Ok(file) => file,
                    Err(error) => {
                        prop_assert!(!error.to_string().is_empty());
                        continue;
                    }
                };
                if matches!(format, ExportFormat::Csv | ExportFormat::Vrma) {
                    continue;
                }
                let name = format!("x.{}", format.ending());
                let back = import(&name, &file, &ImportOptions::default());
                let back = back.map_err(|error| TestCaseError::fail(format!("{format:?}: {error}")))?;
                let back = back.clips.first().map(|read| secs(&read.clip));
                prop_assert!(
                    back.is_some_and(|back| (back - secs(motion.clip())).abs() < 1e-3),
                    "{:?}: {:?} s of {} s", format, back, secs(motion.clip())
                );
            }
        }
    }
}
