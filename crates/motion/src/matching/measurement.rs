//! Measurement of one clip of a database, in slices.

use super::MatchError;
use super::cycle;
use super::database::DatabaseOptions;
use super::features::{Layout, RATE};
use super::motion::{DatabaseClip, FeatureJoints};
use super::tags::{TagRange, suggest_tags};
use crate::clip::{
    Clip, ContactCorrections, ContactOptions, Contacts, Interpolation, Motion, RetargetError,
    mirror, resample,
};
use crate::math::Planar;
use crate::registration::REFERENCE_HEIGHT_M;
use crate::retarget::{MotionRetargeting, RetargetErrors, TargetBody};
use crate::skeleton::Roles;
use crate::transition::repeat_clip;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Number of frames that are retargeted in one slice, in one of several passes.
const FRAMES_PER_RETARGET: usize = 1_000;

/// The measurement of one clip of a database in slices: a pure function of that clip, of the body
/// of the first one, and of the options. Clips of a database can so be measured anywhere and in any
/// order.
///
/// The clip is retargeted to the first clip's skeleton, resampled to [`RATE`] frames per second,
/// measured, and mirrored; one of these steps is a slice. A clip that is a cycle is closed
/// ([`DatabaseOptions::cycles`]). Any other clip that is too short for its trajectory features has
/// no motion.
#[derive(Debug)]
pub struct ClipMeasurement {
    from: Arc<Motion>,
    first: Arc<Motion>,
    source: usize,
    options: DatabaseOptions,
    horizon: usize,
    stage: Stage,
}

/// The motions that a database has of one clip.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredClip {
    /// The motion and its mirror image, if that was requested; none for a clip that is too short.
    pub motions: Vec<DatabaseClip>,
    /// The errors that remain on the first clip's body; `None` for a clip of the same rig.
    pub retargeted: Option<RetargetErrors>,
}

#[derive(Debug)]
enum Stage {
    Prepare,
    Retarget(Box<MotionRetargeting>),
    Measure(PreparedClip, Option<RetargetErrors>),
    Mirror(MeasuredClip),
    MeasureMirrored(PreparedClip, MeasuredClip),
    Complete(MeasuredClip),
}

/// A clip at the database's rate; for a cycle one repetition, and its transform.
#[derive(Clone, Debug)]
struct PreparedClip {
    clip: Arc<Clip>,
    cycle: Option<Planar>,
    /// The corrections of its contacts by hand.
    corrections: ContactCorrections,
}

impl PreparedClip {
    /// Returns the contacts of the feet, as corrected.
    fn contacts(&self, roles: &Roles) -> Result<Contacts, MatchError> {
        Ok(self.corrections.applied_to(&self.detected_contacts(roles)?))
    }

    /// Returns the contacts that are detected; for a cycle those of a repetition between others,
    /// where no stance is cut off.
    fn detected_contacts(&self, roles: &Roles) -> Result<Contacts, MatchError> {
        let detect = |clip: &Clip| Contacts::detect(clip, roles, &ContactOptions::default());
        let Some(cycle) = &self.cycle else {
            return Ok(detect(&self.clip));
        };
        let frames = self.clip.frames();
        let three = detect(&repeat_clip(&self.clip, cycle, 3)?);
        Ok(three.of_frames(&(frames..2 * frames).collect::<Vec<usize>>()))
    }
}

impl ClipMeasurement {
    /// Begins the measurement of a clip, the one with number `source` in its database. `first` is
    /// the database's first clip; for a clip on its skeleton, only its roles are read.
    ///
    /// # Errors
    /// [`MatchError::Times`], [`MatchError::NoFeet`] for the first clip.
    pub fn new(
        from: Arc<Motion>,
        first: Arc<Motion>,
        source: usize,
        options: &DatabaseOptions,
    ) -> Result<Self, MatchError> {
        FeatureJoints::find(first.clip(), first.roles())?;
        let horizon = Layout::new(&options.features)?.horizon();
        Ok(Self { from, first, source, options: options.clone(), horizon, stage: Stage::Prepare })
    }

    /// Returns the number of the clip in its database.
    pub(super) fn source(&self) -> usize {
        self.source
    }

    /// Returns the number of steps that are done, of four.
    pub(super) fn steps_done(&self) -> usize {
        match &self.stage {
            Stage::Prepare | Stage::Retarget(_) => 0,
            Stage::Measure(..) => 1,
            Stage::Mirror(_) => 2,
            Stage::MeasureMirrored(..) => 3,
            Stage::Complete(_) => 4,
        }
    }

