//! Arrays of numbers in the buffers, checked against the bytes that are there.

use super::document::Document;
use crate::ImportError;
use glam::Vec3;
use gltf::json::Index;
use gltf::json::accessor::{
    Accessor, ComponentType, GenericComponentType, IndexComponentType, Type,
};
use gltf::json::buffer::View;
use gltf::json::validation::{Checked, USize64};
use segue_text::msg;

const VALID: &str = "a valid glTF 2.0 file";

/// The layout of elements in a buffer: their bytes, stride, size and count.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.count)
            .filter_map(move |index| self.bytes.get(index * self.stride..)?.get(..self.size))
    }
}

impl Document<'_> {
    /// Reads the elements of an accessor as floats, one element after the other. Normalised
    /// integers are fractions of their largest value (section 3.6.2.2).
    pub(super) fn floats(
        &self,
        index: Index<Accessor>,
        expected: Type,
    ) -> Result<Vec<f32>, ImportError> {
        self.values(index, expected, |component| {
            (component != ComponentType::U32).then_some(number as fn(_, &[u8]) -> _)
        })
    }

    /// Reads the elements of an accessor as unsigned integers: indices of vertices and joints.
    pub(super) fn integers(
        &self,
        index: Index<Accessor>,
        expected: Type,
    ) -> Result<Vec<u32>, ImportError> {
        use ComponentType::{U8, U16, U32};
        self.values(index, expected, |component| {
            matches!(component, U8 | U16 | U32)
                .then_some((|_, bytes| integer(bytes)) as fn(_, &[u8]) -> _)
        })
    }

    /// Reads the elements of an accessor as lengths: integers are plain values unless the accessor
    /// is normalised (`KHR_mesh_quantization`).
    pub(super) fn lengths(
        &self,
        index: Index<Accessor>,
        expected: Type,
    ) -> Result<Vec<f32>, ImportError> {
        if self.root.get(index).is_some_and(|accessor| accessor.normalized) {
            return self.floats(index, expected);
        }
        self.values(index, expected, |component| {
            (component != ComponentType::U32).then_some(plain as fn(_, &[u8]) -> _)
        })
    }

    /// Returns the number of elements that an accessor declares, unchecked.
    pub(super) fn claimed(&self, index: Index<Accessor>) -> u64 {
        self.root.get(index).map_or(0, |accessor| accessor.count.0)
    }

    /// Reads the elements of an accessor. `reader` returns the function that reads one component of
    /// a type, or `None` where the type does not fit.
    fn values<T: Copy + Default>(
        &self,
        index: Index<Accessor>,
        expected: Type,
        reader: impl Fn(ComponentType) -> Option<fn(ComponentType, &[u8]) -> T>,
    ) -> Result<Vec<T>, ImportError> {
        let at = index.value();
        let accessor = self
            .root
            .get(index)
            .ok_or_else(|| self.error(msg!("accessor {at}, which is not there"), VALID))?;
        let (Checked::Valid(GenericComponentType(component)), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(self.error(msg!("accessor {at} of an unknown type"), VALID));
        };
        let Some(read) = reader(component).filter(|_| kind == expected) else {
            let found = msg!(
                "accessor {at} with {kind} of {component}",
                kind = format!("{kind:?}"),
                component = format!("{component:?}")
            );
            return Err(
                self.error(found, msg!("{kind} of another type", kind = format!("{expected:?}")))
            );
        };
        let width = kind.multiplicity();
        let count = self.size(accessor.count)?;
        let mut values = if let Some(view) = accessor.buffer_view {
            let elements =
                self.elements(view, accessor.byte_offset, count, width * component.size())?;
            self.spend(count, size_of::<T>() * width)?;
            let parts = elements.iter().flat_map(|element| element.chunks_exact(component.size()));
            parts.map(|bytes| read(component, bytes)).collect()
        } else {
            // An accessor without a view is all zeros, and no byte of the file bounds their number.
            if count > self.total_bytes() {
                return Err(
                    self.error(msg!("accessor {at} with {count} values and no data"), VALID)
                );
            }
            self.spend(count, size_of::<T>() * width)?;
            vec![T::default(); count * width]
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(IndexComponentType(index_type)) = sparse.indices.component_type
            else {
                return Err(
                    self.error(msg!("accessor {at} with indices of an unknown type"), VALID)
                );
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
                let Some(target) = values.get_mut(start..).and_then(|rest| rest.get_mut(..width))
                else {
                    return Err(
                        self.error(msg!("accessor {at} with an index beyond its end"), VALID)
                    );
                };
                for (value, bytes) in target.iter_mut().zip(content.chunks_exact(component.size()))
                {
                    *value = read(component, bytes);
                }
            }
        }
        Ok(values)
    }

    fn elements(
        &self,
        view: Index<View>,
        offset: Option<USize64>,
        count: usize,
        size: usize,
    ) -> Result<Elements<'_>, ImportError> {
        let at = view.value();
        let view = self
            .root
            .get(view)
            .ok_or_else(|| self.error(msg!("buffer view {at}, which is not there"), VALID))?;
        let buffer = self.buffer(view.buffer.value())?;
        let start = self.size(view.byte_offset.unwrap_or_default())?;
        let (length, offset) =
            (self.size(view.byte_length)?, self.size(offset.unwrap_or_default())?);
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        let bytes = buffer
            .get(start..)
            .and_then(|rest| rest.get(..length))
            .and_then(|view| view.get(offset..));
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() && stride >= size => {
                Ok(Elements { bytes, stride, size, count })
            }
            _ => {
                let found = msg!(
                    "buffer view {at} with {bytes} bytes for {count} values of {size}",
                    bytes = bytes.map_or(0, <[u8]>::len)
                );
                Err(self
                    .error(found, "all bytes of the animation")
                    .with_hint("the file may be cut off"))
            }
        }
    }

    fn size(&self, value: USize64) -> Result<usize, ImportError> {
        usize::try_from(value.0)
            .map_err(|_| self.error(msg!("a size of {bytes} bytes", bytes = value.0), VALID))
    }
}

fn number(component: ComponentType, bytes: &[u8]) -> f32 {
    let plain = plain(component, bytes);
    match component {
        ComponentType::I8 => (plain / 127.0).max(-1.0),
        ComponentType::U8 => plain / 255.0,
        ComponentType::I16 => (plain / 32767.0).max(-1.0),
        ComponentType::U16 => plain / 65535.0,
        ComponentType::F32 | ComponentType::U32 => plain,
    }
}

fn plain(component: ComponentType, bytes: &[u8]) -> f32 {
    match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a]) => f32::from(a.cast_signed()),
        (ComponentType::U8, &[a]) => f32::from(a),
        (ComponentType::I16, &[a, b]) => f32::from(i16::from_le_bytes([a, b])),
        (ComponentType::U16, &[a, b]) => f32::from(u16::from_le_bytes([a, b])),
        _ => 0.0,
    }
}

fn integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

/// Returns vectors from their components, three each.
pub(super) fn vectors(values: &[f32]) -> Vec<Vec3> {
    values.as_chunks::<3>().0.iter().copied().map(Vec3::from_array).collect()
}
