use crate::blend::MAX_SECS;
use crate::clip::{Clip, ClipError, Contacts};
use crate::math::{curve, quat};
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Role, Roles, Side, Skeleton, WorldPose, two_bone_ik};
use glam::{Mat3, Quat, Vec3};
use std::ops::Range;
use std::sync::Arc;

mod anchor;
mod envelope;
mod hips;

/// How feet are planted. Lengths are those of a character 1.75 m tall and are scaled to the clip's
/// character.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FootLockOptions {
    /// Seconds over which a foot leaves its own way before a stance, and comes back to it after
    /// one; less where the next stance is nearer.
    pub blend_secs: f64,
    /// How far a foot may be moved over the ground, metres. The correction bends towards this limit
    /// from its half on; what is beyond it slides as before. A foot that is said to stand while it
    /// swings would tear the leg otherwise.
    pub max_shift_m: f32,
    /// The height of the ground, metres: planted feet are lifted out of it. `None` leaves heights
    /// as they are.
    pub ground_m: Option<f32>,
    /// How high above where it stands a foot is that swings, metres: what is lower scrapes over the
    /// ground, and is lifted. People clear it by 1 to 2 cm with their toes (Winter 1992, "The foot
    /// trajectory in human gait"); a little more is not seen as sliding. `None` leaves swings as
    /// they are.
    pub clearance_m: Option<f32>,
}

impl Default for FootLockOptions {
    fn default() -> Self {
        Self { blend_secs: 0.2, max_shift_m: 0.3, ground_m: Some(0.0), clearance_m: Some(0.025) }
    }
}

/// Why feet cannot be planted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FootLockError {
    /// No leg of thigh, shin and foot, one below the other.
    #[error(
        "this skeleton has no leg with thigh, shin and foot: choose these joints by hand to lock its feet"
    )]
    NoLegs,
    /// The contacts are those of another clip.
    #[error(
        "the contacts are known for {contacts} frames, but the clip has {frames}: detect them on this clip"
    )]
    Contacts {
        /// Frames of the contacts.
        contacts: usize,
        /// Frames of the clip.
        frames: usize,
    },
    /// A number that is none.
    #[error("a {what} of {value} cannot be used: give a number from 0 to {most}")]
    Option {
        /// Which option.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The largest number.
        most: f64,
    },
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// A leg is not stretched beyond this flexion of the knee, unless the clip itself does so: near
/// full stretch the knee would snap. A leg of bones `a` and `b` that becomes longer by `d` turns
/// its knee by `d l / (a b sin φ)`: 1.2° a millimetre here on a leg of 0.85 m, and the hips are
/// lowered by 5 mm more than for a straight leg.
const MIN_FLEXION_RADIANS: f32 = 0.22;
/// Below this sine of the flexion the knee's own plane is uncertain, and the leg's usual plane
/// takes over.
const PLANE_SINE: f32 = 0.2;

/// Plants the feet: while `contacts` say that a foot is on the ground, it does not slide.
///
/// *What is held.* In every step between two planted frames the point of the foot (ball, tip, or
/// ankle; the ankle alone where there are no toes) that moves least over the ground is the one that
/// stands. The foot is moved so that it stands exactly; the foot's own turning stays, so it still
/// rolls from heel to ball to tip, and stays as flat as in the clip. Over a stance this fixes the
/// foot's place up to a constant, which is chosen so that the correction vanishes where the foot is
/// stillest: a mean over the stance with weights of inverse squared speed. What is below the ground
/// is lifted out of it. Before and behind a stance the correction dies away with its own velocity
/// ([`Decay::Cubic`](crate::math::Decay)), so that a foot does not jerk off the ground.
///
/// *What is lifted.* Where the foot swings from one stance to the next, each of its points is
/// brought [`FootLockOptions::clearance_m`] above the height that it has in these, smoothly, while
/// it goes faster than a slow step. Between two motions a foot may pass the ground lower than in
/// either.
///
/// *How the leg follows.* Thigh and shin are turned about the knee's own axis to bring the ankle to
/// its place, then the leg is swung the shortest way ([`two_bone_ik`]); joints between hip, knee and
/// ankle keep their local rotations. Only the *difference* to how the leg was is applied, so that
/// the knee keeps its plane, also when it is nearly straight.
///
/// *How the hips help.* A nearly straight leg has to bend a lot to become a little shorter, and
/// cannot become longer. The hips are raised or lowered to where both knees change least (least
/// squares of the change of flexion), smoothed, and lowered further where a leg would have to
/// stretch past its reach; where even that does not help, the foot slides.
///
/// Frames where nothing needs to be corrected stay exactly as they are. Cost: O(frames × joints),
/// one pass of forward kinematics.
///
/// # Errors
/// [`FootLockError`] when there are no legs, the contacts do not fit the clip, or an option is out
/// of range.
pub fn foot_lock(
    clip: &Clip,
    roles: &Roles,
    contacts: &Contacts,
    options: &FootLockOptions,
) -> Result<Clip, FootLockError> {
    let mut state = State::new(clip, roles, contacts, options)?;
    while state.advance(clip, clip.frames()) {}
    state.finish(clip)
}

