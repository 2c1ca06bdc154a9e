//! The Register lab: the map of distances with the path on it, and the parameters of the result.

use crate::ui::kit::{
    self, Button, Feet, HeatMap, HeatMapEvent, Icon, MapCurve, SliderRow, WeightCurveEvent,
    WeightCurveRow,
};
use crate::ui::labs::lab_ui::{Compares, Edge, LabUi, Shown, Title};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::Out;
use crate::ui::rows::clip_sets_ui;
use crate::ui::rows::{Detail, KeepOffer, param_row_ui};
use crate::ui::rows::{
    clip_choice_ui, clip_list_ui, compare_ui, foot_rows_ui, frames_of_both, pair_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Palette, Type, palette_of, space, theme_of};
use eframe::egui::{Color32, ColorImage, Id, RichText, TextureHandle, TextureOptions, Ui};
use segue_motion::skeleton::Foot;
use segue_session::JobKind;
use segue_session::choices::{self, WarpMode};
use segue_session::{
    Command, Compare, DistanceMap, Key, List, MAX_WEIGHTED_CLIPS, PlaybackCommand,
    RegistrationFacts, Session, Value, weight_curve,
};
use segue_text::{Message, msg};
use std::ops::Range;
use std::sync::Arc;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: register_ui,
    about: [text::REGISTER_ABOUT, text::REGISTER_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_warps),
    title,
    hint: |_| Some(text::REGISTER_HINT),
    take_line: None,
};

/// Returns the value that dragging an end of the transition to a time sets; `None` where nothing of
/// A plays then.
pub(super) fn edge_value(
    edge: Edge,
    secs: f64,
    registered: &RegistrationFacts,
    fps: f64,
) -> Option<(Key, f64)> {
    match edge {
        Edge::Start => Some((Key::WarpFrom, secs.max(0.0))),
        // The end is a time of A, which is warped until then.
        Edge::End => {
            let frame_pair = registered.frame_pair_at(secs)?;
            Some((Key::WarpTo, (frame_pair.frames[0] / fps).max(0.0)))
        }
    }
}

fn title(shown: &Shown<'_>) -> Title {
    let b = shown.name(Key::B);
    let text = if shown.params.choice::<choices::WarpMode>() == choices::WarpMode::Join {
        msg!("→ {clip}", clip = b)
    } else {
        let others = shown.session.params().weighted_clips().iter();
        let others = others.map(|(id, _)| shown.name_of(id).unwrap_or_else(|| id.clone().into()));
        let names: Vec<Message> =
            std::iter::once(b).chain(others).map(|clip| msg!("+ {clip}", clip)).collect();
        Message::joined(names, " ")
    };
    Title { strong: shown.name(Key::A), text, secondary: shown.spoken(Key::WarpWith) }
}

/// The weight of a clip that is added to a blend.
const FIRST_SHARE: f64 = 0.25;

/// Draws the rows of the lab.
pub(super) fn register_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    clip_sets_ui(session, out, ui);
    pair_ui(session, out, ui);
    // The whole map should be in sight at once.
    let room = 0.85 * ui.clip_rect().height();
    map_ui(session, room, state, out, ui);
    let params = session.params();
    let plain = Detail::default();
    param_row_ui(Key::WarpWith, &plain, session, out, ui);
    let on = session.compare().is_some_and(|compare| compare.key == Key::WarpWith);
    if kit::button_ui(Button::new(text::REGISTERED_AND_PLAIN).selected(on), ui).clicked() {
        compare_warps(session, out);
    }
    ui.add_space(space::XS);
    param_row_ui(Key::WarpMode, &plain, session, out, ui);
    let modes: Vec<WarpMode> = session.choices();
    if modes.contains(&WarpMode::Blend) {
        weight_ui(session, out, ui);
        also_ui(session, out, ui);
    }
    if modes.contains(&WarpMode::Join) {
        param_row_ui(Key::WarpFrom, &plain, session, out, ui);
        param_row_ui(Key::WarpTo, &plain, session, out, ui);
        param_row_ui(Key::WeightLaw, &plain, session, out, ui);
    }
    foot_rows_ui(session, out, ui);
    ui.add_space(space::S);
    kit::section_header_ui(text::REGISTRATION, ui);
    let window = Detail { max: frames_of_both(session), ..Detail::default() };
    param_row_ui(Key::RegistrationWindow, &window, session, out, ui);
    param_row_ui(Key::SlopeLimit, &plain, session, out, ui);
    param_row_ui(Key::WarpSmoothing, &plain, session, out, ui);
    param_row_ui(Key::Ends, &plain, session, out, ui);
    if params.choice::<choices::Ends>() == choices::Ends::Free {
        param_row_ui(Key::EndSlack, &plain, session, out, ui);
    }
}

