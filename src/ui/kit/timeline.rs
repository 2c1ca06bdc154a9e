//! What happens in time: bars for the clips, the transition between them, a playhead over all, and the curves below.

use super::chip::Part;
use super::curves::{Curves, curves_ui, hover_ui, key_ui};
use super::keys::keys_pressed;
use super::paint::{Run, focus_ring, full_width, gradient_bar, line_of, put};
use super::words::Words;
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    self, Align2, Color32, CursorIcon, EventFilter, Id, Key, Pos2, Rangef, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo,
    accesskit::Action, accesskit::ActionData, pos2, vec2,
};
use std::ops::Range;

/// A clip on the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Track<'a> {
    /// Which part it plays: gives the bar its colour.
    pub(crate) part: Part,
    /// What stands before the bar: `A walk`. Hidden where there is no room.
    pub(crate) label: &'a str,
    /// What stands inside the bar.
    pub(crate) name: &'a str,
    /// When it begins and ends, in seconds.
    pub(crate) start: f64,
    /// When it ends, in seconds.
    pub(crate) end: f64,
    /// How long it takes to appear, in seconds.
    pub(crate) fade_in: f64,
    /// How long it takes to vanish, in seconds.
    pub(crate) fade_out: f64,
}

/// A moment worth a mark: a foot planted, a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment<'a> {
    /// When, in seconds.
    pub(crate) time: f64,
    /// Its colour.
    pub(crate) color: Color32,
    /// What it is.
    pub(crate) name: &'a str,
}

/// All that the timeline shows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Timeline<'a> {
    /// The length of it all, in seconds.
    pub(crate) duration: f64,
    /// Where the playhead stands, in seconds.
    pub(crate) now: f64,
    /// Frames per second: arrow keys step by one frame. 0: by a hundredth of the whole.
    pub(crate) fps: f64,
    /// The clips, from top to bottom.
    pub(crate) tracks: &'a [Track<'a>],
    /// When the transition begins and ends, in seconds.
    pub(crate) transition: Option<Range<f64>>,
    /// Its edges can be dragged.
    pub(crate) transition_editable: bool,
    /// Where a loop begins, in seconds.
    pub(crate) in_point: Option<f64>,
    /// Where it ends, in seconds.
    pub(crate) out_point: Option<f64>,
    /// Marks above the bars.
    pub(crate) moments: &'a [Moment<'a>],
    /// The curves below the bars; none: bars only.
    pub(crate) curves: Option<Curves<'a>>,
}

/// What was asked of the timeline. Times are in seconds, within the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimelineEvent {
    /// Show this moment.
    Seek(f64),
    /// The playhead was taken hold of: pause while it is held.
    ScrubStarted,
    /// It was let go.
    ScrubEnded,
    /// Let the loop begin here.
    SetIn(f64),
    /// Let the loop end here.
    SetOut(f64),
    /// Let the transition begin here.
    SetTransitionStart(f64),
    /// Let the transition end here.
    SetTransitionEnd(f64),
    /// A handle was taken hold of: what follows until it is let go is one thing to undo.
    EditStarted,
    /// The handle was let go.
    EditEnded,
}

/// Where times lie on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TimeAxis {
    /// The range of x that stands for the whole duration.
    pub(crate) x: Rangef,
    /// The duration, in seconds.
    pub(crate) duration: f64,
}

impl TimeAxis {
    /// Where a time lies.
    pub(crate) fn x_of(&self, time: f64) -> f32 {
        let t = if self.duration > 0.0 { time / self.duration } else { 0.0 };
        self.x.min + t as f32 * self.x.span()
    }

    /// The time at a place, within the duration.
    pub(crate) fn time_at(&self, x: f32) -> f64 {
        let t = f64::from((x - self.x.min) / self.x.span().max(1.0));
        (t * self.duration).clamp(0.0, self.duration.max(0.0))
    }
}

