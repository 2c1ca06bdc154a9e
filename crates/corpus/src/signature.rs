//! The signature of a clip, by which copies of it are found.
//!
//! Copies are the same motion under another name: in another format, unit, rate or rig, exported
//! anew, or mirrored. At eight moments, spread evenly, a signature has the places of hands, elbows,
//! head, knees and feet in the character's own frame, the step over the ground since the moment
//! before, and the turn since then. All are in millimetres: no scale of the corpus enters.

use glam::{DVec2, Vec3};
use segue_motion::clip::{Clip, character_frames};
use segue_motion::math::{Planar, wrap_angle};
use segue_motion::skeleton::{Role, Roles, Side};

/// The number of moments.
const MOMENTS: usize = 8;
/// The joints in the middle of the body.
const MIDDLE: [Role; 1] = [Role::Head];
/// The joints of each side.
const SIDES: [[Role; 4]; 2] = [
    [Role::LeftHand, Role::LeftForearm, Role::LeftShin, Role::LeftFoot],
    [Role::RightHand, Role::RightForearm, Role::RightShin, Role::RightFoot],
];
/// Joints of the body.
const JOINTS: usize = MIDDLE.len() + 2 * SIDES[0].len();
/// Numbers of a moment: joints, a step (x, z), and a turn (sine, cosine).
const NUMBERS: usize = 3 * JOINTS + 4;
/// The length at which a turn is measured, millimetres: that of an arm.
const TURN_MM: f64 = 500.0;
/// The greatest distance of copies, centimetres. The same motion in another rig is nearer, another
/// take of it farther.
pub const MAX_DISTANCE_CM: f32 = 2.5;
/// The greatest difference of the durations of copies, seconds.
pub(crate) const MAX_SECS_APART: f64 = 0.1;

/// The signature of a clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature(Vec<i32>);

impl Signature {
    /// The length of a signature.
    pub const LEN: usize = MOMENTS * NUMBERS;

    /// Returns the signature of a clip on the standard body; `None` if it has no frames.
    #[must_use]
    pub fn of(clip: &Clip, roles: &Roles) -> Option<Self> {
        let last = clip.frames().checked_sub(1)?;
        let frames = character_frames(clip, roles);
        let mut numbers = Vec::with_capacity(Self::LEN);
        let mut before: Option<Planar> = None;
        for moment in 0..MOMENTS {
            let at = (moment as f64 + 0.5) / MOMENTS as f64 * last as f64;
            let (frame, share) = ((at as usize).min(last), at.fract());
            let next = (frame + 1).min(last);
            let here = between(frames.get(frame)?, frames.get(next)?, share);
            let points = joints(clip, roles, frame, frames.get(frame)?);
            let beside = joints(clip, roles, next, frames.get(next)?);
            for (point, beside) in points.iter().zip(&beside) {
                numbers.extend(point.lerp(*beside, share as f32).to_array().map(millimetres));
            }
            let moved = before.map_or(Planar::IDENTITY, |before| before.inverse().after(&here));
            let shift = moved.shift / (1.0 + moved.shift.length());
            numbers.extend([shift.x, shift.y].map(|metres| millimetres(metres as f32)));
            let turn = [libm::sin(moved.yaw), libm::cos(moved.yaw)];
            numbers.extend(turn.map(|part| (part * TURN_MM).round() as i32));
            before = Some(here);
        }
        Some(Self(numbers))
    }

    /// Returns the signature with these numbers; `None` if there are more or fewer.
    #[must_use]
    pub fn from_numbers(numbers: Vec<i32>) -> Option<Self> {
        (numbers.len() == Self::LEN).then_some(Self(numbers))
    }

    /// Returns its numbers.
    #[must_use]
    pub fn numbers(&self) -> &[i32] {
        &self.0
    }

