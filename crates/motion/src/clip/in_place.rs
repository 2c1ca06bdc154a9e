//! Clips without root motion, and root motion computed from planted feet.

use super::contacts::{FootTracks, GROUND_PERCENTILE, REFERENCE_HEIGHT_M, drop_short_runs};
use super::{Clip, ContactCorrections, ContactOptions, Contacts, character_frames};
use crate::math::{Planar, stats};
use crate::skeleton::{Foot, Roles};
use glam::DVec2;

/// The first estimate of the body's speed is a mean over this time, seconds: about one step.
const STEP_SECS: f64 = 0.5;
/// Below this speed of a body of 1.75 m, metres per second, direction does not separate stance
/// from swing, and every low foot stands.
const STANDING_MPS: f64 = 0.15;
/// A standing foot moves backward at no less than this share of the body's speed. A swinging foot
/// moves forward.
const MIN_BACKWARD_SHARE: f64 = 0.6;
/// The velocity at either end of a flight is a mean over this time, seconds.
const FLIGHT_SECS: f64 = 0.1;
/// Displacements are smoothed by a triangle that reaches this time to both sides, seconds.
const SHIFT_SMOOTHING_SECS: f64 = 0.02;
/// Turns are smoothed by a triangle that reaches this time to both sides, seconds: heel and tip are
/// close together, so that a foot that rolls seems to turn.
const TURN_SMOOTHING_SECS: f64 = 0.15;
/// Number of refinements of the first estimate.
const ROUNDS: usize = 3;

/// Returns the transforms that take a clip in place, one for each frame: each moves the body over
/// the origin, and with `turns` makes it face +Z. `character_frames` are those of
/// [`character_frames`]; for [`Clip::transformed_by_frame`].
///
/// [`character_frames`]: super::character_frames
#[must_use]
pub fn take_in_place(character_frames: &[Planar], turns: bool) -> Vec<Planar> {
    let taken = |frame: &Planar| {
        if turns { frame.inverse() } else { Planar { yaw: 0.0, shift: -frame.shift } }
    };
    character_frames.iter().map(taken).collect()
}

/// The root motion of a clip that moves in place.
#[derive(Clone, Debug, PartialEq)]
pub struct RootMotion {
    /// The transform of each frame, for [`Clip::transformed_by_frame`]; the first frame keeps its
    /// place.
    pub world_from_clip: Vec<Planar>,
    /// The intervals in which each foot carries the body.
    pub contacts: Contacts,
}

/// Error computing root motion from planted feet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum RootMotionError {
    /// The skeleton has no known feet.
    #[error("No foot of this body is known: set its body parts.")]
    NoFeet,
    /// No foot reaches the ground.
    #[error("No foot reaches the ground in this clip: raise the contact height.")]
    NoContacts,
}

