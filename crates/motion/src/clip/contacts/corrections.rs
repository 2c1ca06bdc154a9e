//! Manual corrections of contacts.

use super::Contacts;
use crate::skeleton::Foot;
use std::ops::Range;

/// A correction: whether a foot is planted in these frames, whatever was detected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ContactCorrection {
    /// The foot.
    pub foot: Foot,
    /// The frames.
    pub frames: Range<usize>,
    /// Whether it is planted.
    pub planted: bool,
}

/// Corrections of the contacts of a clip; where they overlap, the later one applies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ContactCorrections(Vec<ContactCorrection>);

impl FromIterator<ContactCorrection> for ContactCorrections {
    fn from_iter<I: IntoIterator<Item = ContactCorrection>>(list: I) -> Self {
        Self(list.into_iter().filter(|correction| !correction.frames.is_empty()).collect())
    }
}

impl ContactCorrections {
    /// Returns the fewest corrections that turn the contacts `found` into `wanted`: foot by foot,
    /// the left one first, in order of time. Frames beyond those of `found` are ignored.
    #[must_use]
    pub fn between(found: &Contacts, wanted: &Contacts) -> Self {
        let mut list: Vec<ContactCorrection> = Vec::new();
        for &foot in found.feet() {
            for frame in 0..found.frames() {
                let planted = wanted.planted(foot, frame);
                if planted == found.planted(foot, frame) {
                    continue;
                }
                match list.last_mut() {
                    Some(last)
                        if (last.foot, last.frames.end, last.planted) == (foot, frame, planted) =>
                    {
                        last.frames.end += 1;
                    }
                    _ => list.push(ContactCorrection { foot, frames: frame..frame + 1, planted }),
                }
            }
        }
        Self(list)
    }

    /// Returns the corrections in the order in which they apply.
    #[must_use]
    pub fn list(&self) -> &[ContactCorrection] {
        &self.0
    }

    /// Returns whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns whether a foot is planted in `frame` by a correction; `None` without one.
    #[must_use]
    pub fn planted(&self, foot: impl Into<Foot>, frame: usize) -> Option<bool> {
        let foot = foot.into();
        let covers = |correction: &&ContactCorrection| {
            correction.foot == foot && correction.frames.contains(&frame)
        };
        self.0.iter().rev().find(covers).map(|correction| correction.planted)
    }

    /// Returns the corrected contacts. Corrections of feet that the body does not have are ignored.
    #[must_use]
    pub fn applied_to(&self, found: &Contacts) -> Contacts {
        let mut planted = found.planted.clone();
        for ContactCorrection { foot, frames, planted: is_planted } in &self.0 {
            let Some(flags) = planted.get_mut(foot.index()) else { continue };
            let end = frames.end.min(flags.len());
            if let Some(flags) = flags.get_mut(frames.start.min(end)..end) {
                flags.fill(*is_planted);
            }
        }
        Contacts { planted }
    }

    /// Returns the corrections of the same clip at `ratio` times its frame rate. Each keeps at
    /// least one frame.
    #[must_use]
    pub fn at_rate(&self, ratio: f64) -> Self {
        let frame = |frame: usize| (frame as f64 * ratio).round() as usize;
        let scaled = self.0.iter().map(|correction| {
            let start = frame(correction.frames.start);
            let frames = start..frame(correction.frames.end).max(start + 1);
            ContactCorrection { frames, ..correction.clone() }
        });
        Self(scaled.collect())
    }
}

/// An end of a stance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StanceEnd {
    /// The foot strikes the ground.
    Strike,
    /// The foot lifts.
    Lift,
}

impl Contacts {
    /// Returns the contacts with one end of a stance of a foot, by its number in
    /// [`intervals`](Self::intervals), at another frame: a stance keeps at least one frame, and at
    /// least one frame stays between it and its neighbours. Unchanged without such a stance.
    #[must_use]
    pub fn with_end_at(
        &self,
        foot: impl Into<Foot>,
        stance: usize,
        end: StanceEnd,
        frame: usize,
    ) -> Self {
        let foot = foot.into();
        let stances = self.intervals(foot);
        let Some(moved) = stances.get(stance) else {
            return self.clone();
        };
        let before = stance.checked_sub(1).and_then(|before| stances.get(before));
        let least = before.map_or(0, |before| before.end + 1);
        let most = stances.get(stance + 1).map_or(self.frames(), |next| next.start - 1);
        let frames = match end {
            StanceEnd::Strike => frame.clamp(least, moved.end - 1)..moved.end,
            StanceEnd::Lift => moved.start..frame.clamp(moved.start + 1, most),
        };
        self.with(foot, moved.clone(), false).with(foot, frames, true)
    }

    /// Returns the contacts with a foot planted, or not planted, in some frames; those beyond the
    /// clip are ignored.
    #[must_use]
    pub fn with(&self, foot: impl Into<Foot>, frames: Range<usize>, planted: bool) -> Self {
        let correction = ContactCorrection { foot: foot.into(), frames, planted };
        ContactCorrections(vec![correction]).applied_to(self)
    }

