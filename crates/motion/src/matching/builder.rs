//! Construction of databases in slices.

use super::database::{Database, DatabaseOptions, spread_all};
use super::features::{Features, Layout, Normaliser, RATE};
use super::measurement::{ClipMeasurement, MeasuredClip};
use super::motion::{DatabaseClip, FeatureJoints};
use super::pace::Pace;
use super::search::{BoxBuilder, BoxIndex};
use super::{MatchError, Weights};
use crate::blend::moving_joints_of;
use crate::clip::Motion;
use crate::registration::Progress;
use crate::retarget::RetargetErrors;
use crate::skeleton::{Roles, Skeleton};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The greatest number of frames of a database: features of 27 dimensions then take half a
/// gigabyte.
const MAX_FRAMES: usize = 2_000_000;
/// Number of frames whose features are gathered in one slice.
const FRAMES_PER_GATHER: usize = 10_000;
/// Number of frames whose features are normalised in one slice, in one of three passes.
const FRAMES_PER_PASS: usize = 40_000;
/// Number of frames that are sorted into boxes, or packed in them, in one slice.
const FRAMES_PER_SORT: usize = 40_000;

/// The construction of a [`Database`] in slices: call [`advance`](Self::advance) until it is
/// complete, then [`finish`](Self::finish).
///
/// Each clip is measured ([`ClipMeasurement`]), in slices here, or elsewhere
/// ([`set_measured`](Self::set_measured)). Then features are normalised and frames sorted into
/// boxes, in the order of the clips, in whichever order they were measured. A clip that is a cycle
/// repeats ([`DatabaseOptions::cycles`]). Any other clip that is too short for its trajectory
/// features is left out and named in [`Database::skipped`].
#[derive(Debug)]
pub struct DatabaseBuilder {
    clips: Vec<Arc<Motion>>,
    options: DatabaseOptions,
    layout: Layout,
    skeleton: Arc<Skeleton>,
    roles: Roles,
    /// The motions of each clip, as far as they are measured; empty for a database of known ones.
    measured: Vec<Option<MeasuredClip>>,
    motions: Vec<Arc<DatabaseClip>>,
    skipped: Vec<MatchError>,
    retargeted: Vec<(String, RetargetErrors)>,
    longest_secs: f64,
    stage: Stage,
}

#[derive(Debug)]
enum Stage {
    /// Clips are measured; with the one whose measurement is under way.
    Measure(Option<Box<ClipMeasurement>>),
    Gather(GatheredFeatures),
    Normalise(Normalising),
    Sort(BoxSorting),
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

    /// Gathers up to `count` more frames of the motion that comes next. Returns their number.
    fn push(&mut self, motion: &DatabaseClip, layout: &Layout, count: usize) -> usize {
        let (dims, begin) = (layout.dims(), self.rows.len());
        let start = self.starts.last().copied().unwrap_or(0);
        let from = begin / dims - start;
        let count = (motion.frames() - from).min(count);
        self.rows.resize(begin + count * dims, 0.0);
        for (frame, row) in (from..).zip(self.rows[begin..].chunks_exact_mut(dims)) {
            motion.write_row(layout, frame, row);
        }
        if from + count == motion.frames() {
            self.valid.extend((start..start + motion.valid(layout)).map(|frame| frame as u32));
            self.starts.push(start + motion.frames());
        }
        count
    }
}

