//! What a transition between two captured takes looks like, in numbers: made by the document with its default parameters, and measured from
//! the result alone, with nothing of the program's own metrics but the spin.

use glam::Vec3;
use segue::clip::{Clip, Contacts};
use segue::math::{quat, stats};
use segue::session::{Command, Motion, Outcome, Session, Slot};
use segue::skeleton::{Role, Roles, Side, WorldPose};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

#[derive(Clone, Debug, Default)]
pub struct Pair {
    pub a: String,
    pub b: String,
    pub leave: usize,
    pub enter: usize,
    pub distance_cm: f32,
    pub seam: f32,
    pub seam_joint: String,
    pub seam_dps: f32,
    pub seam_x: f32,
    pub over: f32,
    pub over_joint: String,
    pub over_frame: usize,
    pub pooled: f32,
    pub metric_dps: f64,
    pub spin: f64,
    pub skate: [f64; 2],
    pub stances: [Vec<f32>; 2],
    pub knee: f32,
    pub knee_free: f32,
    pub control: f32,
}

pub struct Bench {
    session: Session,
    pub ids: Vec<String>,
}

impl Bench {
    pub fn open(folder: &Path, wanted: impl Fn(&str) -> bool) -> Result<Self, Box<dyn Error>> {
        let mut paths: Vec<_> = std::fs::read_dir(folder)?.filter_map(|e| e.ok().map(|e| e.path())).collect();
        paths.sort_by_key(|p| (p.extension().is_none_or(|e| e != "asf"), p.clone()));
        let mut session = Session::new();
        session.apply(Command::OpenLink("lab=view".into()))?;
        let mut ids = vec![];
        for path in paths {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let kind = path.extension().unwrap_or_default().to_string_lossy().into_owned();
            let motion = ["amc", "bvh"].contains(&kind.as_str());
            if !(kind == "asf" || motion && wanted(&name)) { continue; }
            let loaded = session.load(&name, std::fs::read(&path)?.into())?;
            if motion { ids.extend(loaded.ids); }
        }
        Ok(Self { session, ids })
    }

    pub fn made() -> Result<Self, Box<dyn Error>> {
        let session = Session::new();
        let ids = segue::synth::presets().iter().map(|p| p.id.to_owned()).collect();
        Ok(Self { session, ids })
    }

    fn outcome(&mut self, a: &str, b: &str, lock: bool) -> Result<Arc<Outcome>, Box<dyn Error>> {
        let lock = if lock { "on" } else { "off" };
        self.session.apply(Command::OpenLink(format!("lab=transition&a={a}&b={b}&foot_lock={lock}")))?;
        while self.session.work() {}
        let pane = &self.session.panes()[0];
        pane.outcome.clone().ok_or_else(|| format!("{a} {b}: {:?}", pane.problem).into())
    }

    pub fn pair(&mut self, a: &str, b: &str) -> Result<Pair, Box<dyn Error>> {
        let free = self.outcome(a, b, false)?;
        let locked = self.outcome(a, b, true)?;
        Ok(measure(a, b, &free, &locked))
    }
}

fn metric(outcome: &Outcome, id: &str) -> f64 {
    outcome.metrics.iter().find(|m| m.id == id).and_then(|m| m.value).unwrap_or(f64::NAN)
}

fn turn(clip: &Clip, frame: usize, joint: usize) -> Vec3 {
    quat::log(quat::shorter_way(clip.rotations(frame)[joint] * clip.rotations(frame - 1)[joint].conjugate()))
}

fn change(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    (frame >= 1 && frame + 1 < clip.frames()).then(|| (turn(clip, frame + 1, joint) - turn(clip, frame, joint)).length())
}

fn usual(clip: &Clip) -> Vec<f32> {
    (0..clip.skeleton().len())
        .map(|joint| {
            let all: Vec<f32> = (1..clip.frames().max(2) - 1).filter_map(|f| change(clip, f, joint)).collect();
            stats::percentile(&all, 0.99).unwrap_or(0.0)
        })
        .collect()
}