    /// Returns the contacts with a new stance around a frame in which the foot is not planted: of
    /// `length` frames where there is room, with a free frame before and behind it. A gap that has
    /// no room for more than it takes to separate them is closed. Unchanged where the foot is
    /// planted already, and beyond the clip.
    #[must_use]
    pub fn with_stance_at(&self, foot: impl Into<Foot>, frame: usize, length: usize) -> Self {
        let foot = foot.into();
        if frame >= self.frames() || self.planted(foot, frame) {
            return self.clone();
        }
        let stances = self.intervals(foot);
        let next = stances.partition_point(|stance| stance.start <= frame);
        let free = next.checked_sub(1).and_then(|before| stances.get(before)).map_or(0, |s| s.end)
            ..stances.get(next).map_or(self.frames(), |stance| stance.start);
        // Stances stay one frame apart; the ends of the clip need no such gap.
        let room = free.start + usize::from(free.start > 0)
            ..free.end - usize::from(free.end < self.frames());
        if room.is_empty() {
            return self.with(foot, free, true);
        }
        let length = length.clamp(1, room.len());
        let start = frame.saturating_sub(length / 2).clamp(room.start, room.end - length);
        self.with(foot, start..start + length, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Side;
    use proptest::prelude::*;

    fn flags(text: &str) -> Vec<bool> {
        text.bytes().map(|byte| byte == b'#').collect()
    }

    fn contacts(left: &str, right: &str) -> Contacts {
        Contacts::from_flags([flags(left), flags(right)])
    }

    fn left(text: &str) -> Contacts {
        contacts(text, &".".repeat(text.len()))
    }

    #[test]
    fn end_of_a_stance_stays_between_its_neighbours() {
        let found = left("..##..###..#");
        let moved = |end, frame| found.with_end_at(Side::Left, 1, end, frame);
        assert_eq!(moved(StanceEnd::Strike, 5), left("..##.####..#"));
        assert_eq!(moved(StanceEnd::Strike, 0), left("..##.####..#"));
        assert_eq!(moved(StanceEnd::Strike, 99), left("..##....#..#"));
        assert_eq!(moved(StanceEnd::Lift, 10), left("..##..####.#"));
        assert_eq!(moved(StanceEnd::Lift, 99), left("..##..####.#"));
        assert_eq!(moved(StanceEnd::Lift, 0), left("..##..#....#"));
        assert_eq!(found.with_end_at(Side::Left, 0, StanceEnd::Strike, 0), left("####..###..#"));
        assert_eq!(found.with_end_at(Side::Left, 2, StanceEnd::Lift, 0), found);
        for (side, stance) in [(Side::Left, 3), (Side::Right, 0)] {
            assert_eq!(found.with_end_at(side, stance, StanceEnd::Lift, 3), found);
        }
    }

    #[test]
    fn new_stance_takes_the_room_that_there_is() {
        let found = left("#......#.#...");
        let with = |frame, length| found.with_stance_at(Side::Left, frame, length);
        assert_eq!(with(3, 2), left("#.##...#.#..."));
        assert_eq!(with(1, 2), left("#.##...#.#..."));
        assert_eq!(with(6, 9), left("#.####.#.#..."));
        assert_eq!(with(8, 2), left("#......###..."), "a gap of one frame");
        assert_eq!(with(12, 2), left("#......#.#.##"));
        assert_eq!((with(0, 2), with(13, 2)), (found.clone(), found.clone()));
        let none = Contacts::from_flags([Vec::new(), Vec::new()]);
        assert_eq!(none.with_stance_at(Side::Left, 0, 4), none);
    }

    #[test]
    fn later_correction_counts_and_frames_beyond_the_clip_are_ignored() {
        let correction =
            |frames, planted| ContactCorrection { foot: Side::Right.into(), frames, planted };
        let corrections: ContactCorrections =
            [correction(1..4, true), correction(2..3, false), correction(5..99, true)]
                .into_iter()
                .chain([correction(90..99, true), correction(7..7, true)])
                .collect();
        assert_eq!(corrections.list().len(), 4, "an empty one says nothing");
        let found = contacts("#.....", "......");
        assert_eq!(corrections.applied_to(&found), contacts("#.....", ".#.#.#"));
        let known = [0, 1, 2, 95].map(|frame| corrections.planted(Side::Right, frame));
        assert_eq!(known, [None, Some(true), Some(false), Some(true)]);
        assert_eq!(corrections.planted(Side::Left, 1), None);
        let doubled = corrections.at_rate(2.0);
        assert_eq!(doubled.list()[0].frames, 2..8);
        let slower = corrections.at_rate(0.1);
        assert!(slower.list().iter().all(|correction| !correction.frames.is_empty()));
    }

    proptest! {
        #[test]
        fn corrections_between_contacts_lead_from_one_to_the_other(
            found in prop::array::uniform2(prop::collection::vec(any::<bool>(), 24)),
            wanted in prop::array::uniform2(prop::collection::vec(any::<bool>(), 24)),
        ) {
            let (found, wanted) = (Contacts::from_flags(found), Contacts::from_flags(wanted));
            let corrections = ContactCorrections::between(&found, &wanted);
            prop_assert_eq!(corrections.applied_to(&found), wanted.clone());
            prop_assert!(ContactCorrections::between(&wanted, &wanted).is_empty());
            // Only the frames that differ are corrected.
            for side in Side::BOTH {
                for frame in 0..24 {
                    let differs = found.planted(side, frame) != wanted.planted(side, frame);
                    prop_assert_eq!(corrections.planted(side, frame).is_some(), differs);
                }
            }
        }
    }
}
