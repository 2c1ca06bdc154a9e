//! Panels that stand still while a motion plays.
//!
//! egui lays out every panel anew in each frame, although all but the stage and the timeline come
//! out as before while a motion plays and nobody touches the page. A panel that has come out the
//! same for a while is therefore painted again from its triangles, and egui is told where its
//! widgets were, so that the next click finds them. Now and then it is drawn anew, to see whether
//! it still comes out the same.

use super::state::UiState;
use eframe::egui::epaint::{ClippedShape, Primitive};
use eframe::egui::layers::PaintList;
use eframe::egui::text_selection::LabelSelectionState;
use eframe::egui::{
    Context, CursorIcon, Id, Mesh, Order, Rect, Shape, Ui, WidgetRect, accesskit_root_id,
};
use std::collections::HashMap;
use std::sync::Arc;

/// The time without an event after which panels may stand still, seconds: a tooltip comes sooner.
const QUIET_SECS: f64 = 1.0;
/// The number of frames after that in which a panel must come out the same.
const PROOF_FRAMES: u32 = 4;
/// The number of frames in a row in which panels stand still: about a second.
const STILL_FRAMES: u32 = 60;

/// The panels that stand still.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stillness {
    mode: Mode,
    /// The time of the first frame of those in a row in which nothing happened, seconds.
    quiet_since: Option<f64>,
    /// The number of frames in a row in which panels were watched or stood still.
    frames: u32,
    panels: HashMap<&'static str, Panel>,
    glyphs: Glyphs,
    /// The pointer's icon of the last frame in which all panels were drawn.
    cursor: CursorIcon,
}

/// The way in which the panels are shown in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Mode {
    /// They are drawn.
    #[default]
    Drawn,
    /// They are drawn, and compared with the last frame.
    Watched,
    /// Those that came out the same are painted again.
    Still,
}

/// The texture of the fonts: its size, and the share of it that is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Glyphs {
    size: [usize; 2],
    used: f32,
}

impl Glyphs {
    fn of(ctx: &Context) -> Self {
        ctx.fonts(|fonts| Self {
            size: fonts.font_image_size(),
            used: fonts.font_atlas_fill_ratio(),
        })
    }
}

impl Stillness {
    /// Begins a frame. `is_quiet`: nothing has happened since the last one but that time passed.
    pub(crate) fn begin(&mut self, is_quiet: bool, ctx: &Context) {
        let was_expected = is_expected(ctx);
        let glyphs = Glyphs::of(ctx);
        // Otherwise the places of the glyphs in the texture are others.
        let has_glyphs = glyphs.size == self.glyphs.size && glyphs.used >= self.glyphs.used;
        self.glyphs = glyphs;
        let now = ctx.input(|input| input.time);
        if is_quiet && has_glyphs && is_untouched(ctx) {
            let since = *self.quiet_since.get_or_insert(now);
            self.frames = if now - since >= QUIET_SECS { self.frames + 1 } else { 0 };
        } else {
            *self = Self { glyphs, cursor: self.cursor, ..Self::default() };
        }
        self.mode = mode_of(self.frames);
        // Without a description of its widgets, a panel would be gone for screen readers.
        let is_described = ctx.has_accesskit_node(accesskit_root_id());
        if is_described && self.mode == Mode::Still {
            self.mode = Mode::Watched;
        }
        if was_expected && self.mode != Mode::Still {
            // This frame's widgets could not be described.
            ctx.request_repaint();
        }
        let expects = mode_of(self.frames + 1) == Mode::Still;
        ctx.data_mut(|data| data.insert_temp(expected_id(), expects));
        if self.mode == Mode::Still {
            ctx.set_cursor_icon(self.cursor);
        }
    }

    /// Ends a frame.
    pub(super) fn end(&mut self, ctx: &Context) {
        if self.mode != Mode::Still {
            self.cursor = ctx.output(|output| output.cursor_icon);
        }
    }

    /// Returns whether panels stand still in this frame, and change nothing.
    pub(super) fn is_still(&self) -> bool {
        self.mode == Mode::Still
    }
}

/// Returns the mode of a frame by its number among those in a row in which nothing happens.
fn mode_of(frame: u32) -> Mode {
    match frame.checked_sub(PROOF_FRAMES + 1) {
        None if frame == 0 => Mode::Drawn,
        None => Mode::Watched,
        Some(after) if after % (STILL_FRAMES + 1) == STILL_FRAMES => Mode::Watched,
        Some(_) => Mode::Still,
    }
}

/// Returns whether panels will stand still in the next frame if nothing happens.
pub(crate) fn is_expected(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(expected_id())).unwrap_or(false)
}

fn expected_id() -> Id {
    Id::unique("panels are expected to stand still")
}

/// Returns whether nobody touches the page, and nothing lies over the panels.
fn is_untouched(ctx: &Context) -> bool {
    let is_idle = ctx.input(|input| {
        input.events.is_empty()
            && input.keys_down.is_empty()
            && input.raw.hovered_files.is_empty()
            && !input.pointer.any_down()
            && !input.is_scrolling()
    });
    let is_bare = ctx.memory(|memory| {
        memory.areas().visible_layer_ids().iter().all(|layer| layer.order == Order::Background)
    });
    is_idle
        && is_bare
        && !ctx.text_edit_focused()
        && !ctx.plugin::<LabelSelectionState>().lock().has_selection()
}

