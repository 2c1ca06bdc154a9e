use super::features::{FeatureOptions, RATE};
use super::motion::Motion;
use super::pace::Pace;
use super::search::{BoxIndex, BoxMasks, Candidates, Question};
use super::tags::{self, TagRange, TagSet};
use super::{Block, DatabaseBuilder, Features, MatchError, Weights};
use crate::clip::Clip;
use crate::math::{Planar, quat, stats};
use crate::skeleton::{Pose, Roles, Skeleton};
use std::sync::Arc;

/// A frame of one of the motions.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    serde::Serialize,
    serde::Deserialize,
)]
pub struct Place {
    /// The motion's index in its [`Database`].
    pub motion: usize,
    /// The frame of that motion.
    pub frame: usize,
}

/// A clip that a database is built from.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchClip {
    /// The clip, at any rate and on any skeleton.
    pub clip: Arc<Clip>,
    /// The roles of its joints.
    pub roles: Roles,
    /// Its tags, at its own rate; `None` takes those that speed and turn rate suggest.
    pub tags: Option<Vec<TagRange>>,
}

impl MatchClip {
    /// A clip with the tags that are suggested.
    #[must_use]
    pub fn new(clip: Arc<Clip>, roles: Roles) -> Self {
        Self { clip, roles, tags: None }
    }
}

/// How a database is built.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DatabaseOptions {
    /// What is looked at in a frame.
    pub features: FeatureOptions,
    /// Whether each clip is followed by its mirror image.
    pub mirrored: bool,
    /// Whether a clip that is a cycle, by itself or but for a rest, goes round: it is searched to
    /// its last frame and plays on behind it. Without it every clip ends.
    pub cycles: bool,
}

impl Default for DatabaseOptions {
    fn default() -> Self {
        Self { features: FeatureOptions::default(), mirrored: true, cycles: true }
    }
}

/// Clips to match: their frames one behind the other, with features, tags, and an index of boxes.
///
/// Made once ([`DatabaseBuilder`]), shared by any number of controllers. What it is made of is
/// shared too: new tags ([`Self::retagged`]) or other trajectory times
/// ([`DatabaseBuilder::retimed`]) give another database that holds the same clips.
#[derive(Clone, Debug, PartialEq)]
pub struct Database {
    pub(super) options: DatabaseOptions,
    pub(super) skeleton: Arc<Skeleton>,
    pub(super) roles: Roles,
    pub(super) motions: Vec<Arc<Motion>>,
    /// The joints other than the root that move against their parent in any of them.
    pub(super) moving: Vec<usize>,
    /// The number of each motion's first frame; behind them the number of frames.
    pub(super) starts: Vec<usize>,
    pub(super) features: Arc<Features>,
    pub(super) valid: Arc<Vec<u32>>,
    pub(super) index: Arc<BoxIndex>,
    pub(super) tags: Vec<TagSet>,
    pub(super) masks: BoxMasks,
    pub(super) skipped: Vec<MatchError>,
    pub(super) pace: Pace,
}

impl Database {
    /// Builds at once what a [`DatabaseBuilder`] builds in slices.
    ///
    /// # Errors
    /// As [`DatabaseBuilder`].
    pub fn new(clips: Vec<MatchClip>, options: &DatabaseOptions) -> Result<Self, MatchError> {
        DatabaseBuilder::new(clips, options)?.finish()
    }

    /// How it was built.
    #[must_use]
    pub fn options(&self) -> &DatabaseOptions {
        &self.options
    }

    /// The height of the ground under all motions, metres: the lowest of theirs, so that no foot is
    /// lifted off the ground that its own clip has, nor moved from one height to another by a jump.
    #[must_use]
    pub fn ground_m(&self) -> f32 {
        let heights = self.motions.iter().map(|motion| motion.ground_m());
        heights.min_by(f32::total_cmp).unwrap_or(0.0)
    }

    /// The height that the lowest point of a foot has as a rule while it is on the ground, metres:
    /// the middle one of the motions'.
    pub(super) fn stand_m(&self) -> f32 {
        let heights: Vec<f32> = self.motions.iter().map(|motion| motion.stand_m()).collect();
        stats::percentile(&heights, 0.5).unwrap_or(0.0)
    }