#[derive(Clone, Debug)]
struct Normalising {
    starts: Vec<usize>,
    valid: Arc<Vec<u32>>,
    normaliser: Normaliser,
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
        let measured = clips.iter().map(|_| None).collect();
        Ok(Self {
            clips,
            options: options.clone(),
            layout,
            skeleton,
            roles,
            measured,
            motions: Vec::new(),
            skipped: Vec::new(),
            retargeted: Vec::new(),
            longest_secs,
            stage: Stage::Measure(None),
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
            measured: Vec::new(),
            motions: database.motions.clone(),
            skipped: database.skipped.clone(),
            retargeted: database.retargeted.clone(),
            longest_secs: longest,
            stage: Stage::Gather(GatheredFeatures::new()),
        })
    }

    /// Returns the first clip that is not measured, by its number; `None` once all are.
    #[must_use]
    pub fn next_clip(&self) -> Option<usize> {
        self.measured.iter().position(Option::is_none)
    }

    /// Returns all clips that are not measured, by their numbers.
    pub fn unmeasured(&self) -> impl Iterator<Item = usize> {
        self.measured.iter().enumerate().filter(|(_, known)| known.is_none()).map(|(clip, _)| clip)
    }

    /// Takes in a clip that was measured elsewhere. Clips may arrive in any order; one that is
    /// already there, or none of this database, is ignored.
    pub fn set_measured(&mut self, clip: usize, measured: MeasuredClip) {
        if let Some(place @ None) = self.measured.get_mut(clip) {
            *place = Some(measured);
        }
    }

    /// Returns the progress, of 1000.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let done = match &self.stage {
            Stage::Measure(under_way) => {
                let steps = under_way.as_ref().map_or(0, |measurement| measurement.steps_done());
                let clips = self.measured.iter().flatten().count();
                (4 * clips + steps) * CLIPS_SHARE / (4 * self.clips.len()).max(1)
            }
            Stage::Gather(gathering) => {
                CLIPS_SHARE + GATHER_SHARE * gathering.motions() / self.motions.len().max(1)
            }
            Stage::Normalise(_) => CLIPS_SHARE + GATHER_SHARE,
            Stage::Sort(sorting) => {
                let Progress { done, total } = sorting.progress;
                let left = 950 - CLIPS_SHARE - GATHER_SHARE;
                // The product may exceed 32 bits.
                let sorted = left as u64 * done as u64 / total.max(1) as u64;
                CLIPS_SHARE + GATHER_SHARE + 50 + sorted as usize
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
        match std::mem::replace(&mut self.stage, Stage::Measure(None)) {
            Stage::Measure(under_way) => {
                let next = self.next_clip();
                let next = next.and_then(|next| Some((next, self.clips.get(next)?)));
                if let Some((next, from)) = next {
                    let under_way = under_way.filter(|one| one.source() == next);
                    let measurement = if let Some(measurement) = under_way {
                        *measurement
                    } else {
                        let first = Arc::clone(self.clips.first().unwrap_or(from));
                        ClipMeasurement::new(Arc::clone(from), first, next, &self.options)?
                    };
                    match measurement.advance()? {
                        ControlFlow::Continue(rest) => {
                            self.stage = Stage::Measure(Some(Box::new(rest)));
                        }
                        ControlFlow::Break(measured) => self.set_measured(next, measured),
                    }
                } else {
                    self.join_measured();
                    self.stage = Stage::Gather(GatheredFeatures::new());
                }
            }
            Stage::Gather(mut gathering) => {
                let mut left = FRAMES_PER_GATHER;
                while left > 0
                    && let Some(motion) = self.motions.get(gathering.motions())
                {
                    left -= gathering.push(motion, &self.layout, left);
                }
                self.stage = if gathering.motions() < self.motions.len() {
                    Stage::Gather(gathering)
                } else {
                    Stage::Normalise(self.normalising(gathering)?)
                };
            }
            Stage::Normalise(mut normalising) => {
                self.stage = if normalising.normaliser.advance(FRAMES_PER_PASS) {
                    Stage::Normalise(normalising)
                } else {
                    Stage::Sort(self.sorting(normalising))
                };
            }
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

    /// Lists the motions of all clips in their order, with the clips that have none.
    fn join_measured(&mut self) {
        for (from, measured) in self.clips.iter().zip(std::mem::take(&mut self.measured)) {
            let Some(MeasuredClip { motions, retargeted }) = measured else { continue };
            let clip = from.clip();
            if let Some(errors) = retargeted {
                self.retargeted.push((clip.name().to_owned(), errors));
            }
            if motions.is_empty() {
                self.skipped.push(MatchError::TooShort {
                    name: clip.name().to_owned(),
                    secs: clip.duration_secs(),
                    horizon_secs: self.layout.horizon() as f64 / RATE as f64,
                });
            }
            self.motions.extend(motions.into_iter().map(Arc::new));
        }
    }

    fn normalising(&self, gathering: GatheredFeatures) -> Result<Normalising, MatchError> {
        let GatheredFeatures { starts, valid, rows } = gathering;
        if valid.is_empty() {
            return Err(MatchError::NoValidFrame {
                clips: self.clips.len().max(self.motions.len()),
                longest_secs: self.longest_secs,
                horizon_secs: self.layout.horizon() as f64 / RATE as f64,
            });
        }
        let (layout, valid) = (self.layout.clone(), Arc::new(valid));
        let normalisation = self.options.features.normalisation;
        let normaliser = Normaliser::new(layout, normalisation, rows, Arc::clone(&valid));
        Ok(Normalising { starts, valid, normaliser })
    }

    fn sorting(&self, Normalising { starts, valid, normaliser }: Normalising) -> BoxSorting {
        BoxSorting {
            starts,
            features: Arc::new(normaliser.finish()),
            boxes: BoxBuilder::new(&valid, &Weights::default().spread(&self.layout)),
            valid,
            progress: Progress { done: 0, total: 1 },
        }
    }
}
