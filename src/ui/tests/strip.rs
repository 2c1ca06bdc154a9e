//! The numbers below the stage.

use super::*;
use eframe::egui::pos2;
use segue_session::metrics::MetricId;
use std::collections::BTreeSet;

const PROJECTOR: Vec2 = vec2(1280.0, 720.0);
const FOUR_TO_THREE: Vec2 = vec2(1024.0, 768.0);
const THREE: &str = "lab=blend&compare=blend_window:30,15,10&play=off&t=2.9";

/// Returns the places of the buttons of a number, pane by pane.
fn places(name: &str, harness: &Harness<'_, Page>) -> Vec<Rect> {
    let begins_with = |label: &str, name: &str| {
        label.strip_prefix(name).is_some_and(|rest| rest.starts_with(' '))
    };
    // Another number may have a longer name with the same beginning, and the sign of the help of a
    // lab has a name like `Speed lab: help`.
    let is_it = |label: &str| {
        let rows = segue_session::metrics::METRICS.iter();
        let named = rows.map(|row| row.label).filter(|name| begins_with(label, name));
        named.max_by_key(|name| name.len()) == Some(name) && !label.contains(':')
    };
    let found = harness.get_all_by_role(Role::Button);
    let found = found.filter(|node| node.accesskit_node().label().is_some_and(|it| is_it(&it)));
    found.map(|node| node.rect()).collect()
}

/// Returns the numbers that the strip shows in the first pane, by their places.
fn shown(harness: &Harness<'_, Page>) -> Vec<(&'static str, Rect)> {
    let labels: BTreeSet<&str> =
        segue_session::metrics::METRICS.iter().map(|row| row.label).collect();
    let place = |label| Some((label, *places(label, harness).first()?));
    labels.into_iter().filter_map(place).collect()
}

fn click(at: egui::Pos2, harness: &mut Harness<'_, Page>) {
    step(vec![egui::Event::PointerMoved(at), button(at, true)], harness);
    step(vec![button(at, false)], harness);
    harness.run();
}

#[test]
fn numbers_of_every_pane_have_the_same_places_below_it() {
    for (name, size, theme) in [
        ("desk-dark", DESK, DARK),
        ("desk-light", DESK, LIGHT),
        ("projector", PROJECTOR, HALL),
        ("four-to-three", FOUR_TO_THREE, LIGHT),
    ] {
        for (lab, link) in [
            ("blend", THREE),
            ("loop", "lab=loop&compare=loop_method:exact,end,both&play=off"),
            ("register", "lab=register&compare=warp_with:registered,plain&play=off"),
            ("path", "lab=path&a=walk_left&compare=control_points:8,20&play=off"),
        ] {
            let mut harness = harness(size, theme, page(link));
            picture(&format!("strip-{lab}-{name}"), &mut harness);
            let panes = harness.state().session.panes().len();
            let stage = harness.state().stage;
            let width = stage.width() / panes as f32;
            let mut seen = 0;
            for (label, _) in shown(&harness) {
                let places = places(label, &harness);
                assert_eq!(places.len(), panes, "{name}, {lab}: {label}");
                for (index, place) in places.iter().enumerate() {
                    let left = stage.left() + (width * index as f32).round();
                    let offset = place.left() - left - (places[0].left() - stage.left());
                    assert!(
                        offset.abs() < 1.0 && place.top() == places[0].top(),
                        "{name}, {lab}: {label}: {places:?}"
                    );
                    assert!(
                        place.top() >= stage.bottom() && place.right() <= left + width + 0.5,
                        "{name}, {lab}: {label} at {place:?}, the stage is {stage:?}"
                    );
                }
                seen += 1;
            }
            assert!(seen >= 2, "{name}, {lab}: {seen}");
        }
    }
}

