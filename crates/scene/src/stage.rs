use super::{Body, Camera};
use glam::Vec3;
use segue_motion::skeleton::WorldPose;
use segue_motion::skin::{RigidTransform, SkinnedMesh};
use std::ops::Range;
use std::sync::Arc;

/// Red, green, blue, alpha, each 0–1; sRGB-encoded as in a palette, alpha straight.
pub type Color = [f32; 4];

/// An opaque colour from its hexadecimal form: `rgb(0x0f1115)`.
#[must_use]
pub const fn rgb(hex: u32) -> Color {
    [
        (hex >> 16 & 0xff) as f32 / 255.0,
        (hex >> 8 & 0xff) as f32 / 255.0,
        (hex & 0xff) as f32 / 255.0,
        1.0,
    ]
}

/// The colour with another alpha.
#[must_use]
pub const fn with_alpha(color: Color, alpha: f32) -> Color {
    [color[0], color[1], color[2], alpha]
}

/// A rounded cone: two balls and their common hull. With `a == b` a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Centre of the first ball, metres.
    pub a: Vec3,
    /// Centre of the second ball, metres.
    pub b: Vec3,
    /// Radius about `a`, metres.
    pub radius_a: f32,
    /// Radius about `b`, metres.
    pub radius_b: f32,
    /// Unit direction in which the cross-section is scaled; the part of it across the axis counts.
    pub flat: Vec3,
    /// The scale in that direction: 1 is round, 0.5 half as thick.
    pub flatness: f32,
    /// Colour; for a ghost the alpha says how much of it is seen.
    pub color: Color,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its limbs, a range of [`Pane::limbs`].
    pub limbs: Range<usize>,
    /// The skin that is seen in their place: then they only shade the ground.
    pub skin: Option<Skin>,
    /// Translucent: only its front is seen, and bodies behind it shine through.
    pub ghost: bool,
    /// How strongly it darkens the ground near it, 0 (not at all) to 1: what is that strong also
    /// keeps off the main light.
    pub shadow: f32,
}

/// A skinned mesh in a pose.
#[derive(Clone, Debug)]
pub struct Skin {
    /// The mesh; many figures may share one.
    pub mesh: Arc<SkinnedMesh>,
    /// Its joints' `world_from_bind`, a range of [`Pane::joints`].
    pub joints: Range<usize>,
    /// Colour; for a ghost the alpha says how much of it is seen. Where the mesh has colours of its
    /// own, a solid body shows those.
    pub color: Color,
    /// Whether every joint has a colour of its own instead, in [`Pane::joint_colors`].
    pub colored: bool,
}

/// Meshes are large: one is itself and no other.
impl PartialEq for Skin {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.joints == other.joints
            && self.color == other.color
            && self.colored == other.colored
    }
}

/// How a skin follows its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Skinning {
    /// The mean of the joints' motions, as dual quaternions: a twisted limb keeps its girth.
    #[default]
    Dual,
    /// The mean of where each joint would take the point: a twisted limb collapses.
    Linear,
}

/// Where a line is in the depth of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layer {
    /// Painted on the ground: behind every body.
    #[default]
    Ground,
    /// In space: hidden by the bodies before it.
    Space,
    /// On top of everything.
    Over,
}

/// One straight piece of a line, of even width on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Where the piece before it starts; `from` itself where none is. It shapes the joint.
    pub before: Vec3,
    /// Start, metres.
    pub from: Vec3,
    /// End, metres.
    pub to: Vec3,
    /// Where the piece after it ends; `to` itself where none is.
    pub after: Vec3,
    /// Colour at the start.
    pub color_from: Color,
    /// Colour at the end.
    pub color_to: Color,
    /// Width in points (see [`Stage::pixels_per_point`]).
    pub width: f32,
    /// On the ground, in space, or over everything.
    pub layer: Layer,
}

/// A ring on the ground: a planted foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Its middle; the height is ignored.
    pub center: Vec3,
    /// Radius of the middle of its line, metres.
    pub radius: f32,
    /// Width of its line, metres; at least one and a half points are drawn.
    pub width: f32,
    /// Colour of the line.
    pub color: Color,
    /// How much of the colour fills the inside, 0–1.
    pub fill: f32,
}

