//! A heat map: the distance of every moment of one clip from every moment of another, with curves
//! and pins on it.

use super::assistive::describe;
use super::paint::{Run, focus_ring, line_of, put};
use super::time_axis::nice_step;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CornerRadius, CursorIcon, Id, Pos2, Rangef, Rect, Response, Role, Sense,
    Shape, Stroke, StrokeKind, TextureId, Ui, WidgetInfo, pos2, vec2,
};
use segue_text::Message;
use std::ops::Range;

/// Number of colours of a heat map: more than an eye tells apart.
const SHADES: usize = 256;

/// The colours of distances in a table: a heat map looks up hundreds of thousands of them.
#[derive(Clone, Debug)]
pub(crate) struct Shades([Color32; SHADES]);

impl Shades {
    /// Returns the shades between the palette's colours, from near to far.
    pub(crate) fn new(heat: &[Color32; 5]) -> Self {
        Self(std::array::from_fn(|shade| {
            let at = shade as f32 / (SHADES - 1) as f32 * (heat.len() - 1) as f32;
            let index = (at as usize).min(heat.len() - 2);
            heat[index].lerp_to_gamma(heat[index + 1], at - index as f32)
        }))
    }

    /// Returns the colour of a share, clamped to 0 to 1.
    pub(crate) fn at(&self, share: f32) -> Color32 {
        // The conversion clamps negative numbers to 0.
        self.0[((share * (SHADES - 1) as f32 + 0.5) as usize).min(SHADES - 1)]
    }
}

/// A curve over both times, seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MapCurve<'a> {
    /// Its points: time in the first clip, time in the second.
    pub(crate) points: &'a [[f64; 2]],
    /// Its colour.
    pub(crate) color: Color32,
    /// Its width, points.
    pub(crate) width: f32,
    /// Whether it is dashed.
    pub(crate) dashed: bool,
}

/// The stances of each foot of one clip, seconds.
pub(crate) type Feet = Vec<Vec<Range<f64>>>;

/// The content of the map. The first clip's time runs to the right, the second's upwards.
#[derive(Clone, Debug)]
pub(crate) struct HeatMap<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The colours of the part `field` of both times; `None` while they are unknown.
    pub(crate) texture: Option<TextureId>,
    /// The start and end of the part that the texture shows, of both clips, seconds.
    pub(crate) field: [[f64; 2]; 2],
    /// The lengths of both clips, seconds.
    pub(crate) spans: [f64; 2],
    /// The names of both axes.
    pub(crate) names: [Word; 2],
    /// The stances of both clips.
    pub(crate) feet: &'a [Feet; 2],
    /// The curves, the most important one last.
    pub(crate) curves: &'a [MapCurve<'a>],
    /// The pins that hold a curve, seconds.
    pub(crate) pins: &'a [[f64; 2]],
    /// The pair of times at the playhead, seconds.
    pub(crate) now: Option<[f64; 2]>,
}

/// The user's input to the map. Times are in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HeatMapEvent {
    /// The pointer is at these times.
    Hover([f64; 2]),
    /// Go to these times.
    Seek([f64; 2]),
    /// Set a pin, or move one.
    Pin {
        /// Its place before; `None` for a new pin.
        from: Option<[f64; 2]>,
        /// Its new place.
        to: [f64; 2],
    },
    /// Remove the pin.
    Unpin([f64; 2]),
    /// The pin was released: the changes since it was taken are one step of undo.
    Settled,
}

/// The places of times on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axes {
    rect: Rect,
    spans: [f64; 2],
}

impl Axes {
    fn at(&self, secs: [f64; 2]) -> Pos2 {
        let share = |axis: usize| (secs[axis] / self.spans[axis].max(1e-9)) as f32;
        pos2(
            self.rect.left() + share(0) * self.rect.width(),
            self.rect.bottom() - share(1) * self.rect.height(),
        )
    }

    fn secs(&self, pos: Pos2) -> [f64; 2] {
        let x = f64::from((pos.x - self.rect.left()) / self.rect.width().max(1.0));
        let y = f64::from((self.rect.bottom() - pos.y) / self.rect.height().max(1.0));
        [x.clamp(0.0, 1.0) * self.spans[0], y.clamp(0.0, 1.0) * self.spans[1]]
    }
}

