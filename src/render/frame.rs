//! From the draw list to what the GPU reads: plain bytes and the order of drawing. Nothing here
//! allocates once it has grown.

use super::light::{self, LightBox, MAP_SIZE};
use super::renderer::Quality;
use glam::Vec4;
use segue_motion::skin::SkinnedMesh;
use segue_scene::{
    Color, Figure, Layer, Lens, Limb, Look, Pane, Ring, Skin, Skinning, Stage, Stroke, Viewport,
};
use std::ops::Range;
use std::sync::Arc;

/// Limbs of one body that melt into the others and shade them.
const NEIGHBOURS: usize = 48;
/// How many of them a limb looks at.
const NEAREST: usize = 20;
/// Limbs nearer than this melt into each other, metres.
const TOUCHING: f32 = 0.02;
/// Ends the list of the nearest.
const NONE: u8 = 255;
/// From this radius in pixels on a limb is drawn with the fine mesh.
const FINE_FROM_PIXELS: f32 = 9.0;

#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct LimbInstance {
    a: [f32; 4],
    b: [f32; 4],
    flat: [f32; 4],
    color: [u8; 4],
    near: [u8; NEAREST],
    shadow: f32,
}

/// A figure in its skin.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct SkinInstance {
    /// The first of its joints; where its colour is from, as in skin.wgsl.
    figure: [u32; 2],
    color: [u8; 4],
}

/// Two texels of a joint: see skin.wgsl.
pub(super) type JointTexels = [[f32; 4]; 2];

#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct StrokeInstance {
    points: [[f32; 3]; 4],
    colors: [[u8; 4]; 2],
    width: f32,
}

#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct RingInstance {
    place: [f32; 4],
    color: [u8; 4],
    fill: f32,
}

/// `View` of view.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct ViewUniform {
    clip_from_world: [f32; 16],
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    viewport: [f32; 4],
    key: [f32; 4],
    background_top: Color,
    background_bottom: Color,
    floor: [f32; 4],
    focus: [f32; 4],
    grid: Color,
    edge: Color,
    style: [f32; 4],
    light_center: [f32; 4],
    light_right: [f32; 4],
    light_up: [f32; 4],
    light_tile: [f32; 4],
    light_tile_metres: [f32; 4],
    more: [f32; 4],
}

impl ViewUniform {
    /// Whether edges are to be seen.
    pub(super) fn has_edges(&self) -> bool {
        self.edge[3] > 0.0 && self.style[0] > 0.0
    }

    /// Fits the light map's part to the bodies of a pane; `false` where none casts a shadow.
    fn add_light(&mut self, pane: &Pane, look: &Look, tile: Viewport) -> bool {
        let key = Vec4::from(self.key).truncate();
        let Some(fit) = LightBox::about(pane, key, tile.width) else {
            return false;
        };
        let texel = 2.0 * fit.half_width / tile.width as f32;
        self.light_center = fit.center.extend(fit.half_width).to_array();
        self.light_right = fit.right.extend(fit.half_depth).to_array();
        self.light_up = fit.up.extend(1.0).to_array();
        self.light_tile =
            [tile.x, tile.y, tile.width, tile.height].map(|texels| texels as f32 / MAP_SIZE as f32);
        let [spread, widest] = if look.flat { [0.0, 0.0] } else { [SPREAD, WIDEST_M] };
        self.light_tile_metres = [texel, spread, widest, look.key_shadow];
        true
    }
}

/// The main light's radius over its distance: how much wider the edge of a shadow gets with every
/// metre.
const SPREAD: f32 = 0.055;
/// The widest that the edge of a shadow gets to either side, metres.
const WIDEST_M: f32 = 0.13;

/// `Figure` of limb.wgsl.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct FigureUniform {
    about: [f32; 4],
    neighbours: [[f32; 4]; 3 * NEIGHBOURS],
}

