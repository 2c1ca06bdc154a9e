//! The stage as a paint callback of egui.

use super::StageRenderer;
use super::quality::Refinement;
use super::renderer::REFINE_AFTER;
use eframe::egui::{self, PaintCallbackInfo, epaint::ViewportInPixels};
use eframe::egui_wgpu::{
    Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor,
};
use eframe::wgpu;
use segue_scene::Stage;
use std::sync::Arc;

/// Makes the renderer, and stores it in egui's resources. Call it once, when the app is created.
pub(crate) fn install(render_state: &RenderState) {
    let (device, queue, adapter) =
        (&render_state.device, &render_state.queue, &render_state.adapter);
    let renderer = StageRenderer::new(device, queue, adapter, render_state.target_format);
    render_state.renderer.write().callback_resources.insert(renderer);
}

/// Returns a shape that shows `stage` in `rect`. Every stage of the page has an `id` of its own.
///
/// Keep the `Arc`, and change the stage with `Arc::make_mut` in the next frame. egui has dropped
/// its handle by then, so that nothing is copied.
pub(crate) fn paint_callback(
    id: u64,
    rect: egui::Rect,
    stage: Arc<Stage>,
    refinement: Refinement,
    ctx: &egui::Context,
) -> egui::Shape {
    let ctx = ctx.clone();
    egui::Shape::Callback(Callback::new_paint_callback(
        rect,
        StageCallback { id, rect, stage, refinement, ctx },
    ))
}

/// Returns the size in physical pixels of the target for a stage in `rect`. The viewports of the
/// panes divide it.
pub(crate) fn stage_pixels(ctx: &egui::Context, rect: egui::Rect) -> [u32; 2] {
    let pixels_per_point = ctx.pixels_per_point();
    let screen = ctx.content_rect().size() * pixels_per_point;
    in_pixels(rect, pixels_per_point, [screen.x.round() as u32, screen.y.round() as u32])
}

/// Returns whether nothing is missing in the stage that was prepared last, such as a texture that
/// is being decoded.
pub(crate) fn is_stage_complete(ctx: &egui::Context) -> bool {
    !ctx.data(|data| data.get_temp(is_incomplete_id())).unwrap_or(false)
}

fn is_incomplete_id() -> egui::Id {
    egui::Id::unique("stage is incomplete")
}

fn in_pixels(rect: egui::Rect, pixels_per_point: f32, screen: [u32; 2]) -> [u32; 2] {
    let pixels = ViewportInPixels::from_points(&rect, pixels_per_point, screen);
    [pixels.width_px.max(0) as u32, pixels.height_px.max(0) as u32]
}

struct StageCallback {
    id: u64,
    rect: egui::Rect,
    stage: Arc<Stage>,
    refinement: Refinement,
    ctx: egui::Context,
}

impl CallbackTrait for StageCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(renderer) = resources.get_mut::<StageRenderer>() {
            let size = in_pixels(self.rect, screen.pixels_per_point, screen.size_in_pixels);
            renderer.begin_frame(self.ctx.input(|input| input.time), self.refinement);
            let prepared = renderer.prepare(device, queue, encoder, self.id, &self.stage, size);
            self.ctx.data_mut(|data| data.insert_temp(is_incomplete_id(), !prepared.complete));
            if !prepared.complete {
                self.ctx.request_repaint();
            } else if prepared.to_be_refined {
                self.ctx.request_repaint_after(REFINE_AFTER);
            }
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(renderer) = resources.get::<StageRenderer>() {
            renderer.paint(pass, self.id);
        }
    }
}