/// Room beside the field for the stripes of the feet, points.
const STRIPES: f32 = 12.0;
/// Room beside the field for the seconds, points.
const SECONDS: f32 = 16.0;
/// The distance within which a pin is taken hold of, points.
const REACH: f32 = 11.0;
/// The distance from the field at which a dragged pin is removed, points.
const OUT: f32 = 14.0;

/// Draws the map as wide as there is room, at most `most_height` points high. Press to go there,
/// drag to set or move a pin, drag it out or double-click it to remove it. A finger sets a pin by
/// holding still, and drags only pins: from everywhere else it scrolls the panel.
pub(crate) fn heat_map_ui(map: &HeatMap<'_>, most_height: f32, ui: &mut Ui) -> Vec<HeatMapEvent> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (stripes, seconds) = ((STRIPES * scale).round(), (SECONDS * scale).round());
    let margin = vec2(seconds + stripes + 4.0, seconds + stripes);
    let width = ui.available_width() - margin.x;
    // The height follows from the times, within limits: equal speeds are a diagonal.
    let wanted = width * (map.spans[1] / map.spans[0].max(1e-9)) as f32;
    let height =
        wanted.clamp(0.55 * width, 1.1 * width).min(most_height - margin.y).max(60.0).round();
    let (_, whole) = ui.allocate_space(vec2(ui.available_width(), height + margin.y));
    let field =
        Rect::from_min_size(pos2(whole.left() + margin.x, whole.top()), vec2(width, height));
    let axes = Axes { rect: field, spans: map.spans };
    let id = ui.make_persistent_id(map.label.english());
    let sense = if theme.touch { Sense::click() } else { Sense::click_and_drag() };
    let response = ui.interact(field, id, sense);
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(map.label, ui)));
    let events = if theme.touch {
        let touched = touched_pins(map, &axes, id, ui);
        touched_events(map, &axes, &response, touched.as_ref(), ui)
    } else {
        events(map, &axes, &response, &response, ui)
    };

    let painter = ui.painter_at(field.expand(1.0));
    painter.rect_filled(field, 0.0, palette.heat[4].lerp_to_gamma(palette.heat[0], 0.8));
    if let Some(texture) = map.texture {
        let [[from_a, to_a], [from_b, to_b]] = map.field;
        let place = Rect::from_two_pos(axes.at([from_a, from_b]), axes.at([to_a, to_b]));
        painter.image(
            texture,
            place,
            Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0)),
            Color32::WHITE,
        );
    }
    for curve in map.curves {
        let points: Vec<Pos2> = curve.points.iter().map(|&secs| axes.at(secs)).collect();
        let stroke = Stroke::new(curve.width * scale, curve.color);
        if curve.dashed {
            painter.extend(Shape::dashed_line(&points, stroke, 4.0 * scale, 4.0 * scale));
        } else {
            painter.add(Shape::line(points, stroke));
        }
    }
    if let Some(now) = map.now {
        let at = axes.at(now);
        let hair = Stroke::new(theme.hairline(), palette.handle.gamma_multiply(0.45));
        painter.vline(at.x, field.y_range(), hair);
        painter.hline(field.x_range(), at.y, hair);
        painter.circle(at, 4.0 * scale, palette.handle, Stroke::new(1.5, palette.on_handle));
    }
    for &pin in map.pins {
        let at = axes.at(pin);
        painter.circle(
            at,
            5.0 * scale,
            palette.warning,
            Stroke::new(1.5 * scale, palette.on_handle),
        );
    }
    if let (Some(pos), false) = (response.hover_pos(), response.dragged()) {
        let hair = Stroke::new(theme.hairline(), palette.text.gamma_multiply(0.35));
        painter.vline(pos.x, field.y_range(), hair);
        painter.hline(field.x_range(), pos.y, hair);
    }
    ui.painter().rect_stroke(
        field,
        0.0,
        Stroke::new(theme.hairline(), palette.line_strong),
        StrokeKind::Outside,
    );
    sides_ui(map, &axes, stripes, ui);
    focus_ring(field, radius::S, &response, ui);
    events
}

