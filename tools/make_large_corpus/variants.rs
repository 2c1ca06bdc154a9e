//! Clips that are made of a few others.

use glam::{DVec2, Quat, Vec3};
use segue_corpus::{
    ClipRecord, Options, Signature, StandardBody, Status, decode_poses, encode_poses, process_file,
    thumbnail,
};
use segue_formats::bvh;
use segue_motion::clip::{Clip, Contacts, mirror};
use segue_motion::math::Planar;
use segue_motion::synth::{Action, Params, synthesize};
use std::error::Error;

/// The number of clips of which all others are made.
const BASES: usize = 300;
/// The durations of clips, seconds: the middle one of most takes, their spread as a ratio, and
/// both ends.
const SECS: (f64, f64, f64, f64) = (6.2, 1.7, 1.0, 24.0);
/// The share of clips that are copies of others.
const COPIES: f64 = 0.03;
/// The share of clips whose files cannot be read.
const UNREADABLE: f64 = 0.001;
/// People, each with a folder, a rig and a format.
const PEOPLE: usize = 160;
/// Formats of files, with their frame rates.
const FORMATS: [(&str, f64); 5] =
    [("bvh", 30.0), ("fbx", 60.0), ("glb", 30.0), ("npz", 120.0), ("bvh", 120.0)];
/// Actions, as often as they are made.
const ACTIONS: [Action; 9] = [
    Action::Walk,
    Action::Run,
    Action::Walk,
    Action::Run,
    Action::Idle,
    Action::Start,
    Action::Stop,
    Action::Spin,
    Action::Jump,
];
/// Words of names and labels.
const STYLES: [&str; 12] = [
    "neutral", "happy", "tired", "angry", "proud", "old", "drunk", "sneaky", "injured", "relaxed",
    "hurried", "scared",
];
/// The number of joints that are changed, and the greatest angle, radians.
const JOINTS: usize = 10;
const ANGLE: f64 = 0.2;

/// A clip that was made.
pub(crate) struct Variant {
    pub(crate) record: ClipRecord,
    pub(crate) path: String,
    pub(crate) name: String,
    pub(crate) labels: Vec<String>,
}

/// The clips of which all others are made.
pub(crate) struct Bases {
    body: StandardBody,
    all: Vec<Base>,
}

struct Base {
    action: Action,
    record: ClipRecord,
    clip: Clip,
    contacts: Contacts,
}

impl Bases {
    /// Makes as many as a large corpus needs.
    pub(crate) fn new() -> Result<Self, Box<dyn Error>> {
        Self::with(BASES)
    }

    /// Makes some.
    pub(crate) fn with(count: usize) -> Result<Self, Box<dyn Error>> {
        let body = StandardBody::new()?;
        let all = super::made_by_all(0..count, |number| {
            base(number, &body).map_err(|error| format!("clip {number}: {error}"))
        })?;
        Ok(Self { body, all })
    }

    /// Returns their number.
    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns the clip of a serial number in a corpus of `count` clips.
    pub(crate) fn variant(&self, serial: usize, count: usize) -> Result<Variant, String> {
        let mut random = Random::new(serial as u64);
        let (copy, unreadable) = (random.next() < COPIES, random.next() < UNREADABLE);
        // A copy is the clip of another serial number.
        let of = if copy && serial < count { random.below(count) } else { serial };
        let is_mirrored = of != serial && random.next() < 0.5;
        let mut made = self.made(of, is_mirrored).map_err(|error| error.to_string())?;
        if of != serial {
            // In the folder of another person, whose files have another format.
            let person = (serial * 7 + 3) % PEOPLE;
            made = Variant { record: made.record, ..named(of, person, &made.labels) };
            set_person(&mut made.record, person);
        }
        if unreadable && serial < count {
            let message = "found the end of the file, expected a number";
            let row = segue_corpus::ClipRow::unreadable(message);
            made.record = ClipRecord::of_row(segue_corpus::ClipRow { line: Some(serial), ..row });
        }
        Ok(made)
    }

