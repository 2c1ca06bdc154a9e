//! Registered blends of captured walks compared with plain ones, if this machine has the data.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::captured;
use glam::Vec3;
use segue_motion::blend::{
    DissolveOptions, FrameMix, Partner, WeightCurve, WeightLaw, dissolve, registered_blend,
    registered_join,
};
use segue_motion::clip::{Clip, ContactOptions, Contacts, Interpolation, Motion};
use segue_motion::registration::{
    PairTerms, PathEnd, Registration, RegistrationOptions, limb_weights,
};
use segue_motion::skeleton::{Roles, Side, world_pose};
use std::sync::Arc;

struct Take {
    name: String,
    source: Motion,
    roles: Roles,
    contacts: Contacts,
}

impl Take {
    fn new(name: &str, clip: Clip) -> Self {
        let roles = Roles::detect(clip.skeleton());
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        Self { name: name.to_owned(), source: Motion::with_roles(clip, &roles), roles, contacts }
    }

    fn clip(&self) -> &Arc<Clip> {
        self.source.clip()
    }
}

/// Returns takes of subject 16 of the CMU database; empty if the data is missing.
fn takes(wanted: &[&'static str]) -> Vec<Take> {
    captured(wanted).into_iter().map(|(name, clip)| Take::new(name, clip)).collect()
}

fn register(a: &Take, b: &Take) -> Registration {
    let (from, to) = (a.clip(), b.clip());
    let mut terms = PairTerms::new(
        from,
        0..from.frames(),
        to,
        0..to.frames(),
        &limb_weights(from.skeleton()),
        1,
    )
    .expect("one body");
    terms.finish();
    let matrix = terms.distances(15, &(0..from.frames()), &(0..to.frames())).expect("complete");
    let mut options = RegistrationOptions::new(from.fps());
    options.path.start = PathEnd::Border { slack: 0.35 };
    options.path.end = PathEnd::Border { slack: 0.35 };
    Registration::new(&terms, &matrix, &options).expect("walks can be registered")
}

/// Returns the points of a foot at a frame that may be between two.
fn foot(clip: &Clip, roles: &Roles, side: Side, frame: f64) -> Vec<Vec3> {
    let pose = clip.sample(frame / clip.fps(), Interpolation::Linear).expect("a clip with frames");
    let world = world_pose(clip.skeleton(), &pose);
    let points = roles.foot_points(clip.skeleton(), side);
    points.iter().map(|&(joint, point)| world.point(joint, point)).collect()
}

/// Returns the step over the ground of the point that moves least.
fn stillest(before: &[Vec3], now: &[Vec3]) -> Vec3 {
    let steps = before.iter().zip(now).map(|(a, b)| Vec3::new(b.x - a.x, 0.0, b.z - a.z));
    steps.min_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or_default()
}

/// Returns the distance that planted feet slide with more than half of the weight, beyond their
/// slide in the heavier clip: the mean over all stances, centimetres. Frame `start` of `result` is
/// made from the first mix.
fn skate_cm(result: &Clip, start: usize, mixes: &[FrameMix], takes: [&Take; 2]) -> f64 {
    let mut stances: Vec<f32> = vec![];
    for side in Side::BOTH {
        let (mut drift, mut farthest) = (Vec3::ZERO, None::<f32>);
        let heavier = |mix: &FrameMix| usize::from(mix.weights[1] > mix.weights[0]);
        let planted = |mix: &FrameMix| {
            let stands =
                |of: &usize| takes[*of].contacts.planted(side, mix.frames[*of].round() as usize);
            (0..2).filter(stands).map(|of| mix.weights[of]).sum::<f64>() > 0.5
        };
        for (k, pair) in mixes.windows(2).enumerate() {
            if !(planted(&pair[0]) && planted(&pair[1])) {
                stances.extend(farthest.take());
                drift = Vec3::ZERO;
                continue;
            }
            let (of, roles) = (heavier(&pair[1]), &takes[0].roles);
            let at = |frame: usize| foot(result, roles, side, frame as f64);
            let step = stillest(&at(start + k), &at(start + k + 1));
            let own = [0, 1]
                .map(|end| foot(takes[of].clip(), &takes[of].roles, side, pair[end].frames[of]));
            let own = stillest(&own[0], &own[1]).length();
            drift += step.normalize_or_zero() * (step.length() - own).max(0.0);
            farthest = Some(farthest.unwrap_or(0.0).max(drift.length()));
        }
        stances.extend(farthest);
    }
    100.0 * f64::from(stances.iter().sum::<f32>()) / stances.len().max(1) as f64
}

/// Returns both clips frame by frame, side by side.
fn in_lockstep(
    leave: usize,
    enter: usize,
    frames: usize,
    weight: impl Fn(usize) -> f64,
) -> Vec<FrameMix> {
    let mix = |p: usize| FrameMix {
        frames: vec![(leave + p) as f64, (enter + p) as f64],
        weights: vec![1.0 - weight(p), weight(p)],
    };
    (0..frames).map(mix).collect()
}

#[test]
fn registered_walks_slide_half_as_much_as_dissolved_ones() {
    let takes = takes(&["11", "13", "15", "16", "22", "33"]);
    let mut sums = [0.0; 3];
    for a in &takes {
        for b in &takes {
            if a.name == b.name {
                continue;
            }
            let registration = register(a, b);
            let warp = registration.warp();
            let ((from, _), (to, _)) = (warp.first(), warp.last());
            let (leave, arrive) = (from.ceil() as usize, to.floor() as usize);
            let join = registered_join(
                &a.source,
                &b.source,
                &registration,
                leave,
                arrive,
                WeightLaw::Smooth,
            )
            .expect("registered");
            let registered = skate_cm(&join.joined.clip, leave, &join.during, [a, b]);
            let enter = warp.at(leave as f64).round() as usize;
            let window = (arrive - leave).min(b.clip().frames() - enter - 1);
            let options = DissolveOptions { window, ..DissolveOptions::default() };
            let plain =
                dissolve(&a.source, leave, &b.source, enter, &options).expect("the window fits");
            let law = |p: usize| 1.0 - WeightLaw::Smooth.alpha((p + 1) as f64 / window as f64);
            let plain =
                skate_cm(&plain.clip, leave, &in_lockstep(leave, enter, window, law), [a, b]);
            let half = WeightCurve::constant(0.5);
            let partner = Partner { source: &b.source, registration: &registration, weight: &half };
            let blend = registered_blend(&a.source, &[partner]).expect("registered");
            let halfway = skate_cm(&blend.clip, 0, &blend.mixes, [a, b]);
            // Differences below 2 cm are not visible.
            assert!(
                plain < 2.0 || registered <= 0.5 * plain,
                "{} → {}: {registered} of {plain} cm",
                a.name,
                b.name
            );
            for (sum, skate) in sums.iter_mut().zip([registered, plain, halfway]) {
                *sum += skate;
            }
            println!(
                "{} {} | {:>3} x {:>3} | join {registered:.2} plain {plain:.2} | half {halfway:.2} | mean {:.1} cm from {:?} to {:?}",
                a.name,
                b.name,
                a.clip().frames(),
                b.clip().frames(),
                registration.path().mean_m * 100.0,
                warp.first(),
                warp.last()
            );
        }
    }
    println!(
        "mean: join, plain, half: {:?}",
        sums.map(|sum| sum / (takes.len() * (takes.len().max(1) - 1)).max(1) as f64)
    );
    assert!(sums[0] <= 0.5 * sums[1], "{sums:?}");
}