/// Draws one weight, or a curve of weights.
fn weight_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let keys = session.params().weight_curve();
    if keys.is_empty() {
        param_row_ui(Key::WarpWeight, &Detail::default(), session, out, ui);
        compare_ui(Key::WarpWeight, session, out, ui);
    } else {
        ui.label(
            RichText::new(say(Word::new(Key::WarpCurve.param().label), ui))
                .font(theme_of(ui).font(Type::Label)),
        );
        let curve = weight_curve(keys);
        let points: Vec<f64> =
            (0..=CURVE_POINTS).map(|k| curve.at(k as f64 / CURVE_POINTS as f64)).collect();
        let duration = session.duration_secs();
        let row = WeightCurveRow {
            label: Word::new(Key::WarpCurve.param().label),
            keys,
            curve: &points,
            now: (duration > 0.0).then(|| session.now_secs() / duration),
            ends: [text::ALL_B, text::ALL_A],
        };
        for event in kit::weight_curve_ui(&row, ui) {
            match event {
                WeightCurveEvent::Keys(keys) => {
                    out.set(Key::WarpCurve, List::WeightCurve(in_order(keys)).into());
                }
                WeightCurveEvent::Settled => out.commands.push(Command::Settle),
            }
        }
        kit::note_ui(text::WEIGHT_CURVE_HELP, palette_of(ui).muted, ui);
    }
    let (label, wanted) = if keys.is_empty() {
        (text::WEIGHT_OVER_TIME, FIRST_WEIGHTS.to_vec())
    } else {
        (text::ONE_WEIGHT, Vec::new())
    };
    if kit::button_ui(Button::new(label), ui).clicked() {
        out.set_once(Key::WarpCurve, List::WeightCurve(wanted).into());
    }
}

/// The initial curve of weights: that of B grows all the way.
const FIRST_WEIGHTS: [(usize, usize); 2] = [(0, 0), (100, 100)];

