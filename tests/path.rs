//! Path editing: on synthesised motion everywhere, and on captured motion if this machine has it.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::shared_data;
use glam::DVec2;
use proptest::prelude::*;
use segue_formats::{ImportOptions, import};
use segue_motion::clip::{Clip, ContactOptions, Contacts, Motion};
use segue_motion::math::{Planar, quat};
use segue_motion::metrics::MotionTrace;
use segue_motion::path::{
    ArcLengthPath, CarriedMotion, CarryOptions, FitOptions, FittedPath, GroundSpline,
    MotionOptions, Offset, Orientation, PathEdit, PathEditError, PathEditor, Pins, SplineEnds,
    Timing, carry, hard_turns,
};
use segue_motion::skeleton::Roles;
use segue_motion::synth::{Action, Params, presets, synthesize};
use segue_motion::transition::FootLockOptions;
use std::sync::Arc;

const TIMINGS: [Timing; 3] = [Timing::Metres, Timing::Speed, Timing::Duration];
const FREE: Pins = Pins { start: false, end: false };

fn source(clip: Clip) -> (Arc<Motion>, Roles) {
    let roles = Roles::detect(clip.skeleton());
    (Arc::new(Motion::with_roles(clip, &roles)), roles)
}

fn made(params: &Params) -> (Arc<Motion>, Roles) {
    source(synthesize(params).expect("it can be made").clip)
}

fn walk() -> (Arc<Motion>, Roles) {
    made(&Params { duration_secs: 6.0, ..Params::new(Action::Walk) })
}

fn options(control_points: usize) -> FitOptions {
    FitOptions { control_points, ..FitOptions::default() }
}

fn every_option() -> impl Iterator<Item = CarryOptions> {
    let ways = [
        (Orientation::Path, Offset::Path),
        (Orientation::World, Offset::Path),
        (Orientation::Path, Offset::World),
        (Orientation::World, Offset::World),
    ];
    let of = move |timing| {
        ways.map(|(orientation, offset)| CarryOptions { timing, orientation, offset })
    };
    TIMINGS.into_iter().flat_map(of)
}

/// Returns the largest distance between joints, metres, and the largest angle between rotations of
/// joints, radians.
fn difference(a: &Clip, b: &Clip) -> (f32, f32) {
    assert_eq!(a.frames(), b.frames());
    let (mut far, mut turned) = (0.0f32, 0.0f32);
    for frame in 0..a.frames() {
        let (one, other) = (a.world_pose(frame), b.world_pose(frame));
        far = one
            .positions
            .iter()
            .zip(&other.positions)
            .map(|(p, q)| p.distance(*q))
            .fold(far, f32::max);
        let angles =
            one.rotations.iter().zip(&other.rotations).map(|(p, q)| quat::angle_between(*p, *q));
        turned = angles.fold(turned, f32::max);
    }
    (far, turned)
}

fn captured() -> Vec<Clip> {
    let Some(data) = shared_data() else {
        return vec![];
    };
    let names = [
        "games105/walkF.bvh",
        "games105/run_forward.bvh",
        "games105/walk_and_turn_left.bvh",
        "cmu/01_01.bvh",
        "cmu/run.bvh",
    ];
    let load = |name: &&str| {
        let bytes = std::fs::read(data.join(name)).ok()?;
        Some(
            import(name, &bytes, &ImportOptions::default())
                .ok()?
                .clips
                .swap_remove(0)
                .clip
                .with_name(*name),
        )
    };
    names.iter().filter_map(load).collect()
}

fn assert_same(path: &FittedPath, what: &str) {
    for options in every_option() {
        let out = carry(path, path.curve(), &options).expect("it is a path");
        let (far, turned) = difference(&out.clip, path.source().clip());
        assert!(far < 1e-4 && turned < 1e-4, "{what} {options:?}: {far} m, {turned} rad");
        assert!(hard_turns(path, &out).is_empty(), "{what}");
    }
}

