//! Costs below each other, each divided into its parts.

use super::assistive::describe;
use super::paint::{Run, focus_ring, full_width, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, Rangef, Rect, Role, Sense, Ui, WidgetInfo, pos2, vec2,
};
use segue_text::Message;

/// One cost.
#[derive(Clone, Debug)]
pub(crate) struct CostRow {
    /// The thing that has the cost.
    pub(crate) name: Message,
    /// Its parts, in the order of the names.
    pub(crate) parts: Vec<f32>,
    /// It stands out: it plays, or was chosen.
    pub(crate) strong: bool,
    /// Whether it is shown on the stage.
    pub(crate) shown: bool,
}

/// Costs and the names of their parts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CostBars<'a> {
    /// The rows, the first for comparison.
    pub(crate) rows: &'a [CostRow],
    /// The names of the parts, with their colours.
    pub(crate) parts: &'a [(Word, Color32)],
}

/// The pointer's input to the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CostResponse {
    /// The row under it.
    pub(crate) hovered: Option<usize>,
    /// The row that was pressed.
    pub(crate) clicked: Option<usize>,
}

/// Draws the rows on one scale, and a legend of the colours below.
pub(crate) fn cost_bars_ui(bars: &CostBars<'_>, ui: &mut Ui) -> CostResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let mut found = CostResponse::default();
    let total = |row: &CostRow| row.parts.iter().sum::<f32>();
    let most = bars.rows.iter().map(total).fold(0.0, f32::max).max(1e-6);
    // The costs of a steady walk are tiny, those of a turn are large.
    let decimals = if most < 0.2 { 3 } else { 2 };
    let spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 2.0);
    for (index, row) in bars.rows.iter().enumerate() {
        let rect = full_width((34.0 * theme.scale()).max(theme.hit()).round(), ui);
        let response = ui
            .interact(rect, ui.make_persistent_id(("cost", index)), Sense::click())
            .on_hover_cursor(CursorIcon::PointingHand);
        let cost = format!("{:.decimals$}", total(row));
        let said = format!("{}: {cost}", say(&row.name, ui));
        describe(&response, &WidgetInfo::selected(Role::Button, true, row.shown, said));
        if response.clicked() {
            found.clicked = Some(index);
        }
        if response.hovered() || response.has_focus() {
            found.hovered = Some(index);
        }
        if row.shown || response.hovered() {
            let ground = if row.shown { palette.accent_wash } else { palette.hover };
            ui.painter().rect_filled(rect.expand2(vec2(4.0, 0.0)), radius::S, ground);
        }
        let step = if row.strong { Type::SmallStrong } else { Type::Small };
        let ink = if row.strong { palette.text } else { palette.muted };
        let number = line_of(&[Run::new(Text::Data(&cost), step, ink)], f32::INFINITY, ui);
        let first = rect.top() + 0.28 * rect.height();
        let number = put(ui.painter(), pos2(rect.right(), first), Align2::RIGHT_CENTER, number);
        let name =
            line_of(&[Run::new(&row.name, step, ink)], number.left() - rect.left() - space::S, ui);
        put(ui.painter(), pos2(rect.left(), first), Align2::LEFT_CENTER, name);
        let y = Rangef::new(rect.top() + 0.58 * rect.height(), rect.bottom() - 5.0);
        ui.painter().rect_filled(
            Rect::from_x_y_ranges(rect.x_range(), y),
            radius::S / 2,
            palette.track,
        );
        let mut left = rect.left();
        for (part, (_, color)) in row.parts.iter().zip(bars.parts) {
            let right = left + part / most * rect.width();
            ui.painter().rect_filled(Rect::from_x_y_ranges(left..=right, y), 0.0, *color);
            left = right;
        }
        focus_ring(rect, radius::S, &response, ui);
    }
    ui.spacing_mut().item_spacing.y = spacing;
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::M, 2.0);
        for (name, color) in bars.parts {
            let galley = line_of(&[Run::new(*name, Type::Small, palette.muted)], f32::INFINITY, ui);
            let (_, rect) = ui.allocate_space(galley.size() + vec2(12.0, 0.0));
            let square =
                Rect::from_center_size(pos2(rect.left() + 4.0, rect.center().y), vec2(8.0, 8.0));
            ui.painter().rect_filled(square, 2, *color);
            put(ui.painter(), rect.left_center() + vec2(12.0, 0.0), Align2::LEFT_CENTER, galley);
        }
    });
    found
}
