//! A GLB file under construction.

use super::GlbError;
use crate::texture::{WEBP, media_type};
use segue_motion::skin::{Sampler, Texture, Wrap};
use serde_json::{Value, json};
use std::sync::Arc;

pub(super) const UNSIGNED_BYTE: u32 = 5121;
pub(super) const UNSIGNED_SHORT: u32 = 5123;
pub(super) const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const NEAREST: u32 = 9728;
const LINEAR: u32 = 9729;
const LINEAR_MIPMAP_LINEAR: u32 = 9987;
const CLAMP_TO_EDGE: u32 = 33071;
const MIRRORED_REPEAT: u32 = 33648;
const REPEAT: u32 = 10497;
/// The extension by which an image is a WebP.
const TEXTURE_WEBP: &str = "EXT_texture_webp";

/// A file under construction: its binary part, and the JSON that describes it. Each accessor has a
/// view of its own with the same index; those of images come behind.
#[derive(Default)]
pub(in crate::gltf) struct File {
    binary: Vec<u8>,
    pub(super) views: Vec<Value>,
    accessors: Vec<Value>,
    /// The textures; a sampler of each has its index.
    textures: Vec<(Arc<[u8]>, Sampler)>,
}

impl File {
    /// Adds numbers, and returns the index of their accessor.
    pub(super) fn floats(
        &mut self,
        values: &[f32],
        kind: &str,
        bounds: Option<(&[f32], &[f32])>,
    ) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let mut accessor =
            json!({ "componentType": FLOAT, "count": values.len() / width, "type": kind });
        if let Some((low, high)) = bounds {
            accessor["min"] = json!(low);
            accessor["max"] = json!(high);
        }
        self.accessor(&bytes, accessor)
    }

    /// Adds bytes, padded to a multiple of four.
    pub(super) fn accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        let index = self.accessors.len();
        accessor["bufferView"] = json!(index);
        self.accessors.push(accessor);
        self.view(bytes);
        index
    }

    /// Adds bytes, padded to a multiple of four, and their view.
    fn view(&mut self, bytes: &[u8]) {
        self.views.push(
            json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() }),
        );
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
    }

    /// Returns the index of a texture, which is added where it is new.
    pub(super) fn texture(&mut self, texture: &Texture) -> usize {
        let is_same = |(image, sampler): &(Arc<[u8]>, Sampler)| {
            Arc::ptr_eq(image, &texture.image) && *sampler == texture.sampler
        };
        self.textures.iter().position(is_same).unwrap_or_else(|| {
            self.textures.push((Arc::clone(&texture.image), texture.sampler));
            self.textures.len() - 1
        })
    }

    /// Adds the images of all textures, and what refers to them.
    fn add_textures(&mut self, root: &mut Value) {
        let (mut images, mut textures, mut samplers) = (Vec::new(), Vec::new(), Vec::new());
        let mut written: Vec<Arc<[u8]>> = Vec::new();
        for (image, sampled) in std::mem::take(&mut self.textures) {
            let kind = media_type(&image);
            let known = written.iter().position(|known| Arc::ptr_eq(known, &image));
            let source = known.unwrap_or_else(|| {
                images.push(json!({ "bufferView": self.views.len(), "mimeType": kind }));
                self.view(&image);
                written.push(image);
                written.len() - 1
            });
            let sampler = samplers.len();
            let wrap = |wrap| match wrap {
                Wrap::Clamp => CLAMP_TO_EDGE,
                Wrap::Repeat => REPEAT,
                Wrap::Mirror => MIRRORED_REPEAT,
            };
            let [wrap_s, wrap_t] = sampled.wraps.map(wrap);
            let magnified = if sampled.is_nearest { NEAREST } else { LINEAR };
            samplers.push(json!({
                "wrapS": wrap_s, "wrapT": wrap_t, "magFilter": magnified,
                "minFilter": LINEAR_MIPMAP_LINEAR
            }));
            textures.push(if kind == WEBP {
                json!({ "sampler": sampler, "extensions": { TEXTURE_WEBP: { "source": source } } })
            } else {
                json!({ "sampler": sampler, "source": source })
            });
        }
        if textures.iter().any(|texture| texture.get("extensions").is_some()) {
            root["extensionsUsed"] = json!([TEXTURE_WEBP]);
            root["extensionsRequired"] = json!([TEXTURE_WEBP]);
        }
        if !textures.is_empty() {
            root["images"] = Value::Array(images);
            root["samplers"] = Value::Array(samplers);
            root["textures"] = Value::Array(textures);
        }
    }

    /// Returns the whole file: header, JSON and binary part, each padded to a multiple of four.
    pub(in crate::gltf) fn finish(mut self, mut root: Value) -> Result<Vec<u8>, GlbError> {
        self.add_textures(&mut root);
        root["accessors"] = Value::Array(self.accessors);
        root["bufferViews"] = Value::Array(self.views);
        root["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        let mut json = root.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.binary.len();
        let word = |length: usize| {
            u32::try_from(length)
                .map(u32::to_le_bytes)
                .map_err(|_| GlbError::TooLarge(length as u64))
        };
        let mut bytes = Vec::with_capacity(length);
        bytes.extend_from_slice(b"glTF");
        bytes.extend_from_slice(&2_u32.to_le_bytes());
        bytes.extend_from_slice(&word(length)?);
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", self.binary)] {
            bytes.extend_from_slice(&word(chunk.len())?);
            bytes.extend_from_slice(kind);
            bytes.extend_from_slice(&chunk);
        }
        Ok(bytes)
    }
}
