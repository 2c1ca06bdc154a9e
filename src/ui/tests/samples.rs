//! Bundled takes and sets of clips with the pointer.

use super::*;
use segue_session::{ClipSet, Request};

/// Hands over the requested takes, as the app does, and does all work.
fn serve(harness: &mut Harness<'_, Page>) {
    harness.run();
    loop {
        let session = &mut harness.state_mut().session;
        while session.work() {}
        let requests = session.take_requests();
        let samples: Vec<_> = (requests.into_iter())
            .filter_map(
                |request| {
                    if let Request::Sample(sample) = request { Some(sample) } else { None }
                },
            )
            .collect();
        if samples.is_empty() {
            break;
        }
        for sample in samples {
            let path = format!("{}/assets/samples/{}", env!("CARGO_MANIFEST_DIR"), sample.file);
            let packed = std::fs::read(path).expect("a bundled take");
            session.load_sample(sample, &packed).expect("it can be read");
        }
    }
    harness.run();
}

#[test]
fn set_of_takes_is_loaded_by_one_click_and_undone() {
    let set = &Session::sample_sets()[0];
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    let first = set.samples[0].label;
    assert!(harness.query_by_label_contains(first).is_none(), "nobody asked for it");
    harness.get_by_label(text::SAMPLES.english()).click();
    harness.run();
    harness.get_by_label(set.label).click();
    harness.run();
    harness.get_by_label(text::LOADING_SAMPLES.english());
    picture("samples-loading", &mut harness);
    serve(&mut harness);
    assert!(harness.query_by_label(text::LOADING_SAMPLES.english()).is_none());
    for sample in set.samples {
        assert!(
            harness.query_all_by_label_contains(sample.label).next().is_some(),
            "{}",
            sample.label
        );
    }
    picture("samples-loaded", &mut harness);
    harness.get_by_label(text::UNDO.english()).click();
    harness.run();
    let last = set.samples[set.samples.len() - 1].label;
    assert!(harness.query_by_label_contains(last).is_none());
}

#[test]
fn button_of_a_set_changes_the_motion_of_every_lab() {
    let (made, captured) = (text::clip_set(ClipSet::Made).0, text::clip_set(ClipSet::Captured).0);
    for lab in ["speed", "loop", "register", "path", "graph", "match"] {
        let mut harness =
            harness(DESK, DARK, page(&format!("lab={lab}&scenario=straight&play=off")));
        assert!(
            harness.query_by_label(text::clip_set(ClipSet::Own).0.english()).is_none(),
            "{lab}: there are none"
        );
        press(captured.english(), &mut harness);
        serve(&mut harness);
        assert!(harness.state().session.uses_clip_set(ClipSet::Captured), "{lab}");
        assert_eq!(harness.state().session.panes()[0].problem, None, "{lab}");
        picture(&format!("real-{lab}"), &mut harness);
        press(made.english(), &mut harness);
        assert!(harness.state().session.uses_clip_set(ClipSet::Made), "{lab}");
    }
}

#[test]
fn own_clips_fill_graph_and_match_by_one_click() {
    for lab in ["graph", "match"] {
        let mut harness =
            harness(DESK, DARK, with_file(&format!("lab={lab}&scenario=straight&play=off")));
        let id = loaded(harness.state()).id.clone();
        press(text::clip_set(ClipSet::Own).0.english(), &mut harness);
        let session = &harness.state().session;
        let ids = if lab == "graph" {
            session.graph_clip_ids()
        } else {
            session.params().clip_ids(Key::MatchClips).to_vec()
        };
        assert_eq!(ids, [id], "{lab}");
    }
}

#[test]
fn corpus_is_asked_for_where_corpora_can_be_shown() {
    let name = text::CORPUS.english();
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    assert!(harness.query_by_label(name).is_none());
    harness.state_mut().state.shows_corpora = true;
    harness.run_steps(3);
    picture("corpus-button", &mut harness);
    harness.get_by_label(name).click();
    harness.run_steps(3);
    assert_eq!(harness.state().out.actions, [out::Action::ChooseCorpus]);
}
