//! Tests of the outline: what the page is told, and what comes back from it.

use super::*;
use eframe::egui::accesskit::Role;
use eframe::egui::{self, Modifiers, RawInput, Ui};
use std::cell::RefCell;

thread_local! {
    /// The changes that the page was told, as JSON.
    static TOLD: RefCell<Vec<serde_json::Value>> = const { RefCell::new(Vec::new()) };
}

fn tell(changes: &str) {
    let changes = serde_json::from_str(changes).expect("JSON");
    TOLD.with_borrow_mut(|told| told.push(changes));
}

/// Runs a frame, and returns what the page was told of it.
fn frame(ctx: &Context, mut show: impl FnMut(&mut Ui)) -> Option<serde_json::Value> {
    let mut output = ctx.run_ui(RawInput::default(), &mut show);
    output.textures_delta.clear();
    TOLD.with_borrow_mut(Vec::pop)
}

fn told_outline() -> (Context, Outline) {
    let (ctx, outline) = (Context::default(), Outline::default());
    outline.install(&ctx, tell);
    outline.enable();
    (ctx, outline)
}

/// Returns the element of a role and name among some changes.
fn find<'a>(
    changes: &'a serde_json::Value,
    role: &str,
    name: &str,
) -> Option<&'a serde_json::Value> {
    let elements = changes["elements"].as_array()?;
    elements.iter().find(|element| element["role"] == role && element["name"] == name)
}

fn number_of(changes: &serde_json::Value, role: &str, name: &str) -> u32 {
    let element = find(changes, role, name).expect("an element of this role and name");
    element["number"].as_u64().and_then(|number| number.try_into().ok()).expect("a number")
}

#[test]
fn disabled_outline_tells_nothing() {
    let (ctx, outline) = (Context::default(), Outline::default());
    outline.install(&ctx, tell);
    assert_eq!(frame(&ctx, |ui| drop(ui.button("Play"))), None);
}

#[test]
fn page_hears_of_still_panels_once_a_second_and_of_events_at_once() {
    let (ctx, outline) = told_outline();
    let mut stillness = ui::still::Stillness::default();
    let mut number = 0;
    let mut next = || {
        frame(&ctx, |ui| {
            stillness.begin(true, ui.ctx());
            number += 1;
            drop(ui.button("Play"));
            ui.label(format!("frame {number}"));
        })
    };
    let first = next().expect("all elements");
    let told: Vec<_> = (0..300).map(|_| next()).collect();
    assert!(told[..60].iter().all(Option::is_some), "until they stand still");
    assert!((3..6).contains(&told[80..].iter().flatten().count()));
    let ends_any = |changes: &serde_json::Value| {
        changes["gone"].as_array().is_some_and(|gone| !gone.is_empty())
    };
    assert!(!told.iter().flatten().any(ends_any));

    outline.request(number_of(&first, "button", "Play"), Deed::Focus);
    let focused = next().expect("the focus");
    assert_eq!(focused["focus"], number_of(&first, "button", "Play"));
}

/// A panel whose texts and values change, one of them the label of another.
fn changing_ui(value: f64, ui: &mut Ui) {
    ui.heading("Blend");
    ui.label(format!("{value:.1} s"));
    let name = ui.label(if value < 5.0 { "Short" } else { "Long" });
    let mut value = value;
    ui.add(egui::DragValue::new(&mut value)).labelled_by(name.id);
    ui.add(egui::Slider::new(&mut value, 0.0..=10.0));
    ui.add(egui::ProgressBar::new(value as f32 / 10.0));
}

// Fails when a frame in which only values change makes all elements anew, and when one in which
// more changes does not.
#[test]
fn only_elements_with_new_values_are_made_anew() {
    let nodes_at = |value: f64| {
        let ctx = Context::default();
        ctx.enable_accesskit();
        // egui's own widgets settle in their second frame.
        let frames = [(); 3].map(|()| {
            let mut output = ctx.run_ui(RawInput::default(), |ui| changing_ui(value, ui));
            output.textures_delta.clear();
            output.platform_output.accesskit_update
        });
        let [.., last] = frames;
        last.expect("a tree")
    };
    let mut tree = Tree::default();
    assert!(tree.changes(nodes_at(3.0), 1.0, String::new).is_some());
    let changed = |value: f64, zoom: f64| {
        tree.new_values(&nodes_at(value).nodes, zoom).map(|elements| elements.len())
    };
    assert_eq!(changed(3.0, 1.0), Some(0));
    assert_eq!(changed(4.0, 1.0), Some(5));
    assert_eq!(changed(6.0, 1.0), None, "a label names another element");
    assert_eq!(changed(3.0, 1.5), None, "all places are others");
}

