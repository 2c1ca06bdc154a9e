//! Something known that cannot be changed: its name, and its value with its unit.

use super::paint::{Run, full_width, line_of, put};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align2, Role, Sense, Ui, WidgetInfo};

/// A label at the left, a value and its unit at the right.
pub(crate) fn fact_row_ui(label: &str, value: &str, unit: &str, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let row = full_width((24.0 * theme.scale()).round(), ui);
    let mut runs = vec![Run::new(value, Type::Number, palette.text)];
    if !unit.is_empty() {
        runs.push(Run::new(unit, Type::Body, palette.muted).after(space::XS));
    }
    put(ui.painter(), row.right_center(), Align2::RIGHT_CENTER, line_of(&runs, row.width() * 0.6, ui));
    let name = line_of(&[Run::new(label, Type::Label, palette.muted)], row.width() * 0.5, ui);
    put(ui.painter(), row.left_center(), Align2::LEFT_CENTER, name);
    let response = ui.interact(row, ui.make_persistent_id(("fact", label)), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("{label} {value} {unit}")));
}
