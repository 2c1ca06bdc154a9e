//! Pictures from a device without a window: run with `cargo test --bin segue render` and look at `target/stage/*.png`.

use super::frame::Frame;
use super::pipelines::{COMPOSITE, GROUND, KEY_SHADOW, LIMB, LINE, RING, SHADOW};
use super::{Image, Quality, StageRenderer, render_to_image};
use eframe::wgpu;
use eframe::wgpu::naga;
use glam::Vec3;
use segue::clip::Clip;
use segue::math::Planar;
use segue::path::{PathEdit, Pins};
use segue::scene::{Body, Bounds, Camera, Colors, Director, Layer, Lens, Look, Pane, PathMarks, Ring, Stage, Viewport, rgb, with_alpha};
use segue::session::{Command, Key, Session, Value};
use segue::skeleton::{Joint, Roles, Skeleton, world_pose};
use segue::synth::{Action, Params, synthesize};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Every entry point can be said in the shading language of WebGL 2.
fn translates_to_webgl(name: &str, module: &naga::Module, info: &naga::valid::ModuleInfo) {
    use naga::back::glsl;
    for entry in &module.entry_points {
        let options = glsl::Options {
            version: glsl::Version::Embedded {
                version: 300,
                is_webgl: true,
            },
            ..glsl::Options::default()
        };
        let pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        let policies = naga::proc::BoundsCheckPolicies::default();
        let written = glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies).and_then(|mut writer| writer.write());
        assert!(
            written.is_ok(),
            "{name}.wgsl, {}: {}",
            entry.name,
            written.err().map_or(String::new(), |e| e.to_string())
        );
        assert!(text.starts_with("#version 300 es"));
    }
}

/// The colours of the dark theme, or of the light one.
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

#[test]
fn every_shader_is_valid() {
    for (name, source) in [
        ("limb", LIMB),
        ("shadow", SHADOW),
        ("key_shadow", KEY_SHADOW),
        ("ground", GROUND),
        ("line", LINE),
        ("ring", RING),
        ("composite", COMPOSITE),
    ] {
        let module = naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{name}.wgsl: {}", e.emit_to_string(source)));
        // No capabilities beyond the plain ones.
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
        let info = validator
            .validate(&module)
            .unwrap_or_else(|e| panic!("{name}.wgsl: {}", e.emit_to_string(source)));
        translates_to_webgl(name, &module, &info);
        let blocks = module
            .global_variables
            .iter()
            .filter(|(_, v)| v.space == naga::AddressSpace::Uniform);
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

struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    renderer: StageRenderer,
}

/// `None` where the machine has nothing to draw with.
fn gpu() -> Option<Gpu> {
    gpu_for(wgpu::TextureFormat::Bgra8Unorm)
}

fn gpu_for(output: wgpu::TextureFormat) -> Option<Gpu> {
    let instance = wgpu::Instance::default();
    let options = wgpu::RequestAdapterOptions::default();
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else {
        eprintln!("no graphics adapter: the picture is not drawn");
        return None;
    };
    let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: limits,
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).ok()?;
    let renderer = StageRenderer::new(&device, &adapter, output);
    Some(Gpu { device, queue, renderer })
}

impl Gpu {
    /// Draws as on a machine with a graphics card, and keeps the picture.
    fn draw(&mut self, name: &str, stage: &Stage, size: [u32; 2]) -> Image {
        self.renderer.set_quality(Quality::Full);
        let start = Instant::now();
        let image = render_to_image(&mut self.renderer, &self.device, &self.queue, stage, size).unwrap();
        eprintln!("{name}: {:.2} s", start.elapsed().as_secs_f64());
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/stage");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), image.to_png().unwrap()).unwrap();
        image
    }
}

struct Actors {
    walk: Clip,
    run: Clip,
    body: Body,
}

fn actors() -> Actors {
    let walk = synthesize(&Params {
        duration_secs: 4.0,
        ..Params::new(Action::Walk)
    })
    .unwrap()
    .clip;
    let run = synthesize(&Params {
        duration_secs: 3.0,
        ..Params::new(Action::Run)
    })
    .unwrap()
    .clip;
    let body = Body::new(walk.skeleton(), Some(&Roles::detect(walk.skeleton())));
    Actors { walk, run, body }
}