/// The picture and the widgets of a panel.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    room: Rect,
    pixels_per_point: f32,
    min_rect: Rect,
    /// The triangles of its shapes by their clip rectangles.
    meshes: Vec<(Rect, Arc<Mesh>)>,
    widgets: Vec<WidgetRect>,
}

/// A panel that was watched.
#[derive(Clone, Debug)]
enum Panel {
    /// It came out like this.
    Same(Drawn),
    /// It differs from frame to frame, and is drawn in each until something happens.
    Lively,
}

/// Draws the contents of a panel, or paints them again while they stand still.
pub(super) fn still_ui(
    name: &'static str,
    state: &mut UiState,
    ui: &mut Ui,
    content: impl FnOnce(&mut UiState, &mut Ui),
) {
    let mode = state.stillness.mode;
    if mode == Mode::Drawn {
        return content(state, ui);
    }
    let panel = match state.stillness.panels.remove(name) {
        Some(Panel::Same(drawn)) if mode == Mode::Still && drawn.fits(ui) => {
            drawn.repeat(ui);
            Panel::Same(drawn)
        }
        Some(Panel::Lively) => {
            content(state, ui);
            Panel::Lively
        }
        before => {
            let (shapes, widgets) = counts(ui);
            content(state, ui);
            match (before, Drawn::since(shapes, widgets, ui)) {
                (None, Some(now)) => Panel::Same(now),
                (Some(Panel::Same(before)), Some(now)) if before == now => Panel::Same(before),
                _ => Panel::Lively,
            }
        }
    };
    state.stillness.panels.insert(name, panel);
}

/// Returns the number of shapes and of widgets in the layer so far.
fn counts(ui: &Ui) -> (usize, usize) {
    let layer = ui.layer_id();
    let shapes = ui.ctx().graphics(|all| all.get(layer).map_or(0, |list| list.all_entries().len()));
    let widgets = ui.ctx().viewport(|viewport| viewport.this_pass.widgets.get_layer(layer).count());
    (shapes, widgets)
}

impl Drawn {
    /// Returns what was drawn into a panel after so many shapes and widgets of its layer; `None`
    /// where something has no triangles.
    fn since(shapes: usize, widgets: usize, ui: &Ui) -> Option<Self> {
        let (ctx, layer) = (ui.ctx(), ui.layer_id());
        let shapes: Vec<ClippedShape> = ctx.graphics(|all| {
            let all = all.get(layer).into_iter().flat_map(PaintList::all_entries);
            all.skip(shapes).cloned().collect()
        });
        Some(Self {
            room: ui.max_rect(),
            pixels_per_point: ctx.pixels_per_point(),
            min_rect: ui.min_rect(),
            meshes: meshes(shapes, ui)?,
            widgets: ctx.viewport(|viewport| {
                viewport.this_pass.widgets.get_layer(layer).skip(widgets).copied().collect()
            }),
        })
    }

    fn fits(&self, ui: &Ui) -> bool {
        self.room == ui.max_rect() && self.pixels_per_point == ui.ctx().pixels_per_point()
    }

    /// Paints what was drawn, and registers its widgets.
    fn repeat(&self, ui: &mut Ui) {
        for (clip, mesh) in &self.meshes {
            ui.painter().with_clip_rect(*clip).add(Shape::Mesh(Arc::clone(mesh)));
        }
        let clip = ui.clip_rect();
        let register = |enabled: bool, ui: &mut Ui| {
            for widget in self.widgets.iter().filter(|widget| widget.enabled == enabled) {
                ui.set_clip_rect(widget.interact_rect);
                ui.interact(widget.rect, widget.id, widget.sense);
            }
            ui.set_clip_rect(clip);
        };
        register(true, ui);
        if self.widgets.iter().any(|widget| !widget.enabled) {
            ui.add_enabled_ui(false, |ui| register(false, ui));
        }
        ui.expand_to_include_rect(self.min_rect);
    }
}

/// Returns the triangles of a panel's shapes; `None` where something has none. Those that a clip
/// rectangle does not cut are clipped with the panel, so that fewer calls draw them.
fn meshes(shapes: Vec<ClippedShape>, ui: &Ui) -> Option<Vec<(Rect, Arc<Mesh>)>> {
    let whole = ui.clip_rect();
    let mut meshes: Vec<(Rect, Mesh)> = Vec::new();
    for primitive in ui.ctx().tessellate(shapes, ui.ctx().pixels_per_point()) {
        let Primitive::Mesh(mesh) = primitive.primitive else { return None };
        let is_cut = !primitive.clip_rect.contains_rect(mesh.calc_bounds());
        let clip = if is_cut { primitive.clip_rect } else { whole };
        match meshes.last_mut() {
            Some((last, all)) if *last == clip && all.texture_id == mesh.texture_id => {
                all.append(mesh);
            }
            _ => meshes.push((clip, mesh)),
        }
    }
    Some(meshes.into_iter().map(|(clip, mesh)| (clip, Arc::new(mesh))).collect())
}
