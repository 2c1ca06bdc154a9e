//! Trials of every lab and every method on a pair or a set of takes, opened by links as users open
//! them.

use super::folder::{Motions, Random, encoded};
use super::guard::{guarded, parallel_map};
use segue_motion::clip::{Clip, Motion, mirror};
use segue_motion::math::stats;
use segue_motion::metrics::{Artefacts, MotionTrace};
use segue_motion::path::GroundSpline;
use segue_session::{Command, CycleMade, Outcome, Session, write_ids};
use std::sync::Arc;
use std::time::Instant;

/// The greatest distance of the windows of a close pair, centimetres: a transition between them
/// should be smooth.
const CLOSE_CM: f32 = 12.0;
/// The ratio above which foot skating counts as more than another clip's: two measurements agree to
/// within this ratio.
const SAME_SKATING: f64 = 1.05;
/// The least difference in foot skating that counts, cm/s: standing clips have next to none, and a
/// millimetre per second is not visible.
const MIN_SKATING_CMPS: f64 = 0.1;
/// The time limit of a trial, seconds.
const MAX_SECS: f64 = 120.0;
/// The sideways displacement of an edited path, as a share of its length, and at most this many
/// metres.
const BULGE: f64 = 0.05;
const MAX_BULGE_M: f64 = 1.0;
/// The number of takes in a set.
const SET: usize = 4;

const WEIGHT_LAWS: [&str; 3] = ["smooth", "linear", "smoother"];
const TRANSITIONS: [&str; 7] =
    ["inertialize", "cubic", "quintic", "dead", "smooth", "linear", "cut"];
const LOOPS: [&str; 6] = ["exact", "both", "start", "end", "linear", "cubic"];
const LAYERS: [&str; 2] = ["partial", "additive"];
const REGISTERED: [&str; 2] = ["blend", "join"];
const KEEPS: [&str; 3] = ["speed", "duration", "whole"];
const CONSTRUCTIONS: [&str; 2] = ["minima", "segments"];
const WALKS: [&str; 2] = ["dissolve", "inertialize"];
const SCENARIOS: [&str; 7] = ["straight", "left", "right", "spin", "start_stop", "run", "eight"];
const JUMPS: [&str; 2] = ["inertialize", "dead"];

/// The kind of a draw of takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Draw {
    /// Two takes of one rig.
    SameRig,
    /// Two takes of two rigs.
    OtherRigs,
    /// Four takes of one rig.
    Set,
}

impl Draw {
    /// Returns the heading of its table.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::SameRig => "Pairs of the same rig",
            Self::OtherRigs => "Pairs of different rigs",
            Self::Set => "Sets of four takes of one rig",
        }
    }
}

/// A use of a lab with one method.
#[derive(Clone, Debug)]
struct LabUse {
    lab: &'static str,
    method: String,
    /// The parameters of the link besides the takes.
    query: String,
    /// The parameter of the foot lock.
    lock: &'static str,
    of: Of,
    /// Whether it jumps intentionally: it is measured without bounds.
    jumps: bool,
}

/// The takes of a use.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Of {
    /// A and B.
    Both,
    /// A.
    First,
    /// All, in the list parameter of this name.
    All(&'static str),
}

/// The result of one use of a lab on some takes.
#[derive(Debug, serde::Serialize)]
pub struct Trial {
    /// The lab's name in links.
    pub lab: &'static str,
    /// The name of the method.
    pub method: String,
    /// The table of the trial.
    #[serde(skip)]
    pub draw: Draw,
    /// The takes.
    pub takes: Vec<String>,
    /// The link, which opens the result if the takes are in the library.
    pub link: String,
    /// Whether feet are locked.
    pub locked: bool,
    /// Whether the bounds apply.
    pub bound: bool,
    /// The duration, seconds.
    pub secs: f64,
    /// The result.
    pub result: TrialResult,
}

/// The result of a trial.
#[derive(Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialResult {
    /// A motion with its measurements.
    Made(Box<Numbers>),
    /// No motion, with a sentence that says why.
    Refused(String),
    /// No motion, and no message.
    Silent,
    /// A panic with its message and place.
    Panicked(String),
}

/// Measurements of a result compared with its sources.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct Numbers {
    /// Whether anything in it is not finite.
    pub not_finite: bool,
    /// Counts as in [`Artefacts`].
    pub spins: usize,
    pub flashes: usize,
    pub new_flashes: usize,
    pub root_jumps: usize,
    pub new_root_jumps: usize,
    /// The first flash that no source has: frame, joint, and the ratio to the sources' 99.9th
    /// percentile.
    pub first_flash: Option<(usize, String, f64)>,
    /// Foot skating of the result, and of the worst source, cm/s.
    pub skating: Option<f64>,
    pub source_skating: Option<f64>,
    /// The median foot slide of a stance in the result, and in the sources, cm.
    pub stance_cm: Option<f64>,
    pub source_stance_cm: Option<f64>,
}