const A: [u32; 2] = [0xf2_a3_5e, 0xd9_79_2a];
const B: [u32; 2] = [0x5f_a8_f5, 0x2f_7f_d6];
const RESULT: [u32; 2] = [0x58_d6_a9, 0x16_9d_72];

/// A walker with two ghosts behind and two runners before, paths on the ground, and a planted foot.
fn blend_pane(actors: &Actors, viewport: Viewport, light: bool, frame: usize) -> Pane {
    let theme = usize::from(light);
    let look = if light { Look::LIGHT } else { Look::DARK };
    let mut pane = Pane {
        viewport,
        ..Pane::default()
    };
    let alpha = if light { 0.32 } else { 0.34 };
    let walk = |frame: usize| actors.walk.world_pose(frame.min(actors.walk.frames() - 1));
    let now = walk(frame);
    let here = now.positions[0].with_y(0.0);
    let (tint_a, tint_b) = (rgb(A[theme]), rgb(B[theme]));
    for (steps, fade) in [(22, 1.0), (44, 0.62)] {
        pane.add_ghost(&actors.body, &walk(frame.saturating_sub(steps)), with_alpha(tint_a, alpha * fade));
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
    pane.add_contact(foot, rgb(RESULT[theme]));
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
    }
}

#[test]
fn three_panes_in_both_themes_and_on_a_phone() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    for (theme, light) in [("dark", false), ("light", true)] {
        let image = gpu.draw(&format!("three-{theme}"), &stage(&actors, [1440, 900], 3, light, 1.0), [1440, 900]);
        // The palette comes out exactly.
        let expected = if light {
            [0xee, 0xf0, 0xf4, 0xff]
        } else {
            [0x0f, 0x11, 0x15, 0xff]
        };
        assert_eq!(image.pixel(20, 0), Some(expected));
        assert_eq!(image.pixel(1300, 0), Some(expected));
        gpu.draw(&format!("phone-{theme}"), &stage(&actors, [780, 800], 1, light, 2.0), [780, 800]);
    }
}

#[test]
fn the_chosen_joint_is_marked_over_the_body() {
    let Some(mut gpu) = gpu() else { return };
    let size = [700, 600];
    let shown = [(
        0,
        Viewport {
            width: size[0],
            height: size[1],
            ..Viewport::default()
        },
    )];
    for (theme, look) in [Look::DARK, Look::LIGHT].into_iter().enumerate() {
        let mut session = Session::new();
        let link = "lab=view&a=walk&t=0.4&joint=left%20hand&trail=off&contacts=off".to_owned();
        session.apply(Command::OpenLink(link)).unwrap();
        let mut director = Director::default();
        let mut accent = |marked: bool| {
            director.mark_joint(marked);
            let stage = director.stage(&session, &shown, 1.0, look, &colors(theme), 0.0);
            let image = gpu.draw(&format!("joint-{theme}-{marked}"), &stage, size);
            let green = |p: &&[u8]| i32::from(p[1]) - i32::from(p[0]) > 60;
            image.rgba.chunks_exact(4).filter(green).count()
        };
        assert_eq!(accent(false), 0);
        // A ring and a dot of a few points.
        let marked = accent(true);
        assert!((40..400).contains(&marked), "{marked}");
    }
}

