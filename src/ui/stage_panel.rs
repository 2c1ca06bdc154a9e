//! The stage: its panes, what lies over them, and the hand on the camera.

use super::commands::{UiCommand, command_icon_ui};
use super::kit::{self, Button, Icon, Metric, Mood, PaneTitle, Rank};
use super::labs::match_::stick_on_stage_ui;
use super::labs::path::ground_line::{GroundLine, ground_line};
use super::labs::path::hand::path_of;
use super::labs::path::stage::{frame_once, handles_ui, said_ui};
use super::labs::{self, Shown, Title};
use super::language::say;
use super::out::{Action, Out};
use super::state::{Filming, Layout, UiState};
use super::text;
use super::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{self, Align2, Frame, Rect, Response, Sense, Ui, UiBuilder, Vec2, pos2, vec2};
use segue_motion::metrics::Better;
use segue_scene::{camera_of, resting_point, shown_size};
use segue_session::choices;
use segue_session::{CycleMade, Key, Kind, Pane, Session, Value};
use segue_text::{Message, ToMessage, msg};

/// Draws the 3D picture: the whole stage, and for each pane that is shown its index in the session
/// and its place.
pub(crate) type Paint<'a> = &'a mut dyn FnMut(Rect, &[(usize, Rect)], &mut Ui);

/// The whole stage, as large as `ui`, in the stage's own theme.
pub(crate) fn stage_panel_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    super::stage_theme(session, theme_of(ui))
        .within(ui, |ui| stage_ui(session, layout, state, out, paint, ui));
}

fn stage_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let stage = ui.available_rect_before_wrap();
    state.stage = stage;
    let panes = session.panes();
    state.shown_pane = state.shown_pane.min(panes.len().saturating_sub(1));
    let shown: Vec<(usize, Rect)> = if layout == Layout::Phone {
        vec![(state.shown_pane, stage)]
    } else {
        columns(stage, panes.len()).enumerate().collect()
    };
    let response = ui.allocate_rect(stage, Sense::click_and_drag());
    frame_once(session, state, out);
    let line = ground_line(&shown, &response, state, ui);
    let takes_drag =
        !matches!(line, GroundLine::None) || state.path.held.is_some() || state.drive.is_held();
    if let GroundLine::Done(points) = line {
        labs::take_line(&points, session, state, out);
    }
    camera_input(session, &response, takes_drag, out, ui);
    paint(stage, &shown, ui);
    (state.path.hovered, state.path.place) = (None, None);
    for &(index, rect) in &shown {
        handles_ui(session, index, rect, &response, state, out, ui);
    }

    let verdicts = verdicts(panes);
    let mut numbers_top = stage.bottom();
    for (place, &(index, rect)) in shown.iter().enumerate() {
        if place > 0 {
            let line = egui::Stroke::new(theme_of(ui).hairline(), palette_of(ui).line);
            ui.painter().vline(rect.left(), rect.y_range(), line);
        }
        if let Some(pane) = panes.get(index) {
            numbers_top = numbers_top.min(pane_ui(pane, index, &verdicts, session, rect, ui));
        }
    }
    state.numbers_top = numbers_top;
    if layout == Layout::Phone && panes.len() > 1 {
        pane_switch_ui(panes.len(), stage, state, ui);
    }
    camera_buttons_ui(session, stage, state, out, ui);
    stick_on_stage_ui(session, stage, layout, state, ui);
    let roomy = numbers_top - stage.top() > 240.0 * theme_of(ui).scale();
    // Where there is nothing to do it to, no hint says what to do.
    let is_refused = session.panes().iter().any(|pane| pane.problem.is_some());
    let says =
        labs::path::is_open(session) && (state.path.said.is_some() || state.drawing.is_some());
    if says {
        said_ui(stage, numbers_top, state, ui);
    } else if let Some(note) = session.character_note().filter(|_| roomy) {
        kit::caption_ui(&say(&note, ui), stage.with_max_y(numbers_top - space::S), ui);
    } else if let Some(hint) = labs::hint(session)
        .filter(|_| state.hint && roomy && layout != Layout::Phone && !is_refused)
    {
        let mut free = stage.with_max_y(numbers_top - space::S);
        if session.is_driven() {
            free.min.x += kit::stick_size(ui) + space::L;
        }
        kit::caption_ui(hint, free, ui);
        if ui.input(|input| input.pointer.any_pressed() || input.keys_down.iter().next().is_some())
        {
            state.hint = false;
        }
    }
}

