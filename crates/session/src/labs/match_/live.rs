//! A character that is driven now.

use super::trace::Tracer;
use crate::labs::LabError;
use crate::labs::{Gauge, Outcome};
use segue_motion::matching::{Control, Controller, ControllerOptions, Database, RATE};
use segue_motion::math::Planar;
use segue_motion::metrics::{Metric, ResultMetrics};
use std::collections::VecDeque;
use std::sync::Arc;

/// So much of what was done is kept for the eye, ticks: 5 s.
const KEPT: usize = 5 * RATE;
/// Jumps are counted over this long, ticks: 30 s.
const COUNTED: u64 = 30 * RATE as u64;
/// Numbers are read four times a second, and no more often measured.
const MEASURED: u64 = RATE as u64 / 4;

/// A controller at the hand of the user, and the last seconds of what it did.
#[derive(Debug)]
pub(crate) struct Live {
    tracer: Tracer,
    /// The ticks of the last jumps.
    jumps: VecDeque<u64>,
    metrics: Vec<Metric>,
    found: Option<ResultMetrics>,
}

impl Live {
    /// Stands at the origin.
    pub(crate) fn new(
        database: &Arc<Database>,
        options: ControllerOptions,
    ) -> Result<Self, LabError> {
        let controller = Controller::new(Arc::clone(database), options, &Planar::IDENTITY)?;
        let mut tracer = Tracer::new(controller, KEPT);
        tracer.note(false);
        Ok(Self { tracer, jumps: VecDeque::new(), metrics: Vec::new(), found: None })
    }

    /// Whether it plays the clips of that database.
    pub(crate) fn plays(&self, database: &Database) -> bool {
        let mine = self.tracer.controller.database().motions();
        // Tags may differ.
        mine.len() == database.motions().len()
            && mine.iter().zip(database.motions()).all(|(a, b)| Arc::ptr_eq(a.clip(), b.clip()))
    }

    /// Goes on with other options, and in a database of the same clips.
    /// Says whether that is something else.
    pub(crate) fn change(
        &mut self,
        database: &Arc<Database>,
        options: ControllerOptions,
    ) -> Result<bool, LabError> {
        let controller = &mut self.tracer.controller;
        let moves = !Arc::ptr_eq(controller.database(), database);
        if moves {
            controller.set_database(Arc::clone(database));
        }
        let differs = *controller.options() != options;
        if differs {
            controller.set_options(options)?;
        }
        Ok(moves || differs)
    }

    /// One tick.
    pub(crate) fn tick(&mut self, control: &Control) {
        let before = self.tracer.controller.jumps();
        self.tracer.tick(control);
        let now = self.tracer.controller.ticks();
        if self.tracer.controller.jumps() > before {
            self.jumps.push_back(now);
        }
        while self.jumps.front().is_some_and(|tick| tick + COUNTED < now) {
            self.jumps.pop_front();
        }
    }

    /// Where the character stands.
    pub(crate) fn root(&self) -> Planar {
        self.tracer.controller.root()
    }

    /// How long what is kept is, seconds.
    pub(crate) fn kept_secs(&self) -> f64 {
        self.tracer.frames().saturating_sub(1) as f64 / RATE as f64
    }

    /// What was done last, with numbers: those that every lab has as soon as what it is made of is
    /// measured.
    pub(crate) fn outcome(&mut self, gauge: &mut Gauge) -> Result<Outcome, LabError> {
        let mut outcome = self.tracer.outcome(true)?;
        let ticks = self.tracer.controller.ticks();
        if ticks.is_multiple_of(MEASURED) || self.metrics.is_empty() {
            self.found = gauge.numbers_now(&outcome);
            self.metrics = self.tracer.metrics(&outcome.motion);
            // Of what was seen last most turns have no beginning or no end.
            self.metrics.retain(|metric| metric.id != "match_turn");
            let over_secs = ticks.min(COUNTED) as f64 / RATE as f64;
            for metric in self.metrics.iter_mut().filter(|metric| metric.id == "match_seams") {
                metric.value =
                    (over_secs > 1.0).then(|| self.jumps.len() as f64 * 60.0 / over_secs);
            }
        }
        outcome.metrics.clone_from(&self.metrics);
        outcome.take_numbers(self.found);
        Ok(outcome)
    }
}
