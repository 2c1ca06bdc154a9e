//! The bottom panel: the clips with the current frame jumping on them, and the costs over time.

use super::present::shown;
use crate::ui::kit::{
    self, Curves, Moment, PlaceBar, Places, Series, StripPlace, Timeline, TimelineEvent,
};
use crate::ui::language::{Word, say};
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::text;
use crate::ui::theme::{Palette, Type, palette_of, space, theme_of};
use crate::ui::transport_row::{Playhead, transport_row_ui};
use eframe::egui::{Color32, Label, RichText, Ui};
use segue_motion::matching::{Database, Place, RATE, Tag};
use segue_session::{Command, DriveHistory, Key, Outcome, PlaybackCommand, Session, Value};
use segue_text::Message;

/// The time for which a jump is shown, seconds.
const JUMP_SECS: f64 = 0.8;
/// The length of the axis of time before the first search, seconds.
const EMPTY_SECS: f64 = 10.0;
/// The greatest number of marks: more could not be told apart.
const MAX_MARKS: usize = 160;
/// The greatest number of clips in the strip: more would have no width.
const MAX_BARS: usize = 300;

/// Draws the panel.
pub(crate) fn drive_panel_ui(
    session: &Session,
    outcome: &Outcome,
    driven: &DriveHistory,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let now = session.now_secs();
    let frames = if driven.is_live { session.recording().ticks() } else { driven.moments.len() };
    let caption = caption(session, driven);
    let playhead = if driven.is_live {
        Playhead { secs: frames as f64 / RATE as f64, frame: frames, frames }
    } else {
        Playhead { secs: now, frame: (now * RATE as f64).round() as usize, frames }
    };
    transport_row_ui(playhead, &caption, layout, session, out, ui);
    let scale = theme_of(ui).scale();
    let rows = if driven.database.options().mirrored { 2.0 } else { 1.0 };
    // The curves below the strip need room as well.
    let most = if layout == Layout::Phone { 1.0 } else { 0.4 } * ui.available_height();
    let height = ((rows * 20.0 + 16.0) * scale).min(most);
    strip_ui(session, driven, now, height, state, ui);
    if layout != Layout::Phone {
        ui.add_space(space::XS);
        time_ui(session, outcome, driven, out, ui);
    }
}

/// Returns the outcome of the last search, in a few words.
fn caption(session: &Session, driven: &DriveHistory) -> Message {
    let search = shown(session).and_then(|(_, moment)| moment.search.as_ref());
    search.map_or_else(Message::default, |search| text::outcome_of_search(search, driven.is_live))
}

/// Draws the costs of continuing and of the best frame, with a mark at each jump.
fn time_ui(
    session: &Session,
    outcome: &Outcome,
    driven: &DriveHistory,
    out: &mut Out,
    ui: &mut Ui,
) {
    let palette = palette_of(ui);
    let (mut current, mut best, mut last) = (Vec::new(), Vec::new(), None);
    for (frame, moment) in driven.moments.iter().enumerate() {
        let Some(search) = moment.search.as_ref().filter(|search| last != Some(search.tick)) else {
            continue;
        };
        last = Some(search.tick);
        let secs = frame as f64 / RATE as f64;
        current.push([secs, f64::from(search.current.cost)]);
        if let Some(winner) = &search.winner {
            best.push([secs, f64::from(winner.cost)]);
        }
    }
    let series = [
        Series {
            name: text::COST_GOING_ON.into(),
            color: palette.muted,
            ink: palette.muted,
            strong: false,
            is_source: false,
            points: &current,
            values: None,
        },
        Series {
            name: text::COST_BEST.into(),
            color: palette.b,
            ink: palette.b_ink,
            strong: true,
            is_source: false,
            points: &best,
            values: None,
        },
    ];
    let mut jumps: Vec<Moment> = driven
        .jumps_secs()
        .map(|time| Moment { time, color: palette.accent, name: text::JUMP })
        .collect();
    if jumps.len() > MAX_MARKS {
        jumps.clear();
    }
    let lasts = if driven.is_live { outcome.duration_secs() } else { session.duration_secs() };
    let nothing_yet = current.is_empty();
    let timeline = Timeline {
        // Without a search there is an axis all the same, and room for a sentence.
        duration: if nothing_yet { lasts.max(EMPTY_SECS) } else { lasts },
        now: session.now_secs(),
        fps: RATE as f64,
        in_point: session.params().optional(Key::In).filter(|_| !driven.is_live),
        out_point: session.params().optional(Key::Out).filter(|_| !driven.is_live),
        moments: &jumps,
        curves: &[Curves {
            title: text::COST,
            unit: Word::default(),
            decimals: 2,
            include: Some(0.0),
            series: &series,
            ..Curves::default()
        }],
        ..Timeline::default()
    };
    let top = ui.cursor().top();
    let events = kit::timeline_ui(&timeline, ui).events;
    if nothing_yet {
        let plot = ui.max_rect().with_min_y(top).intersect(ui.min_rect());
        let words = RichText::new(say(text::COSTS_LATER, ui)).font(theme_of(ui).font(Type::Small));
        ui.put(plot, Label::new(words.color(palette.muted)));
    }
    for event in events {
        match event {
            _ if driven.is_live => {}
            TimelineEvent::Seek(secs) => {
                out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)));
            }
            TimelineEvent::ScrubStarted => out.set(Key::Play, Value::Switch(false)),
            TimelineEvent::SetIn(secs) => out.set(Key::In, Value::Number(secs)),
            TimelineEvent::SetOut(secs) => out.set(Key::Out, Value::Number(secs)),
            TimelineEvent::EditEnded => out.commands.push(Command::Settle),
            _ => {}
        }
    }
}