impl Trial {
    /// Returns the names of the numbers that are worse than the sources' beyond the bounds.
    #[must_use]
    pub fn faults(&self) -> Vec<&'static str> {
        let mut faults = Vec::new();
        let mut note = |is_fault: bool, name: &'static str| {
            if is_fault {
                faults.push(name);
            }
        };
        match &self.result {
            TrialResult::Refused(_) => {}
            TrialResult::Silent => note(true, "refused without a word"),
            TrialResult::Panicked(_) => note(true, "panic"),
            TrialResult::Made(numbers) => {
                note(numbers.not_finite, "not finite");
                if self.bound {
                    note(numbers.spins > 0, "spin");
                    note(numbers.new_flashes > 0, "flash");
                    note(numbers.new_root_jumps > 0, "root jump");
                    let worse =
                        numbers.skating.zip(numbers.source_skating).is_some_and(|(own, source)| {
                            own > (SAME_SKATING * source).max(source + MIN_SKATING_CMPS)
                        });
                    note(self.locked && worse, "skating");
                }
            }
        }
        faults
    }
}

/// Runs all labs on `pairs` pairs of one rig and as many of two, and on half as many sets of four
/// takes, drawn by `seed`.
#[must_use]
pub fn try_all(motions: &Motions, pairs: usize, seed: u64) -> Vec<Trial> {
    let draw = draw(motions, pairs, seed);
    let tried = parallel_map(draw.len(), |index| {
        let (what, takes) = &draw[index];
        TrialSession::new(motions, *what, takes).run()
    });
    tried.into_iter().flatten().collect()
}

fn draw(motions: &Motions, pairs: usize, seed: u64) -> Vec<(Draw, Vec<usize>)> {
    let takes = &motions.takes;
    let mut chance = Random::new(seed);
    let rig = |take: usize| takes[take].rig;
    let mut draw: Vec<(Draw, Vec<usize>)> = Vec::new();
    let wanted = [
        (Draw::SameRig, 2, pairs),
        (Draw::OtherRigs, 2, pairs),
        (Draw::Set, SET, pairs.div_ceil(2)),
    ];
    for (what, size, count) in wanted {
        let first = draw.len();
        // With fewer takes than requested, all of them are drawn eventually.
        for _ in 0..count * 200 {
            if draw.len() - first == count || takes.is_empty() {
                break;
            }
            let mut chosen = vec![chance.below(takes.len())];
            while chosen.len() < size {
                let fits = |take: usize| {
                    (rig(take) == rig(chosen[0])) != (what == Draw::OtherRigs)
                        && !chosen.contains(&take)
                };
                let mates: Vec<usize> = (0..takes.len()).filter(|&take| fits(take)).collect();
                match mates.get(chance.below(mates.len())) {
                    Some(&mate) => chosen.push(mate),
                    None => break,
                }
            }
            if chosen.len() == size && !draw[first..].iter().any(|(_, known)| *known == chosen) {
                draw.push((what, chosen));
            }
        }
    }
    draw
}

/// Takes, a session with them, and traces of their sources.
struct TrialSession<'a> {
    motions: &'a Motions,
    draw: Draw,
    takes: Vec<usize>,
    session: Option<(Session, Vec<String>)>,
}

impl<'a> TrialSession<'a> {
    fn new(motions: &'a Motions, draw: Draw, takes: &[usize]) -> Self {
        Self { motions, draw, takes: takes.to_vec(), session: None }
    }

    fn names(&self) -> Vec<String> {
        self.takes.iter().map(|&take| self.motions.takes[take].name.clone()).collect()
    }

    /// Opens a link in the session, or in a new one if the last was lost in a panic.
    fn open(&mut self, link: impl Fn(&[String]) -> String) -> Opened {
        if self.session.is_none() {
            match guarded(|| self.motions.open(&self.takes)) {
                Ok(Ok(session)) => self.session = Some(session),
                Ok(Err(sentence)) => {
                    return Opened::without(String::new(), Err(TrialResult::Refused(sentence)));
                }
                Err(place) => {
                    return Opened::without(String::new(), Err(TrialResult::Panicked(place)));
                }
            }
        }
        let Some((mut session, ids)) = self.session.take() else {
            return Opened::without(String::new(), Err(TrialResult::Silent));
        };
        let link = link(&ids);
        let start = Instant::now();
        let made = guarded(|| shown(&mut session, &link));
        let secs = start.elapsed().as_secs_f64();
        let made = match made {
            Ok(made) => {
                self.session = Some((session, ids));
                made
            }
            Err(place) => Err(TrialResult::Panicked(place)),
        };
        Opened { link, secs, made }
    }

