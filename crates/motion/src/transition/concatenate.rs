//! Transitions between two clips by any method.

use super::moving::View;
use super::{Inertialization, Inertializer, MovingPose};
use crate::blend::{
    AlignBy, Assembly, BlendError, Concatenation, DissolveOptions, RootBlend, WeightLaw,
    alignment_of, check, dissolve, moving_joints,
};
use crate::clip::Motion;
use crate::math::{Planar, quat, unwrap_near, wrap_angle};
use glam::Vec3;
use std::sync::Arc;

/// The method of a transition.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Method {
    /// The next frame is B's.
    Cut,
    /// A fades into B over a window in which both play ([`dissolve`]).
    Dissolve {
        /// Frames that overlap; 0 and 1 are a cut.
        window: usize,
        /// The curve of A's weight.
        law: WeightLaw,
    },
    /// B plays at once, and the difference to A decays ([`Inertializer`]).
    Inertialize(Inertialization),
}

/// Options of a transition.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TransitionOptions {
    /// The method.
    pub method: Method,
    /// Whether B is first aligned with A, in ground position and facing. Without alignment, B stays
    /// at its own position, and roots are joined in the world for any value of `root`.
    pub align: bool,
    /// The features by which it is aligned.
    pub align_by: AlignBy,
    /// The joining of root motion.
    pub root: RootBlend,
}

impl TransitionOptions {
    /// Returns the options with alignment, and with velocities joined in the character's own frame.
    #[must_use]
    pub fn new(method: Method) -> Self {
        Self { method, align: true, align_by: AlignBy::default(), root: RootBlend::Velocity }
    }
}

/// Plays clip A up to its frame `leave`, then clip B from its frame `enter`, with the transition
/// given by `options`.
///
/// The frames have the same meaning for all methods: `A[..leave]` plays unchanged, frame `leave` of
/// the result is the first to which B contributes, and it corresponds to `A[leave]` and `B[enter]`;
/// the result is as long as `A[..leave]` and `B[enter..]` together. A dissolve needs its window of
/// frames after both; the other methods need no frame of A and one of B.
///
/// Inertialization starts from the frame before: the differences of pose and velocity are those
/// between A at `leave - 1` and B at `enter - 1`, each velocity being that of the step into the
/// next frame ([`MovingPose`]), and frame `leave + p` of the result has the rest
/// of them after `(p + 1) / fps` seconds. The frame before the transition is therefore all A, as in
/// a dissolve, and a clip that is entered at the frame where it is left continues unchanged (except
/// for dead blending, which damps it all the same). Before its first frame and after its last one a
/// clip is extrapolated by the adjacent step.
///
/// Poses are joined in the character's frame: rotations, heights, and translations of joints. Over
/// the ground, the velocities (forward, sideways, yaw) are joined and integrated from A's last
/// frame ([`RootBlend::Velocity`]); B then continues from there, without a jump. With
/// [`RootBlend::World`] B is aligned with A at the seam and the root's remaining offset in the
/// world decays like any other; the root then keeps B's own trajectory, but its speed over the
/// ground is neither clip's.
///
/// # Errors
/// [`BlendError`] when the clips have different skeletons or frame rates (retarget or resample
/// first), B has no such frame, a window crosses the end of its clip, or a duration is out of
/// range.
pub fn concatenate(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    options: &TransitionOptions,
) -> Result<Concatenation, BlendError> {
    let (window, law) = match options.method {
        Method::Cut => (0, WeightLaw::default()),
        Method::Dissolve { window, law } => (window, law),
        Method::Inertialize(how) => {
            return inertialize(a, leave, b, enter, how, options, |_, _| {});
        }
    };
    let &TransitionOptions { align, align_by, root, .. } = options;
    let options = DissolveOptions { window, law, align, align_by, root };
    dissolve(a, leave, b, enter, &options)
}

