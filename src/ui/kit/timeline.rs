//! The timeline: bars for the clips, the transition between them, a playhead over all, and the
//! curves below.

mod content;
mod handles;
mod look;
mod scrub;
mod stances;

use self::handles::Handles;
use self::look::{
    moments_ui, outside_loop, paint_playhead, paint_ruler, paint_stripe, paint_track, stripe_lanes,
};
use self::scrub::scrub_ui;
use self::stances::Lanes;
use super::curves::{curves_ui, hover_ui, key_height, key_ui, plots_in};
use super::paint::{Run, focus_ring, full_width, line_of, put};
use super::time_axis::TimeAxis;
use super::words;
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align2, Id, Rangef, Rect, Sense, Ui, pos2};

pub(crate) use self::content::{
    Moment, StanceEdit, StanceEvent, Stripe, Timeline, TimelineEvent, TimelineResponse, Track,
};
pub(crate) use self::stances::corrected_hint;

/// Draws the bars, the curves, and the playhead over both. Press anywhere to go there, drag to
/// scrub, use the arrow keys for frames.
pub(crate) fn timeline_ui(timeline: &Timeline<'_>, ui: &mut Ui) -> TimelineResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let id = ui.make_persistent_id("timeline");
    let spacing = std::mem::replace(&mut ui.spacing_mut().item_spacing.y, 0.0);

    let gutter = if ui.available_width() < 560.0 * scale { 0.0 } else { (112.0 * scale).round() };
    let Heights { head, bar: bar_height, pitch, .. } = Heights::of(ui);
    // Each of several panes has less room.
    let crowded = timeline.stripes.len() > 3;
    let stripe_pitch = |stripe: &Stripe<'_>| match stripe.edit {
        None => ((if crowded { 0.8 } else { 1.0 }) * STRIPE * scale * pairs(stripe)).round(),
        Some(_) => (edited_stripe(gutter > 0.0) * scale * pairs(stripe)).round(),
    };
    let tracks_height = head + timeline.tracks.len() as f32 * pitch;
    let stripes_height: f32 = timeline.stripes.iter().map(stripe_pitch).sum();
    let bars = full_width(tracks_height + stripes_height, ui);
    let mut slack = None;
    let curve_height = if timeline.curves.is_empty() {
        0.0
    } else {
        let key = match timeline.curves {
            [curves] if gutter > 0.0 => key_height(curves, gutter - SCALE_WIDTH * scale, ui),
            _ => 0.0,
        };
        let least = (MIN_PLOT_HEIGHT * timeline.curves.len() as f32).max(key).ceil();
        let height = (ui.available_height() - (RULER * scale).round()).max(least).floor();
        slack = Some(height - least);
        height
    };
    let plot_row = full_width(curve_height, ui);
    let ruler = full_width((RULER * scale).round(), ui);
    if let Some(slack) = slack {
        ui.data_mut(|data| data.insert_temp(least_bottom_id(), ruler.bottom() - slack));
    }
    ui.spacing_mut().item_spacing.y = spacing;

    let axis = TimeAxis {
        x: Rangef::new(bars.left() + gutter, bars.right()),
        duration: timeline.duration,
    };
    let area = Rect::from_min_max(pos2(axis.x.min, bars.top()), pos2(axis.x.max, ruler.bottom()));
    let plot = plot_row.with_min_x(axis.x.min).with_min_y(plot_row.top() + space::XS);
    let plots: Vec<_> = timeline.curves.iter().zip(plots_in(plot, timeline.curves.len())).collect();

    // Input is read before painting: the playhead is at the pointer in the same frame.
    let mut events = Vec::new();
    let scrub = ui.interact(area, id, Sense::click_and_drag());
    let mut now = timeline.now;
    scrub_ui(timeline, axis, &scrub, &mut now, &mut events, ui);

    // The window of a transition may be longer than what is left of the motion.
    let transition = timeline.transition.as_ref().map(|transition| {
        let within = |secs: f64| secs.clamp(0.0, timeline.duration.max(0.0));
        within(transition.start)..within(transition.end)
    });
    if let Some(transition) = &transition {
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
    let mut tracks = Vec::new();
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
        tracks.push(paint_track(track, row, axis, timeline.duration, ui));
    }
    let mut rows = Vec::new();
    let mut below = bars.top() + tracks_height;
    for stripe in timeline.stripes {
        let row = Rangef::new(below, below + stripe_pitch(stripe) - 2.0);
        below += stripe_pitch(stripe);
        rows.push(row);
        if gutter > 0.0 && stripe.edit.is_none() {
            let label = line_of(
                &[Run::new(stripe.label, Type::Small, palette.muted)],
                gutter - space::S,
                ui,
            );
            put(ui.painter(), pos2(bars.left(), row.center()), Align2::LEFT_CENTER, label);
        }
        paint_stripe(stripe, row, axis, ui);
    }
    for &(curves, plot) in &plots {
        curves_ui(curves, axis, plot, gutter > 0.0, ui);
        if gutter > 0.0 {
            // The values of the scale stand beside it.
            let x = bars.left()..=axis.x.min - SCALE_WIDTH * scale;
            let key = Rect::from_x_y_ranges(x, plot.y_range());
            key_ui(curves, key, now, ui);
        }
    }
    moments_ui(timeline.moments, axis, bars.top() + head / 2.0, id.with("moments"), ui);
    outside_loop(timeline, axis, area, ui);

    for (index, (stripe, row)) in timeline.stripes.iter().zip(rows).enumerate() {
        let Some(edit) = &stripe.edit else {
            continue;
        };
        let rows = stripe_lanes(stripe.feet.len(), row).collect();
        let lanes = Lanes { index, stripe, edit, rows, axis, id: id.with(("stances", index)) };
        if gutter > 0.0 {
            let x = bars.left()..=axis.x.min - space::S;
            lanes.label_ui(Rect::from_x_y_ranges(x, row), now, &mut events, ui);
        }
        lanes.stances_ui(timeline, &mut events, ui);
    }
    let handles = Handles { axis, top: bars.top(), bottom: plot_row.bottom(), id };
    if let (Some(transition), true) = (&transition, timeline.transition_editable) {
        handles.edge_ui(
            words::TRANSITION_START,
            transition.start,
            TimelineEvent::SetTransitionStart,
            timeline,
            &mut events,
            ui,
        );
        handles.edge_ui(
            words::TRANSITION_END,
            transition.end,
            TimelineEvent::SetTransitionEnd,
            timeline,
            &mut events,
            ui,
        );
    }
    if let Some(time) = timeline.in_point {
        handles.flag_ui(
            words::IN_POINT,
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
            words::OUT_POINT,
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
    hover_ui(&plots, axis, &scrub, ui);
    TimelineResponse { events, bars: tracks }
}

/// Returns the lower edge on the page that the timeline drawn last needs: its curves fill all the
/// room that there is. `None` where none with curves was drawn since the last call.
pub(crate) fn take_least_bottom(ui: &Ui) -> Option<f32> {
    ui.data_mut(|data| data.remove_temp(least_bottom_id()))
}

fn least_bottom_id() -> Id {
    Id::unique("least bottom of the timeline")
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

/// The minimum height of a plot, points.
const MIN_PLOT_HEIGHT: f32 = 48.0;

/// Width of the values of a scale beside a plot at scale 1, points.
const SCALE_WIDTH: f32 = 32.0;

/// Height of a stripe of stances at scale 1, points.
const STRIPE: f32 = 15.0;

/// Returns the height of a stripe whose stances can be corrected at scale 1, points. Without a
/// space before it the page is narrow, and fingers need more.
fn edited_stripe(has_gutter: bool) -> f32 {
    if has_gutter { 28.0 } else { 44.0 }
}

/// Returns the number of pairs of feet in a stripe, at least one: each has the height of a stripe.
fn pairs(stripe: &Stripe<'_>) -> f32 {
    stripe.feet.len().div_ceil(2).max(1) as f32
}

/// Height of the line with the seconds at scale 1, points.
const RULER: f32 = 18.0;
