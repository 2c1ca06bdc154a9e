//! The page on every screen: projector, 4:3, phone with fingers, and the presenter mode.

use super::*;
use eframe::egui::{Event, Modifiers, TouchDeviceId, TouchId, TouchPhase, pos2};
use segue_session::PlaybackCommand;
use std::collections::BTreeMap;

const HALL_SIZE: Vec2 = vec2(1280.0, 720.0);
const CLASSIC: Vec2 = vec2(1024.0, 768.0);
const FINGERS: Theme = Theme { touch: true, ..DARK };

/// Returns the names of all labs in links.
fn labs() -> impl Iterator<Item = &'static str> {
    LabId::ALL.iter().map(|lab| lab.word())
}

/// Returns the comparison that needs the most room on the timeline of a lab.
fn fullest(lab: &str) -> &'static str {
    match lab {
        "register" => "&compare=warp_with:registered,plain",
        "blend" => "&compare=blend_window:30,15,10",
        "transition" => "&compare=half_life:0.4,0.2,0.1",
        "loop" => "&compare=loop_method:exact,linear",
        _ => "",
    }
}

#[test]
fn timeline_of_every_lab_is_whole_on_every_screen() {
    for (screen, size, theme) in
        [("projector", HALL_SIZE, HALL), ("classic", CLASSIC, LIGHT), ("desk", DESK, DARK)]
    {
        for lab in labs() {
            let link = format!("lab={lab}&play=off&t=1{}", fullest(lab));
            let mut harness = harness(size, theme, page(&link));
            picture(&format!("screen-{screen}-{lab}"), &mut harness);
            let region = harness.get_by_role_and_label(Role::Region, text::TIMELINE.english());
            let top = harness.state().stage.bottom();
            for child in region.children_recursive() {
                let node = child.accesskit_node();
                if let Some(at) = node.bounding_box().filter(|_| !node.is_hidden()) {
                    let inside = at.y0 >= f64::from(top) - 1.0 && at.y1 <= f64::from(size.y) + 1.0;
                    assert!(inside, "{screen} {lab}: {:?} at {at:?} below {top}", node.label());
                }
            }
        }
    }
}

/// Returns the places of all that is on the page and says the same at any time, by role and label.
fn places_at_rest(harness: &Harness<'_, Page>) -> BTreeMap<String, [i64; 4]> {
    let all = harness.root().children_recursive();
    let place = |node: egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        let (at, label) = (node.bounding_box()?, node.label()?);
        let place = [at.x0, at.y0, at.x1, at.y1].map(|edge| edge.round() as i64);
        Some((format!("{:?} {label}", node.role()), place))
    };
    all.filter_map(place).collect()
}

#[test]
fn nothing_on_the_page_moves_while_time_passes() {
    for (size, theme) in
        [(DESK, DARK), (vec2(1280.0, 800.0), DARK), (HALL_SIZE, HALL), (PHONE, FINGERS)]
    {
        for lab in labs() {
            let link = format!("lab={lab}&play=off&t=0{}", fullest(lab));
            let mut harness = harness(size, theme, page(&link));
            let before = places_at_rest(&harness);
            let duration = harness.state().session.duration_secs();
            for share in 1..20 {
                let seek = PlaybackCommand::Seek(duration * f64::from(share) / 20.0);
                harness.state_mut().session.apply(Command::Playback(seek)).unwrap();
                harness.run();
                for (what, place) in places_at_rest(&harness) {
                    let stays = before.get(&what).is_none_or(|before| *before == place);
                    assert!(stays, "{lab} at {size}: {what} from {:?} to {place:?}", before[&what]);
                }
            }
        }
    }
}

