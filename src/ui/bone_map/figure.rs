//! The picture of the body, between two columns of slots.

use super::bones::{BoneDrag, BoneEvent, bones_ui};
use super::slots::{column, is_needed, label_of, place_of};
use crate::ui::kit::paint::{
    PointerKind, Run, focus_ring, full_width, line_of, name_line, pointer_in_use, put,
};
use crate::ui::kit::{Icon, describe, paint_icon, pointer_label_ui, set_role, switches_menu_ui};
use crate::ui::language::{Text, Word, say};
use crate::ui::text;
use crate::ui::theme::{Palette, Type, palette_of, radius, theme_of};
use eframe::egui::accesskit;
use eframe::egui::{
    Align2, Color32, CursorIcon, DragAndDrop, Id, LayerId, Order, Popup, Pos2, Rect, RectAlign,
    Response, Role as WidgetRole, Sense, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use segue_motion::clip::Motion;
use segue_motion::skeleton::{BodyPlan, Role, RoleSource, Side};
use segue_text::Message;

/// An input to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FigureEvent {
    /// The list of a slot was opened.
    Open(Role),
    /// A slot was given a bone, by its joint, or none.
    Set(Role, Option<usize>),
}

/// The space between slots, points.
const GAP: f32 = 4.0;
/// The share of the width that the body has between the columns.
const BODY_SHARE: f32 = 0.32;
/// The greatest width, points: more would only part the slots from the body.
const MAX_WIDTH: f32 = 480.0;
/// The width of the list of a slot, points.
const LIST_WIDTH: f32 = 248.0;
/// The number of slots of the middle side by side.
const IN_A_ROW: usize = 3;

/// Draws the body with its slots.
pub(super) fn figure_ui(motion: &Motion, search: &mut String, ui: &mut Ui) -> Option<FigureEvent> {
    let theme = theme_of(ui);
    let height = (35.0 * theme.scale()).max(theme.hit()).round();
    let middle: Vec<Role> = column(None).collect();
    let sides = [Side::Right, Side::Left].map(|side| column(Some(side)).collect::<Vec<_>>());
    let (top_rows, rows) = (middle.len().div_ceil(IN_A_ROW), sides[0].len());
    let caption = (16.0 * theme.scale()).round();
    let whole = full_width((top_rows + rows) as f32 * (height + GAP) + caption, ui);
    let whole = Rect::from_center_size(
        whole.center(),
        vec2(whole.width().min(MAX_WIDTH * theme.scale()), whole.height()),
    );
    let width = ((whole.width() * (1.0 - BODY_SHARE)) / 2.0).floor();
    let top = whole.top() + top_rows as f32 * (height + GAP) + caption;
    let mut places: Vec<(Role, Rect)> = Vec::new();
    for (row, roles) in middle.chunks(IN_A_ROW).enumerate() {
        let across = (whole.width() - GAP * (roles.len() as f32 - 1.0)) / roles.len() as f32;
        for (index, &role) in roles.iter().enumerate() {
            let corner = pos2(
                whole.left() + index as f32 * (across + GAP),
                whole.top() + row as f32 * (height + GAP),
            );
            places.push((role, Rect::from_min_size(corner, vec2(across, height))));
        }
    }
    for (roles, left) in sides.iter().zip([whole.left(), whole.right() - width]) {
        for (row, &role) in roles.iter().enumerate() {
            let corner = pos2(left, top + row as f32 * (height + GAP));
            places.push((role, Rect::from_min_size(corner, vec2(width, height))));
        }
    }
    let body = Rect::from_min_max(
        pos2(whole.left() + width, top),
        pos2(whole.right() - width, whole.bottom() - GAP),
    );
    // The space is allocated already.
    let ui = &mut ui.new_child(UiBuilder::new().id_salt("body").max_rect(whole));
    set_role(accesskit::Role::Group, text::BONE_MAP, ui);
    for (word, left) in [(text::RIGHT_SIDE, whole.left()), (text::LEFT_SIDE, whole.right() - width)]
    {
        let words = [Run::new(word, Type::Small, palette_of(ui).muted)];
        let galley = line_of(&words, width, ui);
        put(ui.painter(), pos2(left + 6.0, top - 3.0), Align2::LEFT_BOTTOM, galley);
    }
    body_ui(body, motion.roles().body_plan(), ui);
    Figure { motion, body }.slots_ui(&places, search, ui)
}

struct Figure<'a> {
    motion: &'a Motion,
    body: Rect,
}

