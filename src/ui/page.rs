//! The page: the layout of its panels, at a desk, on a phone, and embedded.

use super::commands;
use super::kit;
use super::labs::{self, in_time, on_stage};
use super::lessons_panel;
use super::library_panel;
use super::out::Out;
use super::overlays;
use super::presenter::presenter_ui;
use super::stage::{Paint, stage_panel_ui};
use super::state::{Layout, NoticePlace, UiState};
use super::still::still_ui;
use super::text;
use super::theme::{Theme, palette_of, space, theme_of};
use super::timeline::{CurveCache, more_height, timeline_panel_ui};
use super::top_bar;
use eframe::egui::accesskit::Role;
use eframe::egui::scroll_area::{DragScroll, ScrollSource};
use eframe::egui::{self, Frame, Margin, Panel, Rect, ScrollArea, Ui, pos2, vec2};
use segue_session::{Key, Session};

/// Draws the page. `paint` draws the 3D picture into the stage.
pub(crate) fn show(
    session: &Session,
    state: &mut UiState,
    curves: &mut CurveCache,
    paint: Paint<'_>,
    ui: &mut Ui,
) -> Out {
    let mut out = Out::default();
    if !state.stillness.is_still() {
        state.joints_open = false;
        state.library.begin_frame();
        state.notice_place = None;
        on_stage::begin_frame(session, state);
    }
    commands::take_keys(session, state, &mut out, ui);
    let layout = Layout::of(ui.available_width(), theme_of(ui).scale());
    state.layout = layout;
    let has_room = ui.available_width() >= MAP_ROOM * theme_of(ui).scale();
    state.labs.graph.has_map_panel =
        has_room && labs::has_side_panel(session) && !lessons_panel::is_open(session);
    if state.presenter.is_on {
        presenter_ui(session, state, &mut out, paint, ui);
    } else if session.params().is_on(Key::Embed) {
        embedded_ui(session, state, curves, &mut out, paint, ui);
    } else {
        match layout {
            Layout::Phone => phone_ui(session, state, curves, &mut out, paint, ui),
            Layout::Desk | Layout::Tablet => {
                desk_ui(session, layout, state, curves, &mut out, paint, ui);
            }
        }
    }
    in_time::steer(session, state, &mut out, ui.ctx());
    let is_low = layout == Layout::Phone && !session.is_driven();
    let on_stage = notices_on_stage(state.stage, is_low, theme_of(ui));
    state.notice_place.get_or_insert(on_stage);
    overlays::overlays_ui(session, state, &mut out, ui);
    state.stillness.end(ui.ctx());
    out
}

/// Returns the place of the notices where no panel has one: under the title of the first pane, left
/// of the buttons; on a small stage, whose figure reaches the title, in the lower left corner.
fn notices_on_stage(stage: Rect, is_small: bool, theme: Theme) -> NoticePlace {
    let (scale, height) = (theme.scale(), 24.0 * theme.scale());
    let top =
        if is_small { stage.bottom() - theme.hit() - height } else { stage.top() + 40.0 * scale };
    let width = (stage.width() - 2.0 * space::M - 96.0 * scale).min(420.0 * scale);
    let row = Rect::from_min_size(pos2(stage.left() + space::M, top), vec2(width, height));
    NoticePlace { row, heading_end: row.left() - space::S }
}

/// Returns the frame of a panel. It fills nothing: the page is cleared in the colour of panels.
fn panel_frame(horizontal: f32, vertical: f32) -> Frame {
    Frame::new().inner_margin(Margin::symmetric(horizontal as i8, vertical as i8))
}

/// Returns the frame of a panel that scrolls, with room for the scroll bar at the right edge, so
/// that it does not cover numbers and units.
fn scrolling_frame(horizontal: f32, vertical: f32) -> Frame {
    let mut frame = panel_frame(horizontal, vertical);
    frame.inner_margin.right = BAR_MARGIN as i8;
    frame
}

/// Returns an area that scrolls by the wheel, its bar, and from the first touch on by a finger.
fn scroll_area(ui: &Ui) -> ScrollArea {
    let by_finger = ScrollSource { drag: DragScroll::Always, ..ScrollSource::default() };
    let source = if theme_of(ui).touch { by_finger } else { ScrollSource::default() };
    ScrollArea::vertical().scroll_source(source)
}

