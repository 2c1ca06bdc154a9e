//! The zone where files are dropped or opened.

use super::button::link_ui;
use super::paint::{Run, line_of, paragraph, put};
use crate::ui::language::{Text, Word};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align, Align2, Color32, Layout, Rect, Shape, Stroke, Ui, UiBuilder, pos2, vec2,
};
use std::f32::consts::FRAC_PI_2;

/// Draws a dashed field with a sentence and links below it. `hot`: whether files are held over the
/// window. Returns the link that was pressed.
pub(crate) fn drop_zone_ui(
    sentence: Word,
    links: &[Word],
    hot: bool,
    ui: &mut Ui,
) -> Option<usize> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let width = ui.available_width();
    let ink = if hot { palette.accent_ink } else { palette.muted };
    let text = paragraph(sentence, Type::Body, ink, width - 2.0 * space::M, ui);
    let link_height = theme.row_height();
    let height = (text.size().y + link_height + 2.0 * space::M).round();
    let (_, rect) = ui.allocate_space(vec2(width, height));
    if hot {
        ui.painter().rect_filled(rect, radius::L, palette.accent_wash);
    }
    let line = if hot { palette.accent } else { palette.line_strong };
    dashed_rect(rect.shrink(0.5), f32::from(radius::L), Stroke::new(theme.hairline(), line), ui);
    // A galley is aligned to the left; a sentence in two lines is short enough to be centred as a
    // block.
    let text_rect =
        put(ui.painter(), pos2(rect.center().x, rect.top() + space::M), Align2::CENTER_TOP, text);

    let dot = line_of(&[Run::new(Text::Data("·"), Type::Body, palette.muted)], f32::INFINITY, ui);
    let widths = links.iter().map(|link| {
        line_of(&[Run::new(*link, Type::Body, Color32::PLACEHOLDER)], f32::INFINITY, ui).size().x
    });
    let gaps = links.len().saturating_sub(1) as f32 * (dot.size().x + 2.0 * space::S);
    let total = widths.sum::<f32>() + gaps;
    let row = Rect::from_center_size(
        pos2(rect.center().x, text_rect.bottom() + link_height / 2.0),
        vec2(total.min(width), link_height),
    );
    let mut pressed = None;
    let builder = UiBuilder::new()
        .id_salt(sentence.english())
        .max_rect(row)
        .layout(Layout::left_to_right(Align::Center));
    // The links get a child of their own: the zone's space is already allocated.
    let mut inner = ui.new_child(builder);
    inner.spacing_mut().item_spacing.x = space::S;
    for (index, link) in links.iter().enumerate() {
        if index > 0 {
            let (_, at) = inner.allocate_space(dot.size());
            put(inner.painter(), at.center(), Align2::CENTER_CENTER, dot.clone());
        }
        if link_ui(Text::Word(*link), &mut inner).clicked() {
            pressed = Some(index);
        }
    }
    pressed
}

/// Draws the outline of a rectangle with round corners, in dashes.
fn dashed_rect(rect: Rect, corner: f32, stroke: Stroke, ui: &Ui) {
    let mut path = Vec::new();
    let corners = [
        (pos2(rect.right() - corner, rect.top() + corner), -FRAC_PI_2),
        (pos2(rect.right() - corner, rect.bottom() - corner), 0.0),
        (pos2(rect.left() + corner, rect.bottom() - corner), FRAC_PI_2),
        (pos2(rect.left() + corner, rect.top() + corner), 2.0 * FRAC_PI_2),
    ];
    for (center, from) in corners {
        for step in 0..=6_u8 {
            let angle = from + FRAC_PI_2 * f32::from(step) / 6.0;
            path.push(center + corner * vec2(angle.cos(), angle.sin()));
        }
    }
    path.extend(path.first().copied());
    ui.painter().extend(Shape::dashed_line(&path, stroke, 4.0, 4.0));
}
