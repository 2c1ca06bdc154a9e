//! The library with mouse, keyboard and finger.

use super::*;
use eframe::egui::{Event, Modifiers, Pos2, TouchDeviceId, TouchId, TouchPhase};
use segue_session::Compare;

/// Returns a small file; `seed` tells its content apart.
fn small_file(seed: usize) -> Arc<[u8]> {
    let head = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION";
    Arc::from(format!("{head} Frames: 3 Frame Time: .1\n1\n2\n{seed}").into_bytes())
}

/// Opens files of these names together.
fn open(names: &[&str], page: &mut Page) {
    page.session.open_together(names.len());
    for (seed, name) in names.iter().enumerate() {
        page.session.load(name, small_file(seed)).expect("a small file");
    }
    while page.session.work() {}
}

fn slots(harness: &Harness<'_, Page>) -> [String; 2] {
    [Key::A, Key::B].map(|key| harness.state().session.params().text(key).to_owned())
}

/// Returns the row of the clip of that name: `Walk, 3.9 s · 468 frames`.
fn clip_row<'a>(name: &str, harness: &'a Harness<'_, Page>) -> Option<egui_kittest::Node<'a>> {
    let begin = format!("{name}, ");
    let is_row = |label: &str| {
        let facts = label.strip_prefix(&begin);
        facts.is_some_and(|facts| facts.starts_with(|letter: char| letter.is_ascii_digit()))
    };
    let rows = harness.get_all_by_role(Role::Button);
    rows.into_iter().find(|row| row.accesskit_node().label().is_some_and(|label| is_row(&label)))
}

fn row_of(name: &str, harness: &Harness<'_, Page>) -> Rect {
    clip_row(name, harness).expect("a row of that name").rect()
}

/// Clicks the row of a clip, beside its letters, with these keys held.
fn click_row(name: &str, modifiers: Modifiers, harness: &mut Harness<'_, Page>) {
    let at = row_of(name, harness).center();
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers,
    };
    step(vec![Event::ModifiersChanged(modifiers), Event::PointerMoved(at)], harness);
    step(vec![button(true)], harness);
    step(vec![button(false)], harness);
    // Away from the row, whose actions have names of other buttons.
    step(vec![Event::ModifiersChanged(Modifiers::NONE), Event::PointerGone], harness);
    harness.run();
}

fn picked(harness: &Harness<'_, Page>) -> Vec<String> {
    harness.state().state.library.picked.iter().cloned().collect()
}

#[test]
fn letters_of_a_row_assign_and_swap() {
    let mut harness = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    let is_held = |name: &str, harness: &Harness<'_, Page>| {
        harness.get_by_label(name).accesskit_node().toggled() == Some(Toggled::True)
    };
    assert!(is_held("Walk as A", &harness) && !is_held("Walk as B", &harness));
    harness.get_by_label("Stand as B").click();
    harness.run();
    assert_eq!(slots(&harness), ["walk", "idle"]);
    // The letter of the other slot swaps.
    harness.get_by_label("Stand as A").click();
    harness.run();
    assert_eq!(slots(&harness), ["idle", "walk"]);
    assert!(is_held("Walk as B", &harness) && is_held("Stand as A", &harness));
    // A letter that is held does nothing.
    let commands = harness.state().out.commands.len();
    harness.get_by_label("Stand as A").click();
    harness.run();
    assert_eq!(harness.state().out.commands.len(), commands);
    picture("library-desk-dark", &mut harness);
    harness.get_by_label(text::SWAP_CLIPS.english()).click();
    harness.run();
    assert_eq!(slots(&harness), ["walk", "idle"]);
    harness.key_press(Keyboard::X);
    harness.run();
    assert_eq!(slots(&harness), ["idle", "walk"]);
    harness.state_mut().session.apply(Command::Undo).unwrap();
    assert_eq!(slots(&harness), ["walk", "idle"], "a swap is one step");
}