/// Computes the root motion of a clip that moves in place, from its planted feet. Root motion that
/// the clip has is removed first, so that the result shows how well its feet agree with it.
///
/// A planted foot stands still in the world, so the body moves against the foot's own motion.
/// Feet that carry the body are found by height and by backward motion: below the contact height
/// each point (ankle, ball, tip) counts by `(1 - height / limit)²`; the mean of their steps,
/// smoothed over half a second, is a first guess at the body's velocity; a point that does not
/// move backward at 0.6 of it belongs to a foot that swings low, and is left out; this is repeated
/// three times. Where nothing carries the body, as in the flight of a run, its velocity is
/// interpolated from the last known to the next. With `turns` the body also turns against the turn
/// of the feet that carry it, where ankle and tip both do. Displacements are smoothed over 0.04 s
/// and turns over 0.3 s, because a foot that begins or ceases to carry changes them in one frame.
///
/// Each foot counts by its point that moves backward fastest: the others roll about it.
///
/// The speed limits of `options` are not used; `corrections` overrule the contacts that are found.
/// The distance of synthesised walks is reproduced within 1 %, that of runs within 7 %, too short:
/// a foot that lands or leaves is a little slower than the ground. A foot that slides in the source
/// is taken as standing. O(frames × joints).
///
/// # Errors
/// [`RootMotionError`]
pub fn root_motion_from_feet(
    clip: &Clip,
    roles: &Roles,
    options: &ContactOptions,
    corrections: &ContactCorrections,
    turns: bool,
) -> Result<RootMotion, RootMotionError> {
    let taken = take_in_place(&character_frames(clip, roles), turns);
    let clip = &clip.transformed_by_frame(&taken);
    let feet = Feet::of(clip, roles, options);
    if feet.points.is_empty() {
        return Err(RootMotionError::NoFeet);
    }
    let carries = feet.carrying(clip.fps());
    let contacts = corrections.applied_to(&feet.contacts(&carries, options, clip.fps()));
    if contacts.feet().iter().all(|&foot| contacts.intervals(foot).is_empty()) {
        return Err(RootMotionError::NoContacts);
    }
    let velocities = feet.velocities(&carries, clip.fps());
    let mut steps: Vec<Option<Planar>> = (velocities.iter().enumerate())
        .take(clip.frames().saturating_sub(1))
        .map(|(frame, velocity)| feet.step(&carries, &contacts, *velocity, frame, turns))
        .collect();
    bridge(&mut steps, (FLIGHT_SECS * clip.fps()).round() as usize);
    let frames_of = |secs: f64| (secs * clip.fps()).round() as usize;
    let shifts = smoothed(&steps, frames_of(SHIFT_SMOOTHING_SECS));
    let turns = smoothed(&steps, frames_of(TURN_SMOOTHING_SECS));
    let mut steps = turns.iter().zip(shifts).map(|(turn, shift)| Planar { yaw: turn.yaw, ..shift });
    let mut place = taken.first().map_or(Planar::IDENTITY, Planar::inverse);
    let mut world_from_clip = Vec::with_capacity(clip.frames());
    for taken in &taken {
        world_from_clip.push(place.after(taken));
        place = steps.next().map_or(place, |step| place.after(&step));
    }
    Ok(RootMotion { world_from_clip, contacts })
}

/// The points of all feet, frame by frame.
struct Feet {
    /// The feet of the body.
    of: &'static [Foot],
    points: Vec<FootPoint>,
    /// The body's height against that of the options.
    scale: f64,
}

struct FootPoint {
    foot: Foot,
    /// Trajectory over the ground, (x, z) in metres.
    way: Vec<DVec2>,
    /// Share of the body that it may carry by its height alone, 0 to 1.
    lows: Vec<f64>,
}

impl Feet {
    fn of(clip: &Clip, roles: &Roles, options: &ContactOptions) -> Self {
        let scale = f64::from(roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M);
        let limit = f64::from(options.leave_height_m.max(options.enter_height_m)) * scale;
        let mut points = Vec::new();
        for (foot, way) in FootTracks::of(clip, roles).feet.into_iter().flatten() {
            let heights: Vec<f32> = way.iter().map(|point| point.y).collect();
            let Some(level) = stats::percentile(&heights, GROUND_PERCENTILE) else {
                continue;
            };
            let low = |height: &f32| {
                let share = f64::from((height - level).max(0.0)) / limit.max(1e-6);
                (1.0 - share).max(0.0).powi(2)
            };
            points.push(FootPoint {
                foot,
                lows: heights.iter().map(low).collect(),
                way: way
                    .iter()
                    .map(|point| DVec2::new(f64::from(point.x), f64::from(point.z)))
                    .collect(),
            });
        }
        Self { of: Foot::of(roles.body_plan()), points, scale }
    }

