//! Tests that everything is drawn at the position of the visible figure, for characters of any
//! size.

use crate::{
    Director, Highlights, Layer, Pane, PathMarks, StageOptions, Viewport, pose_at, shown_size,
    view_size,
};
use glam::{Vec3, Vec3Swizzles};
use segue_formats::gltf::{GlbOptions, write_glb};
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, Interpolation};
use segue_motion::skeleton::{Role, Roles, Side, Skeleton, fixtures, world_pose};
use segue_motion::skin::{Character, SkinnedMesh};
use segue_session::export::{ExportBody, ExportFormat, ExportOptions, export};
use segue_session::{Command, Key, Session, Value};
use std::sync::Arc;

/// Returns a file of another program: a character on a rig of its own, with legs of a given length.
fn character_file(leg_metres: f32) -> Arc<[u8]> {
    let skeleton = fixtures::cmu_bvh();
    let factor = leg_metres / fixtures::roles(&skeleton).leg_length(&skeleton).unwrap();
    let skeleton = Arc::new(skeleton.scaled(factor));
    let root = skeleton.joints()[0].offset;
    let clip = Clip::new("person", Arc::clone(&skeleton), 30.0, vec![], vec![]);
    let clip = clip.unwrap_or_else(|error| panic!("{error} {root}"));
    let options = GlbOptions { smooth: true, ..GlbOptions::default() };
    let mut bytes = write_glb(&clip, &options).unwrap();
    let at = bytes.windows(6).position(|w| w == b"Segue ").unwrap();
    bytes[at..at + 5].copy_from_slice(b"Other");
    bytes.into()
}

/// Returns a session with a character whose legs are `size` times as long as those of the clips.
fn session(link: &str, size: f32) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    let motion = &session.main_outcome().unwrap().motion;
    let leg = motion.roles().leg_length(motion.clip().skeleton()).unwrap();
    session.load("person.glb", character_file(leg * size)).unwrap();
    while session.work() {}
    session
}

fn staged(session: &Session) -> Pane {
    staged_by(&mut Director::default(), session, Highlights::default())
}

/// Returns the pane that a director shows, with highlights.
fn staged_by(director: &mut Director, session: &Session, highlights: Highlights) -> Pane {
    let panes = [(0, Viewport { x: 0, y: 0, width: 640, height: 480 })];
    let options = StageOptions { panes: &panes, highlights, ..StageOptions::default() };
    let stage = director.stage(session, &options, 20.0);
    let size = shown_size(session, &session.main_outcome().unwrap().motion);
    let cell = (stage.grid_metres * size).log10();
    assert!((cell - cell.round()).abs() < 1e-4, "{cell}");
    stage.panes[0].clone()
}

/// Returns the position at which a joint of the first figure is drawn: where its mesh is moved to.
fn drawn(pane: &Pane, character: &Character, role: Role) -> Vec3 {
    let skin = pane.figures[0].skin.as_ref().unwrap();
    let joint = character.roles.get(role).unwrap();
    let bound = skin.mesh.bind[joint].inverse();
    (pane.joints[skin.joints.start + joint] * bound).translation
}

