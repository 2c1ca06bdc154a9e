//! Lessons: the list of them, and the page that is open.

mod maths;
mod prose;

use super::kit::{self, Button, Icon, MenuItem};
use super::labs;
use super::language::{Text, say};
use super::out::{Action, Out};
use super::rows::{Detail, param_row_ui};
use super::state::UiState;
use super::text;
use super::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align, Frame, Layout as Flow, Margin, RichText, Role, ScrollArea, Ui};
use prose::{blocks_ui, spans_ui};
use segue_session::lesson::{Block, CONTENTS, Page, Try};
use segue_session::{Command, Key, Kind, Lesson, LessonPage, PARAMS, Session, Value, link};

/// Returns whether there is a lesson to show.
pub(super) fn is_open(session: &Session) -> bool {
    !session.params().text(Key::Lesson).is_empty() && !session.params().is_on(Key::Embed)
}

/// Opens the list of lessons, or closes the open lesson.
pub(super) fn toggle_lessons(session: &Session, out: &mut Out) {
    go_to(if is_open(session) { "" } else { CONTENTS }, out);
}

/// Returns the width of the panel beside the stage: a comfortable length of lines, less where the
/// stage needs the room.
pub(super) fn width(available: f32, scale: f32) -> f32 {
    (0.29 * available).clamp(330.0 * scale, 460.0 * scale).round()
}

/// Draws the choice between a lesson and the parameters, where they share a place.
pub(super) fn lesson_or_parameters_ui(state: &mut UiState, ui: &mut Ui) {
    let options = [(false, text::LESSON), (true, text::PARAMETERS)];
    let picked = clear_of_bar_ui(ui, |ui| {
        kit::segmented_ui(text::LESSON_OR_PARAMETERS, state.lesson_behind, &options, ui)
    });
    if let Some(behind) = picked {
        state.lesson_behind = behind;
    }
    ui.add_space(space::XS);
}

/// Returns the parameters of the open lab that a page speaks of: those of its own link and of the
/// links to try, in the order of the table.
fn keys_of(page: &Page, session: &Session) -> Vec<Key> {
    let queries = page.state.iter().chain(&page.tries).map(|link| link.query.as_str());
    let values = queries.flat_map(|query| link::read(query).values);
    let named: Vec<Key> = values
        .map(|(key, value)| match value {
            Value::Compare(Some(compare)) => compare.key,
            _ => key,
        })
        .collect();
    let lab = session.params().lab();
    let is_shown = |key: &Key| {
        let param = key.param();
        let is_drawn = matches!(param.kind, Kind::Number { .. } | Kind::Switch | Kind::Choice(_));
        named.contains(key) && param.group.is_of_lab() && param.is_used_by(lab) && is_drawn
    };
    PARAMS.iter().map(|param| param.key).filter(is_shown).collect()
}

/// Returns whether the open lesson speaks of anything among the parameters.
pub(super) fn has_controls(session: &Session) -> bool {
    let Some(Lesson::Page(page)) = session.lesson() else {
        return false;
    };
    labs::has_figure(session) || !keys_of(page.page, session).is_empty()
}

/// Draws what the open lesson speaks of and only the panel of the parameters shows: the lab's
/// figure, and the rows of the parameters that its links set.
pub(super) fn controls_ui(
    session: &Session,
    room: f32,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let Some(Lesson::Page(page)) = session.lesson() else {
        return;
    };
    labs::figure_ui(session, room, state, out, ui);
    for key in keys_of(page.page, session) {
        param_row_ui(key, &Detail::default(), session, out, ui);
    }
}

