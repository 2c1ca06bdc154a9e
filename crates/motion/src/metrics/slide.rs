//! Foot slide: the distance that planted feet move.

use super::Extreme;
use crate::clip::{Clip, Contacts, stillest_step};
use crate::skeleton::{Foot, Roles, WorldPose};
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
    worst_foot_slide(clip, roles, contacts).map(|slide| slide.value)
}

/// Returns the slide of a planted foot in the worst stance of a clip, as [`foot_slide_cm`], and the
/// frame of that stance in which the foot slides fastest. O(frames × joints).
#[must_use]
pub fn worst_foot_slide(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Option<Extreme> {
    let mut meter = SlideMeter::new(clip, roles);
    while meter.advance(clip, contacts, clip.frames()) {}
    meter.worst()
}

/// Returns the slide of a planted foot in each stance, in the order in which stances end. Stances
/// of a single frame are left out.
#[must_use]
pub fn foot_slides(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Vec<StanceSlide> {
    let mut meter = SlideMeter::new(clip, roles);
    while meter.advance(clip, contacts, clip.frames()) {}
    meter.finish()
}

/// The slide of a foot in a stance.
#[derive(Clone, Debug, PartialEq)]
pub struct StanceSlide {
    /// The frames of the stance.
    pub frames: Range<usize>,
    /// The foot.
    pub foot: Foot,
    /// The slide, centimetres, as defined by [`foot_slide_cm`].
    pub slide_cm: f64,
    /// The frame in which the foot slides fastest.
    pub fastest: usize,
    /// The step into that frame, metres.
    largest_step_m: f32,
}

impl StanceSlide {
    /// Returns the stance with the largest slide, the first of equal ones.
    #[must_use]
    pub fn worst(slides: &[Self]) -> Option<Extreme> {
        Extreme::largest(slides.iter().map(|slide| (slide.fastest, slide.slide_cm)))
    }
}

/// The measurement of [`foot_slides`] in slices, for long clips. Every call must be given the
/// same clip and contacts.
#[derive(Clone, Debug)]
pub struct SlideMeter {
    feet: Vec<SlidingFoot>,
    slides: Vec<StanceSlide>,
    frame: usize,
}

/// The measurement of one foot.
#[derive(Clone, Debug)]
struct SlidingFoot {
    foot: Foot,
    /// Its points, and the joints from the root to them.
    points: Vec<(usize, Vec3)>,
    needed: Vec<usize>,
    /// The positions of the points in the previous frame and in the present one, where it is
    /// planted.
    before: Vec<Vec3>,
    now: Vec<Vec3>,
    slid: Vec3,
    /// The current stance, as far as it is measured.
    stance: Option<StanceSlide>,
}

impl SlidingFoot {
    /// Measures the step into `frame`, and returns a stance that ended before. The kinematics of
    /// the foot are computed, in `world`, where it is planted.
    fn advance(
        &mut self,
        clip: &Clip,
        contacts: &Contacts,
        frame: usize,
        world: &mut WorldPose,
    ) -> Option<StanceSlide> {
        let planted = |frame: usize| contacts.planted(self.foot, frame);
        let is_planted = planted(frame);
        let stands = is_planted && frame > 0 && planted(frame - 1);
        std::mem::swap(&mut self.before, &mut self.now);
        self.now.clear();
        if is_planted {
            clip.world_pose_of(frame, &self.needed, world);
            self.now.extend(self.points.iter().map(|&(joint, point)| world.point(joint, point)));
        }
        let step = if stands { stillest_step(&self.before, &self.now) } else { None };
        let Some(step) = step else {
            self.slid = Vec3::ZERO;
            return self.end_stance(frame);
        };
        self.slid += step;
        let stance = self.stance.get_or_insert(StanceSlide {
            frames: frame - 1..frame,
            foot: self.foot,
            slide_cm: 0.0,
            fastest: frame,
            largest_step_m: 0.0,
        });
        let slid_cm = f64::from(self.slid.length()) * 100.0;
        stance.slide_cm = stance.slide_cm.max(slid_cm);
        if step.length() > stance.largest_step_m {
            (stance.largest_step_m, stance.fastest) = (step.length(), frame);
        }
        None
    }

    fn end_stance(&mut self, frame: usize) -> Option<StanceSlide> {
        self.stance.take().map(|mut stance| {
            stance.frames.end = frame;
            stance
        })
    }
}

impl SlideMeter {
    /// Returns a meter that has measured nothing yet.
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles) -> Self {
        let feet: Vec<SlidingFoot> = Foot::of(roles.body_plan())
            .iter()
            .map(|&foot| {
                let points = roles.foot_points(clip.skeleton(), foot);
                let joints = points.iter().map(|&(joint, _)| joint);
                SlidingFoot {
                    foot,
                    needed: clip.skeleton().with_ancestors(joints),
                    points,
                    before: Vec::new(),
                    now: Vec::new(),
                    slid: Vec3::ZERO,
                    stance: None,
                }
            })
            .collect();
        Self { feet, slides: Vec::new(), frame: 0 }
    }

    /// Processes up to `frames` more frames (at least one). Returns `false` when all are done. A
    /// frame of 31 joints takes less than 1 µs.
    pub fn advance(&mut self, clip: &Clip, contacts: &Contacts, frames: usize) -> bool {
        if self.frame >= clip.frames() {
            return false;
        }
        let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
        let mut world = WorldPose::default();
        for frame in self.frame..end {
            for foot in &mut self.feet {
                self.slides.extend(foot.advance(clip, contacts, frame, &mut world));
            }
        }
        self.frame = end;
        true
    }

    /// Returns the slide in each stance, in the order in which stances end.
    #[must_use]
    pub fn finish(mut self) -> Vec<StanceSlide> {
        for foot in &mut self.feet {
            self.slides.extend(foot.end_stance(self.frame));
        }
        self.slides
    }

    /// Returns the slide of the worst stance, centimetres, and the frame in which the foot slides
    /// fastest there.
    #[must_use]
    pub fn worst(self) -> Option<Extreme> {
        StanceSlide::worst(&self.finish())
    }

    /// Returns the slide of the worst stance, centimetres.
    #[must_use]
    pub fn worst_cm(self) -> Option<f64> {
        self.worst().map(|slide| slide.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Planar;
    use crate::skeleton::Side;
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
        assert_eq!(worst_foot_slide(&pulled, &roles, &contacts).unwrap().value, slid);
        let none = Contacts::from_flags([vec![], vec![]]);
        assert_eq!(foot_slide_cm(&clip, &roles, &none), None);
    }

    #[test]
    fn worst_foot_slide_is_at_the_frame_of_a_sudden_slip() {
        let made = synthesize(&Params::new(Action::Walk)).unwrap();
        let clip = made.clip;
        let roles = Roles::detect(clip.skeleton());
        let flags = Side::BOTH
            .map(|side| made.truth.contacts.iter().map(|feet| feet[side.index()].any()).collect());
        let contacts = Contacts::from_flags(flags);
        let stance = contacts.intervals(Side::Left).into_iter().nth(1).unwrap();
        let slip = stance.start + stance.len() / 2;
        // The body is displaced by 20 cm between two frames of the stance.
        let (mut rotations, mut roots) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            let to_side = if frame >= slip { 0.2 } else { 0.0 };
            rotations.extend_from_slice(clip.rotations(frame));
            roots.push(clip.root_translations()[frame] + Vec3::new(to_side, 0.0, 0.0));
        }
        let slipped =
            Clip::new("slipped", clip.skeleton().clone(), clip.fps(), rotations, roots).unwrap();
        let worst = worst_foot_slide(&slipped, &roles, &contacts).unwrap();
        assert_eq!(worst.frame, slip);
        assert!((17.0..=23.0).contains(&worst.value), "{worst:?}");
    }
}
