//! The Layers lab: the part of the body that is B's, its weight and its timing.

use crate::ui::labs::lab_ui::{Compares, LabUi, Shown, Title};
use crate::ui::language::say;
use crate::ui::out::Out;
use crate::ui::rows::{Detail, KeepOffer, param_row_ui};
use crate::ui::rows::{compare_ui, foot_rows_ui, pair_ui};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{RichText, Ui};
use segue_session::choices;
use segue_session::{Key, Session};
use segue_text::msg;

/// The lab's part of the page.
pub(super) const LAB: LabUi = LabUi {
    panel_ui: layers_ui,
    about: [text::LAYERS_ABOUT, text::LAYERS_DETAILS],
    kept: |_, pane| KeepOffer::result(pane),
    compares: Compares::Key(Key::LayerWeight),
    title,
    hint: |_| None,
    take_line: None,
};

fn title(shown: &Shown<'_>) -> Title {
    Title {
        strong: shown.name(Key::A),
        text: msg!("+ {clip}", clip = shown.name(Key::B)),
        secondary: shown.spoken(Key::Mask),
    }
}

/// Draws the rows of the lab.
pub(super) fn layers_ui(session: &Session, _: &mut UiState, out: &mut Out, ui: &mut Ui) {
    pair_ui(session, out, ui);
    let params = session.params();
    let plain = Detail::default();
    let additive = params.choice::<choices::LayerMode>() == choices::LayerMode::Additive
        || session.compare().is_some_and(|compare| compare.key == Key::LayerMode);
    param_row_ui(Key::LayerMode, &plain, session, out, ui);
    ui.add_space(space::XS);
    param_row_ui(Key::Mask, &plain, session, out, ui);
    param_row_ui(Key::LayerWeight, &plain, session, out, ui);
    compare_ui(Key::LayerWeight, session, out, ui);
    param_row_ui(Key::Feather, &plain, session, out, ui);
    if additive {
        param_row_ui(Key::LayerReference, &plain, session, out, ui);
        ui.add_space(space::XS);
    }
    param_row_ui(Key::LayerFit, &plain, session, out, ui);
    if let Some(layer) = session.main_outcome().and_then(|outcome| outcome.layer()) {
        let words = RichText::new(say(&text::fit(layer), ui)).font(theme_of(ui).font(Type::Small));
        ui.label(words.color(palette_of(ui).muted));
    }
    param_row_ui(Key::LayerStart, &plain, session, out, ui);
    ui.add_space(space::XS);
    if params.choice::<choices::LayerMode>() != choices::LayerMode::Additive {
        param_row_ui(Key::KeepOrientation, &plain, session, out, ui);
    }
    param_row_ui(Key::MaskColors, &plain, session, out, ui);
    foot_rows_ui(session, out, ui);
}
