//! Construction of databases in slices.

use super::cycle;
use super::database::{Database, DatabaseOptions, spread_all};
use super::features::{Features, Layout, RATE};
use super::motion::{DatabaseClip, FeatureJoints};
use super::pace::Pace;
use super::search::{BoxBuilder, BoxIndex};
use super::tags::{TagRange, suggest_tags};
use super::{MatchError, Weights};
use crate::blend::moving_joints_of;
use crate::clip::{
    Clip, ContactCorrections, ContactOptions, Contacts, Interpolation, Motion, RetargetError,
    mirror, resample,
};
use crate::math::Planar;
use crate::registration::{Progress, REFERENCE_HEIGHT_M};
use crate::retarget::{MotionRetargeting, RetargetErrors, TargetBody};
use crate::skeleton::{Roles, Side, Skeleton};
use crate::transition::repeat_clip;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The greatest number of frames of a database: features of 27 dimensions then take half a
/// gigabyte.
const MAX_FRAMES: usize = 2_000_000;
/// Number of frames that are retargeted in one slice, in one of several passes.
const FRAMES_PER_RETARGET: usize = 1_000;
/// Number of frames whose features are gathered in one slice.
const FRAMES_PER_GATHER: usize = 3_000;
/// Number of frames that are sorted into boxes in one slice.
const FRAMES_PER_SORT: usize = 100_000;

/// The construction of a [`Database`] in slices: call [`advance`](Self::advance) until it is
/// complete, then [`finish`](Self::finish).
///
/// Each clip is retargeted to the first clip's skeleton, resampled to [`RATE`] frames per second,
/// measured, and mirrored; one of these steps for one clip is a slice. Then features are normalised
/// and frames sorted into boxes. A clip that is a cycle is closed and repeats
/// ([`DatabaseOptions::cycles`]). Any other clip that is too short for its trajectory features is
/// left out and named in [`Database::skipped`].
#[derive(Debug)]
pub struct DatabaseBuilder {
    clips: Vec<Arc<Motion>>,
    options: DatabaseOptions,
    layout: Layout,
    skeleton: Arc<Skeleton>,
    roles: Roles,
    motions: Vec<Arc<DatabaseClip>>,
    skipped: Vec<MatchError>,
    retargeted: Vec<(String, RetargetErrors)>,
    longest_secs: f64,
    /// The next clip, and its stage.
    next: usize,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    Prepare,
    Retarget(Box<MotionRetargeting>),
    Measure(PreparedClip),
    Mirror,
    MeasureMirrored(PreparedClip),
    Gather(GatheredFeatures),
    Normalise(GatheredFeatures),
    Sort(BoxSorting),
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
        Ok(Contacts::from_flags(
            Side::BOTH
                .map(|side| (frames..2 * frames).map(|frame| three.planted(side, frame)).collect()),
        ))
    }
}

/// The features of all motions, one after the other.
#[derive(Clone, Debug)]
struct GatheredFeatures {
    starts: Vec<usize>,
    valid: Vec<u32>,
    rows: Vec<f32>,
}

impl GatheredFeatures {
    fn new() -> Self {
        Self { starts: vec![0], valid: Vec::new(), rows: Vec::new() }
    }

    /// Returns the number of motions that are gathered.
    fn motions(&self) -> usize {
        self.starts.len() - 1
    }

    fn push(&mut self, motion: &DatabaseClip, layout: &Layout) {
        let start = self.starts.last().copied().unwrap_or(0);
        self.valid.extend((start..start + motion.valid(layout)).map(|frame| frame as u32));
        let begin = self.rows.len();
        self.rows.resize(begin + motion.frames() * layout.dims(), 0.0);
        for (frame, row) in self.rows[begin..].chunks_exact_mut(layout.dims()).enumerate() {
            motion.write_row(layout, frame, row);
        }
        self.starts.push(start + motion.frames());
    }
}

