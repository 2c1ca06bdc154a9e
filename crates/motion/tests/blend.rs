//! Transitions between all pairs of synthesised motions, with their metrics, by the public
//! interface.

use segue_motion::blend::{DissolveOptions, RootBlend, dissolve};
use segue_motion::clip::Motion;
use segue_motion::metrics::TransitionMetrics;
use segue_motion::registration::{SearchOptions, best_transition, limb_weights};
use segue_motion::synth::{Params, presets, synthesize};

const WINDOW: usize = 24;

fn motions() -> Vec<(&'static str, Motion)> {
    let made = presets().into_iter().map(|preset| {
        let made =
            synthesize(&Params { fps: 60.0, ..preset.params }).expect("a preset can be made");
        (preset.id, Motion::analyze(made.clip))
    });
    made.collect()
}

#[test]
fn transitions_of_all_synthesised_pairs_are_clean() {
    let motions = motions();
    let mut counted = 0;
    for (a_name, a) in &motions {
        for (b_name, b) in &motions {
            let (from, to) = (a.clip(), b.clip());
            let height = f64::from(a.body_height());
            let found = best_transition(
                from,
                to,
                &limb_weights(from.skeleton()),
                height,
                &SearchOptions::new(WINDOW),
            )
            .expect("windows fit");
            let measured = |window: usize, root: RootBlend, align: bool| {
                let options = DissolveOptions { window, root, align, ..DissolveOptions::default() };
                let out = dissolve(a, found.leave, b, found.enter, &options).expect("windows fit");
                TransitionMetrics::measure(a, b, &out)
            };
            let good = measured(WINDOW, RootBlend::Velocity, true);
            let cut = measured(0, RootBlend::Velocity, true);
            if std::env::var_os("SEGUE_SHOW").is_some() {
                println!(
                    "{a_name:>14} {b_name:<14} {:5.1} cm at {} {}",
                    found.rms_cm, found.leave, found.enter
                );
                for (what, m) in [
                    ("velocity", good),
                    ("world", measured(WINDOW, RootBlend::World, true)),
                    ("cut", cut),
                ] {
                    println!("    {what:>9}: {m:?}");
                }
            }
            let pair = format!("{a_name} → {b_name}: {good:?}");
            assert!(
                found.rms_cm.is_finite()
                    && [good.jump_cm, good.penetration_cm, good.lag_s]
                        .into_iter()
                        .flatten()
                        .all(f64::is_finite),
                "{pair}"
            );
            assert!(
                good.seam_deg.unwrap_or(f64::NAN) <= cut.seam_deg.unwrap_or(0.0) + 0.5,
                "{pair} {cut:?}"
            );
            assert!(
                good.spin_deg.unwrap_or(f64::NAN) < 5.0 && good.jump_cm.unwrap_or(f64::NAN) < 1.0,
                "{pair}"
            );
            counted += 1;
        }
    }
    assert!(counted >= 9);
}