#[test]
fn click_on_a_row_assigns_a_and_never_b() {
    let mut harness = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    for name in ["Walk", "Stand", "Stand"] {
        click_row(name, Modifiers::NONE, &mut harness);
        assert_eq!(slots(&harness)[1], "run", "{name}");
    }
    assert_eq!(slots(&harness)[0], "idle");
    // A row that holds B gives it to A, and takes back what A had.
    click_row("Run", Modifiers::NONE, &mut harness);
    assert_eq!(slots(&harness), ["run", "idle"]);
}

#[test]
fn lab_without_a_slot_has_no_letter_for_it() {
    let view = harness(DESK, DARK, page("lab=view&a=walk&play=off"));
    assert!(view.query_by_label("Walk as A").is_some());
    assert!(view.query_by_label("Walk as B").is_none());
    assert!(view.query_by_label(text::SWAP_CLIPS.english()).is_none());
    let mut make = harness(DESK, DARK, page("lab=make&play=off"));
    assert!(make.query_by_label("Walk as A").is_none());
    click_row("Walk", Modifiers::NONE, &mut make);
    assert_eq!(make.state().state.details.as_deref(), Some("walk"), "its details open");
}

#[test]
fn notices_of_many_files_are_one_chip_over_the_library() {
    let names: Vec<String> = (0..12).map(|n| format!("take_{n}.bvh")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    for (name, size) in [("desk", DESK), ("tablet", vec2(800.0, 700.0)), ("phone", PHONE)] {
        let mut page = page("lab=blend&play=off");
        open(&names, &mut page);
        let mut harness = harness(size, DARK, page);
        let chip = harness.get_by_role_and_label(Role::Button, "12 clips added");
        let (at, stage) = (chip.rect(), harness.state().stage);
        if name == "phone" {
            assert!(at.top() > stage.center().y && at.bottom() < stage.bottom(), "{at}");
        } else {
            assert!(!stage.intersects(at), "{name}: {at} is not on the stage");
        }
        harness.get_by_role(Role::Status);
        picture(&format!("notices-{name}"), &mut harness);
        harness.state_mut().session.tick(5.0);
        harness.run();
        assert!(harness.query_by_role_and_label(Role::Button, "12 clips added").is_none());
        assert!(harness.query_by_role(Role::Status).is_none(), "{name}: gone after a moment");
    }
}

#[test]
fn failure_stays_in_the_chip_until_it_was_seen() {
    let mut page = page("lab=blend&play=off");
    page.session.load("broken.bvh", Arc::from(&b"HIERARCHY"[..])).expect_err("it is broken");
    page.session.tick(60.0);
    let mut harness = harness(DESK, DARK, page);
    let error = harness.state().session.notices().list()[0].text.to_string();
    open_notices(&error, &mut harness);
    harness.key_press(Keyboard::Escape);
    harness.run();
    open_notices("1 note", &mut harness);
    harness.get_by_label(kit::DISMISS.english()).click();
    harness.run();
    assert!(harness.state().session.notices().list().is_empty());
    assert!(harness.query_by_label("1 note").is_none());
}

#[test]
fn search_shows_clips_by_name_until_escape() {
    let mut page = page("lab=view&play=off");
    open(&["dataset-1_walk_normal_001.bvh", "dataset-1_walk_normal_002.bvh"], &mut page);
    let mut harness = harness(DESK, DARK, page);
    assert!(clip_row("Stand", &harness).is_some());
    harness.get_by_label(text::SEARCH_CLIPS.english()).focus();
    harness.run();
    harness.get_by_label(text::SEARCH_CLIPS.english()).type_text("normal 2");
    harness.run();
    assert!(clip_row("Stand", &harness).is_none());
    assert!(clip_row("dataset-1_walk_normal_001", &harness).is_none());
    row_of("dataset-1_walk_normal_002", &harness);
    picture("library-search", &mut harness);
    harness.key_press(Keyboard::Escape);
    harness.run();
    assert!(clip_row("Stand", &harness).is_some());
    // A search without a match shows a message.
    harness.state_mut().state.library.search = "no such name".into();
    harness.run();
    harness.get_by_label(text::NO_SUCH_CLIP.english());
    harness.get_by_label("Clear the search").click();
    harness.run();
    assert!(clip_row("Stand", &harness).is_some());
}

#[test]
fn list_is_sorted_by_its_menu() {
    let mut page = page("lab=view&play=off");
    open(&["b.bvh", "a_10.bvh", "a_9.bvh"], &mut page);
    let mut harness = harness(DESK, DARK, page);
    let order = |harness: &Harness<'_, Page>| {
        let mut names = ["b", "a_10", "a_9"];
        names.sort_by(|x, y| row_of(x, harness).top().total_cmp(&row_of(y, harness).top()));
        names
    };
    assert_eq!(order(&harness), ["b", "a_10", "a_9"]);
    harness.get_by_label(text::SORT.english()).click();
    harness.run();
    harness.get_by_role_and_label(Role::MenuItem, text::ORDER_NAME.english()).click();
    harness.run();
    assert_eq!(order(&harness), ["a_9", "a_10", "b"]);
}

