//! The one table of parameters. Sliders, the link, the page's API, compare, undo and
//! `docs/parameters.md` are made from it.

pub mod choices;
mod current;
mod grammar;
mod key;
mod lists;
mod param;
mod rows;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod value;

pub use choices::Choice;
pub use current::Params;
pub use grammar::{
    ClipContacts, HandTag, List, ListKind, MAX_MORE_CURVES, MAX_WEIGHTED_CLIPS, Misread, write_ids,
};
pub(crate) use grammar::{escaped, is_recipe, parts};
pub use key::Key;
pub use param::{Group, Kind, Mark, Param};
pub use rows::PARAMS;
pub use text::{decimals_of, format_number};
pub use value::{Compare, MAX_PANES, Value, ValueError};