    fn run(mut self) -> Vec<Trial> {
        // The first opening also synthesises the session's clips, which is not timed.
        let view = self.open(|ids| format!("lab=view&a={}", encoded(&ids[0])));
        let mut trials = Vec::new();
        let Ok(first) = &view.made else {
            trials.push(self.trial(
                "view",
                "a clip as it is".to_owned(),
                false,
                false,
                view,
                |_| Numbers::default(),
            ));
            return trials;
        };
        let (first, mut sources) = (Arc::clone(&first.motion), Vec::new());
        let mut is_close = self.draw == Draw::Set;
        if self.draw == Draw::Set {
            for index in 0..self.takes.len() {
                if let Ok(outcome) =
                    self.open(|ids| format!("lab=view&a={}", encoded(&ids[index]))).made
                {
                    sources.push(traced(&outcome.motion));
                }
            }
        } else {
            sources.push(traced(&first));
            let pair =
                self.open(|ids| format!("lab=blend&a={}&b={}", encoded(&ids[0]), encoded(&ids[1])));
            if let Ok(outcome) = &pair.made {
                is_close =
                    outcome.transition.is_some_and(|transition| transition.distance_cm < CLOSE_CM);
                // B as it is mixed: on the skeleton of A.
                sources.extend(outcome.sources.get(1).map(|source| traced(&source.motion)));
            }
            if self.draw == Draw::OtherRigs
                && let Ok(outcome) =
                    self.open(|ids| format!("lab=view&a={}", encoded(&ids[1]))).made
                && let Some(moved) =
                    pair.made.as_ref().ok().and_then(|pair| {
                        pair.sources.get(1).map(|source| Arc::clone(&source.motion))
                    })
            {
                let original = traced(&outcome.motion);
                let numbers = measured(&moved, &[], &[&original], &[&original]);
                trials.push(self.trial(
                    "retarget",
                    "B on the skeleton of A".to_owned(),
                    false,
                    false,
                    pair,
                    |_| numbers,
                ));
            }
        }
        let mirrored = self.mirrored();
        let path_code = self.edited_path();
        for lab_use in lab_uses(self.draw, path_code.as_deref()) {
            for locked in [false, true] {
                let opened = self.open(|ids| lab_use.link(ids, locked));
                let beside: Vec<&MotionTrace> = match (lab_use.of, lab_use.lab) {
                    (Of::First, _) => sources.iter().take(1).collect(),
                    // The database contains every take and its mirror image.
                    (_, "match") => sources.iter().chain(&mirrored).collect(),
                    _ => sources.iter().collect(),
                };
                let feet: Vec<&MotionTrace> = if lab_use.of == Of::First {
                    sources.iter().take(1).collect()
                } else {
                    sources.iter().collect()
                };
                // A path that turns faster than the motion can is reported as such, and no bounds
                // apply to the motion on it.
                let is_hard = |outcome: &Arc<Outcome>| {
                    outcome.path().is_some_and(|path| !path.hard_turns.is_empty())
                };
                // An additive layer adds its own speed by design.
                let adds = lab_use.lab == "layers" && lab_use.method == "additive";
                let is_far = opened.made.as_ref().is_ok_and(|outcome| {
                    own_distance_cm(outcome).is_some_and(|cm| cm >= f64::from(CLOSE_CM))
                });
                let asks_much =
                    lab_use.jumps || adds || is_far || opened.made.as_ref().is_ok_and(is_hard);
                let bound =
                    !asks_much && (is_close || lab_use.lab == "match") && lab_use.lab != "graph";
                let numbers = |outcome: &Outcome| {
                    let values: Vec<f64> =
                        outcome.metrics.iter().filter_map(|metric| metric.value).collect();
                    let part = cut_part(outcome, &first);
                    let feet: Vec<&MotionTrace> = feet.iter().copied().chain(&part).collect();
                    measured(&outcome.motion, &values, &beside, &feet)
                };
                trials.push(self.trial(
                    lab_use.lab,
                    lab_use.method.clone(),
                    locked,
                    bound,
                    opened,
                    numbers,
                ));
            }
        }
        trials
    }