/// Returns pairs in the order of the first, each once.
fn in_order(mut pairs: Vec<(usize, usize)>) -> Vec<(usize, usize)> {
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Draws the further clips of a blend, each with its weight.
fn also_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    let also = session.params().weighted_clips();
    let set = |also: Vec<(String, f64)>, out: &mut Out| {
        out.set(Key::WarpAlso, List::WeightedClips(also).into());
    };
    for (index, (id, weight)) in also.iter().enumerate() {
        let label = text::blended_clip(index);
        let with = |clip: (String, f64)| {
            let mut also = also.to_vec();
            also[index] = clip;
            also
        };
        ui.horizontal(|ui| {
            let gone = kit::icon_button_ui(Icon::Close, text::REMOVE, ui).clicked();
            if gone {
                let rest: Vec<(String, f64)> = also
                    .iter()
                    .enumerate()
                    .filter(|(at, _)| *at != index)
                    .map(|(_, clip)| clip.clone())
                    .collect();
                set(rest, out);
                out.commands.push(Command::Settle);
            }
            ui.vertical(|ui| {
                if let Some(chosen) = clip_choice_ui(Text::Data(&label), id, session, ui) {
                    set(with((chosen, *weight)), out);
                    out.commands.push(Command::Settle);
                }
            });
        });
        let share = text::weight_of(index);
        let response =
            kit::slider_row_ui(*weight, &SliderRow::new(&share, 0.0..=1.0, 0.0).step(0.01), ui);
        if let Some(weight) = response.changed {
            let hundredths = (weight * 100.0).round();
            set(with((id.clone(), hundredths / 100.0)), out);
        }
        if response.drag_ended || (response.changed.is_some() && !response.response.dragged()) {
            out.commands.push(Command::Settle);
        }
    }
    if also.len() >= MAX_WEIGHTED_CLIPS {
        return;
    }
    // The first clip that is not in the blend yet, if there is one.
    let params = session.params();
    let is_in = |id: &str| {
        [Key::A, Key::B].iter().any(|key| params.text(*key) == id)
            || also.iter().any(|(other, _)| other == id)
    };
    let entries = session.library().entries();
    let next = entries.iter().find(|entry| !is_in(&entry.id)).or(entries.first());
    let mut added = None;
    let dropped = clip_list_ui(session, ui, |ui| {
        let hint = Word::new(Key::WarpAlso.param().help);
        let button = Button::new(text::BLEND_MORE).icon(Icon::Plus).hint(hint);
        if kit::button_ui(button, ui).clicked() {
            added = next.map(|entry| entry.id.clone());
        }
    });
    if let Some(id) = added.or(dropped) {
        set(also.iter().cloned().chain([(id, FIRST_SHARE)]).collect(), out);
        out.commands.push(Command::Settle);
    }
}

/// Opens the result with and without the time warp side by side, or goes back to one pane.
pub(super) fn compare_warps(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::WarpWith);
    let query = if on { "" } else { "warp_with:registered,plain" };
    out.compare(Compare::parse(query).ok());
}

/// Draws the map, at most `room` points high, its legend, and the distance of the pair under the
/// pointer, else of the one at the playhead.
pub(super) fn map_ui(
    session: &Session,
    room: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let palette = palette_of(ui);
    let job = session.jobs().into_iter().find(|job| job.kind == JobKind::Registering);
    let waits = job.map(|job| {
        let percent = 100.0 * job.progress;
        msg!("Comparing all frames… {percent:.0} %", percent)
    });
    let Some(map) = session.distance_map() else {
        let words = waits.unwrap_or_else(|| text::EMPTY_PANE.into());
        kit::note_ui(&words, palette.muted, ui);
        return;
    };
    let picture = picture_of(map, ui);
    let fps = map.fps();
    let secs = |frames: [f64; 2]| frames.map(|frame| frame / fps);
    let spans = [0, 1].map(|clip: usize| map.motions()[clip].clip().duration_secs());
    let matrix = map.matrix();
    let (first, last) = (
        secs(map.pair_of((0, 0))),
        secs(map.pair_of((matrix.rows().saturating_sub(1), matrix.columns().saturating_sub(1)))),
    );
    // A cell is as wide as the stride of the matrix.
    let half = 0.5 * matrix.stride() as f64 / fps;
    let field = [0, 1].map(|clip| [first[clip] - half, last[clip] + half]);
    let feet = [0, 1].map(|clip: usize| feet_of(map, clip));
    let registered: Vec<&RegistrationFacts> = (session.panes().iter())
        .filter_map(|pane| pane.outcome.as_ref()?.registered().map(|fact| &**fact))
        .filter(|registered| same_clips(&registered.map, map))
        .collect();
    let lines = lines(&registered, palette);
    let curves: Vec<MapCurve<'_>> = lines.iter().map(Line::curve).collect();
    let pins = session.params().pins();
    let pin_secs: Vec<[f64; 2]> = pins.iter().map(|&(a, b)| secs([a as f64, b as f64])).collect();
    let now = (registered.first())
        .and_then(|registered| registered.frame_pair_at(session.now_secs()))
        .map(|frame_pair| frame_pair.frames);
    let inside =
        |frames: &[f64; 2]| (0..2).all(|clip| (0.0..=spans[clip]).contains(&secs(*frames)[clip]));
    let view = HeatMap {
        label: text::DISTANCES,
        texture: picture.as_ref().map(|picture| picture.texture.id()),
        field,
        spans,
        names: [Word::new("A, s"), Word::new("B")],
        feet: &feet,
        curves: &curves,
        pins: &pin_secs,
        now: now.filter(inside).map(secs),
    };
    for event in kit::heat_map_ui(&view, room, ui) {
        map_event(event, map, registered.first().copied(), pins, state, out);
    }
    ui.add_space(space::XS);
    if let Some(picture) = &picture {
        kit::heat_legend_ui(&text::heat_ends(picture.high_cm), ui);
    }
    let pair = state.labs.register.hovered_pair.or(now.filter(inside));
    let known = pair.map(|frames| text::pair_apart(secs(frames), map.cm_at(frames)));
    kit::note_ui(&waits.or(known).unwrap_or_default(), palette.muted, ui);
    if pins.is_empty() {
        let help = if theme_of(ui).touch { text::MAP_HELP_TOUCH } else { text::MAP_HELP };
        kit::note_ui(help, palette.muted, ui);
    } else {
        ui.horizontal(|ui| {
            ui.label(
                RichText::new(say(&text::pins(pins.len()), ui))
                    .font(theme_of(ui).font(Type::Label)),
            );
            if kit::button_ui(Button::new(text::REMOVE_PINS), ui).clicked() {
                out.reset(Key::Pins);
            }
        });
    }
    ui.add_space(space::S);
}

