//! The draw list of a session as plain data: cameras, limbs, lines and rings. The crate does not
//! depend on a GPU, and a renderer does not depend on the session.
//!
//! # The idea
//!
//! A [`Stage`] is one rectangle of the page with one or several [`Pane`]s in it. A pane has a
//! [`Camera`] and lists what it shows; the [`Director`] makes the list from a
//! [`segue_session::Session`] and a time. Every skeleton has a [`Body`] from its bones' lengths
//! alone, a rounded cone along each bone, so that every file that loads is visible at once.
//!
//! The camera orbits its target on a sphere: yaw along the equator, pitch up to the pole.
//!
//! ```text
//! eye   = target + distance · (sin yaw cos pitch, sin pitch, cos yaw cos pitch)
//! pixel → ray from the eye → ground:  t = -origin.y / direction.y
//! ```
//!
//! At yaw 0 it looks at the face of a character that faces +Z, whose left hand is then on the right
//! of the picture. A [`CameraRig`] moves it to its goal as a critically damped spring.
//!
//! Colours here are `[red, green, blue, alpha]` in 0–1 as written in a palette (sRGB-encoded, alpha
//! straight); see [`rgb`].
//!
//! # Example
//!
//! ```
//! use glam::{Vec2, Vec3};
//! use segue_scene::{Body, Bounds, Pane, Viewport, rgb};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let walk = synthesize(&Params::new(Action::Walk))?.clip;
//! let (body, pose) = (Body::new(walk.skeleton(), None), walk.world_pose(0));
//! let viewport = Viewport { x: 0, y: 0, width: 640, height: 360 };
//! let mut pane = Pane { viewport, ..Pane::default() };
//! pane.add_body(&body, &pose, rgb(0x00d9_c8b4));
//! assert_eq!(pane.limbs.len(), body.limb_count());
//!
//! // The whole body in the picture.
//! let mut bounds = Bounds::EMPTY;
//! bounds.include_pose(&pose);
//! pane.camera.frame(&bounds, viewport.aspect());
//! let size = viewport.size();
//! let is_seen = |at: Vec2| at.cmpge(Vec2::ZERO).all() && at.cmple(size).all();
//! let seen_at = |&point: &Vec3| pane.camera.project(point, size).is_some_and(is_seen);
//! assert!(pose.positions.iter().all(seen_at));
//!
//! // A place on the ground, to its pixel and back.
//! let place = Vec3::new(0.3, 0.0, 0.2);
//! let pixel = pane.camera.project(place, size).ok_or("behind the camera")?;
//! let hit = pane.camera.ray(pixel, size).ground_hit().ok_or("no ground there")?;
//! assert!(hit.distance(place) < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! The ray through a pixel projects back to that pixel within a tenth of one; a framed box fills
//! the picture with a margin of 6 %; the motion of a rig does not depend on the frame rate. A stage
//! is O(limbs shown) per frame.
//!
//! # What it does not do
//!
//! It generates no meshes: limbs are rounded cones, and the meshes of skins come from
//! [`segue_motion::skin`]. It computes neither light nor shadows: a [`Figure`] only has the
//! strength of its shadow on the ground.

mod annotations;
mod body;
mod body_cache;
mod bounds;
mod camera;
mod camera_rig;
#[cfg(test)]
mod character_tests;
mod color;
mod context;
mod director;
mod extra_characters;
mod framing;
mod ground_path;
mod highlights;
mod hinges;
mod labs;
mod look;
mod pane;
mod posing;
mod primitives;
mod result;
mod sources;
mod stage;
mod viewport;

pub use body::Body;
pub use bounds::Bounds;
pub use camera::{Camera, Lens, Ray};
pub use camera_rig::CameraRig;
pub use color::{Color, Colors, rgb, with_alpha};
pub use director::{Director, StageOptions};
pub use framing::{camera_of, resting_point, shown_size, view_size};
pub use highlights::{Highlights, PathMarks};
pub use look::Look;
pub use pane::Pane;
pub use posing::pose_at;
pub use primitives::{Figure, Layer, Limb, Ring, Skin, Skinning, Stroke};
pub use stage::Stage;
pub use viewport::Viewport;
