//! The panels of single labs.

use super::*;

#[test]
fn blend_of_two_skeletons_names_unmatched_joints() {
    let page = with_file("lab=blend&b=run&play=off");
    assert_eq!(outcome(&page).retargeted.as_ref().unwrap().unmatched, ["Tail"]);
    for (name, size, theme) in
        [("retarget-desk-light", DESK, LIGHT), ("retarget-phone-dark", PHONE, DARK)]
    {
        let mut harness = harness(size, theme, with_file("lab=blend&b=run&play=off"));
        harness.get_by_label("B is retargeted to A's skeleton; not matched: Tail.");
        picture(name, &mut harness);
    }
    assert!(outcome(&self::page("lab=blend&play=off")).retargeted.is_none());
}

#[test]
fn speed_beyond_both_clips_has_a_warning() {
    for (name, size, theme, link) in [
        ("speed-desk-dark", DESK, DARK, "lab=speed&play=off&t=1"),
        ("speed-desk-light", DESK, LIGHT, "lab=speed&speed=9&foot_lock=on&play=off"),
        ("speed-compare-desk-dark", DESK, DARK, "lab=speed&compare=speed:1.4,2.2,3.9&play=off"),
        ("speed-phone-dark", PHONE, DARK, "lab=speed&play=off"),
        ("speed-projector", vec2(1280.0, 720.0), HALL, "lab=speed&play=off"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label(text::SPEED_ABOUT.english());
        assert_eq!(
            harness.query_all_by_label_contains("Too far outside the speeds").count(),
            usize::from(link.contains("speed=9"))
        );
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=speed&play=off"));
    press("A, midway, B", &mut harness);
    assert_eq!(compared(&harness), "speed:1.4,2.45,3.5");
    let back = harness.get_by_label("One pane").rect();
    assert!(
        back.right() < DESK.x - space::M,
        "the row of buttons is as wide as the panel at most: {back:?}"
    );
    press("One pane", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    assert_eq!(harness.state().session.params().number(Key::Speed), 1.4, "as the first pane was");
}

#[test]
fn lock_rows_are_shown_while_feet_are_locked() {
    let rows = ["Lock blend", "Lock reach", "Swing clearance"];
    let mut harness = harness(DESK, DARK, page("lab=blend&play=off"));
    press(text::FEET.english(), &mut harness);
    assert!(harness.query_by_label("Contact height").is_some());
    assert!(rows.iter().all(|row| harness.query_by_label(row).is_none()));
    press("Foot lock", &mut harness);
    for row in rows {
        let slider = harness.get_by_label(row);
        assert!(slider.rect().height() > 0.0, "{row}");
    }
}

#[test]
fn loop_lab_describes_its_cut_and_method() {
    for (name, size, theme, link) in [
        ("loop-desk-dark", DESK, DARK, "lab=loop&play=off&t=1"),
        (
            "loop-desk-light",
            DESK,
            LIGHT,
            "lab=loop&a=walk_left&loop_method=linear&loop_from=0.5&foot_lock=on&play=off",
        ),
        (
            "loop-compare-desk-dark",
            DESK,
            DARK,
            "lab=loop&compare=loop_method:exact,end,both&play=off",
        ),
        ("loop-phone-dark", PHONE, DARK, "lab=loop&play=off"),
    ] {
        let mut harness = harness(size, theme, page(link));
        harness.get_by_label_contains("Makes a seamless loop");
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=loop&play=off"));
    // The help of the method is about the chosen one.
    press("Method: help", &mut harness);
    harness.get_by_label_contains("solved so that pose and velocity match");
    press("Compare methods", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 3);
    press("Compare methods", &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    // The keys of the labs follow the tabs.
    harness.key_press(Keyboard::Num5);
    harness.run();
    assert_eq!(harness.state().session.params().lab().word(), "speed");
}

#[test]
fn layers_lab_describes_timing_and_mask() {
    for (name, size, theme, link) in [
        ("layers-desk-dark", DESK, DARK, "lab=layers&play=off&t=1"),
        ("layers-additive-light", DESK, LIGHT, "lab=layers&layer_mode=additive&b=jump&play=off"),
        ("layers-compare-dark", DESK, DARK, "lab=layers&compare=layer_weight:1,0.5,0.33&play=off"),
        ("layers-phone-dark", PHONE, DARK, "lab=layers&play=off"),
    ] {
        let page = page(link);
        let sentence = text::fit(outcome(&page).layer().expect("a layer")).to_string();
        let additive = link.contains("additive");
        assert_eq!(sentence.starts_with("There are no steps"), additive, "{sentence}");
        let mut harness = harness(size, theme, page);
        harness.get_by_label(&sentence);
        // Parameters of another kind of layer are not shown.
        assert_eq!(harness.query_by_label("Keep B's posture").is_none(), additive);
        assert_eq!(harness.query_by_label("first frame").is_some(), additive);
        picture(name, &mut harness);
    }
    let mut harness = harness(DESK, DARK, page("lab=layers&play=off"));
    press("additive", &mut harness);
    press("Mask", &mut harness);
    press("left arm", &mut harness);
    let params = harness.state().session.params();
    assert_eq!(
        (params.choice::<choices::LayerMode>().word(), params.choice::<choices::Mask>().word()),
        ("additive", "left_arm")
    );
    harness.get_by_label("first frame");
}

#[test]
fn note_of_a_panel_is_selected_and_copied() {
    let mut harness = harness(DESK, DARK, page("lab=speed&play=off"));
    let note = "A: 1.41 m/s · B: 3.50 m/s";
    harness.get_by_label(note).scroll_to_me();
    harness.run();
    let rect = harness.get_by_label(note).rect();
    select(rect.left_center() + vec2(1.0, 0.0), rect.right_center(), &mut harness);
    assert_eq!(copied(&mut harness), note);
}

#[test]
fn mistake_is_explained_and_compared_with_the_right_way() {
    let mut harness = harness(DESK, DARK, page("lab=transition&play=off&t=2.3"));
    assert!(harness.query_by_label(text::RIGHT_AND_WRONG.english()).is_none());
    press("Break it", &mut harness);
    press("Euler angles blended", &mut harness);
    harness.get_by_label(text::mistake(Mistake::Euler).english());
    picture("break-desk-dark", &mut harness);
    press(text::RIGHT_AND_WRONG.english(), &mut harness);
    assert_eq!(harness.state().session.panes().len(), 2);
    assert_eq!(compared(&harness), "mistake:none,euler");
    harness.get_by_label(text::mistake(Mistake::Euler).english());
    picture("break-compare-dark", &mut harness);
    press(text::RIGHT_AND_WRONG.english(), &mut harness);
    assert_eq!(harness.state().session.panes().len(), 1);
    // For a cut, the panel says that the mistake has no effect.
    let cut =
        self::harness(DESK, LIGHT, page("lab=transition&method=cut&mistake=degrees&play=off"));
    cut.get_by_label(text::MISTAKE_IDLE.english());
    let dissolve =
        self::harness(DESK, DARK, page("lab=transition&method=smooth&mistake=velocity&play=off"));
    dissolve.get_by_label(text::VELOCITY_IN_DISSOLVE.english());
    let turned =
        self::harness(PHONE, LIGHT, page("lab=transition&method=cut&mistake=atan&play=off"));
    turned.get_by_label(text::mistake(Mistake::Atan).english());
}

#[test]
fn mistake_of_any_kind_has_a_description() {
    for &mistake in Mistake::ALL {
        assert_eq!(text::mistake(mistake).is_empty(), mistake == Mistake::None, "{mistake:?}");
    }
}

#[test]
fn hysteresis_shows_the_rows_of_its_choice() {
    for (link, bias, time) in [
        ("hysteresis=bias", true, false),
        ("hysteresis=time", false, true),
        ("compare=hysteresis:bias,time", true, true),
    ] {
        let mut harness = harness(
            vec2(1440.0, 2400.0),
            DARK,
            page(&format!("lab=match&scenario=straight&{link}&play=off")),
        );
        harness.run_steps(2);
        let has = |key: Key| harness.query_by_label(key.param().label).is_some();
        assert_eq!((has(Key::BiasShare), has(Key::MinimumTime)), (bias, time), "{link}");
    }
}

/// Returns the first frames of the built-in walk as a file.
fn short_file(frames: usize) -> String {
    let walk = page("lab=view&a=walk").session.slot(Slot::A).and_then(|entry| entry.motion.clone());
    let options = segue_formats::bvh::WriteOptions::default();
    let text = segue_formats::bvh::write(walk.expect("a built-in clip").clip(), &options);
    let (head, rest) = text.split_once("Frames: ").expect("a BVH file");
    let mut lines = rest.lines();
    lines.next();
    let kept: Vec<&str> = lines.take(1 + frames).collect();
    format!("{head}Frames: {frames}\n{}\n", kept.join("\n"))
}

/// No window is longer than the shorter clip, whichever that is.
#[test]
fn slider_of_a_window_ends_with_the_shorter_clip() {
    const FRAMES: usize = 90;
    let file = short_file(FRAMES);
    for (link, label, set, used) in [
        ("lab=blend&blend_window=240", "Blend window", 240.0, FRAMES as f64),
        ("lab=transition&method=smooth&blend_window=240", "Blend window", 240.0, FRAMES as f64),
        // A registration is refused until the window is lowered.
        ("lab=register&registration_window=121", "Window", 121.0, 121.0),
    ] {
        for slot in [Slot::A, Slot::B] {
            let mut page = page(&format!("{link}&a=walk&b=run&play=off"));
            page.session.load("short.bvh", Arc::from(file.as_bytes())).expect("a BVH file");
            let id = loaded(&page).id.clone();
            page.session.apply(Command::Assign(slot, id)).expect("a clip of the library");
            while page.session.work() {}
            let harness = harness(DESK, DARK, page);
            let params = harness.state().session.params();
            let key = if used == set { Key::RegistrationWindow } else { Key::BlendWindow };
            assert_eq!(params.number(key), set, "what is set stays");
            let slider = harness.get_by_role_and_label(Role::Slider, label);
            let node = slider.accesskit_node();
            let shown = (node.max_numeric_value(), node.numeric_value());
            assert_eq!(shown, (Some(FRAMES as f64), Some(used)), "{link}, {slot:?}");
        }
    }
}

#[test]
fn clip_on_another_body_has_weights_and_a_table_of_errors() {
    for (name, size, theme) in
        [("edit-body-desk-dark", DESK, DARK), ("edit-body-phone-light", PHONE, LIGHT)]
    {
        let page = page("lab=edit&a=run&edit_body=edit(a:walk,scale:1.2)&play=off&t=0.5");
        let mut harness = harness(size, theme, page);
        harness.get_by_label("Weight of feet");
        harness.get_by_label("Weight of hands");
        press(text::RETARGET_ERRORS.english(), &mut harness);
        for line in ["Left foot error 0 cm", "Right hand error", "Slide per stance 0 cm"] {
            harness.get_by_label_contains(line);
        }
        picture(name, &mut harness);
        press(text::OWN_BODY.english(), &mut harness);
        assert!(harness.state().session.params().clip_ids(Key::EditBody).is_empty());
        assert!(harness.query_by_label("Weight of feet").is_none());
    }
}