#[test]
fn group_of_files_folds() {
    let mut page = page("lab=view&play=off");
    open(&["takes/a.bvh", "takes/b.bvh"], &mut page);
    let mut harness = harness(DESK, DARK, page);
    let head = |harness: &Harness<'_, Page>| {
        harness.get_by_role_and_label(Role::DisclosureTriangle, "takes, 2").rect()
    };
    assert!(head(&harness).bottom() <= row_of("a", &harness).top() + 1.0);
    picture("library-groups", &mut harness);
    harness.get_by_label("takes, 2").click();
    harness.run();
    assert!(clip_row("a", &harness).is_none());
    harness.get_by_label("takes, 2").click();
    harness.run();
    assert!(clip_row("a", &harness).is_some());
    // With Ctrl or Cmd its clips are selected.
    let at = head(&harness).center();
    let command = Modifiers::COMMAND;
    step(vec![Event::ModifiersChanged(command), Event::PointerMoved(at)], &mut harness);
    step(vec![button(at, true)], &mut harness);
    step(vec![button(at, false)], &mut harness);
    step(vec![Event::ModifiersChanged(Modifiers::NONE), Event::PointerGone], &mut harness);
    harness.run();
    assert_eq!(picked(&harness).len(), 2);
}

#[test]
fn several_clips_are_selected_and_used() {
    let mut page = page("lab=graph&walk_seconds=10&play=off");
    open(&["a.bvh", "b.bvh", "c.bvh", "d.bvh"], &mut page);
    let ids: Vec<String> = ["a", "b", "c", "d"]
        .iter()
        .map(|name| page.session.library().find(name).expect("it was read").id.clone())
        .collect();
    page.state.library_open = true;
    let mut harness = harness(DESK, DARK, page);
    click_row("a", Modifiers::COMMAND, &mut harness);
    click_row("c", Modifiers::SHIFT, &mut harness);
    assert_eq!(picked(&harness), ids[..3]);
    harness.get_by_label("3 selected");
    picture("library-selected", &mut harness);
    click_row("b", Modifiers::COMMAND, &mut harness);
    harness.get_by_label(text::USE_THESE.english()).click();
    harness.run();
    assert_eq!(harness.state().session.graph_clip_ids(), [ids[0].clone(), ids[2].clone()]);
    assert!(picked(&harness).is_empty());
    // Removed in one step.
    let all = harness.state().session.library().entries().len();
    click_row("b", Modifiers::COMMAND, &mut harness);
    click_row("d", Modifiers::COMMAND, &mut harness);
    harness.get_by_label(text::REMOVE.english()).click();
    harness.run();
    assert_eq!(harness.state().session.library().entries().len(), all - 2);
    harness.state_mut().session.apply(Command::Undo).unwrap();
    assert_eq!(harness.state().session.library().entries().len(), all);
    click_row("a", Modifiers::COMMAND, &mut harness);
    harness.get_by_label(text::CLEAR_SELECTION.english()).click();
    harness.run();
    assert!(picked(&harness).is_empty());
    // Escape ends the selection, and only that.
    click_row("a", Modifiers::COMMAND, &mut harness);
    harness.key_press(Keyboard::Escape);
    harness.run();
    assert!(picked(&harness).is_empty() && harness.state().state.library_open);
}

