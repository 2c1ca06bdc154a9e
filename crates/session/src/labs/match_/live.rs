//! A character that is driven live.

use super::trace::Tracer;
use crate::labs::LabError;
use crate::labs::{ArtefactMeter, Outcome};
use crate::metrics::{Metric, MetricId};
use segue_motion::matching::{Control, Controller, ControllerOptions, Database, RATE};
use segue_motion::math::Planar;
use segue_motion::metrics::ResultMetrics;
use std::collections::VecDeque;
use std::sync::Arc;

/// The length of the history that is kept, ticks: 5 s.
const HISTORY_TICKS: usize = 5 * RATE;
/// The period over which jumps are counted, ticks: 30 s.
const COUNTED_TICKS: u64 = 30 * RATE as u64;
/// The interval of measurements, ticks: four times a second, about as fast as one can read.
const MEASUREMENT_TICKS: u64 = RATE as u64 / 4;

/// A controller with live input, and the last seconds of its motion.
#[derive(Debug)]
pub(crate) struct Live {
    tracer: Tracer,
    /// The ticks of the last jumps.
    jumps: VecDeque<u64>,
    metrics: Vec<Metric>,
    found: Option<ResultMetrics>,
}

impl Live {
    /// Returns a character at the origin.
    pub(crate) fn new(
        database: &Arc<Database>,
        options: ControllerOptions,
    ) -> Result<Self, LabError> {
        let controller = Controller::new(Arc::clone(database), options, &Planar::IDENTITY)?;
        let mut tracer = Tracer::new(controller, HISTORY_TICKS);
        tracer.note(false);
        Ok(Self { tracer, jumps: VecDeque::new(), metrics: Vec::new(), found: None })
    }

    /// Returns whether it plays the clips of a database.
    pub(crate) fn plays(&self, database: &Database) -> bool {
        let mine = self.tracer.controller.database().motions();
        // Tags may differ.
        mine.len() == database.motions().len()
            && mine.iter().zip(database.motions()).all(|(a, b)| Arc::ptr_eq(a.clip(), b.clip()))
    }

    /// Continues with other options and a database of the same clips. Returns whether anything
    /// changed.
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

    /// Advances by one tick.
    pub(crate) fn tick(&mut self, control: &Control) {
        let before = self.tracer.controller.jumps();
        self.tracer.tick(control);
        let now = self.tracer.controller.ticks();
        if self.tracer.controller.jumps() > before {
            self.jumps.push_back(now);
        }
        while self.jumps.front().is_some_and(|tick| tick + COUNTED_TICKS < now) {
            self.jumps.pop_front();
        }
    }

    /// Returns the position of the character.
    pub(crate) fn root(&self) -> Planar {
        self.tracer.controller.root()
    }

    /// Returns the duration of the history, seconds.
    pub(crate) fn kept_secs(&self) -> f64 {
        self.tracer.frames().saturating_sub(1) as f64 / RATE as f64
    }

    /// Returns the history as an outcome, with metrics: those of every lab as soon as its clips are
    /// measured.
    pub(crate) fn outcome(&mut self, meter: &mut ArtefactMeter) -> Result<Outcome, LabError> {
        let mut outcome = self.tracer.outcome(true)?;
        let ticks = self.tracer.controller.ticks();
        if ticks.is_multiple_of(MEASUREMENT_TICKS) || self.metrics.is_empty() {
            self.found = meter.numbers_now(&outcome);
            self.metrics = self.tracer.metrics(&outcome.motion);
            // Most turns in the history have no beginning or no end.
            self.metrics.retain(|metric| metric.id != MetricId::TurnTime);
            let over_secs = ticks.min(COUNTED_TICKS) as f64 / RATE as f64;
            let jumps = |metric: &&mut Metric| metric.id == MetricId::JumpsPerMinute;
            for metric in self.metrics.iter_mut().filter(jumps) {
                metric.value =
                    (over_secs > 1.0).then(|| self.jumps.len() as f64 * 60.0 / over_secs);
            }
        }
        outcome.metrics.clone_from(&self.metrics);
        outcome.take_numbers(self.found);
        Ok(outcome)
    }
}
