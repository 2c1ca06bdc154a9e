//! The panel of the Path lab: the fit of the path, the quantities that stay, and edits of the whole
//! path.

pub(crate) mod ground_line;
pub(crate) mod hand;
pub(crate) mod stage;

use crate::ui::kit::{self, Button, Icon};
use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::labs::path::hand::path_of;
use crate::ui::language::say;
use crate::ui::out::Out;
use crate::ui::rows::{
    Detail, KeepOffer, add_clip_ui, clip_list_ui, clip_sets_ui, foot_rows_ui, param_row_ui,
    slot_row_ui,
};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Rect, RichText, Ui, UiBuilder, pos2, vec2};
use segue_motion::path::PathEdit;
use segue_session::{
    Command, Compare, ExtraCharacterCommand, Key, LabId, PathFacts, Session, Slot,
};
use segue_text::{Message, ToMessage};

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: path_ui,
    about: [text::PATH_ABOUT, text::PATH_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Own(compare_points),
    title,
    hint: |_| Some(text::PATH_HINT),
    take_line: Some(|points, session, state, out| state.labs.path.take_drawn(points, session, out)),
};

fn title(shown: &Shown<'_>) -> Title {
    Title {
        strong: shown.name(Key::A),
        secondary: path_of(shown.session, shown.pane)
            .map_or_else(Message::default, text::path_lengths),
        ..Title::default()
    }
}

/// Returns whether the lab is open.
pub(crate) fn is_open(session: &Session) -> bool {
    session.params().lab() == LabId::Path
}

/// A turn of the whole path, degrees.
const TURN_DEG: f64 = 15.0;
/// The factor by which the whole path becomes larger.
const LARGER: f64 = 1.1;
/// The greatest number of warnings that are listed.
const MAX_WARNINGS: usize = 3;

/// Draws the rows of the lab.
pub(super) fn path_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let palette = palette_of(ui);
    clip_sets_ui(session, out, ui);
    slot_row_ui(Slot::A, session, out, ui);
    let pane = session.panes().first();
    let path = pane.and_then(|pane| path_of(session, pane));
    ui.add_space(space::S);
    let edited = path.filter(|path| path.is_edited);
    let detail = Detail {
        note: edited.map(|path| text::own_points(path.curve.spline().points().len())),
        ..Detail::default()
    };
    param_row_ui(Key::ControlPoints, &detail, session, out, ui);
    if let Some(path) = path {
        points_ui(path, session, state, out, ui);
    }
    param_row_ui(Key::PathGrid, &Detail::default(), session, out, ui);
    ui.add_space(space::XS);
    if let Some(path) = path {
        whole_ui(path, session, state, out, ui);
    }
    if session.params().edited_path().is_some()
        && kit::button_ui(
            Button::new(text::RESET_PATH).icon(Icon::Undo).hint(text::RESET_PATH_HELP),
            ui,
        )
        .clicked()
    {
        state.labs.path.said = None;
        state.labs.path.chosen = None;
        out.reset(Key::Path);
    }
    if let Some(said) = &state.labs.path.said {
        kit::note_ui(said, palette.warning, ui);
    }
    if let Some(path) = path {
        warnings_ui(path, ui);
    }
    ui.add_space(space::S);
    let more = text::path_keep(session.params().choice()).into();
    let keep = Detail { more: Some(more), ..Detail::default() };
    param_row_ui(Key::PathKeep, &keep, session, out, ui);
    param_row_ui(Key::PathFacing, &Detail::default(), session, out, ui);
    param_row_ui(Key::PathOffset, &Detail::default(), session, out, ui);
    ui.add_space(space::XS);
    foot_rows_ui(session, out, ui);
    if path.is_some_and(|path| path.awaits_feet) {
        kit::note_ui(text::FEET_LATER, palette.muted, ui);
    }
    ui.add_space(space::S);
    fit_ui(path, session, out, ui);
    ui.add_space(space::S);
    company_ui(path.is_some(), session, state, out, ui);
}

