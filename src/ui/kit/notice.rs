//! Captions over the stage, notices that can be dismissed, and the progress of tasks.

use super::assistive::{describe, set_role};
use super::button::{Button, button_ui, icon_button_ui};
use super::chip::Mood;
use super::icon::{Icon, paint_icon};
use super::menu::popup_returning_keyboard_ui;
use super::paint::{
    PointerKind, Run, focus_ring, full_width, line_of, paragraph, pointer_in_use, put,
};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align, Align2, Color32, CursorIcon, Frame, Id, Label, Layout, Margin, Popup,
    PopupCloseBehavior, Rect, RectAlign, Response, Role, ScrollArea, Sense, Shadow, Stroke,
    StrokeKind, Ui, UiBuilder, WidgetInfo, pos2, vec2,
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
    let (scale, hit) = (theme.scale(), theme.hit());
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
            ui.available_width() - text_left - hit - space::XS,
            ui,
        );
        let row = full_width(text.size().y.max(hit - 4.0), ui);
        let sign_rect =
            Align2::LEFT_TOP.anchor_size(row.left_top() + vec2(0.0, 1.0), vec2(sign, sign));
        paint_icon(notice.mood.icon(), sign_rect, ink, ui.painter());
        let at = Rect::from_min_size(row.left_top() + vec2(text_left, 0.0), text.size());
        ui.put(at, Label::new(text).selectable(true));
        let english = notice.text.to_string();
        let close =
            Rect::from_min_size(pos2(row.right() - hit + 4.0, row.top() - 4.0), vec2(hit, hit));
        let close_id = ui.make_persistent_id(("dismiss", &english));
        let closer = super::clip_row::small_icon_ui(
            Icon::Close,
            words::DISMISS,
            close_id,
            close,
            Color32::TRANSPARENT,
            ui,
        );
        if closer.clicked() {
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

/// A chip for all notices, in the head row of a panel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoticeChip<'a> {
    /// Its text, cut where the row ends.
    pub(crate) text: &'a Message,
    /// Its colour.
    pub(crate) mood: Mood,
    /// The whole of what is new, for a screen reader, which reads it out.
    pub(crate) news: &'a Message,
    /// Whether the news is urgent.
    pub(crate) is_alert: bool,
    /// The row.
    pub(crate) row: Rect,
    /// Where the heading in the row ends: a short chip stands behind it.
    pub(crate) heading_end: f32,
}

/// The user's input to the notices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct NoticesResponse {
    /// Whether the list is open.
    pub(crate) is_open: bool,
    /// The input to one of them, by its index.
    pub(crate) event: Option<(usize, NoticeEvent)>,
    /// All of them are to be closed.
    pub(crate) dismissed_all: bool,
}

/// Draws the chip of all notices, and the list of them once it was pressed.
pub(crate) fn notices_ui(
    chip: &NoticeChip<'_>,
    notices: &[Notice<'_>],
    ui: &mut Ui,
) -> NoticesResponse {
    let id = Id::unique("segue notices");
    let opener = chip_ui(chip, id, ui);
    let theme = theme_of(ui);
    let screen = ui.ctx().content_rect();
    let width = (380.0 * theme.scale()).min(screen.width() - 2.0 * space::L);
    let popup = Popup::menu(&opener)
        .align(RectAlign::BOTTOM_START)
        .gap(space::XS)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let list = popup_returning_keyboard_ui(&opener, popup, |ui| {
        set_role(Role::List, words::NOTICES, ui);
        ui.set_width(width);
        notice_list_ui(notices, 0.6 * screen.height(), ui)
    });
    list.map_or_else(NoticesResponse::default, |list| NoticesResponse {
        is_open: true,
        ..list.inner
    })
}

fn chip_ui(chip: &NoticeChip<'_>, id: Id, ui: &Ui) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (ink, wash) = chip.mood.colors(palette);
    let (sign, pad) = ((13.0 * scale).round(), space::S);
    let before = pad + sign + space::XS;
    let run = Run::new(chip.text, Type::SmallStrong, ink);
    let room = chip.row.width() - before - pad;
    let galley = line_of(&[run], room, ui);
    let width = before + galley.size().x + pad;
    let fits_behind = chip.heading_end + space::S + width <= chip.row.right();
    let left = if fits_behind { chip.heading_end + space::S } else { chip.row.left() };
    let rect = Rect::from_center_size(
        pos2(left + width / 2.0, chip.row.center().y),
        vec2(width, (24.0 * scale).round()),
    );
    let news = ui.interact(rect, id.with("news"), Sense::hover());
    let role = if chip.is_alert { Role::Alert } else { Role::Status };
    describe(&news, &WidgetInfo::labeled(role, true, say(chip.news, ui)));
    // A finger needs more room than the row has.
    let by_finger = pointer_in_use(ui) == PointerKind::Finger;
    let hit = if by_finger { rect.expand2(vec2(0.0, 10.0)) } else { rect };
    let response = ui.interact(hit, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let corner = rect.height() / 2.0;
    // Whatever the row says lies behind it.
    ui.painter().rect_filled(rect, corner, palette.panel);
    ui.painter().rect_filled(rect, corner, wash);
    if response.hovered() {
        let line = Stroke::new(theme.hairline(), ink);
        ui.painter().rect_stroke(rect, corner, line, StrokeKind::Inside);
    }
    let at = Rect::from_center_size(
        pos2(rect.left() + pad + sign / 2.0, rect.center().y),
        vec2(sign, sign),
    );
    paint_icon(chip.mood.icon(), at, ink, ui.painter());
    put(ui.painter(), pos2(rect.left() + before, rect.center().y), Align2::LEFT_CENTER, galley);
    focus_ring(rect, radius::L, &response, ui);
    describe(&response, &WidgetInfo::labeled(Role::Button, true, say(chip.text, ui)));
    response.on_hover_text(say(chip.news, ui))
}

/// Draws the notices below each other, the newest first.
fn notice_list_ui(notices: &[Notice<'_>], max_height: f32, ui: &mut Ui) -> NoticesResponse {
    let mut heard = NoticesResponse::default();
    ui.spacing_mut().item_spacing.y = space::XS;
    ScrollArea::vertical().max_height(max_height).show(ui, |ui| {
        for (index, notice) in notices.iter().enumerate().rev() {
            let event = ui.push_id(index, |ui| notice_ui(notice, ui)).inner;
            heard.event = event.map(|event| (index, event)).or(heard.event);
        }
    });
    if notices.len() > 1 {
        heard.dismissed_all = button_ui(Button::new(words::DISMISS_ALL).quiet(), ui).clicked();
    }
    heard
}

/// Draws a sentence on a round ground, centred at the bottom of `free`. It wraps where that is
/// narrow.
pub(crate) fn caption_ui<'a>(text: impl Into<Text<'a>>, free: Rect, ui: &mut Ui) -> Rect {
    let text = text.into();
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let padding = vec2(space::L, space::S);
    let galley =
        paragraph(text, Type::Body, palette.text, (free.width() - 2.0 * padding.x).min(820.0), ui);
    let one_line = galley.rows.len() == 1;
    let rect =
        Align2::CENTER_BOTTOM.anchor_size(free.center_bottom(), galley.size() + 2.0 * padding);
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
