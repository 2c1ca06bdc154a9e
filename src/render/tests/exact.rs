//! Tests of pictures to the pixel.

use super::{actors, ball, gpu, gpu_for, stage};
use crate::render::frame::Frame;
use crate::render::image::read_texture;
use crate::render::{Quality, Refinement, render_to_image};
use eframe::wgpu;
use glam::Vec3;
use segue_scene::{Camera, Lens, Look, Pane, Stage, Viewport};

#[test]
fn stage_in_software_is_coarse_in_motion_and_fine_at_rest() {
    use Refinement::{AtRest, Later, Now};
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let size = [960, 600];
    gpu.renderer.set_quality(Quality::Plain);
    let mut prepare = |secs: f64, refinement: Refinement, stage: &Stage, size: [u32; 2]| {
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        gpu.renderer.begin_frame(secs, refinement);
        let prepared = gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 5, stage, size);
        gpu.queue.submit([encoder.finish()]);
        (prepared.drawn, prepared.to_be_refined)
    };
    let mut prepared = |secs, stage: &Stage, size| prepare(secs, AtRest, stage, size);
    // A small stage, too: it has as many triangles.
    for size in [size, [64, 40]] {
        let mut stage = stage(&actors, size, 2, false, 1.0);
        assert_eq!(prepared(3.0, &stage, size), (true, true));
        assert_eq!(prepared(3.2, &stage, size), (false, true));
        assert_eq!(prepared(3.5, &stage, size), (true, false));
        assert_eq!(prepared(9.0, &stage, size), (false, false));
        stage.panes[0].camera.yaw += 0.1;
        assert_eq!(prepared(9.1, &stage, size), (true, true));
        assert_eq!(prepared(9.3, &stage, size), (false, true));
    }
    // A picture of a frame is fine at once, and the next frame in motion is coarse again.
    let mut stage = stage(&actors, size, 2, false, 1.0);
    assert_eq!(prepare(20.0, Now, &stage, size), (true, false));
    assert_eq!(prepare(20.1, AtRest, &stage, size), (false, false));
    stage.panes[0].camera.yaw += 0.1;
    assert_eq!(prepare(20.2, AtRest, &stage, size), (true, true));
    assert_eq!(prepare(20.3, Now, &stage, size), (true, false));
    // While a body is prepared, a stage at rest stays coarse; afterwards it is drawn finely.
    stage.panes[0].camera.yaw += 0.1;
    assert_eq!(prepare(21.0, Later, &stage, size), (true, true));
    assert_eq!(prepare(22.0, Later, &stage, size), (false, true));
    assert_eq!(prepare(22.1, AtRest, &stage, size), (true, false));

    // The coarse frame has the same panes at the same positions.
    let (mut fine, mut coarse) = (Frame::default(), Frame::default());
    fine.build(&stage, size, size, Quality::Plain);
    coarse.build(&stage, size, [480, 300], Quality::Plain);
    for (fine, coarse) in fine.panes.iter().zip(&coarse.panes) {
        let half = |side: u32| side.div_ceil(2);
        assert_eq!(
            [coarse.viewport.x, coarse.viewport.y, coarse.viewport.width, coarse.viewport.height],
            [fine.viewport.x, fine.viewport.y, fine.viewport.width, fine.viewport.height].map(half)
        );
    }
}

#[test]
fn stage_without_size_or_with_a_pane_outside_is_drawn() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    gpu.renderer.set_quality(Quality::Full);
    let mut stage = stage(&actors, [64, 64], 1, false, 1.0);
    assert!(render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [0, 64]).is_err());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    assert!(!gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [0, 0]).drawn);
    // An unchanged stage is not drawn again; one of another size or content is.
    assert!(gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [64, 64]).drawn);
    assert!(
        !gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [64, 64]).drawn
    );
    assert!(gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [65, 64]).drawn);
    stage.panes[0].camera.yaw += 0.1;
    assert!(gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [65, 64]).drawn);
    gpu.queue.submit([encoder.finish()]);
    // Panes that extend beyond the stage, empty panes, and limbs that are not finite.
    stage.panes[0].viewport = Viewport { x: 40, y: 40, width: 500, height: 500 };
    stage.panes[0].limbs[0].a = Vec3::NAN;
    stage.panes[0].limbs[1].radius_a = f32::INFINITY;
    stage.panes[0].figures[0].limbs = 5..usize::MAX;
    stage.panes.push(Pane::default());
    stage
        .panes
        .push(Pane { viewport: Viewport { x: 900, y: 0, width: 5, height: 5 }, ..Pane::default() });
    stage
        .panes
        .push(Pane { viewport: Viewport { x: 0, y: 0, width: 30, height: 30 }, ..Pane::default() });
    let image =
        render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [64, 64]).unwrap();
    assert_eq!((image.width, image.height, image.rgba.len()), (64, 64, 64 * 64 * 4));
    assert_eq!(image.pixel(64, 0), None);
}