/// One body in the instance buffers: of limbs, or in a skin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FigureDraw {
    /// Its block of [`Frame::figure_uniforms`], where it is of limbs.
    pub(super) uniform: usize,
    pub(super) skin: Option<SkinDraw>,
    pub(super) fine: Range<u32>,
    pub(super) coarse: Range<u32>,
    /// The limbs whose shadow is drawn.
    pub(super) casting: Range<u32>,
    pub(super) ghost: bool,
    /// Whether it keeps the main light off.
    pub(super) in_light: bool,
    depth: f32,
}

impl FigureDraw {
    /// Its limbs.
    pub(super) fn limbs(&self) -> Range<u32> {
        self.fine.start..self.coarse.end
    }
}

/// Figures in the same skin, one instance each.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SkinDraw {
    /// Into [`Frame::meshes`].
    pub(super) mesh: usize,
    pub(super) instances: Range<u32>,
}

/// A mesh: itself, and no other that is alike.
#[derive(Clone)]
pub(super) struct Mesh(pub(super) Arc<SkinnedMesh>);

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// One pane in the instance buffers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PaneDraw {
    pub(super) viewport: Viewport,
    /// Into [`Frame::figures`]: solid ones first, then ghosts from far to near.
    pub(super) figures: Range<usize>,
    /// Into [`Frame::solid_skins`]: all solid figures in skins.
    pub(super) solid_skins: Range<usize>,
    /// Strokes on the ground, in space, and over everything.
    pub(super) strokes: [Range<u32>; 3],
    pub(super) rings: Range<u32>,
    /// The pane's part of the light map, where it has bodies that cast shadows.
    pub(super) lit: Option<Viewport>,
}

/// A stage, ready for the GPU.
#[derive(Clone, Default, PartialEq)]
pub(super) struct Frame {
    pub(super) clear: Color,
    pub(super) views: Vec<ViewUniform>,
    pub(super) figures: Vec<FigureDraw>,
    pub(super) figure_uniforms: Vec<FigureUniform>,
    pub(super) limbs: Vec<LimbInstance>,
    pub(super) skins: Vec<SkinInstance>,
    pub(super) solid_skins: Vec<SkinDraw>,
    pub(super) joints: Vec<JointTexels>,
    pub(super) meshes: Vec<Mesh>,
    pub(super) strokes: Vec<StrokeInstance>,
    pub(super) rings: Vec<RingInstance>,
    pub(super) panes: Vec<PaneDraw>,
}

