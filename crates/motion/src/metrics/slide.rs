//! Foot slide: the distance that planted feet move.

use crate::clip::{Clip, Contacts, stillest_step};
use crate::skeleton::{Roles, Side, WorldPose};
use glam::Vec3;
use std::ops::Range;

/// Returns the slide of a planted foot in the worst stance of a clip, centimetres.
///
/// For every step between two planted frames, the step over the ground of the foot's stillest point
/// (ankle, ball or tip) is added as a vector; the value is the greatest length of this sum in any
/// stance. A foot that rolls without sliding has a point that stands still. `None` without feet or
/// stances. O(frames × joints).
#[must_use]
pub fn foot_slide_cm(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Option<f64> {
    let mut meter = SlideMeter::new(clip, roles);
    while meter.advance(clip, contacts, clip.frames()) {}
    meter.worst_cm()
}

/// Returns the slide of a planted foot in each stance, centimetres, as defined by
/// [`foot_slide_cm`]: the stance's frames, and the slide; in the order in which stances end.
/// Stances of a single frame are left out.
#[must_use]
pub fn foot_slides_cm(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Vec<(Range<usize>, f64)> {
    let mut meter = SlideMeter::new(clip, roles);
    while meter.advance(clip, contacts, clip.frames()) {}
    meter.finish()
}

/// The measurement of [`foot_slides_cm`] in slices, for long clips. Every call must be given the
/// same clip and contacts.
#[derive(Debug)]
pub struct SlideMeter {
    /// Per side: the foot's points, and their positions in the previous frame.
    points: [Vec<(usize, Vec3)>; 2],
    before: [Vec<Vec3>; 2],
    slid: [Vec3; 2],
    /// The current stances: first frame, and slide so far.
    stances: [Option<(usize, f32)>; 2],
    slides: Vec<(Range<usize>, f64)>,
    frame: usize,
}

impl SlideMeter {
    /// Returns a meter that has measured nothing yet.
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles) -> Self {
        Self {
            points: Side::BOTH.map(|side| roles.foot_points(clip.skeleton(), side)),
            before: Default::default(),
            slid: [Vec3::ZERO; 2],
            stances: [None; 2],
            slides: Vec::new(),
            frame: 0,
        }
    }

    /// Processes up to `frames` more frames (at least one). Returns `false` when all are done. A
    /// frame of 31 joints takes 1 µs.
    pub fn advance(&mut self, clip: &Clip, contacts: &Contacts, frames: usize) -> bool {
        if self.frame >= clip.frames() {
            return false;
        }
        let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
        let mut world = WorldPose::default();
        for frame in self.frame..end {
            clip.world_pose_into(frame, &mut world);
            for side in Side::BOTH {
                let index = side.index();
                let now: Vec<Vec3> = self.points[index]
                    .iter()
                    .map(|&(joint, point)| world.point(joint, point))
                    .collect();
                let stands =
                    contacts.planted(side, frame) && frame > 0 && contacts.planted(side, frame - 1);
                if let Some(step) = stillest_step(&self.before[index], &now).filter(|_| stands) {
                    self.slid[index] += step;
                    let (start, farthest) = self.stances[index].unwrap_or((frame - 1, 0.0));
                    self.stances[index] = Some((start, farthest.max(self.slid[index].length())));
                } else {
                    self.slid[index] = Vec3::ZERO;
                    self.end_stance(index, frame);
                }
                self.before[index] = now;
            }
        }
        self.frame = end;
        true
    }

    fn end_stance(&mut self, index: usize, frame: usize) {
        let ended = self.stances[index].take();
        self.slides
            .extend(ended.map(|(start, farthest)| (start..frame, f64::from(farthest) * 100.0)));
    }

    /// Returns the stances, and the slide of the foot in each, centimetres.
    #[must_use]
    pub fn finish(mut self) -> Vec<(Range<usize>, f64)> {
        for side in Side::BOTH {
            self.end_stance(side.index(), self.frame);
        }
        self.slides
    }

    /// Returns the slide of the worst stance, centimetres.
    #[must_use]
    pub fn worst_cm(self) -> Option<f64> {
        self.finish().into_iter().map(|(_, slide)| slide).reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Planar;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn foot_slide_of_a_pulled_walk_is_the_pull() {
        let made = synthesize(&Params::new(Action::Walk)).unwrap();
        let clip = made.clip;
        let roles = Roles::detect(clip.skeleton());
        let flags = Side::BOTH
            .map(|side| made.truth.contacts.iter().map(|feet| feet[side.index()].any()).collect());
        let contacts = Contacts::from_flags(flags);
        let still = foot_slide_cm(&clip, &roles, &contacts).unwrap();
        assert!(still < 3.0, "{still}");
        // Pulled sideways at 10 cm/s, a foot slides by that times its longest stance.
        let (mut rotations, mut roots) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            let pulled = Planar::new(0.0, 0.1 * clip.time_of(frame), 0.0);
            rotations.extend_from_slice(clip.rotations(frame));
            roots.push(pulled.apply(clip.root_translations()[frame]));
        }
        let pulled =
            Clip::new("pulled", clip.skeleton().clone(), clip.fps(), rotations, roots).unwrap();
        let longest = Side::BOTH
            .into_iter()
            .flat_map(|side| contacts.intervals(side))
            .map(|stance| stance.len())
            .max();
        let expected = 10.0 * (longest.unwrap() - 1) as f64 / clip.fps();
        let slid = foot_slide_cm(&pulled, &roles, &contacts).unwrap();
        assert!((slid - expected).abs() < 1.0 + still, "{slid} {expected}");
        let none = Contacts::from_flags([vec![], vec![]]);
        assert_eq!(foot_slide_cm(&clip, &roles, &none), None);
    }
}