    /// Processes one slice. Returns the measured clip after the last one.
    ///
    /// # Errors
    /// [`MatchError`] when the clip cannot be retargeted to the first one's skeleton or mirrored,
    /// or has values that are not finite.
    pub fn advance(mut self) -> Result<ControlFlow<MeasuredClip, Self>, MatchError> {
        self.stage = match std::mem::replace(&mut self.stage, Stage::Prepare) {
            Stage::Prepare if self.from.clip().skeleton() == self.first.clip().skeleton() => {
                self.prepared(Arc::clone(self.from.clip()), None)?
            }
            Stage::Prepare => {
                let (from, body) = (Arc::clone(&self.from), TargetBody::of(&self.first));
                let begun = MotionRetargeting::new(from, body, self.options.retarget);
                Stage::Retarget(Box::new(begun.map_err(|error| not_put_on(&self.from, error))?))
            }
            Stage::Retarget(retargeting) => {
                let next = retargeting.advance(FRAMES_PER_RETARGET);
                match next.map_err(|error| not_put_on(&self.from, error))? {
                    ControlFlow::Continue(rest) => Stage::Retarget(Box::new(rest)),
                    ControlFlow::Break(made) => {
                        let errors = (!made.is_same_rig).then_some(made.report);
                        self.prepared(Arc::new(made.clip), errors.as_ref())?
                    }
                }
            }
            Stage::Measure(prepared, retargeted) => {
                let roles = self.first.roles();
                let contacts = prepared.contacts(roles)?;
                let PreparedClip { clip, cycle, .. } = prepared;
                let motion = DatabaseClip::new(clip, cycle, roles, contacts, self.source, false)?;
                let tags = tags_of(&motion, &self.first);
                let measured = MeasuredClip { motions: vec![motion.with_tags(tags)], retargeted };
                if self.options.mirrored {
                    Stage::Mirror(measured)
                } else {
                    Stage::Complete(measured)
                }
            }
            Stage::Mirror(measured) => match measured.motions.first() {
                Some(motion) => {
                    let clip = mirror(motion.clip(), self.first.roles()).map_err(|error| {
                        MatchError::Mirror { name: motion.clip().name().to_owned(), error }
                    })?;
                    let prepared = PreparedClip {
                        clip: Arc::new(clip),
                        cycle: motion.cycle().map(|cycle| cycle.mirrored()),
                        // The contacts of the original are mirrored.
                        corrections: ContactCorrections::default(),
                    };
                    Stage::MeasureMirrored(prepared, measured)
                }
                None => Stage::Complete(measured),
            },
            Stage::MeasureMirrored(PreparedClip { clip, cycle, .. }, mut measured) => {
                if let Some(original) = measured.motions.first() {
                    let contacts = original.contacts().mirrored();
                    let roles = self.first.roles();
                    let tags = original.tags().to_vec();
                    let motion =
                        DatabaseClip::new(clip, cycle, roles, contacts, self.source, true)?;
                    measured.motions.push(motion.with_tags(tags));
                }
                Stage::Complete(measured)
            }
            complete @ Stage::Complete(_) => complete,
        };
        Ok(match self.stage {
            Stage::Complete(measured) => ControlFlow::Break(measured),
            _ => ControlFlow::Continue(self),
        })
    }

    /// Processes the remaining slices and returns the measured clip.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn finish(mut self) -> Result<MeasuredClip, MatchError> {
        loop {
            match self.advance()? {
                ControlFlow::Continue(rest) => self = rest,
                ControlFlow::Break(measured) => return Ok(measured),
            }
        }
    }

    /// Returns the stage after the clip is on the first one's skeleton.
    fn prepared(
        &self,
        clip: Arc<Clip>,
        retargeted: Option<&RetargetErrors>,
    ) -> Result<Stage, MatchError> {
        let prepared = self.at_rate(clip)?;
        if prepared.cycle.is_some() || prepared.clip.frames() > self.horizon {
            return Ok(Stage::Measure(prepared, retargeted.copied()));
        }
        Ok(Stage::Complete(MeasuredClip { motions: Vec::new(), retargeted: retargeted.copied() }))
    }

    /// Returns a clip, which is on the first one's skeleton, at the database's rate.
    fn at_rate(&self, mut clip: Arc<Clip>) -> Result<PreparedClip, MatchError> {
        let (roles, corrections) = (self.first.roles(), self.from.contact_corrections());
        if self.options.cycles
            && let Some(looped) = cycle::closed(&clip, roles, corrections, self.from.is_cycle())
            && let Some((clip, cycle)) = cycle::at_rate(&looped)
        {
            let ratio = clip.frames() as f64 / looped.clip.frames().max(1) as f64;
            let corrections = corrections.at_rate(ratio);
            return Ok(PreparedClip { clip: Arc::new(clip), cycle: Some(cycle), corrections });
        }
        let corrections = corrections.at_rate(RATE as f64 / clip.fps());
        if clip.fps() != RATE as f64 {
            clip = Arc::new(resample(&clip, RATE as f64, Interpolation::Cubic)?);
        }
        Ok(PreparedClip { clip, cycle: None, corrections })
    }
}

fn not_put_on(from: &Motion, error: RetargetError) -> MatchError {
    MatchError::Retarget { name: from.clip().name().to_owned(), error }
}

fn tags_of(motion: &DatabaseClip, first: &Motion) -> Vec<TagRange> {
    let height_m = f64::from(first.roles().body_height(first.clip().skeleton()));
    suggest_tags(motion.roots(), RATE as f64, height_m / REFERENCE_HEIGHT_M)
}
