//! Captions over the stage, notices that can be dismissed, and the progress of tasks.

use super::assistive::describe;
use super::button::{Button, button_ui, icon_button_ui};
use super::chip::Mood;
use super::icon::{Icon, paint_icon};
use super::paint::{Run, full_width, line_of, paragraph, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align, Align2, Area, Color32, Frame, Id, Layout, Margin, Order, Rect, Role, ScrollArea, Sense,
    Shadow, Stroke, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use segue_text::Message;

/// A notice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Notice<'a> {
    /// The event and its remedy, of any length.
    pub(crate) text: &'a Message,
    /// Its severity.
    pub(crate) mood: Mood,
    /// The label of a button below it; empty for none.
    pub(crate) action: Word,
}

/// The user's input to a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoticeEvent {
    /// Close it.
    Dismissed,
    /// Its button was pressed.
    Acted,
}

/// Draws a notice as wide as its panel.
pub(crate) fn notice_ui(notice: &Notice<'_>, ui: &mut Ui) -> Option<NoticeEvent> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (ink, wash) = notice.mood.colors(palette);
    let mut event = None;
    let frame = Frame::new()
        .fill(palette.panel_raised)
        .stroke(Stroke::new(theme.hairline(), palette.line))
        .corner_radius(radius::L);
    let shown = frame.inner_margin(Margin::symmetric(12, 10)).show(ui, |ui| {
        let sign = 16.0 * scale;
        let text_left = sign + space::S + 2.0;
        let text = paragraph(
            notice.text,
            Type::Body,
            palette.text,
            ui.available_width() - text_left - HIT - space::XS,
            ui,
        );
        let row = full_width(text.size().y.max(HIT - 4.0), ui);
        let sign_rect =
            Align2::LEFT_TOP.anchor_size(row.left_top() + vec2(0.0, 1.0), vec2(sign, sign));
        paint_icon(notice.mood.icon(), sign_rect, ink, ui.painter());
        let at = put(ui.painter(), row.left_top() + vec2(text_left, 0.0), Align2::LEFT_TOP, text);
        let english = notice.text.to_string();
        let label = ui.interact(at, ui.make_persistent_id(("notice", &english)), Sense::hover());
        describe(&label, &WidgetInfo::labeled(Role::Alert, true, say(notice.text, ui)));
        let close =
            Rect::from_min_size(pos2(row.right() - HIT + 4.0, row.top() - 4.0), vec2(HIT, HIT));
        let close_id = ui.make_persistent_id(("dismiss", &english));
        let hit = super::clip_row::small_icon_ui(
            Icon::Close,
            words::DISMISS,
            close_id,
            close,
            Color32::TRANSPARENT,
            ui,
        );
        if hit.clicked() {
            event = Some(NoticeEvent::Dismissed);
        }
        if !notice.action.is_empty() {
            ui.add_space(space::XS);
            ui.horizontal(|ui| {
                ui.add_space(text_left);
                if button_ui(Button::new(notice.action), ui).clicked() {
                    event = Some(NoticeEvent::Acted);
                }
            });
        }
    });
    if notice.mood != Mood::Plain {
        // A quiet ground in the colour of the mood, which catches the eye.
        let rect = shown.response.rect;
        ui.painter().rect_filled(rect, radius::L, wash.gamma_multiply(0.5));
    }
    event
}

