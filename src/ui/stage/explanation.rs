//! The explanation of a number: its name, its meaning, which values are good, and the way to the
//! frame where it happens.

use crate::ui::kit::{self, Button, Icon, Rank};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::accesskit::Role;
use eframe::egui::{Color32, Label, Popup, PopupCloseBehavior, RectAlign, Response, RichText, Ui};
use segue_session::metrics::MetricRow;
use segue_session::{Command, Key, Pane, PlaybackCommand, Session, frame_at};

/// A number that is explained.
pub(super) struct Explained<'a> {
    pub(super) row: &'static MetricRow,
    /// The number as text; a dash for none.
    pub(super) value: &'a str,
    pub(super) unit: Word,
    pub(super) rank: Rank,
    /// The time of the result where it happens, seconds.
    pub(super) at_secs: Option<f64>,
    pub(super) pane: &'a Pane,
}

/// Shows the explanation beside the number while it is open; a press of the number opens it.
pub(super) fn explanation_ui(
    opener: &Response,
    of: &Explained<'_>,
    session: &Session,
    out: &mut Out,
    ui: &Ui,
) {
    let width = 300.0 * theme_of(ui).scale();
    let popup = Popup::from_toggle_button_response(opener)
        .align(RectAlign::TOP_START)
        .gap(space::S)
        .width(width)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    kit::popup_returning_keyboard_ui(opener, popup, |ui| {
        ui.set_max_width(width);
        kit::set_role(Role::Dialog, Word::new(of.row.label), ui);
        content_ui(of, session, out, ui);
    });
}

fn content_ui(of: &Explained<'_>, session: &Session, out: &mut Out, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    ui.spacing_mut().item_spacing.y = space::S;
    line_ui(Word::new(of.row.label).into(), Type::Strong, palette.text, ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::XS;
        line_ui(Text::Data(of.value), Type::Metric, of.rank.ink(ui), ui);
        for (word, ink) in [(of.unit, palette.muted), (of.rank.word(), of.rank.ink(ui))] {
            if !word.is_empty() {
                line_ui(word.into(), Type::Body, ink, ui);
            }
        }
    });
    let is_measured = of.pane.outcome.as_ref().is_some_and(|outcome| {
        outcome.metric(of.row.id).is_some_and(|metric| metric.value.is_some())
    });
    if !is_measured {
        line_ui(text::NOT_MEASURED.into(), Type::Body, palette.warning, ui);
    }
    line_ui(Word::new(of.row.help).into(), Type::Body, palette.text, ui);
    line_ui(Word::new(of.row.good).into(), Type::Body, palette.muted, ui);
    // A driven character has no frames to go to: its time is now.
    let Some((secs, outcome)) =
        of.at_secs.zip(of.pane.outcome.as_deref()).filter(|_| !session.is_driven())
    else {
        return;
    };
    ui.horizontal(|ui| {
        if kit::button_ui(Button::new(text::SHOW_FRAME).icon(Icon::StepForward), ui).clicked() {
            out.commands.push(Command::Playback(PlaybackCommand::Seek(secs)));
            if session.params().is_on(Key::Play) {
                out.commands.push(Command::Playback(PlaybackCommand::TogglePlay));
            }
            ui.close();
        }
        let place = text::worst_frame(secs, frame_at(&outcome.motion, secs));
        ui.label(RichText::new(say(&place, ui)).font(theme.font(Type::Small)).color(palette.muted));
    });
}

/// Draws a text that wraps and can be selected.
fn line_ui(text: Text<'_>, step: Type, color: Color32, ui: &mut Ui) {
    let text = RichText::new(say(text, ui)).font(theme_of(ui).font(step)).color(color);
    ui.add(Label::new(text).wrap().selectable(true));
}
