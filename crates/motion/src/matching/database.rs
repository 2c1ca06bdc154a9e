//! The database: frames of all clips, with features, tags and search index.

use super::features::{FeatureOptions, RATE};
use super::motion::DatabaseClip;
use super::pace::Pace;
use super::search::{BoxIndex, BoxMasks, Candidates, Query};
use super::tags::{self, TagRange, TagSet};
use super::{Block, DatabaseBuilder, Features, MatchError, Weights};
use crate::clip::Motion;
use crate::math::{Planar, quat, stats};
use crate::retarget::{RetargetErrors, RetargetOptions};
use crate::skeleton::{Pose, Roles, Skeleton};
use std::sync::Arc;

/// A frame of one of the motions of a database.
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

/// Options of a database.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DatabaseOptions {
    /// The features of a frame.
    pub features: FeatureOptions,
    /// The options of retargeting clips of other bodies to that of the first.
    #[serde(default)]
    pub retarget: RetargetOptions,
    /// Whether each clip is followed by its mirror image.
    pub mirrored: bool,
    /// Whether a clip that is a cycle, exactly or nearly, repeats: it is searched to its last frame
    /// and plays on after it. Otherwise every clip ends.
    pub cycles: bool,
}

impl Default for DatabaseOptions {
    fn default() -> Self {
        Self {
            features: FeatureOptions::default(),
            retarget: RetargetOptions::default(),
            mirrored: true,
            cycles: true,
        }
    }
}

/// The frames of all clips one after the other, with features, tags, and a search index of bounding
/// boxes.
///
/// It is built once ([`DatabaseBuilder`]) and shared by any number of controllers. Its parts are
/// shared too: new tags ([`Self::retagged`]) or other trajectory times
/// ([`DatabaseBuilder::retimed`]) give another database that holds the same clips.
#[derive(Clone, Debug, PartialEq)]
pub struct Database {
    pub(super) options: DatabaseOptions,
    pub(super) skeleton: Arc<Skeleton>,
    pub(super) roles: Roles,
    pub(super) motions: Vec<Arc<DatabaseClip>>,
    /// The joints other than the root that move relative to their parent in any of them.
    pub(super) moving: Vec<usize>,
    /// The number of each motion's first frame; then the number of all frames.
    pub(super) starts: Vec<usize>,
    pub(super) features: Arc<Features>,
    pub(super) valid: Arc<Vec<u32>>,
    pub(super) index: Arc<BoxIndex>,
    pub(super) tags: Vec<TagSet>,
    pub(super) masks: BoxMasks,
    pub(super) skipped: Vec<MatchError>,
    /// The clips that were retargeted, with the errors that remain.
    pub(super) retargeted: Vec<(String, RetargetErrors)>,
    pub(super) pace: Pace,
}

impl Database {
    /// Builds a database at once, as a [`DatabaseBuilder`] does in slices.
    ///
    /// # Errors
    /// The same as for [`DatabaseBuilder`].
    pub fn new(clips: Vec<Arc<Motion>>, options: &DatabaseOptions) -> Result<Self, MatchError> {
        DatabaseBuilder::new(clips, options)?.finish()
    }

    /// Returns the options.
    #[must_use]
    pub fn options(&self) -> &DatabaseOptions {
        &self.options
    }

    /// Returns the height of the ground under all motions, metres: the lowest of theirs, so that no
    /// foot is lifted off the ground of its own clip, nor moved from one height to another by a
    /// jump.
    #[must_use]
    pub fn ground_m(&self) -> f32 {
        let heights = self.motions.iter().map(|motion| motion.ground_m());
        heights.min_by(f32::total_cmp).unwrap_or(0.0)
    }

    /// Returns the usual height of a planted foot's lowest point, metres: the median of the
    /// motions'.
    pub(super) fn stand_m(&self) -> f32 {
        let heights: Vec<f32> = self.motions.iter().map(|motion| motion.stand_m()).collect();
        stats::percentile(&heights, 0.5).unwrap_or(0.0)
    }

    /// Returns the names of the clips that were put on the body of the first, with the errors that
    /// remain; clips of the same rig are left out.
    #[must_use]
    pub fn retargeted(&self) -> &[(String, RetargetErrors)] {
        &self.retargeted
    }

