//! The buttons beside the reason why there is no result: each does what would help.

use crate::ui::kit::{self, Button};
use crate::ui::out::Out;
use crate::ui::theme::space;
use eframe::egui::{Id, Ui, vec2};
use segue_session::{Pane, Remedy, Session};

/// Draws a button for each remedy of a refused result; nothing where there is none.
pub(crate) fn remedy_buttons_ui(pane: &Pane, session: &Session, out: &mut Out, ui: &mut Ui) {
    let remedies = session.remedies(pane);
    if remedies.is_empty() {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::S, space::XS);
        for (index, remedy) in remedies.iter().enumerate() {
            let label = remedy.label();
            let button = Button::new(&label);
            let button = if index == 0 { button.primary() } else { button.outlined() };
            if kit::button_ui(button, ui).clicked() {
                out.commands.extend(remedy.commands());
                if let Remedy::SetBodyParts { id, .. } = remedy {
                    ui.data_mut(|data| data.insert_temp(asked_id(), id.clone()));
                }
            }
        }
    });
}

/// The place of the clip whose body parts a button has asked for.
fn asked_id() -> Id {
    Id::unique("body parts asked for")
}

/// Returns whether a button has just asked for the body parts of this clip.
pub(crate) fn body_parts_asked_for(id: &str, ui: &Ui) -> bool {
    ui.data_mut(|data| {
        let is_asked = data.get_temp::<String>(asked_id()).is_some_and(|asked| asked == id);
        if is_asked {
            data.remove::<String>(asked_id());
        }
        is_asked
    })
}