/// A rectangle in physical pixels, from the top left corner of its stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it all")]
pub struct Viewport {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
}

impl Viewport {
    /// Width over height; 1 for an empty one.
    #[must_use]
    pub fn aspect(&self) -> f32 {
        if self.width == 0 || self.height == 0 {
            1.0
        } else {
            self.width as f32 / self.height as f32
        }
    }

    /// Width and height as a vector, pixels.
    #[must_use]
    pub fn size(&self) -> glam::Vec2 {
        glam::Vec2::new(self.width as f32, self.height as f32)
    }

    /// `count` panes side by side in a stage of the given size, `gap` pixels apart.
    pub fn columns(width: u32, height: u32, count: u32, gap: u32) -> impl Iterator<Item = Self> {
        let count = count.max(1);
        let inner = width.saturating_sub(gap * (count - 1));
        (0..count).map(move |i| {
            let start = inner * i / count;
            Self { x: start + gap * i, y: 0, width: inner * (i + 1) / count - start, height }
        })
    }
}

/// One view of the stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pane {
    /// Where it lies in the stage.
    pub viewport: Viewport,
    /// What it looks through.
    pub camera: Camera,
    /// Middle of the lit part of the ground; follow the body with it.
    pub focus: Vec3,
    /// All limbs, body by body.
    pub limbs: Vec<Limb>,
    /// The bodies.
    pub figures: Vec<Figure>,
    /// The joints of all skins.
    pub joints: Vec<RigidTransform>,
    /// A colour for each of them.
    pub joint_colors: Vec<Color>,
    /// How skins follow their joints.
    pub skinning: Skinning,
    /// Lines.
    pub strokes: Vec<Stroke>,
    /// Rings on the ground.
    pub rings: Vec<Ring>,
}

impl Pane {
    /// Takes everything out that is to be seen; the memory stays.
    pub fn clear(&mut self) {
        self.limbs.clear();
        self.figures.clear();
        self.joints.clear();
        self.joint_colors.clear();
        self.strokes.clear();
        self.rings.clear();
    }

    /// Adds a body in a pose, solid, with its full shadow.
    pub fn add_body(&mut self, body: &Body, pose: &WorldPose, color: Color) {
        self.add_figure(body, pose, color, None, false, 1.0);
    }

    /// Adds a body in a pose, solid, each limb in the colour of the joint that moves it.
    pub fn add_colored_body(
        &mut self,
        body: &Body,
        pose: &WorldPose,
        color_of: impl Fn(usize) -> Color,
    ) {
        self.add_figure(body, pose, [1.0; 4], Some(&color_of), false, 1.0);
    }

    /// Adds a translucent body; its shadow is as strong as the colour's alpha.
    pub fn add_ghost(&mut self, body: &Body, pose: &WorldPose, color: Color) {
        self.add_figure(body, pose, color, None, true, color[3]);
    }

    /// Adds a body that is seen through, as a ghost is, and that keeps off the light as a solid one
    /// does.
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
        let mut led = WorldPose::default();
        let pose = body.led_pose(pose, &mut led).unwrap_or(pose);
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

    /// Adds a line through `points`, each with its colour, with its pieces joined. Points that
    /// repeat are skipped.
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

    /// Adds a dashed line through `points`; dashes and gaps are equally long along the line.
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
                // Cut the piece where dashes begin and end.
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

    /// Adds a ring of 12 cm on the ground about a planted foot. That of a foot which slides is
    /// heavier: its colour is not all that tells it.
    pub fn add_contact(&mut self, foot: Vec3, color: Color, slides: bool) {
        let (width, fill) = if slides { (0.032, 0.32) } else { (0.014, 0.1) };
        self.rings.push(Ring { center: foot, radius: 0.12, width, color, fill });
    }
}