    /// Returns the share of the body that each point carries, 0 to 1: that of low points that do
    /// not swing.
    fn carrying(&self, fps: f64) -> Vec<Vec<f64>> {
        let mut carries: Vec<Vec<f64>> =
            self.points.iter().map(|point| point.lows.clone()).collect();
        let standing_mps = STANDING_MPS * self.scale;
        for _ in 0..ROUNDS {
            let velocities = self.velocities(&carries, fps);
            for (point, carries) in self.points.iter().zip(&mut carries) {
                for (frame, weight) in carries.iter_mut().enumerate() {
                    let velocity = velocities.get(frame).copied().unwrap_or_default();
                    let speed = velocity.length();
                    let backward = point.velocity(frame, fps).dot(velocity) / -speed.max(1e-9);
                    let stands = speed < standing_mps || backward >= MIN_BACKWARD_SHARE * speed;
                    *weight = if stands { point.lows[frame] } else { 0.0 };
                }
            }
        }
        carries
    }

    /// Returns the body's velocity in each frame, metres per second, as a mean over about one step.
    fn velocities(&self, carries: &[Vec<f64>], fps: f64) -> Vec<DVec2> {
        let frames = self.points.first().map_or(0, |point| point.way.len());
        let weighed = |frame: usize| {
            let each = self.points.iter().zip(carries);
            each.fold((DVec2::ZERO, 0.0), |(sum, total), (point, carries)| {
                let weight = carries[frame];
                (sum - weight * point.velocity(frame, fps), total + weight)
            })
        };
        // Prefix sums, so that the cost does not depend on the width of the mean.
        let mut sums = vec![(DVec2::ZERO, 0.0)];
        for frame in 0..frames {
            let (sum, total) = sums[frame];
            let (more, weight) = weighed(frame);
            sums.push((sum + more, total + weight));
        }
        let reach = (0.5 * STEP_SECS * fps).round() as usize;
        let mean = |frame: usize| {
            let (from, to) = (frame.saturating_sub(reach), (frame + reach + 1).min(frames));
            let ((before, less), (behind, total)) = (sums[from], sums[to]);
            if total > less { (behind - before) / (total - less) } else { DVec2::ZERO }
        };
        (0..frames).map(mean).collect()
    }

    fn contacts(&self, carries: &[Vec<f64>], options: &ContactOptions, fps: f64) -> Contacts {
        // The height below which a foot touches down.
        let share = options.enter_height_m / options.leave_height_m.max(options.enter_height_m);
        let least = (1.0 - f64::from(share)).powi(2).max(1e-6);
        let frames = self.points.first().map_or(0, |point| point.way.len());
        let flags = |foot: Foot| -> Vec<bool> {
            let own =
                || self.points.iter().zip(carries).filter(move |(point, _)| point.foot == foot);
            let carried = |frame: usize| own().any(|(_, carries)| carries[frame] >= least);
            let mut planted: Vec<bool> = (0..frames).map(carried).collect();
            let min_frames = (f64::from(options.min_secs) * fps).round().max(0.0) as usize;
            drop_short_runs(&mut planted, false, min_frames);
            drop_short_runs(&mut planted, true, min_frames);
            planted
        };
        Contacts::of_feet(self.of, flags)
    }