/// With `SEGUE_GALLERY`, writes the pictures by which a change of the whole page is judged.
#[test]
fn every_lab_is_drawn_on_every_screen_in_every_theme_and_language() {
    if std::env::var_os("SEGUE_GALLERY").is_none() {
        return;
    }
    let pack = super::chinese::pack();
    for (screen, size, theme) in [
        ("desk", DESK, DARK),
        ("hall", HALL_SIZE, HALL),
        ("classic", CLASSIC, DARK),
        ("phone", PHONE, FINGERS),
    ] {
        for (dark, name) in [(true, "dark"), (false, "light")] {
            let theme = Theme { dark, ..theme };
            for lab in labs() {
                let link = format!("lab={lab}&play=off&t=1{}", fullest(lab));
                picture(
                    &format!("{screen}-{name}-en-{lab}"),
                    &mut harness(size, theme, page(&link)),
                );
                let mut chinese = super::chinese::chinese(size, theme, &link, &pack);
                picture(&format!("{screen}-{name}-zh-{lab}"), &mut chinese);
            }
        }
    }
}

#[test]
fn phone_shows_every_lab() {
    for lab in labs() {
        let link = format!("lab={lab}&play=off&t=1{}", fullest(lab));
        let mut harness = harness(PHONE, FINGERS, page(&link));
        picture(&format!("screen-phone-{lab}"), &mut harness);
    }
}

#[test]
fn targets_for_fingers_are_as_large_as_a_fingertip() {
    let mut harness = harness(PHONE, FINGERS, page("lab=blend&play=off"));
    let mut small = Vec::new();
    let mut check = |harness: &Harness<'_, Page>| {
        for role in [Role::Button, Role::RadioButton, Role::Slider, Role::Switch, Role::MenuItem] {
            for node in harness.query_all_by_role(role) {
                let (name, rect) = (node.accesskit_node().label(), node.rect());
                let name = name.unwrap_or_default();
                // Typing a value is the slider's second way, and a handle of the timeline is
                // dragged along its whole height.
                let is_second_way = name.contains("Click to type") || name.contains("auto");
                if rect.height() < 43.5 && !is_second_way {
                    small.push(format!("{role:?} {name} {rect:?}"));
                }
            }
        }
    };
    check(&harness);
    harness.get_by_label(text::MENU.english()).click();
    harness.run();
    check(&harness);
    picture("phone-menu", &mut harness);
    assert!(small.is_empty(), "{small:#?}");
}

/// Returns the events of a finger: it comes, moves, or goes.
fn finger(phase: TouchPhase, pos: egui::Pos2) -> Vec<Event> {
    let (device_id, id) = (TouchDeviceId(0), TouchId(0));
    let touch = Event::Touch { device_id, id, phase, pos, force: None };
    let pointer = match phase {
        TouchPhase::Start => vec![Event::PointerMoved(pos), button(pos, true)],
        TouchPhase::Move => vec![Event::PointerMoved(pos)],
        TouchPhase::End | TouchPhase::Cancel => vec![button(pos, false), Event::PointerGone],
    };
    [vec![touch], pointer].concat()
}

/// Moves a finger over the page in some frames.
fn swipe(from: egui::Pos2, way: Vec2, frames: usize, harness: &mut Harness<'_, Page>) {
    step(finger(TouchPhase::Start, from), harness);
    for frame in 1..=frames {
        let at = from + way * (frame as f32 / frames as f32);
        step(finger(TouchPhase::Move, at), harness);
    }
    step(finger(TouchPhase::End, from + way), harness);
    // Kinetic scrolling continues for a while.
    harness.run_steps(120);
}

/// Returns a page of a phone whose frames are as short as those of a phone.
fn phone(link: &str) -> Harness<'static, Page> {
    stepped_harness(PHONE, FINGERS, 1.0 / 60.0, page(link))
}

#[test]
fn swipe_over_the_stage_shows_the_next_pane_and_its_name() {
    let mut harness = phone("compare=blend_window:30,15,10&play=off");
    let yaw = |harness: &Harness<'_, Page>| harness.state().session.params().number(Key::CameraYaw);
    let before = yaw(&harness);
    harness.get_by_label("30 frames · 1 / 3");
    let middle = harness.state().stage.center();
    swipe(middle, vec2(-120.0, 6.0), 5, &mut harness);
    harness.get_by_label("15 frames · 2 / 3");
    assert_eq!(yaw(&harness), before, "a swipe does not turn the camera");
    picture("phone-swiped", &mut harness);
    swipe(middle, vec2(120.0, 0.0), 5, &mut harness);
    harness.get_by_label("30 frames · 1 / 3");
    // A slow finger turns the camera.
    swipe(middle, vec2(-120.0, 0.0), 60, &mut harness);
    harness.get_by_label("30 frames · 1 / 3");
    assert!((yaw(&harness) - before).abs() > 5.0, "{} {before}", yaw(&harness));
    harness.get_by_label(text::NEXT_PANE.english()).click();
    harness.run();
    harness.get_by_label("15 frames · 2 / 3");
}

