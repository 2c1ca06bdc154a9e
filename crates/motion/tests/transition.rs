//! Every transition method on every pair of synthesised motions, with its metrics.

use segue_motion::blend::{RootBlend, WeightLaw};
use segue_motion::clip::Motion;
use segue_motion::math::Decay;
use segue_motion::metrics::TransitionMetrics;
use segue_motion::registration::{PoseSearch, PoseWeights, SearchOptions, limb_weights};
use segue_motion::synth::{Params, presets, synthesize};
use segue_motion::transition::{Inertialization, Method, TransitionOptions, concatenate};

fn motions() -> Vec<(&'static str, Motion)> {
    let made = presets().into_iter().map(|preset| {
        let made =
            synthesize(&Params { fps: 60.0, ..preset.params }).expect("a preset can be made");
        (preset.id, Motion::analyze(made.clip))
    });
    made.collect()
}

const METHODS: [(&str, Method); 7] = [
    ("cut", Method::Cut),
    ("linear", Method::Dissolve { window: 24, law: WeightLaw::Linear }),
    ("smooth", Method::Dissolve { window: 24, law: WeightLaw::Smooth }),
    (
        "spring",
        Method::Inertialize(Inertialization::Offset(Decay::Spring { half_life_secs: 0.14 })),
    ),
    ("cubic", Method::Inertialize(Inertialization::Offset(Decay::Cubic { blend_secs: 0.4 }))),
    ("quintic", Method::Inertialize(Inertialization::Offset(Decay::Quintic { blend_secs: 0.4 }))),
    (
        "dead",
        Method::Inertialize(Inertialization::DeadBlend {
            blend_secs: 0.4,
            extrapolation_half_life_secs: 0.1,
        }),
    ),
];

fn values_of(metrics: &TransitionMetrics) -> [Option<f64>; 3] {
    [metrics.jump_cm, metrics.penetration_cm, metrics.lag_s]
}

#[test]
fn methods_on_all_pairs_have_comparable_metrics() {
    let motions = motions();
    for (a_name, a) in &motions {
        for (b_name, b) in &motions {
            let (from, to) = (a.clip(), b.clip());
            let height = f64::from(a.body_height());
            let weights = limb_weights(from.skeleton());
            let mut search = PoseSearch::new(
                (from, a.ground_frames()),
                (to, b.ground_frames()),
                &weights,
                height,
            )
            .expect("made clips fit");
            search.advance(usize::MAX);
            let found =
                search.best(PoseWeights::default(), &SearchOptions::new(24)).expect("windows fit");
            let numbers = METHODS.map(|(name, method)| {
                let options = TransitionOptions::new(method);
                let out =
                    concatenate(a, found.leave, b, found.enter, &options).expect("windows fit");
                let metrics = TransitionMetrics::measure(a, b, &out);
                let values = values_of(&metrics);
                assert!(
                    values.iter().flatten().all(|value| value.is_finite()),
                    "{a_name} {b_name} {name}"
                );
                if std::env::var_os("SEGUE_SHOW").is_some() {
                    println!("{a_name:>14} {b_name:<14} {name:<8} {metrics:?}");
                }
                (name, metrics)
            });
            let of = |wanted: &str| {
                numbers.iter().find(|(name, _)| *name == wanted).expect("a method of the list").1
            };
            let pair = format!("{a_name} → {b_name} at {} {}", found.leave, found.enter);
            let deg = |metrics: TransitionMetrics| metrics.seam_deg.expect("joints turn");
            for (name, metrics) in &numbers[1..] {
                // The extrapolated pose differs from its source and is faded out, which shows most
                // where there is little to bridge.
                let allowed = if *name == "dead" { 3.0 } else { 0.5 };
                assert!(deg(*metrics) <= deg(of("cut")) + allowed, "{pair} {name} {metrics:?}");
                assert!(
                    metrics.jump_cm.expect("characters move") < 1.0,
                    "{pair} {name} {metrics:?}"
                );
                assert!(
                    metrics.spin_deg.expect("characters turn") < 6.0,
                    "{pair} {name} {metrics:?}"
                );
            }
        }
    }
    assert!(motions.len() >= 3);
}

/// After the last frame of A, before the second of B, unaligned or in the world: every setting of
/// the sliders has metrics.
#[test]
fn metrics_at_the_ends_of_clips_exist() {
    let motions = motions();
    let ((_, a), (_, b)) = (&motions[0], &motions[1]);
    let (last_a, last_b) = (a.clip().frames(), b.clip().frames());
    for (leave, enter) in [(last_a, 0), (last_a, last_b - 1), (0, 0), (1, 1), (0, last_b - 1)] {
        for (name, method) in METHODS {
            if matches!(method, Method::Dissolve { .. }) {
                continue;
            }
            for (align, root) in
                [(true, RootBlend::Velocity), (true, RootBlend::World), (false, RootBlend::World)]
            {
                let options = TransitionOptions { align, root, ..TransitionOptions::new(method) };
                let out =
                    concatenate(a, leave, b, enter, &options).expect("frames are in the clips");
                assert_eq!(out.clip.frames(), leave + last_b - enter);
                let metrics = TransitionMetrics::measure(a, b, &out);
                let finite = values_of(&metrics).into_iter().flatten().all(f64::is_finite);
                assert!(finite, "{name} {leave} {enter} {metrics:?}");
            }
        }
    }
}