/// Draws the stripes of the feet and the seconds: those of the first clip below the field, those of
/// the second at its left.
fn sides_ui(map: &HeatMap<'_>, axes: &Axes, stripes: f32, ui: &Ui) {
    let palette = palette_of(ui);
    let scale = theme_of(ui).scale();
    let field = axes.rect;
    for (clip, color) in [(0, palette.a), (1, palette.b)] {
        let lanes = map.feet[clip].len().max(1) as f32;
        let thick = ((stripes - 2.0 - lanes) / lanes).floor();
        for (foot, stances) in map.feet[clip].iter().enumerate() {
            let lane = 2.0 + foot as f32 * (thick + 1.0);
            for stance in stances {
                let ends = [stance.start, stance.end]
                    .map(|secs| axes.at([secs.min(map.spans[0]), secs.min(map.spans[1])]));
                let bar = if clip == 0 {
                    Rect::from_x_y_ranges(
                        ends[0].x..=ends[1].x,
                        Rangef::new(field.bottom() + lane, field.bottom() + lane + thick),
                    )
                } else {
                    Rect::from_x_y_ranges(
                        Rangef::new(field.left() - lane - thick, field.left() - lane),
                        ends[1].y..=ends[0].y,
                    )
                };
                ui.painter().rect_filled(bar, 1.0, color);
            }
        }
    }
    for clip in [0, 1] {
        let length = if clip == 0 { field.width() } else { field.height() };
        let step = nice_step(map.spans[clip], f64::from(length / (44.0 * scale)));
        let ink = [palette.a_ink, palette.b_ink][clip];
        for mark in 0..=(map.spans[clip] / step) as usize {
            let secs = mark as f64 * step;
            let number = format!("{secs}");
            let (words, color) = if mark == 0 {
                (Text::Word(map.names[clip]), ink)
            } else {
                (Text::Data(&number), palette.muted)
            };
            let galley = line_of(&[Run::new(words, Type::Small, color)], 60.0, ui);
            let at = axes.at([secs, secs]);
            if clip == 0 {
                let anchor = if mark == 0 { Align2::LEFT_TOP } else { Align2::CENTER_TOP };
                put(ui.painter(), pos2(at.x, field.bottom() + stripes), anchor, galley);
            } else {
                let anchor = if mark == 0 { Align2::RIGHT_BOTTOM } else { Align2::RIGHT_CENTER };
                put(ui.painter(), pos2(field.left() - stripes - 2.0, at.y), anchor, galley);
            }
        }
    }
}

/// The last position of the pin that is being dragged; `None` for a drag without a pin.
#[derive(Clone, Copy, Debug)]
struct HeldPin(Option<[f64; 2]>);

/// Adds a touch target to each pin. Returns the one in use.
fn touched_pins(map: &HeatMap<'_>, axes: &Axes, id: Id, ui: &Ui) -> Option<Response> {
    let side = theme_of(ui).hit();
    let pins = map.pins.iter().enumerate().map(|(index, &pin)| {
        let target = Rect::from_center_size(axes.at(pin), vec2(side, side));
        ui.interact(target, id.with(("pin", index)), Sense::click_and_drag())
    });
    // Add all of them, so that each keeps its widget id.
    pins.fold(None, |used, pin| {
        let is_used = pin.dragged() || pin.drag_stopped() || pin.clicked();
        if is_used { Some(pin) } else { used }
    })
}

/// Returns the input of a finger: on a pin, or on the map.
fn touched_events(
    map: &HeatMap<'_>,
    axes: &Axes,
    response: &Response,
    pin: Option<&Response>,
    ui: &Ui,
) -> Vec<HeatMapEvent> {
    if let Some(pin) = pin {
        return events(map, axes, pin, response, ui);
    }
    let held = response.interact_pointer_pos().filter(|_| response.long_touched());
    if let Some(pos) = held {
        let to = axes.secs(pos);
        return vec![HeatMapEvent::Pin { from: None, to }, HeatMapEvent::Settled];
    }
    events(map, axes, response, response, ui)
}

