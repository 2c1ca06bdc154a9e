//! The skeleton of the benches.

use glam::{Quat, Vec3};
use segue_motion::skeleton::{Joint, Skeleton};
use std::sync::Arc;

/// Returns six chains of five joints below a root: 31 joints, as many as the CMU skeleton has.
pub(crate) fn skeleton() -> Arc<Skeleton> {
    let joint = |index: usize| {
        let (chain, link) = (index.div_ceil(5), (index + 4) % 5);
        let parent = (index > 0).then(|| if link == 0 { 0 } else { index - 1 });
        let name = format!("Joint{index}");
        let turn = Quat::from_rotation_y(chain as f32);
        let offset = if index == 0 { Vec3::Y } else { turn * Vec3::new(0.05, 0.2, 0.02) };
        Joint { name, parent, offset, end_site: None, channels: vec![] }
    };
    Arc::new(Skeleton::new((0..31).map(joint).collect()).expect("parents come first"))
}