    /// Returns the step of the body from a frame to the next; `None` where nothing carries it.
    fn step(
        &self,
        carries: &[Vec<f64>],
        contacts: &Contacts,
        velocity: DVec2,
        frame: usize,
        turns: bool,
    ) -> Option<Planar> {
        let stands =
            |foot: Foot| contacts.planted(foot, frame) && contacts.planted(foot, frame + 1);
        let weight = |index: usize| carries[index][frame].min(carries[index][frame + 1]);
        let carrying = || {
            let each = self.points.iter().enumerate();
            let each = each.map(move |(index, point)| (point, weight(index)));
            each.filter(move |(point, weight)| stands(point.foot) && *weight > 0.0)
        };
        let total: f64 = carrying().map(|(_, weight)| weight).sum();
        if total <= 0.0 {
            return None;
        }
        let mut yaw = 0.0;
        if turns {
            let turned = self.of.iter().filter_map(|&foot| {
                let mut own = carrying().filter(|(point, _)| point.foot == foot);
                let (heel, tip) = (own.next()?, own.next_back()?);
                let along = |frame: usize| Some(tip.0.way.get(frame)? - heel.0.way.get(frame)?);
                let (before, after) = (along(frame)?, along(frame + 1)?);
                // About +Y, from z to x.
                let turn = libm::atan2(after.perp_dot(before), after.dot(before));
                Some((-turn, heel.1.min(tip.1)))
            });
            let (sum, weights) = turned
                .fold((0.0, 0.0), |(sum, all), (turn, weight)| (sum + weight * turn, all + weight));
            yaw = if weights > 0.0 { sum / weights } else { 0.0 };
        }
        let turn = Planar { yaw, shift: DVec2::ZERO };
        // The point of each foot that moves backward fastest: it stands, while the others roll
        // about it.
        let step = |point: &FootPoint| point.way[frame] - turn.apply_ground(point.way[frame + 1]);
        let feet = self.of.iter().filter_map(|&foot| {
            let own = carrying().filter(|(point, _)| point.foot == foot);
            let each = own.map(|(point, weight)| (step(point), weight));
            each.max_by(|a, b| a.0.dot(velocity).total_cmp(&b.0.dot(velocity)))
        });
        let (shift, total) = feet.fold((DVec2::ZERO, 0.0), |(sum, all), (step, weight)| {
            (sum + weight * step, all + weight)
        });
        Some(Planar { yaw, shift: shift / total })
    }
}

impl FootPoint {
    /// Its velocity by central differences, metres per second.
    fn velocity(&self, frame: usize, fps: f64) -> DVec2 {
        let last = self.way.len().saturating_sub(1);
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
        if before == after {
            return DVec2::ZERO;
        }
        (self.way[after] - self.way[before]) * fps / (after - before) as f64
    }
}

/// Interpolates unknown steps between known ones, from the mean of up to `reach` steps before the
/// gap to that of up to `reach` steps after it. Before the first known step and after the last one
/// the body continues with the nearest such mean.
fn bridge(steps: &mut [Option<Planar>], reach: usize) {
    let known = steps.to_vec();
    let mean = |run: &mut dyn Iterator<Item = &Option<Planar>>| {
        let run = run.map_while(|step| *step).take(reach.max(1));
        let (sum, count) = run.fold((Planar::IDENTITY, 0.0), |(sum, count), step| {
            (Planar { yaw: sum.yaw + step.yaw, shift: sum.shift + step.shift }, count + 1.0)
        });
        (count > 0.0).then(|| Planar { yaw: sum.yaw / count, shift: sum.shift / count })
    };
    let mut from = 0;
    while let Some(gap) = known.iter().skip(from).position(Option::is_none) {
        let start = from + gap;
        let end = known.iter().skip(start).position(Option::is_some);
        let end = end.map_or(known.len(), |length| start + length);
        let before = mean(&mut known.iter().take(start).rev());
        let behind = mean(&mut known.iter().skip(end));
        // A body whose feet only touch the ground for a frame has no velocity.
        let (a, b) = (before.or(behind).unwrap_or_default(), behind.or(before).unwrap_or_default());
        let length = (end - start + 1) as f64;
        for (frame, step) in steps.iter_mut().enumerate().take(end).skip(start) {
            let share = (frame - start + 1) as f64 / length;
            *step = Some(Planar {
                yaw: a.yaw + (b.yaw - a.yaw) * share,
                shift: a.shift.lerp(b.shift, share),
            });
        }
        from = end;
    }
}