fn same_clips(one: &DistanceMap, other: &DistanceMap) -> bool {
    let pairs = one.motions().iter().zip(other.motions());
    pairs.into_iter().all(|(a, b)| Arc::ptr_eq(a, b))
}

fn map_event(
    event: HeatMapEvent,
    map: &DistanceMap,
    registered: Option<&RegistrationFacts>,
    pins: &[(usize, usize)],
    state: &mut UiState,
    out: &mut Out,
) {
    let frames = |secs: [f64; 2]| secs.map(|secs| secs * map.fps());
    let pin = |secs: [f64; 2]| {
        let [a, b] = frames(secs).map(|frame| frame.round().max(0.0) as usize);
        (a, b)
    };
    let others = |taken: Option<[f64; 2]>| {
        pins.iter().copied().filter(move |known| taken.map(pin) != Some(*known))
    };
    match event {
        HeatMapEvent::Hover(at) => state.labs.register.hovered_pair = Some(frames(at)),
        HeatMapEvent::Seek(at) => {
            if let Some(secs) = registered.and_then(|registered| registered.secs_near(frames(at))) {
                out.set(Key::Play, Value::Switch(false));
                out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)));
            }
        }
        HeatMapEvent::Pin { from, to } => {
            let wanted: Vec<(usize, usize)> = others(from).chain([pin(to)]).collect();
            out.set(Key::Pins, List::Pins(in_order(wanted)).into());
        }
        HeatMapEvent::Unpin(from) => {
            let left: Vec<(usize, usize)> = others(Some(from)).collect();
            out.set(Key::Pins, List::Pins(in_order(left)).into());
        }
        HeatMapEvent::Settled => out.commands.push(Command::Settle),
    }
}

fn feet_of(map: &DistanceMap, clip: usize) -> Feet {
    let contacts = map.motions()[clip].contacts();
    let secs =
        |stance: Range<usize>| stance.start as f64 / map.fps()..stance.end as f64 / map.fps();
    let of_foot = |&foot: &Foot| contacts.intervals(foot).into_iter().map(secs).collect();
    contacts.feet().iter().map(of_foot).collect()
}

/// A curve on the map, with its points.
struct Line {
    points: Vec<[f64; 2]>,
    color: Color32,
    width: f32,
    dashed: bool,
}

impl Line {
    fn curve(&self) -> MapCurve<'_> {
        MapCurve { points: &self.points, color: self.color, width: self.width, dashed: self.dashed }
    }
}