impl Figure<'_> {
    fn slots_ui(
        &self,
        places: &[(Role, Rect)],
        search: &mut String,
        ui: &mut Ui,
    ) -> Option<FigureEvent> {
        let mut event = None;
        let pointer = ui.input(|input| input.pointer.interact_pos());
        let dragged = DragAndDrop::payload::<BoneDrag>(ui.ctx());
        let released = ui.input(|input| input.pointer.any_released());
        for &(role, rect) in places {
            let is_over = dragged.is_some()
                && pointer.is_some_and(|at| rect.contains(at) && ui.clip_rect().contains(at));
            if let Some(drag) = dragged.as_deref().filter(|_| is_over && released) {
                event = Some(FigureEvent::Set(role, Some(drag.0)));
            }
            let slot = self.slot_ui(role, rect, is_over, ui);
            let is_opened = slot.clicked();
            if is_opened {
                search.clear();
                event = Some(FigureEvent::Open(role));
            }
            let list = switches_menu_ui(&slot, RectAlign::BOTTOM_START, |ui| {
                ui.set_width(LIST_WIDTH * theme_of(ui).scale());
                let takes_focus = is_opened && pointer_in_use(ui) != PointerKind::Finger;
                let event = bones_ui(self.motion, Some(role), search, takes_focus, ui);
                if event.is_some() {
                    ui.close();
                }
                event
            });
            if let Some(BoneEvent::Choose(joint)) = list.and_then(|list| list.inner) {
                event = Some(FigureEvent::Set(role, joint));
            }
        }
        if let Some(drag) = dragged {
            if released {
                DragAndDrop::clear_payload(ui.ctx());
            } else if let Some(at) = pointer {
                self.drag_label_ui(*drag, at, ui);
            }
        }
        event
    }

    /// Draws the name of the dragged bone beside the pointer.
    fn drag_label_ui(&self, drag: BoneDrag, at: Pos2, ui: &mut Ui) {
        let joints = self.motion.clip().skeleton().joints();
        let Some(joint) = joints.get(drag.0) else { return };
        let layer = LayerId::new(Order::Tooltip, ui.scope_id().with("dragged-bone"));
        let place = ui.ctx().content_rect();
        ui.scope_builder(UiBuilder::new().layer_id(layer).max_rect(place), |ui| {
            ui.set_clip_rect(place);
            pointer_label_ui(Text::Data(&joint.name), at, place, ui);
        });
    }

    /// Draws a slot and the mark of its part on the body. Returns the slot, which opens a list.
    fn slot_ui(&self, role: Role, rect: Rect, is_over: bool, ui: &mut Ui) -> Response {
        let (theme, palette) = (theme_of(ui), palette_of(ui));
        let id = Id::unique(("slot of a body part", role.index()));
        let response = ui.interact(rect, id, Sense::click());
        let response = response.on_hover_cursor(CursorIcon::PointingHand);
        let roles = self.motion.roles();
        let plan = roles.body_plan();
        let part = Word::new(role.name_in(plan));
        let joints = self.motion.clip().skeleton().joints();
        let joint = roles.get(role).and_then(|joint| joints.get(joint));
        let source = roles.source(role).filter(|_| joint.is_some());
        let is_chosen =
            is_over || Popup::is_id_open(ui.ctx(), Popup::default_response_id(&response));
        let is_lit = is_chosen || response.hovered() || response.has_focus();
        let lacks = joint.is_none() && is_needed(role, plan);

        let [x, y] = place_of(role, plan);
        let mark = on_body(self.body, [x, y]);
        let color = match source {
            Some(source) => source_color(source, palette),
            None if lacks => palette.warning,
            None => palette.muted,
        };
        if role.side().is_some() {
            let from = if x < 0.0 { rect.right_center() } else { rect.left_center() };
            let line = if is_lit { palette.accent } else { palette.line };
            ui.painter().line_segment([from, mark], Stroke::new(theme.hairline(), line));
        }
        let size = if is_lit { 5.5 } else { 4.0 } * theme.scale();
        if source.is_some() {
            ui.painter().circle(mark, size, color, Stroke::new(1.5, palette.panel));
        } else {
            ui.painter().circle(mark, size, palette.panel, Stroke::new(1.5, color));
        }
        if is_chosen {
            ui.painter().circle_stroke(mark, size + 2.5, Stroke::new(1.5, palette.accent));
        }

        let fill = if response.hovered() { palette.hover } else { palette.panel_raised };
        let line = match (is_chosen, lacks) {
            (true, _) => Stroke::new(2.0, palette.accent),
            (false, true) => Stroke::new(theme.hairline(), palette.warning),
            (false, false) => Stroke::new(theme.hairline(), palette.line),
        };
        ui.painter().rect(rect, radius::M, fill, line, StrokeKind::Inside);
        let inner = rect.shrink2(vec2(6.0, 2.0));
        let side = (11.0 * theme.scale()).round();
        let sign = match source {
            Some(source) => Some(sign_of(source).0),
            None => lacks.then_some(Icon::Warning),
        };
        if let Some(sign) = sign {
            let at = Align2::RIGHT_CENTER.anchor_size(
                pos2(inner.right(), inner.top() + inner.height() * 0.28),
                vec2(side, side),
            );
            paint_icon(sign, at, color, ui.painter());
        }
        let label = line_of(
            &[Run::new(label_of(role, plan), Type::SmallStrong, palette.muted)],
            inner.width() - side - 2.0,
            ui,
        );
        let upper = pos2(inner.left(), inner.top() + inner.height() * 0.28);
        put(ui.painter(), upper, Align2::LEFT_CENTER, label);
        let lower = pos2(inner.left(), inner.top() + inner.height() * 0.74);
        let name = match joint {
            Some(joint) => {
                let own = joint.name.rsplit(':').next().unwrap_or(&joint.name);
                name_line(Text::Data(own), Type::Small, palette.text, inner.width(), ui)
            }
            None => name_line(text::NOBODY.into(), Type::Small, color, inner.width(), ui),
        };
        put(ui.painter(), lower, Align2::LEFT_CENTER, name);
        focus_ring(rect, radius::M, &response, ui);

        let said = match (joint, source) {
            (Some(joint), Some(source)) => {
                text::slot(part, Message::data(&*joint.name), sign_of(source).1)
            }
            _ => text::empty_slot(part),
        };
        let info = WidgetInfo::labeled(WidgetRole::Button, ui.is_enabled(), say(&said, ui));
        describe(&response, &info);
        if is_chosen { response } else { response.on_hover_text(say(&said, ui)) }
    }
}