fn bytes(color: Color) -> [u8; 4] {
    color.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// The viewport's part inside a stage of that size.
fn clip(viewport: Viewport, [width, height]: [u32; 2]) -> Viewport {
    let (x, y) = (viewport.x.min(width), viewport.y.min(height));
    Viewport { x, y, width: viewport.width.min(width - x), height: viewport.height.min(height - y) }
}

/// The same part of another target; neighbours stay neighbours.
fn stretched(viewport: Viewport, from: [u32; 2], to: [u32; 2]) -> Viewport {
    let place = |at: u32, axis: usize| {
        (f64::from(at) * f64::from(to[axis]) / f64::from(from[axis].max(1))).round() as u32
    };
    let (x, y) = (place(viewport.x, 0), place(viewport.y, 1));
    Viewport {
        x,
        y,
        width: place(viewport.x + viewport.width, 0) - x,
        height: place(viewport.y + viewport.height, 1) - y,
    }
}

impl Frame {
    /// Fills the frame from a stage whose panes divide `size` pixels and that is drawn into
    /// `target` pixels.
    pub(super) fn build(
        &mut self,
        stage: &Stage,
        size: [u32; 2],
        target: [u32; 2],
        quality: Quality,
    ) {
        self.clear = stage.look.background_top;
        self.views.clear();
        self.figures.clear();
        self.figure_uniforms.clear();
        self.limbs.clear();
        self.skins.clear();
        self.solid_skins.clear();
        self.joints.clear();
        self.meshes.clear();
        self.strokes.clear();
        self.rings.clear();
        self.panes.clear();
        for pane in &stage.panes {
            let viewport = stretched(clip(pane.viewport, size), size, target);
            if viewport.width == 0 || viewport.height == 0 {
                continue;
            }
            let solid_skins = self.add_solid_skins(pane);
            let figures = self.add_figures(pane, viewport, stage.look.flat, quality);
            let strokes = [Layer::Ground, Layer::Space, Layer::Over].map(|layer| {
                let start = self.strokes.len() as u32;
                self.strokes.extend(
                    pane.strokes.iter().filter(|s| s.layer == layer).filter_map(stroke_instance),
                );
                start..self.strokes.len() as u32
            });
            let rings = self.rings.len() as u32;
            self.rings.extend(pane.rings.iter().filter_map(ring_instance));
            let mut view =
                view_uniform(pane, viewport, stage, target[1] as f32 / size[1].max(1) as f32);
            let tile = light::tile(self.panes.len(), stage.panes.len());
            let lit = quality == Quality::Full && view.add_light(pane, &stage.look, tile);
            self.views.push(view);
            self.panes.push(PaneDraw {
                viewport,
                figures,
                solid_skins,
                strokes,
                rings: rings..self.rings.len() as u32,
                lit: lit.then_some(tile),
            });
        }
    }

    /// The number of a mesh in this frame.
    fn mesh(&mut self, mesh: &Arc<SkinnedMesh>) -> usize {
        let known = self.meshes.iter().position(|known| Arc::ptr_eq(&known.0, mesh));
        known.unwrap_or_else(|| {
            self.meshes.push(Mesh(Arc::clone(mesh)));
            self.meshes.len() - 1
        })
    }

    /// Adds a figure in its skin; the number of its instance.
    fn add_skin(&mut self, pane: &Pane, skin: &Skin, ghost: bool) -> u32 {
        let first = self.joints.len() as u32;
        let transforms = pane.joints.get(skin.joints.clone()).unwrap_or_default();
        let colors = pane.joint_colors.get(skin.joints.clone()).unwrap_or_default();
        self.joints.extend(transforms.iter().enumerate().map(|(index, transform)| {
            let [red, green, blue, _] =
                bytes(colors.get(index).copied().unwrap_or(skin.color)).map(f32::from);
            let shift = transform.translation.extend(red + 256.0 * green + 65_536.0 * blue);
            [transform.rotation.to_array(), shift.to_array()]
        }));
        // A joint that is no number takes its vertices nowhere.
        for [rotation, shift] in self.joints.iter_mut().skip(first as usize) {
            if !rotation.iter().chain(shift.iter()).all(|part| part.is_finite()) {
                (*rotation, *shift) = ([0.0, 0.0, 0.0, 1.0], [0.0; 4]);
            }
        }
        let color_from = match (skin.colored, ghost || skin.mesh.colors.is_empty()) {
            (true, _) => 1,
            (false, true) => 0,
            (false, false) => 2,
        };
        self.skins.push(SkinInstance { figure: [first, color_from], color: bytes(skin.color) });
        self.skins.len() as u32 - 1
    }

    /// Adds all solid figures in skins: those that share one follow each other, and are drawn at
    /// once.
    fn add_solid_skins(&mut self, pane: &Pane) -> Range<usize> {
        let first = self.solid_skins.len();
        let solids = || {
            pane.figures
                .iter()
                .filter(|figure| !figure.ghost)
                .filter_map(|figure| figure.skin.as_ref())
        };
        for skin in solids() {
            let mesh = self.mesh(&skin.mesh);
            if self.solid_skins[first..].iter().any(|draw| draw.mesh == mesh) {
                continue;
            }
            let start = self.skins.len() as u32;
            for alike in solids().filter(|other| Arc::ptr_eq(&other.mesh, &skin.mesh)) {
                self.add_skin(pane, alike, false);
            }
            let instances = start..self.skins.len() as u32;
            self.solid_skins.push(SkinDraw { mesh, instances });
        }
        first..self.solid_skins.len()
    }

    fn add_figures(
        &mut self,
        pane: &Pane,
        viewport: Viewport,
        flat: bool,
        quality: Quality,
    ) -> Range<usize> {
        let first = self.figures.len();
        let [_, _, back] = pane.camera.axes();
        let plain = quality == Quality::Plain;
        // Where the main light's shadow is all there is to be, none is soft.
        let soft = plain || !flat;
        // The shadows of high limbs are as wide as the body and hardly seen: where every pixel
        // costs, only what is low casts one.
        let only_low = plain || pane.figures.len() > MANY_FIGURES;
        for figure in &pane.figures {
            let Some(limbs) = pane.limbs.get(figure.limbs.clone()) else {
                continue;
            };
            let shades = soft && figure.shadow > 0.0 && !(plain && figure.ghost);
            let mut draw = FigureDraw {
                uniform: 0,
                skin: None,
                fine: 0..0,
                coarse: 0..0,
                casting: 0..0,
                ghost: figure.ghost,
                in_light: light::keeps_off_light(figure),
                depth: 0.0,
            };
            if let Some(skin) = &figure.skin {
                if figure.ghost {
                    let (mesh, instance) = (self.mesh(&skin.mesh), self.add_skin(pane, skin, true));
                    let instances = instance..instance + 1;
                    draw.skin = Some(SkinDraw { mesh, instances });
                }
                let start = self.limbs.len() as u32;
                if shades {
                    let low = limbs
                        .iter()
                        .filter(|limb| !only_low || limb.a.y.min(limb.b.y) < LOW_SHADOW_HEIGHT_M);
                    self.limbs.extend(low.filter_map(|limb| limb_instance(limb, figure.shadow)));
                }
                draw.casting = start..self.limbs.len() as u32;
            } else {
                self.add_limbs(limbs, figure, pane, viewport, quality, &mut draw);
                if !shades {
                    draw.casting = 0..0;
                } else if only_low && draw.fine.is_empty() {
                    let start = draw.limbs().start;
                    let low = self.limbs[start as usize..]
                        .iter()
                        .take_while(|limb| lowest(limb) < LOW_SHADOW_HEIGHT_M);
                    draw.casting = start..start + low.count() as u32;
                }
            }
            // Limbs come with the biggest first: the trunk says where the body is.
            let depth = limbs.first().map_or(0.0, |l| -((l.a + l.b) * 0.5).dot(back));
            draw.depth = if depth.is_finite() { depth } else { 0.0 };
            self.figures.push(draw);
        }
        // Solid ones first, then ghosts from far to near.
        let key = |f: &FigureDraw| {
            if f.ghost { (true, -f.depth) } else { (false, 0.0) }
        };
        self.figures[first..].sort_unstable_by(|x, y| {
            let (x, y) = (key(x), key(y));
            x.0.cmp(&y.0).then(x.1.total_cmp(&y.1))
        });
        first..self.figures.len()
    }

    /// Adds the limbs of a figure that is seen as such.
    fn add_limbs(
        &mut self,
        limbs: &[Limb],
        figure: &Figure,
        pane: &Pane,
        viewport: Viewport,
        quality: Quality,
        draw: &mut FigureDraw,
    ) {
        let (plain, height) = (quality == Quality::Plain, viewport.height as f32);
        let is_fine = |limb: &Limb| {
            !plain
                && limb.radius_a.max(limb.radius_b)
                    * pane.camera.pixels_per_metre((limb.a + limb.b) * 0.5, height)
                    >= FINE_FROM_PIXELS
        };
        let instance = |limb: &Limb| limb_instance(limb, figure.shadow);
        let start = self.limbs.len() as u32;
        self.limbs.extend(limbs.iter().filter(|l| is_fine(l)).filter_map(instance));
        let middle = self.limbs.len() as u32;
        self.limbs.extend(limbs.iter().filter(|l| !is_fine(l)).filter_map(instance));
        if middle == start {
            // The lowest first: theirs are the shadows.
            self.limbs[start as usize..].sort_unstable_by(|a, b| lowest(a).total_cmp(&lowest(b)));
        } else if quality == Quality::Full {
            // Nobody sees how limbs melt in a body that is small all over.
            let bodys_own = &mut self.limbs[start as usize..];
            find_nearest(&limbs[..limbs.len().min(NEIGHBOURS)], bodys_own, figure.ghost);
        }
        let end = self.limbs.len() as u32;
        (draw.fine, draw.coarse, draw.casting) = (start..middle, middle..end, start..end);
        draw.uniform = self.figure_uniforms.len();
        self.figure_uniforms.push(figure_uniform(limbs, figure));
    }
}

/// With more figures than this in a pane, only their low limbs shade the ground softly.
const MANY_FIGURES: usize = 12;

/// Below this height a limb's soft shadow is worth its pixels where there are few to spend, metres.
const LOW_SHADOW_HEIGHT_M: f32 = 0.5;

/// The height of a limb's lower end, metres.
fn lowest(limb: &LimbInstance) -> f32 {
    limb.a[1].min(limb.b[1])
}

fn limb_instance(limb: &Limb, shadow: f32) -> Option<LimbInstance> {
    let finite = limb.a.is_finite()
        && limb.b.is_finite()
        && limb.radius_a.is_finite()
        && limb.radius_b.is_finite();
    (finite && limb.radius_a >= 0.0 && limb.radius_b >= 0.0).then(|| LimbInstance {
        a: limb.a.extend(limb.radius_a).to_array(),
        b: limb.b.extend(limb.radius_b).to_array(),
        flat: limb.flat.extend(limb.flatness).to_array(),
        color: bytes(limb.color),
        near: [NONE; NEAREST],
        shadow,
    })
}

fn stroke_instance(stroke: &Stroke) -> Option<StrokeInstance> {
    let points = [stroke.before, stroke.from, stroke.to, stroke.after];
    (points.iter().all(|p| p.is_finite()) && stroke.width > 0.0).then(|| StrokeInstance {
        points: points.map(|p| p.to_array()),
        colors: [bytes(stroke.color_from), bytes(stroke.color_to)],
        width: stroke.width,
    })
}

fn ring_instance(ring: &Ring) -> Option<RingInstance> {
    (ring.center.is_finite() && ring.radius > 0.0 && ring.width >= 0.0).then(|| RingInstance {
        place: [ring.center.x, ring.center.z, ring.radius, ring.width],
        color: bytes(ring.color),
        fill: ring.fill,
    })
}

fn figure_uniform(limbs: &[Limb], figure: &Figure) -> FigureUniform {
    let solid = if figure.ghost { 0.0 } else { 1.0 };
    let mut uniform =
        FigureUniform { about: [solid, 0.0, 0.0, 0.0], neighbours: [[0.0; 4]; 3 * NEIGHBOURS] };
    for (limb, triple) in limbs.iter().zip(uniform.neighbours.chunks_exact_mut(3)) {
        // As the mesh is bent: the flattening is across the axis.
        let flat =
            limb.flat - limb.flat.project_onto_normalized((limb.b - limb.a).normalize_or_zero());
        let flatness = if flat.length() > 1e-3 { limb.flatness.max(0.05) } else { 1.0 };
        triple[0] = limb.a.extend(limb.radius_a).to_array();
        triple[1] = limb.b.extend(limb.radius_b).to_array();
        triple[2] = flat.normalize_or_zero().extend(flatness).to_array();
    }
    uniform
}

/// Notes for every instance which limbs of its body, by their numbers in `limbs`, touch it or take
/// the most light from it. A ghost's limbs shade nothing: there only touch counts.
fn find_nearest(limbs: &[Limb], instances: &mut [LimbInstance], ghost: bool) {
    for instance in instances {
        let (a, b) = (Vec4::from(instance.a), Vec4::from(instance.b));
        let points = [a.truncate(), (a.truncate() + b.truncate()) * 0.5, b.truncate()];
        let (half, own_radius) = (points[0].distance(points[2]) * 0.5, a.w.max(b.w));
        let mut scores = [0.0f32; NEAREST];
        for (index, limb) in limbs.iter().enumerate() {
            let radius = limb.radius_a.max(limb.radius_b);
            // Touching limbs first, then those that fill the most of the view from here.
            let score_at = |distance: f32, gap: f32| {
                if gap < TOUCHING { 10.0 - gap } else { radius / distance.max(1e-4) }
            };
            let reach = (limb.b - limb.a).length() * 0.5 + half;
            let at_least = points[1].distance((limb.a + limb.b) * 0.5) - reach;
            let too_far = ghost && at_least - own_radius - radius >= TOUCHING;
            if too_far
                || (at_least > 0.0
                    && score_at(at_least, at_least - own_radius - radius) <= scores[NEAREST - 1])
            {
                continue;
            }
            let itself = limb.a == points[0]
                && limb.b == points[2]
                && limb.radius_a == a.w
                && limb.radius_b == b.w;
            if itself || limb_instance(limb, 0.0).is_none() {
                continue;
            }
            let span = limb.b - limb.a;
            let scale = span.length_squared().max(1e-9).recip();
            let own_radii = [a.w, 0.5 * (a.w + b.w), b.w];
            // From both ends and the middle, each with the girths there.
            let score = (0..3).map(|i| {
                let t = ((points[i] - limb.a).dot(span) * scale).clamp(0.0, 1.0);
                let distance = points[i].distance(limb.a + span * t);
                let here = limb.radius_a + (limb.radius_b - limb.radius_a) * t;
                score_at(distance, distance - own_radii[i] - here)
            });
            let score = score.fold(0.0, f32::max);
            // Insert into the list, the strongest first.
            if score > scores[NEAREST - 1] && (score > 5.0 || !ghost) {
                let at = scores.partition_point(|&s| s >= score);
                scores[at..].rotate_right(1);
                instance.near[at..].rotate_right(1);
                scores[at] = score;
                instance.near[at] = index as u8;
            }
        }
    }
}

fn view_uniform(pane: &Pane, viewport: Viewport, stage: &Stage, stretch: f32) -> ViewUniform {
    let camera = &pane.camera;
    let look = &stage.look;
    let [right, up, back] = camera.axes();
    let aspect = viewport.aspect();
    let orthographic = camera.lens == Lens::Orthographic;
    let half_height = if orthographic { camera.half_height() } else { (camera.fov_y * 0.5).tan() };
    let scale = stretch * if stage.pixels_per_point > 0.0 { stage.pixels_per_point } else { 1.0 };
    let key = light::key_direction(right, camera.yaw);
    ViewUniform {
        clip_from_world: (camera.projection(aspect) * camera.view()).to_cols_array(),
        eye: camera.eye().extend(if orthographic { 1.0 } else { 0.0 }).to_array(),
        right: (right * (half_height * aspect)).extend(0.0).to_array(),
        up: (up * half_height).extend(0.0).to_array(),
        forward: (-back)
            .extend(if orthographic { 0.0 } else { camera.depth_range()[0] })
            .to_array(),
        viewport: [viewport.x, viewport.y, viewport.width, viewport.height].map(|v| v as f32),
        key: key.extend(scale).to_array(),
        background_top: look.background_top,
        background_bottom: look.background_bottom,
        // From far the light falls on more of the ground: it is the middle of the picture that is
        // lit.
        floor: Vec4::from(look.floor)
            .with_w(look.floor_radius.max(0.55 * camera.distance).max(0.1))
            .to_array(),
        focus: pane.focus.extend(look.shadow).to_array(),
        grid: look.grid,
        edge: look.edge,
        style: [look.edge_width * scale, look.rim, f32::from(u8::from(look.flat)), look.rim_light],
        light_center: [0.0, 0.0, 0.0, 1.0],
        light_right: [1.0, 0.0, 0.0, 1.0],
        light_up: [0.0, 1.0, 0.0, 0.0],
        light_tile: [0.0, 0.0, 1.0, 1.0],
        light_tile_metres: [0.0; 4],
        more: [
            f32::from(u8::from(pane.skinning == Skinning::Dual)),
            if stage.grid_metres > 1e-3 { stage.grid_metres } else { 1.0 },
            0.0,
            0.0,
        ],
    }
}
