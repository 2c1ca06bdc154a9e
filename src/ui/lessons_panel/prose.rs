//! Running text with bold and italic words, formulas and links.

use crate::ui::out::{Action, Out};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{Align, CursorIcon, Frame, Label, Margin, Sense, Stroke, Ui};
use segue_session::Command;
use segue_session::lesson::{Block, Span, Target, host_of};

/// Draws the blocks of a text, one below the other.
pub(super) fn blocks_ui(blocks: &[Block], step: Type, out: &mut Out, ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = space::S;
    for block in blocks {
        match block {
            Block::Heading(words) => {
                ui.add_space(space::XS);
                let format = format(&Span::plain(words.as_str()), Type::Strong, false, ui);
                ui.label(LayoutJob::single_section(words.clone(), format));
            }
            // A displayed formula.
            Block::Paragraph(spans) if spans.iter().all(|span| span.code) => {
                formula_ui(
                    &spans.iter().map(|span| span.text.as_str()).collect::<String>(),
                    step,
                    ui,
                );
            }
            Block::Paragraph(spans) => spans_ui(spans, step, false, out, ui),
            Block::Item { depth, number, spans } => {
                ui.horizontal_top(|ui| {
                    ui.spacing_mut().item_spacing.x = space::S;
                    ui.add_space(space::L * *depth as f32);
                    let sign = number.map_or_else(|| "•".to_owned(), |number| format!("{number}."));
                    let format = format(&Span::plain(sign.as_str()), step, true, ui);
                    ui.label(LayoutJob::single_section(sign, format));
                    ui.vertical(|ui| spans_ui(spans, step, false, out, ui));
                });
            }
            Block::Code(lines) => formula_ui(lines, step, ui),
        }
    }
}

/// Draws lines of a formula on a ground of their own.
fn formula_ui(lines: &str, step: Type, ui: &mut Ui) {
    let frame = Frame::new().fill(palette_of(ui).panel_raised).corner_radius(radius::S);
    frame.inner_margin(Margin::symmetric(10, 6)).show(ui, |ui| {
        let format = format(&Span::plain(lines), step, false, ui);
        ui.label(LayoutJob::single_section(lines.to_owned(), format));
    });
}

/// Draws one paragraph. A link to a state sets it. A link to the web opens another window, and has
/// its host beside it.
pub(super) fn spans_ui(spans: &[Span], step: Type, muted: bool, out: &mut Out, ui: &mut Ui) {
    let job_of = |spans: &[Span], ui: &Ui| {
        let mut job = LayoutJob::default();
        for span in spans {
            job.append(&span.text, 0.0, format(span, step, muted, ui));
        }
        job
    };
    if spans.iter().all(|span| span.target.is_none()) {
        let job = job_of(spans, ui);
        ui.label(job);
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for run in spans.chunk_by(|a, b| a.target == b.target) {
            let job = job_of(run, ui);
            let Some(target) = run.first().and_then(|span| span.target.as_ref()) else {
                ui.label(job);
                continue;
            };
            let response = ui
                .add(Label::new(job).sense(Sense::click()))
                .on_hover_cursor(CursorIcon::PointingHand);
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
                        ui.label(LayoutJob::single_section(
                            host.text.clone(),
                            format(&host, step, true, ui),
                        ));
                    }
                }
            }
        }
    });
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
        background: if span.code {
            palette.panel_raised
        } else {
            eframe::egui::Color32::TRANSPARENT
        },
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