#[test]
fn swipe_over_the_stage_counts_while_frames_are_slow() {
    for frame_secs in [1.0 / 60.0, 0.2, 1.5] {
        let link = "compare=blend_window:30,15&play=off";
        let mut harness = stepped_harness(PHONE, FINGERS, frame_secs, page(link));
        harness.ctx.add_plugin(Pacing::default());
        let from = harness.state().stage.center();
        let all = [TouchPhase::Start, TouchPhase::Move, TouchPhase::Move, TouchPhase::End];
        let ways = [0.0, -60.0, -120.0, -120.0];
        let events =
            all.iter().zip(ways).flat_map(|(&phase, way)| finger(phase, from + vec2(way, 0.0)));
        step(events.collect(), &mut harness);
        harness.run_steps(6);
        harness.get_by_label("15 frames · 2 / 2");
    }
}

#[test]
fn swipe_that_begins_on_the_map_scrolls_and_a_held_finger_sets_a_pin() {
    let mut harness = phone("lab=register&play=off");
    harness.get_by_label(text::DISTANCES.english()).scroll_to_me();
    harness.run();
    let map = |harness: &Harness<'_, Page>| harness.get_by_label(text::DISTANCES.english()).rect();
    let pins = |harness: &Harness<'_, Page>| harness.state().session.params().pins().to_vec();
    let before = map(&harness);
    swipe(before.center(), vec2(0.0, -80.0), 8, &mut harness);
    assert!(map(&harness).top() < before.top() - 40.0, "{before:?} {:?}", map(&harness));
    assert!(pins(&harness).is_empty());
    harness.get_by_label(text::DISTANCES.english()).scroll_to_me();
    harness.run_steps(60);
    let at = map(&harness).center();
    step(finger(TouchPhase::Start, at), &mut harness);
    for _ in 0..60 {
        step(Vec::new(), &mut harness);
    }
    step(finger(TouchPhase::End, at), &mut harness);
    harness.run();
    assert_eq!(pins(&harness).len(), 1);
    let (set, place) = (pins(&harness), map(&harness));
    swipe(at, vec2(30.0, -30.0), 8, &mut harness);
    assert_eq!(map(&harness), place, "a pin is dragged, and nothing scrolls");
    assert!(pins(&harness).len() == 1 && pins(&harness) != set, "{:?}", pins(&harness));
}

#[test]
fn swipe_that_begins_on_a_slider_scrolls_and_one_along_it_sets_the_value() {
    let mut harness = phone("lab=make&play=off");
    let slider = |harness: &Harness<'_, Page>| {
        harness.get_by_role_and_label(Role::Slider, "Turn rate").rect()
    };
    let rate = |harness: &Harness<'_, Page>| harness.state().session.params().number(Key::TurnRate);
    harness.get_by_role_and_label(Role::Slider, "Turn rate").scroll_to_me();
    harness.run_steps(60);
    let (before, value) = (slider(&harness), rate(&harness));
    let from = before.left_center() + vec2(40.0, 0.0);
    swipe(from, vec2(4.0, -60.0), 8, &mut harness);
    let after = slider(&harness);
    assert!(after.top() < before.top() - 40.0, "{before:?} {after:?}");
    assert_eq!(rate(&harness), value, "the finger scrolls");
    // A finger along the track slides, and a tap sets the value under it.
    swipe(after.left_center() + vec2(40.0, 0.0), vec2(60.0, 3.0), 8, &mut harness);
    let slid = rate(&harness);
    assert!(slid != value && slider(&harness) == after, "{value} {slid}");
    swipe(after.right_center() - vec2(40.0, 0.0), Vec2::ZERO, 1, &mut harness);
    assert!(rate(&harness) > slid, "{slid} {}", rate(&harness));
}

