//! What happens in time: bars for the clips, the transition between them, a playhead over all, and
//! the curves below.

mod handles;
mod look;
mod scrub;

use self::handles::Handles;
use self::look::{moment_ui, outside_loop, paint_playhead, paint_ruler, paint_stripe, paint_track};
use self::scrub::scrub_ui;
use super::chip::Part;
use super::curves::{Curves, curves_ui, hover_ui, key_ui};
use super::paint::{Run, focus_ring, full_width, line_of, put};
use super::words::Words;
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align2, Color32, Rangef, Rect, Response, Sense, Ui, pos2};
use std::ops::Range;

pub(super) use self::look::nice_step;

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

/// When the feet of a motion stand: the left one in the upper line, the right one in the lower.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Stripe<'a> {
    /// Whose feet: gives the colour.
    pub(crate) part: Part,
    /// What stands before them.
    pub(crate) label: &'a str,
    /// From and to, seconds: left, right.
    pub(crate) feet: [Vec<Range<f64>>; 2],
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
    /// When feet stand, below the clips, from top to bottom.
    pub(crate) stripes: &'a [Stripe<'a>],
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

/// The bars, the curves, and the playhead over both. Press anywhere to go there, drag to scrub, use
/// the arrow keys for frames.
pub(crate) fn timeline_ui(timeline: &Timeline<'_>, ui: &mut Ui) -> Vec<TimelineEvent> {
    let (theme, palette, words) = (theme_of(ui), palette_of(ui), Words::of(ui));
    let scale = theme.scale();
    let id = ui.make_persistent_id("timeline");
    let spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let gutter = if ui.available_width() < 560.0 * scale { 0.0 } else { (112.0 * scale).round() };
    let Heights { head, bar: bar_height, pitch, .. } = Heights::of(ui);
    // Of several panes each has less room.
    let crowded = timeline.stripes.len() > 3;
    let stripe_pitch = ((if crowded { 0.8 } else { 1.0 }) * STRIPE * scale).round();
    let tracks_height = head + timeline.tracks.len() as f32 * pitch;
    let bars = full_width(tracks_height + timeline.stripes.len() as f32 * stripe_pitch, ui);
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
            let label = line_of(
                &[Run::new(track.label, Type::Small, palette.muted)],
                gutter - space::S,
                ui,
            );
            put(ui.painter(), pos2(bars.left(), row.center()), Align2::LEFT_CENTER, label);
        }
        paint_track(track, row, axis, timeline.duration, ui);
    }
    for (index, stripe) in timeline.stripes.iter().enumerate() {
        let y = bars.top() + tracks_height + index as f32 * stripe_pitch;
        let row = Rangef::new(y, y + stripe_pitch - 2.0);
        if gutter > 0.0 {
            let label = line_of(
                &[Run::new(stripe.label, Type::Small, palette.muted)],
                gutter - space::S,
                ui,
            );
            put(ui.painter(), pos2(bars.left(), row.center()), Align2::LEFT_CENTER, label);
        }
        paint_stripe(stripe, row, axis, ui);
    }
    if let Some(curves) = &timeline.curves {
        curves_ui(curves, axis, plot, gutter > 0.0, ui);
        if gutter > 0.0 {
            key_ui(curves, plot_row.with_max_x(axis.x.min - space::S), ui);
        }
    }
    for (index, moment) in timeline.moments.iter().enumerate() {
        moment_ui(
            moment,
            pos2(axis.x_of(moment.time), bars.top() + head / 2.0),
            id.with(("moment", index)),
            ui,
        );
    }
    outside_loop(timeline, axis, area, ui);

    let handles = Handles { axis, top: bars.top(), bottom: plot_row.bottom(), id };
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
        handles.flag_ui(
            words.in_point,
            time,
            true,
            TimelineEvent::SetIn,
            timeline,
            &mut events,
            ui,
        );
    }
    if let Some(time) = timeline.out_point {
        handles.flag_ui(
            words.out_point,
            time,
            false,
            TimelineEvent::SetOut,
            timeline,
            &mut events,
            ui,
        );
    }
    paint_playhead(axis.x_of(now), bars.top(), plot_row.bottom(), &scrub, ui);
    focus_ring(area, radius::S, &scrub, ui);
    if let Some(curves) = &timeline.curves {
        hover_ui(curves, axis, plot, &scrub, ui);
    }
    events
}

struct Heights {
    head: f32,
    bar: f32,
    pitch: f32,
}

impl Heights {
    fn of(ui: &Ui) -> Self {
        let scale = theme_of(ui).scale();
        let bar = (16.0 * scale).round();
        Self { head: (10.0 * scale).round(), bar, pitch: bar + space::S }
    }
}

/// Height of a stripe of feet, at a desk.
const STRIPE: f32 = 15.0;

/// Height of the line with the seconds, at a desk.
const RULER: f32 = 18.0;

/// A read-only look at the pointer's place in time, for panes that want to show it too.
pub(crate) fn hovered_time(axis: TimeAxis, plot: Rect, response: &Response) -> Option<f64> {
    response.hover_pos().filter(|pos| plot.contains(*pos)).map(|pos| axis.time_at(pos.x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_times_are_inverse_and_stay_inside() {
        let axis = TimeAxis { x: Rangef::new(100.0, 500.0), duration: 8.0 };
        assert_eq!(axis.x_of(2.0), 200.0);
        assert_eq!(axis.time_at(200.0), 2.0);
        assert_eq!(axis.time_at(-50.0), 0.0);
        assert_eq!(axis.time_at(900.0), 8.0);
        let empty = TimeAxis { x: Rangef::new(100.0, 500.0), duration: 0.0 };
        assert_eq!((empty.x_of(3.0), empty.time_at(300.0)), (100.0, 0.0));
    }
}