fn columns(stage: Rect, count: usize) -> impl Iterator<Item = Rect> {
    let count = count.max(1);
    let width = stage.width() / count as f32;
    (0..count).map(move |index| {
        let left = stage.left() + (width * index as f32).round();
        let right = stage.left() + (width * (index + 1) as f32).round();
        Rect::from_min_max(pos2(left, stage.top()), pos2(right, stage.bottom()))
    })
}

/// The best and the worst pane, by the velocity jump: what an eye calls smooth and rough. Of
/// registered clips by how the feet skate. Where that is alike, by the next of these numbers.
#[derive(Clone, Copy, Debug, Default)]
struct Verdicts {
    best: Option<usize>,
    worst: Option<usize>,
}

/// A number of a pane's result. One of an earlier result is compared with nothing.
fn metric_of<'a>(pane: &'a Pane, id: &str) -> Option<&'a segue_motion::metrics::Metric> {
    let made = pane.result().ok()?;
    made.outcome.metrics.iter().find(|metric| metric.id == id)
}

fn verdicts(panes: &[Pane]) -> Verdicts {
    let is_registered = panes
        .iter()
        .filter_map(|pane| pane.outcome.as_ref())
        .any(|outcome| outcome.registered().is_some());
    let looked_at = if is_registered {
        ["skating_cmps", "velocity_jump_dps", "pose_jump_deg"]
    } else {
        ["velocity_jump_dps", "pose_jump_deg", "skating_cmps"]
    };
    looked_at
        .map(|id| ranking(panes, id))
        .into_iter()
        .find(|verdicts| verdicts.best.is_some())
        .unwrap_or_default()
}

/// Differences below this are nobody's verdict.
fn least_difference(unit: &str) -> f64 {
    match unit {
        "°/s" => 5.0,
        "°" => 1.0,
        "s" => 0.05,
        _ => 0.5,
    }
}

/// Which panes have the lowest and the highest value; none where they hardly differ.
fn ranking(panes: &[Pane], id: &str) -> Verdicts {
    let values: Vec<(usize, f64)> = panes
        .iter()
        .enumerate()
        .filter_map(|(index, pane)| Some((index, metric_of(pane, id)?.value?)))
        .collect();
    let metric = panes.iter().find_map(|pane| metric_of(pane, id));
    // What only describes has no best.
    let Some(metric) = metric.filter(|metric| metric.better == Better::Lower) else {
        return Verdicts::default();
    };
    let least = least_difference(metric.unit);
    let best = values.iter().copied().min_by(|x, y| x.1.total_cmp(&y.1));
    let worst = values.iter().copied().max_by(|x, y| x.1.total_cmp(&y.1));
    match (best, worst) {
        (Some(best), Some(worst)) if worst.1 - best.1 >= least => {
            Verdicts { best: Some(best.0), worst: Some(worst.0) }
        }
        _ => Verdicts::default(),
    }
}