#[test]
fn a_layered_body_shows_whose_limbs_are_whose() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1440, 620];
    for (theme, look) in [Look::DARK, Look::LIGHT].into_iter().enumerate() {
        let colors = colors(theme);
        let mut blue = Vec::new();
        for (name, link) in [
            ("layers", "lab=layers&t=1.2&compare=mask:upper,arms,head,legs"),
            ("feather", "lab=layers&t=1.2&compare=feather:0,2,5"),
            (
                "posture",
                "lab=layers&t=1.35&compare=layer_mode:partial,additive&camera_distance=3.5",
            ),
            ("jump", "lab=layers&t=1.35&b=jump&compare=layer_weight:0,0.5,1"),
            (
                "broken",
                "lab=transition&t=2.35&compare=mistake:none,euler,hemisphere,degrees&sources=off",
            ),
            ("plain", "lab=layers&t=1.2&mask_colors=off&trail=off"),
        ] {
            let mut session = Session::new();
            session.apply(Command::OpenLink(link.to_owned())).unwrap();
            while session.work() {}
            let panes = session.panes().len() as u32;
            let shown: Vec<(usize, Viewport)> = Viewport::columns(size[0], size[1], panes, 1).enumerate().collect();
            let stage = Director::default().stage(&session, &shown, 1.0, look, &colors, 0.0);
            let image = gpu.draw(&format!("{name}-{theme}"), &stage, size);
            let is_blue = |p: &&[u8]| i32::from(p[2]) - i32::from(p[0]) > 40;
            blue.push(image.rgba.chunks_exact(4).filter(is_blue).count());
        }
        assert!(blue[0] > 5_000 && blue[5] < 500, "{blue:?}");
    }
}

#[test]
fn registered_clips_walk_beside_the_result_and_a_pair_stands_in_its_place() {
    let Some(mut gpu) = gpu() else { return };
    let (size, look) = ([1400, 560], Look::DARK);
    let colors = Colors {
        ghost_alpha: 0.42,
        ..colors(0)
    };
    for (name, link, pair) in [
        ("registered", "lab=register&t=1.1&compare=warp_with:registered,plain", None),
        (
            "registered-join",
            "lab=register&warp_mode=join&t=1.3&compare=warp_with:registered,plain",
            None,
        ),
        ("registered-pair", "lab=register&t=1.1", Some([60.0, 100.0])),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.to_owned())).unwrap();
        while session.work() {}
        let panes = session.panes().len() as u32;
        let shown: Vec<(usize, Viewport)> = Viewport::columns(size[0], size[1], panes, 1).enumerate().collect();
        let mut director = Director::default();
        director.show_pair(pair);
        let stage = director.stage(&session, &shown, 1.0, look, &colors, 0.0);
        let ghosts = stage.panes[0].figures.iter().filter(|figure| figure.ghost).count();
        let bodies = stage.panes[0].figures.len() - ghosts;
        assert_eq!((ghosts, bodies), (2, usize::from(pair.is_none())), "{name}");
        gpu.draw(name, &stage, size);
    }
}

#[test]
fn the_mannequin_from_all_sides() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let size = [1800, 1100];
    for light in [false, true] {
        let look = if light { Look::LIGHT } else { Look::DARK };
        let panes = (0..10u32)
            .map(|i| {
                let viewport = Viewport {
                    x: i % 5 * 360,
                    y: i / 5 * 550,
                    width: 360,
                    height: 550,
                };
                let pose = if i < 5 {
                    actors.walk.world_pose(60)
                } else {
                    actors.run.world_pose(31)
                };
                let here = pose.positions[0].with_y(0.0);
                let mut bounds = Bounds::EMPTY;
                bounds.include_pose(&pose);
                let mut camera = Camera {
                    yaw: i as f32 * std::f32::consts::FRAC_PI_4,
                    pitch: 0.1,
                    ..Camera::default()
                };
                camera.frame(&bounds.grown(0.12), viewport.aspect());
                let mut pane = Pane {
                    viewport,
                    camera,
                    focus: here,
                    ..Pane::default()
                };
                pane.add_body(&actors.body, &pose, look.clay);
                pane
            })
            .collect();
        gpu.draw(
            if light { "sides-light" } else { "sides-dark" },
            &Stage {
                panes,
                look,
                pixels_per_point: 1.0,
            },
            size,
        );
    }
}

