//! The user interface: the theme, the kit of widgets, and the panels built from them.

mod appearance;
mod bone_map;
mod clip_drag;
mod clip_panel;
mod commands;
mod convert_panel;
pub(crate) mod kit;
mod labs;
mod language;
mod lessons_panel;
mod library_panel;
mod notices;
mod out;
mod overlays;
mod pacing;
mod page;
mod presenter;
mod rows;
mod stage;
mod state;
pub(crate) mod still;
#[cfg(all(test, feature = "ui-tests"))]
mod tests;
mod text;
pub(crate) mod theme;
mod timeline;
mod top_bar;
mod transport_row;

pub(crate) use appearance::{stage_look, stage_theme, theme};
pub(crate) use labs::on_stage::highlights;
pub(crate) use language::{Language, LanguagePack, PackError, Word, activate_english, skip_words};
pub(crate) use out::{Action, ConvertAction};
pub(crate) use pacing::Pacing;
pub(crate) use page::show;
pub(crate) use state::{ConvertShown, Filming, Gamepad, UiState};
pub(crate) use text::{HOST_READS, LINK_COPIED, REPORT_COPIED, TABLE_COPIED};
pub(crate) use timeline::CurveCache;
