use crate::clip::{Clip, Contacts, stillest_step};
use crate::skeleton::{Roles, Side, WorldPose};
use glam::Vec3;
use std::ops::Range;

/// How far a planted foot slides in the worst stance of a clip, centimetres.
///
/// In every step between two planted frames, the step over the ground of the foot's stillest point (ankle, ball or tip) is added up as a vector;
/// the value is the farthest that this sum gets in any stance. A foot that rolls without sliding has a point that stands. `None` without
/// feet or stances. O(frames × joints).
#[must_use]
pub fn foot_slide_cm(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Option<f64> {
    foot_slides_cm(clip, roles, contacts)
        .into_iter()
        .map(|(_, slide)| slide)
        .reduce(f64::max)
}

/// How far a planted foot slides in each stance, centimetres, as [`foot_slide_cm`] has it: the stance's frames, and the slide; in the order in which
/// stances end. A stance of a single frame is none.
#[must_use]
pub fn foot_slides_cm(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Vec<(Range<usize>, f64)> {
    let points = Side::BOTH.map(|side| roles.foot_points(clip.skeleton(), side));
    let mut before: [Vec<Vec3>; 2] = Default::default();
    let mut slid = [Vec3::ZERO; 2];
    let mut stances: [Option<(usize, f32)>; 2] = [None; 2];
    let mut slides = Vec::new();
    let mut world = WorldPose::default();
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        for side in Side::BOTH {
            let (points, before, slid) = (&points[side.index()], &mut before[side.index()], &mut slid[side.index()]);
            let stance = &mut stances[side.index()];
            let now: Vec<Vec3> = points.iter().map(|&(joint, point)| world.point(joint, point)).collect();
            let stands = contacts.planted(side, frame) && frame > 0 && contacts.planted(side, frame - 1);
            if let Some(step) = stillest_step(before, &now).filter(|_| stands) {
                *slid += step;
                let (start, farthest) = stance.unwrap_or((frame - 1, 0.0));
                *stance = Some((start, farthest.max(slid.length())));
            } else {
                *slid = Vec3::ZERO;
                slides.extend(stance.take().map(|(start, farthest)| (start..frame, farthest)));
            }
            *before = now;
        }
    }
    let last = stances.into_iter().flatten();
    slides.extend(last.map(|(start, farthest)| (start..clip.frames(), farthest)));
    slides
        .into_iter()
        .map(|(frames, metres)| (frames, f64::from(metres) * 100.0))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Planar;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn a_made_walk_stands_and_one_that_is_pulled_along_slides() {
        let made = synthesize(&Params::new(Action::Walk)).unwrap();
        let clip = made.clip;
        let roles = Roles::detect(clip.skeleton());
        let flags = Side::BOTH.map(|side| made.truth.contacts.iter().map(|feet| feet[side.index()].any()).collect());
        let contacts = Contacts::from_flags(flags);
        let still = foot_slide_cm(&clip, &roles, &contacts).unwrap();
        assert!(still < 3.0, "{still}");
        // Pulled sideways by 10 cm/s, a foot slides by that times its longest stance.
        let (mut rotations, mut roots) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            let pulled = Planar::new(0.0, 0.1 * clip.time_of(frame), 0.0);
            rotations.extend_from_slice(clip.rotations(frame));
            roots.push(pulled.apply(clip.root_translations()[frame]));
        }
        let pulled = Clip::new("pulled", clip.skeleton().clone(), clip.fps(), rotations, roots).unwrap();
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