    fn made(&self, serial: usize, is_mirrored: bool) -> Result<Variant, Box<dyn Error>> {
        let mut random = Random::new(serial as u64 ^ 0x51ed);
        let base = self.all.get(random.below(self.all.len())).ok_or("there is no clip")?;
        let (middle, ratio, least, most) = SECS;
        let secs = (middle * ratio.powf(random.normal())).clamp(least, most);
        let frames = ((secs * 30.0) as usize + 1).min(base.clip.frames());
        let start = random.below(base.clip.frames() - frames + 1);
        let mut clip = base.clip.crop(start..start + frames)?;
        let kept: Vec<usize> = (start..start + frames).collect();
        let mut contacts = base.contacts.of_frames(&kept);
        clip = bent(&turned(&clip, &mut random)?, &mut random);
        if is_mirrored {
            clip = mirror(&clip, self.body.roles())?;
            contacts = contacts.mirrored();
        }
        let labels = vec![
            format!("{:?}", base.action).to_lowercase(),
            STYLES[random.below(STYLES.len())].to_owned(),
        ];
        let person = random.below(PEOPLE);
        let mut record = ClipRecord {
            row: base.record.row.clone(),
            poses: encode_poses(&clip, &contacts)?,
            thumbnail: thumbnail(&clip, self.body.roles())?,
            features: self.body.features(&clip)?,
            signature: Signature::of(&clip, self.body.roles())
                .map_or_else(Vec::new, |own| own.numbers().to_vec()),
        };
        for value in record.row.metrics.values_mut().flatten() {
            *value *= 1.5f64.powf(random.normal());
        }
        record.row.status = Status::Ok;
        record.row.seconds = Some(clip.duration_secs());
        record.row.height_m = Some(1.55 + 0.4 * (person % 23) as f64 / 23.0);
        set_person(&mut record, person);
        Ok(Variant { record, ..named(serial, person, &labels) })
    }
}

/// Sets what all files of a person have in common: format, rate and rig.
fn set_person(record: &mut ClipRecord, person: usize) {
    let (format, fps) = FORMATS[person % FORMATS.len()];
    format.clone_into(&mut record.row.format);
    record.row.fps = Some(fps);
    let secs = record.row.seconds.unwrap_or(0.0);
    record.row.frames = Some((secs * fps).round() as usize + 1);
    record.row.rig = Some(format!("{:08x}", (person % 17) * 0x0f1e_2d3c % 0xffff_fff1));
}

/// Returns a clip without its record, by its name.
fn named(serial: usize, person: usize, labels: &[String]) -> Variant {
    let ending = FORMATS[person % FORMATS.len()].0;
    let [action, style] = [0, 1].map(|at| labels.get(at).map_or("", String::as_str));
    let name = format!("{style}_{action}_{serial:06}__A{person:03}");
    Variant {
        record: ClipRecord::of_row(segue_corpus::ClipRow::unreadable("")),
        path: format!("subject{person:03}/{action}/{name}.{ending}"),
        name,
        labels: labels.to_vec(),
    }
}

