//! Tests of databases: input, tags and mirror images.

use super::super::search::{Query, scan};
use super::*;
use crate::clip::{ContactCorrection, Interpolation, resample};
use crate::skeleton::Side;
use glam::Quat;

#[test]
fn database_of_invalid_clips_is_refused() {
    let options = DatabaseOptions::default();
    assert_eq!(Database::new(vec![], &options), Err(MatchError::NoClips));
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let with = |clip: Clip| Arc::new(Motion::with_roles(clip, walk.roles()));
    let short = with(walk.clip().crop(0..35).unwrap());
    let alone = Database::new(vec![short.clone()], &options);
    assert!(matches!(alone, Err(MatchError::NoValidFrame { clips: 1, .. })), "{alone:?}");
    assert!(alone.unwrap_err().to_string().contains("0.57 s"));
    // With a longer clip it is left out.
    let both = Database::new(vec![short, Arc::new(walk.clone())], &options).unwrap();
    assert!(matches!(both.skipped(), [MatchError::TooShort { .. }]) && both.motions().len() == 2);
    assert_eq!(both.motions()[0].source(), 1);
    let footless = Arc::new(Motion::with_roles(Arc::clone(walk.clip()), &Roles::default()));
    let error = Database::new(vec![footless], &options).unwrap_err();
    assert!(error.to_string().contains("hips"), "{error}");
    let endless = Clip::new(
        "endless",
        walk.clip().skeleton().clone(),
        1e-5,
        vec![Quat::IDENTITY; 2 * walk.clip().skeleton().len()],
        vec![Vec3::Y; 2],
    );
    assert!(matches!(
        Database::new(vec![with(endless.unwrap())], &options),
        Err(MatchError::TooManyFrames { .. })
    ));
    let mut broken = walk.clip().root_translations().to_vec();
    broken[7].x = f32::NAN;
    let rotations =
        (0..walk.clip().frames()).flat_map(|frame| walk.clip().rotations(frame).to_vec()).collect();
    let broken =
        with(Clip::new("broken", walk.clip().skeleton().clone(), 60.0, rotations, broken).unwrap());
    assert!(matches!(Database::new(vec![broken], &options), Err(MatchError::NotFinite { .. })));
}

#[test]
fn database_with_other_rates_times_and_tags_differs_as_documented() {
    let database = small_database();
    let features = FeatureOptions { trajectory_secs: vec![0.25, 0.5], ..FeatureOptions::default() };
    let retimed = DatabaseBuilder::retimed(database, &features).unwrap().finish().unwrap();
    assert_eq!((retimed.frames(), retimed.features().layout().dims()), (database.frames(), 23));
    assert!(retimed.valid().len() > database.valid().len());
    assert!(Arc::ptr_eq(&retimed.motions()[3], &database.motions()[3]));
    // The same motion at another rate gives the same features.
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let finer = resample(&clip, 120.0, Interpolation::Cubic).unwrap();
    // The clips end here: a repetition has a whole number of frames, which differs between rates.
    let [usual, fine] = [clip, finer].map(|clip| {
        Database::new(vec![Arc::new(Motion::analyze(clip))], &cycle_options(false)).unwrap()
    });
    assert_eq!(usual.frames(), fine.frames());
    assert!(usual.valid().iter().all(|&frame| usual.tags(frame as usize).has(Tag::Walk)));
    for &frame in usual.valid() {
        let rows = [&usual, &fine].map(|database| database.features().row(frame as usize).unwrap());
        for (a, b) in rows[0].iter().zip(rows[1]) {
            assert!((a - b).abs() < 2e-3, "{frame}: {a} {b}");
        }
    }
    let excluded = usual.retagged(0, &[TagRange { tag: Tag::Exclude, frames: 0..usual.frames() }]);
    let query = vec![0.0; 27];
    let query = Query { row: &query, weights: &[1.0; 27], filter: TagFilter::default() };
    assert_eq!(excluded.index().search(excluded.masks(), &query, None).best, None);
    assert!(scan(&usual.candidates(), &query).best.is_some());
    for number in (0..database.frames()).step_by(997) {
        assert_eq!(database.number(database.place(number).unwrap()), Some(number));
    }
    assert_eq!(
        (
            database.place(database.frames()),
            database.pose(Place { motion: 999, frame: 0 }, &Planar::IDENTITY)
        ),
        (None, None)
    );
}

/// A mirrored copy has the mirrored features.
#[test]
fn mirrored_motion_has_mirrored_features() {
    let database = small_database();
    let layout = database.features().layout();
    for motion in (0..database.motions().len()).step_by(2) {
        for frame in [5, 70] {
            let row = |motion| {
                let mut row = vec![0.0; layout.dims()];
                database.motion(motion).unwrap().write_row(layout, frame, &mut row);
                row
            };
            let (row, image) = (row(motion), row(motion + 1));
            for place in 0..6 {
                assert!(
                    (row[2 * place] + image[2 * place]).abs() < 1e-3
                        && (row[2 * place + 1] - image[2 * place + 1]).abs() < 1e-3
                );
            }
            for (from, to) in [(12, 15), (15, 12), (18, 21), (21, 18), (24, 24)] {
                assert!(
                    (row[from] + image[to]).abs() < 5e-3
                        && (row[from + 2] - image[to + 2]).abs() < 5e-3,
                    "{motion} {frame} {from}"
                );
            }
        }
    }
}