#[test]
fn buttons_over_a_low_stage_are_whole() {
    for (size, theme) in [(HALL_SIZE, HALL), (CLASSIC, DARK), (vec2(1280.0, 600.0), HALL)] {
        let link = "lab=transition&compare=half_life:0.4,0.2,0.1&play=off";
        let harness = harness(size, theme, page(link));
        let stage = harness.state().stage;
        let at = harness.get_by_label(text::COPY_REPORT.english()).rect();
        assert!(stage.contains_rect(at), "{size}: {at:?} in {stage:?}");
    }
}

#[test]
fn page_key_pressed_while_a_lesson_loads_goes_on_behind_it() {
    let mut harness = harness(HALL_SIZE, DARK, super::lessons::lesson("lesson=blend_window"));
    harness.key_press(Keyboard::P);
    harness.run_steps(4);
    let title = |harness: &Harness<'_, Page>| match harness.state().session.lesson() {
        Some(segue_session::Lesson::Page(page)) => page.number,
        _ => 0,
    };
    assert_eq!(title(&harness), 3);
    for _ in 0..2 {
        harness.key_press(Keyboard::PageDown);
        harness.run_steps(2);
    }
    for _ in 0..2 {
        super::lessons::deliver(&mut harness.state_mut().session);
        harness.run_steps(4);
    }
    assert_eq!(title(&harness), 5);
}

#[test]
fn lesson_has_what_it_speaks_of_beside_its_text() {
    let controls =
        |link: &str, size: Vec2, theme: Theme| harness(size, theme, super::lessons::lesson(link));
    let mut harness = controls("lesson=time_warp", HALL_SIZE, HALL);
    let map = harness.get_by_label(text::DISTANCES.english()).rect();
    assert!(map.bottom() < HALL_SIZE.y && map.height() > 100.0, "{map:?}");
    picture("lesson-map-projector", &mut harness);
    let mut harness = controls("lesson=half_life", HALL_SIZE, HALL);
    harness.get_by_label_contains("50 %");
    let slider = harness.get_by_role_and_label(Role::Slider, "Half-life");
    assert!(slider.rect().bottom() < HALL_SIZE.y, "{:?}", slider.rect());
    picture("lesson-ruler-projector", &mut harness);
    let mut harness = controls("lesson=time_warp", PHONE, FINGERS);
    harness.get_by_label(text::DISTANCES.english()).scroll_to_me();
    harness.run();
    picture("lesson-map-phone", &mut harness);
    // At a desk all of it stands in the panel of the parameters, once.
    let harness = controls("lesson=time_warp", DESK, DARK);
    assert_eq!(harness.query_all_by_label(text::DISTANCES.english()).count(), 1);
}

#[test]
fn presenter_sees_the_stage_alone_and_goes_on_by_page_keys() {
    let mut harness = harness(HALL_SIZE, DARK, page("lab=blend&play=off"));
    let distance =
        |harness: &Harness<'_, Page>| harness.state().session.params().number(Key::CameraDistance);
    let before = distance(&harness);
    harness.key_press(Keyboard::P);
    harness.run();
    let stage = harness.state().stage;
    assert!(stage.width() == HALL_SIZE.x && stage.height() > 580.0, "{stage:?}");
    assert!(harness.query_by_label(text::COPY_LINK.english()).is_none());
    assert!(harness.state().out.actions.contains(&Action::Fullscreen(true)));
    let lab = |harness: &Harness<'_, Page>| harness.state().session.params().lab().word();
    harness.key_press(Keyboard::PageDown);
    harness.run();
    assert_eq!(lab(&harness), "transition");
    harness.key_press(Keyboard::PageUp);
    harness.run();
    assert_eq!(lab(&harness), "blend");
    assert_eq!(distance(&harness), before, "the page keys do not zoom meanwhile");
    harness.key_press(Keyboard::Escape);
    harness.run();
    harness.get_by_label(text::COPY_LINK.english());
    assert!(harness.state().out.actions.contains(&Action::Fullscreen(false)));
}