/// Whether a skeleton has a leg of thigh, shin and foot, one below the other: feet of others cannot
/// be planted.
#[must_use]
pub fn has_legs(skeleton: &Skeleton, roles: &Roles) -> bool {
    Side::BOTH.into_iter().any(|side| Leg::find(skeleton, roles, side).is_some())
}

/// [`foot_lock`] in slices, for clips that take longer than there is time for at once.
#[derive(Debug)]
pub struct FootLocking {
    clip: Arc<Clip>,
    state: State,
}

impl FootLocking {
    /// Nothing is done yet: call [`advance`](Self::advance).
    ///
    /// # Errors
    /// As [`foot_lock`].
    pub fn new(
        clip: Arc<Clip>,
        roles: &Roles,
        contacts: &Contacts,
        options: &FootLockOptions,
    ) -> Result<Self, FootLockError> {
        let state = State::new(&clip, roles, contacts, options)?;
        Ok(Self { clip, state })
    }

    /// Says by how much the whole body was turned in every frame, as on a path that was bent,
    /// radians; frames without a number were not. A foot that stands does not turn with it over the
    /// ground: in its stances it is turned back, by up to 30°, about the vertical. Its own turning
    /// stays.
    ///
    /// To be said before the first [`advance`](Self::advance).
    #[must_use]
    pub fn with_body_yaws(mut self, yaws_radians: &[f64]) -> Self {
        self.state.body_yaws = yaws_radians.to_vec();
        self
    }

    /// Goes on by so many frames (at least one). `false` when nothing is left to do. A frame of 31
    /// joints takes 2 µs, in each of two passes.
    pub fn advance(&mut self, frames: usize) -> bool {
        self.state.advance(&self.clip, frames)
    }

    /// How much is done, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f32 {
        let frames = self.clip.frames().max(1) as f32;
        let turned = self.state.plan.as_ref().map_or(0, |plan| plan.turned);
        (self.state.posed_frames() + turned) as f32 / (2.0 * frames)
    }

    /// The clip with planted feet; what is not done yet is done now.
    ///
    /// # Errors
    /// As [`foot_lock`].
    pub fn finish(mut self) -> Result<Clip, FootLockError> {
        while self.advance(self.clip.frames()) {}
        self.state.finish(&self.clip)
    }
}

/// What is known of a clip whose feet are being planted.
#[derive(Debug)]
struct State {
    options: FootLockOptions,
    scale: f32,
    stances: Vec<Vec<Range<usize>>>,
    legs: Vec<Leg>,
    feet: Vec<anchor::Foot>,
    posed: Vec<Vec<Posed>>,
    body_yaws: Vec<f64>,
    /// Made when all frames are posed.
    plan: Option<Plan>,
}

/// How far everything is moved, and what came of it so far.
#[derive(Debug)]
struct Plan {
    shifts: Vec<Vec<Vec3>>,
    /// Turns of the feet, rotation vectors.
    turns: Vec<Vec<Vec3>>,
    heights: Vec<f32>,
    axes: Vec<Vec3>,
    rotations: Vec<Quat>,
    /// Frames that are done.
    turned: usize,
    /// All feet stand as they are.
    is_idle: bool,
}

