//! The stage: its panes, the layers over them, and the input of the pointer.

mod buttons;
mod camera;
pub(crate) mod framing;
mod pane;
mod pick;
mod swipe;
mod verdicts;

use self::buttons::camera_buttons_ui;
use self::camera::camera_input;
use self::pane::pane_ui;
use self::pick::pick_ui;
use self::swipe::{pane_switch_ui, switch_height};
use self::verdicts::verdicts;
use crate::ui::appearance::stage_theme;
use crate::ui::clip_drag::take_drop_on_pane;
use crate::ui::kit;
use crate::ui::labs::on_stage;
use crate::ui::out::Out;
use crate::ui::state::{Layout, UiState};
use crate::ui::theme::{palette_of, space, theme_of};
use eframe::egui::{self, Rect, Sense, Ui, pos2};
use segue_session::Session;

pub(crate) use self::swipe::Swipe;

/// Draws the 3D picture: the whole stage, and for each pane that is shown its index in the session
/// and its place.
pub(crate) type Paint<'a> = &'a mut dyn FnMut(Rect, &[(usize, Rect)], &mut Ui);

/// Draws the stage, as large as `ui`, in its own theme.
pub(crate) fn stage_panel_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    stage_theme(session, theme_of(ui))
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
    // A phone, or a presenter, shows one pane at a time.
    let is_switched = layout == Layout::Phone && panes.len() > 1;
    let alone = (layout == Layout::Phone).then_some(state.shown_pane);
    let shown: Vec<(usize, Rect)> = match alone.or(state.presenter.pane_alone(panes.len())) {
        Some(pane) => vec![(pane, stage)],
        None => columns(stage, panes.len()).enumerate().collect(),
    };
    let response = ui.allocate_rect(stage, Sense::click_and_drag());
    on_stage::frame_once(session, state, out);
    let takes_drag = on_stage::takes_drag(session, &shown, &response, state, out, ui)
        || (is_switched && swipe::takes_drag(panes.len(), &response, state, ui));
    camera_input(session, &response, takes_drag, out, ui);
    paint(stage, &shown, ui);
    on_stage::handles_ui(session, &shown, &response, state, out, ui);

    let verdicts = verdicts(panes);
    let mut numbers_top = stage.bottom();
    for (place, &(index, rect)) in shown.iter().enumerate() {
        if place > 0 {
            let line = egui::Stroke::new(theme_of(ui).hairline(), palette_of(ui).line);
            ui.painter().vline(rect.left(), rect.y_range(), line);
        }
        take_drop_on_pane(index, rect, session, out, ui);
        if let Some(pane) = panes.get(index) {
            numbers_top = numbers_top.min(pane_ui(pane, index, &verdicts, session, rect, out, ui));
        }
    }
    if !takes_drag && !state.presenter.is_on {
        pick_ui(session, &shown, &response, state, out, ui);
    }
    let mut free = stage.with_min_y(stage.top() + kit::pane_header_height(ui));
    if is_switched {
        pane_switch_ui(session, free, state, ui);
        free.min.y += switch_height(ui);
    }
    if !state.presenter.is_on {
        camera_buttons_ui(session, free, layout, state, out, ui);
    }
    on_stage::controls_ui(session, stage, layout, state, ui);
    let roomy = numbers_top - stage.top() > 240.0 * theme_of(ui).scale();
    // A pane without a result needs no hint.
    let is_refused = session.panes().iter().any(|pane| pane.problem.is_some());
    if let Some(note) = on_stage::note(session, state) {
        kit::caption_ui(&note, stage.with_max_y(numbers_top - space::S), ui);
    } else if let Some(note) = session.character_note().filter(|_| roomy) {
        kit::caption_ui(&note, stage.with_max_y(numbers_top - space::S), ui);
    } else if let Some(hint) = on_stage::hint(session)
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

/// Returns the places of panes side by side.
fn columns(stage: Rect, count: usize) -> impl Iterator<Item = Rect> {
    let count = count.max(1);
    let width = stage.width() / count as f32;
    (0..count).map(move |index| {
        let left = stage.left() + (width * index as f32).round();
        let right = stage.left() + (width * (index + 1) as f32).round();
        Rect::from_min_max(pos2(left, stage.top()), pos2(right, stage.bottom()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn columns_fill_the_stage_without_gaps() {
        let stage = Rect::from_min_size(pos2(10.0, 5.0), vec2(1000.0, 400.0));
        let panes: Vec<Rect> = columns(stage, 3).collect();
        assert_eq!(panes[0].left(), 10.0);
        assert_eq!(panes[2].right(), 1010.0);
        assert!(panes.windows(2).all(|pair| pair[0].right() == pair[1].left()));
    }
}