/// Points of a curve, about one for each point of the map's width.
const CURVE_POINTS: usize = 300;

/// Returns the path of the first pane, and for each pane its time warp, or the plain line without
/// one.
fn lines(registered: &[&RegistrationFacts], palette: &Palette) -> Vec<Line> {
    let mut lines = Vec::new();
    let Some(first) = registered.first() else {
        return lines;
    };
    let fps = first.map.fps();
    let secs = |frames: [f64; 2]| frames.map(|frame| frame / fps);
    lines.push(Line {
        points: first
            .registration
            .path()
            .cells
            .iter()
            .map(|&cell| secs(first.map.pair_of(cell)))
            .collect(),
        color: palette.text.gamma_multiply(0.75),
        width: 1.2,
        dashed: false,
    });
    for registered in registered.iter().rev().filter(|registered| registered.is_plain) {
        let points = registered
            .frame_pairs
            .iter()
            .filter(|frame_pair| frame_pair.frames.iter().all(|frame| *frame >= 0.0));
        lines.push(Line {
            points: points.map(|frame_pair| secs(frame_pair.frames)).collect(),
            color: palette.bad,
            width: 1.6,
            dashed: true,
        });
    }
    for (index, registered) in
        registered.iter().enumerate().rev().filter(|(_, registered)| !registered.is_plain)
    {
        let warp = registered.registration.warp();
        let ((from, _), (to, _)) = (warp.first(), warp.last());
        let points = (0..=CURVE_POINTS).map(|k| {
            let at = from + (to - from) * k as f64 / CURVE_POINTS as f64;
            secs([at, warp.at(at)])
        });
        lines.push(Line {
            points: points.collect(),
            color: palette.accent,
            width: if index == 0 { 2.4 } else { 1.2 },
            dashed: false,
        });
    }
    lines
}

/// The texture of the map.
#[derive(Clone)]
struct Picture {
    map: Arc<DistanceMap>,
    heat: [Color32; 5],
    texture: TextureHandle,
    /// The distance at the upper end of the colours, centimetres.
    high_cm: f64,
}

/// One cell in so many is sampled for the upper end of the colours.
const SAMPLED_CELLS: usize = 13;

/// Returns the picture of these distances, made anew when they or the theme have changed; `None`
/// without distances.
fn picture_of(map: &Arc<DistanceMap>, ui: &Ui) -> Option<Picture> {
    let heat = palette_of(ui).heat;
    let id = Id::unique("distances");
    let known: Option<Picture> = ui.data(|data| data.get_temp(id));
    if let Some(known) = known
        && Arc::ptr_eq(&known.map, map)
        && known.heat == heat
    {
        return Some(known);
    }
    let pooled = map.picture();
    let (rows, columns) = (pooled.rows(), pooled.columns());
    if rows == 0 || columns == 0 {
        return None;
    }
    // The few worst pairs would leave no contrast for the others. A sample of the cells is enough
    // to find where they begin.
    let mut some: Vec<f32> = pooled.rms_m().iter().copied().step_by(SAMPLED_CELLS).collect();
    let worst = (some.len() - 1) * 95 / 100;
    let (_, &mut high, _) = some.select_nth_unstable_by(worst, f32::total_cmp);
    let per_metre = high.max(1e-6).recip();
    let shades = kit::Shades::new(&heat);
    let mut pixels = Vec::with_capacity(rows * columns);
    for column in (0..columns).rev() {
        let cells = pooled.rms_m().iter().skip(column).step_by(columns);
        pixels.extend(cells.map(|rms| shades.at(rms * per_metre)));
    }
    let image = ColorImage::new([rows, columns], pixels);
    let picture = Picture {
        map: Arc::clone(map),
        heat,
        texture: ui.ctx().load_texture("distances", image, TextureOptions::LINEAR),
        high_cm: f64::from(high) * map.cm_scale(),
    };
    ui.data_mut(|data| data.insert_temp(id, picture.clone()));
    Some(picture)
}