/// The bars, the curves, and the playhead over both. Press anywhere to go there, drag to scrub, use the arrow keys for frames.
pub(crate) fn timeline_ui(timeline: &Timeline<'_>, ui: &mut Ui) -> Vec<TimelineEvent> {
    let (theme, palette, words) = (theme_of(ui), palette_of(ui), Words::of(ui));
    let scale = theme.scale();
    let id = ui.make_persistent_id("timeline");
    let spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let gutter = if ui.available_width() < 560.0 * scale {
        0.0
    } else {
        (112.0 * scale).round()
    };
    let Heights {
        head,
        bar: bar_height,
        pitch,
        ..
    } = Heights::of(ui);
    let bars = full_width(head + timeline.tracks.len() as f32 * pitch, ui);
    let curve_height = timeline
        .curves
        .as_ref()
        .map_or(0.0, |_| (ui.available_height() - RULER * scale).max(48.0).floor());
    let plot_row = full_width(curve_height, ui);
    let ruler = full_width(RULER * scale, ui);
    ui.spacing_mut().item_spacing.y = spacing;

    let axis = TimeAxis {
        x: Rangef::new(bars.left() + gutter, bars.right()),
        duration: timeline.duration,
    };
    let area = Rect::from_min_max(pos2(axis.x.min, bars.top()), pos2(axis.x.max, ruler.bottom()));
    let plot = plot_row.with_min_x(axis.x.min).with_min_y(plot_row.top() + space::XS);

    // Interaction first: the playhead should be where the pointer is, in this very frame.
    let mut events = Vec::new();
    let scrub = ui.interact(area, id, Sense::click_and_drag());
    let mut now = timeline.now;
    scrub_ui(timeline, axis, &scrub, &mut now, &mut events, ui);

    if let Some(transition) = &timeline.transition {
        let shade = Rect::from_x_y_ranges(
            axis.x_of(transition.start)..=axis.x_of(transition.end),
            bars.top()..=plot_row.bottom(),
        );
        ui.painter().rect_filled(shade, 0.0, palette.accent_wash);
    }
    paint_ruler(
        axis,
        plot_row.bottom(),
        if curve_height > 0.0 { plot } else { Rect::NOTHING },
        ruler,
        ui,
    );
    for (index, track) in timeline.tracks.iter().enumerate() {
        let y = bars.top() + head + index as f32 * pitch;
        let row = Rangef::new(y, y + bar_height);
        if gutter > 0.0 {
            let label = line_of(&[Run::new(track.label, Type::Small, palette.muted)], gutter - space::S, ui);
            put(ui.painter(), pos2(bars.left(), row.center()), Align2::LEFT_CENTER, label);
        }
        paint_track(track, row, axis, timeline.duration, ui);
    }
    if let Some(curves) = &timeline.curves {
        curves_ui(curves, axis, plot, gutter > 0.0, ui);
        if gutter > 0.0 {
            key_ui(curves, plot_row.with_max_x(axis.x.min - space::S), ui);
        }
    }
    for moment in timeline.moments {
        let center = pos2(axis.x_of(moment.time), bars.top() + head / 2.0);
        let size = 3.0 * scale;
        let diamond = vec![
            center - vec2(0.0, size),
            center + vec2(size, 0.0),
            center + vec2(0.0, size),
            center - vec2(size, 0.0),
        ];
        ui.painter().add(Shape::convex_polygon(diamond, moment.color, Stroke::NONE));
    }
    outside_loop(timeline, axis, area, ui);

    let handles = Handles {
        axis,
        top: bars.top(),
        bottom: plot_row.bottom(),
        id,
    };
    if let (Some(transition), true) = (&timeline.transition, timeline.transition_editable) {
        handles.edge_ui(
            words.transition_start,
            transition.start,
            TimelineEvent::SetTransitionStart,
            timeline,
            &mut events,
            ui,
        );
        handles.edge_ui(
            words.transition_end,
            transition.end,
            TimelineEvent::SetTransitionEnd,
            timeline,
            &mut events,
            ui,
        );
    }
    if let Some(time) = timeline.in_point {
        handles.flag_ui(words.in_point, time, true, TimelineEvent::SetIn, timeline, &mut events, ui);
    }
    if let Some(time) = timeline.out_point {
        handles.flag_ui(words.out_point, time, false, TimelineEvent::SetOut, timeline, &mut events, ui);
    }
    paint_playhead(axis.x_of(now), bars.top(), plot_row.bottom(), &scrub, ui);
    focus_ring(area, radius::S, &scrub, ui);
    if let Some(curves) = &timeline.curves {
        hover_ui(curves, axis, plot, &scrub, ui);
    }
    events
}

/// How high [`timeline_ui`] is with so many tracks and curves of the given height (0: none). It gives its curves all height it is
/// given; this is for panels that want to be as high as it needs.
pub(crate) fn timeline_height(tracks: usize, curves: f32, ui: &Ui) -> f32 {
    let heights = Heights::of(ui);
    heights.head + tracks as f32 * heights.pitch + curves + heights.ruler
}

struct Heights {
    head: f32,
    bar: f32,
    pitch: f32,
    ruler: f32,
}

impl Heights {
    fn of(ui: &Ui) -> Self {
        let scale = theme_of(ui).scale();
        let bar = (16.0 * scale).round();
        Self {
            head: (10.0 * scale).round(),
            bar,
            pitch: bar + space::S,
            ruler: RULER * scale,
        }
    }
}

