//! Tests of the main light and its shadow.

use super::{ball, colors, gpu, options, staged};
use crate::render::render_to_image;
use glam::Vec3;
use segue_scene::{Camera, Director, Figure, Lens, Limb, Look, Pane, Stage, Viewport};
use segue_session::{Command, PlaybackCommand, Session};

/// Returns a stage with balls seen from straight above: 1 cm per pixel, x to the right, z down, and
/// the origin in the middle.
fn from_above(balls: &[Limb], shadow: f32) -> Stage {
    let mut camera = Camera {
        target: Vec3::ZERO,
        yaw: 0.0,
        pitch: std::f32::consts::FRAC_PI_2,
        distance: 8.0,
        lens: Lens::Orthographic,
        ..Camera::default()
    };
    camera.distance *= 4.0 / camera.half_height() * 0.5;
    let mut look = Look::LIGHT;
    (look.edge[3], look.grid[3], look.floor) = (0.0, 0.0, look.background_top);
    look.background_bottom = look.background_top;
    Stage {
        panes: vec![Pane {
            viewport: Viewport { width: SIZE, height: SIZE, ..Viewport::default() },
            camera,
            limbs: balls.to_vec(),
            figures: vec![Figure { limbs: 0..balls.len(), skin: None, ghost: false, shadow }],
            ..Pane::default()
        }],
        look,
        ..Stage::default()
    }
}

const SIZE: u32 = 400;

#[test]
fn shadow_follows_the_light_and_is_crisp_below_low_bodies() {
    let Some(mut gpu) = gpu() else { return };
    let key = crate::render::light::key_direction(Vec3::X, 0.0);
    // The red channel at a point of the ground, as the measure of its light.
    let mut light = |height: f32, along: &[f32]| -> Vec<i32> {
        let stage = from_above(&[ball(Vec3::new(0.0, height, 0.0), 0.2, [1.0; 4])], 1.0);
        let image = gpu.draw(&format!("light-ball-{height}"), &stage, [SIZE, SIZE]);
        let middle = -key * (height / key.y);
        let away = middle.with_y(0.0).normalize_or_zero();
        along
            .iter()
            .map(|&metres| {
                let at = middle + away * metres;
                let pixel = |metres: f32| (SIZE as f32 * 0.5 + metres * 100.0).round() as u32;
                i32::from(image.pixel(pixel(at.x), pixel(at.z)).unwrap()[0])
            })
            .collect()
    };
    let far = light(1.3, &[0.0, 0.8]);
    assert!(far[0] < far[1] - 40, "in the shadow {} and beside it {}", far[0], far[1]);
    // The edge of the ball's shadow is at 0.2 m / sin(elevation of the light). Beyond it, the
    // ground is lit at once when the ball is low, and gradually when it is high.
    let edge = 0.2 / key.y;
    let reach = [edge - 0.05, edge + 0.05];
    let (low, high) = (light(0.45, &reach), light(1.3, &reach));
    let (low, high) = (low[1] - low[0], high[1] - high[0]);
    assert!(
        low > high + 8 && high > 0,
        "over 10 cm {low} levels below a low ball, {high} below a high one"
    );
}

#[test]
fn side_of_a_body_towards_the_light_is_not_shaded() {
    let Some(mut gpu) = gpu() else { return };
    let key = crate::render::light::key_direction(Vec3::X, 0.0);
    let (center, radius) = (Vec3::new(0.0, 0.9, 0.0), 0.8);
    let mut draw = |shadow: f32| {
        let stage = from_above(&[ball(center, radius, [1.0; 4])], shadow);
        render_to_image(&mut gpu.renderer, &gpu.device, &gpu.queue, &stage, [SIZE, SIZE]).unwrap()
    };
    let (lit, unlit) = (draw(1.0), draw(0.0));
    let mut seen = 0;
    for y in 0..SIZE {
        for x in 0..SIZE {
            let [across, down] =
                [x, y].map(|pixel| (pixel as f32 + 0.5 - SIZE as f32 * 0.5) * 0.01 / radius);
            let up = 1.0 - across * across - down * down;
            let normal = Vec3::new(across, up.max(0.0).sqrt(), down);
            if up > 0.1 && normal.dot(key) > 0.35 {
                seen += 1;
                let [with, without] =
                    [&lit, &unlit].map(|image| i32::from(image.pixel(x, y).unwrap()[1]));
                assert!((with - without).abs() <= 2, "{with} is not {without} at {x}, {y}");
            }
        }
    }
    assert!(seen > 10_000, "{seen}");
}

#[test]
fn figure_is_drawn_in_every_look() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1440, 700];
    let shown: Vec<(usize, Viewport)> =
        Viewport::columns(size[0], size[1], 3, 1).enumerate().collect();
    for (name, look, theme) in
        [("dark", Look::DARK, 0), ("light", Look::LIGHT, 1), ("paper", Look::PAPER, 1)]
    {
        for (scene, link) in [
            (
                "blend",
                "lab=blend&a=walk&b=run&compare=blend_window:30,15,10&t=2.9&camera_distance=4",
            ),
            (
                "limbs",
                "lab=blend&a=walk&b=run&compare=blend_window:30,15,10&t=2.9&camera_distance=4&look=limbs",
            ),
            (
                "both",
                "lab=blend&a=walk&b=run&compare=blend_window:30,15,10&t=2.9&camera_distance=4&look=both",
            ),
        ] {
            if scene != "blend" && name == "light" {
                continue;
            }
            let mut session = Session::new();
            session.apply(Command::OpenLink(link.into())).unwrap();
            while session.work() {}
            let stage = staged(
                &mut Director::default(),
                &session,
                &options(&shown, look, &colors(theme)),
                0.0,
            );
            let image = gpu.draw(&format!("stage-{name}-{scene}"), &stage, size);
            if name == "paper" {
                // The background is white up to the corner.
                assert_eq!(image.pixel(4, 4), Some([255; 4]));
            }
        }
    }
}

#[test]
fn sliding_foot_is_marked_in_the_projector_look() {
    let Some(mut gpu) = gpu() else { return };
    let size = [1920, 1080];
    let shown = [(0, Viewport { width: size[0], height: size[1], ..Viewport::default() })];
    let mut session = Session::new();
    let link =
        "lab=blend&a=walk&b=run&blend_window=40&root_blend=off&camera_distance=4.2&stage=paper";
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    let mut look = Look::PAPER;
    look.edge_width *= 1.25;
    let colors = colors(1);
    let mut slides = |secs: f64| {
        session.apply(Command::Playback(PlaybackCommand::Seek(secs))).unwrap();
        let stage =
            staged(&mut Director::default(), &session, &options(&shown, look, &colors), 0.0);
        let ring = stage.panes[0].rings.iter().find(|ring| ring.color == colors.bad)?;
        // The ring is heavier than that of a planted foot.
        assert!(ring.fill > 0.2 && ring.width > 0.02);
        Some(stage)
    };
    let stage = (0..60).find_map(|step| slides(f64::from(step) * 0.1)).expect("a foot that slides");
    gpu.draw("hall-paper", &stage, size);
}