// Fails when elements whose values alone have changed are not as they would be made anew.
#[test]
fn changed_values_give_the_elements_of_a_new_tree() {
    let (ctx, outline) = told_outline();
    let mut told = Vec::new();
    for value in [3.0, 3.0, 3.0, 4.0, 4.5, 4.5, 6.0, 7.0, 7.0] {
        told.push(frame(&ctx, |ui| changing_ui(value, ui)));
        let (other, fresh) = told_outline();
        // egui's own widgets settle in their second frame.
        for _ in 0..3 {
            frame(&other, |ui| changing_ui(value, ui));
        }
        if told.len() > 2 {
            let elements = |outline: &Outline| {
                let tree = outline.tree();
                let mut all: Vec<_> = tree.elements.values().cloned().collect();
                all.sort_by_key(|element| element.number);
                all
            };
            assert_eq!(elements(&outline), elements(&fresh), "at {value}");
        }
    }
    assert_eq!(told.pop().flatten(), None, "nothing has changed");
    let changed = told.pop().flatten().expect("new values");
    let values = changed["values"].as_array().expect("values alone");
    let mut values: Vec<_> = (values.iter())
        .map(|value| {
            let tree = outline.tree();
            let number = value["number"].as_u64().and_then(|number| number.try_into().ok());
            let element = &tree.elements[&number.expect("a number")];
            (element.role, value["name"].as_str() == Some(&element.name), value["now"].as_f64())
        })
        .collect();
    values.sort_by_key(|(role, ..)| *role); // the page takes them in any order
    assert_eq!(
        values,
        [
            ("progressbar", true, Some(69.0)), // of 0.7_f32, in whole per cent
            ("slider", true, Some(7.0)),
            ("spinbutton", true, Some(7.0)),
            ("spinbutton", true, Some(7.0)),
            ("text", true, None),
        ]
    );
}

#[test]
fn widgets_are_told_once_and_then_their_changes() {
    let (ctx, _outline) = told_outline();
    let show = |value: f64, is_on: bool, ui: &mut Ui| {
        let mut value = value;
        let mut on = is_on;
        ui.checkbox(&mut on, "Foot lock");
        ui.add(egui::Slider::new(&mut value, 0.0..=10.0).text("Blend window"));
        ui.label("12 frames");
    };
    let first = frame(&ctx, |ui| show(3.0, false, ui)).expect("all elements");
    assert_eq!(find(&first, "checkbox", "Foot lock").unwrap()["state"][1], "false");
    assert!(find(&first, "text", "12 frames").is_some());
    let slider = first["elements"].as_array().unwrap().iter();
    let slider = slider.into_iter().find(|element| element["role"] == "slider").unwrap();
    assert_eq!((&slider["range"]["now"], &slider["range"]["max"]), (&3.0.into(), &10.0.into()));
    // egui's own widgets settle in their second frame.
    frame(&ctx, |ui| show(3.0, false, ui));
    assert_eq!(frame(&ctx, |ui| show(3.0, false, ui)), None);
    let second = frame(&ctx, |ui| show(3.0, true, ui)).expect("one element");
    assert_eq!(second["elements"].as_array().unwrap().len(), 1);
    assert_eq!(second["elements"][0]["state"][1], "true");
    let number = number_of(&first, "checkbox", "Foot lock");
    assert_eq!(second["elements"][0]["number"], number);
}

#[test]
fn widget_that_leaves_is_gone() {
    let (ctx, _outline) = told_outline();
    let first = frame(&ctx, |ui| drop(ui.button("Play"))).expect("all elements");
    let number = number_of(&first, "button", "Play");
    let second = frame(&ctx, |_| {}).expect("one element less");
    assert_eq!(second["gone"], serde_json::json!([number]));
    assert_eq!(second["top"], serde_json::json!([]));
}

#[test]
fn parts_are_in_reading_order_whatever_is_drawn_first() {
    let (ctx, _outline) = told_outline();
    let part = |role: Role, name: &str, ui: &mut Ui| {
        ui.push_id(name, |ui| {
            ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
                node.set_role(role);
                node.set_label(name);
            });
            ui.label("text");
        });
    };
    let changes = frame(&ctx, |ui| {
        part(Role::Region, "Timeline", ui);
        part(Role::Main, "Stage", ui);
        part(Role::Banner, "Top bar", ui);
    });
    let changes = changes.expect("all elements");
    let order = [("banner", "Top bar"), ("main", "Stage"), ("region", "Timeline")];
    let order = order.map(|(role, name)| number_of(&changes, role, name));
    assert_eq!(changes["top"], serde_json::json!(order));
}

#[test]
fn container_with_a_hint_gives_it_to_its_control() {
    let (ctx, _outline) = told_outline();
    let changes = frame(&ctx, |ui| {
        let row = ui.scope(|ui| drop(ui.checkbox(&mut false, "Foot lock")));
        let hint = "Holds planted feet in place.";
        ui.ctx().accesskit_node_builder(row.response.id, |node| {
            node.set_label(hint);
            node.set_description(hint);
        });
    });
    let changes = changes.expect("all elements");
    assert_eq!(changes["elements"].as_array().unwrap().len(), 1, "{changes}");
    assert_eq!(changes["elements"][0]["description"], "Holds planted feet in place.");
}

#[test]
fn container_that_can_be_pressed_is_no_button() {
    let (ctx, _outline) = told_outline();
    let changes = frame(&ctx, |ui| {
        let row = ui.scope(|ui| drop(ui.button("Walk")));
        ui.ctx().accesskit_node_builder(row.response.id, |node| {
            node.set_label("Clips");
            node.add_action(Action::Click);
        });
    });
    let changes = changes.expect("all elements");
    assert!(find(&changes, "group", "Clips").is_some(), "{changes}");
}

