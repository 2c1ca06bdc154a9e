//! Conversion of a draw list to data for the GPU: plain bytes, and the order of drawing. Buffers
//! are reused, so that a frame like the last one allocates nothing.

use super::instances::{
    bytes, figure_uniform, find_nearest, limb_instance, lowest, ring_instance, stroke_instance,
};
use super::layout::{
    FigureUniform, JointTexels, LimbInstance, MAX_NEIGHBOURS, RingInstance, SkinInstance,
    StrokeInstance, ViewUniform,
};
use super::light;
use super::quality::Quality;
use super::view_uniform::{add_light, view_uniform};
use segue_motion::skin::SkinnedMesh;
use segue_scene::{Color, Figure, Layer, Limb, Pane, Skin, Stage, Viewport};
use std::ops::Range;
use std::sync::Arc;

/// The smallest radius of a limb that is drawn with the fine mesh, pixels.
const MIN_FINE_PIXELS: f32 = 9.0;

/// A body in the instance buffers, made of limbs or in a skin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FigureDraw {
    /// The index of its block in [`Frame::figure_uniforms`], where it is made of limbs.
    pub(super) uniform: usize,
    pub(super) skin: Option<SkinDraw>,
    pub(super) fine: Range<u32>,
    pub(super) coarse: Range<u32>,
    /// The limbs whose shadow is drawn.
    pub(super) casting: Range<u32>,
    pub(super) ghost: bool,
    /// Whether it casts a shadow of the main light.
    pub(super) casts_key_shadow: bool,
    depth: f32,
}

impl FigureDraw {
    /// Returns the range of its limbs.
    pub(super) fn limbs(&self) -> Range<u32> {
        self.fine.start..self.coarse.end
    }
}

/// Figures in the same skin, one instance each.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SkinDraw {
    /// The index in [`Frame::meshes`].
    pub(super) mesh: usize,
    pub(super) instances: Range<u32>,
}

/// A mesh compared by identity, not by content.
#[derive(Clone)]
pub(super) struct SharedMesh(pub(super) Arc<SkinnedMesh>);

impl PartialEq for SharedMesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A pane in the instance buffers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PaneDraw {
    pub(super) viewport: Viewport,
    /// The range in [`Frame::figures`]: solid ones first, then ghosts from far to near.
    pub(super) figures: Range<usize>,
    /// The range in [`Frame::solid_skins`] of all solid figures in skins.
    pub(super) solid_skins: Range<usize>,
    /// The ranges of the strokes on the ground, in space, and over everything.
    pub(super) strokes: [Range<u32>; 3],
    pub(super) rings: Range<u32>,
    /// The pane's part of the light map, where it has bodies that cast shadows.
    pub(super) lit: Option<Viewport>,
}

/// A stage as data for the GPU.
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
    pub(super) meshes: Vec<SharedMesh>,
    pub(super) strokes: Vec<StrokeInstance>,
    pub(super) rings: Vec<RingInstance>,
    pub(super) panes: Vec<PaneDraw>,
}

/// Returns the part of a viewport inside a stage of that size.
fn clip(viewport: Viewport, [width, height]: [u32; 2]) -> Viewport {
    let (x, y) = (viewport.x.min(width), viewport.y.min(height));
    Viewport { x, y, width: viewport.width.min(width - x), height: viewport.height.min(height - y) }
}

/// Returns the same part of another target. Adjacent parts stay adjacent.
fn scaled(viewport: Viewport, from: [u32; 2], to: [u32; 2]) -> Viewport {
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
            let viewport = scaled(clip(pane.viewport, size), size, target);
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
            let lit = quality == Quality::Full && add_light(&mut view, pane, &stage.look, tile);
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

    /// Returns the index of a mesh in this frame, and adds it where it is new.
    fn mesh(&mut self, mesh: &Arc<SkinnedMesh>) -> usize {
        let known = self.meshes.iter().position(|known| Arc::ptr_eq(&known.0, mesh));
        known.unwrap_or_else(|| {
            self.meshes.push(SharedMesh(Arc::clone(mesh)));
            self.meshes.len() - 1
        })
    }

    /// Adds a figure in a skin. Returns the index of its instance.
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
        // A joint that is not finite leaves its vertices in the bind pose.
        for [rotation, shift] in self.joints.iter_mut().skip(first as usize) {
            if !rotation.iter().chain(shift.iter()).all(|part| part.is_finite()) {
                (*rotation, *shift) = ([0.0, 0.0, 0.0, 1.0], [0.0; 4]);
            }
        }
        let color_from = match (skin.colored, ghost || !skin.mesh.has_own_colors()) {
            (true, _) => 1,
            (false, true) => 0,
            (false, false) => 2,
        };
        self.skins.push(SkinInstance { figure: [first, color_from], color: bytes(skin.color) });
        self.skins.len() as u32 - 1
    }

    /// Adds all solid figures in skins. Those with the same mesh are adjacent, and drawn at once.
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
            for same in solids().filter(|other| Arc::ptr_eq(&other.mesh, &skin.mesh)) {
                self.add_skin(pane, same, false);
            }
            let instances = start..self.skins.len() as u32;
            self.solid_skins.push(SkinDraw { mesh, instances });
        }
        first..self.solid_skins.len()
    }

    /// Adds all figures of a pane but solid ones in skins, which have only their shadows here.
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
        // Flat looks have only the main light's shadow, and no soft ones.
        let soft = plain || !flat;
        // The shadows of high limbs are as wide as the body and hardly visible. They are left out
        // where the number of pixels matters.
        let only_low = plain || pane.figures.len() > MAX_SHADED_FIGURES;
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
                casts_key_shadow: light::casts_key_shadow(figure),
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
            // The first limb is the largest: the trunk, which stands for the body's position.
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

    /// Adds the limbs of a figure without a skin.
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
                    >= MIN_FINE_PIXELS
        };
        let instance = |limb: &Limb| limb_instance(limb, figure.shadow);
        let start = self.limbs.len() as u32;
        self.limbs.extend(limbs.iter().filter(|l| is_fine(l)).filter_map(instance));
        let middle = self.limbs.len() as u32;
        self.limbs.extend(limbs.iter().filter(|l| !is_fine(l)).filter_map(instance));
        if middle == start {
            // The lowest come first, so that those that cast shadows are adjacent.
            self.limbs[start as usize..].sort_unstable_by(|a, b| lowest(a).total_cmp(&lowest(b)));
        } else if quality == Quality::Full {
            // In a body without fine limbs, the blending of limbs is not visible.
            let instances = &mut self.limbs[start as usize..];
            find_nearest(&limbs[..limbs.len().min(MAX_NEIGHBOURS)], instances, figure.ghost);
        }
        let end = self.limbs.len() as u32;
        (draw.fine, draw.coarse, draw.casting) = (start..middle, middle..end, start..end);
        draw.uniform = self.figure_uniforms.len();
        self.figure_uniforms.push(figure_uniform(limbs, figure));
    }
}

/// The greatest number of figures in a pane whose high limbs also cast soft shadows.
const MAX_SHADED_FIGURES: usize = 12;

/// The height up to which limbs cast soft shadows where those of high limbs are left out, metres.
const LOW_SHADOW_HEIGHT_M: f32 = 0.5;
