//! Tests that draw pictures on a device without a window. `cargo test --bin segue-app render`
//! leaves them in `target/stage/*.png`.

mod exact;
mod light;
mod pictures;
mod sessions;
mod shaders;
mod skins;
mod textures;

use super::{Image, Quality, StageRenderer, render_to_image};
use eframe::wgpu;
use glam::Vec3;
use segue_motion::clip::Clip;
use segue_motion::math::Planar;
use segue_motion::skeleton::Roles;
use segue_motion::synth::{Action, Params, synthesize};
use segue_scene::{
    Body, Camera, Color, Colors, Director, Layer, Limb, Look, Pane, Stage, StageOptions, Viewport,
    rgb, with_alpha,
};
use segue_session::Session;
use std::path::PathBuf;
use std::sync::Arc;

/// Returns a ball of a colour.
fn ball(center: Vec3, radius: f32, color: Color) -> Limb {
    Limb {
        a: center,
        b: center,
        radius_a: radius,
        radius_b: radius,
        flat: Vec3::ZERO,
        flatness: 1.0,
        color,
    }
}

/// Returns the options of a stage with one pixel per point.
fn options<'a>(panes: &'a [(usize, Viewport)], look: Look, colors: &Colors) -> StageOptions<'a> {
    StageOptions { panes, look, colors: *colors, ..StageOptions::default() }
}

/// Returns the stage of a session, with every skin that is on it built.
fn staged(
    director: &mut Director,
    session: &Session,
    options: &StageOptions<'_>,
    dt_secs: f32,
) -> Arc<Stage> {
    let stage = director.stage(session, options, dt_secs);
    if !director.is_at_work() {
        return stage;
    }
    while director.work() {}
    director.stage(session, options, 0.0)
}

/// Returns the colours of the dark theme (0) or of the light one (1).
fn colors(theme: usize) -> Colors {
    Colors {
        a: rgb(A[theme]),
        b: rgb(B[theme]),
        result: rgb(RESULT[theme]),
        bad: rgb(0xff_7a_6b),
        warning: rgb([0xf0_c0_5a, 0x85_5d_00][theme]),
        others: [rgb(B[theme]), rgb(0xc0_8d_f0), rgb(0xf0_8f_b4), rgb(0xa9_c7_5a)],
        ghost_alpha: 0.4,
    }
}

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: StageRenderer,
}

impl Gpu {
    /// Draws with full quality, and saves the picture.
    fn draw(&mut self, name: &str, stage: &Stage, size: [u32; 2]) -> Image {
        self.renderer.set_quality(Quality::Full);
        let image =
            render_to_image(&mut self.renderer, &self.device, &self.queue, stage, size).unwrap();
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/stage");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), image.to_png().unwrap()).unwrap();
        image
    }
}

/// Returns a device to draw with; `None` where the machine has none.
fn gpu() -> Option<Gpu> {
    gpu_for(wgpu::TextureFormat::Bgra8Unorm)
}

fn gpu_for(output: wgpu::TextureFormat) -> Option<Gpu> {
    // `WGPU_BACKEND=gl` selects the backend that resembles WebGL.
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let options = wgpu::RequestAdapterOptions::default();
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else {
        eprintln!("no graphics adapter: the picture is not drawn");
        return None;
    };
    let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
    let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
    let renderer = StageRenderer::new(&device, &queue, &adapter, output);
    Some(Gpu { device, queue, renderer })
}

struct Actors {
    walk: Clip,
    run: Clip,
    body: Body,
}

fn actors() -> Actors {
    let walk =
        synthesize(&Params { duration_secs: 4.0, ..Params::new(Action::Walk) }).unwrap().clip;
    let run = synthesize(&Params { duration_secs: 3.0, ..Params::new(Action::Run) }).unwrap().clip;
    let body = Body::new(walk.skeleton(), Some(&Roles::detect(walk.skeleton())));
    Actors { walk, run, body }
}

const A: [u32; 2] = [0xf2_a3_5e, 0xd9_79_2a];
const B: [u32; 2] = [0x5f_a8_f5, 0x2f_7f_d6];
const RESULT: [u32; 2] = [0x58_d6_a9, 0x16_9d_72];

/// Returns a pane with a walker, two ghosts behind and two runners in front, paths on the ground,
/// and a planted foot.
fn blend_pane(actors: &Actors, viewport: Viewport, light: bool, frame: usize) -> Pane {
    let theme = usize::from(light);
    let look = if light { Look::LIGHT } else { Look::DARK };
    let mut pane = Pane { viewport, ..Pane::default() };
    let alpha = if light { 0.32 } else { 0.34 };
    let walk = |frame: usize| actors.walk.world_pose(frame.min(actors.walk.frames() - 1));
    let now = walk(frame);
    let here = now.positions[0].with_y(0.0);
    let (tint_a, tint_b) = (rgb(A[theme]), rgb(B[theme]));
    for (steps, fade) in [(22, 1.0), (44, 0.62)] {
        pane.add_ghost(
            &actors.body,
            &walk(frame.saturating_sub(steps)),
            with_alpha(tint_a, alpha * fade),
        );
    }
    let entry = Planar::new(0.0, f64::from(here.x), f64::from(here.z));
    for (ahead, fade) in [(16, 1.0), (34, 0.62)] {
        let mut pose = actors.run.world_pose(ahead);
        pose.apply(&entry);
        pane.add_ghost(&actors.body, &pose, with_alpha(tint_b, alpha * fade));
    }
    pane.add_body(&actors.body, &now, look.clay);
    let path = (0..=frame).map(|f| {
        (
            actors.walk.root_translations()[f].with_y(0.0),
            with_alpha(tint_a, (f as f32 / frame as f32).powf(0.7)),
        )
    });
    pane.add_path(path, 2.0, Layer::Ground);
    let ahead = (0..60).map(|f| entry.apply(actors.run.root_translations()[f].with_y(0.0)));
    pane.add_dashed_path(ahead, tint_b, 0.12, 2.0, Layer::Ground);
    let planted = [4, 8].map(|toe| now.positions[toe.min(now.positions.len() - 1)]);
    let foot = if planted[0].y < planted[1].y { planted[0] } else { planted[1] };
    pane.add_contact(foot, rgb(RESULT[theme]), false);
    pane.focus = here;
    pane.camera = Camera {
        target: here + Vec3::Y * 0.93,
        yaw: 0.95,
        pitch: 0.13,
        distance: 4.6,
        ..Camera::default()
    };
    pane
}

fn stage(actors: &Actors, size: [u32; 2], panes: u32, light: bool, pixels_per_point: f32) -> Stage {
    let panes = Viewport::columns(size[0], size[1], panes, 1)
        .enumerate()
        .map(|(i, viewport)| blend_pane(actors, viewport, light, 104 + 9 * i))
        .collect();
    Stage {
        panes,
        look: if light { Look::LIGHT } else { Look::DARK },
        pixels_per_point,
        ..Stage::default()
    }
}