#[test]
fn numbers_do_not_cover_each_other_at_any_size() {
    for (name, size, theme) in [
        ("desk", DESK, DARK),
        ("projector", PROJECTOR, HALL),
        ("four-to-three", FOUR_TO_THREE, LIGHT),
        ("phone-dark", PHONE, DARK),
        ("phone-light", PHONE, LIGHT),
    ] {
        let lab = |lab: &str| (lab.to_owned(), format!("lab={lab}&play=off&t=1"));
        let labs = ["view", "blend", "speed", "loop", "layers", "register", "path", "match"];
        let three = [("compared".to_owned(), THREE.to_owned())];
        for (lab, link) in labs.map(lab).into_iter().chain(three) {
            let link = link.replace("lab=match", "lab=match&scenario=left");
            let mut harness = harness(size, theme, page(&link));
            picture(&format!("strip-one-{lab}-{name}"), &mut harness);
            for is_open in [false, true] {
                if is_open {
                    let Some(more) = harness.query_by_label(text::ALL_NUMBERS.english()) else {
                        continue;
                    };
                    more.click();
                    harness.run();
                    picture(&format!("strip-all-{lab}-{name}"), &mut harness);
                    let outcome = outcome(harness.state());
                    let all = outcome.metrics.len();
                    assert_eq!(shown(&harness).len(), all, "{lab}, {name}");
                }
                let stage = harness.state().stage;
                assert!(stage.height() > 120.0, "{lab}, {name}: {stage:?}");
                let numbers = shown(&harness);
                assert!(numbers.len() >= 2, "{lab}, {name}: {numbers:?}");
                for (index, (label, place)) in numbers.iter().enumerate() {
                    assert!(
                        place.top() >= stage.bottom() && place.right() <= stage.right(),
                        "{lab}, {name}: {label} at {place:?}"
                    );
                    for (other, its) in &numbers[index + 1..] {
                        let both = place.shrink(0.5).intersect(its.shrink(0.5));
                        assert!(!both.is_positive(), "{lab}, {name}: {label} and {other}");
                    }
                    if size == PHONE {
                        assert!(place.height() >= 44.0, "{lab}: {label} at {place:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn height_of_the_strip_stays_while_playing_and_dragging() {
    for link in [
        "lab=blend&compare=blend_window:30,15,10",
        "lab=loop&loop_from=0.3&loop_to=1.4",
        "lab=speed",
    ] {
        let mut harness = harness(DESK, DARK, page(link));
        let bottom = |harness: &Harness<'_, Page>| harness.state().stage.bottom();
        let before = bottom(&harness);
        for _ in 0..30 {
            harness.state_mut().session.tick(1.0 / 30.0);
            harness.step();
            assert_eq!(bottom(&harness), before, "{link}, playing");
        }
        let sliders = harness.get_all_by_role(Role::Slider);
        let slider = sliders.map(|node| node.rect()).find(|rect| rect.left() > 1100.0);
        let slider = slider.expect("a slider of the lab");
        let from = pos2(slider.left() + 4.0, slider.bottom() - 6.0);
        step(vec![egui::Event::PointerMoved(from), button(from, true)], &mut harness);
        for part in 1..=12 {
            let to = from + vec2(part as f32 / 12.0 * (slider.width() - 8.0), 0.0);
            step(vec![egui::Event::PointerMoved(to)], &mut harness);
            while harness.state_mut().session.work() {}
            harness.step();
            assert_eq!(bottom(&harness), before, "{link}, dragged to {part}");
        }
    }
}

#[test]
fn press_on_a_number_explains_it_and_shows_its_frame() {
    for by_keyboard in [false, true] {
        let link = "lab=transition&method=cut&leave_a=2&enter_b=0.4";
        let mut harness = harness(DESK, DARK, page(link));
        let metric = outcome(harness.state()).metric(MetricId::VelocityJump).unwrap();
        let (row, secs) = (metric.id.row(), metric.at_secs.expect("a place"));
        let activate = |name: &str, harness: &mut Harness<'_, Page>| {
            if !by_keyboard {
                return click(places(name, harness)[0].center(), harness);
            }
            let starts = |label: String| label.starts_with(name);
            harness
                .get_all_by_role(Role::Button)
                .find(|node| node.accesskit_node().label().is_some_and(starts))
                .expect("a number")
                .focus();
            harness.run_steps(2);
            harness.key_press(Keyboard::Enter);
            harness.run_steps(4);
        };
        assert!(harness.query_by_label(row.good).is_none());
        activate(row.label, &mut harness);
        for text in [row.help, row.good, row.label] {
            assert!(harness.query_all_by_label(text).count() > 0, "{text}");
        }
        picture("strip-explained", &mut harness);
        assert!(harness.state().session.params().is_on(Key::Play));
        harness.get_by_label(text::SHOW_FRAME.english()).click();
        harness.run_steps(3);
        let session = &harness.state().session;
        assert!(!session.params().is_on(Key::Play), "it stands at the frame");
        assert!((session.now_secs() - secs).abs() < 2e-3, "{} {secs}", session.now_secs());
        assert!(harness.query_by_label(row.good).is_none(), "the explanation is closed");
        // A mean happens in no frame.
        let mean = MetricId::Skating.row();
        activate(mean.label, &mut harness);
        harness.get_by_label(mean.good);
        assert!(harness.query_by_label(text::SHOW_FRAME.english()).is_none());
        harness.key_press(Keyboard::Escape);
        harness.run_steps(3);
        assert!(harness.query_by_label(mean.good).is_none());
        let focused = harness.get_all_by_role(Role::Button);
        let mut focused = focused.filter(|node| node.accesskit_node().is_focused());
        let label = focused.next().and_then(|node| node.accesskit_node().label());
        assert!(label.is_some_and(|label| label.starts_with(mean.label)), "keys go on there");
    }
}

/// A number that one pane has and another has not keeps its place, with a dash.
#[test]
fn number_that_a_pane_lacks_has_a_dash_in_its_place() {
    let link = "lab=blend&compare=b:walk,run&play=off";
    let mut harness = harness(DESK, DARK, page(link));
    if let Some(more) = harness.query_by_label(text::ALL_NUMBERS.english()) {
        more.click();
        harness.run();
    }
    let row = MetricId::Lag.row();
    let nodes = harness.get_all_by_role(Role::Button);
    let labels: Vec<String> = nodes
        .filter_map(|node| node.accesskit_node().label())
        .filter(|label| label.starts_with(row.label))
        .collect();
    assert_eq!(labels.len(), 2, "{labels:?}");
    // A walk that becomes the same walk changes no velocity.
    assert!(labels[0].contains('–') && !labels[1].contains('–'), "{labels:?}");
}

/// The reason why there is no result is said once, and covers no figure.
#[test]
fn refusal_is_said_once_in_the_place_of_the_numbers() {
    for (name, size, theme) in
        [("desk", DESK, DARK), ("projector", PROJECTOR, HALL), ("phone", PHONE, LIGHT)]
    {
        for link in [
            "lab=path&a=idle",
            "lab=speed&a=idle",
            "lab=register&pins=100-90,120-80",
            "lab=in_place&a=nothing",
            "lab=graph&clips=walk&segment_size=1&graph_method=segments",
        ] {
            let mut harness = harness(size, theme, page(&format!("{link}&play=off")));
            let Some(problem) = harness.state().session.panes()[0].problem.clone() else {
                assert!(link.contains("graph"), "{link} has a result");
                continue;
            };
            let stands = !harness.state().session.panes()[0].sources.is_empty();
            let sentence = segue_text::ToMessage::to_sentence(&problem).to_string();
            let lab = link[4..].split('&').next().unwrap();
            picture(&format!("refused-{lab}-{name}"), &mut harness);
            let said: Vec<Rect> =
                harness.get_all_by_label(&sentence).map(|node| node.rect()).collect();
            assert_eq!(said.len(), 1, "{name}, {link}: {said:?}");
            let stage = harness.state().stage;
            assert_eq!(said[0].top() >= stage.bottom(), stands, "{name}, {link}: {said:?}");
            assert!(said[0].bottom() <= size.y, "{name}, {link}: {said:?}");
        }
    }
}

/// The place of the feet on a stage whose camera has not moved, as a share of its height.
const FEET: f32 = 0.76;

#[test]
fn hint_stands_below_the_feet_and_leaves_for_good() {
    let hint = |harness: &Harness<'_, Page>| {
        let words = labs::welcome(&harness.state().session).unwrap_or_default();
        harness.query_by_label(words.english()).map(|node| node.rect())
    };
    for (name, size, theme) in [
        ("desk", DESK, DARK),
        ("projector", PROJECTOR, HALL),
        ("four-to-three", FOUR_TO_THREE, LIGHT),
    ] {
        for link in [THREE, "lesson=blend_window", "lab=blend&play=off"] {
            let mut harness = harness(size, theme, page(link));
            let Some(place) = hint(&harness) else { continue };
            picture(&format!("hint-{name}-{}", &link[..6].replace('=', "-")), &mut harness);
            let stage = harness.state().stage;
            let titles = harness.get_all_by_role(Role::Heading).map(|node| node.rect());
            let buttons = harness.get_all_by_role(Role::Button).map(|node| node.rect());
            for other in titles.chain(buttons) {
                assert!(!place.intersects(other), "{name}, {link}: {place:?} over {other:?}");
            }
            assert!(place.bottom() <= stage.bottom(), "{name}, {link}: {place:?} in {stage:?}");
            let feet = stage.top() + FEET * stage.height();
            assert!(place.top() > feet, "{name}, {link}: {place:?} over feet at {feet}");
            // Looking around, and a press elsewhere, leave it.
            let menu = harness.get_by_label(text::HELP.english()).rect().center();
            click(menu, &mut harness);
            harness.key_press(Keyboard::Tab);
            harness.run_steps(2);
            harness.state_mut().state.help_open = false;
            harness.run_steps(2);
            assert!(hint(&harness).is_some(), "{name}, {link}");
            let on_stage = pos2(stage.center().x, stage.bottom() - 20.0);
            step(vec![egui::Event::PointerMoved(on_stage), button(on_stage, true)], &mut harness);
            step(vec![button(on_stage, false)], &mut harness);
            harness.run_steps(2);
            assert!(hint(&harness).is_none(), "{name}, {link}");
            for lab in ["loop", "blend"] {
                let set = vec![(Key::Lab, Value::Choice(lab))];
                harness.state_mut().session.apply(Command::Set(set)).unwrap();
                harness.run_steps(2);
            }
            assert!(hint(&harness).is_none(), "{name}, {link}: it does not return");
        }
    }
    // A change of a parameter is enough.
    let mut harness = harness(DESK, DARK, page(THREE));
    assert!(hint(&harness).is_some());
    harness.get_by_label("Blend window · 2").focus();
    harness.step();
    harness.key_press(Keyboard::ArrowRight);
    harness.run_steps(3);
    assert!(hint(&harness).is_none());
}

#[test]
fn number_that_names_its_unit_has_no_second_one() {
    let harness = harness(DESK, DARK, page("lab=edit&a=walk&play=off"));
    harness.get_by_label("Frames 192");
}
