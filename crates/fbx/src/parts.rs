//! Files whose keys would take too much memory at once. They are read in parts: the nodes with the
//! least of the keys, and then, for each span of time that is asked for, the nodes with the keys
//! that decide their transforms in that span. These are the same to the last bit as with all keys.

use crate::OpenError;
use crate::curves::{Curve, CurveFile, KEY_BYTES, Pick, Shape};
use crate::cut::Cut;
use crate::scene::{Node, OpenOptions, Source, are_same, load, nodes};
use crate::take::{self, Curves, Take, WholeCurves};
use std::ops::Range;
use ufbx::{AnimCurve, SceneRoot};

/// The least number of different times of keys in a part.
const MIN_TIMES: usize = 64;

/// A file that is read in parts.
pub(crate) struct Parts<'a> {
    file: CurveFile<'a>,
    options: OpenOptions,
    ticks_per_sec: f64,
    /// For each curve, whether it has the same value for all times.
    is_constant: Vec<bool>,
    /// For each curve, the takes that have it.
    owners: Vec<Owner>,
    /// The nodes, as each part has them.
    nodes: Vec<Node>,
}

/// The takes that have a curve. One bit for each pair of them would grow with the square of a file
/// of many takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Owner {
    /// No take: it may decide how layers are joined.
    None,
    /// The take of this index.
    One(usize),
    /// Several takes.
    Several,
}

impl Owner {
    /// Returns the owner with another take.
    fn with(self, take: usize) -> Self {
        match self {
            Self::None => Self::One(take),
            Self::One(own) if own == take => self,
            _ => Self::Several,
        }
    }

    /// Returns whether the keys of a curve may decide the transforms in a take.
    fn may_be(self, take: usize) -> bool {
        match self {
            Self::One(own) => own == take,
            Self::None | Self::Several => true,
        }
    }
}

/// A part of a file: a span of time of a take.
pub(crate) struct Window {
    take: usize,
    span: Range<f64>,
    pub(crate) root: SceneRoot,
}

impl Window {
    /// Returns whether a time of a take lies in it.
    pub(crate) fn has(&self, take: usize, secs: f64) -> bool {
        take == self.take && self.span.start <= secs && secs <= self.span.end
    }
}

