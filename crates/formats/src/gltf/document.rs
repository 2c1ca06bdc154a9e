//! The JSON of a file and the binary buffers that it refers to.

use super::humanoid::Humanoid;
use super::texture::WebpTextures;
use crate::text::{decode, short};
use crate::texture::ImageBytes;
use crate::{ImportError, Resolve};
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::json::{Root, Value};
use segue_text::{Message, msg};
use std::cell::Cell;
use std::sync::Arc;

/// The extensions whose buffers have no data but in a packed form.
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// A file, split into JSON and buffers. Nothing in `root` has been checked.
pub(super) struct Document<'a> {
    name: &'a str,
    pub(super) root: Root,
    buffers: Vec<Buffer<'a>>,
    /// The bone map, where the file has one.
    pub(super) humanoid: Option<Humanoid>,
    /// The error of a bone map that cannot be read.
    pub(super) broken_humanoid: Option<serde_json::Error>,
    /// The images in WebP of its textures.
    pub(super) webp: WebpTextures,
    resolve: Resolve<'a>,
    /// The number of bytes that may still be allocated for this file.
    left: Cell<usize>,
}

enum Buffer<'a> {
    Slice(&'a [u8]),
    Shared(Arc<[u8]>),
    /// The reason why the buffer is missing. It is an error only if the buffer is needed.
    Missing(Message),
}

impl<'a> Document<'a> {
    /// Opens a file. `most` bounds the bytes that are allocated for it: a few bytes of JSON may
    /// declare any number of values.
    pub(super) fn open(
        name: &'a str,
        bytes: &'a [u8],
        resolve: Resolve<'a>,
        most: usize,
    ) -> Result<Self, ImportError> {
        let (json, binary) = if bytes.starts_with(b"glTF") {
            chunks(bytes).map_err(|found| {
                ImportError::whole_file(name, found, "a whole glTF 2.0 file (.glb)")
            })?
        } else {
            (bytes, None)
        };
        let json = decode(json);
        let root = parse(name, &json)?;
        let (humanoid, broken_humanoid) = match Humanoid::read(&json) {
            Ok(humanoid) => (humanoid, None),
            Err(error) => (None, Some(error)),
        };
        let buffers = root.buffers.iter().enumerate();
        let buffers = buffers.map(|(index, buffer)| match (&buffer.uri, binary) {
            (None, Some(binary)) if index == 0 => Buffer::Slice(binary),
            (None, _) => Buffer::Missing(msg!("buffer {index} without data")),
            (Some(uri), _) => match uri.strip_prefix("data:") {
                Some(data) => embedded(data).map_or_else(
                    || Buffer::Missing(msg!("buffer {index} with data that is not Base64")),
                    |bytes| Buffer::Shared(bytes.into()),
                ),
                None => external(uri, resolve).map_or_else(
                    || {
                        Buffer::Missing(msg!(
                            "no file `{name}` beside it",
                            name = short(uri.as_bytes())
                        ))
                    },
                    Buffer::Shared,
                ),
            },
        });
        Ok(Self {
            name,
            buffers: buffers.collect(),
            root,
            humanoid,
            broken_humanoid,
            webp: WebpTextures::read(&json),
            resolve,
            left: Cell::new(most),
        })
    }

    pub(super) fn name(&self) -> &str {
        self.name
    }

    pub(super) fn error(
        &self,
        found: impl Into<Message>,
        expected: impl Into<Message>,
    ) -> ImportError {
        ImportError::whole_file(self.name, found, expected)
    }

    /// Returns the bytes of a buffer.
    pub(super) fn buffer(&self, index: usize) -> Result<&[u8], ImportError> {
        match self.buffers.get(index) {
            Some(Buffer::Slice(bytes)) => Ok(bytes),
            Some(Buffer::Shared(bytes)) => Ok(bytes),
            Some(Buffer::Missing(_)) if MESHOPT.iter().any(|name| self.requires(name)) => Err(self
                .error("data that was packed by meshopt", "plain data")
                .with_hint("save the file without compression (gltfpack: without -c and -cc)")),
            Some(Buffer::Missing(why)) => Err(self
                .error(why.clone(), "the binary data of the animation")
                .with_hint("open it together with its .bin file")),
            None => Err(self.error(
                msg!("a view of buffer {index}, which is not there"),
                "a valid glTF 2.0 file",
            )),
        }
    }

