//! Tags of frames, and filters by tags.

use super::features::RATE;
use crate::math::{Planar, wrap_angle};
use std::ops::Range;

/// A property of a range of frames.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub enum Tag {
    /// The character walks.
    Walk,
    /// The character runs.
    Run,
    /// The character stands.
    Idle,
    /// The character turns.
    Turn,
    /// The frames are never searched.
    Exclude,
    /// A tag of the user, by its number from 0 to 26.
    Own(u8),
}

impl Tag {
    /// The greatest number of user tags.
    pub const MAX_OWN: u8 = 27;

    /// The built-in tags.
    pub const FIXED: [Self; 5] = [Self::Walk, Self::Run, Self::Idle, Self::Turn, Self::Exclude];

    /// Returns the name on screen; empty for user tags.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Walk => "walk",
            Self::Run => "run",
            Self::Idle => "idle",
            Self::Turn => "turn",
            Self::Exclude => "exclude",
            Self::Own(_) => "",
        }
    }

    const fn bit(self) -> u32 {
        match self {
            Self::Walk => 1,
            Self::Run => 2,
            Self::Idle => 4,
            Self::Turn => 8,
            Self::Exclude => 16,
            Self::Own(word) if word < Self::MAX_OWN => 32 << word,
            Self::Own(_) => 0,
        }
    }
}

/// A set of tags: of one frame, or of a filter.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct TagSet(pub u32);

impl TagSet {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// Returns the set of these tags.
    #[must_use]
    pub fn of(tags: &[Tag]) -> Self {
        Self(tags.iter().fold(0, |bits, tag| bits | tag.bit()))
    }

    /// Returns whether a tag is in the set.
    #[must_use]
    pub const fn has(self, tag: Tag) -> bool {
        self.0 & tag.bit() != 0
    }

    /// Returns the set with a tag, or without it.
    #[must_use]
    pub const fn with(self, tag: Tag, wanted: bool) -> Self {
        if wanted { Self(self.0 | tag.bit()) } else { Self(self.0 & !tag.bit()) }
    }

    /// Returns whether both sets have a tag in common.
    #[must_use]
    pub const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// A filter of frames by tags.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct TagFilter {
    /// The required tags: a frame must have at least one of these; an empty set admits all.
    pub ask: TagSet,
    /// The forbidden tags: a frame must have none of these. [`Tag::Exclude`] is always forbidden.
    pub forbid: TagSet,
}

impl TagFilter {
    /// Returns whether the filter admits a frame with these tags.
    #[must_use]
    pub fn admits(self, tags: TagSet) -> bool {
        (self.ask == TagSet::NONE || tags.meets(self.ask)) && !tags.meets(self.forbidden())
    }

    /// Returns whether the filter may admit one of several frames, which have the tags `any`
    /// between them and `all` of these in common.
    pub(super) fn may_admit(self, any: TagSet, all: TagSet) -> bool {
        (self.ask == TagSet::NONE || any.meets(self.ask)) && !all.meets(self.forbidden())
    }

    fn forbidden(self) -> TagSet {
        self.forbid.with(Tag::Exclude, true)
    }
}

/// A range of frames of a clip with a tag.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TagRange {
    /// The tag.
    pub tag: Tag,
    /// The frames, at the clip's own rate.
    pub frames: Range<usize>,
}

/// The speed below which a body of 1.75 m stands, and the speed above which it runs, metres per
/// second: between walking (at most 2.2) and running lies the preferred transition at about 2 m/s
/// (Hreljac 1993).
const MAX_IDLE_MPS: f64 = 0.25;
const MIN_RUN_MPS: f64 = 2.1;
/// The yaw rate above which it turns, radians per second: 17° per second.
const MIN_TURN_RPS: f64 = 0.3;
/// Half the time over which speed and turn rate are measured, and the least duration of a range,
/// seconds.
const REACH_SECS: f64 = 0.2;