/// Synthesises a clip, and processes it as a file.
fn base(number: usize, body: &StandardBody) -> Result<Base, Box<dyn Error>> {
    let mut random = Random::new(number as u64 ^ 0xba5e_0000);
    let action = ACTIONS[number % ACTIONS.len()];
    let usual = Params::new(action);
    let mut within = |low: f64, high: f64| (low + (high - low) * random.next()) as f32;
    let mut params = Params {
        speed_mps: usual.speed_mps * within(0.8, 1.25),
        turn_rate_dps: within(-50.0, 50.0),
        spin_degrees: within(60.0, 300.0) * within(-1.0, 1.0).signum(),
        height_m: within(1.5, 1.95),
        seed: number as u32 + 1,
        duration_secs: 25.0,
        ..usual
    };
    params.style.bounce = within(0.4, 1.6);
    params.style.arm_swing = within(0.3, 1.8);
    params.style.stance_width = within(0.7, 1.5);
    params.style.energy = within(0.5, 1.5);
    params.style.lean = within(0.0, 2.0);
    if let Some((low, high)) = Params::speed_range(action) {
        params.speed_mps = params.speed_mps.clamp(low, high);
    }
    if matches!(action, Action::Spin | Action::Jump) {
        params.duration_secs = usual.duration_secs * within(0.9, 1.6);
    }
    let file = bvh::write(&synthesize(&params)?.clip, &bvh::WriteOptions::default());
    let record = process_file("a.bvh", file.as_bytes(), &[], &Options::default());
    let record = record.clips.into_iter().next().ok_or("a file has no clip")?;
    let read = decode_poses("", &record.poses, body.skeleton())?;
    Ok(Base { action, clip: read.clip, contacts: read.contacts, record })
}

/// Turns some joints by angles that change slowly.
fn turned(clip: &Clip, random: &mut Random) -> Result<Clip, Box<dyn Error>> {
    let joints = clip.skeleton().len();
    let waves: Vec<(usize, Vec3, [f64; 4])> = (0..JOINTS)
        .map(|_| {
            // Not the hips, which carry the whole body.
            let joint = 1 + random.below(joints - 1);
            let axis = Vec3::from_array([0; 3].map(|_| random.normal() as f32));
            let numbers = [ANGLE, ANGLE, 4.0, 6.3].map(|most| most * random.next());
            (joint, axis.normalize_or(Vec3::X), numbers)
        })
        .collect();
    let poses = (0..clip.frames()).map(|frame| {
        let mut pose = clip.pose(frame);
        let secs = frame as f64 / clip.fps();
        for (joint, axis, [steady, swing, pace, phase]) in &waves {
            let angle = steady + swing * (secs * pace + phase).sin();
            if let Some(own) = pose.rotations.get_mut(*joint) {
                *own = Quat::from_axis_angle(*axis, angle as f32) * *own;
            }
        }
        pose
    });
    let poses: Vec<_> = poses.collect();
    Ok(Clip::from_poses("", clip.skeleton().clone(), clip.fps(), poses)?)
}

/// Bends the way over the ground, and lengthens its steps.
fn bent(clip: &Clip, random: &mut Random) -> Clip {
    let (rate, sway, pace) =
        (0.5 * random.normal(), 0.4 * random.next(), 0.5 + 1.5 * random.next());
    let longer = 0.85 + 0.35 * random.next();
    let ground: Vec<DVec2> = (clip.root_translations().iter())
        .map(|root| DVec2::new(f64::from(root.x), f64::from(root.z)))
        .collect();
    let Some(first) = ground.first().copied() else { return clip.clone() };
    let (mut here, mut before) = (first, first);
    let moves: Vec<Planar> = ground
        .iter()
        .enumerate()
        .map(|(frame, own)| {
            let secs = frame as f64 / clip.fps();
            let turn = Planar::new(rate * secs + sway * (pace * secs).sin(), 0.0, 0.0);
            let step = *own - before;
            let step = turn.apply(Vec3::new(step.x as f32, 0.0, step.y as f32));
            before = *own;
            here += longer * DVec2::new(f64::from(step.x), f64::from(step.z));
            let own = turn.apply(Vec3::new(own.x as f32, 0.0, own.y as f32));
            Planar { shift: here - DVec2::new(f64::from(own.x), f64::from(own.z)), ..turn }
        })
        .collect();
    clip.transformed_by_frame(&moves)
}

/// A generator of numbers by a seed (`SplitMix64`).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// Returns a number from 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number below `end`; 0 where there is none.
    fn below(&mut self, end: usize) -> usize {
        ((self.next() * end as f64) as usize).min(end.saturating_sub(1))
    }

    /// Returns a number of about the normal distribution: the sum of twelve even ones.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}