/// What lies over one pane. Returns where its numbers begin, from the top of the page.
fn pane_ui(
    pane: &Pane,
    index: usize,
    verdicts: &Verdicts,
    session: &Session,
    rect: Rect,
    ui: &mut Ui,
) -> f32 {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let Title { strong, text, secondary } = pane_words(pane, session);
    let [strong, text, secondary] = [strong, text, secondary].map(|part| say(&part, ui));
    if pane.is_outdated() {
        // What is seen is not what is asked for.
        ui.painter().rect_filled(rect, 0.0, palette.stage.sky.gamma_multiply(0.55));
    }
    let (chip, mood) = if pane.is_outdated() {
        (text::OUTDATED, Mood::Warning)
    } else if verdicts.best == Some(index) {
        (text::SMOOTHEST, Mood::Good)
    } else if verdicts.worst == Some(index) {
        (text::ROUGHEST, Mood::Bad)
    } else if is_beyond(pane) {
        (text::BEYOND, Mood::Warning)
    } else if path_of(session, pane).is_some_and(|path| !path.hard_turns.is_empty()) {
        (text::TOO_HARD, Mood::Warning)
    } else {
        ("", Mood::default())
    };
    let title = PaneTitle { strong: &strong, text: &text, secondary: &secondary, chip, mood };
    kit::pane_header_ui(&title, rect, ui);
    if let Some(problem) = &pane.problem {
        return problem_ui(&problem.to_sentence(), rect, ui);
    } else if pane.outcome.is_none() {
        let jobs = session.jobs();
        let words = jobs.first().map_or(text::EMPTY_PANE.into(), text::under_way);
        let words = say(&words, ui);
        let galley = kit::paint::line_of(
            &[kit::paint::Run::new(&words, Type::Body, palette.muted)],
            rect.width(),
            ui,
        );
        kit::paint::put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    }
    let Some(outcome) = pane.outcome.as_deref() else {
        return rect.bottom();
    };
    let panes = session.panes();
    let room = if rect.width() < 280.0 * theme.scale() { 6 } else { text::METRICS.len() };
    let shown = text::METRICS
        .iter()
        .filter_map(|(id, label)| {
            Some((outcome.metrics.iter().find(|metric| metric.id == *id)?, label))
        })
        .take(room);
    let numbers: Vec<(String, &str, Rank, &str)> = shown
        .map(|(metric, &label)| {
            let ranks = if metric.better == Better::Neutral {
                Verdicts::default()
            } else {
                ranking(panes, metric.id)
            };
            let rank = if ranks.best == Some(index) {
                Rank::Best
            } else if ranks.worst == Some(index) {
                Rank::Worst
            } else {
                Rank::Middle
            };
            (written(metric), label, rank, metric.help)
        })
        .collect();
    let strip: Vec<Metric<'_>> = numbers
        .iter()
        .map(|(value, label, rank, hint)| Metric { value, label, rank: *rank, hint })
        .collect();
    kit::pane_footer_ui(&strip, rect, ui).top()
}

/// Why a pane has no result, on a plate where its numbers would be: the clips above it are to be
/// seen. Returns where it begins.
fn problem_ui(problem: &Message, rect: Rect, ui: &mut Ui) -> f32 {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let width = (rect.width() - 2.0 * space::L).min(420.0 * theme.scale());
    let place = Rect::from_min_max(
        pos2(rect.center().x - 0.5 * width, rect.top()),
        pos2(rect.center().x + 0.5 * width, rect.bottom() - space::L),
    );
    let builder = UiBuilder::new()
        .id_salt(("problem", rect.min.x.to_bits()))
        .max_rect(place)
        .layout(egui::Layout::bottom_up(egui::Align::Center));
    let plate =
        Frame::new().fill(palette.panel_raised).corner_radius(radius::L).inner_margin(space::M);
    let shown = ui.scope_builder(builder, |ui| {
        plate.show(ui, |ui| {
            let words = egui::RichText::new(say(problem, ui)).font(theme.font(Type::Body));
            ui.add(egui::Label::new(words.color(palette.warning)).wrap());
        })
    });
    shown.inner.response.rect.top()
}

/// Whether a gait was asked for a speed that neither clip nor anything between them has.
fn is_beyond(pane: &Pane) -> bool {
    let cycle = pane.outcome.as_ref().and_then(|outcome| outcome.cycle);
    matches!(cycle.map(|cycle| cycle.made), Some(CycleMade::Gait { facts, .. }) if facts.extrapolated || facts.limited)
}

/// A metric's number as it is read at a glance.
fn written(metric: &segue_motion::metrics::Metric) -> String {
    let Some(value) = metric.value else {
        return "–".to_owned();
    };
    let decimals = match metric.unit {
        "s" | "m" | "m/s" | "ms" => 2,
        "cm" => 1,
        // What has no unit is counted.
        "%" | "frames" | "bends" | "" => 0,
        _ => usize::from(value < 9.95),
    };
    let degree = if metric.unit == "°" { "°" } else { "" };
    let digits = format!("{value:.decimals$}");
    // What rounds to nothing has no sign.
    let is_zero = digits.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    let digits = if is_zero { digits.trim_start_matches('-') } else { &digits };
    format!("{}{degree}", digits.replace('-', "−"))
}

