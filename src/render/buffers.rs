//! Buffers on the device.

use eframe::wgpu;
use std::borrow::Cow;

/// A buffer that is replaced only by a larger one.
pub(super) struct GrowingBuffer {
    label: &'static str,
    usage: wgpu::BufferUsages,
    pub(super) buffer: Option<wgpu::Buffer>,
}

/// Makes a buffer that holds `contents`.
///
/// It is never mapped: on a lost device, browsers throw an exception there, and wgpu panics.
pub(super) fn filled_buffer(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let mut contents = Cow::Borrowed(contents);
    let size = contents.len().next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
    if contents.len() < size {
        contents.to_mut().resize(size, 0);
    }
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    if size > 0 {
        queue.write_buffer(&buffer, 0, &contents);
    }
    buffer
}

impl GrowingBuffer {
    pub(super) fn new(label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { label, usage: usage | wgpu::BufferUsages::COPY_DST, buffer: None }
    }

    /// Writes `bytes`. Returns whether the buffer was replaced.
    pub(super) fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        bytes: &[u8],
    ) -> bool {
        let needed = bytes.len().max(256) as u64;
        let grown = self.buffer.as_ref().is_none_or(|b| b.size() < needed);
        if grown {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: needed.next_power_of_two(),
                usage: self.usage,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer
            && !bytes.is_empty()
        {
            queue.write_buffer(buffer, 0, bytes);
        }
        grown
    }
}

/// Writes `blocks` to `out`, each at a multiple of `stride`, and one more block of zeros, so that
/// no binding reaches past the end.
pub(super) fn spaced<T: bytemuck::Pod>(blocks: &[T], stride: usize, out: &mut Vec<u8>) {
    out.clear();
    out.resize(stride * (blocks.len() + 1), 0);
    for (slot, block) in out.chunks_exact_mut(stride).zip(blocks) {
        slot[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(block));
    }
}

/// Makes a bind group for one block of a buffer of uniform blocks.
pub(super) fn uniform_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    label: &str,
    buffer: &GrowingBuffer,
    size: usize,
) -> Option<wgpu::BindGroup> {
    let buffer = buffer.buffer.as_ref()?;
    Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: wgpu::BufferSize::new(size as u64),
            }),
        }],
    }))
}