/// Draws the scrolled content of a [`scrolling_frame`], as wide as in a panel that does not scroll.
fn scrolled_ui(horizontal: f32, ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    scroll_area(ui).auto_shrink(false).show(ui, |ui| {
        let margin = Margin { right: (horizontal - BAR_MARGIN) as i8, ..Margin::ZERO };
        Frame::new().inner_margin(margin).show(ui, content);
    });
}

/// Draws the buttons that keep and save the result, below the scrolled content of a
/// [`scrolling_frame`].
fn footer_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    let right = (space::L - BAR_MARGIN) as i8;
    let margin = Margin { right, top: space::S as i8, ..Margin::ZERO };
    let panel = Panel::bottom("keep and save").frame(Frame::new().inner_margin(margin));
    let most = ui.available_height();
    let shown =
        panel.resizable(false).show(ui, |ui| labs::lab_footer_ui(session, most, state, out, ui));
    // The panel gets its new height in the next frame.
    let (id, height) = (shown.response.id.with("height"), shown.response.rect.height());
    if ui.data_mut(|data| std::mem::replace(data.get_temp_mut_or(id, height), height)) != height {
        ui.request_repaint();
    }
}

/// Returns the height of the bar at the top: a row that can be pressed, and its margins.
fn bar_height(ui: &Ui) -> f32 {
    let theme = theme_of(ui);
    (48.0 * theme.scale()).max(theme.row_height() + 2.0 * space::S).round()
}

/// The least width of the page with room for the map of a graph beside the stage, points.
const MAP_ROOM: f32 = 1000.0;
/// The gap between a scroll bar and the edge of its panel, points.
const BAR_MARGIN: f32 = 3.0;

fn desk_ui(
    session: &Session,
    layout: Layout,
    state: &mut UiState,
    curves: &mut CurveCache,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let scale = theme_of(ui).scale();
    let height = ui.available_height();
    let frame = panel_frame(space::L, space::S);
    Panel::top("top bar").exact_size(bar_height(ui)).frame(frame).show(ui, |ui| {
        kit::set_role(Role::Banner, text::TOP_BAR, ui);
        still_ui("bar", state, ui, |state, ui| {
            top_bar::top_bar_ui(session, layout, state, out, ui);
        });
    });
    let lesson = lessons_panel::is_open(session);
    // A lesson without a panel of its own shares that of the parameters, which is then as high as
    // the page: text needs the lines more than the timeline the width.
    let shared = lesson && layout == Layout::Tablet;
    let parameters = |state: &mut UiState, out: &mut Out, ui: &mut Ui| {
        lab_side_ui(session, layout, shared, state, out, ui);
    };
    if shared {
        parameters(state, out, ui);
    }
    // No panel may be smaller than its contents: they would cover the next one.
    let least = state.timeline_least.min(0.55 * height);
    Panel::bottom("timeline")
        .exact_size(timeline_height(session, height, scale).max(least).round())
        .frame(panel_frame(space::L, space::S))
        .resizable(false)
        .show(ui, |ui| {
            kit::set_role(Role::Region, text::TIMELINE, ui);
            timeline_panel_ui(session, layout, curves, state, out, ui);
            note_least_height(state, ui);
        });
    let side = panel_frame(space::M, space::M);
    if lesson && layout == Layout::Desk {
        Panel::left("lesson")
            .exact_size(lessons_panel::width(ui.available_width(), scale))
            .frame(scrolling_frame(space::L, space::M))
            .resizable(false)
            .show(ui, |ui| {
                kit::set_role(Role::Complementary, text::LESSON, ui);
                still_ui("lesson", state, ui, |state, ui| {
                    lessons_panel::lessons_panel_ui(session, false, state, out, ui);
                });
            });
    }
    if state.library_open || !has_drawer(session, layout) {
        Panel::left("library").exact_size(244.0 * scale).frame(side).resizable(false).show(
            ui,
            |ui| {
                kit::set_role(Role::Complementary, text::LIBRARY, ui);
                still_ui("library", state, ui, |state, ui| {
                    library_panel::library_panel_ui(session, state, out, ui);
                });
            },
        );
    }
    if !shared {
        parameters(state, out, ui);
    }
    if state.labs.graph.has_map_panel {
        Panel::right("graph map")
            .exact_size((labs::side_panel_share(session) * ui.available_width()).round())
            .frame(panel_frame(space::M, space::M))
            .resizable(false)
            .show(ui, |ui| {
                kit::set_role(Role::Region, text::MAP, ui);
                labs::side_panel_ui(session, state, out, ui);
            });
    }
    egui::CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
        kit::set_role(Role::Main, text::STAGE, ui);
        stage_panel_ui(session, layout, state, out, paint, ui);
    });
}