/// Draws the panel. `with_controls`: behind the text comes what it speaks of among the parameters,
/// where these are out of sight.
pub(super) fn lessons_panel_ui(
    session: &Session,
    with_controls: bool,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let Some(lesson) = session.lesson() else {
        return;
    };
    let name = session.params().text(Key::Lesson);
    if state.answered.as_ref().is_some_and(|answered| answered != name) {
        state.answered = None;
    }
    clear_of_bar_ui(ui, |ui| header_ui(&lesson, out, ui));
    ui.add_space(space::XS);
    // Each page has its own scroll position.
    ScrollArea::vertical().id_salt(name).auto_shrink(false).show(ui, |ui| {
        clear_of_bar_ui(ui, |ui| match &lesson {
            Lesson::Contents(page) => contents_ui(page, out, ui),
            Lesson::Page(page) => page_ui(page, name, with_controls, session, state, out, ui),
            Lesson::Waiting => {
                note_ui(text::LESSON_WAITING.into(), false, ui);
                if kit::button_ui(Button::new(text::STOP_LOADING).icon(Icon::Close), ui).clicked() {
                    out.actions.push(Action::StopLesson);
                }
            }
            Lesson::Failed(problem) => {
                note_ui(problem.into(), true, ui);
                if kit::button_ui(Button::new(text::TRY_AGAIN).icon(Icon::Loop), ui).clicked() {
                    out.commands.push(Command::Try(format!("{}={name}", Key::Lesson.param().name)));
                }
            }
        });
    });
}

/// Draws content beside the room for the scroll bar.
fn clear_of_bar_ui<R>(ui: &mut Ui, content: impl FnOnce(&mut Ui) -> R) -> R {
    let margin = Margin { right: space::M as i8, ..Margin::ZERO };
    Frame::new().inner_margin(margin).show(ui, content).inner
}

/// Draws the buttons to the list, to the pages before and after, and to close, with the number of
/// the page.
fn header_ui(lesson: &Lesson<'_>, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        if !matches!(lesson, Lesson::Contents(_))
            && kit::icon_button_ui(Icon::Menu, text::ALL_LESSONS, ui).clicked()
        {
            go_to(CONTENTS, out);
        }
        if let Lesson::Page(page) = lesson {
            let words = RichText::new(say(&text::page_of(page.number, page.of), ui));
            ui.label(words.font(theme.font(Type::Small)).color(palette.muted));
        }
        ui.with_layout(Flow::right_to_left(Align::Center), |ui| {
            if kit::icon_button_ui(Icon::Close, text::CLOSE_LESSONS, ui).clicked() {
                go_to("", out);
            }
            if let Lesson::Page(page) = lesson {
                let ways = [
                    (Icon::ChevronRight, text::NEXT_PAGE, &page.next),
                    (Icon::ChevronLeft, text::PREVIOUS_PAGE, &page.previous),
                ];
                for (icon, words, to) in ways {
                    ui.add_enabled_ui(to.is_some(), |ui| {
                        if kit::icon_button_ui(icon, words, ui).clicked()
                            && let Some(to) = to
                        {
                            go_to(to, out);
                        }
                    });
                }
            }
        });
    });
}

fn contents_ui(page: &Page, out: &mut Out, ui: &mut Ui) {
    title_ui(&page.title, ui);
    let words = page.body.iter().take_while(|block| !matches!(block, Block::Item { .. })).count();
    blocks_ui(page.body.get(..words).unwrap_or_default(), Type::Body, out, ui);
    ui.add_space(space::XS);
    for (index, entry) in page.entries().enumerate() {
        let name = format!("{}. {}", index + 1, entry.label);
        let item = MenuItem { text: Text::Data(&name), ..MenuItem::default() };
        if kit::menu_item_ui(item, ui).clicked() {
            out.commands.push(Command::Try(entry.query.clone()));
        }
        ui.add_space(-space::S);
        indented_ui(MENU_INDENT * theme_of(ui).scale(), ui, |ui| {
            spans_ui(&entry.about, Type::Small, true, out, ui);
        });
    }
}

