//! The themes and the look of the stage that the parameters ask for.

use super::theme::Theme;
use segue_scene::Look;
use segue_session::choices::{Backdrop, PageTheme};
use segue_session::{Key, Session};

/// Returns the theme that the parameters ask for, on a system that prefers dark or light, worked by
/// fingers or by a mouse.
pub(crate) fn theme(session: &Session, system_dark: bool, touch: bool) -> Theme {
    let dark = match session.params().choice::<PageTheme>() {
        PageTheme::Dark => true,
        PageTheme::Light => false,
        PageTheme::Auto => system_dark,
    };
    Theme { dark, projector: session.params().is_on(Key::Projector), touch, ..Theme::default() }
}

/// Returns the theme of the layers over the stage, on a page of that theme.
pub(crate) fn stage_theme(session: &Session, page: Theme) -> Theme {
    let dark = match session.params().choice::<Backdrop>() {
        Backdrop::Dark => true,
        Backdrop::Light | Backdrop::Paper => false,
        Backdrop::Auto => page.dark,
    };
    Theme { dark, ..page }
}

/// Returns the colours and the light of the stage in that theme.
pub(crate) fn stage_look(session: &Session, theme: Theme) -> Look {
    let mut look = match (session.params().choice(), theme.dark) {
        (Backdrop::Paper, _) => Look::PAPER,
        (_, true) => Look::DARK,
        (_, false) => Look::LIGHT,
    };
    look.edge_width *= theme.scale();
    look
}