    /// Returns the bytes of an image, in whatever format: in a buffer, in the JSON, or in a file
    /// beside this one.
    pub(super) fn image(&self, index: usize) -> Option<ImageBytes<'_>> {
        let image = self.root.images.get(index)?;
        if let Some(view) = image.buffer_view {
            let view = self.root.get(view)?;
            let start = usize::try_from(view.byte_offset.unwrap_or_default().0).ok()?;
            let length = usize::try_from(view.byte_length.0).ok()?;
            let buffer = self.buffer(view.buffer.value()).ok()?;
            return Some(ImageBytes::Inside(buffer.get(start..)?.get(..length)?));
        }
        let uri = image.uri.as_deref()?;
        match uri.strip_prefix("data:") {
            Some(data) => embedded(data).map(ImageBytes::Decoded),
            None => external(uri, self.resolve).map(ImageBytes::Beside),
        }
    }

    /// Returns whether the file says that it cannot be read without an extension.
    pub(super) fn requires(&self, extension: &str) -> bool {
        self.root.extensions_required.iter().any(|name| name == extension)
    }

    /// Returns the number of bytes of all buffers.
    pub(super) fn total_bytes(&self) -> usize {
        (0..self.buffers.len())
            .filter_map(|index| self.buffer(index).ok())
            .fold(0, |sum, bytes| sum.saturating_add(bytes.len()))
    }

    /// Checks and counts memory before it is allocated.
    pub(super) fn spend(&self, count: usize, bytes_each: usize) -> Result<(), ImportError> {
        let left =
            count.checked_mul(bytes_each).and_then(|bytes| self.left.get().checked_sub(bytes));
        let Some(left) = left else {
            return Err(self
                .error(
                    "more motion than fits into the memory that a file may take",
                    "a shorter or a sparser animation",
                )
                .with_hint("export a part of the animation, or at a lower frame rate"));
        };
        self.left.set(left);
        Ok(())
    }
}

/// Returns the JSON and the binary chunk of a `.glb` file.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Message> {
    /// Magic, version and length of the file.
    const HEADER: usize = 12;
    let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(msg!("glTF version {version}")),
        None => return Err("a file that was cut off".into()),
    }
    let (mut json, mut binary) = (None, None);
    let mut at = HEADER;
    while let (Some(length), Some(kind)) = (word(at), bytes.get(at + 4..at + 8)) {
        let chunk = bytes.get(at + 8..).and_then(|rest| rest.get(..length as usize));
        let Some(chunk) = chunk else {
            let there = bytes.len() - at - 8;
            return Err(msg!(
                "{there} bytes of a part that should have {length}: the file was cut off"
            ));
        };
        // The first of each kind is used; other kinds are extensions (section 4.4.3).
        match kind {
            b"JSON" => json = json.or(Some(chunk)),
            b"BIN\0" => binary = binary.or(Some(chunk)),
            _ => {}
        }
        // Chunks should end at multiples of four, but not all writers pad them.
        at += 8 + chunk.len();
    }
    json.map(|json| (json, binary)).ok_or_else(|| "a file without JSON".into())
}

fn parse(name: &str, json: &[u8]) -> Result<Root, ImportError> {
    let error = match Root::from_slice(json) {
        Ok(root) if root.asset.version.starts_with("2.") => return Ok(root),
        Ok(root) => return Err(version(name, &root.asset.version)),
        Err(error) => error,
    };
    let refused = |error: &gltf::json::Error| ImportError {
        line: error.line().max(1),
        column: error.column().max(1),
        ..ImportError::whole_file(
            name,
            msg!("JSON that is not glTF ({error})", error = error.to_string()),
            "a glTF 2.0 file",
        )
    };
    let Ok(mut value) = serde_json::from_slice::<Value>(json) else {
        return Err(refused(&error));
    };
    match value.pointer("/asset/version").and_then(Value::as_str) {
        Some(found) if !found.starts_with("2.") => return Err(version(name, found)),
        _ => {}
    }
    // Channels that animate something other than a node (KHR_animation_pointer) are valid, but not
    // supported by the library.
    let animations = value.get_mut("animations").and_then(Value::as_array_mut);
    for channels in animations
        .into_iter()
        .flatten()
        .filter_map(|animation| animation.get_mut("channels")?.as_array_mut())
    {
        channels.retain(|channel| channel.pointer("/target/node").is_some());
    }
    // As text again: the types of glTF are many, and a second reader of them, from values, would be
    // a twentieth of the page's reader.
    serde_json::to_vec(&value).and_then(|json| Root::from_slice(&json)).map_err(|_| refused(&error))
}

fn version(name: &str, found: &str) -> ImportError {
    ImportError::whole_file(
        name,
        msg!("glTF version {version}", version = short(found.as_bytes())),
        "glTF 2.0",
    )
}

/// Returns the content of a data URI after `data:`. Padding and white space are optional, percent
/// signs are decoded.
fn embedded(data: &str) -> Option<Vec<u8>> {
    const READER: GeneralPurpose = GeneralPurpose::new(
        &STANDARD,
        GeneralPurposeConfig::new()
            .with_decode_padding_mode(DecodePaddingMode::Indifferent)
            .with_decode_allow_trailing_bits(true),
    );
    let (kind, content) = data.split_once(',')?;
    let content = percent_encoding::percent_decode_str(content);
    if !kind.ends_with(";base64") {
        return Some(content.collect());
    }
    let content: Vec<u8> = content.filter(|b| !b.is_ascii_whitespace()).collect();
    READER.decode(content).ok()
}

/// Returns a file beside this one: by its name as written, otherwise percent-decoded.
fn external(uri: &str, resolve: Resolve<'_>) -> Option<Arc<[u8]>> {
    resolve(uri).or_else(|| resolve(&percent_encoding::percent_decode_str(uri).decode_utf8().ok()?))
}
