//! Tabs side by side, with a menu where there is no room for all.

use super::assistive::{describe, set_role};
use super::button::{Button, button_ui};
use super::icon::Icon;
use super::menu::{MenuItem, menu_item_ui, menu_ui};
use super::paint::{Run, focus_ring, line_of, put};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, RectAlign, Response, Role, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, vec2,
};

/// The least number of tabs beside a menu: with fewer, the chosen one alone is clearer.
const MIN_TABS: usize = 3;

/// Draws tabs in one line, `width` points at most. Those without room are in a menu at the right
/// end; the chosen one is always among the tabs. Where hardly any have room, the chosen one alone
/// is shown, with all in its menu. `name` and `more` are the accessible names of the tabs and of
/// the menu with the rest. Returns a new choice.
pub(crate) fn tabs_ui<T: Copy + PartialEq>(
    [name, more]: [Word; 2],
    chosen: T,
    options: &[(T, Word)],
    width: f32,
    ui: &mut Ui,
) -> Option<T> {
    let theme = theme_of(ui);
    let pad = 10.0 * theme.scale();
    let size_of = |text: Word| {
        line_of(&[Run::new(text, Type::Strong, Color32::PLACEHOLDER)], f32::INFINITY, ui).size().x
            + 2.0 * pad
    };
    let widths: Vec<f32> = options.iter().map(|option| size_of(option.1).ceil()).collect();
    let at = options.iter().position(|option| option.0 == chosen).unwrap_or(0);
    // The button of the menu is as wide as it is high, and has a gap of its own.
    let shown = fitting(&widths, at, width, theme.row_height() + space::S);
    let mut picked = None;
    if shown.len() < MIN_TABS.min(options.len()) {
        let current = options.get(at).map_or(Word::default(), |option| option.1);
        let opener = button_ui(Button::new(current).trailing(Icon::ChevronDown).name(name), ui);
        picked = menu_of(&opener, chosen, options.iter().copied());
        return picked.filter(|&value| value != chosen);
    }
    ui.spacing_mut().item_spacing.x = GAP;
    ui.scope(|ui| {
        set_role(Role::TabList, name, ui);
        for &index in &shown {
            let (Some(&(value, text)), Some(&width)) = (options.get(index), widths.get(index))
            else {
                continue;
            };
            if tab_ui(text, width, value == chosen, ui) {
                picked = Some(value);
            }
        }
    });
    if shown.len() < options.len() {
        let opener = button_ui(Button::icon_only(Icon::ChevronDown, more).quiet(), ui);
        let rest = options.iter().copied().enumerate().filter(|(index, _)| !shown.contains(index));
        picked = picked.or(menu_of(&opener, chosen, rest.map(|(_, option)| option)));
    }
    picked.filter(|&value| value != chosen)
}

/// The gap between two tabs, points.
const GAP: f32 = 2.0;

/// Returns the tabs that have room, in order: all of them, or as many of the first as fit beside a
/// menu of the width `rest`. The last of these gives way to the chosen one, if it is not among
/// them.
fn fitting(widths: &[f32], chosen: usize, width: f32, rest: f32) -> Vec<usize> {
    let needed = |tabs: &[usize]| {
        tabs.iter().filter_map(|&tab| widths.get(tab)).map(|width| width + GAP).sum::<f32>() - GAP
    };
    let all: Vec<usize> = (0..widths.len()).collect();
    if needed(&all) <= width {
        return all;
    }
    for count in (1..widths.len()).rev() {
        let mut tabs: Vec<usize> = (0..count).collect();
        if chosen >= count {
            tabs[count - 1] = chosen;
        }
        if needed(&tabs) + GAP + rest <= width {
            return tabs;
        }
    }
    Vec::new()
}

fn tab_ui(text: Word, width: f32, is_chosen: bool, ui: &mut Ui) -> bool {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let (rect, response) = ui.allocate_exact_size(vec2(width, theme.row_height()), Sense::click());
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    if is_chosen {
        let line = Stroke::new(theme.hairline(), palette.line);
        ui.painter().rect(rect, radius::M, palette.panel_raised, line, StrokeKind::Inside);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, radius::M, palette.hover);
    }
    let ink = if is_chosen || response.hovered() { palette.text } else { palette.muted };
    let step = if is_chosen { Type::Strong } else { Type::Body };
    let galley = line_of(&[Run::new(text, step, ink)], f32::INFINITY, ui);
    put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    focus_ring(rect, radius::M, &response, ui);
    let name = say(text, ui);
    describe(&response, &WidgetInfo::selected(Role::Tab, ui.is_enabled(), is_chosen, name));
    response.clicked()
}

fn menu_of<T: Copy + PartialEq>(
    opener: &Response,
    chosen: T,
    options: impl Iterator<Item = (T, Word)>,
) -> Option<T> {
    let mut picked = None;
    menu_ui(opener, RectAlign::BOTTOM_START, |ui| {
        for (value, text) in options {
            let item = MenuItem {
                text: text.into(),
                chosen: Some(value == chosen),
                ..MenuItem::default()
            };
            if menu_item_ui(item, ui).clicked() {
                picked = Some(value);
            }
        }
    });
    picked
}

#[cfg(test)]
mod tests {
    use super::fitting;

    #[test]
    fn tabs_that_fit_include_the_chosen_one() {
        let widths = [50.0; 10];
        let all = 10.0 * 50.0 + 9.0 * 2.0;
        assert_eq!(fitting(&widths, 0, all, 30.0).len(), 10);
        // 6 tabs and the menu need 342 points.
        assert_eq!(fitting(&widths, 2, 342.0, 30.0), [0, 1, 2, 3, 4, 5]);
        assert_eq!(fitting(&widths, 8, 342.0, 30.0), [0, 1, 2, 3, 4, 8]);
        assert_eq!(fitting(&widths, 8, 341.0, 30.0), [0, 1, 2, 3, 8]);
        assert_eq!(fitting(&widths, 8, 90.0, 30.0), [8]);
        assert!(fitting(&widths, 8, 40.0, 30.0).is_empty());
        assert!(fitting(&[], 0, 40.0, 30.0).is_empty());
    }
}