#[test]
fn items_are_buttons_outside_of_menus() {
    let (ctx, _outline) = told_outline();
    let item = |role: Role, ui: &mut Ui| {
        ui.push_id(role as u8, |ui| {
            ui.ctx().accesskit_node_builder(ui.unique_id(), |node| node.set_role(role));
            let response = ui.button("Walk");
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_role(Role::MenuItem));
        });
    };
    let changes = frame(&ctx, |ui| {
        item(Role::Menu, ui);
        item(Role::GenericContainer, ui);
    });
    let changes = changes.expect("all elements");
    assert!(find(&changes, "menuitem", "Walk").is_some(), "{changes}");
    assert!(find(&changes, "button", "Walk").is_some(), "{changes}");
}

#[test]
fn click_and_value_of_an_element_reach_its_widget() {
    let (ctx, outline) = told_outline();
    let (mut clicks, mut value) = (0, 3.0);
    let show = |clicks: &mut i32, value: &mut f64, ui: &mut Ui| {
        *clicks += i32::from(ui.button("Play").clicked());
        ui.add(egui::Slider::new(value, 0.0..=10.0).text("Blend window"));
    };
    let first = frame(&ctx, |ui| show(&mut clicks, &mut value, ui)).expect("all elements");
    outline.request(number_of(&first, "button", "Play"), Deed::Click);
    let slider = first["elements"].as_array().unwrap().iter();
    let slider = slider.into_iter().find(|element| element["role"] == "slider").unwrap();
    let slider = slider["number"].as_u64().and_then(|number| number.try_into().ok()).unwrap();
    outline.request(slider, Deed::SetValue(7.0));
    outline.request(9999, Deed::Click);
    frame(&ctx, |ui| show(&mut clicks, &mut value, ui));
    assert_eq!((clicks, value), (1, 7.0));
}

#[test]
fn focus_and_keys_of_an_element_reach_its_widget() {
    let (ctx, outline) = told_outline();
    let mut clicks = 0;
    let mut show = |ui: &mut Ui| clicks += i32::from(ui.button("Play").clicked());
    let first = frame(&ctx, &mut show).expect("all elements");
    let play = number_of(&first, "button", "Play");
    outline.set_has_keyboard(true);
    outline.request(play, Deed::Focus);
    let second = frame(&ctx, &mut show).expect("the focus");
    assert_eq!(second["focus"], play);
    for pressed in [true, false] {
        outline.press("Enter", "Enter", pressed, Modifiers::NONE);
    }
    outline.press("Dead", "Nowhere", true, Modifiers::NONE);
    frame(&ctx, &mut show);
    assert_eq!(clicks, 1);
}

#[test]
fn letters_of_an_element_are_text_unless_they_are_a_command() {
    let outline = Outline::default();
    outline.press("7", "Digit7", true, Modifiers::NONE);
    outline.press("7", "Digit7", false, Modifiers::NONE);
    outline.press("c", "KeyC", true, Modifiers::COMMAND);
    let texts = |event: &&Event| matches!(event, Event::Text(_));
    let texts: Vec<Event> = outline.tree().events.iter().filter(texts).cloned().collect();
    assert_eq!(texts, [Event::Text("7".into())]);
}

#[test]
fn keys_have_the_names_of_the_browser() {
    assert_eq!(key_of("ArrowLeft"), Some(Key::ArrowLeft));
    assert_eq!(key_of(" "), Some(Key::Space));
    assert_eq!(key_of("KeyA"), Some(Key::A));
    assert_eq!(key_of("Digit7"), Some(Key::Num7));
    assert_eq!(key_of("Unidentified"), None);
}

#[test]
fn button_stays_a_button_while_what_it_opens_is_shown() {
    let (ctx, _outline) = told_outline();
    let show = |is_open: bool, ui: &mut Ui| {
        let opener = ui.button("Pose jump");
        egui::Popup::from_response(&opener).open(is_open).show(|ui| {
            ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
                node.set_role(Role::Dialog);
                node.set_label("Explanation");
            });
            ui.label("How far a joint turns in one frame.");
        });
    };
    let closed = frame(&ctx, |ui| show(false, ui)).expect("all elements");
    let number = number_of(&closed, "button", "Pose jump");
    // egui measures a popup in its first frame, and shows it in its second.
    let open: Vec<_> = (0..2).filter_map(|_| frame(&ctx, |ui| show(true, ui))).collect();
    let dialog = open.iter().find(|changes| find(changes, "dialog", "Explanation").is_some());
    assert!(dialog.is_some(), "{open:?}");
    for changes in &open {
        let mut elements = changes["elements"].as_array().expect("elements").iter();
        let opener = elements.find(|element| element["number"] == number);
        assert!(opener.is_none_or(|opener| opener["role"] == "button"), "{changes}");
        assert_eq!(changes["gone"].as_array().map(Vec::len), Some(0), "{changes}");
    }
}