    fn trial(
        &self,
        lab: &'static str,
        method: String,
        locked: bool,
        bound: bool,
        opened: Opened,
        numbers: impl FnOnce(&Outcome) -> Numbers,
    ) -> Trial {
        Trial {
            lab,
            method,
            draw: self.draw,
            takes: self.names(),
            link: opened.link,
            locked,
            bound,
            secs: opened.secs,
            result: match opened.made {
                Ok(outcome) => guarded(|| numbers(&outcome))
                    .map_or_else(TrialResult::Panicked, |numbers| {
                        TrialResult::Made(Box::new(numbers))
                    }),
                Err(result) => result,
            },
        }
    }

    /// Returns the mirror images of the takes of a set.
    fn mirrored(&mut self) -> Vec<MotionTrace> {
        let count = if self.draw == Draw::Set { self.takes.len() } else { 0 };
        let mut traces = Vec::new();
        for index in 0..count {
            if let Ok(outcome) =
                self.open(|ids| format!("lab=view&a={}", encoded(&ids[index]))).made
            {
                let motion = &outcome.motion;
                traces.extend(
                    mirror(motion.clip(), motion.roles())
                        .map(|clip| MotionTrace::new(&clip, motion.roles())),
                );
            }
        }
        traces
    }

    /// Returns the code of A's path with its middle moved sideways.
    fn edited_path(&mut self) -> Option<String> {
        if self.draw == Draw::Set {
            return None;
        }
        let fitted = self.open(|ids| format!("lab=path&a={}", encoded(&ids[0]))).made.ok()?;
        let curve = &fitted.path()?.curve;
        let spline = curve.spline();
        let points = spline.points();
        let chord = *points.last()? - *points.first()?;
        let aside = chord.perp().try_normalize().unwrap_or(glam::DVec2::X)
            * (BULGE * curve.length_m()).min(MAX_BULGE_M);
        let last = (points.len() - 1) as f64;
        let moved = points.iter().enumerate().map(|(index, point)| {
            let share = index as f64 / last;
            *point + aside * (std::f64::consts::PI * share).sin()
        });
        let edited = GroundSpline::with_knots(moved.collect(), spline.inner_knots()).ok()?;
        Some(edited.to_code())
    }
}

struct Opened {
    link: String,
    secs: f64,
    made: Result<Arc<Outcome>, TrialResult>,
}

impl Opened {
    fn without(link: String, made: Result<Arc<Outcome>, TrialResult>) -> Self {
        Self { link, secs: 0.0, made }
    }
}

/// Opens a link and returns its result when all work is done.
fn shown(session: &mut Session, link: &str) -> Result<Arc<Outcome>, TrialResult> {
    let opened = session.apply(Command::OpenLink(link.to_owned()));
    opened.map_err(|error| TrialResult::Refused(error.to_string()))?;
    let start = Instant::now();
    while session.work() {
        if start.elapsed().as_secs_f64() > MAX_SECS {
            return Err(TrialResult::Silent);
        }
    }
    let pane = session.panes().first().ok_or(TrialResult::Silent)?;
    match (&pane.problem, &pane.outcome) {
        (Some(problem), _) => Err(match problem.to_string() {
            sentence if sentence.trim().is_empty() => TrialResult::Silent,
            sentence => TrialResult::Refused(sentence),
        }),
        (None, Some(outcome)) => Ok(Arc::clone(outcome)),
        (None, None) => Err(TrialResult::Silent),
    }
}

fn traced(motion: &Motion) -> MotionTrace {
    MotionTrace::new(motion.clip(), motion.roles())
}

fn is_finite(clip: &Clip) -> bool {
    let rotations =
        (0..clip.frames()).flat_map(|frame| clip.rotations(frame)).all(|q| q.is_finite());
    let moved = clip.translations().iter().flat_map(|joint| &joint.values).all(|t| t.is_finite());
    rotations && moved && clip.root_translations().iter().all(|t| t.is_finite())
}

/// Measures a result: its motion compared with `sources`, and its foot skating compared with
/// `feet`.
fn measured(
    motion: &Motion,
    values: &[f64],
    sources: &[&MotionTrace],
    feet: &[&MotionTrace],
) -> Numbers {
    if !is_finite(motion.clip()) {
        return Numbers { not_finite: true, ..Numbers::default() };
    }
    let trace = traced(motion);
    let Artefacts { spins, flashes, new_flashes, root_jumps, new_root_jumps } =
        trace.beside(sources);
    let joints = motion.clip().skeleton().joints();
    let stances: Vec<f64> = feet.iter().flat_map(|source| source.stances_cm()).copied().collect();
    Numbers {
        not_finite: values.iter().any(|value| !value.is_finite()),
        spins,
        flashes,
        first_flash: new_flashes
            .first()
            .map(|flash| (flash.frame, joints[flash.joint].name.clone(), flash.times)),
        new_flashes: new_flashes.len(),
        root_jumps,
        new_root_jumps,
        skating: trace.skating_cm_per_sec(),
        source_skating: feet
            .iter()
            .filter_map(|source| source.skating_cm_per_sec())
            .reduce(f64::max),
        stance_cm: median(trace.stances_cm()),
        source_stance_cm: median(&stances),
    }
}