/// Returns the height of the timeline's panel on a page of a height, points.
fn timeline_height(session: &Session, height: f32, scale: f32) -> f32 {
    let more = (more_height(session) * scale).min(0.16 * height);
    ((214.0 * scale).min(0.31 * height) + more).round()
}

/// Returns whether the library is a drawer: a lesson and the map of the graph leave no room for it.
fn has_drawer(session: &Session, layout: Layout) -> bool {
    layout == Layout::Tablet || lessons_panel::is_open(session) || labs::has_side_panel(session)
}

/// Draws the panel of the parameters, which a lesson may share.
fn lab_side_ui(
    session: &Session,
    layout: Layout,
    shared: bool,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let scale = theme_of(ui).scale();
    Panel::right("lab")
        .exact_size(if shared { 340.0 } else { 288.0 } * scale)
        .frame(scrolling_frame(space::L, space::M))
        .resizable(false)
        .show(ui, |ui| {
            kit::set_role(Role::Form, text::PARAMETERS, ui);
            still_ui("lab", state, ui, |state, ui| {
                lab_side_contents_ui(session, layout, shared, state, out, ui);
            });
        });
}

/// Draws the contents of the panel of the parameters, where a lesson may take the place of them.
fn lab_side_contents_ui(
    session: &Session,
    layout: Layout,
    shared: bool,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    if shared {
        lessons_panel::lesson_or_parameters_ui(state, ui);
        if !state.lesson_behind {
            lesson_with_controls_ui(session, state, out, ui);
            return;
        }
    }
    if has_drawer(session, layout) {
        library_panel::library_button_ui(state, ui);
        ui.add_space(space::S);
    }
    footer_ui(session, state, out, ui);
    scrolled_ui(space::L, ui, |ui| labs::lab_panel_ui(session, state, out, ui));
}

/// Draws a lesson, and below it the controls that it mentions and those of the hidden parameters.
fn lesson_with_controls_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if lessons_panel::has_controls(session) {
        let most = (CONTROLS_SHARE * ui.available_height()).round();
        let size = state.lesson_controls.map_or(most, |needed| needed.min(most));
        let panel = Panel::bottom("lesson controls").exact_size(size).frame(Frame::new());
        panel.resizable(false).show(ui, |ui| {
            ui.add_space(space::S);
            let margin = Margin { right: (space::L - BAR_MARGIN) as i8, ..Margin::ZERO };
            let shown = scroll_area(ui).auto_shrink(false).show(ui, |ui| {
                Frame::new().inner_margin(margin).show(ui, |ui| {
                    let room = most - FIGURE_REST * theme_of(ui).scale();
                    lessons_panel::controls_ui(session, room, state, out, ui);
                });
            });
            let needed = Some((shown.content_size.y + space::S).ceil());
            if state.lesson_controls != needed {
                state.lesson_controls = needed;
                ui.ctx().request_repaint();
            }
        });
    }
    lessons_panel::lessons_panel_ui(session, false, state, out, ui);
}

/// The room below a figure for its legend, points.
const FIGURE_REST: f32 = 40.0;
/// The greatest share of a lesson's panel for the controls that it mentions.
const CONTROLS_SHARE: f32 = 0.45;

/// Records the height at which the timeline's panel shows all of its contents, for the next frame.
fn note_least_height(state: &mut UiState, ui: &Ui) {
    let bottom = kit::take_least_bottom(ui);
    let least = bottom.map_or(0.0, |bottom| bottom - ui.max_rect().top() + 2.0 * space::S);
    if (least - state.timeline_least).abs() > 0.5 {
        state.timeline_least = least;
        ui.ctx().request_repaint();
    }
}