/// Inertializes A into B. `seen` may change the two poses, given the frame rate, before their
/// differences are taken.
pub(super) fn inertialize(
    a: &Motion,
    leave: usize,
    b: &Motion,
    enter: usize,
    how: Inertialization,
    options: &TransitionOptions,
    seen: impl Fn(&mut MovingPose, f64),
) -> Result<Concatenation, BlendError> {
    how.validate()?;
    check(a, leave, b, enter, 0)?;
    let (from, to) = (a.clip(), b.clip());
    let aligned_b = if options.align {
        alignment_of(a, leave.min(from.frames().saturating_sub(1)), b, enter, 0, options.align_by)?
    } else {
        Planar::IDENTITY
    };
    let by_velocity = options.align && options.root == RootBlend::Velocity;
    let moving = moving_joints(from, to);
    let view = |source, fixed: Planar| View {
        source,
        moving: &moving,
        fixed: (!by_velocity).then_some(fixed),
    };
    let (old, new) = (view(a, Planar::IDENTITY), view(b, aligned_b));
    let (mut old_pose, a_stands) = old.before(leave);
    let (mut new_pose, b_stands) = new.before(enter);
    // In the world the ground frame is one more decaying offset, after the translations.
    let mut unwrapped = UnwrappedFrames::new(&a_stands, &aligned_b.after(&b_stands));
    if !by_velocity {
        old_pose.translations.push(unwrapped.of_a);
        new_pose.translations.push(unwrapped.of_b);
        let velocity = |source: &Motion, world: Planar, frame: usize, stands: &Planar| {
            let step = source.step_into(frame.min(source.ground_frames().len().saturating_sub(1)));
            let next = stands.after(&step);
            let (here, there) = (world.after(stands), world.after(&next));
            let shift = (there.shift - here.shift) * source.clip().fps();
            Vec3::new(
                shift.x as f32,
                (wrap_angle(step.yaw) * source.clip().fps()) as f32,
                shift.y as f32,
            )
        };
        old_pose.velocities.push(velocity(a, Planar::IDENTITY, leave, &a_stands));
        new_pose.velocities.push(velocity(b, aligned_b, enter, &b_stands));
    }
    let (fps, rest) = (to.fps(), to.frames() - enter);
    // Rounding must not add a frame for the last digit of a whole number, nor for a duration of 0.
    let frames_in = |secs: f64| (secs * fps - 1e-5).ceil().max(0.0).min(rest as f64) as usize;
    // One frame more, so that nothing is left in the last frame computed.
    let settling = frames_in(how.settling_secs() + fps.recip());
    let carried = old_pose.steady_travel.y - new_pose.steady_travel.y;
    old_pose.steady_travel.y =
        new_pose.steady_travel.y + shared_turn(carried, (a, leave), (b, enter), how, settling);
    seen(&mut old_pose, fps);
    seen(&mut new_pose, fps);
    let mut inertia = Inertializer::new(how);
    inertia.trigger(&old_pose, &new_pose);
    let window = frames_in(how.secs_until(0.01)).min(settling);
    let mut made = Assembly::new(from, to, leave + rest);
    made.play(from, 0..leave);
    let mut frames = a.ground_frames()[..leave].to_vec();
    frames.reserve(rest);
    let mut b_during = Vec::with_capacity(window);
    let (mut here, mut world_from_b) = (a_stands, aligned_b);
    let (mut rotations, mut translations) = (Vec::new(), Vec::new());
    for p in 0..settling {
        let frame = enter + p;
        inertia.advance(fps.recip());
        new.pose_into(frame, &mut rotations, &mut translations);
        if by_velocity {
            inertia.apply(&mut rotations, &mut translations);
            here = here.after(&inertia.step(&b.step_into(frame), fps.recip()));
            world_from_b = here.after(&b.ground_frames()[frame].inverse());
            translations[0] = here.apply(translations[0]);
            rotations[0] = quat::renormalize(here.rotation() * rotations[0]);
        } else {
            translations.push(unwrapped.follow(&aligned_b.after(&b.ground_frames()[frame])));
            inertia.apply(&mut rotations, &mut translations);
            here = translations.pop().map_or(here, UnwrappedFrames::frame);
        }
        frames.push(here);
        if p < window {
            b_during.push(world_from_b);
        }
        made.push(translations[0], &rotations, &translations[1..]);
    }
    made.play_moved(to, enter + settling..to.frames(), &world_from_b);
    frames.extend(
        b.ground_frames()[enter + settling..].iter().map(|frame| world_from_b.after(frame)),
    );
    let half = frames_in(how.secs_until(0.5)).min(window);
    Ok(Concatenation {
        clip: Arc::new(made.finish(format!("{} → {}", from.name(), to.name()))?),
        transition: leave..leave + window,
        enter,
        handover: leave + half.saturating_sub(1),
        aligned_b,
        b_during,
        world_from_b,
        frames,
    })
}

/// Returns the part of a difference of steady yaw rates, `carried` (A's minus B's, rad/s), that is
/// handed over: at most as much as lets the result turn, while the difference decays, as far as the
/// two clips do in that time with their weights. The steady turn of a stride may lie ahead of B or
/// behind A: if it were carried in full, a turn that B is yet to make would first be made the other
/// way round.
fn shared_turn(
    carried: f32,
    (a, leave): (&Motion, usize),
    (b, enter): (&Motion, usize),
    how: Inertialization,
    steps: usize,
) -> f32 {
    let fps = b.clip().fps();
    let frames_of_a = a.ground_frames().len();
    let (mut between, mut weights) = (0.0, 0.0);
    for p in 0..steps {
        let weight = how.remaining((p as f64 + 0.5) / fps);
        // After its end A is extrapolated.
        let in_a = if leave + p < frames_of_a {
            leave + p
        } else {
            (2 * frames_of_a).saturating_sub(leave + p + 1)
        };
        let turn = |source: &Motion, frame: usize| wrap_angle(source.step_into(frame).yaw);
        between += weight * (turn(a, in_a) - turn(b, enter + p));
        weights += weight;
    }
    if weights <= 0.0 {
        return carried;
    }
    let between = (between / weights * fps) as f32;
    carried.clamp(between.min(0.0), between.max(0.0))
}

/// Ground frames as vectors (x, yaw, z) with unwrapped yaw.
struct UnwrappedFrames {
    of_a: Vec3,
    of_b: Vec3,
    yaw: f64,
}

impl UnwrappedFrames {
    /// Begins with frames `a` and `b`, which are less than half a turn apart.
    fn new(a: &Planar, b: &Planar) -> Self {
        let vector = |frame: &Planar, yaw: f64| {
            Vec3::new(frame.shift.x as f32, yaw as f32, frame.shift.y as f32)
        };
        Self { of_a: vector(a, unwrap_near(a.yaw, b.yaw)), of_b: vector(b, b.yaw), yaw: b.yaw }
    }

    /// Returns the next frame of B as a vector.
    fn follow(&mut self, b: &Planar) -> Vec3 {
        self.yaw = unwrap_near(b.yaw, self.yaw);
        Vec3::new(b.shift.x as f32, self.yaw as f32, b.shift.y as f32)
    }

    fn frame(vector: Vec3) -> Planar {
        Planar::new(wrap_angle(f64::from(vector.y)), f64::from(vector.x), f64::from(vector.z))
    }
}

#[cfg(test)]
mod tests;
