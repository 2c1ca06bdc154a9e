//! Joints that are chosen on the figure with the pointer.

use crate::ui::kit;
use crate::ui::language::{Text, Word};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use crate::ui::theme::{palette_of, theme_of};
use eframe::egui::{CursorIcon, PointerButton, Pos2, Rect, Response, Stroke, Ui, vec2};
use glam::{Vec2, Vec3};
use segue_motion::skeleton::{Role, Skeleton};
use segue_scene::Camera;
use segue_session::{Key, Session, Value, joint_of, word_of_joint};

/// The distance within which a joint is the one that is meant, whatever bone is nearer, points.
const AT_JOINT: f32 = 12.0;
/// The greatest distance from a joint or a bone, points.
const REACH: f32 = 24.0;
/// Joints whose distances from the pointer differ by less than this are told apart by their depth,
/// points.
const ALIKE: f32 = 5.0;
/// Radius of the ring around the joint under the pointer, points.
const RING: f32 = 7.0;

/// Marks and names the joint under the pointer, and chooses it by a click. A click beside the
/// figure takes the mark of the chosen joint away.
pub(super) fn pick_ui(
    session: &Session,
    shown: &[(usize, Rect)],
    response: &Response,
    state: &mut UiState,
    out: &mut Out,
    ui: &Ui,
) {
    let pointer = response.interact_pointer_pos().or(response.hover_pos());
    // A drag moves the camera.
    let Some(pos) = pointer.filter(|_| !response.dragged() && state.drawing.is_none()) else {
        return;
    };
    let is_clicked = response.clicked_by(PointerButton::Primary);
    let Some(&(index, rect)) = shown.iter().find(|(_, rect)| rect.contains(pos)) else {
        return;
    };
    let outcome = session.panes().get(index).and_then(|pane| pane.outcome.as_ref());
    let camera = state.cameras.get(index).copied().flatten();
    let (Some(outcome), Some(camera), Some(figure)) = (outcome, camera, state.figures.get(index))
    else {
        return;
    };
    let motion = &outcome.motion;
    let picture = Picture::new(&camera, rect, figure, motion.clip().skeleton());
    let Some(joint) = picture.joint_at(pos) else {
        state.joint_marked &= !is_clicked;
        return;
    };
    let word = word_of_joint(motion, joint);
    if is_clicked {
        state.joint_marked = true;
        // Another name of the same joint changes nothing.
        if joint_of(motion, session.params().text(Key::Joint)) != Some(joint) {
            out.set_once(Key::Joint, Value::Text(word.to_owned()));
        }
    }
    // Fingers cover what they touch.
    if ui.input(eframe::egui::InputState::any_touches) {
        return;
    }
    ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    if let Some(at) = picture.places.get(joint).copied().flatten() {
        let (theme, palette) = (theme_of(ui), palette_of(ui));
        let painter = ui.painter_at(rect);
        painter.circle_stroke(at.on_page, RING, Stroke::new(3.5 * theme.scale(), palette.panel));
        painter.circle_stroke(at.on_page, RING, Stroke::new(1.5 * theme.scale(), palette.accent));
    }
    let role = Role::ALL.into_iter().find(|role| role.name() == word);
    let name = role.map_or(Text::Data(word), |role| Word::new(role.name()).into());
    kit::pointer_label_ui(name, pos, rect, ui);
}

/// A joint in the picture.
#[derive(Clone, Copy, Debug)]
struct Place {
    on_page: Pos2,
    /// Distance from the camera along its axis, metres.
    depth: f32,
}

/// A figure in the picture of a pane.
struct Picture<'a> {
    skeleton: &'a Skeleton,
    /// The joints; `None` behind the camera.
    places: Vec<Option<Place>>,
}

impl<'a> Picture<'a> {
    /// Projects the joints of a figure: their positions in the world, in the order of the skeleton.
    fn new(camera: &Camera, rect: Rect, figure: &[Vec3], skeleton: &'a Skeleton) -> Self {
        let [_, _, back] = camera.axes();
        let size = Vec2::new(rect.width(), rect.height());
        let place = |&point: &Vec3| {
            let at = camera.project(point, size)?;
            let depth = (camera.eye() - point).dot(back);
            Some(Place { on_page: rect.min + vec2(at.x, at.y), depth })
        };
        Self { skeleton, places: figure.iter().map(place).collect() }
    }

