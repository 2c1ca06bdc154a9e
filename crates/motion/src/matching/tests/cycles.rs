//! Tests of clips that are cycles.

use super::*;
use crate::gait::GaitCycle;
use crate::transition::repeat_clip;

/// Returns one stride of a made gait, without the frame that equals its first.
fn one_stride(action: Action, fps: f32, turn_rate_dps: f32) -> Arc<Motion> {
    let params = Params { turn_rate_dps, fps, ..Params::new(action) };
    let clip = Arc::new(synthesize(&params).unwrap().clip);
    let roles = Roles::detect(clip.skeleton());
    let cycle = GaitCycle::find(&Motion::with_roles(Arc::clone(&clip), &roles)).unwrap();
    Arc::new(Motion::with_roles(clip.crop(cycle.range()).unwrap(), &roles))
}

#[test]
fn cycle_has_the_features_of_its_repeated_clip() {
    for (action, fps, turn) in [
        (Action::Walk, 60.0, 0.0),
        (Action::Run, 60.0, 0.0),
        (Action::Walk, 100.0, 60.0),
        (Action::Run, 30.0, -40.0),
    ] {
        let stride = one_stride(action, fps, turn);
        let secs = stride.clip().frames() as f64 / stride.clip().fps();
        let database = Database::new(vec![stride.clone()], &cycle_options(true)).unwrap();
        assert!(database.skipped().is_empty() && database.motions().len() == 2);
        let layout = database.features().layout().clone();
        for motion in database.motions() {
            let name = format!("{action:?} {fps} {turn} {}", motion.is_mirrored());
            assert!(motion.is_cycle() && motion.valid(&layout) == motion.frames(), "{name}");
            assert!(
                (motion.frames() as f64 / RATE as f64 - secs).abs() < 1.6 / RATE as f64,
                "{name} {secs}"
            );
            // The slow way: nine repetitions as one long clip, of which the fifth is compared.
            let frames = motion.frames();
            // The motion continues over the seam.
            let step =
                |frame: usize| motion.root(frame).inverse().after(&motion.root(frame + 1)).shift;
            assert!(step(frames - 1).distance(step(frames - 2)) < 0.1 * step(0).length(), "{name}");
            let long = repeat_clip(motion.clip(), &motion.cycle().unwrap(), 9).unwrap();
            let long = Database::new(
                vec![Arc::new(Motion::with_roles(long, stride.roles()))],
                &cycle_options(false),
            )
            .unwrap();
            let long = &long.motions()[0];
            assert!(!long.is_cycle());
            for frame in 0..frames {
                let (mut own, mut wanted) = (vec![0.0; layout.dims()], vec![0.0; layout.dims()]);
                motion.write_row(&layout, frame, &mut own);
                long.write_row(&layout, 4 * frames + frame, &mut wanted);
                for (dim, (own, wanted)) in own.iter().zip(&wanted).enumerate() {
                    assert!(
                        (own - wanted).abs() < 2e-3,
                        "{name}, frame {frame}, {dim}: {own} {wanted}"
                    );
                }
                for side in crate::skeleton::Side::BOTH {
                    assert_eq!(
                        motion.contacts().planted(side, frame),
                        long.contacts().planted(side, 4 * frames + frame),
                        "{name} {frame}"
                    );
                }
            }
        }
        // Without repetition it ends, and is too short for its trajectory features if it lasts less
        // than a second.
        let ends = Database::new(vec![stride.clone()], &cycle_options(false));
        assert_eq!(ends.is_err(), secs < 1.0, "{secs} {ends:?}");
    }
    let whole: Vec<&str> = small_database()
        .motions()
        .iter()
        .filter(|motion| motion.is_cycle())
        .map(|motion| motion.clip().name())
        .collect();
    let leads_away = |name: &&str| ["start", "stop", "turn"].iter().any(|word| name.contains(word));
    assert!(!whole.iter().any(leads_away), "{whole:?}");
}

#[test]
fn cycle_plays_without_end() {
    let stride = one_stride(Action::Walk, 60.0, 0.0);
    let options = DatabaseOptions { mirrored: false, ..cycle_options(true) };
    let database = Arc::new(Database::new(vec![stride], &options).unwrap());
    let motion = Arc::clone(&database.motions()[0]);
    let frames = motion.frames();
    let control = Control::new(DVec2::new(0.0, 1.4), None);
    let mut controller =
        Controller::new(Arc::clone(&database), self::options(), &Planar::IDENTITY).unwrap();
    let (mut rounds, mut most, mut ends) = (0, 0.0f32, 0);
    for tick in 0..1_200 {
        let before = controller.place().frame;
        let jumps = controller.jumps();
        let pose = controller.pose().rotations.clone();
        controller.tick(&control);
        let search =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks());
        ends += usize::from(search.is_some_and(|search| search.reason == SearchReason::ClipEnd));
        if controller.jumps() == jumps {
            assert_eq!(controller.place().frame, (before + 1) % frames, "{tick}");
            rounds += usize::from(before + 1 == frames);
        }
        if tick > 300 {
            let turned = pose.iter().zip(&controller.pose().rotations);
            most =
                turned.map(|(&a, &b)| crate::math::quat::angle_between(a, b)).fold(most, f32::max);
        }
    }
    // Twenty seconds are nearly twenty strides, and none of them ends.
    assert!(rounds >= 15 && ends == 0, "{rounds} {ends}");
    let own = (0..frames - 1).flat_map(|frame| {
        let clip = motion.clip();
        let turned = clip.rotations(frame).iter().zip(clip.rotations(frame + 1));
        turned.map(|(&a, &b)| crate::math::quat::angle_between(a, b)).collect::<Vec<_>>()
    });
    let own = own.fold(0.0, f32::max);
    assert!(most < 1.3 * own + 0.02, "{most} {own}");
    assert!(
        (controller.root().shift.y - 28.0).abs() < 1.5 && controller.root().shift.x.abs() < 0.5,
        "{:?}",
        controller.root()
    );
}