/// Returns the sign of a source, and the words for it.
pub(super) fn sign_of(source: RoleSource) -> (Icon, Word) {
    match source {
        RoleSource::ByHand => (Icon::Pencil, text::FOUND_BY_HAND),
        RoleSource::ByFile => (Icon::Report, text::FOUND_BY_FILE),
        RoleSource::ByName => (Icon::Check, text::FOUND_BY_NAME),
        RoleSource::ByShape => (Icon::Help, text::FOUND_BY_SHAPE),
    }
}

/// Returns the colour of parts by their source.
pub(super) fn source_color(source: RoleSource, palette: &Palette) -> Color32 {
    match source {
        RoleSource::ByHand => palette.accent_ink,
        RoleSource::ByName | RoleSource::ByFile => palette.good,
        RoleSource::ByShape => palette.a_ink,
    }
}

/// Returns the place on the body of a point in body heights.
fn on_body(body: Rect, [x, y]: [f32; 2]) -> Pos2 {
    // A tall place has room above and below, a wide one at the sides.
    let height = body.height().min(body.width() / BODY_WIDTH);
    let top = body.center().y - height / 2.0;
    pos2(body.center().x + x * height, top + y * height)
}

/// The width of the body with its arms, and a margin, in body heights.
const BODY_WIDTH: f32 = 0.4;

/// The limbs of the body that are drawn: their ends in body heights, and their thickness.
const LIMBS: [([f32; 2], [f32; 2], f32); 6] = [
    ([0.095, 0.2], [0.135, 0.345], 0.052),
    ([0.135, 0.345], [0.155, 0.49], 0.042),
    ([0.05, 0.5], [0.06, 0.74], 0.085),
    ([0.06, 0.74], [0.064, 0.94], 0.06),
    ([0.064, 0.955], [0.092, 0.975], 0.045),
    ([0.04, 0.2], [0.095, 0.2], 0.055),
];

/// The limbs of a body on four legs, seen from below with its head at the top.
const LIMBS_ON_FOUR: [([f32; 2], [f32; 2], f32); 6] = [
    ([0.04, 0.27], [0.075, 0.27], 0.075),
    ([0.075, 0.27], [0.13, 0.33], 0.055),
    ([0.13, 0.33], [0.16, 0.21], 0.04),
    ([0.07, 0.63], [0.13, 0.58], 0.08),
    ([0.13, 0.58], [0.14, 0.76], 0.05),
    ([0.14, 0.76], [0.165, 0.69], 0.04),
];

/// Draws a body that faces the viewer, or one on four legs.
fn body_ui(body: Rect, plan: BodyPlan, ui: &Ui) {
    let color = palette_of(ui).pressed;
    let painter = ui.painter();
    let at = |point| on_body(body, point);
    let unit = (at([0.0, 1.0]) - at([0.0, 0.0])).y;
    let limb = |from: [f32; 2], to: [f32; 2], thickness: f32| {
        let (from, to) = (at(from), at(to));
        painter.line_segment([from, to], Stroke::new(thickness * unit, color));
        for end in [from, to] {
            painter.circle_filled(end, thickness * unit / 2.0, color);
        }
    };
    let limbs = match plan {
        BodyPlan::Biped => LIMBS,
        BodyPlan::Quadruped => LIMBS_ON_FOUR,
    };
    for (from, to, thickness) in limbs {
        limb(from, to, thickness);
        limb([-from[0], from[1]], [-to[0], to[1]], thickness);
    }
    match plan {
        BodyPlan::Biped => {
            limb([0.0, 0.12], [0.0, 0.2], 0.05);
            limb([0.0, 0.23], [0.0, 0.44], 0.15);
            limb([-0.03, 0.48], [0.03, 0.48], 0.1);
        }
        BodyPlan::Quadruped => {
            limb([0.0, 0.02], [0.0, 0.2], 0.05);
            limb([0.0, 0.27], [0.0, 0.62], 0.13);
            limb([0.0, 0.68], [0.0, 0.93], 0.025);
        }
    }
    painter.circle_filled(at([0.0, 0.07]), 0.062 * unit, color);
}