/// Draws notices over the lower edge of the stage, the newest at the bottom. Returns the index of
/// the one that was used, and the input to it.
pub(crate) fn toasts_ui(
    notices: &[Notice<'_>],
    stage: Rect,
    ui: &mut Ui,
) -> Option<(usize, NoticeEvent)> {
    if notices.is_empty() {
        return None;
    }
    let width = (stage.width() - 2.0 * space::L).min(460.0 * theme_of(ui).scale());
    let shadow = Shadow { offset: [0, 6], blur: 20, spread: 0, color: palette_of(ui).shadow };
    let area =
        Area::new(Id::unique("segue toasts")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM);
    let area = area
        .fixed_pos(stage.center_bottom() - vec2(0.0, space::L))
        .constrain_to(stage)
        .default_width(width);
    let shown = area.show(ui.ctx(), |ui| {
        ui.set_width(width);
        // Notices scroll where there is no room, from the end, so that each can be closed.
        let scrolled = ScrollArea::vertical()
            .max_height(stage.height() - 2.0 * space::L)
            .stick_to_bottom(true);
        let shown = scrolled.show(ui, |ui| {
            let mut touched = None;
            for (index, notice) in notices.iter().enumerate() {
                let inner = Frame::new()
                    .shadow(shadow)
                    .corner_radius(radius::L)
                    .show(ui, |ui| ui.push_id(index, |ui| notice_ui(notice, ui)).inner);
                touched = inner.inner.map(|event| (index, event)).or(touched);
            }
            touched
        });
        shown.inner
    });
    shown.inner
}

/// Draws a sentence on a round ground, centred at the bottom of `stage`. It wraps on narrow stages.
pub(crate) fn caption_ui<'a>(text: impl Into<Text<'a>>, stage: Rect, ui: &mut Ui) -> Rect {
    let text = text.into();
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let padding = vec2(space::L, space::S);
    let galley =
        paragraph(text, Type::Body, palette.text, (stage.width() - 4.0 * space::L).min(720.0), ui);
    let one_line = galley.rows.len() == 1;
    let rect =
        Align2::CENTER_BOTTOM.anchor_size(stage.center_bottom(), galley.size() + 2.0 * padding);
    let corner = if one_line { rect.height() / 2.0 } else { f32::from(radius::L) };
    let shadow = Shadow { offset: [0, 4], blur: 16, spread: 0, color: palette.shadow };
    ui.painter().add(shadow.as_shape(rect, corner));
    let stroke = Stroke::new(theme.hairline(), palette.line);
    ui.painter().rect(rect, corner, palette.panel_raised, stroke, eframe::egui::StrokeKind::Inside);
    put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    let id = ui.make_persistent_id(("caption", text.english()));
    let response = ui.interact(rect, id, Sense::hover());
    describe(&response, &WidgetInfo::labeled(Role::Label, true, say(text, ui)));
    rect
}

/// Draws a task: its name, its progress (`None` if unknown), and a button that stops it. Returns
/// whether that was pressed.
pub(crate) fn progress_row_ui<'a>(
    label: impl Into<Text<'a>>,
    done: Option<f32>,
    detail: impl Into<Text<'a>>,
    ui: &mut Ui,
) -> bool {
    progress_ui(label.into(), done, detail.into(), true, ui)
}

/// Draws a task that is too short to be stopped.
pub(crate) fn brief_progress_ui<'a>(
    label: Word,
    done: f32,
    detail: impl Into<Text<'a>>,
    ui: &mut Ui,
) {
    progress_ui(label.into(), Some(done), detail.into(), false, ui);
}

fn progress_ui(
    label: Text<'_>,
    done: Option<f32>,
    detail: Text<'_>,
    can_be_stopped: bool,
    ui: &mut Ui,
) -> bool {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let width = ui.available_width();
    let head_height = theme.row_height();
    let (_, rect) = ui.allocate_space(vec2(width, head_height + 6.0 * scale));
    let head = Rect::from_min_size(rect.min, vec2(width, head_height));
    let builder = UiBuilder::new()
        .id_salt(label.english())
        .max_rect(head)
        .layout(Layout::right_to_left(Align::Center));
    let mut inner = ui.new_child(builder);
    let stopped =
        can_be_stopped && icon_button_ui(Icon::Close, words::CANCEL, &mut inner).clicked();
    let right = if can_be_stopped { inner.min_rect().left() - space::XS } else { head.right() };
    // The name has precedence over the detail: the bar shows the progress as well.
    let galley = line_of(&[Run::new(label, Type::Label, palette.text)], right - head.left(), ui);
    let said = put(ui.painter(), head.left_center(), Align2::LEFT_CENTER, galley);
    let detail = line_of(&[Run::new(detail, Type::Small, palette.muted)], f32::INFINITY, ui);
    if detail.size().x < right - said.right() - space::S {
        put(ui.painter(), pos2(right, head.center().y), Align2::RIGHT_CENTER, detail);
    }

    let track = Rect::from_min_max(pos2(rect.left(), rect.bottom() - 4.0 * scale), rect.max);
    ui.painter().rect_filled(track, 2.0 * scale, palette.track);
    let (from, to) = if let Some(done) = done {
        (0.0, done.clamp(0.0, 1.0))
    } else {
        // The end is unknown: a third of the bar moves along it.
        ui.request_repaint();
        let phase = (ui.input(|input| input.time) * 0.7).rem_euclid(1.4) as f32 - 0.35;
        (phase.max(0.0), (phase + 0.35).clamp(0.0, 1.0))
    };
    let bar = Rect::from_x_y_ranges(
        track.left() + from * track.width()..=track.left() + to * track.width(),
        track.y_range(),
    );
    ui.painter().rect_filled(bar, 2.0 * scale, palette.accent);
    let id = ui.make_persistent_id(("progress", label.english()));
    let response = ui.interact(track, id, Sense::hover());
    let mut info = WidgetInfo::labeled(Role::ProgressIndicator, true, say(label, ui));
    info.value = done.map(f64::from);
    describe(&response, &info);
    stopped
}
