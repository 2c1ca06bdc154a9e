//! Where the cameras of the panes go.

use crate::context::{DrawContext, Shown};
use crate::framing::{camera_of, middle_height};
use crate::{Camera, CameraRig, Pane, pose_at};
use glam::Vec3;
use segue_motion::math::Planar;
use segue_motion::skeleton::Role;
use segue_session::choices::Follow;
use segue_session::{Key, Slot, joint_of};

/// Half-life with which a camera that follows nothing comes to a new view, seconds.
const VIEW_HALF_LIFE_SECS: f32 = 0.06;
/// The camera cuts to a followed character that jumped farther than this (a loop began again), and
/// does not chase it.
const CUT_METRES: f32 = 1.5;

/// What the camera of a pane is aimed at.
pub(super) struct Aim {
    /// The point that it follows; `None` when it follows nothing.
    pub(super) followed: Option<Vec3>,
    /// Where it rests otherwise.
    pub(super) rest: Vec3,
    /// How many times as large as its motion the figure is shown.
    pub(super) shown_size: f32,
}

/// Moves a pane's camera on to where the parameters want it: after the followed point, or to where
/// it rests.
pub(super) fn aim(
    rig: &mut CameraRig,
    aim: &Aim,
    context: &DrawContext<'_>,
    dt_secs: f32,
    pane: &mut Pane,
) {
    let params = context.params;
    let pan = Vec3::new(
        params.number(Key::PanX) as f32,
        params.number(Key::PanY) as f32,
        params.number(Key::PanZ) as f32,
    ) / aim.shown_size;
    let goal = Camera {
        target: aim.followed.unwrap_or(aim.rest) + pan,
        ..camera_of(params, aim.shown_size)
    };
    let first = *rig == CameraRig::default();
    if context.highlights.path.is_held && !first {
        // The ground must not move under the hand.
        pane.camera = *rig.camera();
        pane.focus = rig.goal.target.with_y(0.0);
        return;
    }
    let cut = goal.target.distance(rig.goal.target) > CUT_METRES;
    rig.goal = goal;
    if first || cut {
        rig.jump();
    } else {
        let half_life = if aim.followed.is_some() {
            params.number(Key::FollowHalfLife) as f32
        } else {
            VIEW_HALF_LIFE_SECS
        };
        // The hand turns and zooms at once; only what the camera follows is smoothed.
        rig.update(half_life, dt_secs);
        rig.turn_at_once();
    }
    pane.camera = *rig.camera();
    pane.focus = goal.target.with_y(0.0);
}

/// Returns the point of the figure that the camera stays with; `None` when it follows nothing.
pub(super) fn followed_point(shown: &Shown<'_>, context: &mut DrawContext<'_>) -> Option<Vec3> {
    let (session, params, outcome) = (context.session, context.params, shown.outcome);
    let wanted = match params.choice::<Follow>() {
        Follow::Off => return None,
        Follow::A => Some(Slot::A),
        Follow::B => Some(Slot::B),
        Follow::Result | Follow::Other => None,
    };
    let source = outcome.sources.iter().find(|source| Some(source.slot) == wanted);
    let other = (params.choice::<Follow>() == Follow::Other).then(|| {
        let place = (params.number(Key::FollowOther) as usize).saturating_sub(1);
        session.extra_characters().get(place)?.motion.as_ref().ok()
    });
    let source_pose;
    let (motion, world) = match source {
        // A character that is not on the stage is not followed; the result is, in its place.
        None => match other.flatten() {
            None => (&outcome.motion, &shown.world),
            Some(motion) => {
                source_pose = pose_at(motion, session.now_secs(), &Planar::IDENTITY)?;
                (motion, &source_pose)
            }
        },
        Some(source) => {
            let (at, world_from_clip) = (outcome.source_at(source, shown.now))
                .unwrap_or((shown.now - source.starts_at_secs, source.world_from_clip));
            source_pose = pose_at(&source.motion, at, &shown.place.after(&world_from_clip))?;
            (&source.motion, &source_pose)
        }
    };
    let body = context.bodies.body(motion);
    let joint = joint_of(motion, params.text(Key::FollowJoint)).unwrap_or(0);
    let point = *body.drawn_pose(world).positions.get(body.drawn_joint(joint))?;
    let hips = motion.roles().get(Role::Hips).unwrap_or(0);
    // Bobbing with every step makes an audience seasick: hips are followed over the ground, at the
    // height of a standing body's middle.
    Some(if joint == hips { point.with_y(middle_height(motion)) } else { point })
}
