//! The painting of a timeline: bars, seconds, the playhead, and the parts outside the loop.

use super::super::assistive::describe;
use super::super::chip::Part;
use super::super::paint::{Run, gradient_bar, line_of, put};
use super::super::time_axis::{TimeAxis, nice_step};
use super::content::{Moment, Stripe, Timeline, Track};
use crate::ui::language::{Text, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Id, Pos2, Rangef, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};
use segue_motion::math::sort::sort_by;
use segue_text::{Message, msg};

/// Draws the bar of a track, and returns its place.
pub(super) fn paint_track(
    track: &Track<'_>,
    row: Rangef,
    axis: TimeAxis,
    duration: f64,
    ui: &Ui,
) -> Rect {
    let palette = palette_of(ui);
    let (fill, ink) = track.part.fill(palette);
    let (start, end) = (track.start.clamp(0.0, duration), track.end.clamp(0.0, duration));
    let bar = Rect::from_x_y_ranges(axis.x_of(start)..=axis.x_of(end), row);
    if bar.width() < 1.0 {
        return bar;
    }
    // A fade ends in a faint colour, not in none: the bar's shape stays in sight to its end.
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
    sort_by(&mut stops, |one, other| one.0.total_cmp(&other.0));
    gradient_bar(bar, f32::from(radius::S), &stops, ui.painter());

    // The name is at the opaque end of the bar: the beginning, or the end if it fades in.
    let name =
        line_of(&[Run::new(track.name, Type::SmallStrong, ink)], bar.width() - 2.0 * space::S, ui);
    let (anchor, x) = if fade_in > 0.0 {
        (Align2::RIGHT_CENTER, bar.right() - space::S)
    } else {
        (Align2::LEFT_CENTER, bar.left() + space::S)
    };
    if name.size().x < bar.width() * (1.0 - fade_in - fade_out).max(0.2) {
        put(ui.painter(), pos2(x, row.center()), anchor, name);
    }
    bar
}

/// Draws seconds along the bottom, and hairlines up through the curves.
pub(super) fn paint_ruler(axis: TimeAxis, bottom: f32, plot: Rect, ruler: Rect, ui: &Ui) {
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
        let label = format!("{time:.decimals$}{unit}");
        let run = Run::new(Text::Data(&label), Type::Small, palette.muted);
        let label = line_of(&[run], f32::INFINITY, ui);
        let anchor = if tick == 0 { Align2::LEFT_BOTTOM } else { Align2::CENTER_BOTTOM };
        if x + label.size().x / 2.0 <= axis.x.max + 1.0 || tick == 0 {
            put(ui.painter(), pos2(x, ruler.bottom()), anchor, label);
        }
    }
}

/// Veils the parts outside the loop.
pub(super) fn outside_loop(timeline: &Timeline<'_>, axis: TimeAxis, area: Rect, ui: &Ui) {
    let veil = palette_of(ui).panel.gamma_multiply(0.66);
    let cover = |from: f64, to: f64| {
        if to > from {
            ui.painter().rect_filled(
                Rect::from_x_y_ranges(axis.x_of(from)..=axis.x_of(to), area.y_range()),
                0.0,
                veil,
            );
        }
    };
    if let Some(time) = timeline.in_point {
        cover(0.0, time);
    }
    if let Some(time) = timeline.out_point {
        cover(time, timeline.duration);
    }
}

pub(super) fn paint_playhead(x: f32, top: f32, bottom: f32, scrub: &Response, ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let x = ui.painter().round_to_pixel_center(x);
    let width = if theme.projector { 2.0 } else { 1.5 };
    ui.painter().vline(
        x,
        top..=bottom,
        Stroke::new(width + 2.0, palette.panel.gamma_multiply(0.45)),
    );
    ui.painter().vline(x, top..=bottom, Stroke::new(width, palette.handle));
    let hot = ui
        .ctx()
        .animate_bool(scrub.id.with("hot"), scrub.hovered() || scrub.is_pointer_button_down_on());
    ui.painter().circle_filled(pos2(x, top + 2.0), (3.5 + hot) * theme.scale(), palette.handle);
}