#[derive(Clone, Debug)]
struct BoxSorting {
    starts: Vec<usize>,
    features: Arc<Features>,
    valid: Arc<Vec<u32>>,
    boxes: BoxBuilder,
    progress: Progress,
}

/// The share of the progress that belongs to the preparation of clips, of 1000.
const CLIPS_SHARE: usize = 700;
/// The share of the progress that belongs to the gathering of features, of 1000.
const GATHER_SHARE: usize = 100;

impl DatabaseBuilder {
    /// Begins the construction, and checks the clips and options as far as possible beforehand.
    ///
    /// # Errors
    /// [`MatchError::NoClips`], [`MatchError::Times`], [`MatchError::TooManyFrames`],
    /// [`MatchError::NoFeet`] for the first clip.
    pub fn new(clips: Vec<Arc<Motion>>, options: &DatabaseOptions) -> Result<Self, MatchError> {
        let layout = Layout::new(&options.features)?;
        let first = clips.first().ok_or(MatchError::NoClips)?;
        FeatureJoints::find(first.clip(), first.roles())?;
        let (skeleton, roles) = (Arc::clone(first.clip().skeleton()), first.roles().clone());
        let copies = if options.mirrored { 2.0 } else { 1.0 };
        let frames: f64 =
            clips.iter().map(|clip| clip.clip().duration_secs() * RATE as f64 * copies).sum();
        if frames > MAX_FRAMES as f64 {
            return Err(MatchError::TooManyFrames { frames: frames as usize, most: MAX_FRAMES });
        }
        let longest_secs = clips.iter().map(|clip| clip.clip().duration_secs()).fold(0.0, f64::max);
        Ok(Self {
            clips,
            options: options.clone(),
            layout,
            skeleton,
            roles,
            motions: Vec::new(),
            skipped: Vec::new(),
            retargeted: Vec::new(),
            longest_secs,
            next: 0,
            stage: Stage::Prepare,
        })
    }

    /// Begins the construction of a database of the same clips with other features: only
    /// trajectories are measured again.
    ///
    /// # Errors
    /// [`MatchError::Times`].
    pub fn retimed(
        database: &Database,
        features: &super::FeatureOptions,
    ) -> Result<Self, MatchError> {
        let longest =
            database.motions.iter().map(|motion| motion.clip().duration_secs()).fold(0.0, f64::max);
        Ok(Self {
            clips: Vec::new(),
            options: DatabaseOptions { features: features.clone(), ..database.options.clone() },
            layout: Layout::new(features)?,
            skeleton: Arc::clone(&database.skeleton),
            roles: database.roles.clone(),
            motions: database.motions.clone(),
            skipped: database.skipped.clone(),
            retargeted: database.retargeted.clone(),
            longest_secs: longest,
            next: 0,
            stage: Stage::Gather(GatheredFeatures::new()),
        })
    }

