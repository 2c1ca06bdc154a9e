//! The Path lab: a motion on another path.

use super::rounds::fact;
use super::{Outcome, Slot, Source};
use crate::blend;
use crate::math::Planar;
use crate::metrics::{Better, Metric};
use crate::path::{
    CarryOptions, FitError, FitOptions, FittedPath, GroundSpline, HardTurn, MotionOptions, Orientation, PathEditor, Road, Timing, Waypoint,
};
use crate::session::compare::MAX_PANES;
use crate::session::motion::Motion;
use crate::session::params::{Key, Params};
use crate::transition::FootLockOptions;
use std::sync::Arc;

/// A motion and the path that was fitted to its way: what stays while the path is edited.
#[derive(Debug)]
pub struct FittedMotion {
    motion: Arc<Motion>,
    options: FitOptions,
    editor: PathEditor,
    road: Arc<Road>,
    error: FitError,
    errors_cm: Vec<[f64; 2]>,
}

impl FittedMotion {
    fn new(motion: &Arc<Motion>, options: FitOptions) -> Result<Self, String> {
        let source = blend::Source::with_frames(Arc::clone(&motion.clip), &motion.roles, motion.ground_frames.clone());
        let path = FittedPath::new(Arc::new(source), &options).map_err(|error| error.to_string())?;
        let off = path.residuals().map(|residual| residual.shift.length() * 100.0);
        Ok(Self {
            motion: Arc::clone(motion),
            options,
            road: Arc::new(path.road().clone()),
            error: path.error(),
            errors_cm: path.places().iter().map(|place| place.along_m).zip(off).map(Into::into).collect(),
            editor: PathEditor::new(path, &motion.roles, motion.contacts.clone()),
        })
    }

    /// The motion as it came.
    #[must_use]
    pub fn motion(&self) -> &Arc<Motion> {
        &self.motion
    }

    /// The fitted path.
    #[must_use]
    pub fn road(&self) -> &Arc<Road> {
        &self.road
    }

    /// For every frame of the motion the place on the fitted path that it rides in.
    #[must_use]
    pub fn places(&self) -> &[Waypoint] {
        self.editor.path().places()
    }

    /// How far the hips are from the path.
    #[must_use]
    pub fn error(&self) -> FitError {
        self.error
    }

    /// Likewise frame by frame: metres along the path, and centimetres away from it.
    #[must_use]
    pub fn errors_cm(&self) -> &[[f64; 2]] {
        &self.errors_cm
    }
}

/// What is known of a motion on an edited path.
#[derive(Clone, Debug)]
pub struct OnPath {
    /// The motion before it was edited.
    pub fitted: Arc<FittedMotion>,
    /// The path that it goes on now.
    pub road: Arc<Road>,
    /// Whether that is another one than was fitted.
    pub is_edited: bool,
    /// For every frame of the result the place on the path that it rides in.
    pub places: Vec<Waypoint>,
    /// Where the path turns faster than the motion can.
    pub hard_turns: Vec<HardTurn>,
}

/// What a motion on a path depends on. Equal inputs, equal result.
#[derive(Clone, Debug)]
pub(in crate::session) struct PathInputs {
    fitted: Arc<FittedMotion>,
    /// The word of the edited path; empty for the fitted one.
    code: String,
    options: MotionOptions,
}

impl PartialEq for PathInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.fitted, &other.fitted) && self.code == other.code && self.options == other.options
    }
}

/// Fits paths, and keeps the last ones: a hand that drags a point changes none of them.
#[derive(Debug, Default)]
pub(in crate::session) struct Paths(Vec<Arc<FittedMotion>>);

impl Paths {
    /// What the parameters ask for, of this clip.
    pub(in crate::session) fn inputs(&mut self, motion: &Arc<Motion>, params: &Params) -> Result<PathInputs, String> {
        let options = FitOptions {
            control_points: params.number(Key::ControlPoints) as usize,
            smoothing: params.number(Key::PathSmoothing),
            pin_ends: false,
        };
        Ok(PathInputs {
            fitted: self.fitted(motion, options)?,
            code: params.text(Key::Path).to_owned(),
            options: motion_options(params),
        })
    }

