//! The kit laid out as a whole lab. With `SEGUE_GALLERY` set to a folder, pictures are written
//! there.

mod fixtures;

use crate::ui::theme::Theme;
use eframe::egui::{self, Rect, UiBuilder, Vec2, pos2, vec2};
use egui_kittest::{
    Harness,
    kittest::{NodeT as _, Queryable as _},
};
use fixtures::{Mock, lab_ui};

fn harness(size: Vec2, theme: Theme, mock: Mock) -> Harness<'static, Mock> {
    let builder = Harness::builder()
        .with_size(size)
        .with_max_steps(40)
        .with_context_setup(move |ctx| theme.install(ctx));
    builder
        .with_theme(if theme.dark { egui::Theme::Dark } else { egui::Theme::Light })
        .build_ui_state(
            move |ui, mock: &mut Mock| {
                let rect = ui.ctx().content_rect();
                ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| lab_ui(mock, ui));
            },
            mock,
        )
}

/// Writes a picture if pictures are wanted. They are to be looked at, not compared: rasterisers
/// differ.
fn picture(name: &str, harness: &mut Harness<'_, Mock>) {
    if let Some(folder) = std::env::var_os("SEGUE_GALLERY") {
        let image = harness.render().expect("a rasteriser");
        image
            .save(std::path::Path::new(&folder).join(format!("{name}.png")))
            .expect("a folder that can be written to");
    }
}

const DESK: Vec2 = vec2(1440.0, 900.0);
const DARK: Theme = Theme { dark: true, projector: false, presents: false, touch: false };
const LIGHT: Theme = Theme { dark: false, ..DARK };

/// Checks that every named widget lies within the window.
fn assert_nothing_sticks_out(size: Vec2, harness: &Harness<'_, Mock>) {
    let window = Rect::from_min_size(pos2(0.0, 0.0), size).expand(1.0);
    for name in ["Blend window", "Play", "Timeline", "Align to A", "dissolve"] {
        let rect = harness.get_by_label(name).rect();
        assert!(
            rect.left() >= window.left() && rect.right() <= window.right(),
            "{name} at {rect:?} in {size:?}"
        );
        assert!(
            rect.height() >= 24.0 && rect.width() >= 24.0,
            "{name} is too small to be hit: {rect:?}"
        );
    }
}

#[test]
fn lab_fits_desk_projector_and_phone() {
    let hall = Theme { projector: true, ..DARK };
    let places = [
        ("desk-dark", DESK, DARK),
        ("desk-light", DESK, LIGHT),
        ("projector", vec2(1280.0, 720.0), hall),
        ("phone", vec2(390.0, 844.0), DARK),
        ("phone-light", vec2(390.0, 844.0), LIGHT),
    ];
    for (name, size, theme) in places {
        let mut harness = harness(size, theme, Mock::default());
        harness.run();
        assert_nothing_sticks_out(size, &harness);
        picture(name, &mut harness);
    }
}

#[test]
fn menus_notices_and_hovers_are_drawn() {
    let mut mock = Mock::default();
    (mock.notices, mock.caption) = (true, false);
    let mut harness = harness(DESK, DARK, mock);
    harness.run();
    harness.get_by_label("Compare · 3").click();
    harness.run();
    assert!(harness.get_by_label("Three windows").accesskit_node().is_selected().is_none());
    harness.hover_at(pos2(620.0, 800.0));
    harness.run();
    picture("open-dark", &mut harness);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Three windows").is_none());
    harness.get_by_label("Blend window").focus();
    harness.key_press(egui::Key::ArrowRight);
    let name = harness.get_by_label_contains("idle, 3.3").rect();
    harness.hover_at(name.center());
    harness.run();
    picture("focus-dark", &mut harness);
    assert_eq!(harness.state().window, 31.0);
}