/// Returns the events of a finger, and those that browsers add for the pointer.
fn finger(phase: TouchPhase, pos: Pos2) -> Vec<Event> {
    let touch =
        Event::Touch { device_id: TouchDeviceId(1), id: TouchId(1), phase, pos, force: None };
    match phase {
        TouchPhase::Start => vec![touch, Event::PointerMoved(pos), button(pos, true)],
        TouchPhase::Move => vec![touch, Event::PointerMoved(pos)],
        TouchPhase::End | TouchPhase::Cancel => vec![touch, button(pos, false), Event::PointerGone],
    }
}

/// Touches a place for a moment.
fn tap(at: Pos2, harness: &mut Harness<'_, Page>) {
    step(finger(TouchPhase::Start, at), harness);
    step(finger(TouchPhase::End, at), harness);
    harness.run_steps(4);
}

/// Touches a place and moves the finger.
fn swipe(from: Pos2, by: Vec2, harness: &mut Harness<'_, Page>) {
    step(finger(TouchPhase::Start, from), harness);
    for part in 1..=8 {
        step(finger(TouchPhase::Move, from + by * (part as f32 / 8.0)), harness);
    }
    step(finger(TouchPhase::End, from + by), harness);
    harness.run_steps(4);
}

fn phone_with_library() -> Harness<'static, Page> {
    let mut page = page("lab=blend&a=walk&b=run&play=off");
    page.state.library_open = true;
    let mut harness = harness(PHONE, DARK, page);
    // The first touch tells that there is a touch screen.
    tap(Pos2::new(200.0, 250.0), &mut harness);
    harness
}

#[test]
fn library_of_a_phone_opens_at_its_top_and_scrolls_by_finger() {
    let mut harness = phone_with_library();
    let open = harness.get_by_label(text::OPEN_FILES.english()).rect();
    assert!(open.top() > harness.state().stage.bottom() && open.bottom() < PHONE.y, "{open}");
    harness.get_by_label(text::CLOSE.english());
    picture("library-phone-dark", &mut harness);
    let fourth = row_of("Walk, turn right", &harness);
    assert!(fourth.bottom() < PHONE.y, "four rows are in sight: {fourth}");
    let before = slots(&harness);
    let row = row_of("Walk", &harness);
    swipe(row.center(), vec2(0.0, -120.0), &mut harness);
    let moved = row.top() - row_of("Walk", &harness).top();
    assert!(moved > 60.0, "the list moved by {moved}");
    assert_eq!(slots(&harness), before, "no row was pressed");
    // Closed and opened again, it is at its top.
    harness.get_by_label(text::CLOSE.english()).click();
    harness.run_steps(3);
    harness.state_mut().state.library_open = true;
    harness.run_steps(3);
    assert_eq!(harness.get_by_label(text::OPEN_FILES.english()).rect(), open);
}

#[test]
fn targets_for_a_finger_are_large() {
    let harness = phone_with_library();
    for name in ["Walk as A", "Walk as B"] {
        let size = harness.get_by_label(name).rect().size();
        assert!(size.x >= 44.0 && size.y >= 44.0, "{name}: {size}");
    }
    assert!(harness.query_all_by_label("More").count() > 3, "a menu for each row");
}

#[test]
fn finger_that_is_held_selects() {
    let mut harness = phone_with_library();
    swipe(row_of("Walk", &harness).center(), vec2(0.0, -60.0), &mut harness);
    let at = row_of("Walk", &harness).center();
    step(finger(TouchPhase::Start, at), &mut harness);
    for _ in 0..80 {
        harness.step();
    }
    step(finger(TouchPhase::End, at), &mut harness);
    harness.run_steps(3);
    assert_eq!(picked(&harness), ["walk"]);
    let other = row_of("Run", &harness).center();
    tap(other, &mut harness);
    assert_eq!(picked(&harness), ["run", "walk"], "a tap adds another one");
    harness.get_by_label("2 selected");
    picture("library-phone-selected", &mut harness);
    harness.get_by_label(text::USE_THESE.english()).click();
    harness.run_steps(3);
    assert_eq!(slots(&harness), ["walk", "run"]);
    assert!(picked(&harness).is_empty());
}