impl State {
    fn new(
        clip: &Clip,
        roles: &Roles,
        contacts: &Contacts,
        options: &FootLockOptions,
    ) -> Result<Self, FootLockError> {
        let check = |what, value: f64, most: f64| {
            let fits = (0.0..=most).contains(&value);
            if fits { Ok(()) } else { Err(FootLockError::Option { what, value, most }) }
        };
        check("blend time (s)", options.blend_secs, MAX_SECS)?;
        check("largest shift (m)", f64::from(options.max_shift_m), 10.0)?;
        check("clearance (m)", f64::from(options.clearance_m.unwrap_or(0.0)), 1.0)?;
        let sides = Side::BOTH.into_iter();
        let (sides, legs): (Vec<Side>, Vec<Leg>) =
            sides.filter_map(|side| Some((side, Leg::find(clip.skeleton(), roles, side)?))).unzip();
        if legs.is_empty() {
            return Err(FootLockError::NoLegs);
        }
        if contacts.frames() != clip.frames() {
            let (contacts, frames) = (contacts.frames(), clip.frames());
            return Err(FootLockError::Contacts { contacts, frames });
        }
        Ok(Self {
            options: *options,
            scale: roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M as f32,
            stances: sides.iter().map(|side| contacts.intervals(*side)).collect(),
            feet: (sides.iter().zip(&legs))
                .map(|(side, leg)| anchor::Foot::new(clip, roles, *side, leg.joints[2]))
                .collect(),
            posed: legs.iter().map(|_| Vec::with_capacity(clip.frames())).collect(),
            body_yaws: Vec::new(),
            legs,
            plan: None,
        })
    }

    fn posed_frames(&self) -> usize {
        self.posed.first().map_or(0, Vec::len)
    }

    /// Goes on by so many frames. `false` when nothing is left to do.
    fn advance(&mut self, clip: &Clip, frames: usize) -> bool {
        let (posed, last) = (self.posed_frames(), clip.frames());
        let end = |done: usize| done.saturating_add(frames.max(1)).min(last);
        if posed < last {
            self.pose(clip, posed..end(posed));
            return true;
        }
        let Some(plan) = &mut self.plan else {
            self.plan = Some(self.plan(clip));
            return true;
        };
        if plan.is_idle || plan.turned >= last {
            return false;
        }
        for frame in plan.turned..end(plan.turned) {
            let first = plan.rotations.len();
            plan.rotations.extend_from_slice(clip.rotations(frame));
            let (local, height) = (&mut plan.rotations[first..], plan.heights[frame]);
            for (index, leg) in self.legs.iter().enumerate() {
                let (shift, turn) = (plan.shifts[index][frame], plan.turns[index][frame]);
                if shift != Vec3::ZERO || turn != Vec3::ZERO || height != 0.0 {
                    let [upper, lower] =
                        self.posed[index][frame].turned(shift - Vec3::Y * height, plan.axes[index]);
                    let turns = [upper, lower, Quat::from_scaled_axis(turn)];
                    leg.write(&self.posed[index][frame], turns, local);
                }
            }
        }
        plan.turned = end(plan.turned);
        true
    }

