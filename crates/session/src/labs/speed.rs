//! The Speed lab: two gait cycles blended to a speed.

use super::feet::Lock;
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::pair::{Pair, Pairs};
use super::repetition::{Repetition, repeat_cycle};
use super::{Cycle, CycleMade, Outcome, Slot};
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Kind, Params};
use segue_motion::clip::{Contacts, Motion, ground_speed};
use segue_motion::gait::{GaitCycle, PhaseAlignment, SpeedBlend, SpeedOptions};
use segue_motion::skeleton::BodyPlan;
use segue_text::{Message, msg};
use std::sync::Arc;

/// The Speed lab: two cycles blended to a speed.
pub(super) struct SpeedLab;

impl<S: HasPart<Pairs> + HasPart<GaitFinder>> Lab<S> for SpeedLab {
    fn result_name(&self, params: &Params, a: Message, b: Message) -> Message {
        let mps = Key::Speed.param().format(params.get(Key::Speed));
        msg!("{a} and {b} at {mps} m/s", a, b, mps)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} and {}", params.text(Key::A), params.text(Key::B))
    }

    fn found(&self, outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        match outcome.cycle.map(|cycle| cycle.made) {
            Some(CycleMade::Gait { asked_mps, .. }) => vec![(Key::Speed, asked_mps)],
            _ => Vec::new(),
        }
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk&b=cmu16_run")
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        let Some(pair) = HasPart::<Pairs>::part(labs).of_slots(&clips.slots, params)? else {
            return Ok(None);
        };
        Ok(Some(Inputs::new(HasPart::<GaitFinder>::part(labs).inputs(&pair, params)?)))
    }
}

/// The cycles of two clips.
#[derive(Debug)]
struct Gaits {
    pair: Arc<Pair>,
    cycles: [GaitCycle; 2],
}

/// The inputs of a gait at a speed. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct SpeedInputs {
    gaits: Arc<Gaits>,
    alignment: PhaseAlignment,
    asked_mps: f64,
    foot_lock: Option<Lock>,
}

impl PartialEq for SpeedInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.gaits, &other.gaits)
            && (self.alignment, self.foot_lock) == (other.alignment, other.foot_lock)
            && self.asked_mps == other.asked_mps
    }
}

/// A cache of the cycles of two clips.
#[derive(Debug, Default)]
pub(crate) struct GaitFinder {
    known: Option<Arc<Gaits>>,
}

impl GaitFinder {
    /// Returns the gait of the parameters for two clips.
    pub(crate) fn inputs(
        &mut self,
        pair: &Arc<Pair>,
        params: &Params,
    ) -> Result<SpeedInputs, LabError> {
        let gaits = self.gaits(pair)?;
        let clips_mps = [0, 1].map(|clip: usize| gaits.cycles[clip].speed_mps());
        Ok(SpeedInputs {
            alignment: if params.is_on(Key::PhaseAlign) {
                PhaseAlignment::Feet
            } else {
                PhaseAlignment::None
            },
            asked_mps: params.optional(Key::Speed).unwrap_or_else(|| middle_mps(clips_mps)),
            foot_lock: Lock::of(params),
            gaits,
        })
    }

    fn gaits(&mut self, pair: &Arc<Pair>) -> Result<Arc<Gaits>, LabError> {
        if let Some(gaits) = &self.known
            && Arc::ptr_eq(&gaits.pair, pair)
        {
            return Ok(Arc::clone(gaits));
        }
        let cycle = |motion: &Motion, slot: Slot| {
            GaitCycle::find(motion).map_err(|error| LabError::from(error).in_slot(slot))
        };
        let cycles = [cycle(&pair.a, Slot::A)?, cycle(&pair.incoming, Slot::B)?];
        let gaits = Arc::new(Gaits { pair: Arc::clone(pair), cycles });
        self.known = Some(Arc::clone(&gaits));
        Ok(gaits)
    }
}

/// Returns the speed halfway between two, on a step of the slider.
pub(crate) fn middle_mps([a, b]: [f64; 2]) -> f64 {
    let Kind::Number { min, max, step, .. } = Key::Speed.param().kind else {
        return 0.5 * (a + b);
    };
    ((0.5 * (a + b) / step).round() * step).clamp(min, max)
}

impl SpeedInputs {
    /// Returns whether the gaits and their alignment are the same.
    pub(crate) fn differs_in_speed_alone(&self, other: &Self) -> bool {
        let asked_mps = other.asked_mps;
        Self { asked_mps, ..self.clone() } == *other
    }

    /// Computes the gait at another speed.
    pub(crate) fn run_at(&self, speed_mps: f64) -> Result<Outcome, LabError> {
        let asked_mps = speed_mps;
        Self { asked_mps, ..self.clone() }.run()
    }
}

impl LabInputs for SpeedInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let (pair, [a, b]) = (&self.gaits.pair, &self.gaits.cycles);
        let options = SpeedOptions { alignment: self.alignment, ..SpeedOptions::default() };
        let roles = pair.a.roles();
        let blend = SpeedBlend::new(a, b, roles, &options)?;
        let fps = pair.a.clip().fps();
        let three = blend.cycles_at(self.asked_mps, 3)?;
        let (facts, cycle_frames) = (three.facts, (three.clip.frames() - 1) / 3);
        // The events of the gait are those of the hind feet.
        let contacts = match roles.body_plan() {
            BodyPlan::Biped => three.contacts,
            BodyPlan::Quadruped => Contacts::detect(&three.clip, roles, &pair.a.feet().contacts),
        };
        let Repetition { motion, mut slides } = repeat_cycle(
            roles,
            cycle_frames,
            three.clip,
            &contacts,
            pair.ground_m(),
            self.foot_lock,
        )?;
        let measured = f64::from(ground_speed(motion.ground_frames(), fps));
        let mut metrics = vec![
            Metric::new(MetricId::Speed, measured),
            Metric::new(MetricId::Stride, facts.stride_m),
            Metric::new(MetricId::Cadence, facts.cadence_spm),
            Metric::new(MetricId::WeightOfB, 100.0 * facts.weight),
        ];
        metrics.append(&mut slides);
        Ok(Outcome {
            cycle: Some(Cycle {
                secs: cycle_frames as f64 / fps,
                made: CycleMade::Gait {
                    facts,
                    asked_mps: self.asked_mps,
                    clips_mps: blend.speeds_mps(),
                    cuts_secs: [a, b].map(|cycle| {
                        let range = cycle.range();
                        [range.start, range.end]
                            .map(|frame| frame as f64 / cycle.looped().clip.fps())
                    }),
                },
            }),
            retargeted: pair.retargeted.clone(),
            metrics,
            beside: pair.clips(),
            ..Outcome::plain(Arc::new(motion))
        })
    }
}