/// Colours and light of the empty stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Background at the top of a pane.
    pub background_top: Color,
    /// Background at the bottom of a pane.
    pub background_bottom: Color,
    /// The ground where the light falls.
    pub floor: Color,
    /// Radius of the lit part of the ground, metres.
    pub floor_radius: f32,
    /// Lines of the grid, one metre apart; the alpha says how clear they are.
    pub grid: Color,
    /// How dark the ground gets under a body, 0–1.
    pub shadow: f32,
    /// How much of the light on the ground is the main one's, which throws the shadow of the whole
    /// body, 0–1.
    pub key_shadow: f32,
    /// The neutral clay for the bodies that are the result.
    pub clay: Color,
    /// Thin lines where one limb passes before another; the alpha says how clear they are.
    pub edge: Color,
    /// Their width in points.
    pub edge_width: f32,
    /// How much limbs darken towards their silhouette, 0–1.
    pub rim: f32,
    /// How much light from behind there is on a silhouette.
    pub rim_light: f32,
    /// Two tones with a line between them, and shadows with a hard edge: for print.
    pub flat: bool,
}

impl Look {
    /// For the dark theme.
    pub const DARK: Self = Self {
        background_top: rgb(0x0f_11_15),
        background_bottom: rgb(0x0c_0d_11),
        floor: rgb(0x20_24_2d),
        floor_radius: 3.6,
        grid: [0.55, 0.6, 0.7, 0.26],
        shadow: 0.82,
        key_shadow: 0.6,
        clay: rgb(0xd2_d6_e2),
        edge: [0.04, 0.045, 0.06, 0.85],
        edge_width: 1.1,
        rim: 0.62,
        rim_light: 0.5,
        flat: false,
    };

    /// For the light theme.
    pub const LIGHT: Self = Self {
        background_top: rgb(0xee_f0_f4),
        background_bottom: rgb(0xe4_e7_ee),
        floor: rgb(0xfb_fc_fe),
        floor_radius: 4.2,
        grid: [0.42, 0.48, 0.6, 0.3],
        shadow: 0.5,
        key_shadow: 0.5,
        clay: rgb(0xae_b4_c4),
        edge: [0.16, 0.19, 0.26, 0.8],
        edge_width: 1.1,
        rim: 0.45,
        rim_light: 0.2,
        flat: false,
    };

    /// For print and for a bright lecture hall: black lines and two flat tones on white.
    pub const PAPER: Self = Self {
        background_top: rgb(0xff_ff_ff),
        background_bottom: rgb(0xff_ff_ff),
        floor: rgb(0xff_ff_ff),
        floor_radius: 5.0,
        grid: [0.0, 0.0, 0.0, 0.28],
        shadow: 0.3,
        key_shadow: 0.85,
        clay: rgb(0xf4_f4_f4),
        edge: [0.0, 0.0, 0.0, 1.0],
        edge_width: 2.0,
        rim: 0.0,
        rim_light: 0.0,
        flat: true,
    };
}

/// Everything that is to be seen in one rectangle of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The views, drawn in order.
    pub panes: Vec<Pane>,
    /// Colours and light.
    pub look: Look,
    /// Physical pixels per point: widths of lines are in points.
    pub pixels_per_point: f32,
    /// Width of a cell of the grid on the ground, metres of the scene.
    pub grid_metres: f32,
}

impl Default for Stage {
    fn default() -> Self {
        Self { panes: Vec::new(), look: Look::DARK, pixels_per_point: 1.0, grid_metres: 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_fill_the_stage() {
        let panes: Vec<_> = Viewport::columns(1000, 500, 3, 2).collect();
        assert_eq!(panes.len(), 3);
        assert_eq!(panes[2].x + panes[2].width, 1000);
        assert!(panes.windows(2).all(|p| p[0].x + p[0].width + 2 == p[1].x));
        assert_eq!(Viewport::columns(0, 0, 3, 2).map(|v| v.width).sum::<u32>(), 0);
    }

    #[test]
    fn a_path_joins_its_pieces_and_skips_repeats() {
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
    fn dashes_cover_half_of_the_way_also_round_corners() {
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

    #[test]
    fn hex_is_exact() {
        assert_eq!(rgb(0x0f_11_15), [15.0 / 255.0, 17.0 / 255.0, 21.0 / 255.0, 1.0]);
    }
}