    /// Returns the signature of the mirrored clip.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let (middle, side) = (3 * MIDDLE.len(), 3 * SIDES[0].len());
        let mut made = Vec::with_capacity(Self::LEN);
        for moment in self.0.chunks_exact(NUMBERS) {
            let (joints, ground) = moment.split_at(3 * JOINTS);
            let (middle, sides) = joints.split_at(middle);
            let (left, right) = sides.split_at(side);
            for point in [middle, right, left].concat().chunks_exact(3) {
                made.extend([-point[0], point[1], point[2]]);
            }
            made.extend([-ground[0], ground[1], -ground[2], ground[3]]);
        }
        Self(made)
    }

    /// Returns the greatest distance at any moment, centimetres: the root mean square over joints,
    /// step and turn. `None` beyond `most_cm`.
    #[must_use]
    pub fn distance_cm(&self, other: &Self, most_cm: f32) -> Option<f32> {
        let vectors = (JOINTS + 2) as f64;
        let most = f64::from(most_cm) * 10.0;
        let mut worst = 0.0f64;
        for (a, b) in self.0.chunks_exact(NUMBERS).zip(other.0.chunks_exact(NUMBERS)) {
            let apart = a.iter().zip(b).map(|(a, b)| f64::from(*a) - f64::from(*b));
            worst = worst.max(apart.map(|apart| apart * apart).sum::<f64>() / vectors);
            if worst > most * most {
                return None;
            }
        }
        Some((worst.sqrt() * 0.1) as f32)
    }
}

/// Returns the places of the joints in the character's frame, metres.
fn joints(clip: &Clip, roles: &Roles, frame: usize, character: &Planar) -> Vec<Vec3> {
    let (world, character_from_world) = (clip.world_pose(frame), character.inverse());
    let all = MIDDLE.into_iter().chain(Side::BOTH.into_iter().flat_map(|side| SIDES[side.index()]));
    let place = |role| {
        let joint = roles.get_within(role, world.positions.len());
        joint.map_or(Vec3::ZERO, |joint| character_from_world.apply(world.positions[joint]))
    };
    all.map(place).collect()
}

fn between(a: &Planar, b: &Planar, share: f64) -> Planar {
    let shift: DVec2 = a.shift.lerp(b.shift, share);
    Planar { yaw: a.yaw + share * wrap_angle(b.yaw - a.yaw), shift }
}

fn millimetres(metres: f32) -> i32 {
    (metres * 1000.0).round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StandardBody;
    use segue_motion::clip::{Interpolation, Motion, mirror, resample};
    use segue_motion::synth::{Action, Params, synthesize};

    fn signature(motion: &Motion) -> Signature {
        let body = StandardBody::new().unwrap();
        let placed = body.place(motion).unwrap();
        Signature::of(&placed.clip, body.roles()).unwrap()
    }

    fn walk(change: impl FnOnce(&mut Params)) -> Motion {
        let mut params = Params::new(Action::Walk);
        change(&mut params);
        Motion::analyze(synthesize(&params).unwrap().clip)
    }

    #[test]
    fn copy_at_another_rate_and_size_is_near_and_another_walk_is_not() {
        let own = walk(|_| ());
        let first = signature(&own);
        let slower = resample(own.clip(), 25.0, Interpolation::Linear).unwrap();
        let smaller = Motion::analyze(slower.scaled(0.9));
        let distance = |motion: &Motion| first.distance_cm(&signature(motion), 1e6).unwrap();
        assert!(distance(&smaller) < MAX_DISTANCE_CM, "{}", distance(&smaller));
        let elsewhere = Motion::analyze(own.clip().transformed(&Planar::new(2.0, 3.0, -7.0)));
        assert!(distance(&elsewhere) < 0.3, "{}", distance(&elsewhere));
        let others =
            [walk(|params| params.speed_mps = 1.7), walk(|params| params.turn_rate_dps = 35.0)];
        for other in others {
            assert!(distance(&other) > MAX_DISTANCE_CM, "{}", distance(&other));
        }
    }

    #[test]
    fn mirrored_signature_is_that_of_the_mirrored_clip() {
        let own = walk(|params| params.turn_rate_dps = 25.0);
        let mirrored = Motion::analyze(mirror(own.clip(), own.roles()).unwrap());
        let (own, mirrored) = (signature(&own), signature(&mirrored));
        assert_eq!(own.distance_cm(&mirrored, MAX_DISTANCE_CM), None);
        let distance = own.mirrored().distance_cm(&mirrored, 1e6).unwrap();
        assert!(distance < 0.5, "{distance}");
        assert_eq!(own.mirrored().mirrored(), own);
    }

    #[test]
    fn signature_of_other_length_is_refused() {
        assert_eq!(Signature::from_numbers(vec![0; Signature::LEN - 1]), None);
        assert!(Signature::from_numbers(vec![0; Signature::LEN]).is_some());
    }
}