/// Returns the lines of the feet in the row of a stripe.
pub(super) fn stripe_lanes(feet: usize, row: Rangef) -> impl Iterator<Item = Rangef> {
    let count = feet.max(1) as f32;
    let height = (row.span() - (count - 1.0)) / count;
    (0..feet).map(move |foot| {
        let top = row.min + foot as f32 * (height + 1.0);
        Rangef::new(top, top + height)
    })
}

/// Draws the stances of a motion as bars.
pub(super) fn paint_stripe(stripe: &Stripe<'_>, row: Rangef, axis: TimeAxis, ui: &Ui) {
    let palette = palette_of(ui);
    let color =
        if stripe.part == Part::Result { palette.accent } else { stripe.part.fill(palette).0 };
    for (stances, lane) in stripe.feet.iter().zip(stripe_lanes(stripe.feet.len(), row)) {
        let lane = Rect::from_x_y_ranges(axis.x, lane);
        ui.painter().rect_filled(lane, 1.0, palette.track.gamma_multiply(0.5));
        for stance in stances {
            let bar = Rect::from_x_y_ranges(
                axis.x_of(stance.start)..=axis.x_of(stance.end.min(axis.duration)),
                lane.y_range(),
            );
            ui.painter().rect_filled(bar, 1.0, color);
        }
    }
}

/// The greatest number of moments with an element each: more would be too many to read aloud, and
/// hardly distinguishable on the screen.
const MAX_MOMENT_ELEMENTS: usize = 60;
/// The width and height of the area in which the pointer shows a moment's name, points.
const MOMENT_SIZE: f32 = 12.0;

/// Draws the moments in a row around the height `y`. More than [`MAX_MOMENT_ELEMENTS`], which must
/// be of one kind, are one element: its label has the name of the first and their number, its hint
/// the name of the moment nearest to the pointer.
pub(super) fn moments_ui(moments: &[Moment], axis: TimeAxis, y: f32, id: Id, ui: &Ui) {
    let place = |moment: &Moment| pos2(axis.x_of(moment.time), y);
    let Some(first) = moments.first().filter(|_| moments.len() > MAX_MOMENT_ELEMENTS) else {
        for (index, moment) in moments.iter().enumerate() {
            let area = Rect::from_center_size(place(moment), Vec2::splat(MOMENT_SIZE));
            paint_moment(moment, place(moment), ui);
            let response = ui.interact(area, id.with(index), Sense::hover());
            let said = name_of(moment);
            describe(&response, &WidgetInfo::labeled(Role::Label, true, say(&said, ui)));
            response.on_hover_text(say(&said, ui));
        }
        return;
    };
    for moment in moments {
        paint_moment(moment, place(moment), ui);
    }
    let row =
        Rect::from_x_y_ranges(axis.x, Rangef::new(y - 0.5 * MOMENT_SIZE, y + 0.5 * MOMENT_SIZE));
    let response = ui.interact(row, id, Sense::hover());
    let said = msg!("{name}, {count} times", name = first.name, count = moments.len());
    describe(&response, &WidgetInfo::labeled(Role::Label, true, say(&said, ui)));
    let distance = |moment: &Moment, at: Pos2| (place(moment).x - at.x).abs();
    let nearest = response.hover_pos().and_then(|at| {
        let nearest = moments.iter().min_by(|a, b| distance(a, at).total_cmp(&distance(b, at)))?;
        (distance(nearest, at) <= 0.5 * MOMENT_SIZE).then_some(nearest)
    });
    if let Some(moment) = nearest {
        response.on_hover_text_at_pointer(say(&name_of(moment), ui));
    }
}

fn name_of(moment: &Moment) -> Message {
    msg!("{name}, {secs:.2} s", name = moment.name, secs = moment.time)
}

/// Draws a moment: a small diamond.
fn paint_moment(moment: &Moment, center: Pos2, ui: &Ui) {
    let size = 3.0 * theme_of(ui).scale();
    let diamond = vec![
        center - vec2(0.0, size),
        center + vec2(size, 0.0),
        center + vec2(0.0, size),
        center - vec2(size, 0.0),
    ];
    ui.painter().add(Shape::convex_polygon(diamond, moment.color, Stroke::NONE));
}
