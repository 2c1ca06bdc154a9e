//! From two clips to a transition and its numbers, as a person would: all pairs of made motions.

use segue_motion::blend::{DissolveOptions, RootBlend, dissolve};
use segue_motion::clip::{ContactOptions, Contacts, Motion};
use segue_motion::metrics::{Profile, Subject, TransitionMetrics};
use segue_motion::registration::{SearchOptions, best_transition, limb_weights};
use segue_motion::skeleton::Roles;
use segue_motion::synth::{Params, presets, synthesize};
use std::sync::Arc;

const WINDOW: usize = 24;

fn profiles() -> Vec<(&'static str, Profile)> {
    let made = presets().into_iter().map(|preset| {
        let clip =
            synthesize(&Params { fps: 60.0, ..preset.params }).expect("a preset can be made").clip;
        let roles = Roles::detect(clip.skeleton());
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        (preset.id, Profile::new(Arc::new(Motion::with_roles(clip, &roles)), &roles, contacts))
    });
    made.collect()
}

#[test]
fn every_pair_of_made_motions_has_a_clean_transition() {
    let profiles = profiles();
    let mut counted = 0;
    for (a_name, a) in &profiles {
        for (b_name, b) in &profiles {
            let (from, to) = (a.source().clip(), b.source().clip());
            let roles = Roles::detect(from.skeleton());
            let height = f64::from(roles.body_height(from.skeleton()));
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
                let out = dissolve(a.source(), found.leave, b.source(), found.enter, &options)
                    .expect("windows fit");
                let (start, end) = (out.transition.start, out.transition.end);
                let subject = Subject {
                    result: &out.clip,
                    start,
                    end,
                    handover: out.handover,
                    enter: found.enter,
                    a,
                    b,
                    roles: &roles,
                    ground_m: 0.0,
                };
                TransitionMetrics::measure(&subject)
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
                    let show: Vec<String> = m
                        .list()
                        .iter()
                        .map(|m| format!("{} {:.2}", m.id, m.value.unwrap_or(f64::NAN)))
                        .collect();
                    println!("    {what:>9}: {}", show.join("  "));
                }
            }
            let pair = format!("{a_name} → {b_name}: {good:?}");
            assert!(
                found.rms_cm.is_finite()
                    && good.list().iter().all(|m| m.value.is_none_or(f64::is_finite)),
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