/// Drags the row of a clip to a place.
fn drag(name: &str, to: Pos2, harness: &mut Harness<'_, Page>) {
    let from = row_of(name, harness).center();
    step(vec![Event::PointerMoved(from)], harness);
    step(vec![button(from, true)], harness);
    for part in 1..=6 {
        step(vec![Event::PointerMoved(from.lerp(to, part as f32 / 6.0))], harness);
    }
    picture(&format!("drag-{name}"), harness);
    step(vec![button(to, false)], harness);
    harness.run();
}

#[test]
fn row_is_dragged_to_a_slot_a_pane_and_a_list() {
    let mut blend = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    let row_of_b = blend.get_by_role_and_label(Role::ComboBox, "B").rect();
    drag("Stand", row_of_b.center(), &mut blend);
    assert_eq!(slots(&blend), ["walk", "idle"]);
    let stage = blend.state().stage;
    drag("Run", stage.center(), &mut blend);
    assert_eq!(slots(&blend), ["run", "idle"]);
    // Outside of all targets nothing happens.
    drag("Walk", Pos2::new(700.0, 12.0), &mut blend);
    assert_eq!(slots(&blend), ["run", "idle"]);

    let mut view = harness(DESK, DARK, page("lab=view&compare=a:walk,run&play=off"));
    let stage = view.state().stage;
    drag("Stand", stage.center() + vec2(stage.width() / 4.0, 0.0), &mut view);
    let compare = view.state().session.compare().map(Compare::to_string);
    assert_eq!(compare.as_deref(), Some("a:walk,idle"));

    let mut page = page("lab=graph&clips=walk,walk_left&walk_seconds=10&play=off");
    page.state.library_open = true;
    let mut graph = harness(DESK, DARK, page);
    graph.get_by_role_and_label(Role::ComboBox, text::ADD_CLIP.english()).scroll_to_me();
    graph.run();
    let list = graph.get_by_role_and_label(Role::ComboBox, text::ADD_CLIP.english()).rect();
    drag("Run", list.center(), &mut graph);
    assert_eq!(graph.state().session.graph_clip_ids(), ["walk", "walk_left", "run"]);
}

#[test]
fn row_is_dragged_to_a_bar_of_the_timeline_and_the_map_of_a_graph() {
    let mut blend = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    // The bar of A ends in the transition and that of B begins there, a row below.
    let edge = |name: &str, harness: &Harness<'_, Page>| harness.get_by_label(name).rect();
    let bar_of_a = edge("Transition start", &blend).center_top() + vec2(-40.0, 18.0);
    drag("Stand", bar_of_a, &mut blend);
    assert_eq!(slots(&blend), ["idle", "run"]);
    let bar_of_b = edge("Transition end", &blend).center_top() + vec2(40.0, 42.0);
    drag("Walk", bar_of_b, &mut blend);
    assert_eq!(slots(&blend), ["idle", "walk"]);

    let mut page = page("lab=graph&clips=walk,walk_left&walk_seconds=10&play=off");
    page.state.library_open = true;
    let mut graph = harness(DESK, DARK, page);
    for _ in 0..2 {
        let map = graph.get_by_label(text::ALL_DISTANCES.english()).rect();
        drag("Run", map.center(), &mut graph);
        assert_eq!(graph.state().session.graph_clip_ids(), ["walk", "walk_left", "run"]);
        while graph.state_mut().session.work() {}
        graph.run();
    }
}