#[test]
fn presenter_of_a_comparison_sees_all_panes_and_then_each_alone() {
    let link = "compare=blend_window:30,15,10&play=off";
    let mut harness = harness(HALL_SIZE, DARK, page(link));
    harness.key_press(Keyboard::P);
    harness.run();
    picture("presenter-all", &mut harness);
    let titles = |harness: &Harness<'_, Page>| {
        ["30 frames", "15 frames", "10 frames"].map(|title| {
            let mut headings = harness.query_all_by_role(Role::Heading);
            headings.any(|node| node.accesskit_node().label().is_some_and(|it| it.contains(title)))
        })
    };
    assert_eq!(titles(&harness), [true; 3]);
    for alone in 0..3 {
        harness.key_press(Keyboard::PageDown);
        harness.run();
        assert_eq!(titles(&harness), [0, 1, 2].map(|pane| pane == alone));
    }
    picture("presenter-one", &mut harness);
    harness.key_press(Keyboard::PageDown);
    harness.run();
    assert_eq!(titles(&harness), [true; 3]);
    harness.key_press(Keyboard::PageUp);
    harness.run();
    assert_eq!(titles(&harness), [false, false, true]);
}

#[test]
fn bar_of_the_presenter_comes_with_the_pointer_and_leaves() {
    let mut harness = harness(HALL_SIZE, LIGHT, super::lessons::lesson("lesson=blend_window"));
    harness
        .state_mut()
        .session
        .apply(Command::Set(vec![(Key::Play, Value::Switch(false))]))
        .unwrap();
    harness.key_press(Keyboard::P);
    harness.run_steps(20);
    let is_shown = |harness: &Harness<'_, Page>| {
        harness.query_by_label(text::STOP_PRESENTING.english()).is_some()
    };
    assert!(!is_shown(&harness));
    harness.hover_at(pos2(400.0, 300.0));
    harness.run_steps(2);
    assert!(is_shown(&harness));
    harness.get_by_label_contains("3 / 15 · ");
    picture("presenter-bar", &mut harness);
    harness.run_steps(40);
    assert!(!is_shown(&harness));
    harness.hover_at(pos2(410.0, 300.0));
    harness.run_steps(2);
    harness.get_by_label(text::STOP_PRESENTING.english()).click();
    harness.run_steps(2);
    harness.get_by_label(text::COPY_LINK.english());
}

#[test]
fn link_is_copied_with_or_without_what_is_the_readers_own() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    harness.get_by_label(text::COPY_LINK.english()).click();
    harness.run();
    harness.get_by_label(text::SHARE.english()).click();
    harness.run();
    picture("share-menu", &mut harness);
    harness.get_by_label(text::COPY_LINK_AS_SHOWN.english()).click();
    harness.run();
    assert_eq!(harness.state().out.actions, [Action::CopyLink, Action::CopyLinkAsShown]);
}

#[test]
fn list_of_shortcuts_is_whole_in_its_first_frames() {
    for size in [DESK, CLASSIC, PHONE] {
        let mut harness = harness(size, DARK, page("lab=blend&play=off"));
        harness.event(Event::Text("?".to_owned()));
        harness.run_steps(3);
        let early = harness.get_by_label_contains("compare full, half").rect();
        harness.run_steps(30);
        let late = harness.get_by_label_contains("compare full, half").rect();
        assert!((early.width() - late.width()).abs() < 1.0, "{early:?} {late:?}");
        assert!(late.right() <= size.x, "{late:?}");
        picture(&format!("shortcuts-{}", size.x), &mut harness);
    }
}

#[test]
fn tab_moves_on_by_one_stop_for_each_press() {
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    harness.ctx.add_plugin(Pacing::default());
    let press = |pressed: bool| Event::Key {
        key: Keyboard::Tab,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    let focused = |harness: &Harness<'_, Page>| harness.ctx.memory(egui::Memory::focused);
    let mut one_by_one = Vec::new();
    for _ in 0..5 {
        step(vec![press(true), press(false)], &mut harness);
        harness.run();
        one_by_one.push(focused(&harness));
    }
    harness.ctx.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.surrender_focus(id);
        }
    });
    harness.run();
    step((0..5).flat_map(|_| [press(true), press(false)]).collect(), &mut harness);
    harness.run();
    assert_eq!(focused(&harness), one_by_one[4]);
}
