//! The bottom panel: the timeline.

mod contacts;
mod curve_values;
mod curves;
mod events;
mod tracks;

pub(crate) use self::curves::CurveCache;

use self::curves::{Curve, CurveOf, Plotted, curve_menu_ui, unit_of};
use self::events::timeline_event;
use self::tracks::{
    feet_names, hard_turns, named_outcomes, round_name, seams, stripes, tracks, whole_track,
};
use crate::ui::clip_drag::take_drop_on_slot;
use crate::ui::kit::{self, Curves, Part, Series, Timeline};
use crate::ui::labs::in_time;
use crate::ui::language::Word;
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{Palette, palette_of};
use crate::ui::transport_row::{Playhead, transport_row_ui};
use eframe::egui::Ui;
use segue_motion::skeleton::Role;
use segue_session::choices;
use segue_session::{Key, Pane, Session, Slot, frame_at};
use segue_text::{Message, msg};

/// Draws the seconds alone, with the playhead and the ends of the loop.
pub(crate) fn scrub_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let Some(outcome) = session.main_outcome() else {
        return;
    };
    let params = session.params();
    let timeline = Timeline {
        duration: session.duration_secs(),
        now: session.now_secs(),
        fps: outcome.motion.clip().fps(),
        transition: outcome.transition.map(|transition| transition.start_secs..transition.end_secs),
        in_point: params.optional(Key::In),
        out_point: params.optional(Key::Out),
        ..Timeline::default()
    };
    for event in kit::timeline_ui(&timeline, ui).events {
        timeline_event(event, &[], session, outcome, out);
    }
}

/// Draws the panel: the strip of a walk or drive, else the timeline of the result.
pub(crate) fn timeline_panel_ui(
    session: &Session,
    layout: Layout,
    cache: &mut CurveCache,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    if in_time::strip_ui(session, layout, state, out, ui) {
        return;
    }
    let params = session.params();
    let Some(outcome) = session.main_outcome() else {
        in_time::part_ui(session, out, ui);
        return kit::note_ui(text::EMPTY_PANE, palette_of(ui).muted, ui);
    };
    let clip = outcome.motion.clip();
    let plotted = Plotted::of(params);
    let role = Role::ALL.into_iter().find(|role| role.name() == plotted.joint);
    let plan = outcome.motion.roles().body_plan();
    let joint_title =
        role.map_or_else(|| Message::data(&*plotted.joint), |role| role.name_in(plan).into());
    let caption = match plotted.quantities[..] {
        [quantity] => {
            let (what, unit) = (quantity.label(), unit_of(quantity));
            msg!("{joint} · {what} {unit}", joint = joint_title.clone(), what, unit)
        }
        _ => joint_title.clone(),
    };
    let playhead = Playhead {
        secs: session.now_secs(),
        frame: frame_at(&outcome.motion, session.now_secs()),
        frames: clip.frames(),
    };
    let row = transport_row_ui(playhead, &caption, layout, session, out, ui);
    if layout != Layout::Phone {
        curve_menu_ui(session, outcome, &row, out, ui);
    }
    in_time::part_ui(session, out, ui);

    let panes = named_outcomes(session);
    cache.update(outcome, &panes, &plotted);
    let palette = palette_of(ui);
    let series: Vec<Vec<Series<'_>>> =
        cache.plots.iter().map(|plot| series_of(&plot.lines, palette)).collect();
    let made_from = session.panes().first().and_then(Pane::made_from).unwrap_or(params);
    let names = [Key::A, Key::B].map(|key| {
        session.library().find(made_from.text(key)).map(|entry| entry.title()).unwrap_or_default()
    });
    let names = match outcome.walk() {
        Some(walk) => [0, 1].map(|part: usize| {
            let clip = walk.passed.get(part).map(|passed| passed.stay.clip);
            clip.and_then(|clip| walk.built.clips().names().get(clip))
                .map(|name| session.clip_title(name))
                .unwrap_or_default()
        }),
        None => names,
    };
    let made = in_time::made_name(made_from);
    let round = round_name(outcome, &names);
    let tracks = if outcome.registered().is_some() {
        // The stances of both clips take the place of their bars.
        Vec::new()
    } else if let Some(made) = &made {
        vec![whole_track(Part::Result, made, outcome)]
    } else if outcome.cycle.is_some() {
        vec![whole_track(Part::Result, &round, outcome)]
    } else {
        tracks(outcome, &names)
    };
    let curves = cache.plots.iter().zip(&series).map(|(plot, series)| Curves {
        of: (&joint_title).into(),
        title: Word::new(plot.quantity.label()),
        unit: Word::new(unit_of(plot.quantity)),
        decimals: 2,
        include: (plot.quantity != choices::Curve::Turn).then_some(0.0),
        series,
    });
    let curves: Vec<_> = curves.collect();
    let mut seams = seams(outcome, palette.accent);
    seams.extend(hard_turns(outcome, palette.warning));
    seams.extend(in_time::moments(session, [palette.accent, palette.warning]));
    let feet = feet_names(session, layout);
    // A lab with stripes of registered clips shows none of clips frame by frame.
    let clips = session.contact_clips();
    let labels = contacts::labels(&clips, session);
    let mut stripes = stripes(session, &feet);
    if stripes.is_empty() {
        stripes = contacts::stripes(&clips, &labels, session);
    }
    let timeline = Timeline {
        duration: session.duration_secs(),
        now: session.now_secs(),
        fps: clip.fps(),
        tracks: &tracks,
        stripes: &stripes,
        transition: outcome.transition.map(|transition| transition.start_secs..transition.end_secs),
        transition_editable: session.panes().len() == 1 && outcome.walk().is_none(),
        // Without marks the handles are at the ends.
        in_point: Some(params.optional(Key::In).unwrap_or(0.0)),
        out_point: Some(params.optional(Key::Out).unwrap_or(session.duration_secs())),
        moments: &seams,
        curves: if layout == Layout::Phone { &[] } else { &curves },
    };
    let response = kit::timeline_ui(&timeline, ui);
    for event in response.events {
        timeline_event(event, &clips, session, outcome, out);
    }
    for (track, bar) in tracks.iter().zip(response.bars) {
        let slot = match track.part {
            Part::A => Slot::A,
            Part::B => Slot::B,
            Part::Result | Part::None => continue,
        };
        if session.uses(slot) {
            take_drop_on_slot(slot, bar, session, out, ui);
        }
    }
}

