//! What is to be seen, as plain data: cameras, limbs, lines and rings. It knows no GPU; the renderer knows no session.
//!
//! A [`Stage`] is one rectangle of the page with one or several [`Pane`]s in it. A pane has a [`Camera`] and lists what it shows. Every
//! skeleton has a [`Body`] from its bones' lengths alone, so that whatever loads can be seen at once.
//!
//! Colours here are `[red, green, blue, alpha]` in 0–1 as written in a palette (sRGB-encoded, alpha straight); see [`rgb`].

mod body;
mod bounds;
mod build;
mod camera;
mod dress;
mod drive;
mod path;
mod rig;
mod stage;

pub use body::Body;
pub use bounds::Bounds;
pub use build::{Colors, Director, camera_of, figure_height, pose_at, resting_point};
pub use camera::{Camera, Lens, Ray};
pub use path::PathMarks;
pub use rig::CameraRig;
pub use stage::{Color, Figure, Layer, Limb, Look, Pane, Ring, Skin, Skinning, Stage, Stroke, Viewport, rgb, with_alpha};