fn page_ui(
    shown: &LessonPage<'_>,
    name: &str,
    with_controls: bool,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let page = shown.page;
    title_ui(&page.title, ui);
    if let Some(begin) = &page.state {
        // An empty link is the state of the page itself.
        try_ui(&begin.label, "", session, out, ui);
    }
    ui.add_space(space::S);
    blocks_ui(&page.body, Type::Reading, out, ui);
    if with_controls && has_controls(session) {
        ui.add_space(space::M);
        controls_ui(session, FIGURE_ROOM, state, out, ui);
    }
    if !page.tries.is_empty() {
        ui.add_space(space::M);
        kit::section_header_ui(text::TRY, ui);
        for Try { label, query, about } in &page.tries {
            try_ui(label, query, session, out, ui);
            indented_ui(space::M, ui, |ui| spans_ui(about, Type::Reading, false, out, ui));
            ui.add_space(space::XS);
        }
    }
    if !page.question.is_empty() {
        ui.add_space(space::M);
        kit::section_header_ui(text::QUESTION, ui);
        blocks_ui(&page.question, Type::Reading, out, ui);
        answer_ui(page, name, state, out, ui);
    }
    if let Some(next) = &shown.next {
        ui.add_space(space::L);
        if kit::button_ui(Button::new(text::NEXT).trailing(Icon::ChevronRight), ui).clicked() {
            go_to(next, out);
        }
    }
}

/// Draws the button of the answer, and the answer while it is shown.
fn answer_ui(page: &Page, name: &str, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if page.answer.is_empty() {
        return;
    }
    let was_shown = state.answered.is_some();
    let words = if was_shown { text::HIDE_ANSWER } else { text::SHOW_ANSWER };
    if kit::button_ui(Button::new(words).selected(was_shown), ui).clicked() {
        state.answered = (!was_shown).then(|| name.to_owned());
    }
    if state.answered.is_some() {
        let frame = Frame::new().fill(palette_of(ui).panel_raised).corner_radius(radius::M);
        let shown = frame.inner_margin(Margin::same(space::M as i8)).show(ui, |ui| {
            ui.set_width(ui.available_width());
            blocks_ui(&page.answer, Type::Reading, out, ui);
        });
        if !was_shown {
            shown.response.scroll_to_me(None);
        }
    }
}

/// Draws a button that sets a state, with a mark while the state is set.
fn try_ui(label: &str, query: &str, session: &Session, out: &mut Out, ui: &mut Ui) {
    let is_there = session.is_tried(query);
    let icon = if is_there { Icon::Check } else { Icon::Play };
    if kit::button_ui(Button::new(Text::Data(label)).icon(icon).selected(is_there), ui).clicked() {
        out.commands.push(Command::Try(query.to_owned()));
    }
}

fn title_ui(title: &str, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let words = RichText::new(say(Text::Data(title), ui))
        .font(theme.font(Type::Heading))
        .color(palette.text);
    let title = ui.label(words);
    ui.ctx().accesskit_node_builder(title.id, |node| node.set_role(Role::Heading));
    ui.add_space(space::XS);
}

fn note_ui(words: Text<'_>, is_problem: bool, ui: &mut Ui) {
    let palette = palette_of(ui);
    let color = if is_problem { palette.warning } else { palette.muted };
    ui.label(RichText::new(say(words, ui)).font(theme_of(ui).font(Type::Body)).color(color));
    ui.add_space(space::S);
}

/// The room for a lab's figure inside the text of a lesson, points.
const FIGURE_ROOM: f32 = 240.0;

/// The indent of the text of a menu's item, points.
const MENU_INDENT: f32 = 31.0;

/// Draws indented content, below a button or an item of a menu.
fn indented_ui(by: f32, ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let margin = Margin { left: by as i8, ..Margin::ZERO };
    Frame::new().inner_margin(margin).show(ui, content);
}

/// Opens a lesson, a page, or nothing.
pub(super) fn go_to(lesson: &str, out: &mut Out) {
    out.set_once(Key::Lesson, Value::Text(lesson.to_owned()));
}
