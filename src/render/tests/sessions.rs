//! Pictures of the stages of sessions.

use super::{colors, gpu, options, staged};
use segue_motion::path::{PathEdit, Pins};
use segue_scene::{Colors, Director, Highlights, Look, PathMarks, StageOptions, Viewport};
use segue_session::{Command, Key, List, Session};
use std::sync::Arc;

#[test]
fn chosen_joint_is_marked_over_the_body() {
    let Some(mut gpu) = gpu() else { return };
    let size = [700, 600];
    let shown = [(0, Viewport { width: size[0], height: size[1], ..Viewport::default() })];
    for (theme, look) in [Look::DARK, Look::LIGHT].into_iter().enumerate() {
        let mut session = Session::new();
        let link = "lab=view&a=walk&t=0.4&joint=left%20hand&trail=off&contacts=off".to_owned();
        session.apply(Command::OpenLink(link)).unwrap();
        let mut director = Director::default();
        let mut accent = |marked: bool| {
            let highlights = Highlights { joint: marked, ..Highlights::default() };
            let options = StageOptions { highlights, ..options(&shown, look, &colors(theme)) };
            let stage = staged(&mut director, &session, &options, 0.0);
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
fn limbs_of_a_layered_body_have_the_colours_of_their_clips() {
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
            let shown: Vec<(usize, Viewport)> =
                Viewport::columns(size[0], size[1], panes, 1).enumerate().collect();
            let stage =
                staged(&mut Director::default(), &session, &options(&shown, look, &colors), 0.0);
            let image = gpu.draw(&format!("{name}-{theme}"), &stage, size);
            let is_blue = |p: &&[u8]| i32::from(p[2]) - i32::from(p[0]) > 40;
            blue.push(image.rgba.chunks_exact(4).filter(is_blue).count());
        }
        assert!(blue[0] > 5_000 && blue[5] < 500, "{blue:?}");
    }
}

#[test]
fn registered_clips_are_drawn_beside_the_result() {
    let Some(mut gpu) = gpu() else { return };
    let (size, look) = ([1400, 560], Look::DARK);
    let colors = Colors { ghost_alpha: 0.42, ..colors(0) };
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
        let shown: Vec<(usize, Viewport)> =
            Viewport::columns(size[0], size[1], panes, 1).enumerate().collect();
        let highlights = Highlights { pair, ..Highlights::default() };
        let options = StageOptions { highlights, ..options(&shown, look, &colors) };
        let stage = staged(&mut Director::default(), &session, &options, 0.0);
        let ghosts = stage.panes[0].figures.iter().filter(|figure| figure.ghost).count();
        let bodies = stage.panes[0].figures.len() - ghosts;
        assert_eq!((ghosts, bodies), (2, usize::from(pair.is_none())), "{name}");
        gpu.draw(name, &stage, size);
    }
}

#[test]
fn path_is_drawn_with_its_points_and_extra_characters() {
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
                let spline = outcome.path().unwrap().curve.spline();
                let to = spline.points()[4] + glam::DVec2::new(-1.4, -1.9);
                let edited =
                    spline.edited(&PathEdit::Move { index: 4, to }, Pins::default()).unwrap();
                session
                    .apply(Command::Set(vec![(
                        Key::Path,
                        List::EditedPath(Some(edited.clone())).into(),
                    )]))
                    .unwrap();
                assert!(!session.main_outcome().unwrap().path().unwrap().hard_turns.is_empty());
            }
            let viewport = Viewport { x: 0, y: 0, width: size[0], height: size[1] };
            let path = PathMarks {
                handles: true,
                chosen: Some(4),
                hovered: Some(2),
                ..PathMarks::default()
            };
            let shown = [(0, viewport)];
            let highlights = Highlights { path, ..Highlights::default() };
            let options = StageOptions { highlights, ..options(&shown, look, &colors) };
            let stage = staged(&mut Director::default(), &session, &options, 0.0);
            let bodies = if name == "path-fitted" { 1 } else { 3 };
            assert_eq!(stage.panes[0].figures.len(), bodies, "{name}");
            gpu.draw(&format!("{name}-{theme}"), &stage, size);
        }
    }
}

#[test]
fn driven_character_is_drawn_with_its_paths_a_ghost_and_a_crowd() {
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
            let driven = outcome.driven().unwrap();
            let moment = driven.at(session.now_secs()).unwrap();
            let candidate = moment.search.as_ref().map(|search| search.candidates[1].place);
            let shown = [(0, Viewport { x: 0, y: 0, width: size[0], height: size[1] })];
            let highlights = Highlights { candidate, ..Highlights::default() };
            let options = StageOptions { highlights, ..options(&shown, look, &colors) };
            let stage = staged(&mut Director::default(), &session, &options, 0.0);
            assert_eq!(stage.panes[0].figures.len(), bodies, "{name}");
            let ring = stage.panes[0].rings.iter().any(|ring| ring.color[..3] == colors.a[..3]);
            assert!(ring, "the simulation object");
            gpu.draw(&format!("{name}-{theme}"), &stage, size);
        }
    }
}