/// Draws the timeline where room is scarce. Strips of walks and drives fill the room that they get;
/// tracks and stripes take the room that they need, and no panel may be smaller than its contents:
/// the next one would cover it.
fn slim_time_ui(
    panel: Panel,
    margin: f32,
    session: &Session,
    state: &mut UiState,
    curves: &mut CurveCache,
    out: &mut Out,
    ui: &mut Ui,
) {
    let scale = theme_of(ui).scale();
    let panel = if in_time::has_strip(session) {
        panel.exact_size(144.0 * scale)
    } else {
        panel.default_size(136.0 * scale)
    };
    panel.frame(panel_frame(margin, space::S)).show(ui, |ui| {
        kit::set_role(Role::Region, text::TIMELINE, ui);
        timeline_panel_ui(session, Layout::Phone, curves, state, out, ui);
    });
}

/// Draws the page of a phone in one column: bar, stage, timeline, parameters.
fn phone_ui(
    session: &Session,
    state: &mut UiState,
    curves: &mut CurveCache,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let frame = panel_frame(space::M, space::S);
    Panel::top("top bar").exact_size(bar_height(ui)).frame(frame).show(ui, |ui| {
        kit::set_role(Role::Banner, text::TOP_BAR, ui);
        still_ui("bar", state, ui, |state, ui| {
            top_bar::top_bar_ui(session, Layout::Phone, state, out, ui);
        });
    });
    let lesson = lessons_panel::is_open(session);
    let height = ui.available_height();
    // A list of clips needs more room than a panel of sliders.
    let share = match (state.library_open, lesson) {
        (true, _) => 0.4,
        (false, true) => 0.42,
        (false, false) => 0.5,
    };
    Panel::top("stage").exact_size((height * share).round()).frame(Frame::new()).show(ui, |ui| {
        kit::set_role(Role::Main, text::STAGE, ui);
        stage_panel_ui(session, Layout::Phone, state, out, paint, ui);
    });
    slim_time_ui(Panel::top("timeline"), space::L, session, state, curves, out, ui);
    egui::CentralPanel::default().frame(scrolling_frame(space::L, space::M)).show(ui, |ui| {
        let part = if state.library_open {
            (Role::Complementary, text::LIBRARY)
        } else {
            (Role::Form, text::PARAMETERS)
        };
        kit::set_role(part.0, part.1, ui);
        still_ui("panel", state, ui, |state, ui| {
            phone_panel_ui(session, state, out, ui);
        });
    });
}

/// Draws the panel of a phone: the library, a lesson, or the parameters.
fn phone_panel_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if lessons_panel::is_open(session) && !state.library_open {
        lessons_panel::lesson_or_parameters_ui(state, ui);
        if !state.lesson_behind {
            lessons_panel::lessons_panel_ui(session, true, state, out, ui);
            return;
        }
    }
    if state.library_open {
        let margin = Margin { right: (space::L - BAR_MARGIN) as i8, ..Margin::ZERO };
        let frame = Frame::new().inner_margin(margin);
        library_panel::library_drawer_ui(session, frame, state, out, ui);
        return;
    }
    footer_ui(session, state, out, ui);
    scrolled_ui(space::L, ui, |ui| {
        // On a small stage the hint would cover the motion.
        if let Some(hint) = labs::welcome(session) {
            kit::note_ui(hint, palette_of(ui).muted, ui);
            ui.add_space(space::M);
        }
        labs::lab_panel_ui(session, state, out, ui);
    });
}

/// Draws the embedded page: the stage, a slim timeline, and the parameters that the link names.
fn embedded_ui(
    session: &Session,
    state: &mut UiState,
    curves: &mut CurveCache,
    out: &mut Out,
    paint: Paint<'_>,
    ui: &mut Ui,
) {
    let scale = theme_of(ui).scale();
    slim_time_ui(Panel::bottom("timeline"), space::M, session, state, curves, out, ui);
    if labs::has_named_params(session) {
        let frame = panel_frame(space::M, space::S);
        Panel::bottom("parameters").frame(frame).show(ui, |ui| {
            kit::set_role(Role::Form, text::PARAMETERS, ui);
            labs::named_params_ui(session, out, ui);
        });
    }
    let layout = if ui.available_width() < 480.0 * scale { Layout::Phone } else { Layout::Desk };
    egui::CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
        kit::set_role(Role::Main, text::STAGE, ui);
        stage_panel_ui(session, layout, state, out, paint, ui);
    });
}