impl<'a> Parts<'a> {
    /// Opens a file with more keys than fit into the memory for them, and returns its scene without
    /// most keys; `None` for another file, or if it is not certain that its parts give the same
    /// motion.
    pub(crate) fn open(
        bytes: &'a [u8],
        options: OpenOptions,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Option<(SceneRoot, Self)>, OpenError> {
        let most = options.max_key_memory / KEY_BYTES;
        let Some(file) = CurveFile::of(bytes, most, options.max_memory)? else {
            return Ok(None);
        };
        let mut parts = Self {
            file,
            options,
            ticks_per_sec: 1.0,
            is_constant: Vec::new(),
            owners: Vec::new(),
            nodes: Vec::new(),
        };
        let root = parts.load(&|_| Pick::Ends, options.meshes, progress)?;
        parts.ticks_per_sec = root.metadata.ktime_second as f64;
        parts.nodes = nodes(&root);
        if !parts.has_curves_of_file(&root) || !parts.is_like(&root) {
            return Ok(None);
        }
        let bare = parts.load(&|_| Pick::Ends, false, progress)?;
        if !parts.is_like(&bare) {
            return Ok(None);
        }
        drop(bare);
        parts.owners = parts.owners_in(&root);
        parts.is_constant = parts.constant_curves(&root, progress)?;
        Ok(Some((root, parts)))
    }

    /// Returns the takes.
    pub(crate) fn takes(&self, root: &SceneRoot) -> Result<Vec<Take>, OpenError> {
        take::takes(root, self, self.options.max_memory)
    }

    /// Reads the part of a take that begins at a time, seconds.
    pub(crate) fn window(&self, index: usize, take: &Take, secs: f64) -> Result<Window, OpenError> {
        let is_own = |curve: usize| self.owners.get(curve).is_none_or(|own| own.may_be(index));
        let curves = self.file.curves.iter().enumerate();
        let keys = curves.filter(|(curve, _)| is_own(*curve)).map(|(_, curve)| curve.len());
        let bytes = keys.sum::<usize>().saturating_mul(KEY_BYTES).max(1);
        let share = self.options.max_key_memory as f64 / bytes as f64;
        let times = (share * take.key_secs.len() as f64) as usize;
        let first = take.key_secs.partition_point(|time| *time <= secs);
        let last = take.key_secs.get(first.saturating_add(times.max(MIN_TIMES)));
        let span = secs..last.copied().unwrap_or(f64::INFINITY);
        let pick = |curve: usize| {
            if is_own(curve) { Pick::Span(span.clone()) } else { Pick::Ends }
        };
        let root = self.load(&pick, false, &mut |_| true)?;
        if !self.is_like(&root) {
            return Err(OpenError::differs());
        }
        Ok(Window { take: index, span, root })
    }

    fn load(
        &self,
        pick: &dyn Fn(usize) -> Pick,
        has_meshes: bool,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<SceneRoot, OpenError> {
        let cut = Cut::new(&self.file, pick, has_meshes, self.ticks_per_sec);
        let options = OpenOptions {
            meshes: has_meshes,
            max_memory: self.options.max_memory.saturating_sub(self.file.memory),
            ..self.options
        };
        load(Source::Cut(cut), options, progress)
    }

    /// Returns whether a scene has the nodes of the others, and as many curves as the file.
    fn is_like(&self, root: &SceneRoot) -> bool {
        root.anim_curves.len() == self.file.curves.len() && are_same(&nodes(root), &self.nodes)
    }

    /// Returns whether a scene with the least of the keys has the curves in the order of the file.
    fn has_curves_of_file(&self, root: &SceneRoot) -> bool {
        let begins = |(curve, read): (&Curve<'_>, &AnimCurve)| {
            let keys = read.keyframes.as_ref();
            curve.begins_with(keys.len(), keys.first().map_or(0.0, |key| key.value))
        };
        root.anim_curves.len() == self.file.curves.len()
            && self.file.curves.iter().zip(&root.anim_curves).all(begins)
    }

    /// Returns the owner of each curve.
    fn owners_in(&self, root: &SceneRoot) -> Vec<Owner> {
        let mut owners = vec![Owner::None; self.file.curves.len()];
        for (index, take) in root.anim_stacks.into_iter().enumerate() {
            let values = take.layers.into_iter().flat_map(|layer| &layer.anim_values);
            for curve in values.flat_map(|value| value.curves.iter().flatten()) {
                if let Some(owner) = owners.get_mut(curve.element.typed_id as usize) {
                    *owner = owner.with(index);
                }
            }
        }
        owners
    }

    /// Returns for each curve whether it has the same value for all times. Where its tangents
    /// decide, ufbx computes them.
    fn constant_curves(
        &self,
        root: &SceneRoot,
        progress: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Vec<bool>, OpenError> {
        let curves = &self.file.curves;
        let mut is_constant: Vec<bool> = curves
            .iter()
            .zip(&root.anim_curves)
            .map(|(curve, read)| match curve.shape() {
                Shape::Constant => true,
                Shape::Unknown => take::is_constant(read),
                Shape::Empty | Shape::Varied | Shape::Level => false,
            })
            .collect();
        let level =
            |curve: &usize| curves.get(*curve).is_some_and(|curve| curve.shape() == Shape::Level);
        let mut left: Vec<usize> = (0..curves.len()).filter(level).rev().collect();
        while !left.is_empty() {
            let (mut probed, mut bytes) = (vec![false; curves.len()], 0);
            while let Some(&curve) = left.last()
                && (bytes == 0 || bytes < self.options.max_key_memory)
            {
                bytes += KEY_BYTES * curves.get(curve).map_or(0, Curve::len);
                if let Some(probed) = probed.get_mut(curve) {
                    *probed = true;
                }
                left.pop();
            }
            let is_probed = |curve: usize| probed.get(curve).is_some_and(|probed| *probed);
            let pick = |curve: usize| if is_probed(curve) { Pick::All } else { Pick::Ends };
            let read = self.load(&pick, false, progress)?;
            let read = read.anim_curves.into_iter().enumerate();
            for (index, curve) in read.filter(|(index, _)| is_probed(*index)) {
                if let Some(constant) = is_constant.get_mut(index) {
                    *constant = take::is_constant(curve);
                }
            }
        }
        Ok(is_constant)
    }

    /// Returns the keys of a curve of a scene, and whether it is constant.
    fn curve(&self, curve: &AnimCurve) -> Option<(&Curve<'a>, bool)> {
        let index = curve.element.typed_id as usize;
        Some((self.file.curves.get(index)?, *self.is_constant.get(index)?))
    }
}

impl Curves for Parts<'_> {
    fn is_empty(&self, curve: &AnimCurve) -> bool {
        match self.curve(curve) {
            Some((own, _)) if own.shape() != Shape::Unknown => own.len() == 0,
            _ => WholeCurves.is_empty(curve),
        }
    }

    fn is_constant(&self, curve: &AnimCurve) -> bool {
        self.curve(curve).is_some_and(|(_, is_constant)| is_constant)
    }

    fn key_secs<'b>(&'b self, curve: &'b AnimCurve) -> Box<dyn Iterator<Item = f64> + 'b> {
        match self.curve(curve) {
            Some((own, _)) if own.shape() != Shape::Unknown => {
                Box::new(own.ticks().map(|ticks| ticks as f64 / self.ticks_per_sec))
            }
            _ => WholeCurves.key_secs(curve),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owner_is_one_take_or_any() {
        let one = Owner::None.with(3).with(3);
        let is_own = |owner: Owner| [2, 3, 4].map(|take| owner.may_be(take));
        assert_eq!(is_own(one), [false, true, false]);
        for owner in [Owner::None, one.with(4), one.with(4).with(3)] {
            assert_eq!(is_own(owner), [true; 3]);
        }
    }
}