/// A four-legged animal that no role fits.
fn dog() -> Skeleton {
    let mut joints: Vec<Joint> = Vec::new();
    let mut add = |name: &str, parent: Option<usize>, offset: [f32; 3]| {
        joints.push(Joint {
            name: name.into(),
            parent,
            offset: offset.into(),
            end_site: None,
            channels: vec![],
        });
        joints.len() - 1
    };
    let root = add("Pelvis", None, [0.0, 0.55, 0.0]);
    let chest = (0..3).fold(root, |parent, _| add("Back", Some(parent), [0.0, 0.01, 0.17]));
    let neck = add("Neck", Some(chest), [0.0, 0.12, 0.12]);
    let head = add("Head", Some(neck), [0.0, 0.1, 0.1]);
    add("Snout", Some(head), [0.0, -0.04, 0.16]);
    (0..3).fold(root, |parent, _| add("Tail", Some(parent), [0.0, 0.04, -0.12]));
    for (parent, ahead) in [(root, -0.03f32), (chest, 0.05)] {
        for side in [-0.09, 0.09] {
            let hip = add("Leg", Some(parent), [side, -0.04, ahead]);
            let knee = add("Leg", Some(hip), [0.0, -0.22, 0.06]);
            let ankle = add("Leg", Some(knee), [0.0, -0.2, -0.08]);
            add("Paw", Some(ankle), [0.0, -0.08, 0.07]);
        }
    }
    Skeleton::new(joints).unwrap()
}

#[test]
fn from_above_close_up_and_other_bodies() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    for light in [false, true] {
        let look = if light { Look::LIGHT } else { Look::DARK };
        let mut panes: Vec<Pane> = Viewport::columns(1600, 800, 4, 2)
            .map(|viewport| blend_pane(&actors, viewport, light, 110))
            .collect();
        let here = panes[0].focus;
        panes[0].camera.look_from_top();
        panes[0].camera.distance = 8.0;
        panes[1].camera = Camera {
            target: here + Vec3::Y * 1.4,
            yaw: 0.5,
            pitch: 0.1,
            distance: 1.5,
            ..Camera::default()
        };
        panes[2].camera = Camera {
            target: here + Vec3::Y * 0.12,
            yaw: 1.3,
            pitch: 0.3,
            distance: 1.6,
            ..Camera::default()
        };
        panes[3].clear();
        panes[3].camera = Camera {
            target: here + Vec3::Y * 0.6,
            yaw: 0.8,
            pitch: 0.25,
            distance: 4.6,
            ..Camera::default()
        };
        let dog = dog();
        let mut pose = world_pose(
            &dog,
            &segue::skeleton::Pose {
                root_translation: dog.joints()[0].offset,
                ..Default::default()
            },
        );
        pose.apply(&Planar::new(0.6, f64::from(here.x) + 0.7, f64::from(here.z)));
        panes[3].add_body(&Body::new(&dog, Some(&Roles::detect(&dog))), &pose, look.clay);
        let mut person = actors.walk.world_pose(110);
        person.apply(&Planar::new(0.0, -0.6, 0.0));
        // The same skeleton without roles, with its bones over everything.
        panes[3].add_body(&Body::new(actors.walk.skeleton(), None), &person, look.clay);
        for (index, joint) in actors.walk.skeleton().joints().iter().enumerate().skip(1) {
            if let Some(parent) = joint.parent {
                panes[3].add_line(person.positions[parent], person.positions[index], rgb(0x58_d6_a9), 1.5, Layer::Over);
            }
        }
        panes[3].add_path(
            (0..40).map(|i| {
                let t = i as f32 * 0.2;
                (
                    here + Vec3::new(t.cos() * 0.9, 0.2 + 0.03 * i as f32, t.sin() * 0.9),
                    with_alpha(rgb(0xff_7a_6b), i as f32 / 40.0),
                )
            }),
            3.0,
            Layer::Space,
        );
        panes[3].rings.push(Ring {
            center: here + Vec3::X * 0.7,
            radius: 0.5,
            width: 0.02,
            color: rgb(0xff_7a_6b),
            fill: 0.08,
        });
        gpu.draw(
            if light { "more-light" } else { "more-dark" },
            &Stage {
                panes,
                look,
                pixels_per_point: 1.0,
            },
            [1600, 800],
        );
    }
}