/// Returns the colour of a tag.
fn tag_color(tag: Tag, palette: &Palette) -> Color32 {
    match tag {
        Tag::Walk => palette.b,
        Tag::Run => palette.a,
        Tag::Idle => palette.line_strong,
        Tag::Turn => palette.others[1],
        Tag::Exclude => palette.bad,
        Tag::Own(_) => palette.accent,
    }
}

fn strip_ui(
    session: &Session,
    driven: &DriveHistory,
    now_secs: f64,
    height: f32,
    state: &mut UiState,
    ui: &mut Ui,
) {
    let palette = palette_of(ui);
    let database = &driven.database;
    let mirrored = database.options().mirrored;
    let originals = database.motions().iter().filter(|motion| !motion.is_mirrored());
    let bars: Vec<PlaceBar> = originals
        .take(MAX_BARS)
        .map(|motion| PlaceBar {
            name: session.clip_title(motion.clip().name()),
            frames: motion.frames(),
            stretches: (motion.tags().iter())
                .map(|range| (range.frames.clone(), tag_color(range.tag, palette)))
                .collect(),
        })
        .collect();
    let at = |place: Place| strip_place(database, place);
    let frame = (now_secs * RATE as f64).round().max(0.0) as usize;
    let moment = driven.at(now_secs);
    let reach = (JUMP_SECS * RATE as f64) as usize;
    let moments =
        driven.moments.get(frame.saturating_sub(reach)..(frame + 1).min(driven.moments.len()));
    let mut jumps = Vec::new();
    for (index, moment) in moments.unwrap_or(&[]).iter().rev().enumerate() {
        if let (true, Some(search)) = (moment.jumped, &moment.search)
            && let (Some(from), Some(to)) =
                (at(search.current.place), search.winner.and_then(|winner| at(winner.place)))
        {
            jumps.push((from, to, 1.0 - index as f32 / reach as f32));
        }
    }
    let marks: Vec<StripPlace> = moment
        .and_then(|moment| moment.search.as_ref())
        .map(|search| {
            search.candidates.iter().filter_map(|candidate| at(candidate.place)).collect()
        })
        .unwrap_or_default();
    let legend: Vec<(Word, Color32)> = [Tag::Idle, Tag::Walk, Tag::Run, Tag::Turn]
        .into_iter()
        .map(|tag| (Word::new(tag.name()), tag_color(tag, palette)))
        .collect();
    let places = Places {
        label: text::CLIP_STRIP,
        title: text::CLIP_STRIP_TITLE,
        bars: &bars,
        rows: if mirrored { 2 } else { 1 },
        now: moment.and_then(|moment| at(moment.place)),
        jumps: &jumps,
        chosen: state.labs.match_.stretch.as_ref(),
        marks: &marks,
        legend: &legend,
    };
    if let Some(stretch) = kit::places_ui(&places, height, ui) {
        state.labs.match_.stretch = Some(stretch);
    }
}

/// Returns the place of a frame in the strip. A clip's mirror image follows it, so that half the
/// index of a motion is the index of its clip.
pub(crate) fn strip_place(database: &Database, place: Place) -> Option<StripPlace> {
    let motion = database.motion(place.motion)?;
    let bar = if database.options().mirrored { place.motion / 2 } else { place.motion };
    (bar < MAX_BARS).then_some(StripPlace {
        bar,
        row: usize::from(motion.is_mirrored()),
        frame: place.frame,
    })
}