    fn fitted(&mut self, motion: &Arc<Motion>, options: FitOptions) -> Result<Arc<FittedMotion>, String> {
        let is_it = |known: &&Arc<FittedMotion>| Arc::ptr_eq(&known.motion, motion) && known.options == options;
        if let Some(known) = self.0.iter().find(is_it) {
            return Ok(Arc::clone(known));
        }
        let fitted = Arc::new(FittedMotion::new(motion, options)?);
        if self.0.len() >= MAX_PANES {
            self.0.remove(0);
        }
        self.0.push(Arc::clone(&fitted));
        Ok(fitted)
    }
}

fn motion_options(params: &Params) -> MotionOptions {
    MotionOptions {
        carry: CarryOptions {
            timing: match params.text(Key::PathKeep) {
                "duration" => Timing::Duration,
                "whole" => Timing::Speed,
                _ => Timing::Metres,
            },
            orientation: match params.text(Key::PathFacing) {
                "world" => Orientation::World,
                _ => Orientation::Path,
            },
        },
        foot_lock: params.is_on(Key::FootLock).then(FootLockOptions::default),
    }
}

impl PathInputs {
    /// The motion on the path.
    pub(in crate::session) fn run(&self) -> Result<Outcome, String> {
        let fitted = &self.fitted;
        let road = if self.code.is_empty() {
            Arc::clone(&fitted.road)
        } else {
            let spline = GroundSpline::from_code(&self.code);
            Arc::new(spline.and_then(Road::new).map_err(|error| error.to_string())?)
        };
        let made = fitted.editor.motion(&road, &self.options).map_err(|error| error.to_string())?;
        let slide = |id, label, value, better, help| Metric {
            id,
            label,
            value,
            unit: "cm",
            better,
            help,
        };
        let mut metrics = vec![
            fact(
                "fit_rms_cm",
                "Fit error",
                fitted.error.rms_cm,
                "cm",
                "How far the hips are from the fitted path: the root of the mean squared distance. It is carried along, not lost.",
            ),
            fact(
                "fit_most_cm",
                "Largest fit error",
                fitted.error.most_cm,
                "cm",
                "The same where it is largest.",
            ),
            fact(
                "path_m",
                "Length of the path",
                road.length_m(),
                "m",
                "The edited path from its start to its end.",
            ),
            slide(
                "skate_cm",
                "Foot slide",
                made.slide_cm.locked,
                Better::Lower,
                "How far a planted foot slides in the worst stance.",
            ),
            slide(
                "skate_original_cm",
                "Foot slide of the original",
                made.slide_cm.original,
                Better::Neutral,
                "How far a planted foot slides in the worst stance before the path was edited.",
            ),
        ];
        if self.options.foot_lock.is_some() {
            metrics.push(slide(
                "skate_before_cm",
                "Foot slide before the lock",
                made.slide_cm.carried,
                Better::Neutral,
                "How far a planted foot slides in the worst stance without the foot lock.",
            ));
        }
        if !self.code.is_empty() {
            metrics.push(fact(
                "path_original_m",
                "Length of the original path",
                fitted.road.length_m(),
                "m",
                "The fitted path from its start to its end.",
            ));
        }
        metrics.push(Metric {
            better: Better::Lower,
            ..fact(
                "hard_turns",
                "Hard turns",
                made.hard_turns.len() as f64,
                "bends",
                "Places where curvature times speed is beyond what the original does.",
            )
        });
        let motion = Motion {
            clip: Arc::new(made.clip),
            roles: fitted.motion.roles.clone(),
            contacts: made.contacts,
            ground_frames: made.characters,
        };
        Ok(Outcome {
            sources: vec![Source {
                slot: Slot::A,
                motion: Arc::clone(&fitted.motion),
                starts_at_secs: 0.0,
                world_from_clip: Planar::IDENTITY,
            }],
            path: Some(Arc::new(OnPath {
                fitted: Arc::clone(fitted),
                road,
                is_edited: !self.code.is_empty(),
                places: made.places,
                hard_turns: made.hard_turns,
            })),
            metrics,
            ..Outcome::plain(Arc::new(motion))
        })
    }
}