#[test]
fn path_without_edits_keeps_the_motion() {
    let mut stood = vec![];
    for preset in presets() {
        let (source, _) = made(&preset.params);
        for control_points in [4, 8, 30] {
            match FittedPath::new(Arc::clone(&source), &options(control_points)) {
                Ok(path) => assert_same(&path, preset.id),
                Err(PathEditError::NoTravel { extent_m }) if extent_m < 0.2 => {
                    stood.push(preset.id);
                }
                Err(error) => panic!("{}: {error}", preset.id),
            }
        }
    }
    stood.dedup();
    assert!(stood.iter().all(|id| ["idle", "spin"].contains(id)), "{stood:?}");
    for clip in captured() {
        let (source, _) = source(clip);
        let path = FittedPath::new(Arc::clone(&source), &options(8)).expect("it goes somewhere");
        println!("{}: {:?}, {:.2} m", source.clip().name(), path.error(), path.curve().length_m());
        assert_same(&path, source.clip().name());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn path_moved_rigidly_moves_the_motion_rigidly(
        yaw in -3.0f64..3.0, x in -20.0f64..20.0, z in -20.0f64..20.0, preset in 0usize..7, control_points in 4usize..20
    ) {
        let (source, _) = made(&presets()[preset].params);
        let path = FittedPath::new(source, &options(control_points)).unwrap();
        let planar = Planar::new(yaw, x, z);
        let points = path.curve().spline().points().iter().map(|&p| planar.apply_ground(p)).collect();
        let moved = ArcLengthPath::new(GroundSpline::uniform(points).unwrap()).unwrap();
        let expected = path.source().clip().transformed(&planar);
        for timing in TIMINGS {
            let out = carry(&path, &moved, &CarryOptions { timing, ..CarryOptions::default() }).unwrap();
            let (far, turned) = difference(&out.clip, &expected);
            prop_assert!(far < 1e-4 && turned < 1e-4, "{timing:?}: {far} m, {turned} rad");
        }
    }

    /// In every frame the body is that of the original, moved over the ground, whatever the path;
    /// and the result is deterministic.
    #[test]
    fn path_of_any_shape_keeps_the_body(points in prop::collection::vec((-3.0f64..3.0, -3.0f64..3.0), 4..10), closed: bool) {
        let (source, _) = walk();
        let path = FittedPath::new(source, &options(6)).unwrap();
        let mut spline = GroundSpline::uniform(points.into_iter().map(DVec2::from).collect()).unwrap();
        if let Ok(ring) = spline.edited(&PathEdit::Close, FREE).and_then(|ring| ArcLengthPath::new(ring.clone()).map(|_| ring)) && closed {
            spline = ring;
        }
        let Ok(edited) = ArcLengthPath::new(spline) else { return Ok(()) };
        let original = path.source().clip();
        for options in every_option() {
            let out = carry(&path, &edited, &options).unwrap();
            prop_assert_eq!(&out, &carry(&path, &edited, &options).unwrap());
            for (frame, &at) in out.frames.iter().enumerate().step_by(17).filter(|(_, at)| at.fract() == 0.0) {
                let (a, b) = (out.clip.world_pose(frame).positions, original.world_pose(at as usize).positions);
                for (i, j) in (0..a.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
                    prop_assert!((a[i].distance(a[j]) - b[i].distance(b[j])).abs() < 1e-4);
                    prop_assert!((a[i].y - b[i].y).abs() < 1e-4);
                }
            }
        }
    }
}

/// Returns a walk, its path, and the path with its middle dragged sideways.
fn bow(by: f64) -> (FittedPath, Roles, ArcLengthPath) {
    let (source, roles) = walk();
    let path = FittedPath::new(source, &options(8)).expect("a walk goes somewhere");
    let spline = path.curve().spline();
    let to = spline.points()[4] + DVec2::new(by, 0.0);
    let edited = spline.edited(&PathEdit::Move { index: 4, to }, FREE).expect("the point is there");
    (path, roles, ArcLengthPath::new(edited).expect("it has a length"))
}

/// The slow implementation of the timing: lengths by many chords, frames by small steps along the
/// path.
#[test]
fn timing_by_metres_keeps_distances() {
    let (path, _, edited) = bow(1.0);
    let out = carry(&path, &edited, &CarryOptions::default()).unwrap();
    let samples = 200_000;
    let walked = |spline: &GroundSpline| {
        let mut along = vec![0.0];
        for k in 1..=samples {
            let step = spline
                .position(f64::from(k) / f64::from(samples))
                .distance(spline.position(f64::from(k - 1) / f64::from(samples)));
            along.push(along[along.len() - 1] + step);
        }
        along
    };
    let frame_at = |spline: &GroundSpline, u: f64| {
        let way = spline.position(u + 1e-6) - spline.position(u - 1e-6);
        let place = spline.position(u);
        Planar::new(way.x.atan2(way.y), place.x, place.y)
    };
    let (old, new) = (path.curve().spline(), edited.spline());
    let (old_along, new_along) = (walked(old), walked(new));
    let clip = path.source().clip();
    for frame in (1..clip.frames() - 1).step_by(13) {
        let u = path.parameters()[frame];
        let metres = old_along[(u * f64::from(samples)).round() as usize];
        let v = new_along.partition_point(|&along| along < metres) as f64 / f64::from(samples);
        let planar = frame_at(new, v).after(&frame_at(old, u).inverse());
        let expected = planar.apply(clip.root_translations()[frame]);
        assert!(out.clip.root_translations()[frame].distance(expected) < 1e-3, "{frame}");
    }
    assert!((out.taken_m().end - out.taken_m().start - path.curve().length_m()).abs() < 1e-6);
    assert_eq!(out.clip.frames(), clip.frames());
}

#[test]
fn timing_keeps_speed_or_duration() {
    let (path, _, edited) = bow(3.0);
    assert!(edited.length_m() > 1.1 * path.curve().length_m());
    let with = |timing| {
        let options = CarryOptions { timing, ..CarryOptions::default() };
        carry(&path, &edited, &options).unwrap()
    };
    let whole = |out: &CarriedMotion| (out.taken_m().end - edited.length_m()).abs() < 1e-6;
    let (speed, duration) = (with(Timing::Speed), with(Timing::Duration));
    assert!(whole(&speed) && whole(&duration));
    assert_eq!(duration.clip.frames(), path.source().clip().frames());
    let grown = speed.clip.frames() as f64 / duration.clip.frames() as f64;
    assert!((grown - edited.length_m() / path.curve().length_m()).abs() < 0.02, "{grown}");
    // Frame by frame as fast as the original at the same moment.
    let fps = speed.clip.fps();
    for frame in 1..speed.clip.frames() {
        let own = (speed.places[frame].along_m - speed.places[frame - 1].along_m) * fps;
        let at = speed.frames[frame - 1] as usize;
        let original = (path.places()[at + 1].along_m - path.places()[at].along_m) * fps;
        assert!((own - original).abs() < 0.1, "{frame}: {own} {original}");
    }
    // Far from the dragged point nothing changes.
    let (far, turned) =
        difference(&duration.clip.crop(0..30).unwrap(), &path.source().clip().crop(0..30).unwrap());
    assert!(far < 1e-4 && turned < 1e-4, "{far} {turned}");
}

#[test]
fn facing_is_kept_on_request() {
    let (path, roles, edited) = bow(2.0);
    let options = CarryOptions { orientation: Orientation::World, ..CarryOptions::default() };
    let out = carry(&path, &edited, &options).unwrap();
    let turned = carry(&path, &edited, &CarryOptions::default()).unwrap();
    let clip = path.source().clip();
    let place =
        |clip: &Clip| Motion::with_roles(Arc::new(clip.clone()), &roles).ground_frames().to_vec();
    for ((held, turned), frame) in place(&out.clip).iter().zip(place(&turned.clip)).zip(0..) {
        assert!(quat::angle_between(out.clip.rotations(frame)[0], clip.rotations(frame)[0]) < 1e-3);
        assert!(held.shift.distance(turned.shift) < 1e-4, "{frame}");
    }
}

#[test]
fn offset_stays_in_the_world_on_request() {
    let (path, roles, edited) = bow(2.0);
    for orientation in [Orientation::Path, Orientation::World] {
        let options =
            CarryOptions { orientation, offset: Offset::World, ..CarryOptions::default() };
        let out = carry(&path, &edited, &options).unwrap();
        let stands =
            Motion::with_roles(Arc::new(out.clip.clone()), &roles).ground_frames().to_vec();
        let rows = stands
            .iter()
            .zip(&out.characters)
            .zip(path.source().ground_frames())
            .zip(&out.places)
            .zip(path.places());
        for ((((found, told), stood), place), old) in rows {
            let (offset, was) = (found.shift - place.frame.shift, stood.shift - old.frame.shift);
            assert!(offset.distance(was) < 1e-4, "{offset} {was}");
            assert!(found.shift.distance(told.shift) < 1e-4);
        }
    }
}

#[test]
fn path_with_unclamped_ends_is_the_same() {
    for count in [4, 5, 9] {
        let with = |ends| {
            let (source, _) = made(&Params {
                turn_rate_dps: 40.0,
                duration_secs: 6.0,
                ..Params::new(Action::Walk)
            });
            let options = FitOptions { ends, ..options(count) };
            FittedPath::new(source, &options).unwrap().curve().spline().clone()
        };
        let (clamped, uniform) = (with(SplineEnds::Clamped), with(SplineEnds::Uniform));
        assert_eq!((clamped.ends(), uniform.ends()), (SplineEnds::Clamped, SplineEnds::Uniform));
        for k in 0..=100 {
            let u = f64::from(k) / 100.0;
            assert!(clamped.position(u).distance(uniform.position(u)) < 1e-9);
        }
        // The matrix of a uniform piece: the path begins in (P0 + 4 P1 + P2)/6, in the direction P2
        // - P0.
        let (p, end) = (uniform.points(), uniform.points().len() - 1);
        let mean = |a: DVec2, b: DVec2, c: DVec2| (a + b * 4.0 + c) / 6.0;
        assert!(mean(p[0], p[1], p[2]).distance(uniform.position(0.0)) < 1e-9);
        assert!(mean(p[end], p[end - 1], p[end - 2]).distance(uniform.position(1.0)) < 1e-9);
        let way = p[2] - p[0];
        assert!((way.x.atan2(way.y) - uniform.heading(0.0)).abs() < 1e-9);
        // The first point moves the path by at most 1/6 of its own motion; clamped, it moves the
        // start as well.
        let by = DVec2::new(0.6, 0.0);
        let start = |spline: &GroundSpline, pins: Pins| {
            let to = spline.points()[0] + by;
            let moved = spline.edited(&PathEdit::Move { index: 0, to }, pins)?;
            Ok::<DVec2, PathEditError>(moved.position(0.0) - spline.position(0.0))
        };
        assert!(start(&uniform, FREE).unwrap().distance(by / 6.0) < 1e-9);
        assert!(start(&clamped, FREE).unwrap().distance(by) < 1e-9);
        let pinned = Pins { start: true, ..FREE };
        assert_eq!(start(&uniform, pinned), Err(PathEditError::Pinned));
        // All other operations apply to the curve.
        for edit in [
            PathEdit::Insert { at: 0.4 },
            PathEdit::Rotate { radians: 0.5 },
            PathEdit::Straighten { share: 0.3 },
        ] {
            let (one, other) = (clamped.edited(&edit, pinned), uniform.edited(&edit, pinned));
            let (one, other) = (one.unwrap(), other.unwrap());
            assert_eq!(other.ends(), SplineEnds::Uniform);
            for k in 0..=20 {
                let u = f64::from(k) / 20.0;
                assert!(one.position(u).distance(other.position(u)) < 1e-8, "{edit:?}");
            }
        }
    }
}

#[test]
fn foot_lock_on_an_edited_path_plants_the_feet() {
    let lock = Some(FootLockOptions::default());
    let mut checked = 0;
    let made =
        [Action::Walk, Action::Run].map(|action| synthesize(&Params::new(action)).unwrap().clip);
    for clip in made.into_iter().chain(captured()) {
        let (source, roles) = source(clip);
        let contacts = Contacts::detect(source.clip(), &roles, &ContactOptions::default());
        let path = FittedPath::new(source, &options(6)).unwrap();
        let spline = path.curve().spline();
        // At right angles to the line between the ends.
        let way = spline.points()[5] - spline.points()[0];
        let to =
            spline.points()[3] + way.perp().normalize_or_zero() * 0.15 * path.curve().length_m();
        let edited =
            ArcLengthPath::new(spline.edited(&PathEdit::Move { index: 3, to }, FREE).unwrap())
                .unwrap();
        let name = path.source().clip().name().to_owned();
        let editor = PathEditor::new(path, &roles, contacts);
        for timing in TIMINGS {
            let carry = CarryOptions { timing, ..CarryOptions::default() };
            let out = editor.motion(&edited, &MotionOptions { carry, foot_lock: lock }).unwrap();
            println!("{name} {timing:?}: {:?}, {} hard turns", out.slide_cm, out.hard_turns.len());
            let (Some(carried), Some(locked)) = (out.slide_cm.carried, out.slide_cm.locked) else {
                continue;
            };
            // This one goes there and back: where it turns round, six control points do not make a
            // path, and no foot can be locked.
            let limit =
                if name.ends_with("01_01.bvh") { carried } else { (0.25 * carried).max(0.5) };
            assert!(locked <= limit, "{name} {timing:?}: {carried} → {locked} cm");
            checked += 1;
        }
    }
    assert!(checked >= 6);
}

#[test]
fn foot_lock_on_a_bent_path_keeps_the_yaw_of_feet() {
    for params in [
        Params { height_m: 1.9, seed: 632, ..Params::new(Action::Jump) },
        Params::new(Action::Walk),
    ] {
        let (source, roles) = made(&params);
        let contacts = Contacts::detect(source.clip(), &roles, &ContactOptions::default());
        let path = FittedPath::new(Arc::clone(&source), &options(6)).unwrap();
        let spline = path.curve().spline();
        let way = spline.points()[5] - spline.points()[0];
        let edited =
            [(2, 0.25), (4, -0.25)].into_iter().fold(spline.clone(), |spline, (index, share)| {
                let to = spline.points()[index] + way.perp() * share;
                spline.edited(&PathEdit::Move { index, to }, FREE).unwrap()
            });
        let options = MotionOptions {
            foot_lock: Some(FootLockOptions::default()),
            ..MotionOptions::default()
        };
        let editor = PathEditor::new(path, &roles, contacts);
        let bent = editor.motion(&ArcLengthPath::new(edited).unwrap(), &options).unwrap();
        let skating = |clip: &Clip| MotionTrace::new(clip, &roles).skating_cm_per_sec().unwrap();
        let (original, locked) = (skating(source.clip()), skating(&bent.clip));
        assert!(locked < original.max(0.5), "{:?}: {original} → {locked} cm/s", params.action);
    }
}

#[test]
fn motion_beyond_the_end_of_a_path_continues() {
    // The hips sway, so this path turns at its end by 3° per frame.
    let mut params = Params {
        speed_mps: 0.65,
        turn_rate_dps: -8.0,
        height_m: 1.9,
        seed: 213,
        duration_secs: 4.0,
        ..Params::new(Action::Walk)
    };
    (params.style.arm_swing, params.style.bounce) = (0.65, 0.25);
    let (source, _) = made(&params);
    let path = FittedPath::new(Arc::clone(&source), &FitOptions::default()).unwrap();
    let shorter = path.curve().spline().edited(&PathEdit::Scale { factor: 0.9 }, FREE).unwrap();
    let shorter = ArcLengthPath::new(shorter).unwrap();
    let carried = carry(&path, &shorter, &CarryOptions::default()).unwrap();
    let behind: Vec<usize> = (0..source.clip().frames())
        .filter(|&frame| path.places()[frame].along_m > shorter.length_m())
        .collect();
    assert!(behind.len() > 10, "{}", behind.len());
    for pair in behind.windows(2) {
        let step = |frames: &[Planar]| frames[pair[0]].inverse().after(&frames[pair[1]]);
        let (was, is) = (step(source.ground_frames()), step(&carried.characters));
        assert!((was.yaw - is.yaw).abs() < 1e-9, "{pair:?}: {was:?} {is:?}");
        assert!(was.shift.distance(is.shift) < 1e-9, "{pair:?}: {was:?} {is:?}");
    }
    // No jump at the end.
    let step = |frames: &[Planar]| frames[behind[0] - 1].inverse().after(&frames[behind[0]]);
    let (was, is) = (step(source.ground_frames()), step(&carried.characters));
    assert!(
        (was.yaw - is.yaw).abs() < 0.05 && was.shift.distance(is.shift) < 0.002,
        "{was:?} {is:?}"
    );
}

#[test]
fn path_with_sharp_turns_reports_them() {
    let (path, _, gentle) = bow(0.2);
    let out = carry(&path, &gentle, &CarryOptions::default()).unwrap();
    assert_eq!(hard_turns(&path, &out), []);
    let (path, _, sharp) = bow(4.0);
    let out = carry(&path, &sharp, &CarryOptions::default()).unwrap();
    let turns = hard_turns(&path, &out);
    assert!(!turns.is_empty());
    for turn in turns {
        assert!(turn.frames.contains(&turn.worst) && turn.turn_dps > turn.limit_dps, "{turn}");
        assert!(turn.to_string().contains("widen the bend"));
    }
}

#[test]
fn path_of_a_degenerate_motion_works_or_is_refused() {
    let (idle, _) = made(&Params::new(Action::Idle));
    let error = FittedPath::new(idle, &FitOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no path to edit"), "{error}");
    let (source_of_walk, _) = walk();
    for frames in [0, 1] {
        let (short, _) = source(source_of_walk.clip().crop(0..frames).unwrap());
        assert_eq!(
            FittedPath::new(short, &FitOptions::default()).unwrap_err(),
            PathEditError::Frames { frames }
        );
    }
    // A fifth of a second, with more control points than frames.
    let (short, _) = source(source_of_walk.clip().crop(0..12).unwrap());
    assert_same(&FittedPath::new(short, &options(16)).unwrap(), "short");
    // More than a full circle, beyond its own beginning.
    let round = Params { duration_secs: 9.0, turn_rate_dps: 60.0, ..Params::new(Action::Walk) };
    let (round, _) = made(&round);
    let path = FittedPath::new(round, &options(12)).unwrap();
    assert_same(&path, "round");
    assert!(path.error().most_cm < 20.0, "{:?}", path.error());
    // A walk on a closed path continues around it.
    let (path, _, _) = bow(0.0);
    let ring = path.curve().spline().edited(&PathEdit::Scale { factor: 0.4 }, FREE).unwrap();
    let ring = ArcLengthPath::new(ring.edited(&PathEdit::Close, FREE).unwrap()).unwrap();
    let out = carry(&path, &ring, &CarryOptions::default()).unwrap();
    assert!(out.taken_m().end > 2.0 * ring.length_m());
    let steps = out.clip.root_translations().windows(2).map(|pair| pair[0].distance(pair[1]));
    assert!(steps.fold(0.0, f32::max) < 0.06);
    // There and back the same way.
    let clip = source_of_walk.clip();
    let order: Vec<usize> = (0..clip.frames()).chain((0..clip.frames() - 1).rev()).collect();
    let back = Clip::from_poses(
        "back",
        clip.skeleton().clone(),
        clip.fps(),
        order.iter().map(|&frame| clip.pose(frame)),
    )
    .unwrap();
    let (back, _) = source(back);
    assert_same(&FittedPath::new(back, &options(16)).unwrap(), "there and back");
}