/// Returns the input to the map: by `response`, the map itself or a pin on it.
fn events(
    map: &HeatMap<'_>,
    axes: &Axes,
    response: &Response,
    whole: &Response,
    ui: &Ui,
) -> Vec<HeatMapEvent> {
    let mut events = Vec::new();
    let held_id: Id = whole.id.with("held pin");
    // To the corner of a pin's target.
    let reach_of_pin = if theme_of(ui).touch { 0.71 * theme_of(ui).hit() } else { REACH };
    let near = |pos: Pos2| {
        let off = |pin: &&[f64; 2]| axes.at(**pin).distance(pos);
        let nearest = map.pins.iter().min_by(|x, y| off(x).total_cmp(&off(y)));
        nearest.copied().filter(|pin| axes.at(*pin).distance(pos) <= reach_of_pin)
    };
    let reach =
        near(response.interact_pointer_pos().or(response.hover_pos()).unwrap_or(Pos2::ZERO));
    if response.hovered() {
        ui.ctx().set_cursor_icon(if reach.is_some() {
            CursorIcon::Grab
        } else {
            CursorIcon::Crosshair
        });
    }
    if response.drag_started() {
        let origin =
            ui.input(|input| input.pointer.press_origin()).or(response.interact_pointer_pos());
        ui.data_mut(|data| data.insert_temp(held_id, HeldPin(origin.and_then(near))));
    }
    if let (true, Some(pos)) = (response.dragged(), response.interact_pointer_pos()) {
        let HeldPin(from) = ui.data(|data| data.get_temp(held_id)).unwrap_or(HeldPin(None));
        let to = axes.secs(pos);
        let stays = axes.rect.expand(OUT).contains(pos);
        match (stays, from) {
            (true, _) if from != Some(to) => {
                events.push(HeatMapEvent::Pin { from, to });
                ui.data_mut(|data| data.insert_temp(held_id, HeldPin(Some(to))));
            }
            (false, Some(from)) => {
                events.push(HeatMapEvent::Unpin(from));
                ui.data_mut(|data| data.insert_temp(held_id, HeldPin(None)));
            }
            _ => {}
        }
        events.push(HeatMapEvent::Hover(to));
    } else if let Some(pos) = response.hover_pos() {
        events.push(HeatMapEvent::Hover(axes.secs(pos)));
    }
    if response.drag_stopped() {
        events.push(HeatMapEvent::Settled);
    }
    let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
    if let Some(pos) = clicked {
        match near(pos) {
            Some(pin) if response.double_clicked() => {
                events.extend([HeatMapEvent::Unpin(pin), HeatMapEvent::Settled]);
            }
            Some(pin) => events.push(HeatMapEvent::Seek(pin)),
            None => events.push(HeatMapEvent::Seek(axes.secs(pos))),
        }
    }
    events
}

/// Draws the legend of the colours, from near to far.
pub(crate) fn heat_legend_ui([low, high]: &[Message; 2], ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let height = (14.0 * theme.scale()).round();
    let row = super::paint::full_width(height, ui);
    let low = line_of(&[Run::new(low, Type::Small, palette.muted)], row.width(), ui);
    let high = line_of(&[Run::new(high, Type::Small, palette.muted)], row.width(), ui);
    let left = put(ui.painter(), row.left_center(), Align2::LEFT_CENTER, low).right() + space::S;
    let right = put(ui.painter(), row.right_center(), Align2::RIGHT_CENTER, high).left() - space::S;
    if right > left {
        let bar = Rect::from_x_y_ranges(left..=right, row.center().y - 4.0..=row.center().y + 4.0);
        let count = palette.heat.len() as f32 - 1.0;
        let stops: Vec<(f32, Color32)> =
            palette.heat.iter().enumerate().map(|(k, &color)| (k as f32 / count, color)).collect();
        super::paint::gradient_bar(bar, 2.0, &stops, ui.painter());
        let line = Stroke::new(theme.hairline(), palette.line_strong);
        ui.painter().rect_stroke(bar, CornerRadius::same(2), line, StrokeKind::Outside);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_places_are_inverse_and_stay_inside() {
        let axes = Axes {
            rect: Rect::from_min_size(pos2(10.0, 20.0), vec2(200.0, 100.0)),
            spans: [4.0, 2.0],
        };
        assert_eq!(axes.at([1.0, 0.5]), pos2(60.0, 95.0));
        assert_eq!(axes.secs(pos2(60.0, 95.0)), [1.0, 0.5]);
        assert_eq!(axes.secs(pos2(900.0, 900.0)), [4.0, 0.0]);
    }
}
