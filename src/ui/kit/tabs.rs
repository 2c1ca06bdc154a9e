//! The labs, side by side; behind a menu where there is no room for all.

use super::button::{Button, button_ui};
use super::icon::Icon;
use super::menu::{MenuItem, menu_item_ui, menu_ui};
use super::paint::{Run, focus_ring, line_of, put};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align2, Color32, CursorIcon, RectAlign, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, vec2};

/// Tabs in one line, `width` points at most: if they need more, the chosen one alone, with the others in its menu.
/// What was chosen anew.
pub(crate) fn tabs_ui<T: Copy + PartialEq>(name: &str, chosen: T, options: &[(T, &str)], width: f32, ui: &mut Ui) -> Option<T> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let pad = 10.0 * theme.scale();
    let gap = 2.0;
    let size_of = |text: &str| {
        line_of(&[Run::new(text, Type::Strong, Color32::PLACEHOLDER)], f32::INFINITY, ui)
            .size()
            .x
            + 2.0 * pad
    };
    let widths: Vec<f32> = options.iter().map(|option| size_of(option.1).ceil()).collect();
    let needed = widths.iter().sum::<f32>() + gap * options.len().saturating_sub(1) as f32;
    let mut picked = None;
    if needed > width {
        let current = options.iter().find(|option| option.0 == chosen).map_or("", |option| option.1);
        let opener = button_ui(Button::new(current).trailing(Icon::ChevronDown).name(name), ui);
        menu_ui(&opener, RectAlign::BOTTOM_START, |ui| {
            for &(value, text) in options {
                if menu_item_ui(
                    MenuItem {
                        text,
                        chosen: value == chosen,
                        ..MenuItem::default()
                    },
                    ui,
                )
                .clicked()
                {
                    picked = Some(value);
                }
            }
        });
        return picked.filter(|&value| value != chosen);
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.x = gap;
        for (&(value, text), &width) in options.iter().zip(&widths) {
            let (rect, response) = ui.allocate_exact_size(vec2(width, theme.row_height()), Sense::click());
            let response = response.on_hover_cursor(CursorIcon::PointingHand);
            let is_chosen = value == chosen;
            if is_chosen {
                let line = Stroke::new(theme.hairline(), palette.line);
                ui.painter().rect(rect, radius::M, palette.panel_raised, line, StrokeKind::Inside);
            } else if response.hovered() {
                ui.painter().rect_filled(rect, radius::M, palette.hover);
            }
            let ink = if is_chosen || response.hovered() {
                palette.text
            } else {
                palette.muted
            };
            let step = if is_chosen { Type::Strong } else { Type::Body };
            let galley = line_of(&[Run::new(text, step, ink)], f32::INFINITY, ui);
            put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
            focus_ring(rect, radius::M, &response, ui);
            response.widget_info(|| WidgetInfo::selected(Role::Tab, ui.is_enabled(), is_chosen, text));
            if response.clicked() {
                picked = Some(value);
            }
        }
    });
    ui.add_space(-space::XS);
    picked.filter(|&value| value != chosen)
}