/// Height of the line with the seconds, at a desk.
const RULER: f32 = 18.0;

fn scrub_ui(timeline: &Timeline<'_>, axis: TimeAxis, scrub: &Response, now: &mut f64, events: &mut Vec<TimelineEvent>, ui: &Ui) {
    let held_id = scrub.id.with("held");
    let was_held = ui.data(|data| data.get_temp::<bool>(held_id)).unwrap_or(false);
    let pointer = scrub.interact_pointer_pos().filter(|_| scrub.is_pointer_button_down_on());
    if let Some(Pos2 { x, .. }) = pointer {
        if !was_held {
            scrub.request_focus();
            ui.data_mut(|data| data.insert_temp(held_id, true));
            events.push(TimelineEvent::ScrubStarted);
        }
        let asked = axis.time_at(x);
        if asked != *now {
            events.push(TimelineEvent::Seek(asked));
            *now = asked;
        }
    } else if was_held {
        ui.data_mut(|data| data.remove::<bool>(held_id));
        events.push(TimelineEvent::ScrubEnded);
    }

    let mut asked = *now;
    let frame = if timeline.fps > 0.0 {
        1.0 / timeline.fps
    } else {
        timeline.duration / 100.0
    };
    if scrub.has_focus() {
        let filter = EventFilter {
            horizontal_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(scrub.id, filter));
        for (key, modifiers) in keys_pressed(ui) {
            let frames = if modifiers.shift { 10.0 } else { 1.0 };
            // From one whole frame to the next, wherever between two one was.
            asked = match key {
                Key::ArrowRight => ((asked / frame).round() + frames) * frame,
                Key::ArrowLeft => ((asked / frame).round() - frames) * frame,
                Key::Home => 0.0,
                Key::End => timeline.duration,
                _ => asked,
            };
        }
    }
    ui.input(|input| {
        let up = input.num_accesskit_action_requests(scrub.id, Action::Increment) as f64;
        let down = input.num_accesskit_action_requests(scrub.id, Action::Decrement) as f64;
        asked += (up - down) * frame;
        for request in input.accesskit_action_requests(scrub.id, Action::SetValue) {
            if let Some(ActionData::NumericValue(value)) = request.data
                && value.is_finite()
            {
                asked = value;
            }
        }
    });
    asked = asked.clamp(0.0, timeline.duration.max(0.0));
    if asked != *now {
        events.push(TimelineEvent::Seek(asked));
        *now = asked;
    }
    let (said, enabled, name) = (*now, ui.is_enabled(), Words::of(ui).timeline);
    scrub.widget_info(|| WidgetInfo::slider(enabled, said, name));
    ui.ctx().accesskit_node_builder(scrub.id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(timeline.duration);
        node.set_numeric_value_step(frame);
        node.set_value(format!("{said:.2} s"));
        node.add_action(Action::SetValue);
        node.add_action(Action::Increment);
        node.add_action(Action::Decrement);
    });
}

fn paint_track(track: &Track<'_>, row: Rangef, axis: TimeAxis, duration: f64, ui: &Ui) {
    let palette = palette_of(ui);
    let (fill, ink) = track.part.fill(palette);
    let (start, end) = (track.start.clamp(0.0, duration), track.end.clamp(0.0, duration));
    let bar = Rect::from_x_y_ranges(axis.x_of(start)..=axis.x_of(end), row);
    if bar.width() < 1.0 {
        return;
    }
    // What fades is a veil of the panel's colour, not nothing: the bar's shape stays in sight to its end.
    let faint = palette.panel.lerp_to_gamma(fill, 0.14);
    let length = (end - start).max(f64::EPSILON);
    let (fade_in, fade_out) = ((track.fade_in / length) as f32, (track.fade_out / length) as f32);
    let mut stops = Vec::new();
    if fade_in > 0.0 {
        stops.push((0.0, faint));
    }
    stops.extend([(fade_in.min(1.0), fill), ((1.0 - fade_out).max(0.0), fill)]);
    if fade_out > 0.0 {
        stops.push((1.0, faint));
    }
    stops.sort_by(|one, other| one.0.total_cmp(&other.0));
    gradient_bar(bar, f32::from(radius::S), &stops, ui.painter());

    // The name stands where the bar is full: at its beginning, or at its end if it fades in.
    let name = line_of(&[Run::new(track.name, Type::SmallStrong, ink)], bar.width() - 2.0 * space::S, ui);
    let (anchor, x) = if fade_in > 0.0 {
        (Align2::RIGHT_CENTER, bar.right() - space::S)
    } else {
        (Align2::LEFT_CENTER, bar.left() + space::S)
    };
    if name.size().x < bar.width() * (1.0 - fade_in - fade_out).max(0.2) {
        put(ui.painter(), pos2(x, row.center()), anchor, name);
    }
}