#[test]
fn row_is_worked_by_the_keyboard() {
    let mut harness = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    let focus = |harness: &mut Harness<'_, Page>| {
        clip_row("Stand", harness).expect("a row").focus();
        harness.run();
    };
    assert!(harness.query_by_label(text::RENAME.english()).is_none());
    focus(&mut harness);
    harness.get_by_label(text::RENAME.english());
    harness.key_press(Keyboard::Enter);
    harness.run();
    assert_eq!(slots(&harness), ["idle", "run"]);
    // The menu opens with the focus on its first line.
    for modifiers_and_key in [(Modifiers::SHIFT, Keyboard::F10), (Modifiers::NONE, Keyboard::Menu)]
    {
        focus(&mut harness);
        harness.key_press_modifiers(modifiers_and_key.0, modifiers_and_key.1);
        harness.run();
        let first = harness.get_by_role_and_label(Role::MenuItem, text::USE_AS_A.english());
        assert!(first.is_focused());
        harness.key_press(Keyboard::Escape);
        harness.run();
    }
    focus(&mut harness);
    harness.key_press(Keyboard::F2);
    harness.run();
    assert!(harness.state().state.renaming.is_some());
    harness.key_press(Keyboard::Escape);
    harness.run();
    focus(&mut harness);
    harness.key_press(Keyboard::Delete);
    harness.run();
    assert!(harness.state().session.library().get("idle").is_none());
}

#[test]
fn actions_of_a_row_stay_while_one_of_them_has_the_focus() {
    let mut harness = harness(DESK, DARK, page("lab=blend&a=walk&b=run&play=off"));
    clip_row("Stand", &harness).expect("a row").focus();
    harness.run();
    harness.get_by_label(text::RENAME.english()).focus();
    harness.run();
    harness.get_by_label(text::REMOVE.english());
    harness.key_press(Keyboard::Enter);
    harness.run();
    assert!(harness.state().state.renaming.is_some());
}

/// A figure that was left out can be cast from the menu of its row.
#[test]
fn figure_is_cast_from_the_menu_of_its_row() {
    use segue_formats::gltf::{GlbOptions, write_glb};
    let mut page = page("lab=blend&a=walk&b=run&play=off");
    let motion = page.session.library().get("walk").and_then(|walk| walk.motion.clone());
    let options = GlbOptions { smooth: true, ..GlbOptions::default() };
    let mut bytes =
        write_glb(motion.expect("it is in A").clip(), &options).expect("a walk with a body");
    // The reader skips bodies that Segue wrote, so pretend that another program wrote this one.
    let at = bytes.windows(6).position(|word| word == b"Segue ").expect("its generator");
    bytes[at..at + 5].copy_from_slice(b"Other");
    let id = page.session.load("person.glb", bytes.into()).expect("a figure").ids.remove(0);
    page.session.apply(Command::Reset(Key::Character)).unwrap();
    let name = page.session.library().get(&id).expect("it was read").name.clone();
    let mut harness = harness(DESK, DARK, page);
    clip_row(&name, &harness).expect("a row").focus();
    harness.run();
    harness.key_press(Keyboard::Menu);
    harness.run();
    picture("library-menu", &mut harness);
    harness.get_by_role_and_label(Role::MenuItem, text::USE_AS_CHARACTER.english()).click();
    harness.run();
    assert_eq!(harness.state().session.params().text(Key::Character), id);
}

/// Returns the number of rows of small files that are drawn.
fn drawn(harness: &Harness<'_, Page>) -> usize {
    let rows = harness.get_all_by_role(Role::Button).filter(|row| {
        row.accesskit_node().label().is_some_and(|label| label.ends_with("0.2 s · 3 frames"))
    });
    rows.count()
}

#[test]
fn long_list_lays_out_only_the_rows_in_sight() {
    let mut page = page("lab=view&a=walk&play=off");
    let names: Vec<String> = (0..300).map(|index| format!("takes/{index:03}.bvh")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    open(&names, &mut page);
    let mut harness = harness(DESK, DARK, page);
    harness.run();
    let first = drawn(&harness);
    assert!((5..60).contains(&first), "{first} rows");
    // One that arrives at the end of the group is scrolled into sight.
    harness.state_mut().session.load("takes/new.bvh", small_file(999)).unwrap();
    harness.run_steps(40);
    let row = row_of("new", &harness);
    assert!(row.top() > 0.0 && row.bottom() < 900.0, "{row:?}");
    assert!(clip_row("003", &harness).is_none(), "those before it are out of sight");
    assert!(drawn(&harness) < 60);
    // A search looks into all of them.
    harness.state_mut().state.library.search = "150".to_owned();
    harness.run_steps(4);
    assert_eq!(drawn(&harness), 1);
    row_of("150", &harness);
}
