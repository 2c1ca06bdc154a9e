//! The classic mistakes of the Transition lab, one at a time, with a description of each.

use crate::ui::kit::{self, Button};
use crate::ui::language::say;
use crate::ui::out::Out;
use crate::ui::rows::{Detail, param_row_ui};
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, theme_of};
use eframe::egui::{RichText, Ui};
use segue_session::choices::{Mistake, TransitionMethod};
use segue_session::{Compare, Key, Session, mistake_shows};

/// Draws the choice, a sentence for every mistake on the stage, and the button that compares with
/// the right way.
pub(super) fn break_it_ui(session: &Session, out: &mut Out, ui: &mut Ui) {
    param_row_ui(Key::Mistake, &Detail::default(), session, out, ui);
    let params = session.params();
    let compared = session.compare().filter(|compare| compare.key == Key::Mistake);
    for mistake in session.choices::<Mistake>() {
        let shows = shows(mistake, session);
        let sentence = match (mistake, params.choice()) {
            _ if !shows => text::MISTAKE_IDLE,
            (Mistake::Velocity, TransitionMethod::Smooth | TransitionMethod::Linear) => {
                text::VELOCITY_IN_DISSOLVE
            }
            _ => text::mistake(mistake),
        };
        if !sentence.is_empty() {
            let color = if shows { palette_of(ui).muted } else { palette_of(ui).warning };
            ui.label(
                RichText::new(say(sentence, ui)).font(theme_of(ui).font(Type::Small)).color(color),
            );
        }
    }
    if (params.choice::<Mistake>() != Mistake::None || compared.is_some())
        && kit::button_ui(Button::new(text::RIGHT_AND_WRONG).selected(compared.is_some()), ui)
            .clicked()
    {
        let none = Mistake::None.into();
        let values = vec![none, params.get(Key::Mistake).clone()];
        out.compare(match compared {
            Some(_) => None,
            None => Some(Compare { key: Key::Mistake, values }),
        });
    }
}

/// Returns whether the mistake can be made with the method.
fn shows(mistake: Mistake, session: &Session) -> bool {
    let mut params = session.params().clone();
    params.set(Key::Mistake, mistake.into()).is_ok() && mistake_shows(&params)
}