/// Seconds along the bottom, and hairlines up through the curves.
fn paint_ruler(axis: TimeAxis, bottom: f32, plot: Rect, ruler: Rect, ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    if axis.duration <= 0.0 {
        return;
    }
    let step = nice_step(axis.duration, f64::from(axis.x.span() / (76.0 * theme.scale())));
    let decimals = usize::from(step < 1.0) + usize::from(step < 0.1);
    let line = Stroke::new(theme.hairline(), palette.line.gamma_multiply(0.7));
    ui.painter().hline(axis.x, bottom, Stroke::new(theme.hairline(), palette.line));
    let count = (axis.duration / step + 1e-6).floor() as u32;
    for tick in 0..=count {
        let time = f64::from(tick) * step;
        let x = axis.x_of(time).round();
        if tick > 0 && plot.height() > 0.0 {
            ui.painter().vline(x, plot.y_range(), line);
        }
        let decimals = if tick == 0 { 0 } else { decimals };
        let unit = if tick == 0 { " s" } else { "" };
        let label = line_of(
            &[Run::new(&format!("{time:.decimals$}{unit}"), Type::Small, palette.muted)],
            f32::INFINITY,
            ui,
        );
        let anchor = if tick == 0 { Align2::LEFT_BOTTOM } else { Align2::CENTER_BOTTOM };
        if x + label.size().x / 2.0 <= axis.x.max + 1.0 || tick == 0 {
            put(ui.painter(), pos2(x, ruler.bottom()), anchor, label);
        }
    }
}

