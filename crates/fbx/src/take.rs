//! The takes of a file: which nodes move, and the times of their keys.

use crate::OpenError;
use std::ops::Range;
use ufbx::{AnimCurve, AnimStack, SceneRoot};

/// The properties of a node that its transform depends on.
const TRANSFORM: [&str; 10] = [
    "Lcl Translation",
    "Lcl Rotation",
    "Lcl Scaling",
    "PreRotation",
    "PostRotation",
    "RotationOffset",
    "RotationPivot",
    "ScalingOffset",
    "ScalingPivot",
    "RotationOrder",
];

/// The movement of a node in a take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Movement {
    /// It has no keys: its transform is the one outside of the takes.
    Still,
    /// Its keys give the same transform for every time.
    Held,
    /// It moves.
    Moves,
}

/// A take: an animation of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Its name.
    pub name: String,
    /// The time range in which it plays, seconds; `None` if the file states none.
    pub span_secs: Option<Range<f64>>,
    /// The times of all keys of all moving nodes, seconds, ascending; where no node moves, those of
    /// all nodes, which say how long they are held.
    pub key_secs: Vec<f64>,
    /// Node by node.
    pub movements: Vec<Movement>,
}

/// Facts about curves, whether all their keys are in memory or a part.
pub(crate) trait Curves {
    /// Returns whether a curve has no keys.
    fn is_empty(&self, curve: &AnimCurve) -> bool;

    /// Returns whether a curve has the same value for all times.
    fn is_constant(&self, curve: &AnimCurve) -> bool;

    /// Returns the times of a curve's keys, seconds.
    fn key_secs<'a>(&'a self, curve: &'a AnimCurve) -> Box<dyn Iterator<Item = f64> + 'a>;
}

/// Curves with all their keys.
pub(crate) struct WholeCurves;

impl Curves for WholeCurves {
    fn is_empty(&self, curve: &AnimCurve) -> bool {
        curve.keyframes.is_empty()
    }

    fn is_constant(&self, curve: &AnimCurve) -> bool {
        is_constant(curve)
    }

    fn key_secs<'a>(&'a self, curve: &'a AnimCurve) -> Box<dyn Iterator<Item = f64> + 'a> {
        Box::new(curve.keyframes.as_ref().iter().map(|key| key.time))
    }
}

/// Returns the takes of a scene, if they take no more than `max_memory` bytes: many takes may have
/// the same layers.
pub(crate) fn takes(
    root: &SceneRoot,
    curves: &dyn Curves,
    max_memory: usize,
) -> Result<Vec<Take>, OpenError> {
    let (mut takes, mut left) = (Vec::new(), max_memory);
    for stack in &root.anim_stacks {
        let nodes = root.nodes.len() * size_of::<Movement>();
        left = left.checked_sub(nodes).ok_or(OpenError::Memory)?;
        let take = take(root, stack, curves);
        left = left.checked_sub(size_of_val(&*take.key_secs)).ok_or(OpenError::Memory)?;
        takes.push(take);
    }
    Ok(takes)
}

fn take(root: &SceneRoot, stack: &AnimStack, curves: &dyn Curves) -> Take {
    // Without the root node of ufbx.
    let mut movements = vec![Movement::Still; root.nodes.len().saturating_sub(1)];
    let (mut times, mut held) = (Times::default(), Vec::new());
    for layer in &stack.layers {
        for prop in layer.anim_props.as_ref() {
            let node = ufbx::as_node(&prop.element);
            let (Some(node), true) = (node, TRANSFORM.contains(&prop.prop_name.as_ref())) else {
                continue;
            };
            let place = (node.element.typed_id as usize).checked_sub(1);
            let Some(movement) = place.and_then(|place| movements.get_mut(place)) else {
                continue;
            };
            for curve in prop.anim_value.curves.iter().flatten() {
                if curves.is_empty(curve) {
                    continue;
                }
                if curves.is_constant(curve) && !layer.weight_is_animated {
                    *movement = (*movement).max(Movement::Held);
                    held.push(curve);
                } else {
                    *movement = Movement::Moves;
                    times.add(|| curves.key_secs(curve));
                }
            }
        }
    }
    if times.all.is_empty() {
        for curve in held {
            times.add(|| curves.key_secs(curve));
        }
    }
    follow_scales(root, &mut movements);
    let span = stack.time_begin..stack.time_end;
    Take {
        name: stack.element.name.as_ref().to_owned(),
        span_secs: (span.start.is_finite() && span.end.is_finite() && span.start < span.end)
            .then_some(span),
        key_secs: times.merged(),
        movements,
    }
}

/// Returns whether a curve with all its keys is constant: equal keys with flat tangents.
pub(crate) fn is_constant(curve: &AnimCurve) -> bool {
    let keys = curve.keyframes.as_ref();
    let first = keys.first().map_or(0.0, |key| key.value);
    keys.iter().all(|key| key.value == first && key.left.dy == 0.0 && key.right.dy == 0.0)
        || keys.len() == 1
}

/// Marks the scale helpers that ufbx adds as moving with the nodes that they belong to, and the
/// siblings whose translation they scale as well.
fn follow_scales(root: &SceneRoot, movements: &mut [Movement]) {
    for (place, node) in root.nodes.into_iter().skip(1).enumerate() {
        let Some(parent) = &node.parent else { continue };
        let above = (parent.element.typed_id as usize)
            .checked_sub(1)
            .and_then(|parent| movements.get(parent).copied());
        let helper = parent
            .scale_helper
            .as_ref()
            .and_then(|helper| (helper.element.typed_id as usize).checked_sub(1))
            .and_then(|helper| movements.get(helper).copied());
        if node.is_scale_helper || parent.scale_helper.is_some() {
            let with = above.max(helper).unwrap_or(Movement::Still);
            if let Some(movement) = movements.get_mut(place) {
                *movement = (*movement).max(with);
            }
        }
    }
}

/// The key times of curves; most curves share theirs.
#[derive(Default)]
struct Times {
    /// Ascending and without duplicates up to `merged`, and behind it as they were added.
    all: Vec<f64>,
    merged: usize,
    /// The key times of the last curve.
    last: Vec<f64>,
}

impl Times {
    fn add<'a>(&mut self, secs: impl Fn() -> Box<dyn Iterator<Item = f64> + 'a>) {
        if secs().eq(self.last.iter().copied()) {
            return;
        }
        self.last.clear();
        self.last.extend(secs());
        self.all.extend(self.last.iter().copied().filter(|time| time.is_finite()));
        // Often enough to keep the list short, and seldom enough for thousands of curves that have
        // times of their own.
        if self.all.len() > 2 * self.merged {
            self.merge();
        }
    }

    fn merge(&mut self) {
        self.all.sort_by(f64::total_cmp);
        self.all.dedup();
        self.merged = self.all.len();
    }

    fn merged(mut self) -> Vec<f64> {
        self.merge();
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_times_of_curves_are_all_of_theirs_once() {
        let (mut times, mut expected) = (Times::default(), Vec::new());
        for curve in 0..50_u32 {
            let own = (0..curve % 7 * 10).map(|key| f64::from(key * (curve % 3) + curve / 20));
            let own: Vec<f64> = own.chain([f64::NAN]).collect();
            times.add(|| Box::new(own.iter().copied()));
            expected.extend(own.into_iter().filter(|time| time.is_finite()));
        }
        expected.sort_by(f64::total_cmp);
        expected.dedup();
        assert_eq!(times.merged(), expected);
    }
}