    /// Returns the joint that is meant by a point of the page: the nearest one, of several alike
    /// the foremost; beside all joints, the nearer end of the nearest bone. `None` beside the
    /// figure.
    fn joint_at(&self, pos: Pos2) -> Option<usize> {
        let joints =
            || self.places.iter().enumerate().filter_map(|(joint, at)| Some((joint, (*at)?)));
        let near = joints().map(|(joint, at)| (joint, at.on_page.distance(pos), at.depth));
        let at_joint = foremost(near.clone().filter(|(_, off, _)| *off <= AT_JOINT));
        at_joint.or_else(|| {
            let bones = joints().filter_map(|(joint, at)| {
                let parent = self.skeleton.parent(joint)?;
                let start = self.places.get(parent).copied().flatten()?;
                let bone = at.on_page - start.on_page;
                let along = (pos - start.on_page).dot(bone) / bone.length_sq().max(1e-6);
                let along = along.clamp(0.0, 1.0);
                let off = (start.on_page + bone * along).distance(pos);
                let end = if along < 0.5 { parent } else { joint };
                Some((end, off, start.depth + (at.depth - start.depth) * along))
            });
            foremost(near.chain(bones).filter(|(_, off, _)| *off <= REACH))
        })
    }
}

/// Returns of joints with their distances from the pointer and from the camera the one that is
/// nearest to the pointer; of several alike, the nearest to the camera.
fn foremost(joints: impl Iterator<Item = (usize, f32, f32)> + Clone) -> Option<usize> {
    let least = joints.clone().map(|(_, off, _)| off).min_by(f32::total_cmp)?;
    let alike = joints.filter(|(_, off, _)| *off <= least + ALIKE);
    alike.min_by(|one, other| one.2.total_cmp(&other.2)).map(|(joint, _, _)| joint)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;
    use segue_motion::clip::Motion;
    use segue_motion::synth::{Action, Params, synthesize};
    use segue_scene::Lens;

    #[test]
    fn joints_are_picked_at_their_places_and_bones_at_their_nearer_end() {
        let motion =
            Motion::analyze(synthesize(&Params::new(Action::Idle)).expect("a motion").clip);
        let (skeleton, world) = (motion.clip().skeleton(), motion.clip().world_pose(0));
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 1600.0));
        let camera = Camera { yaw: 0.0, pitch: 0.0, distance: 4.0, ..Camera::default() };
        for lens in [Lens::Perspective, Lens::Orthographic] {
            let camera = Camera { lens, ..camera };
            let picture = Picture::new(&camera, rect, &world.positions, skeleton);
            let at = |role: Role| {
                let joint = motion.roles().get(role).expect("a role");
                (joint, picture.places[joint].expect("in sight").on_page)
            };
            let roles = [Role::Head, Role::LeftHand, Role::RightFoot, Role::LeftShin];
            for role in roles {
                let (joint, place) = at(role);
                assert_eq!(picture.joint_at(place), Some(joint), "{role:?}");
            }
            let (knee, from) = at(Role::LeftShin);
            let (ankle, to) = at(Role::LeftFoot);
            assert!(from.distance(to) > 4.0 * AT_JOINT);
            assert_eq!(picture.joint_at(from.lerp(to, 0.35)), Some(knee));
            assert_eq!(picture.joint_at(from.lerp(to, 0.65)), Some(ankle));
            let (_, head) = at(Role::Head);
            assert_eq!(picture.joint_at(head + vec2(200.0, 0.0)), None);
        }
    }

    #[test]
    fn foremost_of_joints_alike_is_picked() {
        let joints = [(0, 3.0, 5.0), (1, 6.0, 4.0), (2, 9.0, 1.0)];
        assert_eq!(foremost(joints.into_iter()), Some(1));
        assert_eq!(foremost(joints[..1].iter().copied()), Some(0));
        assert_eq!(foremost(std::iter::empty()), None);
    }
}
