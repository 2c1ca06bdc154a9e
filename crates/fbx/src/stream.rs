//! Reading of a scene from a stream of bytes.

#![expect(unsafe_code, reason = "ufbx asks for a stream that may live for ever")]

use crate::OpenError;
use std::io::Read;
use ufbx::{LoadOpts, SceneRoot, Stream};

/// Reads a scene from a stream.
pub(crate) fn load<'a>(
    stream: impl Read + 'a,
    options: LoadOpts<'_>,
) -> Result<SceneRoot, OpenError> {
    let stream: Box<dyn Read + 'a> = Box::new(stream);
    // SAFETY: only the lifetime of the trait object changes. ufbx reads the stream within this
    // call alone: it drops it before it returns, and the scene has copies of what it needs.
    let stream = unsafe { std::mem::transmute::<Box<dyn Read + 'a>, Box<dyn Read>>(stream) };
    Ok(ufbx::load_stream(Stream::Read(stream), options)?)
}