/// What a pane says of itself: the value in which it differs, or what it shows.
fn pane_words(pane: &Pane, session: &Session) -> Title {
    let fps = pane.outcome.as_ref().map_or(60.0, |outcome| outcome.motion.clip().fps());
    // What is on the stage, if it is of earlier parameters; else what is asked for.
    let params = pane.made_from().unwrap_or(session.params());
    if let Some((key, value)) = pane.compared() {
        let param = key.param();
        if matches!(param.kind, Kind::Clip) {
            let strong = session.variant_name(pane).unwrap_or_default();
            return Title { strong, ..Title::default() };
        }
        let secondary = match value {
            Value::Number(frames) if param.unit == "frames" => {
                msg!("{secs:.2} s", secs = frames / fps)
            }
            // A bare number says nothing of itself.
            Value::Number(_) if param.unit.is_empty() => param.label.into(),
            _ => Message::default(),
        };
        return Title { strong: param.spoken(value), text: param.unit.into(), secondary };
    }
    labs::title(&Shown { pane, params, session })
}

/// On a phone one pane is shown; this goes on to the next.
fn pane_switch_ui(count: usize, stage: Rect, state: &mut UiState, ui: &mut Ui) {
    let rect =
        Rect::from_min_size(pos2(stage.right() - 92.0, stage.top() + 44.0), vec2(84.0, 28.0));
    let label = format!("{} / {count}", state.shown_pane + 1);
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        if kit::button_ui(Button::new(&label).icon(Icon::Swap), ui).clicked() {
            state.shown_pane = (state.shown_pane + 1) % count;
        }
    });
}

fn camera_buttons_ui(
    session: &Session,
    stage: Rect,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let params = session.params();
    let side = (30.0 * theme_of(ui).scale()).round();
    let rect = Rect::from_min_size(
        pos2(stage.right() - side - space::S, stage.top() + 76.0),
        vec2(side, 3.0 * side + 2.0 * space::XS),
    );
    ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        for command in
            [UiCommand::ToggleFollow, UiCommand::ToggleTopView, UiCommand::FrameEverything]
        {
            command_icon_ui(command, session, state, out, ui);
        }
    });
    if !params.is_on(Key::Embed) {
        let below = Rect::from_min_size(
            rect.left_bottom() + vec2(0.0, space::M),
            vec2(side, 3.0 * side + 2.0 * space::XS),
        );
        filming_ui(state.filming, below, out, ui);
    }
}

/// A picture of the stage, and a film of the page: the film under way says so, and how long it is.
fn filming_ui(filming: Filming, rect: Rect, out: &mut Out, ui: &mut Ui) {
    let builder = UiBuilder::new().id_salt("filming").max_rect(rect);
    let recorded = ui.scope_builder(builder, |ui| {
        ui.spacing_mut().item_spacing.y = space::XS;
        if filming.pictures
            && kit::button_ui(Button::icon_only(Icon::Picture, text::SAVE_PICTURE).quiet(), ui)
                .clicked()
        {
            out.actions.push(Action::SavePicture);
        }
        if kit::button_ui(Button::icon_only(Icon::Report, text::COPY_REPORT).quiet(), ui).clicked()
        {
            out.actions.push(Action::CopyReport);
        }
        if !filming.films {
            return None;
        }
        let name = if filming.secs.is_some() { text::STOP_RECORDING } else { text::RECORD };
        let button = kit::button_ui(
            Button::icon_only(Icon::Record, name).quiet().selected(filming.secs.is_some()),
            ui,
        );
        if button.clicked() {
            out.actions.push(Action::Record);
        }
        Some(button.rect)
    });
    if let (Some(button), Some(secs)) = (recorded.inner, filming.secs) {
        kit::recording_ui(text::RECORDING, secs, button.left_center() - vec2(space::XS, 0.0), ui);
    }
}

/// Degrees that the camera turns when the pointer moves by a point.
const TURN_PER_POINT: f64 = 0.35;

