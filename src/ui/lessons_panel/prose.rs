//! Running text with bold and italic words, formulas and links. It can be selected and copied,
//! across paragraphs too.

use super::maths::{Place, parts_of};
use crate::ui::kit::describe;
use crate::ui::out::{Action, Out};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::text_selection::LabelSelectionState;
use eframe::egui::{
    Align, Color32, CursorIcon, FontId, Frame, Galley, Label, Margin, Pos2, Rect, Response, Role,
    Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use segue_session::Command;
use segue_session::lesson::{Block, Span, Target, host_of};
use std::ops::Range;

/// Draws the blocks of a text, one below the other.
pub(super) fn blocks_ui(blocks: &[Block], step: Type, out: &mut Out, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = space::S;
    for block in blocks {
        match block {
            Block::Heading(words) => {
                ui.add_space(space::XS);
                let spans = [Span::plain(words.as_str())];
                Prose::new(&spans, Type::Strong, false, ui).show(Sense::hover(), ui);
            }
            // A displayed formula.
            Block::Paragraph(spans) if spans.iter().all(|span| span.code) => {
                formula_ui(spans, step, ui);
            }
            Block::Paragraph(spans) => spans_ui(spans, step, false, out, ui),
            Block::Item { depth, number, spans } => {
                ui.horizontal_top(|ui| {
                    ui.spacing_mut().item_spacing.x = space::S;
                    ui.add_space(space::L * *depth as f32);
                    let sign = number.map_or_else(|| "•".to_owned(), |number| format!("{number}."));
                    Prose::new(&[Span::plain(sign)], step, true, ui).show(Sense::hover(), ui);
                    ui.vertical(|ui| spans_ui(spans, step, false, out, ui));
                });
            }
            Block::Code(lines) => {
                let code = Span { code: true, ..Span::plain(lines.as_str()) };
                formula_ui(&[code], step, ui);
            }
        }
    }
}

/// Draws lines of a formula on a ground of their own.
fn formula_ui(spans: &[Span], step: Type, ui: &mut Ui) {
    let frame = Frame::new().fill(palette_of(ui).panel_raised).corner_radius(radius::S);
    frame.inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        let mut formula = Prose::new(spans, step, false, ui);
        formula.codes.clear();
        formula.show(Sense::hover(), ui);
    });
}

/// Draws one paragraph. A link to a state sets it. A link to the web opens another window, and has
/// its host beside it.
pub(super) fn spans_ui(spans: &[Span], step: Type, muted: bool, out: &mut Out, ui: &mut Ui) {
    if spans.iter().all(|span| span.target.is_none()) {
        Prose::new(spans, step, muted, ui).show(Sense::hover(), ui);
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for run in spans.chunk_by(|a, b| a.target == b.target) {
            let prose = Prose::new(run, step, muted, ui);
            let Some(target) = run.first().and_then(|span| span.target.as_ref()) else {
                prose.show(Sense::hover(), ui);
                continue;
            };
            let response = prose.show(Sense::click(), ui).on_hover_cursor(CursorIcon::PointingHand);
            let clicked = response.clicked();
            match target {
                Target::State(query) if clicked => out.commands.push(Command::Try(query.clone())),
                Target::State(_) => {}
                Target::Web(address) => {
                    response.on_hover_text(address);
                    if clicked {
                        out.actions.push(Action::OpenPage(address.clone()));
                    }
                    // The text of a link may be another address.
                    if run.iter().map(|span| span.text.as_str()).collect::<String>() != *address {
                        let host = Span::plain(format!(" ({})", host_of(address)));
                        Prose::new(&[host], step, true, ui).show(Sense::hover(), ui);
                    }
                }
            }
        }
    });
}

/// A text that is ready to be laid out, with the places of formulas and values in it.
struct Prose {
    job: LayoutJob,
    /// The letters of each formula.
    codes: Vec<Range<usize>>,
}

impl Prose {
    fn new(spans: &[Span], step: Type, muted: bool, ui: &Ui) -> Self {
        let (mut job, mut codes, mut letters) = (LayoutJob::default(), Vec::new(), 0);
        for span in spans {
            let format = format(span, step, muted, ui);
            let count = span.text.chars().count();
            if span.code {
                codes.push(letters..letters + count);
                for part in parts_of(&span.text) {
                    let format = placed(format.clone(), part.place, part.is_quantity);
                    job.append(part.text, 0.0, format);
                }
            } else {
                job.append(&span.text, 0.0, format);
            }
            letters += count;
        }
        Self { job, codes }
    }