fn measure(a: &str, b: &str, free: &Outcome, locked: &Outcome) -> Pair {
    let clip = &free.motion.clip;
    let fps = clip.fps();
    let place = free.transition.unwrap();
    let frame = |secs: f64| (secs * fps).round() as usize;
    let (start, end) = (frame(place.start_secs), frame(place.end_secs));
    let (leave, enter) = (start, frame(place.enter_b_secs));
    let from = &free.sources[0].motion;
    let to = &free.sources[1].motion;
    let (ua, ub) = (usual(&from.clip), usual(&to.clip));
    let pooled = |c: &Clip| {
        let all: Vec<f32> = (1..c.frames() - 1).flat_map(|f| (0..c.skeleton().len()).filter_map(move |j| change(c, f, j))).collect();
        stats::percentile(&all, 0.99).unwrap()
    };
    let pool = pooled(&from.clip).max(pooled(&to.clip));
    let mut p = Pair { a: a.into(), b: b.into(), leave, enter, distance_cm: place.distance_cm, ..Pair::default() };
    let name = |j: usize| clip.skeleton().joints()[j].name.clone();
    let deg = |x: f32| x.to_degrees() * fps as f32;
    for f in start.max(1) - 1..=end {
        for j in 0..clip.skeleton().len() {
            let Some(c) = change(clip, f, j) else { continue };
            let limit = ua[j].max(ub[j]).max(1e-5);
            let own = change(&from.clip, f, j).unwrap_or(0.0).max((f + enter).checked_sub(start).and_then(|g| change(&to.clip, g, j)).unwrap_or(0.0));
            let ratio = c / limit;
            let ratio_x = c / limit.max(own);
            if f <= start {
                if ratio > p.seam { p.seam = ratio; p.seam_joint = name(j); p.seam_dps = deg(c); }
                p.seam_x = p.seam_x.max(ratio_x);
                p.pooled = p.pooled.max(c / pool);
                let ca = change(&from.clip, f, j).unwrap_or(0.0) / ua[j].max(1e-5);
                p.control = p.control.max(ca);
            }
            if ratio_x > p.over { p.over = ratio_x; p.over_joint = name(j); p.over_frame = f - (start.max(1) - 1); }
        }
    }
    p.metric_dps = metric(free, "seam_dps");
    p.spin = metric(free, "spin_deg");
    p.skate = [metric(free, "skate_cm"), metric(locked, "skate_cm")];
    let margin = (0.5 * fps) as usize;
    let around = start.saturating_sub(margin)..(end + margin).min(clip.frames());
    p.stances = [free, locked].map(|o| stances(&o.motion, &locked.motion.contacts, &around));
    let fastest = |m: &Motion| fastest_knee(&m.clip, &m.roles);
    p.knee = fastest(&locked.motion) / fastest(from).max(fastest(to));
    p.knee_free = fastest(&locked.motion) / fastest(&free.motion);
    p
}

fn stances(motion: &Motion, contacts: &Contacts, around: &std::ops::Range<usize>) -> Vec<f32> {
    let clip = &motion.clip;
    let worlds: Vec<WorldPose> = (0..clip.frames()).map(|f| clip.world_pose(f)).collect();
    let mut all = vec![];
    for side in Side::BOTH {
        let points = motion.roles.foot_points(clip.skeleton(), side);
        for stance in contacts.intervals(side) {
            if stance.end <= around.start || stance.start >= around.end { continue; }
            let (mut drift, mut far) = (Vec3::ZERO, 0.0_f32);
            for f in stance.start + 1..stance.end.min(clip.frames()) {
                let step = points.iter().map(|&(j, p)| (worlds[f].point(j, p) - worlds[f - 1].point(j, p)) * Vec3::new(1.0, 0.0, 1.0));
                drift += step.min_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(Vec3::ZERO);
                far = far.max(drift.length());
            }
            all.push(far * 100.0);
        }
    }
    all
}

fn fastest_knee(clip: &Clip, roles: &Roles) -> f32 {
    let knees = Side::BOTH.map(|side| roles.get(Role::shin(side)).unwrap_or(0));
    let steps = (1..clip.frames()).flat_map(|f| knees.map(|k| turn(clip, f, k).length()));
    steps.fold(0.0, f32::max).to_degrees() * clip.fps() as f32
}
