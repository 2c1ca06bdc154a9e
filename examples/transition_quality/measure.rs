//! Transitions as the Transition lab makes them with its default parameters, and what can be seen of them, in numbers. Shared with the test of the
//! same name.

#![allow(
    dead_code,
    unreachable_pub,
    reason = "a module of an example and of a test, each of which uses a part of it"
)]

#[path = "../takes/mod.rs"]
mod takes;

use glam::Vec3;
use segue::clip::Clip;
use segue::math::{quat, stats};
use segue::session::{Command, Motion, Outcome, Session};
use segue::skeleton::{Role, Roles, Side, WorldPose};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use takes::session_of_folder;

/// A change of a joint's turning that is smaller is none, radians per step: what single precision makes of a joint at rest.
const STILL_RADIANS: f32 = 1e-4;

/// The lab, and the clips to go through it.
pub struct Lab {
    session: Session,
    takes: Vec<Take>,
}

/// What is known of a clip before it meets another.
struct Take {
    id: String,
    /// Per joint, the 99th percentile of [`change`] over the clip.
    usual: Vec<f32>,
    /// The fastest that a knee turns, radians per second.
    knee: f32,
}

/// One transition.
pub struct Numbers {
    /// The clips' names, outgoing and incoming.
    pub names: [String; 2],
    /// The largest jump of a joint's angular velocity at the seam, over the 99th percentile of that joint's jumps in the clips (the larger one of the
    /// two). At the seam: from the last step that is A's alone to the first of the transition, and from that to the next.
    pub seam: f32,
    /// The joint of [`seam`](Self::seam).
    pub seam_joint: String,
    /// The most that a joint's jump at the seam is above that percentile, degrees per second; 0 where none is.
    pub seam_excess_dps: f32,
    /// The same ratio for the same two frames of A if it had gone on, against itself alone: what an untouched clip has. `None` where A ends there.
    pub untouched: Option<f32>,
    /// How far the character turns beyond what either clip turns meanwhile, degrees.
    pub spin_deg: f64,
    /// For every stance that touches the transition, how far the foot slides at most, centimetres: without foot lock and with it.
    pub slides_cm: [Vec<f32>; 2],
    /// The program's own number: the slide of the worst stance beyond that of its clip, centimetres, without foot lock and with it.
    pub worst_cm: [f64; 2],
    /// The fastest that a knee turns with foot lock, over the fastest in the two clips.
    pub knee: f32,
}