/// Turns, moves and zooms: drag; Shift or another button, or two fingers; wheel or pinch.
fn camera_input(session: &Session, response: &Response, draws: bool, out: &mut Out, ui: &Ui) {
    let params = session.params();
    let mut values = Vec::new();
    let (mut drag, mut panning) = if draws { (Vec2::ZERO, false) } else { drag_of(response, ui) };
    let mut nearer = 1.0;
    if !session.is_driven() {
        let keys = camera_keys(ui);
        (drag, panning) =
            if keys.drag == Vec2::ZERO { (drag, panning) } else { (keys.drag, keys.panning) };
        nearer = keys.nearer;
    }
    let from_above = params.choice::<choices::Camera>() == choices::Camera::Top;
    if drag != Vec2::ZERO && (panning || from_above) {
        values.extend(pan(session, drag, response.rect));
    } else if drag != Vec2::ZERO {
        let yaw = params.number(Key::CameraYaw) - f64::from(drag.x) * TURN_PER_POINT;
        let pitch = params.number(Key::CameraPitch) + f64::from(drag.y) * TURN_PER_POINT;
        values.push((Key::CameraYaw, Value::Number((yaw + 180.0).rem_euclid(360.0) - 180.0)));
        values.push((Key::CameraPitch, Value::Number(pitch.clamp(-10.0, 89.0))));
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        nearer *= f64::from(pinch) * f64::from(scroll * 0.002).exp();
    }
    if (nearer - 1.0).abs() > 1e-4 {
        let distance = (params.number(Key::CameraDistance) / nearer).clamp(0.5, 60.0);
        values.push((Key::CameraDistance, Value::Number(distance)));
    }
    if !values.is_empty() {
        out.commands.push(segue_session::Command::Set(values));
    }
}

/// What keys ask of the camera: a drag of as many points, with or without Shift, and how much
/// nearer it comes.
struct CameraKeys {
    drag: Vec2,
    panning: bool,
    nearer: f64,
}

/// A press of a key, or its repetition, is a drag of so many points.
const POINTS_PER_KEY: f32 = 16.0;

/// W, A, S, D turn the camera (with Shift they move it), the page keys zoom. What has the focus
/// keeps its keys.
fn camera_keys(ui: &Ui) -> CameraKeys {
    let mut keys = CameraKeys { drag: Vec2::ZERO, panning: false, nearer: 1.0 };
    if ui.ctx().memory(|memory| memory.focused().is_some()) {
        return keys;
    }
    let ways = [
        (egui::Key::A, vec2(1.0, 0.0)),
        (egui::Key::D, vec2(-1.0, 0.0)),
        (egui::Key::W, vec2(0.0, 1.0)),
        (egui::Key::S, vec2(0.0, -1.0)),
    ];
    ui.input_mut(|input| {
        for (modifiers, panning) in [(egui::Modifiers::SHIFT, true), (egui::Modifiers::NONE, false)]
        {
            for (key, way) in ways {
                let times = input.count_and_consume_key(modifiers, key) as f32;
                keys.drag += way * times * POINTS_PER_KEY;
                keys.panning |= panning && times > 0.0;
            }
        }
        let [nearer, farther] = [egui::Key::PageUp, egui::Key::PageDown]
            .map(|key| input.count_and_consume_key(egui::Modifiers::NONE, key) as i32);
        keys.nearer = 1.1_f64.powi(nearer - farther);
    });
    keys
}

/// How far the pointer, or two fingers, moved, and whether that moves the camera instead of turning
/// it.
fn drag_of(response: &Response, ui: &Ui) -> (Vec2, bool) {
    if let Some(touch) = ui.input(eframe::egui::InputState::multi_touch)
        && response.rect.contains(touch.center_pos)
    {
        return (touch.translation_delta, true);
    }
    let other_button = response.dragged_by(egui::PointerButton::Secondary)
        || response.dragged_by(egui::PointerButton::Middle);
    if response.dragged() {
        (response.drag_delta(), other_button || ui.input(|input| input.modifiers.shift))
    } else {
        (Vec2::ZERO, false)
    }
}

fn pan(session: &Session, drag: Vec2, stage: Rect) -> Vec<(Key, Value)> {
    let params = session.params();
    // What the hand moves on the screen does not depend on how large the figure is shown.
    let mut camera = camera_of(session.params(), 1.0);
    let before = camera.target;
    camera.pan(glam_vec2(drag), stage.height());
    let moved = camera.target - before;
    [(Key::PanX, moved.x), (Key::PanY, moved.y), (Key::PanZ, moved.z)]
        .map(|(key, by)| {
            (key, Value::Number((params.number(key) + f64::from(by)).clamp(-100.0, 100.0)))
        })
        .to_vec()
}

