//! The stage: its panes, the layers over them, and the input of the pointer.

mod buttons;
mod camera;
mod columns;
mod explanation;
pub(crate) mod framing;
mod pane;
mod pick;
pub(crate) mod strip;
mod swipe;
mod verdicts;

use self::buttons::camera_buttons_ui;
use self::camera::camera_input;
use self::columns::shown_panes;
use self::pane::pane_ui;
use self::pick::pick_ui;
use self::strip::Strip;
use self::swipe::{pane_switch_ui, switch_height};
use self::verdicts::verdicts;
use crate::ui::appearance::stage_theme;
use crate::ui::clip_drag::take_drop_on_pane;
use crate::ui::kit;
use crate::ui::labs::on_stage;
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::theme::{palette_of, space, theme_of};
use eframe::egui::{self, Event, Rect, Response, Sense, Ui, vec2};
use segue_session::{Command, Session};

/// Draws the 3D picture: the whole stage, and for each pane that is shown its index in the session
/// and its place.
pub(crate) type Paint<'a> = &'a mut dyn FnMut(Rect, &[(usize, Rect)], &mut Ui);

/// Draws the stage in its own theme, and below it the numbers of its panes, on the ground of the
/// panels; both together as large as `ui`.
pub(crate) fn stage_panel_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let whole = ui.available_rect_before_wrap();
    state.shown_pane = state.shown_pane.min(session.panes().len().saturating_sub(1));
    let strip = Strip::new(session, whole, layout, state, ui);
    state.stage = whole.with_max_y(whole.bottom() - strip.height());
    stage_theme(session, theme_of(ui))
        .within(ui, |ui| stage_ui(session, layout, state, out, paint, ui));
    strip.show(session, layout, state, out, ui);
}

fn stage_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let stage = state.stage;
    let panes = session.panes();
    // A phone shows one pane at a time.
    let is_switched = layout == Layout::Phone && panes.len() > 1;
    let shown = shown_panes(session, stage, layout, state);
    let response = ui.allocate_rect(stage, Sense::click_and_drag());
    on_stage::frame_once(session, state, out);
    let takes_drag = on_stage::takes_drag(session, &shown, &response, state, out, ui)
        || (is_switched && swipe::takes_drag(panes.len(), &response, state, ui));
    camera_input(session, &response, takes_drag, out, ui);
    paint(stage, &shown, ui);
    on_stage::handles_ui(session, &shown, &response, state, out, ui);

    let verdicts = verdicts(panes);
    for (place, &(index, rect)) in shown.iter().enumerate() {
        if place > 0 {
            let line = egui::Stroke::new(theme_of(ui).hairline(), palette_of(ui).line);
            ui.painter().vline(rect.left(), rect.y_range(), line);
        }
        take_drop_on_pane(index, rect, session, out, ui);
        if let Some(pane) = panes.get(index) {
            pane_ui(pane, index, verdicts, session, rect, out, ui);
        }
    }
    if !takes_drag && !state.presenter.is_on {
        pick_ui(session, &shown, &response, state, out, ui);
    }
    let mut free = stage.with_min_y(stage.top() + kit::pane_header_height(ui));
    if is_switched {
        pane_switch_ui(session, free, state, ui);
        free.max.y -= switch_height(ui);
    }
    let mut buttons = Rect::NOTHING;
    if !state.presenter.is_on {
        buttons = camera_buttons_ui(session, free, layout, state, out, ui);
    }
    let controls = on_stage::controls_ui(session, free, layout, state, ui);
    // Beside the controls of a lab, and below the buttons or beside them.
    free.min.x = free.min.x.max(controls.right() + space::S);
    if buttons.bottom() > free.bottom() - CAPTION_ROOM * theme_of(ui).scale() {
        free = free.shrink2(vec2(free.right() - buttons.left(), 0.0));
    }
    caption_ui(session, layout, free, &response, state, out, ui);
}

/// The height in which a caption has two lines, points.
const CAPTION_ROOM: f32 = 68.0;

/// Draws the note on the last action, or on the character, or the hint of the lab, at the bottom of
/// `free`: feet stand well above it, while heads reach the titles.
fn caption_ui(
    session: &Session,
    layout: Layout,
    free: Rect,
    response: &Response,
    state: &mut UiState,
    out: &Out,
    ui: &mut Ui,
) {
    let lab = session.params().lab();
    if is_used(response, out, ui) && !state.hints_used.contains(&lab) {
        state.hints_used.push(lab);
    }
    let free = free.shrink(space::S);
    let is_roomy = state.stage.height() > 240.0 * theme_of(ui).scale();
    // A pane without a result needs no hint.
    let is_refused = session.panes().iter().any(|pane| pane.problem.is_some());
    if let Some(note) = on_stage::note(session, state) {
        kit::caption_ui(&note, free, ui);
    } else if let Some(note) = session.character_note().filter(|_| is_roomy) {
        kit::caption_ui(&note, free, ui);
    } else if is_roomy
        && layout != Layout::Phone
        && !is_refused
        && !state.hints_used.contains(&lab)
        && let Some(hint) = on_stage::hint(session)
    {
        kit::caption_ui(hint, free, ui);
    }
}

/// Returns whether the user works with the lab: presses the stage or a key, or changes a parameter
/// of the lab. From then on its hint is not needed.
fn is_used(response: &Response, out: &Out, ui: &Ui) -> bool {
    let is_pressed = response.is_pointer_button_down_on()
        || ui.input(|input| {
            input.events.iter().any(|event| {
                matches!(event, Event::Key { key, pressed: true, .. } if *key != egui::Key::Tab)
            })
        });
    let is_set = |command: &Command| match command {
        Command::Set(values) => values.iter().any(|(key, _)| key.param().group.is_of_lab()),
        _ => false,
    };
    is_pressed || out.commands.iter().any(is_set)
}