    /// Returns the skeleton of all motions: the first clip's.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.skeleton
    }

    /// Returns the roles of its joints.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        &self.roles
    }

    /// Returns the motions: each clip, followed by its mirror image where that was requested.
    #[must_use]
    pub fn motions(&self) -> &[Arc<DatabaseClip>] {
        &self.motions
    }

    /// Returns one motion.
    #[must_use]
    pub fn motion(&self, motion: usize) -> Option<&DatabaseClip> {
        self.motions.get(motion).map(|motion| &**motion)
    }

    /// Returns the number of frames of all motions.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// Returns the frames that can be found: those whose trajectory lies inside their motion, and
    /// all frames of a cycle.
    #[must_use]
    pub fn valid(&self) -> &[u32] {
        &self.valid
    }

    /// Returns the reasons why clips were left out.
    #[must_use]
    pub fn skipped(&self) -> &[MatchError] {
        &self.skipped
    }

    /// Returns the greatest speeds of its motions.
    #[must_use]
    pub fn pace(&self) -> &Pace {
        &self.pace
    }

    /// Returns the normalised features of all frames. Those of frames that cannot be found are
    /// extrapolated beyond the end of their motion.
    #[must_use]
    pub fn features(&self) -> &Features {
        &self.features
    }

    /// Returns the index of boxes.
    #[must_use]
    pub fn index(&self) -> &BoxIndex {
        &self.index
    }

    /// Returns the tags of the boxes.
    #[must_use]
    pub fn masks(&self) -> &BoxMasks {
        &self.masks
    }

    /// Returns the input of a scan or of a tree.
    #[must_use]
    pub fn candidates(&self) -> Candidates<'_> {
        Candidates { features: &self.features, tags: &self.tags, valid: &self.valid }
    }

    /// Returns the tags of a frame.
    #[must_use]
    pub fn tags(&self, frame: usize) -> TagSet {
        self.tags.get(frame).copied().unwrap_or_default()
    }

    /// Returns the motion of a frame of the database, and its frame there.
    #[must_use]
    pub fn place(&self, frame: usize) -> Option<Place> {
        // Motions are not empty, so that no two start at the same number.
        let motion = self.starts.partition_point(|&start| start <= frame).checked_sub(1)?;
        (motion < self.motions.len()).then(|| Place { motion, frame: frame - self.starts[motion] })
    }

    /// Returns the number of a motion's frame; `None` outside the motion.
    #[must_use]
    pub fn number(&self, place: Place) -> Option<usize> {
        let motion = self.motion(place.motion)?;
        (place.frame < motion.frames()).then(|| self.starts[place.motion] + place.frame)
    }

    /// Returns whether a frame can be found: its trajectory lies inside its motion, or that is a
    /// cycle. Tags are not considered.
    #[must_use]
    pub fn is_valid(&self, place: Place) -> bool {
        self.motion(place.motion)
            .is_some_and(|motion| place.frame < motion.valid(self.features.layout()))
    }

    /// Returns the cost of a frame, block by block, in the order of [`Block::ALL`]. Zeros for a
    /// frame that does not exist.
    #[must_use]
    pub fn split(&self, query: &[f32], weights: &Weights, frame: usize) -> [f32; Block::COUNT] {
        let Some(row) = self.features.row(frame) else {
            return [0.0; Block::COUNT];
        };
        Block::ALL.map(|block| {
            let range = self.features.layout().range(block);
            let weights = vec![weights.of(block); range.len()];
            let part = Query {
                row: query.get(range.clone()).unwrap_or(&[]),
                weights: &weights,
                filter: super::TagFilter::default(),
            };
            part.cost(&row[range])
        })
    }

    /// Returns the pose of a frame for a character at `world_from_character`; `None` for a frame
    /// that does not exist.
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

    /// Returns the ground frames of the character at the trajectory times if a motion continues
    /// from `place`, with the character at `world_from_character`.
    #[must_use]
    pub fn trajectory(&self, place: Place, world_from_character: &Planar) -> Vec<Planar> {
        let Some(motion) = self.motion(place.motion) else {
            return Vec::new();
        };
        let world_from_clip = world_from_character.after(&motion.root(place.frame).inverse());
        let ahead = self.features.layout().ahead().iter();
        ahead.map(|ahead| world_from_clip.after(&motion.root(place.frame + ahead))).collect()
    }

    /// Returns the same database with other tags on a clip and its mirror image: `source` is the
    /// clip's number among those from which it was built, `tags` are at [`RATE`]. O(frames);
    /// features and boxes are shared.
    #[must_use]
    pub fn retagged(&self, source: usize, tags: &[TagRange]) -> Self {
        let mut tagged = self.clone();
        for motion in tagged.motions.iter_mut().filter(|motion| motion.source() == source) {
            *motion = Arc::new(DatabaseClip::clone(motion).with_tags(tags.to_vec()));
        }
        tagged.tags = spread_all(&tagged.motions);
        tagged.masks = tagged.index.masks(&tagged.tags);
        tagged
    }
}

/// Returns the tags of all frames.
pub(super) fn spread_all(motions: &[Arc<DatabaseClip>]) -> Vec<TagSet> {
    let one =
        |motion: &Arc<DatabaseClip>| tags::spread(motion.tags(), RATE as f64, motion.frames());
    motions.iter().flat_map(one).collect()
}