#[test]
fn corrected_contacts_are_those_of_the_database_at_its_rate_and_mirrored() {
    let walk = synthesize(&Params { fps: 30.0, ..Params::new(Action::Walk) }).unwrap();
    let corrections = [(10..20, false), (30..40, true)]
        .map(|(frames, planted)| ContactCorrection { foot: Side::Left.into(), frames, planted });
    let corrected =
        Motion::analyze(walk.clip).with_contact_corrections(corrections.into_iter().collect());
    let database = Database::new(vec![Arc::new(corrected)], &cycle_options(false)).unwrap();
    for (motion, side) in database.motions().iter().zip([Side::Left, Side::Right]) {
        for frame in 20..40 {
            assert!(!motion.contacts().planted(side, frame), "{frame}");
            assert!(motion.contacts().planted(side, 40 + frame), "{frame}");
        }
    }
    assert_eq!(database.motions().len(), 2);
}

#[test]
fn feature_rows_of_a_clip_are_those_of_its_database() {
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let options = DatabaseOptions { mirrored: false, cycles: false, ..DatabaseOptions::default() };
    let database = Database::new(vec![Arc::new(walk.clone())], &options).unwrap();
    let layout = database.features().layout();
    let clip = resample(walk.clip(), RATE as f64, Interpolation::Cubic).unwrap();
    let rows = feature_rows(&clip, walk.roles(), layout, 3).unwrap();
    let frames = database.valid().iter().step_by(3);
    assert_eq!(rows.len() / layout.dims(), frames.len());
    for (row, &frame) in rows.chunks_exact(layout.dims()).zip(frames) {
        let mut row = row.to_vec();
        database.features().normalise_row(&mut row);
        assert_eq!(Some(row.as_slice()), database.features().row(frame as usize));
    }
    let short = clip.crop(0..layout.horizon()).unwrap();
    assert_eq!(feature_rows(&short, walk.roles(), layout, 1), Ok(Vec::new()));
}

/// Clips of two rigs, a cycle among them, and one that is too short.
fn mixed_clips() -> Vec<Arc<Motion>> {
    let of = |action, fps| synthesize(&Params { fps, ..Params::new(action) }).unwrap().clip;
    let (idle, walk, run) =
        (of(Action::Idle, 60.0), of(Action::Walk, 30.0), of(Action::Run, 60.0).scaled(1.2));
    let short = walk.crop(0..9).unwrap();
    [idle, short, walk, run].map(|clip| Arc::new(Motion::analyze(clip))).into()
}

#[test]
fn database_of_clips_measured_in_any_order_is_the_same() {
    let (clips, options) = (mixed_clips(), DatabaseOptions::default());
    let whole = Database::new(clips.clone(), &options).unwrap();
    assert_eq!((whole.motions().len(), whole.skipped().len(), whole.retargeted().len()), (6, 1, 1));
    for order in [[3, 1, 0, 2], [2, 3, 1, 0]] {
        let mut builder = DatabaseBuilder::new(clips.clone(), &options).unwrap();
        for (count, &clip) in order.iter().enumerate() {
            assert_eq!(builder.unmeasured().count(), clips.len() - count);
            let (from, first) = (Arc::clone(&clips[clip]), Arc::clone(&clips[0]));
            let measured = ClipMeasurement::new(from, first, clip, &options).unwrap();
            builder.set_measured(clip, measured.finish().unwrap());
            let done = builder.progress().done;
            assert_eq!(done, 700 * (count + 1) / clips.len());
        }
        assert_eq!(builder.next_clip(), None);
        assert!(builder.finish().unwrap() == whole, "{order:?}");
    }
    // One that arrives while it is measured in slices, and one that is there already.
    let mut builder = DatabaseBuilder::new(clips.clone(), &options).unwrap();
    builder.advance().unwrap();
    let first = || ClipMeasurement::new(Arc::clone(&clips[0]), Arc::clone(&clips[0]), 0, &options);
    builder.set_measured(0, first().unwrap().finish().unwrap());
    builder.set_measured(0, MeasuredClip { motions: Vec::new(), retargeted: None });
    builder.set_measured(99, MeasuredClip { motions: Vec::new(), retargeted: None });
    assert!(builder.finish().unwrap() == whole);
}

#[test]
fn database_clip_of_parts_is_the_same_and_refused_where_one_is_missing() {
    let clip = DatabaseClip::clone(&small_database().motions()[1]);
    let parts = clip.clone().into_parts();
    assert!(DatabaseClip::of_parts(parts.clone()) == Some(clip));
    let mut torn = parts.clone();
    torn.body.pop();
    assert_eq!(DatabaseClip::of_parts(torn), None);
    let mut torn = parts.clone();
    torn.feet[1].pop();
    assert_eq!(DatabaseClip::of_parts(torn), None);
    let mut torn = parts;
    torn.pace.joints_radps.pop();
    assert_eq!(DatabaseClip::of_parts(torn), None);
}