/// Draws without a graphics card what moves, and then what stands still.
#[test]
fn in_software_what_moves_is_coarse_and_what_stands_is_fine() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let size = [960, 600];
    let mut stage = stage(&actors, size, 2, false, 1.0);
    gpu.renderer.set_quality(Quality::Plain);
    let mut prepared = |stage: &Stage| {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let prepared = gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 5, stage, size);
        gpu.queue.submit([encoder.finish()]);
        (prepared.drawn, prepared.to_be_refined)
    };
    assert_eq!(prepared(&stage), (true, true));
    assert_eq!(prepared(&stage), (true, false));
    assert_eq!(prepared(&stage), (false, false));
    stage.panes[0].camera.yaw += 0.1;
    assert_eq!(prepared(&stage), (true, true));

    // The coarse frame shows the same panes in the same places.
    let (mut fine, mut coarse) = (super::frame::Frame::default(), super::frame::Frame::default());
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
fn a_stage_without_size_or_with_a_pane_outside_is_fine() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let mut stage = stage(&actors, [64, 64], 1, false, 1.0);
    assert!(render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [0, 64]).is_err());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    assert!(!gpu.renderer.prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [0, 0]).drawn);
    // What did not change is not drawn again; what changed in size or content is.
    assert!(
        gpu.renderer
            .prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [64, 64])
            .drawn
    );
    assert!(
        !gpu.renderer
            .prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [64, 64])
            .drawn
    );
    assert!(
        gpu.renderer
            .prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [65, 64])
            .drawn
    );
    stage.panes[0].camera.yaw += 0.1;
    assert!(
        gpu.renderer
            .prepare(&gpu.device, &gpu.queue, &mut encoder, 1, &stage, [65, 64])
            .drawn
    );
    gpu.queue.submit([encoder.finish()]);
    // Panes that reach out of the stage, that are empty, and limbs that are no numbers.
    stage.panes[0].viewport = Viewport {
        x: 40,
        y: 40,
        width: 500,
        height: 500,
    };
    stage.panes[0].limbs[0].a = Vec3::NAN;
    stage.panes[0].limbs[1].radius_a = f32::INFINITY;
    stage.panes[0].figures[0].limbs = 5..usize::MAX;
    stage.panes.push(Pane::default());
    stage.panes.push(Pane {
        viewport: Viewport {
            x: 900,
            y: 0,
            width: 5,
            height: 5,
        },
        ..Pane::default()
    });
    stage.panes.push(Pane {
        viewport: Viewport {
            x: 0,
            y: 0,
            width: 30,
            height: 30,
        },
        ..Pane::default()
    });
    let image = render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [64, 64]).unwrap();
    assert_eq!((image.width, image.height, image.rgba.len()), (64, 64, 64 * 64 * 4));
    assert_eq!(image.pixel(64, 0), None);
}

