//! Rendering of a [`segue_scene::Stage`] with wgpu, inside the page that egui paints.
//!
//! The stage is drawn in egui's prepare step into a target of its own (multisampled, with depth)
//! and copied into the page, pixel by pixel, in its paint step. A stage that did not change since
//! the last frame is not drawn again. Everything runs on `WebGL2`: instance attributes and small
//! uniform blocks, no storage buffers.

mod buffers;
mod callback;
mod coarse_mesh;
mod encode;
mod frame;
#[cfg(test)]
mod image;
mod instances;
mod layout;
mod light;
mod mesh;
mod pipelines;
mod quality;
mod renderer;
mod skins;
mod targets;
#[cfg(test)]
mod tests;
mod textures;
mod view;
mod view_uniform;

pub(crate) use callback::{install, is_stage_complete, paint_callback, stage_pixels};
#[cfg(test)]
use image::{Image, render_to_image};
#[cfg(test)]
use quality::Quality;
pub(crate) use quality::Refinement;
pub(crate) use renderer::StageRenderer;