    /// Returns the progress, of 1000.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let of_clip =
            |part: usize| (4 * self.next + part) * CLIPS_SHARE / (4 * self.clips.len()).max(1);
        let done = match &self.stage {
            Stage::Prepare | Stage::Retarget(_) => of_clip(0),
            Stage::Measure(_) => of_clip(1),
            Stage::Mirror => of_clip(2),
            Stage::MeasureMirrored(_) => of_clip(3),
            Stage::Gather(gathering) => {
                CLIPS_SHARE + GATHER_SHARE * gathering.motions() / self.motions.len().max(1)
            }
            Stage::Normalise(_) => CLIPS_SHARE + GATHER_SHARE,
            Stage::Sort(sorting) => {
                let Progress { done, total } = sorting.progress;
                CLIPS_SHARE
                    + GATHER_SHARE
                    + 50
                    + (950 - CLIPS_SHARE - GATHER_SHARE) * done / total.max(1)
            }
        };
        Progress { done, total: 1_000 }
    }

    /// Processes one slice.
    ///
    /// # Errors
    /// [`MatchError`] when a clip cannot be retargeted to the first one's skeleton or mirrored, has
    /// no feet there or values that are not finite, or no clip has a frame that can be searched.
    pub fn advance(&mut self) -> Result<Progress, MatchError> {
        match std::mem::replace(&mut self.stage, Stage::Prepare) {
            Stage::Prepare => match self.clips.get(self.next) {
                Some(from) if *from.clip().skeleton() == self.skeleton => {
                    self.stage = self.measure_next(Arc::clone(from.clip()))?;
                }
                Some(from) => {
                    let first = self.clips.first().unwrap_or(from);
                    let (body, options) = (TargetBody::of(first), self.options.retarget);
                    let begun = MotionRetargeting::new(Arc::clone(from), body, options);
                    let begun = begun.map_err(|error| self.not_retargeted(error))?;
                    self.stage = Stage::Retarget(Box::new(begun));
                }
                None => self.stage = Stage::Gather(GatheredFeatures::new()),
            },
            Stage::Retarget(retargeting) => {
                let next = retargeting.advance(FRAMES_PER_RETARGET);
                self.stage = match next.map_err(|error| self.not_retargeted(error))? {
                    ControlFlow::Continue(rest) => Stage::Retarget(Box::new(rest)),
                    ControlFlow::Break(made) => {
                        if let Some(from) = self.clips.get(self.next).filter(|_| !made.is_same_rig)
                        {
                            self.retargeted.push((from.clip().name().to_owned(), made.report));
                        }
                        self.measure_next(Arc::new(made.clip))?
                    }
                };
            }
            Stage::Measure(round) => {
                let contacts = round.contacts(&self.roles)?;
                let mut motion = DatabaseClip::new(
                    round.clip,
                    round.cycle,
                    &self.roles,
                    contacts,
                    self.next,
                    false,
                )?;
                motion.tags = self.tags_of(&motion);
                self.motions.push(Arc::new(motion));
                self.stage = if self.options.mirrored { Stage::Mirror } else { self.next_clip() };
            }
            Stage::Mirror => {
                self.stage = match self.motions.last() {
                    Some(motion) => {
                        let clip = mirror(motion.clip(), &self.roles).map_err(|error| {
                            MatchError::Mirror { name: motion.clip().name().to_owned(), error }
                        })?;
                        Stage::MeasureMirrored(PreparedClip {
                            clip: Arc::new(clip),
                            cycle: motion.cycle().map(|cycle| cycle.mirrored()),
                            // The contacts of the original are mirrored.
                            corrections: ContactCorrections::default(),
                        })
                    }
                    None => self.next_clip(),
                };
            }
            Stage::MeasureMirrored(round) => {
                if let Some(original) = self.motions.last() {
                    let contacts = original.contacts().mirrored();
                    let mut motion = DatabaseClip::new(
                        round.clip,
                        round.cycle,
                        &self.roles,
                        contacts,
                        self.next,
                        true,
                    )?;
                    motion.tags.clone_from(&original.tags);
                    self.motions.push(Arc::new(motion));
                }
                self.stage = self.next_clip();
            }
            Stage::Gather(mut gathering) => {
                let until = gathering.rows.len() + FRAMES_PER_GATHER * self.layout.dims();
                while gathering.rows.len() < until
                    && let Some(motion) = self.motions.get(gathering.motions())
                {
                    gathering.push(motion, &self.layout);
                }
                self.stage = if gathering.motions() < self.motions.len() {
                    Stage::Gather(gathering)
                } else {
                    Stage::Normalise(gathering)
                };
            }
            Stage::Normalise(gathering) => self.stage = Stage::Sort(self.normalised(gathering)?),
            Stage::Sort(mut sorting) => {
                sorting.progress = sorting.boxes.advance(&sorting.features, FRAMES_PER_SORT);
                self.stage = Stage::Sort(sorting);
            }
        }
        Ok(self.progress())
    }

    /// Processes the remaining slices and returns the database.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn finish(mut self) -> Result<Database, MatchError> {
        loop {
            match self.stage {
                Stage::Sort(sorting) if sorting.progress.is_complete() => {
                    let index: BoxIndex = sorting.boxes.finish(&sorting.features);
                    let tags = spread_all(&self.motions);
                    return Ok(Database {
                        options: self.options,
                        skeleton: self.skeleton,
                        roles: self.roles,
                        masks: index.masks(&tags),
                        index: Arc::new(index),
                        moving: moving_joints_of(
                            self.motions.iter().map(|motion| &**motion.clip()),
                        ),
                        pace: Pace::of_all(self.motions.iter().map(|motion| motion.pace())),
                        motions: self.motions,
                        starts: sorting.starts,
                        features: sorting.features,
                        valid: sorting.valid,
                        tags,
                        skipped: self.skipped,
                        retargeted: self.retargeted,
                    });
                }
                _ => {
                    self.advance()?;
                }
            }
        }
    }

    fn next_clip(&mut self) -> Stage {
        self.next += 1;
        Stage::Prepare
    }

    fn not_retargeted(&self, error: RetargetError) -> MatchError {
        let clip = self.clips.get(self.next).map(|from| from.clip().name().to_owned());
        MatchError::Retarget { name: clip.unwrap_or_default(), error }
    }

    /// Returns the stage after the next clip is on the first one's skeleton.
    fn measure_next(&mut self, clip: Arc<Clip>) -> Result<Stage, MatchError> {
        let Some(from) = self.clips.get(self.next) else { return Ok(Stage::Prepare) };
        let round = self.prepared(from, clip)?;
        if round.cycle.is_some() || round.clip.frames() > self.layout.horizon() {
            return Ok(Stage::Measure(round));
        }
        self.skipped.push(MatchError::TooShort {
            name: from.clip().name().to_owned(),
            secs: from.clip().duration_secs(),
            horizon_secs: self.layout.horizon() as f64 / RATE as f64,
        });
        self.next += 1;
        Ok(Stage::Prepare)
    }

    /// Returns a clip, which is on the first one's skeleton, at the database's rate.
    fn prepared(&self, from: &Motion, mut clip: Arc<Clip>) -> Result<PreparedClip, MatchError> {
        let corrections = from.contact_corrections();
        if self.options.cycles
            && let Some(looped) = cycle::closed(&clip, &self.roles, corrections, from.is_cycle())
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

    fn tags_of(&self, motion: &DatabaseClip) -> Vec<TagRange> {
        let scale = f64::from(self.roles.body_height(&self.skeleton)) / REFERENCE_HEIGHT_M;
        suggest_tags(motion.roots(), RATE as f64, scale)
    }

    fn normalised(&self, gathering: GatheredFeatures) -> Result<BoxSorting, MatchError> {
        let GatheredFeatures { starts, valid, rows } = gathering;
        let frames = starts.last().copied().unwrap_or(0);
        if valid.is_empty() {
            return Err(MatchError::NoValidFrame {
                clips: self.clips.len().max(self.motions.len()),
                longest_secs: self.longest_secs,
                horizon_secs: self.layout.horizon() as f64 / RATE as f64,
            });
        }
        let mut counts = vec![false; frames];
        for &frame in &valid {
            counts[frame as usize] = true;
        }
        let normalisation = self.options.features.normalisation;
        let features =
            Features::normalise(self.layout.clone(), normalisation, rows, |row| counts[row]);
        let boxes = BoxBuilder::new(&valid, &Weights::default().spread(&self.layout));
        Ok(BoxSorting {
            starts,
            features: Arc::new(features),
            valid: Arc::new(valid),
            boxes,
            progress: Progress { done: 0, total: 1 },
        })
    }
}