#[test]
fn a_ghost_shows_only_its_front_and_is_hidden_by_the_solid_before_it() {
    let Some(mut gpu) = gpu() else { return };
    let ball = |center: Vec3, radius: f32, color| segue::scene::Limb {
        a: center,
        b: center,
        radius_a: radius,
        radius_b: radius,
        flat: Vec3::ZERO,
        flatness: 1.0,
        color,
    };
    let camera = Camera {
        target: Vec3::Y * 2.0,
        yaw: 0.0,
        pitch: 0.0,
        distance: 5.0,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    let viewport = Viewport {
        x: 0,
        y: 0,
        width: 64,
        height: 64,
    };
    let mut look = Look::DARK;
    look.edge[3] = 0.0;
    let mut middle = |limbs: Vec<segue::scene::Limb>, figures: &[(std::ops::Range<usize>, bool)]| {
        let figures = figures
            .iter()
            .map(|(limbs, ghost)| segue::scene::Figure {
                limbs: limbs.clone(),
                ghost: *ghost,
                shadow: 0.0,
            })
            .collect();
        let stage = Stage {
            panes: vec![Pane {
                viewport,
                camera,
                limbs,
                figures,
                ..Pane::default()
            }],
            look,
            pixels_per_point: 1.0,
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
    // A second ghost behind it does.
    let two = middle(
        vec![ball(at(0.0), 0.5, red), ball(at(-3.0), 0.5, red)],
        &[(0..1, true), (1..2, true)],
    );
    assert!(two[0] > one[0] + 20, "{two:?} over {one:?}");
    // In whichever order they come.
    let swapped = middle(
        vec![ball(at(-3.0), 0.5, red), ball(at(0.0), 0.5, red)],
        &[(0..1, true), (1..2, true)],
    );
    assert_eq!(two, swapped);
    // A solid before it hides it; a solid behind it shines through.
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
fn a_ball_is_round_and_as_large_as_the_camera_says() {
    let Some(mut gpu) = gpu() else { return };
    let camera = Camera {
        target: Vec3::Y * 4.0,
        yaw: 0.3,
        pitch: 0.2,
        distance: 6.0,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    let viewport = Viewport {
        x: 0,
        y: 0,
        width: 200,
        height: 200,
    };
    let mut look = Look::DARK;
    (look.edge[3], look.grid[3], look.floor) = (0.0, 0.0, look.background_top);
    look.background_bottom = look.background_top;
    let radius = 1.0;
    let ball = segue::scene::Limb {
        a: camera.target,
        b: camera.target,
        radius_a: radius,
        radius_b: radius,
        flat: Vec3::ZERO,
        flatness: 1.0,
        color: [1.0; 4],
    };
    let figures = vec![segue::scene::Figure {
        limbs: 0..1,
        ghost: false,
        shadow: 0.0,
    }];
    let stage = Stage {
        panes: vec![Pane {
            viewport,
            camera,
            limbs: vec![ball],
            figures,
            ..Pane::default()
        }],
        look,
        pixels_per_point: 1.0,
    };
    let image = gpu.draw("ball", &stage, [200, 200]);
    let covered = image.rgba.chunks_exact(4).filter(|p| p[0] > 0x18).count() as f32;
    let expected = std::f32::consts::PI * (radius * camera.pixels_per_metre(camera.target, 200.0)).powi(2);
    assert!((covered / expected - 1.0).abs() < 0.02, "{covered} pixels, not {expected}");
}

#[test]
fn the_page_gets_the_stage_pixel_by_pixel_in_both_kinds_of_targets() {
    for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
        let Some(mut gpu) = gpu_for(format) else { return };
        let actors = actors();
        let stage = stage(&actors, [128, 96], 1, false, 1.0);
        let expected = render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [128, 96]).unwrap();
        let page = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: 256,
                height: 128,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = page.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        assert!(
            gpu.renderer
                .prepare(&gpu.device, &gpu.queue, &mut encoder, 3, &stage, [128, 96])
                .drawn
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
        let got = super::image::read_texture(&gpu.device, &gpu.queue, encoder, &page).unwrap();
        assert_eq!(got.pixel(15, 20), Some([255, 0, 0, 255]));
        for y in 0..96 {
            for x in 0..128 {
                assert_eq!(got.pixel(x + 16, y + 8), expected.pixel(x, y), "{format:?} at {x}, {y}");
            }
        }
    }
}

#[test]
fn time_to_build_and_encode() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let mut stage = stage(&actors, [1440, 900], 3, false, 1.0);
    let mut frame = Frame::default();
    frame.build(&stage, [1440, 900], [1440, 900], Quality::Full);
    gpu.renderer.set_quality(Quality::Full);
    let rounds = 200u32;
    let (mut bodies, mut build, mut prepare) = (0.0, 0.0, 0.0);
    let pose = actors.walk.world_pose(50);
    for round in 0..rounds {
        let start = Instant::now();
        for pane in &mut stage.panes {
            let kept = (pane.strokes.clone(), pane.rings.clone());
            pane.clear();
            (pane.strokes, pane.rings) = kept;
            for _ in 0..4 {
                pane.add_ghost(&actors.body, &pose, rgb(A[0]));
            }
            pane.add_body(&actors.body, &pose, rgb(B[0]));
            pane.camera.yaw += 1e-3 * round as f32;
        }
        bodies += start.elapsed().as_secs_f64();
        let start = Instant::now();
        frame.build(&stage, [1440, 900], [1440, 900], Quality::Full);
        build += start.elapsed().as_secs_f64();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let start = Instant::now();
        assert!(
            gpu.renderer
                .prepare(&gpu.device, &gpu.queue, &mut encoder, 7, &stage, [1440, 900])
                .drawn
        );
        prepare += start.elapsed().as_secs_f64();
        // Without submitting: this measures the processor's side alone.
        drop(encoder);
    }
    let limbs: usize = stage.panes.iter().map(|p| p.limbs.len()).sum();
    let each = |secs: f64| secs * 1e6 / f64::from(rounds);
    eprintln!(
        "{limbs} limbs: bodies {:.0} µs, frame {:.0} µs, build + upload + encode {:.0} µs",
        each(bodies),
        each(build),
        each(prepare)
    );
}

#[test]
fn a_path_lies_on_the_stage_with_its_points_and_those_who_play_along() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1000, 640];
    let camera = "follow=off&camera_pitch=34&camera_distance=11&pan_z=2.5";
    for (theme, look) in [Look::DARK, Look::LIGHT].into_iter().enumerate() {
        let colors = colors(theme);
        for (name, link) in [
            ("path-fitted", "lab=path&a=walk_left&t=1.5"),
            ("path-edited", "lab=path&a=walk&t=2&others=run,walk_left"),
            ("path-top", "lab=path&a=walk&t=2&others=run,walk_left&camera=top"),
        ] {
            let mut session = Session::new();
            session.apply(Command::OpenLink(format!("{link}&{camera}"))).unwrap();
            while session.work() {}
            if name != "path-fitted" {
                let outcome = Arc::clone(session.main_outcome().unwrap());
                let spline = outcome.path.as_ref().unwrap().road.spline();
                let to = spline.points()[4] + glam::DVec2::new(-1.4, -1.9);
                let edited = spline.edited(&PathEdit::Move { index: 4, to }, Pins::default()).unwrap();
                session
                    .apply(Command::Set(vec![(Key::Path, Value::Text(edited.to_code()))]))
                    .unwrap();
                assert!(!session.main_outcome().unwrap().path.as_ref().unwrap().hard_turns.is_empty());
            }
            let viewport = Viewport {
                x: 0,
                y: 0,
                width: size[0],
                height: size[1],
            };
            let mut director = Director::default();
            director.mark_path(PathMarks {
                handles: true,
                chosen: Some(4),
                hovered: Some(2),
                ..PathMarks::default()
            });
            let stage = director.stage(&session, &[(0, viewport)], 1.0, look, &colors, 0.0);
            let bodies = if name == "path-fitted" { 1 } else { 3 };
            assert_eq!(stage.panes[0].figures.len(), bodies, "{name}");
            gpu.draw(&format!("{name}-{theme}"), &stage, size);
        }
    }
}

#[test]
fn a_driven_character_has_its_ways_on_the_ground_a_ghost_and_a_crowd() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1000, 640];
    for (theme, look) in [Look::DARK, Look::LIGHT].into_iter().enumerate() {
        let colors = colors(theme);
        for (name, link, bodies) in [
            ("drive-spin", "lab=match&scenario=spin&play=off&t=2.3", 2),
            ("drive-crowd", "lab=match&crowd=40&camera_distance=12&camera_pitch=20", 41),
        ] {
            let mut session = Session::new();
            session.apply(Command::OpenLink(link.into())).unwrap();
            while session.work() {}
            for _ in 0..200 {
                session.tick(1.0 / 60.0);
            }
            let outcome = Arc::clone(session.main_outcome().unwrap());
            let driven = outcome.driven.as_ref().unwrap();
            let moment = driven.at(session.now_secs()).unwrap();
            let mut director = Director::default();
            director.show_candidate(moment.search.as_ref().map(|search| search.candidates[1].place));
            let viewport = Viewport {
                x: 0,
                y: 0,
                width: size[0],
                height: size[1],
            };
            let stage = director.stage(&session, &[(0, viewport)], 1.0, look, &colors, 0.0);
            assert_eq!(stage.panes[0].figures.len(), bodies, "{name}");
            let ring = stage.panes[0].rings.iter().any(|ring| ring.color[..3] == colors.a[..3]);
            assert!(ring, "the simulation object");
            gpu.draw(&format!("{name}-{theme}"), &stage, size);
        }
    }
}
