//! Trials of every lab on a pair or a set of takes, opened by links as users open them.

use super::folder::{Motions, Random, encoded};
use super::guard::{guarded, parallel_map};
use super::lab_uses::{LabTakes, lab_uses};
use super::measured::{cut_part, measured, own_distance_cm, traced};
use super::trial::{Draw, Numbers, Trial, TrialResult};
use segue_motion::clip::mirror;
use segue_motion::metrics::MotionTrace;
use segue_motion::path::GroundSpline;
use segue_session::{Command, Outcome, Session};
use std::sync::Arc;
use std::time::Instant;

/// The greatest distance of the windows of a close pair, centimetres: a transition between them
/// should be smooth.
const MAX_CLOSE_CM: f32 = 12.0;
/// The time limit of a trial, seconds.
const MAX_SECS: f64 = 120.0;
/// The sideways displacement of an edited path, as a share of its length, and at most this many
/// metres.
const BULGE: f64 = 0.05;
const MAX_BULGE_M: f64 = 1.0;
/// The number of takes in a set.
const TAKES_IN_SET: usize = 4;

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

/// Draws the takes of every trial.
fn draw(motions: &Motions, pairs: usize, seed: u64) -> Vec<(Draw, Vec<usize>)> {
    let takes = &motions.takes;
    let mut chance = Random::new(seed);
    let rig = |take: usize| takes[take].rig;
    let mut draw: Vec<(Draw, Vec<usize>)> = Vec::new();
    let wanted = [
        (Draw::SameRig, 2, pairs),
        (Draw::OtherRigs, 2, pairs),
        (Draw::Set, TAKES_IN_SET, pairs.div_ceil(2)),
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
    fn open(&mut self, link: impl Fn(&[String]) -> String) -> OpenedLink {
        if self.session.is_none() {
            match guarded(|| self.motions.open(&self.takes)) {
                Ok(Ok(session)) => self.session = Some(session),
                Ok(Err(sentence)) => {
                    return OpenedLink::without(String::new(), Err(TrialResult::Refused(sentence)));
                }
                Err(place) => {
                    return OpenedLink::without(String::new(), Err(TrialResult::Panicked(place)));
                }
            }
        }
        let Some((mut session, ids)) = self.session.take() else {
            return OpenedLink::without(String::new(), Err(TrialResult::Silent));
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
        OpenedLink { link, secs, made }
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
                is_close = outcome
                    .transition
                    .is_some_and(|transition| transition.distance_cm < MAX_CLOSE_CM);
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
                let beside: Vec<&MotionTrace> = match (lab_use.takes, lab_use.lab) {
                    (LabTakes::First, _) => sources.iter().take(1).collect(),
                    // The database contains every take and its mirror image.
                    (_, "match") => sources.iter().chain(&mirrored).collect(),
                    _ => sources.iter().collect(),
                };
                let feet: Vec<&MotionTrace> = if lab_use.takes == LabTakes::First {
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
                    own_distance_cm(outcome).is_some_and(|cm| cm >= f64::from(MAX_CLOSE_CM))
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
        opened: OpenedLink,
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

/// A link that was opened, with the time that it took, seconds.
struct OpenedLink {
    link: String,
    secs: f64,
    made: Result<Arc<Outcome>, TrialResult>,
}

impl OpenedLink {
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
