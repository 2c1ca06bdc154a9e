//! The positions of the panes' cameras.

use crate::context::{DrawContext, PosedResult};
use crate::framing::{camera_of, middle_height};
use crate::{Camera, CameraRig, Pane};
use glam::Vec3;
use segue_motion::math::Planar;
use segue_motion::skeleton::Role;
use segue_session::choices::Follow;
use segue_session::{Key, Slot, joint_of};
use std::sync::Arc;

/// Half-life with which a camera that follows no character approaches a new view, seconds.
const VIEW_HALF_LIFE_SECS: f32 = 0.06;
/// The distance within one frame from which a camera cuts to the followed character instead of
/// moving there, metres in the parameters' size: the motion has started again.
const CUT_METRES: f32 = 1.5;

/// The target of a pane's camera.
pub(super) struct Aim {
    /// The point that it follows; `None` where it follows none.
    pub(super) followed: Option<Vec3>,
    /// The target where it follows none.
    pub(super) rest: Vec3,
    /// Metres in the size of the motion per metre of the parameters.
    pub(super) scale: f32,
}

/// Advances a pane's camera towards the view of the parameters: at the followed point, or at the
/// resting target.
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
    ) * aim.scale;
    let goal =
        Camera { target: aim.followed.unwrap_or(aim.rest) + pan, ..camera_of(params, aim.scale) };
    let first = *rig == CameraRig::default();
    if context.highlights.path.is_held && !first {
        // The ground must not move while the user drags on it.
        pane.camera = *rig.camera();
        pane.focus = rig.goal.target.with_y(0.0);
        return;
    }
    let cut = goal.target.distance(rig.goal.target) > CUT_METRES * aim.scale;
    rig.goal = goal;
    if first || cut {
        rig.jump();
    } else {
        let half_life = if aim.followed.is_some() {
            params.number(Key::FollowHalfLife) as f32
        } else {
            VIEW_HALF_LIFE_SECS
        };
        // The user's turns and zooms apply at once; only the followed point is smoothed.
        rig.update(half_life, dt_secs);
        rig.turn_at_once();
    }
    pane.camera = *rig.camera();
    pane.focus = goal.target.with_y(0.0);
}

/// Returns the point of the figure that the camera follows; `None` where it follows none.
pub(super) fn followed_point(
    shown: &PosedResult<'_>,
    context: &mut DrawContext<'_>,
) -> Option<Vec3> {
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
    let (motion, body, world) = match source {
        // The result is followed if the wanted character is not on the stage.
        None => match other.flatten() {
            None => (&outcome.motion, Arc::clone(&shown.body), shown.world.clone()),
            Some(motion) => {
                let (body, world) =
                    context.figure(motion, session.now_secs(), &Planar::IDENTITY)?;
                (motion, body, world)
            }
        },
        Some(source) => {
            let (at, world_from_clip) = (outcome.source_at(source, shown.now))
                .unwrap_or((shown.now - source.starts_at_secs, source.world_from_clip));
            let place = shown.place.after(&world_from_clip);
            let (body, world) = context.figure(&source.motion, at, &place)?;
            (&source.motion, body, world)
        }
    };
    let joint = joint_of(motion, params.text(Key::FollowJoint)).unwrap_or(0);
    let point = *world.positions.get(body.drawn_joint(joint))?;
    let hips = motion.roles().get(Role::Hips).unwrap_or(0);
    // A view that bobs with every step is unpleasant: hips are followed over the ground, at a
    // constant height.
    Some(if joint == hips { point.with_y(middle_height(motion)) } else { point })
}