/// Draws the buttons for single points.
fn points_ui(path: &PathFacts, session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let points = path.curve.spline().points();
    let chosen = state.labs.path.chosen.and_then(|index| Some((index, *points.get(index)?)));
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        let draw = Button::new(text::DRAW)
            .icon(Icon::Pencil)
            .hint(text::DRAW_HELP)
            .selected(state.drawing.is_some());
        if kit::button_ui(draw, ui).clicked() {
            state.drawing = if state.drawing.is_some() { None } else { Some(Vec::new()) };
            state.labs.path.said = None;
        }
        if kit::button_ui(Button::new(text::ADD_POINT).hint(text::ADD_POINT_HELP), ui).clicked() {
            state.labs.path.add_point(path, session, out);
        }
    });
    // In a row of its own: a part of the panel that is disabled does not wrap.
    ui.add_enabled_ui(chosen.is_some(), |ui| {
        let remove = Button::new(text::REMOVE_POINT).hint(text::REMOVE_POINT_HELP);
        let remove = kit::button_ui(remove, ui);
        if remove.on_disabled_hover_text(say(text::CHOOSE_POINT, ui)).clicked() {
            state.labs.path.remove_point(path, session, out);
        }
    });
    let words = chosen.map_or_else(
        || text::POINTS_HELP.into(),
        |(index, place)| text::chosen_point(index, points.len(), place),
    );
    kit::note_ui(&words, palette_of(ui).muted, ui);
    let before = out.commands.len();
    for key in [Key::PinStart, Key::PinEnd] {
        param_row_ui(key, &Detail::default(), session, out, ui);
    }
    if out.commands.len() > before {
        // A change that was refused because of a pin may be possible now.
        state.labs.path.said = None;
    }
}

/// Draws the buttons for the whole path.
fn whole_ui(path: &PathFacts, session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    ui.label(RichText::new(say(text::WHOLE_PATH, ui)).font(theme_of(ui).font(Type::Label)));
    let turn = |degrees: f64| PathEdit::Rotate { radians: degrees.to_radians() };
    let grid_m = session.params().number(Key::PathGrid);
    let spline = path.curve.spline();
    let mut edits = vec![
        (text::TURN_LEFT, turn(TURN_DEG)),
        (text::TURN_RIGHT, turn(-TURN_DEG)),
        (text::LARGER_PATH, PathEdit::Scale { factor: LARGER }),
        (text::SMALLER_PATH, PathEdit::Scale { factor: LARGER.recip() }),
        (text::MIRROR, PathEdit::Mirror),
        (text::STRAIGHTEN, PathEdit::Straighten { share: 0.5 }),
        (text::SMOOTH, PathEdit::Smooth { share: 0.5 }),
        if spline.is_closed() {
            (text::OPEN_LOOP, PathEdit::Open)
        } else {
            (text::CLOSE_LOOP, PathEdit::Close)
        },
    ];
    if grid_m > 0.0 {
        edits.push((text::SNAP_ALL, PathEdit::Snap { grid_m }));
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        for (label, edit) in edits {
            if kit::button_ui(Button::new(label), ui).clicked() {
                state.labs.path.edit_once(spline, &edit, session, out);
            }
        }
    });
    ui.add_space(space::XS);
}

/// Draws warnings where the path turns harder than the motion can.
fn warnings_ui(path: &PathFacts, ui: &mut Ui) {
    let fps = path.fitted.motion().clip().fps();
    let warning = palette_of(ui).warning;
    for turn in path.hard_turns.iter().take(MAX_WARNINGS) {
        kit::note_ui(&text::hard_turn(turn, fps), warning, ui);
    }
    if path.hard_turns.len() > MAX_WARNINGS {
        let more = text::more_hard_turns(path.hard_turns.len() - MAX_WARNINGS);
        kit::note_ui(&more, warning, ui);
    }
}