/// Returns the distance that a result bridges: of the windows of its transition, of the registered
/// frames, or of the ends of its cycle.
fn own_distance_cm(outcome: &Outcome) -> Option<f64> {
    match (outcome.transition.as_ref(), outcome.cycle.as_ref().map(|cycle| &cycle.made)) {
        (_, Some(CycleMade::Cut { distance_cm, .. })) => Some(*distance_cm),
        (Some(transition), _) => Some(f64::from(transition.distance_cm)),
        _ => None,
    }
}

/// Returns the part of A that loops: it may skate more than the whole of A, which also contains
/// standing and flight.
fn cut_part(outcome: &Outcome, a: &Motion) -> Option<MotionTrace> {
    let CycleMade::Cut { from_secs, to_secs, .. } = outcome.cycle?.made else {
        return None;
    };
    let frame = |secs: f64| (secs * a.clip().fps()).round() as usize;
    let part = a.clip().crop(frame(from_secs)..(frame(to_secs) + 1).min(a.clip().frames())).ok()?;
    Some(MotionTrace::new(&part, a.roles()))
}

/// Returns the median.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    let values: Vec<f32> = values.iter().map(|value| *value as f32).collect();
    stats::percentile(&values, 0.5).map(f64::from)
}

impl LabUse {
    fn link(&self, ids: &[String], locked: bool) -> String {
        let takes = match self.of {
            Of::Both => format!("a={}&b={}", encoded(&ids[0]), encoded(&ids[1])),
            Of::First => format!("a={}", encoded(&ids[0])),
            Of::All(key) => format!("{key}={}", encoded(&write_ids(ids))),
        };
        let switch = if locked { "on" } else { "off" };
        format!("lab={}&{takes}&{}&{}={switch}", self.lab, self.query, self.lock)
    }
}

fn lab_uses(draw: Draw, path_code: Option<&str>) -> Vec<LabUse> {
    let mut lab_uses = Vec::new();
    let mut add = |lab: &'static str, of: Of, method: String, query: String, jumps: bool| {
        lab_uses.push(LabUse {
            lab,
            method,
            query,
            lock: if lab == "match" { "plant_feet" } else { "foot_lock" },
            of,
            jumps,
        });
    };
    if draw == Draw::Set {
        for (scenario, jump) in
            SCENARIOS.into_iter().flat_map(|scenario| JUMPS.map(|jump| (scenario, jump)))
        {
            let query = format!("scenario={scenario}&jump_method={jump}");
            add("match", Of::All("match_clips"), format!("{scenario}, {jump}"), query, false);
        }
        for (construction, walk) in CONSTRUCTIONS
            .into_iter()
            .flat_map(|construction| WALKS.map(|walk| (construction, walk)))
        {
            let query = format!("construction={construction}&walk_method={walk}");
            add("graph", Of::All("clips"), format!("{construction}, {walk}"), query, false);
        }
        return lab_uses;
    }
    for law in WEIGHT_LAWS {
        add("blend", Of::Both, law.to_owned(), format!("weight_law={law}"), false);
    }
    for method in TRANSITIONS {
        add("transition", Of::Both, method.to_owned(), format!("method={method}"), method == "cut");
    }
    add("speed", Of::Both, "half lab_use".to_owned(), "speed=auto".to_owned(), false);
    for method in LOOPS {
        add("loop", Of::First, method.to_owned(), format!("loop_method={method}"), false);
    }
    // Without root motion feet slide by design: only the rebuilt motion is bound by its source.
    let (rebuilt, query) = ("put_back".to_owned(), "root_way=put_back".to_owned());
    add("in_place", Of::First, rebuilt, query, false);
    for mode in LAYERS {
        add("layers", Of::Both, mode.to_owned(), format!("layer_mode={mode}"), false);
    }
    for mode in REGISTERED {
        add("register", Of::Both, mode.to_owned(), format!("warp_mode={mode}"), false);
    }
    for keep in KEEPS {
        let code = path_code.unwrap_or_default();
        add("path", Of::First, format!("bent, {keep}"), format!("keep={keep}&path={code}"), false);
    }
    lab_uses
}
