//! Measurements of results, compared with their sources.

use super::trial::Numbers;
use segue_motion::clip::{Clip, Motion};
use segue_motion::math::stats::median;
use segue_motion::metrics::{Artefacts, MotionTrace};
use segue_session::{CycleMade, Outcome};

/// Measures a result: its motion compared with `sources`, and its foot skating compared with
/// `feet`.
pub(super) fn measured(
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

pub(super) fn traced(motion: &Motion) -> MotionTrace {
    MotionTrace::new(motion.clip(), motion.roles())
}

fn is_finite(clip: &Clip) -> bool {
    let rotations =
        (0..clip.frames()).flat_map(|frame| clip.rotations(frame)).all(|q| q.is_finite());
    let moved = clip.translations().iter().flat_map(|joint| &joint.values).all(|t| t.is_finite());
    rotations && moved && clip.root_translations().iter().all(|t| t.is_finite())
}

/// Returns the distance that a result bridges: of the windows of its transition, of the registered
/// frames, or of the ends of its cycle.
pub(super) fn own_distance_cm(outcome: &Outcome) -> Option<f64> {
    match (outcome.transition.as_ref(), outcome.cycle.as_ref().map(|cycle| &cycle.made)) {
        (_, Some(CycleMade::Cut { distance_cm, .. })) => Some(*distance_cm),
        (Some(transition), _) => Some(f64::from(transition.distance_cm)),
        _ => None,
    }
}

/// Returns the part of A that loops: it may skate more than the whole of A, which also contains
/// standing and flight.
pub(super) fn cut_part(outcome: &Outcome, a: &Motion) -> Option<MotionTrace> {
    let CycleMade::Cut { from_secs, to_secs, .. } = outcome.cycle?.made else {
        return None;
    };
    let frame = |secs: f64| (secs * a.clip().fps()).round() as usize;
    let part = a.clip().crop(frame(from_secs)..(frame(to_secs) + 1).min(a.clip().frames())).ok()?;
    Some(MotionTrace::new(&part, a.roles()))
}