impl Lab {
    /// The clips of a folder: BVH files, and AMC files with the ASF file beside them; those whose file names `wanted` picks.
    ///
    /// # Errors
    /// When the folder or a file cannot be read.
    pub fn of_folder(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Self, Box<dyn Error>> {
        let (session, ids) = session_of_folder(folder, wanted)?;
        Self::of_clips(session, &ids)
    }

    /// The synthesiser's clips of these ids.
    ///
    /// # Errors
    /// When there is no such clip.
    pub fn of_presets(ids: &[&str]) -> Result<Self, Box<dyn Error>> {
        Self::of_clips(Session::new(), ids)
    }

    fn of_clips(mut session: Session, ids: &[impl AsRef<str>]) -> Result<Self, Box<dyn Error>> {
        let mut takes = Vec::new();
        for id in ids.iter().map(AsRef::as_ref) {
            session.apply(Command::OpenLink(format!("lab=view&a={id}")))?;
            let outcome = session.main_outcome().ok_or_else(|| format!("there is no clip `{id}`"))?;
            let motion = &outcome.motion;
            takes.push(Take {
                id: id.to_owned(),
                usual: usual_changes(&motion.clip),
                knee: fastest_knee(&motion.clip, &motion.roles),
            });
        }
        Ok(Self { session, takes })
    }

    /// How many clips there are.
    pub fn len(&self) -> usize {
        self.takes.len()
    }

    /// Goes from one clip to another, without foot lock and with it, and measures that.
    ///
    /// # Errors
    /// When the lab has no result for this pair.
    pub fn pair(&mut self, a: usize, b: usize) -> Result<Numbers, Box<dyn Error>> {
        let (free, locked) = (self.outcome(a, b, "off")?, self.outcome(a, b, "on")?);
        let [of_a, of_b] = [&self.takes[a], &self.takes[b]];
        let ([from, to], Some(place)) = (&free.sources[..], free.transition) else {
            return Err(format!("no transition from {} to {}", of_a.id, of_b.id).into());
        };
        let clip = &free.motion.clip;
        let frame = |secs: f64| (secs * clip.fps()).round() as usize;
        let (start, end) = (frame(place.start_secs), frame(place.end_secs));
        let mut numbers = Numbers {
            names: [of_a, of_b].map(|take| take.id.split('~').next().unwrap_or_default().to_owned()),
            seam: 0.0,
            seam_joint: String::new(),
            seam_excess_dps: 0.0,
            untouched: None,
            spin_deg: metric(&free, "spin_deg"),
            slides_cm: [&free, &locked].map(|outcome| slides(&outcome.motion, start, end)),
            worst_cm: [&free, &locked].map(|outcome| metric(outcome, "skate_cm")),
            knee: fastest_knee(&locked.motion.clip, &locked.motion.roles) / of_a.knee.max(of_b.knee),
        };
        // A clip of another skeleton or rate is another clip by now.
        let usual_of_b = if Arc::ptr_eq(from.motion.clip.skeleton(), to.motion.clip.skeleton()) && of_b.usual.len() == of_a.usual.len() {
            of_b.usual.clone()
        } else {
            usual_changes(&to.motion.clip)
        };
        for frame in start.saturating_sub(1)..=start {
            for (joint, (usual_of_a, usual_of_b)) in of_a.usual.iter().zip(&usual_of_b).enumerate() {
                if let Some(own) = change(&from.motion.clip, frame, joint) {
                    numbers.untouched = Some(numbers.untouched.unwrap_or(0.0).max(own / usual_of_a));
                }
                let Some(jump) = change(clip, frame, joint) else { continue };
                let usual = usual_of_a.max(*usual_of_b);
                if jump / usual > numbers.seam {
                    numbers.seam = jump / usual;
                    numbers.seam_joint.clone_from(&clip.skeleton().joints()[joint].name);
                }
                let excess = (jump - usual).to_degrees() * clip.fps() as f32;
                numbers.seam_excess_dps = numbers.seam_excess_dps.max(excess);
            }
        }
        Ok(numbers)
    }

    fn outcome(&mut self, a: usize, b: usize, foot_lock: &str) -> Result<Arc<Outcome>, Box<dyn Error>> {
        let [a, b] = [&self.takes[a].id, &self.takes[b].id];
        let link = format!("lab=transition&a={a}&b={b}&foot_lock={foot_lock}");
        self.session.apply(Command::OpenLink(link))?;
        while self.session.work() {}
        let pane = &self.session.panes()[0];
        pane.outcome
            .clone()
            .ok_or_else(|| format!("{a} → {b}: {}", pane.problem.as_deref().unwrap_or("nothing is made")).into())
    }
}

fn metric(outcome: &Outcome, id: &str) -> f64 {
    let found = outcome.metrics.iter().find(|metric| metric.id == id);
    found.and_then(|metric| metric.value).unwrap_or(0.0)
}

/// The turn of a joint in the step into a frame, radians.
fn turn(clip: &Clip, frame: usize, joint: usize) -> Vec3 {
    quat::log(clip.rotations(frame)[joint] * clip.rotations(frame - 1)[joint].conjugate())
}

/// How much that turn changes from the step into `frame` to the step out of it, radians.
fn change(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    (frame >= 1 && frame + 1 < clip.frames()).then(|| (turn(clip, frame + 1, joint) - turn(clip, frame, joint)).length())
}

fn usual_changes(clip: &Clip) -> Vec<f32> {
    let usual = |joint| {
        let changes: Vec<f32> = (0..clip.frames()).filter_map(|frame| change(clip, frame, joint)).collect();
        stats::percentile(&changes, 0.99).unwrap_or(0.0).max(STILL_RADIANS)
    };
    (0..clip.skeleton().len()).map(usual).collect()
}

/// For every stance that touches the frames of the transition: the farthest that the foot's stillest point is carried over the ground, centimetres.
fn slides(motion: &Motion, start: usize, end: usize) -> Vec<f32> {
    let clip = &motion.clip;
    let (mut before, mut after) = (WorldPose::default(), WorldPose::default());
    let mut slides = Vec::new();
    for side in Side::BOTH {
        let points = motion.roles.foot_points(clip.skeleton(), side);
        let stances = motion.contacts.intervals(side);
        for stance in stances.into_iter().filter(|stance| stance.start <= end && stance.end >= start) {
            let (mut drift, mut farthest) = (Vec3::ZERO, 0.0_f32);
            for frame in stance.start + 1..stance.end.min(clip.frames()) {
                clip.world_pose_into(frame - 1, &mut before);
                clip.world_pose_into(frame, &mut after);
                let steps = points
                    .iter()
                    .map(|&(joint, point)| after.point(joint, point) - before.point(joint, point));
                let over_ground = steps.map(|step| Vec3::new(step.x, 0.0, step.z));
                drift += over_ground.min_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or_default();
                farthest = farthest.max(drift.length());
            }
            slides.push(farthest * 100.0);
        }
    }
    slides
}

/// Radians per second.
fn fastest_knee(clip: &Clip, roles: &Roles) -> f32 {
    let knees = Side::BOTH.into_iter().filter_map(|side| roles.get(Role::shin(side)));
    let turns = knees.flat_map(|knee| (1..clip.frames()).map(move |frame| turn(clip, frame, knee).length()));
    turns.fold(0.0, f32::max) * clip.fps() as f32
}
