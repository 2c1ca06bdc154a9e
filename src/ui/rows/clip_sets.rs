//! The row of a lab with the sets of clips that it can work with.

use crate::ui::kit::{self, Button};
use crate::ui::out::Out;
use crate::ui::text;
use crate::ui::theme::space;
use eframe::egui::{Ui, vec2};
use segue_session::{ClipSet, Command, Session};

/// Draws a button for each available set of clips, the one in use marked.
pub(crate) fn clip_sets_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        for set in [ClipSet::Made, ClipSet::Captured, ClipSet::Own] {
            let Some(values) = session.clip_set(set) else {
                continue;
            };
            let (words, help) = text::clip_set(set);
            let button = Button::new(words).selected(session.uses_clip_set(set)).hint(help);
            if kit::button_ui(button, ui).clicked() {
                out.commands.push(Command::Set(values));
                out.commands.push(Command::Settle);
            }
        }
    });
}
