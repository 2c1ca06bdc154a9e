//! The shaders of a stage: their sources, and their compilation on demand.

use eframe::wgpu;
use std::sync::OnceLock;

/// The source of limb.wgsl, after the sources that it uses. The other constants are alike.
pub(crate) const LIMB: &str = concat!(
    include_str!("../view.wgsl"),
    include_str!("../light.wgsl"),
    include_str!("../limb.wgsl")
);
pub(crate) const SKIN: &str = concat!(
    include_str!("../view.wgsl"),
    include_str!("../light.wgsl"),
    include_str!("../skin.wgsl")
);
pub(crate) const KEY_SHADOW: &str = concat!(
    include_str!("../view.wgsl"),
    include_str!("../light.wgsl"),
    include_str!("../key_shadow.wgsl")
);
pub(crate) const SHADOW: &str =
    concat!(include_str!("../view.wgsl"), include_str!("../shadow.wgsl"));
pub(crate) const GROUND: &str =
    concat!(include_str!("../view.wgsl"), include_str!("../ground.wgsl"));
pub(crate) const LINE: &str = concat!(include_str!("../view.wgsl"), include_str!("../line.wgsl"));
pub(crate) const RING: &str = concat!(include_str!("../view.wgsl"), include_str!("../ring.wgsl"));
pub(crate) const COMPOSITE: &str = include_str!("../composite.wgsl");

/// A shader that is compiled for the first pipeline that uses it.
pub(super) struct Shader {
    label: &'static str,
    source: &'static str,
    module: OnceLock<wgpu::ShaderModule>,
}

impl Shader {
    pub(super) const fn new(label: &'static str, source: &'static str) -> Self {
        Self { label, source, module: OnceLock::new() }
    }

    /// Returns the compiled shader.
    pub(super) fn module(&self, device: &wgpu::Device) -> &wgpu::ShaderModule {
        self.module.get_or_init(|| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(self.label),
                source: wgpu::ShaderSource::Wgsl(self.source.into()),
            })
        })
    }
}
