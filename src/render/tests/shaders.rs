//! Validation of every shader.

use crate::render::pipelines::shaders::{
    COMPOSITE, GROUND, KEY_SHADOW, LIMB, LINE, RING, SHADOW, SKIN,
};
use eframe::wgpu::naga;

/// Asserts that every entry point can be translated to the shading language of WebGL 2.
fn translates_to_webgl(name: &str, module: &naga::Module, info: &naga::valid::ModuleInfo) {
    use naga::back::glsl;
    for entry in &module.entry_points {
        let options = glsl::Options {
            version: glsl::Version::Embedded { version: 300, is_webgl: true },
            ..glsl::Options::default()
        };
        let pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        let policies = naga::proc::BoundsCheckPolicies::default();
        let written = glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
            .and_then(|mut writer| writer.write());
        assert!(
            written.is_ok(),
            "{name}.wgsl, {}: {}",
            entry.name,
            written.err().map_or(String::new(), |e| e.to_string())
        );
        assert!(text.starts_with("#version 300 es"));
    }
}

#[test]
fn every_shader_is_valid_and_translates_to_webgl() {
    for (name, source) in [
        ("limb", LIMB),
        ("skin", SKIN),
        ("shadow", SHADOW),
        ("key_shadow", KEY_SHADOW),
        ("ground", GROUND),
        ("line", LINE),
        ("ring", RING),
        ("composite", COMPOSITE),
    ] {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|e| panic!("{name}.wgsl: {}", e.emit_to_string(source)));
        // No optional capabilities are allowed.
        let mut validator = naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            naga::valid::Capabilities::empty(),
        );
        let info = validator
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}.wgsl: {}", e.emit_to_string(source)));
        translates_to_webgl(name, &module, &info);
        let blocks =
            module.global_variables.iter().filter(|(_, v)| v.space == naga::AddressSpace::Uniform);
        for (_, block) in blocks {
            let size = module.types[block.ty].inner.size(module.to_ctx());
            assert!(size <= 16 * 1024, "{name}.wgsl: a uniform block of {size} bytes");
        }
        assert!(
            module
                .global_variables
                .iter()
                .all(|(_, v)| !matches!(v.space, naga::AddressSpace::Storage { .. }))
        );
    }
}