fn glam_vec2(v: Vec2) -> glam::Vec2 {
    glam::Vec2::new(v.x, v.y)
}

/// Stops following and shows the whole way of every pane.
pub(crate) fn frame_everything(session: &Session, state: &UiState, out: &mut Out) {
    out.commands.extend(framing(session, state, None).map(segue_session::Command::Set));
}

/// The camera that shows the whole way of everybody; from this height, degrees, or from where it
/// is.
pub(super) fn framing(
    session: &Session,
    state: &UiState,
    pitch: Option<f64>,
) -> Option<Vec<(Key, Value)>> {
    let outcomes = || session.panes().iter().filter_map(|pane| pane.shown_at(0.0));
    let places = outcomes().flat_map(|shown| {
        let frames = shown.outcome.motion.ground_frames();
        frames.iter().map(move |frame| shown.place.after(frame).origin())
    });
    let company =
        session.extra_characters().iter().filter_map(|companion| companion.motion.as_ref().ok());
    let company = company
        .flat_map(|motion| motion.ground_frames().iter().map(segue_motion::math::Planar::origin));
    let paths = session.panes().iter().filter_map(|pane| path_of(session, pane));
    let points = paths.flat_map(|path| path.road.spline().points());
    let points = points.map(|point| glam::Vec3::new(point.x as f32, 0.0, point.y as f32));
    let all = places.chain(company).chain(points);
    let (low, high) = all
        .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
    let first = outcomes().next().filter(|_| low.is_finite())?;
    let motion = &first.outcome.motion;
    let height = motion.roles().body_height(motion.clip().skeleton());
    let mut bounds = segue_scene::Bounds::default();
    bounds.include(low - glam::Vec3::new(0.4, 0.0, 0.4));
    bounds.include(high + glam::Vec3::new(0.4, height, 0.4));
    let mut params = session.params().clone();
    let pitch = pitch.map(|pitch| (Key::CameraPitch, Value::Number(pitch)));
    if let Some((key, value)) = &pitch {
        params.set(*key, value.clone()).ok()?;
    }
    let shown = shown_size(session, motion);
    let mut camera = camera_of(&params, shown);
    let pane_width = state.stage.width() / session.panes().len().max(1) as f32;
    camera.frame(&bounds, pane_width / state.stage.height().max(1.0));
    let pan = (camera.target - resting_point(first.outcome, &first.place)) * shown;
    let mut values = vec![
        (Key::Follow, choices::Follow::Off.into()),
        (Key::CameraDistance, Value::Number(f64::from(camera.distance * shown).clamp(0.5, 60.0))),
    ];
    values.extend(pitch);
    for (key, value) in [(Key::PanX, pan.x), (Key::PanY, pan.y), (Key::PanZ, pan.z)] {
        values.push((key, Value::Number(f64::from(value).clamp(-100.0, 100.0))));
    }
    Some(values)
}

/// Where a point of the picture is, for tests and captions.
#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::Command;

    #[test]
    fn columns_fill_the_stage_without_gaps() {
        let stage = Rect::from_min_size(pos2(10.0, 5.0), vec2(1000.0, 400.0));
        let panes: Vec<Rect> = columns(stage, 3).collect();
        assert_eq!(panes[0].left(), 10.0);
        assert_eq!(panes[2].right(), 1010.0);
        assert!(panes.windows(2).all(|pair| pair[0].right() == pair[1].left()));
    }

    #[test]
    fn panes_are_ranked_by_the_numbers_of_every_lab() {
        for (link, best, worst) in [
            ("compare=blend_window:30,15,10", 0, 2),
            ("lab=transition&compare=mistake:none,hemisphere", 0, 1),
            (
                "lab=loop&a=walk_left&loop_from=0.3&loop_to=1.2&compare=loop_method:exact,linear",
                0,
                1,
            ),
            ("lab=register&compare=warp_with:registered,plain", 0, 1),
        ] {
            let mut session = Session::new();
            session.apply(Command::OpenLink(link.into())).unwrap();
            while session.work() {}
            let found = verdicts(session.panes());
            assert_eq!((found.best, found.worst), (Some(best), Some(worst)), "{link}");
        }
    }
}