/// Returns the curves of a plot in the colours of their owners.
fn series_of<'a>(lines: &'a [Curve], palette: &Palette) -> Vec<Series<'a>> {
    let series = |curve: &'a Curve| {
        let (points, name) = (&curve.points, curve.of.name());
        let values = curve.values.as_ref().map(|values| values as &dyn kit::SeriesValues);
        match &curve.of {
            CurveOf::Source(part) => Series {
                color: part.fill(palette).0,
                ink: part.ink(palette),
                strong: false,
                is_source: true,
                name,
                points,
                values,
            },
            CurveOf::Pane(index, _) => Series {
                // The first result, which the rest of the page shows, has the accent; two more
                // differ in lightness, the last has a colour that neither clip has.
                color: [palette.accent, palette.text, palette.muted, palette.others[1]][index % 4],
                ink: [palette.accent_ink, palette.text, palette.muted, palette.others[1]]
                    [index % 4],
                strong: *index == 0,
                is_source: false,
                name,
                points,
                values,
            },
        }
    };
    lines.iter().map(series).collect()
}

/// Returns the height that the panel needs beyond that for bars and one curve at scale 1, points.
pub(crate) fn more_height(session: &Session) -> f32 {
    /// Height of a further plot.
    const PLOT: f32 = 46.0;
    /// Height of the contacts of a pair of feet.
    const CONTACTS: f32 = 28.0;
    let is_strip = in_time::has_strip(session);
    let plots = session.params().plotted_curves().len().saturating_sub(1);
    let clips = session.contact_clips();
    let pairs: usize =
        clips.iter().map(|clip| clip.motion.contacts().feet().len().div_ceil(2)).sum();
    if is_strip { 0.0 } else { plots as f32 * PLOT + pairs as f32 * CONTACTS }
}