    fn pose(&mut self, clip: &Clip, frames: Range<usize>) {
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_into(frame, &mut world);
            for ((leg, posed), foot) in self.legs.iter().zip(&mut self.posed).zip(&mut self.feet) {
                posed.push(leg.pose(&world));
                foot.push(&world);
            }
        }
    }

    fn plan(&self, clip: &Clip) -> Plan {
        let corrections = self.stances.iter().zip(&self.feet).map(|(stances, foot)| {
            let stances = foot.parted(stances, clip.fps(), self.scale);
            let turns = foot.turns(&stances, &self.body_yaws, clip.fps(), &self.options);
            let shifts =
                |foot: &anchor::Foot| foot.shifts(&stances, clip.fps(), self.scale, &self.options);
            let stays = turns.iter().all(|turn| *turn == Vec3::ZERO);
            (if stays { shifts(foot) } else { shifts(&foot.turned(&turns)) }, turns)
        });
        let (shifts, turns): (Vec<Vec<Vec3>>, Vec<Vec<Vec3>>) = corrections.unzip();
        let is_idle = shifts.iter().chain(&turns).flatten().all(|value| *value == Vec3::ZERO);
        Plan {
            heights: hips::heights(&self.posed, &shifts, clip.fps()),
            axes: self.posed.iter().map(|posed| usual_axis(posed)).collect(),
            rotations: Vec::with_capacity(if is_idle {
                0
            } else {
                clip.frames() * clip.skeleton().len()
            }),
            turned: 0,
            shifts,
            turns,
            is_idle,
        }
    }

    fn finish(self, clip: &Clip) -> Result<Clip, FootLockError> {
        let Some(plan) = self.plan.filter(|plan| !plan.is_idle) else {
            return Ok(clip.clone());
        };
        let mut roots = clip.root_translations().to_vec();
        for (root, height) in roots.iter_mut().zip(&plan.heights) {
            root.y += height;
        }
        let locked =
            Clip::new(clip.name(), clip.skeleton().clone(), clip.fps(), plan.rotations, roots)?;
        Ok(locked
            .with_translations(clip.translations().to_vec())?
            .with_provenance(clip.provenance()))
    }
}

/// The joints of a leg, and their parents.
#[derive(Clone, Debug)]
pub(crate) struct Leg {
    joints: [usize; 3],
    parents: [usize; 3],
}

/// A leg of the clip in one frame, in the world.
#[derive(Clone, Copy, Debug)]
struct Posed {
    /// Hip to knee, and knee to ankle.
    thigh: Vec3,
    shin: Vec3,
    rotations: [Quat; 3],
    parents: [Quat; 3],
}

impl Leg {
    /// `None` where thigh, shin and foot are not one below the other.
    pub(crate) fn find(skeleton: &Skeleton, roles: &Roles, side: Side) -> Option<Self> {
        let [thigh, shin, foot, _] =
            Role::leg(side).map(|role| roles.get_within(role, skeleton.len()));
        let joints = [thigh?, shin?, foot?];
        let above = |joint: usize, wanted: usize| {
            std::iter::successors(skeleton.parent(joint), |&j| skeleton.parent(j))
                .any(|j| j == wanted)
        };
        let [Some(a), Some(b), Some(c)] = joints.map(|joint| skeleton.parent(joint)) else {
            return None;
        };
        let chain = above(joints[1], joints[0]) && above(joints[2], joints[1]);
        let rest = skeleton.rest_positions();
        let bones = [0, 1].map(|bone| rest[joints[bone]].distance(rest[joints[bone + 1]]));
        (chain && bones.iter().all(|length| *length > 1e-3))
            .then_some(Self { joints, parents: [a, b, c] })
    }

    /// Thigh, shin and foot.
    pub(crate) fn joints(&self) -> [usize; 3] {
        self.joints
    }

    /// The axis about which this knee bends over some poses, in the thigh's frame.
    pub(crate) fn usual_axis<'a>(&self, worlds: impl Iterator<Item = &'a WorldPose>) -> Vec3 {
        usual_axis(&worlds.map(|world| self.pose(world)).collect::<Vec<_>>())
    }

    /// Moves the ankle by `shift` (metres, world) as [`foot_lock`] does, the hips staying where
    /// they are: writes the local rotations of thigh, shin and foot. `world` is the pose before; it
    /// may hold these joints and their ancestors alone.
    pub(crate) fn move_ankle(
        &self,
        world: &WorldPose,
        shift: Vec3,
        usual_axis: Vec3,
        local: &mut [Quat],
    ) {
        let posed = self.pose(world);
        let [upper, lower] = posed.turned(shift, usual_axis);
        self.write(&posed, [upper, lower, Quat::IDENTITY], local);
    }

    /// By how much the hips are too high for this leg when its ankle is moved by `shift`, metres.
    pub(crate) fn too_high(&self, world: &WorldPose, shift: Vec3) -> f32 {
        hips::too_high(std::iter::once((&self.pose(world), shift)), 0.0)
    }

    fn pose(&self, world: &WorldPose) -> Posed {
        let [hip, knee, ankle] = self.joints.map(|joint| world.positions[joint]);
        Posed {
            thigh: knee - hip,
            shin: ankle - knee,
            rotations: self.joints.map(|joint| world.rotations[joint]),
            parents: self.parents.map(|joint| world.rotations[joint]),
        }
    }

    /// Local rotations after thigh, shin and foot were turned in the world, each by its own.
    fn write(&self, posed: &Posed, [upper, lower, own]: [Quat; 3], local: &mut [Quat]) {
        let [thigh, shin, foot] = self.joints;
        let (rotations, parents) = (posed.rotations, posed.parents);
        local[thigh] = quat::renormalize(parents[0].conjugate() * upper * rotations[0]);
        local[shin] = quat::renormalize((upper * parents[1]).conjugate() * lower * rotations[1]);
        local[foot] = quat::renormalize((lower * parents[2]).conjugate() * own * rotations[2]);
    }
}

