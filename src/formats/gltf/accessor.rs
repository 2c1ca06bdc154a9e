//! Arrays of numbers in the buffers, checked against the bytes that are there.

use super::document::Document;
use crate::formats::ImportError;
use gltf::json::Index;
use gltf::json::accessor::{Accessor, ComponentType, GenericComponentType, IndexComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::{Checked, USize64};

const VALID: &str = "a valid glTF 2.0 file";

/// Where elements lie: their bytes, from one to the next, and how many.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.count).filter_map(move |index| self.bytes.get(index * self.stride..)?.get(..self.size))
    }
}

impl Document<'_> {
    /// The elements of an accessor as numbers, one element after the other. Integers are fractions of their largest value (section 3.6.2.2).
    pub(super) fn floats(&self, index: Index<Accessor>, expected: Type) -> Result<Vec<f32>, ImportError> {
        let at = index.value();
        let accessor = self
            .root
            .get(index)
            .ok_or_else(|| self.error(format!("accessor {at}, which is not there"), VALID))?;
        let (Checked::Valid(GenericComponentType(component)), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(self.error(format!("accessor {at} of an unknown type"), VALID));
        };
        if kind != expected || component == ComponentType::U32 {
            let found = format!("accessor {at} with {kind:?} of {component:?}");
            return Err(self.error(found, &format!("{expected:?} of F32")));
        }
        let width = kind.multiplicity();
        let count = self.size(accessor.count)?;
        let mut values = if let Some(view) = accessor.buffer_view {
            let elements = self.elements(view, accessor.byte_offset, count, width * component.size())?;
            self.spend(count, 4 * width)?;
            let parts = elements.iter().flat_map(|element| element.chunks_exact(component.size()));
            parts.map(|bytes| number(component, bytes)).collect()
        } else {
            // Zeros that no byte stands for.
            if count > self.total_bytes() {
                return Err(self.error(format!("accessor {at} with {count} values and no data"), VALID));
            }
            self.spend(count, 4 * width)?;
            vec![0.0; count * width]
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(IndexComponentType(index_type)) = sparse.indices.component_type else {
                return Err(self.error(format!("accessor {at} with indices of an unknown type"), VALID));
            };
            let count = self.size(sparse.count)?;
            let places = self.elements(
                sparse.indices.buffer_view,
                Some(sparse.indices.byte_offset),
                count,
                index_type.size(),
            )?;
            let contents = self.elements(
                sparse.values.buffer_view,
                Some(sparse.values.byte_offset),
                count,
                width * component.size(),
            )?;
            for (place, content) in places.iter().zip(contents.iter()) {
                let start = (integer(place) as usize).saturating_mul(width);
                let Some(target) = values.get_mut(start..).and_then(|rest| rest.get_mut(..width)) else {
                    return Err(self.error(format!("accessor {at} with an index beyond its end"), VALID));
                };
                for (value, bytes) in target.iter_mut().zip(content.chunks_exact(component.size())) {
                    *value = number(component, bytes);
                }
            }
        }
        Ok(values)
    }

    fn elements(&self, view: Index<View>, offset: Option<USize64>, count: usize, size: usize) -> Result<Elements<'_>, ImportError> {
        let at = view.value();
        let view = self
            .root
            .get(view)
            .ok_or_else(|| self.error(format!("buffer view {at}, which is not there"), VALID))?;
        let buffer = self.buffer(view.buffer.value())?;
        let start = self.size(view.byte_offset.unwrap_or_default())?;
        let (length, offset) = (self.size(view.byte_length)?, self.size(offset.unwrap_or_default())?);
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        let bytes = buffer
            .get(start..)
            .and_then(|rest| rest.get(..length))
            .and_then(|view| view.get(offset..));
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() && stride >= size => Ok(Elements {
                bytes,
                stride,
                size,
                count,
            }),
            _ => {
                let found = format!(
                    "buffer view {at} with {} bytes for {count} values of {size}",
                    bytes.map_or(0, <[u8]>::len)
                );
                Err(self.error(found, "all bytes of the animation").with_hint("the file may be cut off"))
            }
        }
    }

    fn size(&self, value: USize64) -> Result<usize, ImportError> {
        usize::try_from(value.0).map_err(|_| self.error(format!("a size of {} bytes", value.0), VALID))
    }
}

fn number(component: ComponentType, bytes: &[u8]) -> f32 {
    match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a]) => (f32::from(a.cast_signed()) / 127.0).max(-1.0),
        (ComponentType::U8, &[a]) => f32::from(a) / 255.0,
        (ComponentType::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])) / 32767.0).max(-1.0),
        (ComponentType::U16, &[a, b]) => f32::from(u16::from_le_bytes([a, b])) / 65535.0,
        _ => 0.0,
    }
}

fn integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