/// Draws the rows of the fit and its error.
fn fit_ui(path: Option<&PathFacts>, session: &Session, out: &mut Out, ui: &mut Ui) {
    ui.label(RichText::new(say(text::FIT, ui)).font(theme_of(ui).font(Type::Strong)));
    let on = session.compare().is_some_and(|compare| compare.key == Key::ControlPoints);
    // The rows of the compared values have the way back.
    if !on && kit::button_ui(Button::new(text::FOUR_EIGHT_SIXTEEN), ui).clicked() {
        compare_points(session, out);
    }
    param_row_ui(Key::PathSpline, &Detail::default(), session, out, ui);
    param_row_ui(Key::PathSmoothing, &Detail::default(), session, out, ui);
    let Some(path) = path else { return };
    let error = path.fitted.error();
    let words = text::fit_error(
        error.rms_cm,
        error.most_cm,
        path.fitted.places().get(error.frame).map_or(0.0, |place| place.along_m),
    );
    let color = palette_of(ui).a;
    kit::profile_ui(&words, path.fitted.errors_cm(), error.most_cm, color, ui);
    kit::note_ui(&words, palette_of(ui).muted, ui);
}

/// Opens few and many control points side by side, or goes back to one pane.
pub(super) fn compare_points(session: &Session, out: &mut Out) {
    let on = session.compare().is_some_and(|compare| compare.key == Key::ControlPoints);
    let query = if on { "" } else { text::FOUR_EIGHT_SIXTEEN_QUERY };
    out.compare(Compare::parse(query).ok());
}

/// Draws the list of extra characters.
fn company_ui(
    has_result: bool,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    ui.label(RichText::new(say(text::COMPANY, ui)).font(theme.font(Type::Strong)));
    for (place, companion) in session.extra_characters().iter().enumerate() {
        ui.push_id(("companion", place), |ui| {
            let row = kit::paint::full_width(theme.row_height(), ui);
            let color = palette.others[place % palette.others.len()];
            ui.painter().circle_filled(
                row.left_center() + vec2(6.0, 0.0),
                5.0 * theme.scale(),
                color,
            );
            let side = theme.row_height();
            let buttons =
                Rect::from_min_max(pos2(row.right() - 2.0 * side - space::XS, row.top()), row.max);
            let title = session.clip_title(&companion.name);
            let name = kit::paint::line_of(
                &[kit::paint::Run::new(&title, Type::Body, palette.text)],
                buttons.left() - row.left() - 2.0 * space::L,
                ui,
            );
            kit::paint::put(
                ui.painter(),
                row.left_center() + vec2(18.0, 0.0),
                eframe::egui::Align2::LEFT_CENTER,
                name,
            );
            ui.scope_builder(UiBuilder::new().max_rect(buttons), |ui| {
                ui.horizontal(|ui| {
                    ui.spacing_mut().item_spacing.x = space::XS;
                    let edit = text::edit_companion(title.clone());
                    if kit::icon_button_ui(Icon::Swap, &edit, ui).clicked() {
                        state.labs.path.chosen = None;
                        out.commands
                            .push(Command::ExtraCharacters(ExtraCharacterCommand::Edit(place)));
                    }
                    let leave = text::companion_leaves(title.clone());
                    if kit::icon_button_ui(Icon::Close, &leave, ui).clicked() {
                        out.commands
                            .push(Command::ExtraCharacters(ExtraCharacterCommand::Remove(place)));
                    }
                });
            });
            if let Err(problem) = &companion.motion {
                kit::note_ui(&problem.to_sentence(), palette.warning, ui);
            }
        });
    }
    let button = Button::new(text::JOIN).icon(Icon::Plus).hint(text::JOIN_HELP);
    if has_result && kit::button_ui(button, ui).clicked() {
        out.commands
            .push(Command::ExtraCharacters(ExtraCharacterCommand::AddResult(state.saved_pane)));
    }
    let mut added = None;
    let dropped = clip_list_ui(session, ui, |ui| added = add_clip_ui(session, |_| true, ui));
    if let Some(id) = added.or(dropped) {
        out.commands.push(Command::ExtraCharacters(ExtraCharacterCommand::Add(id)));
    }
    kit::note_ui(text::COMPANY_HELP, palette.muted, ui);
}