impl Posed {
    fn line(&self) -> Vec3 {
        self.thigh + self.shin
    }

    /// The area that the bones span, which points along the axis that the knee is bent about, over
    /// both lengths: the sine of the flexion.
    fn bend(&self) -> Vec3 {
        self.thigh.cross(self.shin) / (self.thigh.length() * self.shin.length()).max(1e-9)
    }

    /// How long this leg may become.
    fn reach(&self) -> f32 {
        let (a, b) = (self.thigh.length(), self.shin.length());
        let reach = (a * a + b * b + 2.0 * a * b * MIN_FLEXION_RADIANS.cos()).sqrt();
        reach.max(self.line().length())
    }

    /// World turns of thigh and shin that move the ankle by `shift` against the hip.
    ///
    /// `usual_axis` is the axis of the knee in the thigh's frame. Where the leg is not bent in one
    /// plane about the axis used, or the knee is bent the wrong way, a difference of angles does
    /// not quite reach; what is missing is asked for once more.
    fn turned(&self, shift: Vec3, usual_axis: Vec3) -> [Quat; 2] {
        let (a, b) = (self.thigh.length(), self.shin.length());
        let bend = self.bend();
        let usual = self.rotations[0] * usual_axis;
        // A knee that is bent the wrong way has no plane of its own either.
        let own = curve::smoothstep(bend.dot(usual) / PLANE_SINE);
        let line = self.line();
        let axis = bend * own + usual * PLANE_SINE * (1.0 - own);
        let from = two_bone_ik(line, a, b, axis);
        let wanted = (line + shift).clamp_length_max(self.reach());
        let mut asked = wanted;
        let mut turns = [Quat::IDENTITY; 2];
        for _ in 0..3 {
            let swing = quat::between_directions(line, asked);
            let to = two_bone_ik(asked, a, b, swing * from.hinge);
            turns = [(from.upper, to.upper), (from.lower, to.lower)].map(|(bone, turned)| {
                quat::renormalize(basis(turned, to.hinge) * basis(bone, from.hinge).conjugate())
            });
            let missing = wanted - (turns[0] * self.thigh + turns[1] * self.shin);
            if missing.length_squared() < 1e-10 {
                break;
            }
            asked = (asked + missing).clamp_length_max(self.reach());
        }
        turns
    }
}

/// The rotation that takes X to `hinge` and Y to `bone`, unit vectors square to each other.
fn basis(bone: Vec3, hinge: Vec3) -> Quat {
    Quat::from_mat3(&Mat3::from_cols(hinge, bone, hinge.cross(bone)))
}

/// The axis about which a knee bends over the whole clip, in the thigh's frame; bent frames count
/// more.
fn usual_axis(posed: &[Posed]) -> Vec3 {
    let sum: Vec3 = posed.iter().map(|posed| posed.rotations[0].conjugate() * posed.bend()).sum();
    // A clip of straight legs: across the body, which at rest faces +Z.
    sum.try_normalize().unwrap_or(Vec3::X)
}

#[cfg(test)]
mod tests;