/// Returns the steps as means over the steps around them, weighted by a triangle of `reach` steps
/// to both sides, because the step of the body changes abruptly when a foot starts or stops
/// carrying it. Unknown steps do not count.
fn smoothed(steps: &[Option<Planar>], reach: usize) -> Vec<Planar> {
    let mean = |frame: usize| {
        let window = frame.saturating_sub(reach)..(frame + reach + 1).min(steps.len());
        let (mut sum, mut total) = (Planar::IDENTITY, 0.0);
        for at in window {
            let weight = (reach + 1 - at.abs_diff(frame)) as f64;
            let step = steps[at].unwrap_or_default();
            sum.yaw += weight * step.yaw;
            sum.shift += weight * step.shift;
            total += weight;
        }
        Planar { yaw: sum.yaw / total, shift: sum.shift / total }
    };
    (0..steps.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::wrap_angle;
    use crate::skeleton::Side;
    use crate::synth::{Action, Params, synthesize};
    use proptest::prelude::*;

    fn made(params: &Params) -> (Clip, Roles, Vec<Planar>) {
        let made = synthesize(params).expect("a motion");
        let roles = Roles::detect(made.clip.skeleton());
        let frames = character_frames(&made.clip, &roles);
        (made.clip, roles, frames)
    }

    fn none() -> ContactCorrections {
        ContactCorrections::default()
    }

    fn put_back(clip: &Clip, roles: &Roles, turns: bool) -> Vec<Planar> {
        let way = root_motion_from_feet(clip, roles, &ContactOptions::default(), &none(), turns)
            .expect("a way");
        assert_eq!(way.world_from_clip.len(), clip.frames());
        assert_eq!(way.contacts.frames(), clip.frames());
        let back = clip.transformed_by_frame(&way.world_from_clip);
        character_frames(&back, roles)
    }

    /// Returns the transform of the last frame relative to the first.
    fn whole(frames: &[Planar]) -> Planar {
        let (first, last) = (frames.first().expect("frames"), frames.last().expect("frames"));
        first.inverse().after(last)
    }

    fn rebuilt(params: &Params) -> (Planar, Planar) {
        let (clip, roles, frames) = made(params);
        let still = clip.transformed_by_frame(&take_in_place(&frames, true));
        (whole(&frames), whole(&put_back(&still, &roles, true)))
    }

    #[test]
    fn clip_in_place_stands_over_the_origin() {
        let (clip, roles, frames) =
            made(&Params { turn_rate_dps: 30.0, ..Params::new(Action::Walk) });
        for turns in [true, false] {
            let moved = clip.transformed_by_frame(&take_in_place(&frames, turns));
            for (before, after) in frames.iter().zip(character_frames(&moved, &roles)) {
                assert!(after.shift.length() < 1e-4, "{after:?}");
                let yaw = if turns { 0.0 } else { before.yaw };
                assert!(wrap_angle(after.yaw - yaw).abs() < 1e-3, "{after:?}");
            }
        }
    }

    #[test]
    fn root_motion_of_made_gaits_is_rebuilt_from_their_feet() {
        for (action, speed_mps, turn_rate_dps) in [
            (Action::Walk, 0.7, 0.0),
            (Action::Walk, 1.3, 0.0),
            (Action::Walk, 2.0, 0.0),
            (Action::Walk, 1.3, 20.0),
            (Action::Run, 3.0, 0.0),
            (Action::Run, 4.5, 0.0),
        ] {
            let params = Params { speed_mps, turn_rate_dps, ..Params::new(action) };
            let (wanted, found) = rebuilt(&params);
            let (way, off) = (wanted.shift.length(), wanted.shift.distance(found.shift));
            let turn = wrap_angle(found.yaw - wanted.yaw).to_degrees();
            let share = if action == Action::Walk { 0.01 } else { 0.07 };
            assert!(off < share * way, "{action:?} at {speed_mps} m/s: {off} m of {way} m");
            assert!(turn.abs() < 1.5, "{action:?} at {speed_mps} m/s: {turn}° off");
        }
    }

    #[test]
    fn root_motion_of_a_clip_with_root_motion_is_rebuilt() {
        let (clip, roles, frames) = made(&Params::new(Action::Walk));
        let (wanted, found) = (whole(&frames), whole(&put_back(&clip, &roles, true)));
        let off = wanted.shift.distance(found.shift);
        assert!(off < 0.01 * wanted.shift.length(), "{off} m of {wanted:?}");
    }

    #[test]
    fn root_motion_of_a_standing_body_is_small() {
        let (_, found) = rebuilt(&Params::new(Action::Idle));
        assert!(found.shift.length() < 0.02 && found.yaw.abs() < 0.03, "{found:?}");
    }

    #[test]
    fn bridge_of_a_flight_continues_evenly() {
        let step = |x: f64| Some(Planar::new(0.1 * x, x, 0.0));
        let mut steps = [None, step(1.0), None, None, step(4.0), None];
        bridge(&mut steps, 1);
        let found: Vec<f64> = steps.iter().map(|step| step.expect("bridged").shift.x).collect();
        assert_eq!(found, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert!((steps[2].expect("bridged").yaw - 0.2).abs() < 1e-12);
    }

    #[test]
    fn smoothed_step_is_spread_over_its_neighbours() {
        let step = |frame| Some(Planar::new(0.0, if frame < 10 { 0.0 } else { 1.0 }, 0.0));
        let steps: Vec<_> = (0..20).map(step).collect();
        let found: Vec<f64> = smoothed(&steps, 3).iter().map(|step| step.shift.x).collect();
        assert_eq!((found[0], found[19]), (0.0, 1.0));
        assert!(found.windows(2).all(|pair| (0.0..=0.251).contains(&(pair[1] - pair[0]))));
        assert!((found.iter().sum::<f64>() - 10.0).abs() < 1e-9, "the distance is kept");
    }

    #[test]
    fn root_motion_of_a_single_frame_is_the_identity() {
        let (clip, roles, _) = made(&Params::new(Action::Walk));
        let one = clip.crop(0..1).expect("a frame");
        let way = root_motion_from_feet(&one, &roles, &ContactOptions::default(), &none(), true)
            .expect("a way");
        let [stays] = way.world_from_clip[..] else { panic!("one frame") };
        assert!(stays.shift.length() < 1e-9 && stays.yaw.abs() < 1e-9, "{stays:?}");
    }

    #[test]
    fn corrected_contacts_carry_the_body_in_place_of_those_that_are_found() {
        let (clip, roles, frames) = made(&Params::new(Action::Walk));
        let still = clip.transformed_by_frame(&take_in_place(&frames, true));
        let put_back = |corrections: &ContactCorrections| {
            root_motion_from_feet(&still, &roles, &ContactOptions::default(), corrections, true)
        };
        let found = put_back(&none()).expect("a way").contacts;
        let late = found.with_end_at(Side::Left, 1, crate::clip::StanceEnd::Strike, usize::MAX);
        let way = put_back(&ContactCorrections::between(&found, &late)).expect("a way");
        assert_eq!(way.contacts, late);
        let nothing = Contacts::from_flags(Side::BOTH.map(|_| vec![false; clip.frames()]));
        let refused = put_back(&ContactCorrections::between(&found, &nothing));
        assert_eq!(refused, Err(RootMotionError::NoContacts));
    }

    #[test]
    fn root_motion_without_feet_is_refused() {
        let (clip, _, _) = made(&Params::new(Action::Walk));
        let refused = root_motion_from_feet(
            &clip,
            &Roles::default(),
            &ContactOptions::default(),
            &none(),
            true,
        );
        assert_eq!(refused, Err(RootMotionError::NoFeet));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]
        /// The position and facing of the clip in place do not change the trajectory.
        #[test]
        fn root_motion_does_not_depend_on_the_position_of_the_clip(
            yaw in -3.0f64..3.0,
            x in -5.0f64..5.0,
            z in -5.0f64..5.0,
        ) {
            let (clip, roles, frames) = made(&Params::new(Action::Walk));
            let still = clip.transformed_by_frame(&take_in_place(&frames, true));
            let there = Planar::new(yaw, x, z);
            let moved = still.transformed(&there);
            let [a, b] = [&still, &moved].map(|clip| whole(&put_back(clip, &roles, true)));
            prop_assert!(a.shift.distance(b.shift) < 0.01, "{a:?} {b:?}");
        }
    }
}
