//! A view of the stage: its camera, and everything that it shows.

use crate::primitives::{Figure, Layer, Limb, Ring, Skin, Skinning, Stroke};
use crate::{Body, Camera, Color, Viewport};
use glam::Vec3;
use segue_motion::skeleton::WorldPose;
use segue_motion::skin::RigidTransform;
use std::sync::Arc;

/// A view of the stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pane {
    /// Its rectangle in the stage.
    pub viewport: Viewport,
    /// Its camera.
    pub camera: Camera,
    /// Centre of the lit part of the ground; it should follow the body.
    pub focus: Vec3,
    /// All limbs, body by body.
    pub limbs: Vec<Limb>,
    /// The bodies.
    pub figures: Vec<Figure>,
    /// The joint transforms of all skins.
    pub joints: Vec<RigidTransform>,
    /// A colour for each joint in [`Self::joints`].
    pub joint_colors: Vec<Color>,
    /// The skinning method.
    pub skinning: Skinning,
    /// Lines.
    pub strokes: Vec<Stroke>,
    /// Rings on the ground.
    pub rings: Vec<Ring>,
}

impl Pane {
    /// Removes all contents; their memory is kept.
    pub fn clear(&mut self) {
        self.limbs.clear();
        self.figures.clear();
        self.joints.clear();
        self.joint_colors.clear();
        self.strokes.clear();
        self.rings.clear();
    }

    /// Adds a solid body in a pose of its own skeleton, with its full shadow.
    pub fn add_body(&mut self, body: &Body, pose: &WorldPose, color: Color) {
        self.add_figure(body, pose, color, None, false, 1.0);
    }

    /// Adds a solid body in a pose, with each limb in the colour of the joint that moves it.
    pub fn add_colored_body(
        &mut self,
        body: &Body,
        pose: &WorldPose,
        color_of: impl Fn(usize) -> Color,
    ) {
        self.add_figure(body, pose, [1.0; 4], Some(&color_of), false, 1.0);
    }

    /// Adds a translucent body, whose shadow is as strong as the colour's alpha.
    pub fn add_ghost(&mut self, body: &Body, pose: &WorldPose, color: Color) {
        self.add_figure(body, pose, color, None, true, color[3]);
    }

    /// Adds a translucent body whose shadow is that of a solid one.
    pub fn add_glass(&mut self, body: &Body, pose: &WorldPose, color: Color) {
        self.add_figure(body, pose, color, None, true, 1.0);
    }

    fn add_figure(
        &mut self,
        body: &Body,
        pose: &WorldPose,
        color: Color,
        color_of: Option<&dyn Fn(usize) -> Color>,
        ghost: bool,
        shadow: f32,
    ) {
        let start = self.limbs.len();
        match (color_of, body.skin()) {
            (Some(color_of), None) => body.colored_limbs(pose, color_of, &mut self.limbs),
            _ => body.limbs(pose, color, &mut self.limbs),
        }
        let skin =
            body.skin().map(|mesh| {
                let first = self.joints.len();
                self.joints.extend(mesh.world_from_bind(pose));
                let joints = first..self.joints.len();
                self.joint_colors.extend((0..joints.len()).map(|joint| {
                    color_of.map_or(color, |color_of| color_of(body.color_joint(joint)))
                }));
                Skin { mesh: Arc::clone(mesh), joints, color, colored: color_of.is_some() }
            });
        self.figures.push(Figure { limbs: start..self.limbs.len(), skin, ghost, shadow });
    }

    /// Adds a single straight line.
    pub fn add_line(&mut self, from: Vec3, to: Vec3, color: Color, width: f32, layer: Layer) {
        self.strokes.push(Stroke {
            before: from,
            from,
            to,
            after: to,
            color_from: color,
            color_to: color,
            width,
            layer,
        });
    }