/// Returns the distance of a point of the ground from the lines that are painted on it.
fn distance_to_ground_lines(pane: &Pane, point: Vec3) -> f32 {
    let to_line = |from: Vec3, to: Vec3| {
        let (from, along) = (from.xz(), (to - from).xz());
        let share =
            ((point.xz() - from).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
        point.xz().distance(from + along * share)
    };
    let ground = pane.strokes.iter().filter(|stroke| stroke.layer == Layer::Ground);
    ground.map(|stroke| to_line(stroke.from, stroke.to)).fold(f32::INFINITY, f32::min)
}

fn set(session: &mut Session, key: Key, value: Value) {
    session.apply(Command::Set(vec![(key, value)])).unwrap();
    while session.work() {}
}

/// Checks at several times that everything is drawn at the position of the figure.
fn assert_drawn_together(session: &mut Session, size: f32, what: &str) {
    let character = session.character().unwrap();
    let mut rings = 0;
    for step in 0..8 {
        let secs = session.main_outcome().unwrap().duration_secs() * f64::from(step) / 8.0;
        set(session, Key::Time, Value::Number(secs));
        let motion = Arc::clone(session.main_outcome().unwrap());
        let motion = &motion.motion;
        let pane = staged(session);
        let shown = session.panes()[0].shown_at(session.now_secs()).unwrap();
        let world = pose_at(motion, shown.secs, &shown.place).unwrap();
        let hips = drawn(&pane, &character, Role::Hips);
        let moved = world.positions[motion.roles().get(Role::Hips).unwrap()];
        assert!(hips.xz().distance(moved.xz()) < 2e-3, "{what}: hips at {hips} beside {moved}");
        let [left, right] = Side::BOTH.map(|side| {
            let toe =
                character.roles.get(Role::toe(side)).map_or(Role::foot(side), |_| Role::toe(side));
            drawn(&pane, &character, toe).lerp(drawn(&pane, &character, Role::foot(side)), 0.35)
        });
        for ring in &pane.rings {
            let from =
                left.xz().distance(ring.center.xz()).min(right.xz().distance(ring.center.xz()));
            // The ring of the simulation object in the Match lab does not belong to a foot.
            assert!(from < 2e-3 || ring.radius > 0.15, "{what}: a ring {from} m beside the foot");
            rings += 1;
        }
        let leg = motion.roles().leg_length(motion.clip().skeleton()).unwrap();
        let head = drawn(&pane, &character, Role::Head);
        assert!((1.3..2.4).contains(&(head.y / leg)), "{what}: {head} on legs of {leg} m");
        // The hips sway about the curve that is fitted to their trajectory.
        let line = distance_to_ground_lines(&pane, hips);
        assert!(
            line < if what.contains("path") { 0.25 } else { 0.02 },
            "{what}: {line} m beside the line"
        );
        let target = pane.camera.target;
        assert!(
            target.xz().distance(hips.xz()) < 2e-3,
            "{what}: the camera looks at {target}, hips at {hips}"
        );
        assert!(
            (target.y / hips.y - 0.87).abs() < 0.25,
            "{what}: the camera looks at {target}, hips at {hips}"
        );
        let near = session.params().number(Key::CameraDistance) as f32 * view_size(session, motion);
        assert!((pane.camera.distance * size / near - 1.0).abs() < 1e-3, "{what}");
    }
    assert!(rings > 2, "{what}: {rings} rings");
}

#[test]
fn figure_of_any_size_stands_whole_in_the_picture() {
    for size in [0.05, 0.4, 0.8, 1.0, 1.25, 3.0, 12.0, 40.0] {
        let session = session("lab=view&a=idle&t=0.5", size);
        let pane = staged(&session);
        let skin = pane.figures[0].skin.as_ref().unwrap();
        let clip_from_world = pane.camera.projection(640.0 / 480.0) * pane.camera.view();
        let heights = (0..skin.mesh.bind.len()).map(|joint| {
            let at = pane.joints[skin.joints.start + joint] * skin.mesh.bind[joint].inverse();
            clip_from_world.project_point3(at.translation).y
        });
        let (low, high) = heights
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
        assert!(low > -0.9 && high < 0.9 && high - low > 0.55, "{size}: {low} to {high}");
    }
}

#[test]
fn annotations_of_a_character_of_any_size_are_at_its_figure() {
    for size in [1.6, 0.6] {
        let others = "camera_distance=4&follow_half_life=0&trail=on&contacts=on";
        for lab in ["view", "blend", "transition", "loop", "path"] {
            let mut session = session(&format!("lab={lab}&a=walk&{others}"), size);
            assert_drawn_together(&mut session, size, &format!("{lab}, {size}"));
            let roles = Roles::detect(session.main_outcome().unwrap().motion.clip().skeleton());
            assert!(roles.get(Role::Hips).is_some());
            set(&mut session, Key::A, Value::Text("run".into()));
            assert_drawn_together(&mut session, size, &format!("{lab} of another clip, {size}"));
        }
    }
}

#[test]
fn path_handles_of_a_character_of_any_size_lie_along_its_trajectory() {
    let mut session = session("lab=path&a=walk&camera_distance=4&follow_half_life=0&trail=on", 1.6);
    let character = session.character().unwrap();
    let mut director = Director::default();
    let path = PathMarks { handles: true, ..PathMarks::default() };
    let highlights = Highlights { path, ..Highlights::default() };
    let mut farthest = 0.0f32;
    for step in 0..=4 {
        let secs = session.main_outcome().unwrap().duration_secs() * f64::from(step) / 4.0;
        set(&mut session, Key::Time, Value::Number(secs));
        let pane = staged_by(&mut director, &session, highlights.clone());
        let hips = drawn(&pane, &character, Role::Hips);
        let dots = pane.strokes.iter().filter(|stroke| stroke.layer == Layer::Over);
        let nearest =
            dots.map(|dot| dot.from.xz().distance(hips.xz())).fold(f32::INFINITY, f32::min);
        farthest = farthest.max(nearest);
    }
    // Handles are about a metre apart.
    assert!(farthest < 1.0, "{farthest} m from the nearest handle");
}

#[test]
fn exported_character_equals_the_one_on_the_stage() {
    for size in [1.6, 0.6] {
        let mut session = session("lab=blend&a=walk&b=run&camera_distance=4", size);
        let outcome = Arc::clone(session.main_outcome().unwrap());
        let motion = &outcome.motion;
        let mut character = session.character().unwrap();
        let options = ExportOptions { format: ExportFormat::Glb, ..ExportOptions::default() };
        // Trousers in another colour.
        let mut mesh = SkinnedMesh::clone(&character.mesh);
        let (blue, red) = ([0.1, 0.2, 0.8, 1.0], [0.8, 0.3, 0.2, 1.0]);
        let middle = character.skeleton.joints()[0].offset.y;
        mesh.colors =
            mesh.positions.iter().map(|at| if at.y < middle { blue } else { red }).collect();
        character.mesh = Arc::new(mesh);
        let bytes = export(motion, Some(&character), &[], &options).unwrap();
        let back = import("x.glb", &bytes, &ImportOptions::default()).unwrap().clips.remove(0);
        let (skeleton, mesh) = (back.clip.skeleton(), back.mesh.unwrap());
        let names = |skeleton: &Skeleton| {
            skeleton.joints().iter().map(|joint| joint.name.clone()).collect::<Vec<_>>()
        };
        assert_eq!(names(skeleton), names(&character.skeleton));
        // The same triangles, in the order of their colours; weights are stored as bytes.
        let corners = |mesh: &SkinnedMesh, vertex: u32| {
            let vertex = vertex as usize;
            let [x, y, z] =
                mesh.positions[vertex].to_array().map(|x| (f64::from(x) * 1e4).round() as i64);
            (x, y, z, mesh.joints[vertex][0])
        };
        let triangles = |mesh: &SkinnedMesh| {
            let mut triangles: Vec<_> = mesh
                .triangles
                .iter()
                .map(|triangle| triangle.map(|corner| corners(mesh, corner)))
                .collect();
            triangles.sort_unstable();
            triangles
        };
        let (found, expected) = (triangles(&mesh), triangles(&character.mesh));
        let same = found.iter().filter(|triangle| expected.binary_search(triangle).is_ok()).count();
        assert_eq!(
            (found.len(), mesh.triangles.len()),
            (expected.len(), character.mesh.triangles.len())
        );
        assert!(same * 100 > found.len() * 98, "{same} of {} triangles", found.len());
        for color in [blue, red] {
            let is_near = |known: &[f32; 4]| {
                known.iter().zip(color).all(|(known, color)| (known - color).abs() < 1e-3)
            };
            assert!(mesh.colors.iter().filter(|known| is_near(known)).count() > 500);
        }
        // The exported character has its own size, and the stage shows the same pose.
        assert_eq!(back.clip.frames(), motion.clip().frames());
        let shown = shown_size(&session, motion);
        let mut director = Director::default();
        let mut farthest = 0.0f32;
        for frame in 0..motion.clip().frames() {
            set(&mut session, Key::Time, Value::Number(motion.clip().time_of(frame)));
            let pane = staged_by(&mut director, &session, Highlights::default());
            let skin = pane.figures[0].skin.as_ref().unwrap();
            // A link keeps the time to the millisecond.
            let pose = back.clip.sample(session.now_secs(), Interpolation::Linear).unwrap();
            let world = world_pose(skeleton, &pose);
            for (joint, bind) in skin.mesh.bind.iter().enumerate() {
                let drawn = (pane.joints[skin.joints.start + joint] * bind.inverse()).translation;
                farthest = farthest.max((drawn * shown).distance(world.positions[joint]));
            }
        }
        assert!(farthest < 1e-3, "{size}: {farthest} m apart");
        let plain = ExportOptions { body: ExportBody::Plain, ..options };
        let bytes = export(motion, Some(&character), &[], &plain).unwrap();
        let back = import("x.glb", &bytes, &ImportOptions::default()).unwrap().clips.remove(0);
        assert_eq!(names(back.clip.skeleton()), names(motion.clip().skeleton()));
        assert!(back.mesh.is_none());
    }
}