/// Suggests walk, run, idle and turn from the speed and the turn rate of `roots`
/// (`world_from_character` at `fps`), for a body `scale` times as high as 1.75 m. Ranges of one tag
/// are in order and do not touch; turn overlaps the others.
#[must_use]
pub fn suggest_tags(roots: &[Planar], fps: f64, scale: f64) -> Vec<TagRange> {
    let reach = ((REACH_SECS * fps).round() as usize).max(1);
    let last = roots.len().saturating_sub(1);
    let rates = |frame: usize| {
        let (before, after) = (frame.saturating_sub(reach), (frame + reach).min(last));
        let secs = (after - before).max(1) as f64 / fps;
        let (from, to) = (&roots[before], &roots[after]);
        // In two halves, so that a quick spin is not mistaken for its complement.
        let middle = &roots[usize::midpoint(before, after)];
        let turned = wrap_angle(middle.yaw - from.yaw) + wrap_angle(to.yaw - middle.yaw);
        (from.shift.distance(to.shift) / secs / scale.max(1e-3), turned.abs() / secs)
    };
    let all: Vec<(f64, f64)> = (0..roots.len()).map(rates).collect();
    let mut ranges = Vec::new();
    let mut add = |tag, is: &dyn Fn((f64, f64)) -> bool| {
        let mut start = None;
        for frame in 0..=all.len() {
            let here = all.get(frame).is_some_and(|&rates| is(rates));
            match (here, start) {
                (true, None) => start = Some(frame),
                (false, Some(from)) => {
                    if frame - from >= reach {
                        ranges.push(TagRange { tag, frames: from..frame });
                    }
                    start = None;
                }
                _ => {}
            }
        }
    };
    add(Tag::Walk, &|(speed, _)| (MAX_IDLE_MPS..MIN_RUN_MPS).contains(&speed));
    add(Tag::Run, &|(speed, _)| speed >= MIN_RUN_MPS);
    add(Tag::Idle, &|(speed, turn)| speed < MAX_IDLE_MPS && turn < MIN_TURN_RPS);
    add(Tag::Turn, &|(_, turn)| turn >= MIN_TURN_RPS);
    ranges
}

/// Returns the tags of each of `frames` frames at [`RATE`], from ranges at `fps`.
pub(super) fn spread(ranges: &[TagRange], fps: f64, frames: usize) -> Vec<TagSet> {
    let mut tags = vec![TagSet::NONE; frames];
    let scale = RATE as f64 / fps;
    for range in ranges {
        let at = |frame: usize| ((frame as f64 * scale).round() as usize).min(frames);
        let (from, to) = (at(range.frames.start), at(range.frames.end));
        for set in tags.get_mut(from..to).into_iter().flatten() {
            *set = set.with(range.tag, true);
        }
    }
    tags
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggest_tags_follows_speed_and_turn_rate() {
        let fps = 60.0;
        // Two seconds of standing, two of walking, two of running, two of turning on the spot.
        let mut at = Planar::IDENTITY;
        let roots: Vec<Planar> = (0..480)
            .map(|frame| {
                let (speed, turn) = [(0.0, 0.0), (1.4, 0.0), (3.5, 0.0), (0.0, 2.0)][frame / 120];
                at = at.after(&Planar::new(turn / fps, 0.0, speed / fps));
                at
            })
            .collect();
        let found = suggest_tags(&roots, fps, 1.0);
        for (tag, from, to) in [(Tag::Walk, 120, 240), (Tag::Run, 240, 360), (Tag::Turn, 360, 480)]
        {
            let range = &found.iter().find(|range| range.tag == tag).expect("suggested").frames;
            assert!(
                range.start.abs_diff(from) < 13 && range.end.abs_diff(to) < 13,
                "{tag:?} {range:?}"
            );
        }
        let tags = spread(&found, fps, 480);
        assert!(tags[60].has(Tag::Idle) && !tags[60].has(Tag::Turn) && !tags[420].has(Tag::Idle));
        assert_eq!(suggest_tags(&[], fps, 1.0), []);
    }

    #[test]
    fn tag_filter_requires_one_and_forbids_all() {
        let [walk, turn, own] = [Tag::Walk, Tag::Turn, Tag::Own(26)].map(|tag| TagSet::of(&[tag]));
        let filter = TagFilter { ask: TagSet(walk.0 | own.0), forbid: turn };
        assert!(
            filter.admits(walk)
                && filter.admits(own)
                && !filter.admits(TagSet::NONE)
                && !filter.admits(TagSet(walk.0 | turn.0))
        );
        assert!(!TagFilter::default().admits(TagSet::of(&[Tag::Exclude, Tag::Walk])));
        assert_eq!(TagSet::of(&[Tag::Own(27), Tag::Own(255)]), TagSet::NONE);
        // Ranges beyond the clip, and reversed ranges, are ignored.
        let odd = TagRange { tag: Tag::Run, frames: Range { start: 9, end: 3 } };
        let far = TagRange { tag: Tag::Run, frames: 70..usize::MAX };
        assert!(spread(&[odd, far], 60.0, 50).iter().all(|tags| *tags == TagSet::NONE));
    }
}