/// The step of 1, 2 or 5 times a power of ten that divides `span` into at most `most` pieces.
pub(super) fn nice_step(span: f64, most: f64) -> f64 {
    let rough = span / most.max(1.0);
    if !(rough.is_finite() && rough > 0.0) {
        return 1.0;
    }
    let power = 10.0_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|&step| step >= rough * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// What a loop leaves out is veiled.
fn outside_loop(timeline: &Timeline<'_>, axis: TimeAxis, area: Rect, ui: &Ui) {
    let veil = palette_of(ui).panel.gamma_multiply(0.66);
    let cover = |from: f64, to: f64| {
        if to > from {
            ui.painter()
                .rect_filled(Rect::from_x_y_ranges(axis.x_of(from)..=axis.x_of(to), area.y_range()), 0.0, veil);
        }
    };
    if let Some(time) = timeline.in_point {
        cover(0.0, time);
    }
    if let Some(time) = timeline.out_point {
        cover(time, timeline.duration);
    }
}

fn paint_playhead(x: f32, top: f32, bottom: f32, scrub: &Response, ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let x = ui.painter().round_to_pixel_center(x);
    let width = if theme.projector { 2.0 } else { 1.5 };
    ui.painter()
        .vline(x, top..=bottom, Stroke::new(width + 2.0, palette.panel.gamma_multiply(0.45)));
    ui.painter().vline(x, top..=bottom, Stroke::new(width, palette.handle));
    let hot = ui
        .ctx()
        .animate_bool(scrub.id.with("hot"), scrub.hovered() || scrub.is_pointer_button_down_on());
    ui.painter()
        .circle_filled(pos2(x, top + 2.0), (3.5 + hot) * theme.scale(), palette.handle);
}

/// Things on the timeline that can be dragged along it.
struct Handles {
    axis: TimeAxis,
    top: f32,
    bottom: f32,
    id: Id,
}

impl Handles {
    /// An edge of the transition: bare until the pointer is on it.
    fn edge_ui(
        &self,
        name: &str,
        time: f64,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) {
        let response = self.handle(
            name,
            time,
            Rangef::new(self.top, self.bottom),
            HIT / 2.0,
            event,
            timeline,
            events,
            ui,
        );
        let palette = palette_of(ui);
        let hot = ui
            .ctx()
            .animate_bool(response.id, response.hovered() || response.dragged() || response.has_focus());
        let x = ui.painter().round_to_pixel_center(self.axis.x_of(time));
        let tone = palette.accent.gamma_multiply(0.35 + 0.65 * hot);
        ui.painter()
            .vline(x, self.top..=self.bottom, Stroke::new(theme_of(ui).hairline() + hot, tone));
        if hot > 0.0 {
            let grip = Rect::from_center_size(pos2(x, f32::midpoint(self.top, self.bottom)), vec2(5.0, 22.0));
            ui.painter().rect_filled(grip, 2.5, palette.accent.gamma_multiply(hot));
        }
    }

    /// An end of the loop: a flag that hangs into the loop.
    #[expect(
        clippy::too_many_arguments,
        reason = "the two ends differ in three of them, and a struct would only be taken apart again"
    )]
    fn flag_ui(
        &self,
        name: &str,
        time: f64,
        rightward: bool,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) {
        let response = self.handle(
            name,
            time,
            Rangef::new(self.top - 6.0, self.top + HIT - 6.0),
            HIT,
            event,
            timeline,
            events,
            ui,
        );
        let palette = palette_of(ui);
        let hot = ui
            .ctx()
            .animate_bool(response.id, response.hovered() || response.dragged() || response.has_focus());
        let x = ui.painter().round_to_pixel_center(self.axis.x_of(time));
        let tone = palette.muted.lerp_to_gamma(palette.text, hot);
        ui.painter().vline(
            x,
            self.top..=self.bottom,
            Stroke::new(theme_of(ui).hairline(), tone.gamma_multiply(0.7)),
        );
        let reach = if rightward { 7.0 } else { -7.0 };
        let flag = vec![pos2(x, self.top), pos2(x + reach, self.top), pos2(x, self.top + 9.0)];
        ui.painter().add(Shape::convex_polygon(flag, tone, Stroke::NONE));
    }

    #[expect(clippy::too_many_arguments, reason = "private, and each is one plain thing")]
    fn handle(
        &self,
        name: &str,
        time: f64,
        y: Rangef,
        width: f32,
        event: fn(f64) -> TimelineEvent,
        timeline: &Timeline<'_>,
        events: &mut Vec<TimelineEvent>,
        ui: &Ui,
    ) -> Response {
        let x = self.axis.x_of(time);
        let hit = Rect::from_x_y_ranges(x - width / 2.0..=x + width / 2.0, y);
        let response = ui
            .interact(hit, self.id.with(name), Sense::drag())
            .on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
        if response.drag_started() {
            response.request_focus();
            events.push(TimelineEvent::EditStarted);
        }
        if let Some(pointer) = response
            .interact_pointer_pos()
            .filter(|_| response.dragged() && ui.input(|i| i.pointer.delta().x != 0.0))
        {
            events.push(event(self.axis.time_at(pointer.x)));
        }
        if response.drag_stopped() {
            events.push(TimelineEvent::EditEnded);
        }
        if response.has_focus() {
            let filter = EventFilter {
                horizontal_arrows: true,
                ..EventFilter::default()
            };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
            let frame = if timeline.fps > 0.0 {
                1.0 / timeline.fps
            } else {
                timeline.duration / 100.0
            };
            let presses = ui.input(|i| i.num_presses(Key::ArrowRight) as f64 - i.num_presses(Key::ArrowLeft) as f64);
            if presses != 0.0 {
                events.push(event((time + presses * frame).clamp(0.0, timeline.duration)));
            }
        }
        response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), time, name));
        focus_ring(hit, radius::S, &response, ui);
        response
    }
}

/// A read-only look at the pointer's place in time, for panes that want to show it too.
pub(crate) fn hovered_time(axis: TimeAxis, plot: Rect, response: &Response) -> Option<f64> {
    response
        .hover_pos()
        .filter(|pos| plot.contains(*pos))
        .map(|pos: egui::Pos2| axis.time_at(pos.x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_times_are_inverse_and_stay_inside() {
        let axis = TimeAxis {
            x: Rangef::new(100.0, 500.0),
            duration: 8.0,
        };
        assert_eq!(axis.x_of(2.0), 200.0);
        assert_eq!(axis.time_at(200.0), 2.0);
        assert_eq!(axis.time_at(-50.0), 0.0);
        assert_eq!(axis.time_at(900.0), 8.0);
        let empty = TimeAxis {
            x: Rangef::new(100.0, 500.0),
            duration: 0.0,
        };
        assert_eq!((empty.x_of(3.0), empty.time_at(300.0)), (100.0, 0.0));
    }

    #[test]
    fn steps_are_round_and_few() {
        assert_eq!(nice_step(10.0, 10.0), 1.0);
        assert_eq!(nice_step(3.9, 10.0), 0.5);
        assert_eq!(nice_step(61.0, 8.0), 10.0);
        assert_eq!(nice_step(0.0, 8.0), 1.0);
        for span in [0.3, 1.7, 9.9, 128.0] {
            let step = nice_step(span, 8.0);
            assert!(span / step <= 8.0 + 1e-9 && span / step > 8.0 / 5.1, "{span} in steps of {step}");
        }
    }
}
