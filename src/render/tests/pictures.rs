//! Pictures of bodies made of limbs.

use super::{actors, blend_pane, gpu, stage};
use glam::Vec3;
use segue_motion::math::Planar;
use segue_motion::skeleton::{Joint, Roles, Skeleton, world_pose};
use segue_scene::{
    Body, Bounds, Camera, Layer, Look, Pane, Ring, Stage, Viewport, rgb, with_alpha,
};

#[test]
fn three_panes_are_drawn_in_both_themes_and_on_a_phone() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    for (theme, light) in [("dark", false), ("light", true)] {
        let image = gpu.draw(
            &format!("three-{theme}"),
            &stage(&actors, [1440, 900], 3, light, 1.0),
            [1440, 900],
        );
        // The colours of the palette are exact.
        let expected = if light { [0xee, 0xf0, 0xf4, 0xff] } else { [0x0f, 0x11, 0x15, 0xff] };
        assert_eq!(image.pixel(20, 0), Some(expected));
        assert_eq!(image.pixel(1300, 0), Some(expected));
        gpu.draw(&format!("phone-{theme}"), &stage(&actors, [780, 800], 1, light, 2.0), [780, 800]);
    }
}

#[test]
fn mannequin_is_drawn_from_all_sides() {
    let Some(mut gpu) = gpu() else { return };
    let actors = actors();
    let size = [1800, 1100];
    for light in [false, true] {
        let look = if light { Look::LIGHT } else { Look::DARK };
        let panes = (0..10u32)
            .map(|i| {
                let viewport = Viewport { x: i % 5 * 360, y: i / 5 * 550, width: 360, height: 550 };
                let pose =
                    if i < 5 { actors.walk.world_pose(60) } else { actors.run.world_pose(31) };
                let here = pose.positions[0].with_y(0.0);
                let mut bounds = Bounds::EMPTY;
                bounds.include_pose(&pose);
                let mut camera = Camera {
                    yaw: i as f32 * std::f32::consts::FRAC_PI_4,
                    pitch: 0.1,
                    ..Camera::default()
                };
                camera.frame(&bounds.grown(0.12), viewport.aspect());
                let mut pane = Pane { viewport, camera, focus: here, ..Pane::default() };
                pane.add_body(&actors.body, &pose, look.clay);
                pane
            })
            .collect();
        gpu.draw(
            if light { "sides-light" } else { "sides-dark" },
            &Stage { panes, look, pixels_per_point: 1.0, ..Stage::default() },
            size,
        );
    }
}

/// Returns the skeleton of a four-legged animal, whose joints have no roles.
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
fn bodies_are_drawn_from_above_close_up_and_without_roles() {
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
            &segue_motion::skeleton::Pose {
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
                panes[3].add_line(
                    person.positions[parent],
                    person.positions[index],
                    rgb(0x58_d6_a9),
                    1.5,
                    Layer::Over,
                );
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
            &Stage { panes, look, pixels_per_point: 1.0, ..Stage::default() },
            [1600, 800],
        );
    }
}
