//! The timeline and the transport: scrubs, steps by frames, dragged edges and what both report.

use super::*;

/// The timeline's state, and the input to it.
struct Timed {
    now: f64,
    transition: (f64, f64),
    events: Vec<TimelineEvent>,
}

fn timeline() -> Harness<'static, Timed> {
    let start = Timed { now: 1.0, transition: (4.0, 6.0), events: Vec::new() };
    bench(start, |state, ui| {
        let points: Vec<[f64; 2]> =
            (0..=100_u32).map(|i| [f64::from(i) / 10.0, f64::from(i)]).collect();
        let ink = egui::Color32::WHITE;
        let series = [Series {
            name: Word::new("result").into(),
            color: ink,
            ink,
            strong: true,
            is_source: false,
            points: &points,
            values: None,
        }];
        let view = Timeline {
            duration: 10.0,
            now: state.now,
            fps: 50.0,
            transition: Some(state.transition.0..state.transition.1),
            transition_editable: true,
            out_point: Some(9.0),
            curves: &[Curves {
                title: Word::new("speed"),
                unit: Word::new("m/s"),
                decimals: 1,
                include: None,
                series: &series,
                ..Curves::default()
            }],
            ..Timeline::default()
        };
        for event in timeline_ui(&view, ui).events {
            match event {
                TimelineEvent::Seek(time) => state.now = time,
                TimelineEvent::SetTransitionStart(time) => state.transition.0 = time,
                _ => {}
            }
            state.events.push(event);
        }
    })
}

#[test]
fn timeline_seeks_scrubs_and_steps_by_frames() {
    let mut harness = timeline();
    let area = harness.get_by_label("Timeline").rect();
    let at = |time: f32| pos2(area.left() + time / 10.0 * area.width(), area.bottom() - 4.0);
    press(&mut harness, at(3.0), true);
    assert!((harness.state().now - 3.0).abs() < 1e-3);
    move_to(&mut harness, at(7.5), Modifiers::NONE);
    assert!((harness.state().now - 7.5).abs() < 1e-3);
    move_to(&mut harness, at(40.0), Modifiers::NONE);
    assert_eq!(harness.state().now, 10.0);
    press(&mut harness, at(40.0), false);
    let events = &harness.state().events;
    assert_eq!(events.first(), Some(&TimelineEvent::ScrubStarted));
    assert_eq!(events.last(), Some(&TimelineEvent::ScrubEnded));
    assert_eq!(events.iter().filter(|event| !matches!(event, TimelineEvent::Seek(_))).count(), 2);

    // A step goes from between two frames to a whole one, then by ten.
    harness.state_mut().now = 2.013;
    harness.get_by_label("Timeline").focus();
    harness.run();
    for (key, modifiers, expected) in [
        (Key::ArrowRight, Modifiers::NONE, 2.04),
        (Key::ArrowLeft, Modifiers::NONE, 2.02),
        (Key::ArrowRight, Modifiers::SHIFT, 2.22),
        (Key::End, Modifiers::NONE, 10.0),
        (Key::ArrowRight, Modifiers::NONE, 10.0),
        (Key::Home, Modifiers::NONE, 0.0),
    ] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
        assert!((harness.state().now - expected).abs() < 1e-9, "{key:?}: {}", harness.state().now);
    }
}

#[test]
fn transition_edge_is_dragged_in_one_gesture() {
    let mut harness = timeline();
    let area = harness.get_by_label("Timeline").rect();
    let edge = harness.get_by_label("Transition start").rect();
    assert!(
        (edge.center().x - (area.left() + 0.4 * area.width())).abs() < 1.0,
        "{edge:?} in {area:?}"
    );
    press(&mut harness, edge.center(), true);
    let target = pos2(area.left() + 0.25 * area.width(), edge.center().y);
    move_to(&mut harness, target, Modifiers::NONE);
    press(&mut harness, target, false);
    harness.run();
    let state = harness.state();
    assert!((state.transition.0 - 2.5).abs() < 1e-3, "{}", state.transition.0);
    assert_eq!(state.events.first(), Some(&TimelineEvent::EditStarted));
    assert_eq!(state.events.last(), Some(&TimelineEvent::EditEnded));
    assert_eq!(state.now, 1.0, "the playhead stays");
}

#[test]
fn transport_reports_play_step_and_speed() {
    let mut harness = Harness::builder()
        .with_size(vec2(800.0, 400.0))
        .with_context_setup(|ctx| Theme::default().install(ctx))
        .build_ui_state(
            |ui, events: &mut Vec<TransportEvent>| {
                ui.add_space(300.0);
                let view = Transport {
                    playing: false,
                    repeat: true,
                    speed: 1.0,
                    now: 0.5,
                    frame: 15,
                    frames: 90,
                    caption: Word::new("speed").into(),
                };
                events.extend(transport_ui(&view, ui));
            },
            Vec::new(),
        );
    for name in ["Play", "One frame back", "Repeat", "Speed: 1×"] {
        harness.get_by_label(name).click();
        harness.run();
    }
    harness.get_by_label("0.25×").click();
    harness.run();
    let asked = [
        TransportEvent::SetPlaying(true),
        TransportEvent::Step(-1),
        TransportEvent::SetRepeat(false),
        TransportEvent::SetSpeed(0.25),
    ];
    assert_eq!(*harness.state(), asked);
}

// Fails when the numbers of a playing motion push what stands behind them.
#[test]
fn place_of_the_position_is_that_of_every_frame() {
    let mut harness = Harness::builder()
        .with_size(vec2(800.0, 400.0))
        .with_context_setup(|ctx| Theme::default().install(ctx))
        .build_ui_state(
            |ui, frame: &mut usize| {
                let view = Transport {
                    playing: true,
                    repeat: true,
                    speed: 1.0,
                    now: 0.5,
                    frame: *frame,
                    frames: 2090,
                    caption: Word::new("speed").into(),
                };
                transport_ui(&view, ui);
            },
            0,
        );
    let places = [0, 9, 10, 99, 100, 1000, 2089].map(|frame| {
        *harness.state_mut() = frame;
        harness.run();
        harness.get_by_label(&format!("0.50 s, frame {frame} / 2090")).rect()
    });
    assert_eq!(places, [places[0]; 7]);
}

#[test]
fn many_moments_are_one_element_that_names_the_nearest() {
    let of = |count: usize| {
        bench((), move |(), ui| {
            let moment = |at: usize| Moment {
                time: 9.0 * at as f64 / count as f64,
                color: egui::Color32::WHITE,
                name: Word::new("fault"),
            };
            let moments: Vec<Moment> = (0..count).map(moment).collect();
            let view = Timeline { duration: 10.0, moments: &moments, ..Timeline::default() };
            timeline_ui(&view, ui);
        })
    };
    let few = of(3);
    assert!(few.query_by_label("fault, 3.00 s").is_some());
    assert!(few.query_by_label("fault, 3 times").is_none());
    let mut many = of(90);
    assert!(many.query_by_label("fault, 3.00 s").is_none());
    let row = many.get_by_label("fault, 90 times").rect();
    // Beyond the last moment there is no name.
    for (secs, is_named) in [(3.01, true), (9.8, false)] {
        let at = pos2(row.left() + secs / 10.0 * row.width(), row.center().y);
        move_to(&mut many, at, Modifiers::NONE);
        for _ in 0..60 {
            many.step();
        }
        let shown = many.query_by_label_contains("fault, 3.00 s").is_some();
        assert_eq!(shown, is_named, "{secs}");
    }
}
