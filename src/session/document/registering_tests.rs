//! The Register lab, by commands.

use super::*;
use crate::skeleton::Side;

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    session
}

fn number_of(outcome: &Outcome, id: &str) -> f64 {
    let metric = outcome.metrics.iter().find(|metric| metric.id == id);
    metric.and_then(|metric| metric.value).unwrap_or(f64::NAN)
}

#[test]
fn probe() {
    for link in [
        "lab=register",
        "lab=register&warp_with=plain",
        "lab=register&warp_mode=join",
        "lab=register&warp_mode=join&warp_with=plain",
        "lab=register&warp_weight=0",
        "lab=register&warp_weight=1",
        "lab=register&ends=corner",
        "lab=register&a=walk&b=walk_left",
        "lab=register&a=walk&b=walk(gait_speed:2)",
        "lab=register&a=walk&b=walk(gait_speed:2)&warp_with=plain",
    ] {
        let session = opened(link);
        let pane = &session.panes()[0];
        println!("{link}: {:?}", pane.problem);
        let Some(outcome) = &pane.outcome else { continue };
        let r = outcome.registered.as_ref().unwrap();
        println!(
            "  {} frames, warp {:?} {:?}, map {}x{}",
            outcome.motion.clip.frames(),
            r.registration.warp().first(),
            r.registration.warp().last(),
            r.map.matrix().rows(),
            r.map.matrix().columns()
        );
        for m in &outcome.metrics {
            print!("  {} {:?}", m.id, m.value);
        }
        println!();
        for of in [Some(Slot::A), Some(Slot::B), None] {
            println!(
                "   {:?}",
                r.stances(of, Side::BOTH[0])
                    .iter()
                    .map(|s| format!("{:.2}-{:.2}", s.start, s.end))
                    .collect::<Vec<_>>()
            );
        }
    }
}