    /// Draws the text, which can be selected.
    fn show(self, sense: Sense, ui: &mut Ui) -> Response {
        let is_link = sense != Sense::hover();
        let label = Label::new(self.job).selectable(true).sense(sense);
        let (at, galley, response) = label.layout_in_ui(ui);
        let role = if is_link { Role::Link } else { Role::Label };
        describe(&response, &WidgetInfo::labeled(role, ui.is_enabled(), galley.text()));
        if ui.is_rect_visible(response.rect) {
            let palette = palette_of(ui);
            for code in &self.codes {
                for ground in grounds(code, at, &galley) {
                    ui.painter().rect_filled(ground, radius::S, palette.panel_raised);
                }
            }
            let focus = if response.has_focus() {
                Stroke::new(1.0, palette.accent_ink)
            } else {
                Stroke::NONE
            };
            LabelSelectionState::label_text_selection(
                ui,
                &response,
                at,
                galley,
                palette.text,
                focus,
            );
        }
        response
    }
}

/// Returns the grounds of some letters of a text, one for each line that they stand on, of one
/// height whatever the letters are.
fn grounds(letters: &Range<usize>, at: Pos2, galley: &Galley) -> Vec<Rect> {
    let mut grounds = Vec::new();
    let mut begin = 0;
    for row in &galley.rows {
        let end = begin + row.glyphs.len();
        let (from, to) = (letters.start.clamp(begin, end), letters.end.clamp(begin, end));
        let shown = row.glyphs.get(from - begin..to - begin).unwrap_or_default();
        if let (Some(first), Some(last)) = (shown.first(), shown.last()) {
            let line = row.rect().translate(at.to_vec2());
            let left = at.x + row.pos.x + first.pos.x;
            let right = at.x + row.pos.x + last.max_x();
            grounds.push(
                Rect::from_min_max(pos2(left, line.top()), pos2(right, line.bottom()))
                    .expand2(vec2(2.0, -1.0)),
            );
        }
        begin = end + usize::from(row.ends_with_newline);
    }
    grounds
}

/// Returns the format of a part of a formula.
fn placed(format: TextFormat, place: Place, is_quantity: bool) -> TextFormat {
    let family = format.font_id.family.clone();
    let sized = |size: f32| FontId::new(size, family);
    let size = format.font_id.size;
    match place {
        Place::Line => TextFormat { italics: is_quantity, ..format },
        Place::Raised => TextFormat {
            italics: is_quantity,
            font_id: sized((0.74 * size).round()),
            line_height: Some((0.9 * size).round()),
            valign: Align::TOP,
            ..format
        },
        // As small as a text can be; it is there to be copied.
        Place::Hidden => TextFormat {
            font_id: sized(1.0),
            line_height: Some(1.0),
            color: Color32::TRANSPARENT,
            ..format
        },
    }
}

fn format(span: &Span, step: Type, muted: bool, ui: &Ui) -> TextFormat {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let font = theme.font(match (span.strong, step) {
        (true, Type::Reading) => Type::ReadingStrong,
        (true, Type::Body) => Type::Strong,
        (true, Type::Small) => Type::SmallStrong,
        _ => step,
    });
    let line_height = (font.size * 1.42).round();
    // Letters that Inter lacks have one weight and no italics: colour marks emphasis there.
    let is_in_one_weight = span.text.chars().any(|letter| letter >= '\u{2e80}');
    let color = if span.target.is_some() || ((span.strong || span.emphasis) && is_in_one_weight) {
        palette.accent_ink
    } else if muted {
        palette.muted
    } else {
        palette.text
    };
    TextFormat {
        italics: span.emphasis && !is_in_one_weight,
        underline: if span.target.is_some() {
            Stroke::new(theme.hairline(), palette.line_strong)
        } else {
            Stroke::NONE
        },
        line_height: Some(line_height),
        valign: Align::Center,
        ..TextFormat::simple(font, color)
    }
}