    /// Adds a line through `points`, each with its colour, with joined segments. Repeated points
    /// are skipped.
    pub fn add_path(
        &mut self,
        points: impl IntoIterator<Item = (Vec3, Color)>,
        width: f32,
        layer: Layer,
    ) {
        let first = self.strokes.len();
        let mut last: Option<(Vec3, Color)> = None;
        for (to, color_to) in points {
            if !to.is_finite() {
                continue;
            }
            let Some((from, color_from)) = last else {
                last = Some((to, color_to));
                continue;
            };
            if from.distance_squared(to) < 1e-10 {
                continue;
            }
            let mut before = from;
            if self.strokes.len() > first
                && let Some(previous) = self.strokes.last_mut()
            {
                before = previous.from;
                previous.after = to;
            }
            self.strokes.push(Stroke {
                before,
                from,
                to,
                after: to,
                color_from,
                color_to,
                width,
                layer,
            });
            last = Some((to, color_to));
        }
    }

    /// Adds a dashed line through `points`. Dashes and gaps have equal lengths along the line.
    pub fn add_dashed_path(
        &mut self,
        points: impl IntoIterator<Item = Vec3>,
        color: Color,
        dash: f32,
        width: f32,
        layer: Layer,
    ) {
        let dash = dash.max(1e-3);
        let mut walked = 0.0f32;
        let mut last: Option<Vec3> = None;
        for to in points {
            if let Some(from) = last {
                let length = from.distance(to);
                if !length.is_finite() || length > dash * 1e4 {
                    continue;
                }
                // The segment is cut where dashes begin and end.
                let mut at = 0.0;
                while at < length {
                    let phase = (walked + at).rem_euclid(2.0 * dash);
                    let step = (if phase < dash { dash } else { 2.0 * dash } - phase)
                        .max(dash * 1e-3)
                        .min(length - at)
                        .max(1e-6);
                    if phase < dash {
                        self.add_line(
                            from.lerp(to, at / length),
                            from.lerp(to, ((at + step) / length).min(1.0)),
                            color,
                            width,
                            layer,
                        );
                    }
                    at += step;
                }
                walked = (walked + length).rem_euclid(2.0 * dash);
            }
            last = Some(to);
        }
    }

    /// Adds a ring of 12 cm on the ground around a planted foot. The ring of a sliding foot is also
    /// thicker, so that it does not differ in colour alone.
    pub fn add_contact(&mut self, foot: Vec3, color: Color, slides: bool) {
        let (width, fill) = if slides { (0.032, 0.32) } else { (0.014, 0.1) };
        self.rings.push(Ring { center: foot, radius: 0.12, width, color, fill });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgb;

    #[test]
    fn path_of_repeated_points_skips_them_and_joins_its_segments() {
        let mut pane = Pane::default();
        let points = [Vec3::ZERO, Vec3::X, Vec3::X, Vec3::new(1.0, 0.0, 1.0)];
        pane.add_line(Vec3::ZERO, Vec3::Y, rgb(0), 1.0, Layer::Over);
        pane.add_path(points.map(|p| (p, rgb(0xff_ff_ff))), 2.0, Layer::Ground);
        assert_eq!(pane.strokes.len(), 3);
        assert_eq!(pane.strokes[0].after, Vec3::Y);
        assert_eq!((pane.strokes[1].before, pane.strokes[1].after), (Vec3::ZERO, points[3]));
        assert_eq!((pane.strokes[2].before, pane.strokes[2].after), (Vec3::ZERO, points[3]));
    }

    #[test]
    fn dashes_of_a_path_with_corners_cover_half_of_it() {
        let mut pane = Pane::default();
        pane.add_dashed_path(
            [Vec3::ZERO, Vec3::X * 0.55, Vec3::new(0.55, 0.0, 3.45)],
            rgb(0),
            0.1,
            2.0,
            Layer::Ground,
        );
        let length: f32 = pane.strokes.iter().map(|s| s.from.distance(s.to)).sum();
        assert!((length - 2.0).abs() < 1e-2, "{length}");
    }
}
