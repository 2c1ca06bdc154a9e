//! The foot lock in transitions: on captured motion if this machine has it, and on synthesised
//! motion everywhere.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use common::captured;
use segue_motion::blend::Concatenation;
use segue_motion::clip::{Clip, Contacts, Motion};
use segue_motion::math::{Decay, quat};
use segue_motion::metrics::TransitionMetrics;
use segue_motion::registration::{PoseSearch, PoseWeights, SearchOptions, limb_weights};
use segue_motion::skeleton::{Role, Roles, Side};
use segue_motion::synth::{Action, Params, synthesize};
use segue_motion::transition::{
    FootLockOptions, Inertialization, Method, TransitionOptions, concatenate, foot_lock,
};
use std::sync::Arc;

struct Take {
    name: String,
    motion: Motion,
}

impl Take {
    fn new(name: &str, clip: Clip) -> Self {
        Self { name: name.to_owned(), motion: Motion::analyze(clip) }
    }

    fn clip(&self) -> &Arc<Clip> {
        self.motion.clip()
    }
}

/// Returns takes of subject 16 of the CMU database; empty if the data is missing.
fn takes(wanted: &[&'static str]) -> Vec<Take> {
    captured(wanted).into_iter().map(|(name, clip)| Take::new(name, clip)).collect()
}

fn joined(a: &Take, b: &Take) -> Concatenation {
    let weights = limb_weights(a.clip().skeleton());
    let height = f64::from(a.motion.body_height());
    let (from, to) = (&a.motion, &b.motion);
    let mut search = PoseSearch::new(
        (from.clip(), from.ground_frames()),
        (to.clip(), to.ground_frames()),
        &weights,
        height,
    )
    .expect("one rig");
    search.advance(usize::MAX);
    let found = search.best(PoseWeights::default(), &SearchOptions::new(40)).expect("windows fit");
    let spring = Inertialization::Offset(Decay::Spring { half_life_secs: 0.15 });
    let options = TransitionOptions::new(Method::Inertialize(spring));
    concatenate(from, found.leave, to, found.enter, &options).expect("frames are there")
}

/// Returns the largest angular velocity of a knee, degrees per second.
fn fastest_knee(clip: &Clip, roles: &Roles) -> f32 {
    let knees = Side::BOTH.map(|side| roles.get(Role::shin(side)).expect("legs have knees"));
    let step = |frame: usize, knee: usize| {
        quat::angle_between(clip.rotations(frame - 1)[knee], clip.rotations(frame)[knee])
    };
    let steps = (1..clip.frames()).flat_map(|frame| knees.map(|knee| step(frame, knee)));
    steps.fold(0.0, f32::max).to_degrees() * clip.fps() as f32
}

/// Returns foot skating before and after, centimetres, and the fastest knee before and after,
/// degrees per second.
fn locked(a: &Take, b: &Take) -> ([f64; 2], [f32; 2]) {
    let out = joined(a, b);
    let contacts = Contacts::joined(
        a.motion.contacts(),
        b.motion.contacts(),
        out.transition.start,
        out.enter,
        out.handover,
    );
    let clip = foot_lock(&out.clip, a.motion.roles(), &contacts, &FootLockOptions::default())
        .expect("there are legs");
    let locked = Concatenation { clip: Arc::new(clip), ..out.clone() };
    let made = [&out, &locked];
    let skate = made
        .map(|made| TransitionMetrics::measure(&a.motion, &b.motion, made).skate_cm.unwrap_or(0.0));
    let knees = made.map(|made| fastest_knee(&made.clip, a.motion.roles()));
    eprintln!(
        "{} → {} at {} {}: skate {:.2} → {:.3} cm, knee {:.0} → {:.0} °/s",
        a.name, b.name, out.transition.start, out.enter, skate[0], skate[1], knees[0], knees[1]
    );
    (skate, knees)
}

#[test]
fn walk_to_run_with_the_foot_lock_loses_nine_tenths_of_its_skating() {
    for pair in takes(&["15", "35"]).chunks_exact(2) {
        let (skate, knees) = locked(&pair[0], &pair[1]);
        assert!(skate[0] > 0.5 && skate[1] <= 0.1 * skate[0], "{skate:?}");
        assert!(knees[1] <= 1.5 * knees[0], "{knees:?}");
    }
}

#[test]
fn synthesised_walks_and_runs_with_the_foot_lock_lose_their_skating() {
    let [walk, run] = [Action::Walk, Action::Run].map(|action| {
        let made = synthesize(&Params::new(action)).expect("defaults can be made");
        Take::new(made.clip.name(), made.clip.clone())
    });
    for (a, b) in [(&walk, &run), (&run, &walk)] {
        let (skate, knees) = locked(a, b);
        assert!(skate[1] <= 0.1 * skate[0], "{skate:?}");
        assert!(knees[1] <= 1.5 * knees[0], "{knees:?}");
    }
}

/// With automatic frames, for any pair, the feet of most transitions stand, and hardly any knee
/// moves faster.
#[test]
fn captured_pairs_with_the_foot_lock_stand_still() {
    let takes = takes(&["05", "11", "15", "17", "22", "35", "43", "55"]);
    let (mut skates, mut hurried) = (vec![], 0);
    for a in &takes {
        for b in &takes {
            let (skate, knees) = locked(a, b);
            skates.push(skate[1]);
            hurried += usize::from(knees[1] > 1.5 * knees[0]);
        }
    }
    if !skates.is_empty() {
        skates.sort_by(f64::total_cmp);
        let median = skates[skates.len() / 2];
        println!("median {median:.3} cm, {hurried} of {} with a hurried knee", skates.len());
        assert!(median < 1.0 && hurried * 20 < skates.len(), "{median} {hurried}");
    }
}