    /// The skeleton of all motions: the first clip's.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// The roles of its joints.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        &self.roles
    }

    /// The motions: each clip, followed by its mirror image where that was asked for.
    #[must_use]
    pub fn motions(&self) -> &[Arc<Motion>] {
        &self.motions
    }

    /// One motion.
    #[must_use]
    pub fn motion(&self, motion: usize) -> Option<&Motion> {
        self.motions.get(motion).map(|motion| &**motion)
    }

    /// Frames of all motions.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// Frames that can be found: those whose trajectory lies inside their motion, and all of a
    /// cycle.
    #[must_use]
    pub fn valid(&self) -> &[u32] {
        &self.valid
    }

    /// Clips that were left out, and why.
    #[must_use]
    pub fn skipped(&self) -> &[MatchError] {
        &self.skipped
    }

    /// How fast its motions go.
    #[must_use]
    pub fn pace(&self) -> &Pace {
        &self.pace
    }

    /// The normalised features of all frames. Those of frames that cannot be found go on behind the
    /// end of their motion as it did last.
    #[must_use]
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// The boxes.
    #[must_use]
    pub fn index(&self) -> &BoxIndex {
        &self.index
    }

    /// The boxes' tags.
    #[must_use]
    pub fn masks(&self) -> &BoxMasks {
        &self.masks
    }

    /// What a scan or a tree is made over.
    #[must_use]
    pub fn candidates(&self) -> Candidates<'_> {
        Candidates { features: &self.features, tags: &self.tags, valid: &self.valid }
    }

    /// The tags of a frame.
    #[must_use]
    pub fn tags(&self, frame: usize) -> TagSet {
        self.tags.get(frame).copied().unwrap_or_default()
    }

    /// The motion and its frame of a frame of the database.
    #[must_use]
    pub fn place(&self, frame: usize) -> Option<Place> {
        // Motions have frames, so that no two start at one number.
        let motion = self.starts.partition_point(|&start| start <= frame).checked_sub(1)?;
        (motion < self.motions.len()).then(|| Place { motion, frame: frame - self.starts[motion] })
    }

    /// The number of a motion's frame; `None` outside the motion.
    #[must_use]
    pub fn number(&self, place: Place) -> Option<usize> {
        let motion = self.motion(place.motion)?;
        (place.frame < motion.frames()).then(|| self.starts[place.motion] + place.frame)
    }

    /// Whether a frame can be found: its trajectory lies inside its motion, or that is a cycle.
    /// Tags are another matter.
    #[must_use]
    pub fn is_valid(&self, place: Place) -> bool {
        self.motion(place.motion)
            .is_some_and(|motion| place.frame < motion.valid(self.features.layout()))
    }

    /// The cost of a frame, block by block, in the order of [`Block::ALL`]. Zeros for a frame that
    /// is not there.
    #[must_use]
    pub fn split(&self, query: &[f32], weights: &Weights, frame: usize) -> [f32; Block::COUNT] {
        let Some(row) = self.features.row(frame) else {
            return [0.0; Block::COUNT];
        };
        Block::ALL.map(|block| {
            let range = self.features.layout().range(block);
            let weights = vec![weights.of(block); range.len()];
            let part = Question {
                query: query.get(range.clone()).unwrap_or(&[]),
                weights: &weights,
                filter: super::TagFilter::default(),
            };
            part.cost(&row[range])
        })
    }

    /// The pose of a frame as it looks when the character stands at `world_from_character`; `None`
    /// for a frame that is not there.
    #[must_use]
    pub fn pose(&self, place: Place, world_from_character: &Planar) -> Option<Pose> {
        let motion = self.motion(place.motion)?;
        let mut pose = (place.frame < motion.frames()).then(|| motion.clip().pose(place.frame))?;
        let world_from_clip = world_from_character.after(&motion.root(place.frame).inverse());
        pose.root_translation = world_from_clip.apply(pose.root_translation);
        if let Some(root) = pose.rotations.first_mut() {
            *root = quat::renormalize(world_from_clip.rotation() * *root);
        }
        Some(pose)
    }

    /// Where the character will be at the trajectory times if a motion goes on from `place`,
    /// standing at `world_from_character`.
    #[must_use]
    pub fn trajectory(&self, place: Place, world_from_character: &Planar) -> Vec<Planar> {
        let Some(motion) = self.motion(place.motion) else {
            return Vec::new();
        };
        let world_from_clip = world_from_character.after(&motion.root(place.frame).inverse());
        let ahead = self.features.layout().ahead().iter();
        ahead.map(|ahead| world_from_clip.after(&motion.root(place.frame + ahead))).collect()
    }

    /// The same database with other tags on a clip and its mirror image: `source` is the clip's
    /// number among those it was built from, `tags` are at [`RATE`]. O(frames); features and boxes
    /// stay.
    #[must_use]
    pub fn retagged(&self, source: usize, tags: &[TagRange]) -> Self {
        let mut tagged = self.clone();
        for motion in tagged.motions.iter_mut().filter(|motion| motion.source() == source) {
            let mut changed = Motion::clone(motion);
            changed.tags = tags.to_vec();
            *motion = Arc::new(changed);
        }
        tagged.tags = spread_all(&tagged.motions);
        tagged.masks = tagged.index.masks(&tagged.tags);
        tagged
    }
}

/// The tags of all frames.
pub(super) fn spread_all(motions: &[Arc<Motion>]) -> Vec<TagSet> {
    let one = |motion: &Arc<Motion>| tags::spread(motion.tags(), RATE as f64, motion.frames());
    motions.iter().flat_map(one).collect()
}