#[test]
fn ghost_shows_its_front_and_is_hidden_by_a_solid_body_before_it() {
    let Some(mut gpu) = gpu() else { return };
    let camera = Camera {
        target: Vec3::Y * 2.0,
        yaw: 0.0,
        pitch: 0.0,
        distance: 5.0,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    let viewport = Viewport { x: 0, y: 0, width: 64, height: 64 };
    let mut look = Look::DARK;
    look.edge[3] = 0.0;
    let mut middle = |limbs: Vec<segue_scene::Limb>, figures: &[(std::ops::Range<usize>, bool)]| {
        let figures = figures
            .iter()
            .map(|(limbs, ghost)| segue_scene::Figure {
                limbs: limbs.clone(),
                ghost: *ghost,
                skin: None,
                shadow: 0.0,
            })
            .collect();
        let stage = Stage {
            panes: vec![Pane { viewport, camera, limbs, figures, ..Pane::default() }],
            look,
            pixels_per_point: 1.0,
            ..Stage::default()
        };
        render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [64, 64])
            .unwrap()
            .pixel(32, 32)
            .unwrap()
    };
    let at = |z: f32| Vec3::new(0.0, 2.0, z);
    let red = [1.0, 0.0, 0.0, 0.5];
    let one = middle(vec![ball(at(0.0), 0.5, red)], &[(0..1, true)]);
    // A second limb of the same ghost inside or behind the first adds nothing.
    let stacked = middle(
        vec![ball(at(0.0), 0.5, red), ball(at(-0.2), 0.4, red), ball(at(0.0), 0.3, red)],
        &[(0..3, true)],
    );
    assert_eq!(one, stacked);
    // A second ghost behind it adds its colour.
    let two = middle(
        vec![ball(at(0.0), 0.5, red), ball(at(-3.0), 0.5, red)],
        &[(0..1, true), (1..2, true)],
    );
    assert!(two[0] > one[0] + 20, "{two:?} over {one:?}");
    // The order of the ghosts does not matter.
    let swapped = middle(
        vec![ball(at(-3.0), 0.5, red), ball(at(0.0), 0.5, red)],
        &[(0..1, true), (1..2, true)],
    );
    assert_eq!(two, swapped);
    // A solid body in front hides it; one behind it shines through.
    let white = [1.0, 1.0, 1.0, 1.0];
    let alone = middle(vec![ball(at(2.0), 0.5, white)], &[(0..1, false)]);
    let hidden = middle(
        vec![ball(at(0.0), 0.5, red), ball(at(2.0), 0.5, white)],
        &[(0..1, true), (1..2, false)],
    );
    assert_eq!(alone, hidden);
    let through = middle(
        vec![ball(at(0.0), 0.5, red), ball(at(-2.0), 0.5, white)],
        &[(0..1, true), (1..2, false)],
    );
    assert!(through[2] > one[2] + 40, "{through:?} over {one:?}");
}

#[test]
fn ball_is_round_and_has_the_size_of_its_projection() {
    let Some(mut gpu) = gpu() else { return };
    let camera = Camera {
        target: Vec3::Y * 4.0,
        yaw: 0.3,
        pitch: 0.2,
        distance: 6.0,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    let viewport = Viewport { x: 0, y: 0, width: 200, height: 200 };
    let mut look = Look::DARK;
    (look.edge[3], look.grid[3], look.floor) = (0.0, 0.0, look.background_top);
    look.background_bottom = look.background_top;
    let radius = 1.0;
    let ball = segue_scene::Limb {
        a: camera.target,
        b: camera.target,
        radius_a: radius,
        radius_b: radius,
        flat: Vec3::ZERO,
        flatness: 1.0,
        color: [1.0; 4],
    };
    let figures = vec![segue_scene::Figure { limbs: 0..1, ghost: false, skin: None, shadow: 0.0 }];
    let stage = Stage {
        panes: vec![Pane { viewport, camera, limbs: vec![ball], figures, ..Pane::default() }],
        look,
        pixels_per_point: 1.0,
        ..Stage::default()
    };
    let image = gpu.draw("ball", &stage, [200, 200]);
    let covered = image.rgba.chunks_exact(4).filter(|p| p[0] > 0x18).count() as f32;
    let expected =
        std::f32::consts::PI * (radius * camera.pixels_per_metre(camera.target, 200.0)).powi(2);
    assert!((covered / expected - 1.0).abs() < 0.02, "{covered} pixels, not {expected}");
}

#[test]
fn page_gets_the_stage_pixel_by_pixel_in_encoded_and_linear_targets() {
    for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
        let Some(mut gpu) = gpu_for(format) else {
            return;
        };
        let actors = actors();
        let stage = stage(&actors, [128, 96], 1, false, 1.0);
        let expected =
            render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [128, 96]).unwrap();
        let page = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: 256, height: 128, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = page.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        assert!(
            gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 3, &stage, [128, 96]).drawn
        );
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::RED),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_viewport(16.0, 8.0, 128.0, 96.0, 0.0, 1.0);
            gpu.renderer.paint(&mut pass, 3);
        }
        let got = read_texture(&gpu.device, &gpu.queue, encoder, &page).unwrap();
        assert_eq!(got.pixel(15, 20), Some([255, 0, 0, 255]));
        for y in 0..96 {
            for x in 0..128 {
                assert_eq!(
                    got.pixel(x + 16, y + 8),
                    expected.pixel(x, y),
                    "{format:?} at {x}, {y}"
                );
            }
        }
    }
}
